//! A search scheduler of one's own, composed from Foliate's systems: it watches what succeeds and steers effort there.
//!
//! P0 §III-A asks for feedback during the search: how often a transition's projections succeed, what blocks its motions.
//! Both are components on the transitions' entities. `Curious` adds one system that reads them after every step and
//! reweights the transitions, so that hopeless ones are tried less (but never given up).
//!
//! Run with `cargo run --release --example own_scheduler`.

use bevy_ecs::prelude::*;
use foliate::components::outcome::TransitionStatistics;
use foliate::components::samples::swap_two_boxes;
use foliate::planner::outcome_name;
use foliate::schedulers::{Scheduler, mrrt::Mrrt};
use foliate::systems::exploration::entities::Weight;
use foliate::systems::schedule::SearchSet;
use foliate::{Planner, Report};

/// `mrrt`, with weights that follow success.
struct Curious;

impl Scheduler for Curious {
    fn name(&self) -> &'static str {
        "curious"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        let mut schedule = Mrrt.schedule(world);
        schedule.add_systems(follow_success.in_set(SearchSet::Conclude));
        schedule
    }
}

/// Laplace's estimate of the success rate, never below a tenth. It depends on counts alone, so the search stays
/// deterministic.
fn follow_success(mut transitions: Query<'_, '_, (&TransitionStatistics, &mut Weight)>) {
    for (statistics, mut weight) in &mut transitions {
        let kept = (statistics.reached + statistics.partial) as f64;
        weight.0 = ((kept + 1.0) / (statistics.attempts as f64 + 2.0)).max(0.1);
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (name, planner) in [
        ("mrrt", Planner::new(swap_two_boxes()?)?.scheduler(Mrrt)),
        ("curious", Planner::new(swap_two_boxes()?)?.scheduler(Curious)),
    ] {
        let answer = planner.seed(3).solve();
        let report = Report::of(&answer);
        println!("{name}: {} after {} candidates", outcome_name(&answer), report.candidates);
        for row in &report.funnel {
            let s = &row.statistics;
            println!(
                "  {:45} tried {:4}, reached {:4}, kept in part {:4}",
                row.transition, s.attempts, s.reached, s.partial
            );
        }
    }
    Ok(())
}
