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
    pub fn demands(&self, leaf: &Leaf, _leaves: &LeafIndex) -> Vec<PathConstraint> {
        let manifold = &self.graph.state(leaf.state).manifold;
        manifold.iter().filter_map(|&constraint| self.demand(constraint)).collect()
    }

    fn demand(&self, id: ConstraintId) -> Option<PathConstraint> {
        let constraint = self.graph.constraint(id);
        match constraint.kind {
            ConstraintKind::Placement { object } => {
                // Polygons that touch are attachments. A plane is no document, so the file has to say how it is stood on;
                // that the object keeps its place on it is told by its hanging on nothing.
                let resting = self.objects().get(object as usize)?.resting.as_ref()?;
                let on_plane = matches!(resting, Resting::Plane { .. }).then(|| resting.constraint(0.0))?;
                Some(PathConstraint { name: constraint.name.clone(), constraint: on_plane, argument: None })
            }
            ConstraintKind::Grasp { .. }
            | ConstraintKind::Pregrasp { .. }
            | ConstraintKind::Preplacement { .. }
            | ConstraintKind::Rest { .. } => None,
        }
    }
}
