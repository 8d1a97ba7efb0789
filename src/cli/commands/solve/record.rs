//! `--record` of every command that searches: what the search did, as a file, whatever it found.

use crate::Planner;
use crate::cli::commands::solve::answer::Answer;
use crate::cli::commands::solve::arguments::SearchArguments;
use crate::cli::console::print::{Refusal, say};
use crate::path_file::{PathContext, save};
use crate::recording::Recording;
use crate::scene::Scene;
use std::path::PathBuf;

/// Whether the search is recorded, and where.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct RecordArguments {
    /// Write what the search did to this file, also where it finds nothing: its roadmap, what became of candidates, which shapes collided,
    /// the path
    #[arg(long, value_name = "FILE.search")]
    pub record: Option<PathBuf>,
    /// Largest size of that file, MiB; of a roadmap that is larger the first nodes are kept
    #[arg(long, value_name = "N", default_value_t = 16, requires = "record")]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=256))]
    record_limit: u16,
}

impl RecordArguments {
    /// A planner that keeps what is to be recorded.
    pub(crate) fn apply(&self, planner: Planner) -> Planner {
        match self.record {
            Some(_) => planner.record_within(u64::from(self.record_limit) << 20),
            None => planner,
        }
    }

    /// Writes the file, where one is asked for, with the models that live only in the program beside it. What it leaves out is said.
    pub(crate) fn write(
        &self,
        scene: &Scene,
        planner: &Planner,
        answer: &Answer,
        arguments: &SearchArguments,
    ) -> Result<(), Refusal> {
        let Some(out) = &self.record else { return Ok(()) };
        let models = save::model_names(scene, out).map_err(|e| Refusal(e.to_string()))?;
        let context = PathContext {
            problem: &planner.model().problem,
            graph: &answer.model().graph,
            models: &models,
            seed: arguments.seed,
            scheduler: &arguments.scheduler,
            simd: arguments.tuning.level.name(),
        };
        let recording = Recording::of(&context, &answer.0);
        recording.save(out).map_err(|e| Refusal(e.to_string()))?;
        if let Some(left_out) = recording.left_out() {
            say(&format!("{}: {left_out}\n", out.display()));
        }
        Ok(())
    }
}
