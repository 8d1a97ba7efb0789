//! Which objects to move next on the way from one leaf to another.

use crate::heuristic::blocking::buffers::Buffers;
use crate::heuristic::blocking::exclusions::{Exclusions, Placeable};
use crate::heuristic::blocking::order::{Move, Order};
use crate::heuristic::blocking::reach::Reach;
use crate::planning_model::model::Model;
use bevy_ecs::prelude::Resource;
use foliate_components::graph::leaf::{Leaf, LeafIndex};
use foliate_components::graph::{ConstraintGraph, ConstraintId, ConstraintKind, StateId, Transition, TransitionId};

/// So many objects that are elsewhere in the goal are few.
const FEW: usize = 2;

/// Changes of grasp that an object adds which has to be set aside or to change hands, and one that is held while its target is taken.
const DETOUR: u16 = 2;
const HELD: u16 = 1;

/// The order of moves; nothing is known, and all is as likely as without, where few objects move.
#[derive(Clone, Debug, Default, Resource)]
pub struct MoveOrder {
    pub(crate) known: Option<Known>,
}

#[derive(Clone, Debug)]
pub(crate) struct Known {
    pub(crate) exclusions: Exclusions,
    pub(crate) buffers: Buffers,
    pub(crate) reach: Reach,
    /// By object: its grasps, of the constraints that were there.
    grasps: Vec<Vec<ConstraintId>>,
    constraints: usize,
    /// By transition: what it does with an object.
    moves: Vec<Option<Move>>,
}

impl MoveOrder {
    /// Learns which objects there are, where so many are elsewhere in all goals.
    pub(crate) fn begin(&mut self, model: &Model, start: &Leaf, goals: &[&Leaf]) {
        let least = goals.iter().map(|goal| displaced(&model.graph, start, goal)).min().unwrap_or(0);
        if self.known.is_none() && least > FEW {
            let (exclusions, grasps, moves) = (Exclusions::new(model), Vec::new(), Vec::new());
            self.known = Some(Known {
                exclusions,
                buffers: Buffers::default(),
                reach: Reach::default(),
                grasps,
                constraints: 0,
                moves,
            });
        }
    }

    /// Whether many objects move.
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.known.is_some()
    }

    /// Changes of grasp that the way from one leaf to another takes beyond one by one: objects that are on cycles are moved twice.
    pub(crate) fn detours(&mut self, model: &Model, leaves: &LeafIndex, from: &Leaf, to: &Leaf) -> u16 {
        let Some(known) = &mut self.known else { return 0 };
        let order = Order::new(model, leaves, &mut known.exclusions, from, to);
        let is_held = |&object: &usize| {
            order.here[object].is_none() && order.there[object].is_some() && order.dependencies.waits(object)
        };
        let held = (0..order.here.len()).filter(is_held).count() as u16;
        let idle = if order.is_done() { 0 } else { order.held_in_both() };
        DETOUR * (order.aside.len() as u16 + known.changing_hands(&model.graph, &order, from)) + HELD * (held + idle)
    }

    /// How much likelier each of some transitions gets on the way from one leaf to another by what stands in the way.
    pub fn preferences<'t>(
        &mut self,
        model: &Model,
        leaves: &LeafIndex,
        (from, to): (&Leaf, &Leaf),
        transitions: impl Iterator<Item = (TransitionId, &'t Transition)>,
    ) -> Option<Vec<f64>> {
        let known = self.known.as_mut()?;
        let order = Order::new(model, leaves, &mut known.exclusions, from, to);
        Some(
            transitions
                .map(|(id, transition)| order.weight(known.what(&model.graph, id), transition, &known.reach))
                .collect(),
        )
    }
}

impl Known {
    /// What a transition does with an object.
    pub(crate) fn what(&mut self, graph: &ConstraintGraph, id: TransitionId) -> Move {
        if self.moves.len() <= id.at() {
            self.moves.resize(id.at() + 1, None);
        }
        let objects = &self.exclusions.objects;
        let find = || {
            let transition = graph.transition(id);
            let has = |state, constraint: ConstraintId| graph.state(state).foliation.contains(&constraint);
            let grasp_in = |has: StateId, lacks: StateId| {
                let grasps = graph.state(has).manifold.iter().copied();
                let mut new = grasps.filter(|c| !graph.state(lacks).manifold.contains(c));
                new.find(|&c| matches!(graph.constraint(c).kind, ConstraintKind::Grasp { .. }))
            };
            let changed = objects.iter().enumerate().find_map(|(number, object)| {
                match (has(transition.from, object.constraint), has(transition.to, object.constraint)) {
                    (true, false) => Some(Move::Take(number, grasp_in(transition.to, transition.from))),
                    (false, true) => Some(Move::Put(number, grasp_in(transition.from, transition.to))),
                    _ => None,
                }
            });
            changed.unwrap_or(Move::Other)
        };
        *self.moves[id.at()].get_or_insert_with(find)
    }

    /// The grasps of an object.
    pub(crate) fn grasps_of(&mut self, graph: &ConstraintGraph, object: usize) -> &[ConstraintId] {
        self.grasps.resize_with(self.exclusions.objects.len(), Vec::new);
        for number in self.constraints..graph.constraints.len() {
            let constraint = ConstraintId(number as u32);
            if let ConstraintKind::Grasp { handle, .. } = graph.constraint(constraint).kind {
                let has = |object: &Placeable| graph.objects[object.object as usize].handles.contains(&handle);
                let of = self.exclusions.objects.iter().position(has);
                of.into_iter().for_each(|of| self.grasps[of].push(constraint));
            }
        }
        self.constraints = graph.constraints.len();
        &self.grasps[object]
    }

    /// How many objects no grasp takes to their targets at once, as far as that is known.
    fn changing_hands(&mut self, graph: &ConstraintGraph, order: &Order, from: &Leaf) -> u16 {
        let mut count = 0;
        for (object, (here, there)) in order.here.iter().zip(&order.there).enumerate() {
            let Some(target) = there.filter(|there| *here != Some(*there)) else { continue };
            let held = |c: &ConstraintId| graph.state(from.state).manifold.contains(c);
            let grasps = self.grasps_of(graph, object).to_vec();
            let carries = |grasp: &ConstraintId| {
                let takes = here.map_or_else(|| held(grasp), |here| !self.reach.is_out(*grasp, here));
                takes && !self.reach.is_out(*grasp, target)
            };
            count += u16::from(!grasps.is_empty() && !grasps.iter().any(carries));
        }
        count
    }
}

/// How many constraints have values in two leaves that are not the same.
fn displaced(graph: &ConstraintGraph, a: &Leaf, b: &Leaf) -> usize {
    let known = graph.state(a.state).foliation.iter().zip(&a.parameters);
    known.filter(|&(&c, &value)| graph.value(b, c).is_some_and(|other| other != value)).count()
}
