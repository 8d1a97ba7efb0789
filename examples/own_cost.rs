//! A cost of the host's own: the first joint of the arm is expensive to move, and a grasp costs three seconds.
//!
//! Run with `cargo run --release --example own_cost`.

use foliate::components::path::events;
use foliate::components::samples::swap_two_boxes;
use foliate::prelude::*;
use foliate::systems::improvement::PathCost;
use foliate::systems::planning_model::Model;
use std::error::Error;

/// Radians of all joints, the first one counted `weight` times.
#[derive(Debug)]
struct SpareTheFirstJoint {
    weight: f64,
}

impl PathCost for SpareTheFirstJoint {
    fn name(&self) -> &'static str {
        "weighted radians"
    }

    fn way(&self, model: &Model, a: &[f64], b: &[f64]) -> f64 {
        // Numbers of the boxes come behind those of the arm and follow from them.
        let arm = model.problem.robot.joints.iter().filter(|joint| joint.name.starts_with("arm/")).count();
        let travel = |i: usize| (b[i] - a[i]).abs() * if i == 0 { self.weight } else { 1.0 };
        (0..arm).map(travel).sum()
    }

    fn motion(&self, model: &Model, knots: &[&[f64]]) -> f64 {
        knots.windows(2).map(|pair| self.way(model, pair[0], pair[1])).sum()
    }

    fn grasp_change(&self) -> f64 {
        3.0
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    for weight in [1.0, 10.0] {
        let planner = Planner::new(swap_two_boxes()?)?.seed(3).cost(SpareTheFirstJoint { weight });
        let solution = planner.solve()?;
        let knots = || solution.path.segments.iter().flat_map(|segment| &segment.knots);
        let turned: f64 = knots().zip(knots().skip(1)).map(|(a, b)| (b[0] - a[0]).abs()).sum();
        let improvement = solution.report.improvement.as_ref().ok_or("the path was not improved")?;
        println!(
            "weight {weight}: {} {:.1} -> {:.1}, {} grasps and releases; the first joint turns {turned:.2} rad",
            improvement.cost,
            improvement.first_cost,
            improvement.final_cost,
            events(&solution.path).len()
        );
    }
    Ok(())
}
