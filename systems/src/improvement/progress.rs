//! How far an improvement has come, and how it has ended.

use crate::improvement::changes::local_change::LocalChange;
use crate::improvement::proposal::{Attempt, Proposal};
use bevy_ecs::prelude::{Mut, Resource};

/// Counts, and what the path has cost after how much work.
#[derive(Clone, Debug, Default, PartialEq, Resource)]
pub struct Progress {
    /// Rounds of proposals so far.
    pub rounds: u64,
    /// Counted work so far.
    pub work: u64,
    /// Of it, work of searches.
    pub replanning: u64,
    /// Steps that a search may take, a multiple of the first search's.
    pub replanning_steps: u64,
    /// Work and cost at the start and after every round that made the path better.
    pub history: Vec<Milestone>,
    /// Changes that were committed.
    pub changes: Changes,
    /// Set where the improvement has ended.
    pub ending: Option<ImprovementEnding>,
}

/// What the path costs from here on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Milestone {
    /// Counted work until then.
    pub work: u64,
    /// Cost of the path.
    pub cost: f64,
}

/// Changes that were committed, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Shortcuts of one motion.
    pub shortcuts: u64,
    /// Shortcuts of some coordinates.
    pub limb_shortcuts: u64,
    /// Grasp changes whose waypoints were moved.
    pub waypoint_moves: u64,
    /// Leaves that were moved.
    pub leaf_moves: u64,
    /// Stretches that were planned again.
    pub replanned: u64,
}

/// How an improvement has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImprovementEnding {
    /// The work was spent.
    Work,
    /// The deadline passed, the host cancelled, or memory ran out. The round under way counts for nothing.
    Stopped,
}

/// Budgets of searches grow by no more than this.
const MOST_GROWTH: u64 = 32;

impl Progress {
    /// Before the first round.
    #[must_use]
    pub fn new(cost: f64, first_steps: u64) -> Self {
        let history = vec![Milestone { work: 0, cost }];
        Self { replanning_steps: 2 * first_steps.max(4), history, ..Self::default() }
    }

    /// Counts the work of a round. Where searches find nothing they may take longer from then on.
    pub(crate) fn count(&mut self, proposals: &[Mut<'_, Proposal>], first_steps: u64) {
        let mut failed = false;
        for proposal in proposals {
            self.work += proposal.work;
            if let Some(Attempt::Replan { .. }) = proposal.attempt {
                self.replanning += proposal.work;
                failed |= !proposal.is_solved;
            }
        }
        if failed {
            let most = MOST_GROWTH * first_steps.max(4);
            self.replanning_steps = (self.replanning_steps + self.replanning_steps / 4).min(most);
        }
    }
}

impl Changes {
    pub(crate) fn count(&mut self, attempt: Option<&Attempt>) {
        match attempt {
            Some(Attempt::Local(LocalChange::Shortcut(_))) => self.shortcuts += 1,
            Some(Attempt::Local(LocalChange::LimbShortcut)) => self.limb_shortcuts += 1,
            Some(Attempt::Local(LocalChange::WaypointMove)) => self.waypoint_moves += 1,
            Some(Attempt::Local(LocalChange::LeafMove)) => self.leaf_moves += 1,
            Some(Attempt::Replan { .. }) => self.replanned += 1,
            None => {}
        }
    }
}
