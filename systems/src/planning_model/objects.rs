//! The movable objects of a problem: the root joint of each, and where it may rest.
//!
//! [`ModelError`] is here too, since objects are the first part of a model that may fail to build.

use crate::planning_model::graph::attachment_order::root_of;
use crate::planning_model::graph::checks::GraphError;
use crate::planning_model::graph::support_placement::{PlacementOnSupport, SupportPlacement};
use crate::planning_model::problem_tables::UnboundedRoot;
use foliate_components::constraint::{MaskError, PlacementError};
use foliate_components::graph::ConstraintGraph;
use foliate_components::problem::Problem;
use foliate_components::robot::JointIndex;

/// A movable object.
#[derive(Clone, Debug)]
pub struct ObjectModel {
    /// Its free-flyer; none for a part that is fixed in the world and only has joints (doors, drawers).
    pub root: Option<JointIndex>,
    /// What it may rest on, by body; without any, it stays where it is.
    pub resting: Vec<PlacementOnSupport>,
}

impl ObjectModel {
    /// How it rests on a body's supports.
    #[must_use]
    pub fn placement_on(&self, body: Option<JointIndex>) -> Option<&PlacementOnSupport> {
        self.resting.iter().find(|place| place.on == body)
    }
}

/// Why a problem cannot be planned for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum ModelError {
    #[error(transparent)]
    Graph(#[from] GraphError),
    #[error(transparent)]
    UnboundedRoot(#[from] UnboundedRoot),
    #[error("object `{object}`: {source}")]
    Placement { object: String, source: PlacementError },
    #[error("object `{object}`: its contact surfaces are on a link that moves against its root")]
    SurfacesOffRoot { object: String },
    #[error("handle `{handle}`: {source}")]
    Grasp { handle: String, source: MaskError },
}

pub(crate) fn object_models(problem: &Problem, graph: &ConstraintGraph) -> Result<Vec<ObjectModel>, ModelError> {
    let (robot, options) = (&problem.robot, &problem.graph);
    let model = |object: &foliate_components::problem::ObjectOptions| {
        let name = || robot.parts[object.part.at()].name.clone();
        let Some(root) = root_of(robot, object.part) else {
            return Ok(ObjectModel { root: None, resting: Vec::new() });
        };
        let resting = PlacementOnSupport::of_object(robot, options, object)
            .map_err(|source| ModelError::Placement { object: name(), source })?;
        let off_root = |place: &PlacementOnSupport| match &place.resting {
            SupportPlacement::Surfaces(lying) => lying.object_joint() != Some(root),
            SupportPlacement::Plane { .. } => false,
        };
        if resting.iter().any(off_root) {
            return Err(ModelError::SurfacesOffRoot { object: name() });
        }
        Ok(ObjectModel { root: Some(root), resting })
    };
    graph.objects.iter().map(model).collect()
}
