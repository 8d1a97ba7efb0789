//! `foliate demo`: the embedded scene, explained.

use crate::cli::commands::solve::arguments::SearchArguments;
use crate::cli::commands::solve::record::RecordArguments;
use crate::cli::commands::solve::run;
use crate::cli::commands::solve::{story, summary};
use crate::cli::commands::view::answered::ViewArguments;
use crate::cli::console::loading;
use crate::cli::console::outputs;
use crate::cli::console::print::{Ending, Refusal, print};
use crate::scene::PackagePath;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Solves the embedded scene and prints what happens
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) search: SearchArguments,
    /// Write the path to this file
    #[arg(long, value_name = "PATH.json")]
    out: Option<PathBuf>,
    #[command(flatten)]
    record: RecordArguments,
    #[command(flatten)]
    view: ViewArguments,
}

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    outputs::check([], arguments.out.iter().chain(&arguments.record.record).chain(arguments.view.file()))?;
    let (started, limit) = (Instant::now(), arguments.search.deadline()?);
    let (scene, tables) = match loading::scene("demo", packages, limit, None)? {
        Ok(loaded) => loaded,
        Err(cut) => return cut.tell("demo", started.elapsed(), false),
    };
    let planner = arguments.search.planner(tables)?.time_limit(limit.saturating_sub(started.elapsed()));
    let planner = arguments.record.apply(planner);
    let model = planner.model();
    print(&format!(
        "{}.\n\n\
         Each \"gripper A holds handle B, object C lies on surface D\" is a state; here there are {} of them, joined by {}\n\
         transitions. Every place where a box may lie is a leaf of its own, and so is every way to hold it. A motion stays on one\n\
         leaf, so the boxes change places by way of others: held in both hands, or with one of them at a third place.\n\n",
        scene.description,
        model.graph.states_of_nodes().count(),
        model.graph.transitions.len()
    ));
    let (planner, mut answer) = run::solve(planner, &arguments.search, true)?;
    let _measured = answer.measure_clearance();
    arguments.record.write(&scene, &planner, &answer, &arguments.search)?;
    let report = answer.report();
    let Ok(solution) = &answer.0 else {
        print(&format!("No answer: {} after {} candidates.\n", answer.name(), report.candidates));
        arguments.view.write(&scene, &answer, (packages, print));
        return run::ending(&answer);
    };
    let (path, certificate) = (&solution.path, solution.certificate());
    let improving = report.improvement.as_ref().map_or(Duration::ZERO, |improved| improved.time) + report.timing_time;
    let takes = path.duration().map_or_else(String::new, |seconds| {
        let improving = improving.as_secs_f64();
        format!("The motion takes {seconds:.1} s. Making it so short took {improving:.2} s after the first path was there.\n\n")
    });
    print(&format!(
        "Solved in {:.0} ms: {} extensions were tried, {} configurations on {} leaves were reached.\n\n\
         What the robot does ({} motions):\n{}\n\
         {takes}Proved along every motion, between the samples too: joint limits are kept, all tested pairs of shapes stay at\n\
         least {} apart, and grasps and placements hold to {:.1e} (m, rad).\n\n\
         The same seed gives the same answer on any number of threads. Try another: foliate demo --seed 2\n",
        report.time().as_secs_f64() * 1e3,
        report.candidates,
        report.nodes,
        report.leaves,
        path.segments.len(),
        story::tell(&solution.model, path),
        summary::distance(certificate.min_clearance.unwrap_or_default()),
        certificate.max_residual,
    ));
    if let Some(out) = &arguments.out {
        run::write(out, &scene, solution, &arguments.search)?;
        print(&format!("The path is in {}; prove it again: foliate check {}\n", out.display(), out.display()));
    }
    arguments.view.write(&scene, &answer, (packages, print));
    run::ending(&answer)
}
