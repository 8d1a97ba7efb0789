//! A scheduler that listens: transitions are drawn by what has succeeded so far, compared with `mrrt` on the same seeds.
//!
//! P0 §III-A proposes to hand a task planner what the geometry learns (how often an action can be projected, how often it
//! arrives, what blocks it) so that it may refine which edges it selects while the search runs. Here the task planner is one
//! system. It runs between Commit, which counts, and the next Select, which draws by `Weight`:
//!
//! * A transition's weight becomes the graph's own times its success rate. The rate starts at a half and trusts its counts
//!   only after about eight attempts, so that an early failure decides nothing.
//! * No weight falls below a tenth of the graph's: what fails now may be the only way once an object has moved.
//! * Loops keep the graph's weight. They nearly always succeed and lead to no new leaf; by success alone they would win.
//!
//! The counts are components, and counts are all that it uses: no clock, no random number, so the same seed gives the
//! same roadmap on any number of threads.
//!
//! Whether it helps depends on the problem. Sums of candidates until solved, seeds 1 to 10, all solved: 12112 became 9696 on
//! `baxter-case4` and 3632 became 1888 on `pr2-manipulation-kitchen`, but 2496 became 3856 on `ur3-spheres`; the median
//! times rose on all three (212 to 238 ms, 796 to 939 ms, 254 to 533 ms), since what succeeds leads to long motions, which
//! are dear to certify. So it is an example and no shipped scheduler.
//!
//! Run with `cargo run --release --example adaptive_scheduler`.

use bevy_ecs::prelude::*;
use foliate::components::graph::{TransitionId, TransitionKind};
use foliate::components::outcome::{Prior, TransitionStatistics};
use foliate::components::samples::swap_two_boxes;
use foliate::planner::outcome_name;
use foliate::schedulers::{Scheduler, mrrt::Mrrt};
use foliate::systems::exploration::entities::Weight;
use foliate::systems::planning_model::PlanningModel;
use foliate::systems::schedule::SearchSet;
use foliate::{Planner, Report};

/// The rate that is assumed before anything was tried, and how many attempts it takes to change that mind.
const PRIOR: Prior = Prior { successes: 4.0, attempts: 8.0 };

/// The smallest part of the graph's weight that a transition keeps.
const FLOOR: f64 = 0.1;

/// `mrrt`, with weights that follow success.
pub struct Adaptive;

impl Scheduler for Adaptive {
    fn name(&self) -> &'static str {
        "adaptive"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        let mut schedule = Mrrt.schedule(world);
        schedule.add_systems(follow_success.after(SearchSet::Commit).before(SearchSet::Connect));
        schedule
    }
}

/// The one system: counts in, weights out.
fn follow_success(
    model: Res<'_, PlanningModel>,
    mut transitions: Query<'_, '_, (&TransitionId, &TransitionStatistics, &mut Weight)>,
) {
    for (id, statistics, mut weight) in &mut transitions {
        let transition = model.graph.transition(*id);
        if transition.kind != TransitionKind::Loop {
            weight.0 = transition.weight * statistics.success_rate(PRIOR).max(FLOOR);
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seeds = 1..=10;
    let mut sums = Vec::new();
    for name in ["mrrt", "adaptive"] {
        let planner = Planner::new(swap_two_boxes()?)?;
        let mut planner = if name == "adaptive" { planner.scheduler(Adaptive) } else { planner.scheduler(Mrrt) };
        println!("{name}:");
        let mut sum = 0;
        for seed in seeds.clone() {
            planner = planner.seed(seed);
            let answer = planner.solve();
            let report = Report::of(&answer);
            println!("  seed {seed:2}: {} after {:5} candidates", outcome_name(&answer), report.candidates);
            sum += report.candidates;
            if seed == *seeds.end() {
                // What the system saw of the last search.
                for row in &report.funnel {
                    let in_the_way = row.blocking_parts.first();
                    let in_the_way = in_the_way.map_or(String::new(), |(a, b, n)| format!(", {a} meets {b} {n} times"));
                    println!(
                        "    {:42} {:4} tried, {:3.0} % arrive, {:3.0} % project{in_the_way}",
                        row.transition,
                        row.statistics.attempts,
                        100.0 * row.success_rate,
                        100.0 * row.projection_rate
                    );
                }
            }
        }
        sums.push(sum);
    }
    println!("candidates in all: mrrt {}, adaptive {}", sums[0], sums[1]);
    Ok(())
}
