//! What there is to move on the way from one leaf to another, and how likely each move is worth a try.

use crate::heuristic::blocking::dependencies::Dependencies;
use crate::heuristic::blocking::exclusions::Exclusions;
use crate::heuristic::blocking::reach::Reach;
use crate::planning_model::model::Model;
use foliate_components::graph::leaf::{Leaf, LeafIndex, ParameterId};
use foliate_components::graph::{ConstraintId, Transition, TransitionKind};

/// What is left of the weight of taking an object that waits for others, and of one that has to be set aside while others can go.
const WAITING: f64 = 0.05;
const LATER: f64 = 0.1;

/// What is left of the weight of taking an object that is where it shall be.
const IDLE: f64 = 0.02;

/// What is left of the weight of setting an object down where another is.
const TAKEN: f64 = 0.02;

/// How much likelier an object is set down anywhere while its target is taken.
const ASIDE: f64 = 4.0;

/// What is left of the weight of setting an object down anywhere while its target is free.
const ANYWHERE: f64 = 0.1;

/// What a transition does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Move {
    /// It takes an object from where it rests, by a grasp.
    Take(usize, Option<ConstraintId>),
    /// It sets an object down that is held by a grasp.
    Put(usize, Option<ConstraintId>),
    Other,
}

/// What there is to move on the way from one leaf to another.
#[derive(Clone, Debug)]
pub(crate) struct Order {
    /// By object: where it rests in either leaf.
    pub(crate) here: Vec<Option<ParameterId>>,
    pub(crate) there: Vec<Option<ParameterId>>,
    pub(crate) dependencies: Dependencies,
    pub(crate) aside: Vec<usize>,
    /// Whether some object can go to its target at once.
    is_any_free: bool,
}

impl Order {
    /// What stands in the way from one leaf to another.
    pub(crate) fn new(model: &Model, leaves: &LeafIndex, exclusions: &mut Exclusions, from: &Leaf, to: &Leaf) -> Self {
        let rests = |leaf: &Leaf| -> Vec<Option<ParameterId>> {
            let objects = exclusions.objects.iter();
            let value = |constraint| model.graph.value(leaf, constraint);
            let fixed = |id: &ParameterId| leaves.parameter(*id).carrier.is_none();
            objects.map(|object| value(object.constraint).filter(fixed)).collect()
        };
        let (here, there) = (rests(from), rests(to));
        let mut waits_for = vec![Vec::new(); here.len()];
        for (object, target) in there.iter().enumerate() {
            if let Some(target) = target.filter(|&target| here[object] != Some(target)) {
                waits_for[object] = exclusions.excluded(model, leaves, (object, target), &here);
            }
        }
        let moves = |object: usize| here[object].is_some() && there[object].is_some() && here[object] != there[object];
        let is_any_free = (0..here.len()).any(|object| moves(object) && waits_for[object].is_empty());
        let dependencies = Dependencies::new(waits_for);
        let aside = dependencies.to_set_aside();
        Self { here, there, dependencies, aside, is_any_free }
    }

    /// Whether the target of an object is taken.
    pub(crate) fn waits(&self, object: usize) -> bool {
        self.dependencies.waits(object)
    }

    /// Whether every object rests where it shall, or is held there.
    pub(crate) fn is_done(&self) -> bool {
        self.here == self.there
    }

    /// Objects that both leaves hold: hands that are busy with something else than what is left to move.
    pub(crate) fn held_in_both(&self) -> u16 {
        self.here.iter().zip(&self.there).filter(|(here, there)| here.is_none() && there.is_none()).count() as u16
    }

    /// How much likelier a transition gets.
    pub(crate) fn weight(&self, what: Move, transition: &Transition, reach: &Reach) -> f64 {
        match what {
            Move::Take(object, grasp) => {
                let ends = [self.here[object], self.there[object]].into_iter().flatten();
                let within_reach = |grasp| ends.map(|end| reach.likelihood(grasp, end)).product::<f64>();
                self.weight_of_taking(object) * grasp.map_or(1.0, within_reach)
            }
            Move::Put(object, grasp) => {
                let Some(target) = self.there[object] else { return 1.0 };
                let is_out = grasp.is_some_and(|grasp| reach.is_out(grasp, target));
                match (transition.kind, self.waits(object)) {
                    (TransitionKind::Crossed, true) => TAKEN,
                    (TransitionKind::Crossed, false) => grasp.map_or(1.0, |grasp| reach.likelihood(grasp, target)),
                    (_, waits) => {
                        if waits || is_out {
                            ASIDE
                        } else {
                            ANYWHERE
                        }
                    }
                }
            }
            Move::Other => 1.0,
        }
    }

    fn weight_of_taking(&self, object: usize) -> f64 {
        if self.here[object] == self.there[object] {
            return IDLE;
        }
        match (self.waits(object), self.aside.contains(&object), self.is_any_free) {
            (false, ..) | (true, true, false) => 1.0,
            (true, true, true) => LATER,
            (true, false, _) => WAITING,
        }
    }
}
