//! The role of each candidate of a step.

use foliate_components::candidate::Candidate;
use foliate_systems::schedule::StepCounter;

/// Of so many candidates one is an extension as `mrrt` makes them, so that nothing is given up for good.
const ORDINARY: u64 = 64;

/// Among the first so many candidates every other one is left out: most problems need few grasps, and further lazy extensions
/// are wasted.
const FIRST: u64 = 32;

/// A candidate's number among all candidates of the search, in a pool of `pool`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CandidateRole(u64);

impl CandidateRole {
    /// The role of a candidate in the next step.
    #[must_use]
    pub fn of(step: &StepCounter, pool: usize, candidate: &Candidate) -> Self {
        Self(step.step * pool as u64 + u64::from(candidate.index))
    }

    /// Whether it is left to the rules of `mrrt`.
    #[must_use]
    pub fn is_ordinary(self) -> bool {
        self.0 % ORDINARY == ORDINARY / 2
    }

    /// Whether it is left out.
    #[must_use]
    pub fn rests(self) -> bool {
        self.0 < FIRST && self.0 % 2 == 1
    }
}
