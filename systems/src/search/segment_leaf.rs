//! The leaf of a segment as its path has it: what the first knot and the written constraints say.
//!
//! A checker of a path file reads the leaf from there, so that what is proved about it is proved about the path as it is written.

use crate::planning_model::graph::attachment_order::pose_on_carrier;
use crate::planning_model::leg_program::LegProgram;
use crate::planning_model::model::Model;
use crate::planning_model::state_classification::parameters_of;
use foliate_components::Pose;
use foliate_components::candidate::LegParameter;
use foliate_components::graph::leaf::{LeafIndex, Parameter};
use foliate_components::graph::{ConstraintId, ConstraintKind};
use foliate_components::path::Segment;
use foliate_kernels::kinematics::RigidAttachment;

/// What carries each object along a segment, and its pose on the carrier at the first knot.
pub(crate) fn attachments_as_written(model: &Model, segment: &Segment) -> Vec<RigidAttachment> {
    let X_WJ = poses_at_start(model, segment);
    let parameters = parameters_of(model, segment.state, &segment.knots[0], &X_WJ);
    let mut rigid_attachments =
        model.rigid_attachments(segment.state, |constraint| parameters.iter().find(|p| p.constraint == constraint));
    for rigid_attachment in &mut rigid_attachments {
        rigid_attachment.X_CO = pose_on_carrier(rigid_attachment.object, rigid_attachment.carrier, &X_WJ);
    }
    rigid_attachments
}

/// The right-hand sides of the rows that keep a segment on its leaf: the values that its written constraints have, and those of
/// the first knot.
pub(crate) fn arguments_as_written(model: &Model, segment: &Segment, interior: &LegProgram) -> Vec<Pose> {
    let X_WJ = poses_at_start(model, segment);
    let written = |id: ConstraintId| {
        let constraint = model.graph.constraint(id);
        match constraint.kind {
            ConstraintKind::JointRest { .. } | ConstraintKind::Given { .. } | ConstraintKind::Lift { .. } => {
                segment.constraints.iter().find(|written| written.name == constraint.name)?.argument
            }
            _ => None,
        }
    };
    let parameter = |at_start: Parameter| {
        LegParameter::Fresh(Parameter { value: written(at_start.constraint).unwrap_or(at_start.value), ..at_start })
    };
    let at_start = parameters_of(model, segment.state, &segment.knots[0], &X_WJ);
    let parameters: Vec<_> = at_start.into_iter().map(parameter).collect();
    interior.arguments(model, &LeafIndex::default(), segment.state, &parameters, None)
}

fn poses_at_start(model: &Model, segment: &Segment) -> Vec<Pose> {
    model.kinematics.poses(&segment.knots[0])
}
