//! Places where an object is to be held: where it starts, where goals have it, or anywhere on a support.

use crate::goals::impossible::moves::{Asked, asked, places_on, rests_on_what_moves, with_object_at};
use crate::planning_model::model::Model;
use crate::planning_model::state_classification::residual;
use foliate_components::constraint::Constraint;
use foliate_components::graph::{ConstraintId, ConstraintKind};
use foliate_components::problem::{NamedConstraint, OtherHands, PartialGoal};

/// Where a grasp holds at the start, metres and radians.
const HOLDS: f64 = 1e-4;

/// Where an object is when it is to be held.
#[derive(Clone, Debug)]
pub(crate) struct Site {
    /// A configuration with the object there, as far as a pose is asked.
    pub q: Vec<f64>,
    /// What holds there besides a grasp.
    pub goal: PartialGoal,
    /// How the object lies, where no pose is asked.
    pub lies: Option<Constraint>,
}

impl Site {
    /// Where an object starts; `None` where it is held there, or lies on what moves.
    pub(crate) fn at_start(model: &Model, start: &[f64], object: usize) -> Option<Self> {
        let X_WJ = model.kinematics.poses(start);
        let holds = |(number, kind): (u32, ConstraintKind)| match kind {
            ConstraintKind::Grasp { handle, .. } => {
                model.graph.objects[object].handles.contains(&handle)
                    && residual(model, ConstraintId(number), start, &X_WJ) <= HOLDS
            }
            _ => false,
        };
        let mut kinds = (0u32..).zip(model.graph.constraints.iter().map(|constraint| constraint.kind));
        let is_fixed = !rests_on_what_moves(model, object, &X_WJ) && !kinds.any(holds);
        is_fixed.then(|| Self::at(model, start, object)).flatten()
    }

    /// The places where goals have an object, each once; `None` where a goal says none, or one on what moves.
    pub(crate) fn at_goals(model: &Model, start: &[f64], object: usize) -> Option<Vec<Self>> {
        let mut places: Vec<Asked> = Vec::new();
        for goal in &model.problem.goals {
            let place = asked(model, goal, object)?;
            if !places.contains(&place) {
                places.push(place);
            }
        }
        let site = |place: &Asked| match place {
            Asked::At(pose) => {
                let q = with_object_at(model, start, object, pose)?;
                let is_fixed = !rests_on_what_moves(model, object, &model.kinematics.poses(&q));
                is_fixed.then(|| Self::at(model, &q, object)).flatten()
            }
            Asked::On(supports) => match &places_on(model, object, supports)[..] {
                [place] if place.on.is_none() => Some(Self::lying(start, place.resting.constraint(0.0))),
                _ => None,
            },
        };
        places.iter().map(site).collect::<Option<Vec<_>>>().filter(|sites| !sites.is_empty())
    }

    /// Where a configuration has an object.
    pub(crate) fn at(model: &Model, q: &[f64], object: usize) -> Option<Self> {
        let pose = model.kinematics.poses(q)[model.objects()[object].root?.at()];
        let poses = vec![(model.graph.objects[object].part, pose)];
        let goal = PartialGoal { poses, other_hands: OtherHands::Anything, ..PartialGoal::default() };
        Some(Self { q: q.to_vec(), goal, lies: None })
    }

    /// Wherever an object lies so.
    pub(crate) fn lying(q: &[f64], lies: Constraint) -> Self {
        let constraints = vec![NamedConstraint { name: "lying".into(), constraint: lies.clone() }];
        let goal = PartialGoal { constraints, other_hands: OtherHands::Anything, ..PartialGoal::default() };
        Self { q: q.to_vec(), goal, lies: Some(lies) }
    }
}
