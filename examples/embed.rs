//! Foliate in a program of one's own: a problem in, events while it works, a certified path out.
//!
//! Run with `cargo run --release --example embed`.

use foliate::components::samples::swap_two_boxes;
use foliate::prelude::*;
use std::time::Duration;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Any problem will do: `Scene::from_file` reads one; this one is built in code. Joints and parts are set by name.
    let mut problem = swap_two_boxes()?;
    problem.set_start("arm/w2", 0.2)?;
    let (planner, events) = Planner::new(problem)?.seed(7).time_limit(Duration::from_secs(30)).events();

    // The host owns the threads. The answer is the same on any number of them.
    let listener = std::thread::spawn(move || {
        events.iter().take_while(|told| !matches!(told.event, SearchEvent::Solved { .. })).count()
    });
    let answer = planner.solve_on(2);
    drop(planner); // closes the channel
    println!("{} events on the way", listener.join().map_err(|_| "the listener panicked")?);

    match answer {
        Ok(Solution { path, report, .. }) => {
            println!("solved after {} candidates, {} nodes", report.candidates, report.nodes);
            println!("{} segments, clearance at least {:?} m", path.segments.len(), path.certificate.min_clearance);
        }
        Err(NoSolution { reason: NoSolutionReason::TimeLimit, report, .. }) => {
            println!("no time was left after {} candidates", report.candidates);
        }
        Err(other) => return Err(other.into()),
    }
    Ok(())
}
