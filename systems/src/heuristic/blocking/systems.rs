//! The systems of the order of moves: it begins before leaves are measured, and candidates are aimed at buffer places once their
//! transitions are drawn.

use crate::exploration::explored::Explored;
use crate::exploration::roadmap_query::roadmap_in;
use crate::exploration::roots::Roots;
use crate::exploration::writer;
use crate::heuristic::blocking::moves::{Known, MoveOrder};
use crate::heuristic::blocking::order::{Move, Order};
use crate::planning_model::model::{Model, PlanningModel};
use crate::runtime::random::{Purpose, stream};
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Entity, Mut, Query, Res, ResMut, World};
use foliate_components::candidate::{Candidate, CommitAs};
use foliate_components::graph::leaf::{Leaf, LeafId, LeafIndex};
use foliate_components::graph::{Transition, TransitionId, TransitionKind};
use foliate_components::outcome::Rejection;
use rand::RngExt;

/// Share of the releases onto new leaves that are aimed at a chosen place, of objects whose target is taken.
const CHOSEN: f64 = 0.9;

/// Finds out whether so many objects move that their order matters.
pub fn begin_order(
    model: Res<'_, PlanningModel>,
    roots: Res<'_, Roots>,
    explored: Explored<'_, '_>,
    mut order: ResMut<'_, MoveOrder>,
) {
    if order.is_known() {
        return;
    }
    let leaf = |node| explored.leaves.leaf(explored.roadmap().node(node).leaf);
    let goals: Vec<_> = roots.goals.iter().map(|&goal| leaf(goal)).collect();
    if let Some(start) = roots.start {
        order.begin(&model, leaf(start), &goals);
    }
}

/// Aims candidates that set down an object anywhere, because its target is taken, at a place that is free.
pub fn aim_at_buffers(world: &mut World) {
    if !world.resource::<MoveOrder>().is_known() {
        return;
    }
    world.resource_scope(|world, mut order: Mut<'_, MoveOrder>| {
        world.resource_scope(|world, model: Mut<'_, PlanningModel>| {
            if let Some(known) = &mut order.known {
                aim(world, &model, known);
            }
        });
    });
}

/// A candidate that sets down an object anywhere.
struct Setting {
    candidate: Entity,
    index: u32,
    from: LeafId,
    to: LeafId,
    transition: TransitionId,
}

fn aim(world: &mut World, model: &Model, known: &mut Known) {
    let (step, seed) = (world.resource::<StepCounter>().step, world.resource::<SearchSettings>().seed);
    let mut settings = Vec::new();
    for (entity, candidate) in world.query::<(Entity, &Candidate)>().iter(world) {
        let Candidate { index, near: Some(near), transition: Some(transition), target_leaf: Some(to), .. } = *candidate
        else {
            continue;
        };
        let is_free = model.graph.transition(transition).kind == TransitionKind::Regular;
        if candidate.is_alive() && is_free && candidate.commit_as == CommitAs::DetachedTrees {
            settings.push((entity, index, near, to, transition));
        }
    }
    settings.sort_by_key(|&(_, index, ..)| index);
    let roadmap = roadmap_in(world);
    let settings: Vec<Setting> = settings
        .into_iter()
        .map(|(candidate, index, near, to, transition)| Setting {
            candidate,
            index,
            from: roadmap.node(near).leaf,
            to,
            transition,
        })
        .collect();
    for setting in settings {
        let mut rng = stream(seed, Purpose::AIM, step, setting.index | 1 << 31);
        if rng.random::<f64>() >= CHOSEN {
            continue;
        }
        let Some((transition, target)) = buffer_for(world, model, known, &setting, seed, &mut rng) else { continue };
        if let Some(mut candidate) = world.get_mut::<Candidate>(setting.candidate) {
            candidate.transition = Some(transition);
            candidate.target_leaf = Some(target);
        }
    }
}

/// The crossed transition that sets the object down, and the leaf on which it then is.
fn buffer_for(
    world: &mut World,
    model: &Model,
    known: &mut Known,
    setting: &Setting,
    seed: u64,
    rng: &mut impl RngExt,
) -> Option<(TransitionId, LeafId)> {
    let Move::Put(object, grasp) = known.what(&model.graph, setting.transition) else { return None };
    let placed = known.exclusions.objects[object].constraint;
    let parallel = model.graph.transition(setting.transition);
    let is_crossed = |&(_, transition): &(TransitionId, &Transition)| {
        transition.kind == TransitionKind::Crossed && transition.to == parallel.to && transition.adds == [placed]
    };
    let (id, transition) = model.graph.leaving(parallel.from).find(is_crossed)?;
    let leaves = world.resource::<LeafIndex>();
    let (from, to) = (leaves.leaf(setting.from).clone(), leaves.leaf(setting.to).clone());
    let order = Order::new(model, leaves, &mut known.exclusions, &from, &to);
    let target = order.there[object]?;
    let is_out = grasp.is_some_and(|grasp| known.reach.is_out(grasp, target));
    if !order.waits(object) && !is_out {
        return None;
    }
    let onward = known.grasps_of(&model.graph, object).to_vec();
    let Known { exclusions, buffers, reach, .. } = known;
    let suits = |place| {
        let carries = |&grasp: &_| reach.likelihood(grasp, place) * reach.likelihood(grasp, target);
        let goes_on = onward.iter().map(carries).reduce(f64::max).unwrap_or(1.0);
        grasp.map_or(1.0, |grasp| reach.likelihood(grasp, place)) * goes_on
    };
    let mut leaves = world.resource_mut::<LeafIndex>();
    let parameter = buffers.choose(model, &mut leaves, exclusions, (&order, object), (seed, rng), suits)?;
    let value = |&constraint: &_| match constraint == placed {
        true => Some(parameter),
        false => model.graph.value(&from, constraint),
    };
    let parameters = model.graph.state(transition.to).foliation.iter().map(value).collect::<Option<_>>()?;
    Some((id, writer::intern_leaf(world, Leaf { state: transition.to, parameters })))
}

/// Set Validate, after the certificates: remembers which grasps were found at which placements.
pub fn learn_reach(
    model: Res<'_, PlanningModel>,
    explored: Explored<'_, '_>,
    mut order: ResMut<'_, MoveOrder>,
    candidates: Query<'_, '_, &Candidate>,
) {
    let Some(known) = &mut order.known else { return };
    for candidate in &candidates {
        let (Some(near), Some(transition)) = (candidate.near, candidate.transition) else { continue };
        let (object, grasp, leaf) = match known.what(&model.graph, transition) {
            Move::Take(object, Some(grasp)) => (object, grasp, Some(explored.roadmap().node(near).leaf)),
            Move::Put(object, Some(grasp)) => (object, grasp, candidate.drawn),
            _ => continue,
        };
        let placed = known.exclusions.objects[object].constraint;
        let place = leaf.and_then(|leaf| model.graph.value(explored.leaves.leaf(leaf), placed));
        let was_found = !matches!(candidate.rejected, Some(Rejection::ProjectionFailed(_)));
        if let (Some(place), true) = (place, was_tried(candidate)) {
            known.reach.count(grasp, place, was_found);
        }
    }
}

/// Whether a candidate came so far that its waypoints were looked for.
fn was_tried(candidate: &Candidate) -> bool {
    !matches!(
        candidate.rejected,
        Some(Rejection::LeftOut | Rejection::Stopped | Rejection::NoLeafToAimAt | Rejection::NoProgress)
    )
}
