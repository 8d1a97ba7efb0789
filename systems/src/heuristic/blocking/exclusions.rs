//! Which placements of two objects exclude each other: tested by their shapes once, then known.

use crate::planning_model::model::Model;
use crate::planning_model::objects::ObjectModel;
use foliate_components::Pose;
use foliate_components::graph::leaf::{LeafIndex, ParameterId};
use foliate_components::graph::{ConstraintId, ConstraintKind};
use foliate_components::robot::JointIndex;
use foliate_kernels::collision::{DistanceQuery, PairId, contained, pair_clearance};
use glam::DVec3;
use std::collections::HashMap;

/// An object that may rest on what is fixed in the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placeable {
    /// Number in the graph.
    pub(crate) object: u32,
    /// Its placement.
    pub(crate) constraint: ConstraintId,
    root: JointIndex,
}

/// See the module.
#[derive(Clone, Debug, Default)]
pub(crate) struct Exclusions {
    pub(crate) objects: Vec<Placeable>,
    /// By two objects, the smaller number first: pairs of shapes on their roots.
    pairs: HashMap<(usize, usize), Vec<PairId>>,
    /// By two parameters, the smaller first: whether they exclude each other.
    known: HashMap<(ParameterId, ParameterId), bool>,
    X_WJ: Vec<Pose>,
}

impl Exclusions {
    /// The objects of a model; only shapes on their roots count.
    pub(crate) fn new(model: &Model) -> Self {
        let placeable = |(object, of): (u32, &ObjectModel)| {
            let wanted = ConstraintKind::Placement { object, on: None };
            let constraint = model.graph.constraints.iter().position(|c| c.kind == wanted)?;
            Some(Placeable { object, constraint: ConstraintId(constraint as u32), root: of.root? })
        };
        let objects: Vec<_> = (0..).zip(model.objects()).filter_map(placeable).collect();
        let by_body: HashMap<JointIndex, usize> =
            objects.iter().enumerate().map(|(number, object)| (object.root, number)).collect();
        let of_shape = |shape: foliate_components::robot::ShapeIndex| {
            by_body.get(&model.collision.solids()[shape.at()].body?).copied()
        };
        let mut pairs: HashMap<_, Vec<PairId>> = HashMap::new();
        for (id, pair) in (0..).map(PairId).zip(model.collision.pairs()) {
            if let (Some(a), Some(b)) = (of_shape(pair.first), of_shape(pair.second)) {
                pairs.entry((a.min(b), a.max(b))).or_default().push(id);
            }
        }
        Self { objects, pairs, known: HashMap::new(), X_WJ: vec![Pose::identity(); model.kinematics.bodies()] }
    }

    /// Of the placements `others` of other objects (`None`: it rests nowhere) those that exclude the placement `at` of an object, by object.
    pub(crate) fn excluded(
        &mut self,
        model: &Model,
        leaves: &LeafIndex,
        (object, at): (usize, ParameterId),
        others: &[Option<ParameterId>],
    ) -> Vec<usize> {
        let others = others.iter().enumerate().filter(|&(other, _)| other != object);
        let mut exclude = |&(other, place): &(usize, ParameterId)| {
            let key = (at.min(place), at.max(place));
            let test = || {
                Self::test(
                    &self.pairs,
                    &mut self.X_WJ,
                    model,
                    leaves,
                    [(object, at), (other, place)].map(|(number, place)| (number, self.objects[number].root, place)),
                )
            };
            *self.known.entry(key).or_insert_with(test)
        };
        others
            .filter_map(|(other, place)| Some((other, (*place)?)))
            .filter(&mut exclude)
            .map(|(other, _)| other)
            .collect()
    }

    /// Whether two objects touch where they are placed.
    fn test(
        pairs: &HashMap<(usize, usize), Vec<PairId>>,
        X_WJ: &mut [Pose],
        model: &Model,
        leaves: &LeafIndex,
        placed: [(usize, JointIndex, ParameterId); 2],
    ) -> bool {
        for (_, root, place) in placed {
            X_WJ[root.at()] = leaves.parameter(place).value;
        }
        let [a, b] = placed.map(|(number, ..)| number);
        let touch = |&id: &PairId| {
            let clearance =
                pair_clearance(&model.collision, id, X_WJ, DistanceQuery::exact(0.0), &mut DVec3::ZERO.clone());
            let is_apart = clearance > 0.0;
            !is_apart || contained(&model.collision, id, X_WJ)
        };
        pairs.get(&(a.min(b), a.max(b))).is_some_and(|pairs| pairs.iter().any(touch))
    }
}
