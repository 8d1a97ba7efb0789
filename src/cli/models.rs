//! `foliate models`: which published robots are at hand; fetches them.

use super::{Ending, Refusal};

/// Tells which published robot models are at hand
#[derive(clap::Args)]
pub(crate) struct Arguments {}

pub(crate) fn run(_arguments: &Arguments) -> Result<Ending, Refusal> {
    Ok(Ending::Done)
}
