//! An answer on a robot: plan, improve for 50 ms, then follow the trajectory at 500 Hz, and open and close hands when it says so.
//!
//! Run with `cargo run --release --example follow_a_trajectory`.

use foliate::components::samples::swap_two_boxes;
use foliate::prelude::*;
use std::error::Error;
use std::time::Duration;

/// What a controller is told 500 times a second.
fn send(_positions: &[f64], _velocities: &[f64]) {}

fn main() -> Result<(), Box<dyn Error>> {
    let planner = Planner::new(swap_two_boxes()?)?.seed(7).improve_time(Duration::from_millis(50));
    let solution = planner.solve_on(1)?;
    let trajectory = solution.trajectory()?;
    println!("{:.2} s in {} segments", trajectory.duration(), trajectory.segments().len());

    // Joints by name, with velocities and accelerations: the last sample is exactly at the end.
    let joints = trajectory.joints_of("arm")?;
    let mut events = trajectory.events().into_iter().peekable();
    let mut fastest = vec![0.0_f64; joints.names().len()];
    for sample in joints.sampled(500.0)? {
        while let Some(event) = events.next_if(|event| event.time <= sample.time) {
            let place = trajectory.pose(event.object, event.time)?.translation;
            let (kind, object, gripper) = (event.kind, event.object, event.gripper);
            println!(
                "{:6.3} s: {kind:?} {object} by {gripper} at {place:.3}, then {:.2} s still",
                event.time, event.dwell
            );
        }
        send(&sample.positions, &sample.velocities);
        fastest.iter_mut().zip(&sample.velocities).for_each(|(fastest, v)| *fastest = fastest.max(v.abs()));
    }
    for (name, fastest) in joints.names().iter().zip(fastest) {
        println!("{name}: at most {fastest:.2} rad/s");
    }
    Ok(())
}
