//! How far a gripper can get from the first joint of its robot, and which grasps are farther away: a bound by the lengths of links.

use crate::goals::impossible::moves::{Asked, places_on};
use crate::planning_model::graph::support_placement::SupportPlacement;
use crate::planning_model::model::Model;
use foliate_components::constraint::{Frame, Mask, Polygon};
use foliate_components::infeasibility::RuledOut;
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex, JointType, Robot};
use glam::DVec3;

/// Beyond the tolerances of starts and constraints, metres.
const SLACK: f64 = 1e-3;

/// A ball in the world in which a gripper always is.
struct Ball {
    /// The joint in its middle.
    joint: JointIndex,
    middle: DVec3,
    radius: f64,
}

/// Why a grasp is out of reach where an object is asked, whatever the joints do. Nothing is said of robots that drive, and of grasps that
/// leave a translation free.
pub(super) fn too_far(
    model: &Model,
    (gripper, handle): (GripperIndex, HandleIndex),
    object: usize,
    place: &Asked,
) -> Option<RuledOut> {
    let robot = &model.problem.robot;
    let mask = Mask(robot.handles[handle.at()].mask).of_grasp().ok()?;
    if mask.0[..3] != [true; 3] {
        return None;
    }
    let handle = &robot.handles[handle.at()];
    let handle = Frame::on_link(robot, handle.link, &handle.link_from_handle);
    if handle.joint != model.objects()[object].root {
        return None;
    }
    let ball = ball_of(robot, gripper)?;
    let handle = handle.joint_from_frame.translation;
    let distance = match place {
        Asked::At(pose) => ball.middle.distance(pose.transform_point(handle)),
        Asked::On(supports) => {
            let places = places_on(model, object, supports);
            let distances = places.iter().map(|place| {
                let SupportPlacement::Surfaces(lying) = &place.resting else { return None };
                let from_support = lying.supports.iter().map(|support| distance_to(support, ball.middle));
                let from_handle = lying.object.iter().flat_map(corners).map(|corner| corner.distance(handle));
                let nearest = from_support.min_by(f64::total_cmp)?;
                let farthest = from_handle.max_by(f64::total_cmp)?;
                place.on.is_none().then_some(nearest - farthest - lying.margin.abs())
            });
            let distances: Option<Vec<f64>> = distances.collect();
            distances?.into_iter().min_by(f64::total_cmp)?
        }
    };
    let tolerance = model.problem.start_tolerance.distance + SLACK;
    let joint = robot.joints[ball.joint.at()].name.clone();
    (distance > ball.radius + tolerance).then_some(RuledOut::TooFar { joint, distance, longest: ball.radius })
}

/// The sum of the distances from joint to joint, from the gripper to the first joint that moves.
fn ball_of(robot: &Robot, gripper: GripperIndex) -> Option<Ball> {
    let gripper = &robot.grippers[gripper.at()];
    let frame = Frame::on_link(robot, gripper.link, &gripper.link_from_gripper);
    let (mut joint, mut radius) = (frame.joint?, frame.joint_from_frame.translation.length());
    loop {
        let record = &robot.joints[joint.at()];
        radius += match record.motion {
            JointType::Revolute { .. } => 0.0,
            JointType::Prismatic { .. } => record.lower[0].abs().max(record.upper[0].abs()),
            JointType::Planar | JointType::FreeFlyer => return None,
        };
        let offset = record.parent_from_joint.translation;
        match record.parent {
            Some(parent) => (joint, radius) = (parent, radius + offset.length()),
            None => return radius.is_finite().then_some(Ball { joint, middle: offset, radius }),
        }
    }
}

/// The corners of a polygon on its body, metres.
fn corners(polygon: &Polygon) -> impl Iterator<Item = DVec3> + '_ {
    polygon
        .vertices
        .iter()
        .map(|corner| polygon.frame.joint_from_frame.transform_point(DVec3::new(0.0, corner.x, corner.y)))
}

/// How far a point is at least from a polygon that is fixed in the world: the distance from the box around it, in its own axes.
fn distance_to(polygon: &Polygon, point: DVec3) -> f64 {
    let local = polygon.frame.joint_from_frame.inverse().transform_point(point);
    let beyond = |value: f64, low: f64, high: f64| (low - value).max(value - high).max(0.0);
    let range = |along: fn(&glam::DVec2) -> f64| {
        let values = || polygon.vertices.iter().map(along);
        (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
    };
    let ((low_y, high_y), (low_z, high_z)) = (range(|corner| corner.x), range(|corner| corner.y));
    DVec3::new(local.x, beyond(local.y, low_y, high_y), beyond(local.z, low_z, high_z)).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::Pose;
    use foliate_components::samples::models::{fixed_robot, seven_axis_arm};
    use rand::SeedableRng;

    #[test]
    fn no_configuration_takes_the_gripper_out_of_the_ball() {
        let arm = seven_axis_arm();
        let mount = Pose::from_translation(DVec3::new(0.3, -0.2, 0.5));
        let robot = Robot::compose(&[(&arm, fixed_robot("arm", mount))]).unwrap();
        let ball = ball_of(&robot, GripperIndex(0)).unwrap();
        assert!(ball.radius > 1.1 && ball.radius < 1.4, "{}", ball.radius);
        let gripper = &robot.grippers[0];
        let frame = Frame::on_link(&robot, gripper.link, &gripper.link_from_gripper);
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let kinematics = foliate_kernels::kinematics::Kinematics::new(&robot);
        let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
        let (mut q, mut farthest) = (robot.space.neutral(), 0.0_f64);
        for _ in 0..10_000 {
            robot.space.random(&mut rng, &mut q);
            kinematics.forward(&q, &mut X_WJ);
            let at = (X_WJ[frame.joint.unwrap().at()] * frame.joint_from_frame).translation;
            farthest = farthest.max(at.distance(ball.middle));
        }
        assert!(farthest <= ball.radius && farthest > 0.7 * ball.radius, "{farthest} of {}", ball.radius);
    }
}
