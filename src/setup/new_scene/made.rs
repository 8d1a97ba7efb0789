//! The steps from models to a scene.

use crate::scene::{PackagePath, UpAxis, read_model};
use crate::setup::collision_matrix::{MatrixSettings, collision_matrix};
use crate::setup::error::SetupError;
use crate::setup::grippers::grippers;
use crate::setup::handles::distinct;
use crate::setup::new_scene::holding::hold;
use crate::setup::new_scene::own_roots;
use crate::setup::new_scene::read_objects::objects;
use crate::setup::new_scene::request::{NewScene, WrittenScene};
use crate::setup::new_scene::setting::Setting;
use foliate_components::Pose;
use foliate_components::robot::{PartKind, PartPlacement, RootJoint};

/// Makes a scene: finds what its models hold, lays the objects on the table where the robot can take them, and plans to see that it does.
///
/// # Errors
/// A model that cannot be read; a robot without gripper; an object that cannot be held, or that is out of reach everywhere on the table.
pub fn new_scene(request: &NewScene, packages: &PackagePath) -> Result<WrittenScene, SetupError> {
    let mut read = read_model(&request.robot, request.srdf.as_deref(), UpAxis::AsWritten, packages)?;
    let mut placement = PartPlacement::new("robot", PartKind::Robot, RootJoint::Fixed, Pose::identity());
    placement.joint_bounds = own_roots::bounds(&read.model);
    let robot = read.compose_placed(placement.clone())?;
    let matrix = collision_matrix(&robot, MatrixSettings { seed: request.seed, ..MatrixSettings::default() });
    let found = grippers(&robot, &request.grippers, &read.model.end_effectors)?;
    let mut objects = objects(request, packages, &mut read.warnings)?;
    let ways = hold(request, &mut objects, &found)?;
    let setting = Setting {
        request,
        packages,
        model: &read.model,
        robot: &robot,
        joint_bounds: &placement.joint_bounds,
        matrix: &matrix,
        grippers: &found,
    };
    let (text, solved) = setting.written(&objects, &ways)?;
    let left_out = matrix.ignored().count();
    Ok(WrittenScene {
        text,
        objects: objects.iter().map(|o| (o.name.clone(), distinct(&o.handles).len(), o.faces.len())).collect(),
        pairs: (left_out, matrix.pairs.len()),
        grippers: found,
        solved,
        warnings: read.warnings,
    })
}
