//! What a leaf demands besides its attachments, for output: whoever proves a path again has to know it.

use crate::model::Model;
use crate::resting::Resting;
use foliate_components::graph::{ConstraintId, ConstraintKind};
use foliate_components::leaf::{Leaf, LeafIndex};
use foliate_components::path::PathConstraint;

impl Model {
    /// The constraints that hold along motions on a leaf besides what [`Model::attachments`] says, in the order of the
    /// state's manifold; parameter rows with the leaf's values.
    #[must_use]
    pub fn demands(&self, leaf: &Leaf, leaves: &LeafIndex) -> Vec<PathConstraint> {
        let manifold = &self.graph.state(leaf.state).manifold;
        manifold.iter().filter_map(|&constraint| self.demand(constraint, leaf, leaves)).collect()
    }

    fn demand(&self, id: ConstraintId, leaf: &Leaf, leaves: &LeafIndex) -> Option<PathConstraint> {
        let name = self.graph.constraint(id).name.clone();
        match self.graph.constraint(id).kind {
            ConstraintKind::Placement { object, on } => {
                // Polygons that touch are attachments. A plane is no document, so the file has to say how it is stood on;
                // that the object keeps its place on it is told by its hanging on nothing.
                let resting = &self.objects().get(object as usize)?.resting_on(on)?.resting;
                let constraint = matches!(resting, Resting::Plane { .. }).then(|| resting.constraint(0.0))?;
                Some(PathConstraint { name, constraint, argument: None })
            }
            ConstraintKind::Given { .. } | ConstraintKind::JointRest { .. } => {
                let position = self.graph.state(leaf.state).foliation.iter().position(|&c| c == id);
                let argument = position.map(|position| leaves.parameter(leaf.parameters[position]).value);
                Some(PathConstraint { name, constraint: self.constraint(id)?, argument })
            }
            ConstraintKind::Grasp { .. }
            | ConstraintKind::Pregrasp { .. }
            | ConstraintKind::Preplacement { .. }
            | ConstraintKind::Rest { .. } => None,
        }
    }
}
