//! A constraint of one's own: the planner swaps two boxes and never tilts its hand farther than half a right angle from
//! straight down, as if the boxes were open and full.
//!
//! Run with `cargo run --release --example own_constraint`.

use foliate::components::Pose;
use foliate::components::constraint::{Constraint, Curvature, Custom, Frame, Function, Gradient, Row};
use foliate::components::problem::NamedConstraint;
use foliate::components::samples::swap_two_boxes;
use foliate::{Planner, Solution};
use glam::DVec3;
use std::sync::Arc;
use std::time::Duration;

/// The x axis of a frame points down, give or take an angle: one row, cos(angle to straight down) − cos(largest angle),
/// which may not be negative.
#[derive(Debug)]
struct PointsDown {
    frame: Frame,
    cosine: f64,
}

impl Function for PointsDown {
    fn name(&self) -> &str {
        "the hand points down"
    }

    fn frames(&self) -> &[Frame] {
        std::slice::from_ref(&self.frame)
    }

    fn rows(&self) -> &[Row] {
        &[Row::Inequality]
    }

    fn value(&self, world_from_frame: &[Pose], values: &mut [f64]) {
        values[0] = DVec3::NEG_Z.dot(world_from_frame[0].rotation * DVec3::X) - self.cosine;
    }

    /// The axis a turns with the frame, a′ = ω × a, so the row changes by (a × −z)·ω. Moving the frame's origin changes
    /// nothing.
    fn gradient(&self, world_from_frame: &[Pose], gradients: &mut [Gradient]) {
        let axis = world_from_frame[0].rotation * DVec3::X;
        gradients[0] = Gradient { linear: DVec3::ZERO, angular: axis.cross(DVec3::NEG_Z) };
    }

    /// |a″| = |α × a + ω × (ω × a)| ≤ |α| + |ω|²: this is what lets whole motions be certified, not only their knots.
    fn curvature(&self) -> Option<Curvature> {
        Some(Curvature { lipschitz: 1.0, bend: 1.0 })
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut problem = swap_two_boxes()?;
    let hand = problem.robot.gripper("arm/hand").ok_or("the arm has a hand")?;
    let hand = &problem.robot.grippers[hand.at()];
    let frame = Frame::on_link(&problem.robot, hand.link, &hand.link_from_gripper);
    let steepest = std::f64::consts::FRAC_PI_4;
    let own = Custom(Arc::new(PointsDown { frame, cosine: steepest.cos() }));
    let tilt = own.clone();

    let constraint = NamedConstraint { name: own.0.name().into(), constraint: Constraint::Custom(own) };
    problem.graph.everywhere.push(problem.graph.constraints.len() as u32);
    problem.graph.constraints.push(constraint);

    let robot = problem.robot.clone();
    let planner = Planner::new(problem)?.seed(7).time_limit(Duration::from_secs(60));
    let Solution { path, report, .. } = planner.solve_on(2)?;
    println!("solved after {} candidates, {} nodes", report.candidates, report.nodes);

    // The certificate says that it holds between the knots too; many points in between show it.
    let kinematics = foliate::kernels::kinematics::Kinematics::new(&robot);
    let (mut q, mut bodies) = (robot.space.neutral(), vec![Pose::identity(); kinematics.bodies()]);
    let (mut knots, mut worst) = (0, f64::INFINITY);
    for segment in &path.segments {
        knots += segment.knots.len();
        for pair in segment.knots.windows(2) {
            for sample in 0..=10 {
                robot.space.interpolate(&pair[0], &pair[1], f64::from(sample) / 10.0, &mut q);
                kinematics.forward(&q, &mut bodies);
                worst = worst.min(foliate::kernels::constraints::custom::value(&tilt, &bodies)[0]);
            }
        }
    }
    let steepest_seen = (worst + steepest.cos()).min(1.0).acos().to_degrees();
    println!("{} segments, {knots} knots; the hand tilts by at most {steepest_seen:.2} degrees", path.segments.len());
    if worst < -path.certificate.path_tolerance {
        return Err("the hand tilts farther than it may".into());
    }
    Ok(())
}
