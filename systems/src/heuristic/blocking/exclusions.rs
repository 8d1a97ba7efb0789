//! Which placements of two objects exclude each other: tested by their shapes once, then known.

use crate::planning_model::model::Model;
use foliate_components::Pose;
use foliate_components::graph::leaf::{LeafIndex, ParameterId};
use foliate_components::graph::{ConstraintId, ConstraintKind};
use foliate_components::robot::JointIndex;
use foliate_kernels::collision::{PairSet, all_collisions};
use std::collections::HashMap;

/// An object that may rest on what is fixed in the world.
#[derive(Clone, Debug)]
pub(crate) struct Placeable {
    /// Number in the graph.
    pub(crate) object: u32,
    /// Its placement.
    pub(crate) constraint: ConstraintId,
    root: JointIndex,
    /// Its shapes against those of the others, once they are asked for.
    pairs: Option<PairSet>,
}

/// See the module.
#[derive(Clone, Debug, Default)]
pub(crate) struct Exclusions {
    pub(crate) objects: Vec<Placeable>,
    /// By body: the object whose root it is.
    by_body: HashMap<JointIndex, usize>,
    /// By two parameters, the smaller first: whether they exclude each other.
    known: HashMap<(ParameterId, ParameterId), bool>,
    X_WJ: Vec<Pose>,
}

impl Exclusions {
    /// The objects of a model; only shapes on their roots count.
    pub(crate) fn new(model: &Model) -> Self {
        let placeable = |(object, of): (u32, &crate::planning_model::objects::ObjectModel)| {
            let wanted = ConstraintKind::Placement { object, on: None };
            let constraint = model.graph.constraints.iter().position(|c| c.kind == wanted)?;
            Some(Placeable { object, constraint: ConstraintId(constraint as u32), root: of.root?, pairs: None })
        };
        let objects: Vec<_> = (0..).zip(model.objects()).filter_map(placeable).collect();
        let by_body = objects.iter().enumerate().map(|(number, object)| (object.root, number)).collect();
        Self { objects, by_body, known: HashMap::new(), X_WJ: vec![Pose::identity(); model.kinematics.bodies()] }
    }

    /// Of the placements `others` of other objects (`None`: it rests nowhere) those that exclude the placement `at` of an object, by object.
    pub(crate) fn excluded(
        &mut self,
        model: &Model,
        leaves: &LeafIndex,
        (object, at): (usize, ParameterId),
        others: &[Option<ParameterId>],
    ) -> Vec<usize> {
        let key = |other: ParameterId| (at.min(other), at.max(other));
        let of_others = || others.iter().enumerate().filter(|&(other, _)| other != object);
        if !of_others().filter_map(|(_, &other)| other).all(|other| self.known.contains_key(&key(other))) {
            self.test(model, leaves, (object, at), others);
        }
        let excludes = |&(_, other): &(usize, &Option<ParameterId>)| other.is_some_and(|other| self.known[&key(other)]);
        of_others().filter(excludes).map(|(other, _)| other).collect()
    }

    /// Tests a placement of an object against those of all others.
    fn test(
        &mut self,
        model: &Model,
        leaves: &LeafIndex,
        (object, at): (usize, ParameterId),
        others: &[Option<ParameterId>],
    ) {
        let root = self.objects[object].root;
        for (other, place) in others.iter().enumerate() {
            let at_test = if other == object { Some(at) } else { *place };
            let Some(place) = at_test else { continue };
            self.X_WJ[self.objects[other].root.at()] = leaves.parameter(place).value;
        }
        let by_body = &self.by_body;
        let is_other = |body: Option<JointIndex>| body.is_some_and(|body| body != root && by_body.contains_key(&body));
        let between = || model.pairs_between(|a, b| a == Some(root) && is_other(b));
        let pairs = self.objects[object].pairs.get_or_insert_with(between);
        let mut touched = vec![false; others.len()];
        for contact in all_collisions(&model.collision, &self.X_WJ, pairs, 0.0) {
            let (first, second) = model.pair_shapes(contact.pair);
            for shape in [first, second] {
                let body = model.collision.solids()[shape.at()].body;
                body.and_then(|body| by_body.get(&body)).into_iter().for_each(|&other| touched[other] = true);
            }
        }
        for (other, place) in others.iter().enumerate().filter(|&(other, _)| other != object) {
            if let Some(place) = *place {
                self.known.insert((at.min(place), at.max(place)), touched[other]);
            }
        }
    }
}
