//! The constraints of a leaf besides its attachments, for output: a checker of the path needs them.

use crate::planning_model::graph::support_placement::SupportPlacement;
use crate::planning_model::model::Model;
use foliate_components::Pose;
use foliate_components::graph::leaf::{Leaf, LeafIndex};
use foliate_components::graph::{ConstraintId, ConstraintKind};
use foliate_components::path::PathConstraint;

impl Model {
    /// The constraints that hold along motions on a leaf besides what [`Model::attachments`] says, in the order of the
    /// state's manifold; parameter rows with the leaf's values.
    ///
    /// # Panics
    /// If the leaf is of another model or index.
    #[must_use]
    pub fn path_constraints(&self, leaf: &Leaf, leaves: &LeafIndex) -> Vec<PathConstraint> {
        let state = self.graph.state(leaf.state);
        let value = |constraint: ConstraintId| {
            let position = state.foliation.iter().position(|&c| c == constraint)?;
            Some(leaves.parameter(leaf.parameters[position]).value)
        };
        state.manifold.iter().filter_map(|&constraint| self.path_constraint(constraint, value(constraint))).collect()
    }

    fn path_constraint(&self, id: ConstraintId, value: Option<Pose>) -> Option<PathConstraint> {
        let name = self.graph.constraint(id).name.clone();
        match self.graph.constraint(id).kind {
            ConstraintKind::Placement { object, on } => {
                // Polygons that touch are attachments. A plane is no document, so the file has to say how it is stood on;
                // that the object keeps its place on it follows from its having no attachment.
                let resting = &self.objects().get(object as usize)?.placement_on(on)?.resting;
                let on_plane = matches!(resting, SupportPlacement::Plane { .. }).then(|| resting.constraint(0.0))?;
                Some(PathConstraint { name, constraint: on_plane, argument: None })
            }
            ConstraintKind::JointRest { .. }
            | ConstraintKind::Finger { .. }
            | ConstraintKind::Given { .. }
            | ConstraintKind::Approach { .. }
            | ConstraintKind::Lift { .. }
            | ConstraintKind::WhileHeld { .. } => {
                Some(PathConstraint { name, constraint: self.constraint(id)?, argument: value })
            }
            ConstraintKind::Grasp { .. }
            | ConstraintKind::Pregrasp { .. }
            | ConstraintKind::Preplacement { .. }
            | ConstraintKind::Rest { .. } => None,
        }
    }
}
