//! Foliate in a program of one's own: a problem in, events while it works, a certified path out.
//!
//! Run with `cargo run --release --example embed`.

use foliate::components::samples::swap_two_boxes;
use foliate::systems::events::SearchEvent;
use foliate::{Planner, Solution};
use std::time::Duration;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Any problem will do: `foliate::scene::load_scene` reads one from a file; this one is built in code.
    let (planner, events) = Planner::new(swap_two_boxes()?)?.seed(7).time_limit(Duration::from_secs(30)).events();

    // The host owns the threads. The answer is the same on any number of them.
    let listener = std::thread::spawn(move || {
        events.iter().take_while(|event| !matches!(event, SearchEvent::Solved { .. })).count()
    });
    let Solution { outcome, path, report, .. } = planner.solve_on(2)?;
    drop(planner); // closes the channel

    println!("{} after {} candidates, {} nodes", outcome.name(), report.candidates, report.nodes);
    println!("{} events on the way", listener.join().map_err(|_| "the listener panicked")?);
    let path = path.ok_or("no path")?;
    println!("{} segments, clearance at least {:?} m", path.segments.len(), path.certificate.min_clearance);
    Ok(())
}
