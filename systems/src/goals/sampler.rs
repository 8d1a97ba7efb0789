//! The goals of a problem that leave something free, as one resource: when to draw again, and what to say if nothing was
//! found.

use crate::events::StopSignal;
use crate::goals::region::{MOST_TOLD, Region, Site};
use crate::planning_model::model::{Model, PlanningModel};
use crate::planning_model::state_classification::Feasible;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::Resource;
use foliate_components::graph::StateId;
use foliate_components::infeasibility::{GoalFailure, GoalFailureKind, Infeasibility};
use foliate_components::outcome::GoalStatistics;
use foliate_components::problem::Goal;

/// Tries before the first step, and at most as many as the settings allow in all.
const FIRST_TRIES: u32 = 512;

/// Tries in a later step.
pub(crate) const LATER_TRIES: u32 = 128;

/// The goals of a search that leave something free, and how far each has been looked into.
#[derive(Clone, Debug, Default, Resource)]
pub struct GoalSampler {
    /// The start, from which what is not asked for is kept.
    start: Vec<f64>,
    pub(crate) regions: Vec<Region>,
    statistics: GoalStatistics,
    /// The step at which more configurations are drawn.
    next: u64,
}

impl GoalSampler {
    /// The partial goals of a problem, for a search that starts at `start`; they are looked for in the states that `may_reach` accepts.
    #[must_use]
    pub fn new(model: &Model, settings: &SearchSettings, start: &[f64], may_reach: impl Fn(StateId) -> bool) -> Self {
        let regions = model.problem.goals.iter().enumerate().filter_map(|(number, goal)| match goal {
            Goal::Configuration(_) => None,
            Goal::Partial(goal) => Some(Region::new(model, number, goal, &may_reach)),
        });
        Self {
            start: start.to_vec(),
            regions: regions.collect(),
            statistics: GoalStatistics::default(),
            next: settings.goal_interval,
        }
    }

    /// Whether the problem has no goal that leaves something free.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.regions.is_empty()
    }

    /// What became of the tries so far.
    #[must_use]
    pub fn statistics(&self) -> &GoalStatistics {
        &self.statistics
    }

    /// Why no partial goal will be sampled any more: all of them contradict themselves or have had their tries. `None`
    /// while one is open, and where the problem has no such goal.
    #[must_use]
    pub fn given_up(&self, model: &Model, settings: &SearchSettings) -> Option<Infeasibility> {
        let is_open = |region: &Region| region.is_possible() && region.tries < settings.goal_tries;
        if self.regions.is_empty() || self.regions.iter().any(is_open) {
            return None;
        }
        Some(Infeasibility::GoalsNotFound(self.regions.iter().map(|region| self.failure(model, region)).collect()))
    }

    /// The first tries, before the first step.
    pub fn draw_first(
        &mut self,
        model: &mut PlanningModel,
        settings: &SearchSettings,
        stop: &StopSignal,
    ) -> Vec<Feasible> {
        self.draw(model, settings, stop, FIRST_TRIES)
    }

    /// At most [`SearchSettings::goal_samples`] configurations of every goal, found in at most `tries` tries.
    pub(crate) fn draw(
        &mut self,
        model: &mut PlanningModel,
        settings: &SearchSettings,
        stop: &StopSignal,
        tries: u32,
    ) -> Vec<Feasible> {
        let mut found = Vec::new();
        let Self { start, regions, statistics, .. } = self;
        for region in regions {
            found.extend(region.draw(model, settings, stop, start, tries, statistics));
        }
        found
    }

    /// Whether this step draws, and when the next one does: twice as late each time, since every goal is a tree that
    /// shares the search's effort.
    pub(crate) fn is_due(&mut self, settings: &SearchSettings, step: u64, goals: usize) -> bool {
        if goals == 0 {
            return true;
        }
        let due = settings.goal_interval > 0 && step >= self.next;
        if due {
            self.next = step.saturating_mul(2);
        }
        due
    }

    fn failure(&self, model: &Model, region: &Region) -> GoalFailure {
        let kind = match (&region.malformed, region.is_possible()) {
            (Some(_), _) => GoalFailureKind::Malformed,
            (None, true) => GoalFailureKind::NotFound { tries: region.tries },
            (None, false) => GoalFailureKind::ContradictsEveryState,
        };
        GoalFailure::new(region.number, kind, self.why(model, region))
    }

    fn why(&self, model: &Model, region: &Region) -> String {
        let name = format!("goal {}", region.number + 1);
        if let Some(malformed) = &region.malformed {
            return format!("{name}: {malformed}");
        }
        if let Some(overlap) = &region.overlap {
            return format!("{name}: where it has its objects, {overlap}");
        }
        let contradictions: Vec<&str> =
            region.sites.iter().filter_map(Site::contradiction).map(String::as_str).collect();
        let mut words = match region.is_possible() {
            true => format!("{name}: no configuration in {} tries", region.tries),
            false if model.graph.lazy => format!("{name} contradicts every state near the start"),
            false if region.leaves_out > 0 => {
                format!("{name} contradicts every state that transitions lead to")
            }
            false => format!("{name} contradicts every state"),
        };
        if !contradictions.is_empty() {
            let told = contradictions[..contradictions.len().min(MOST_TOLD)].join("; ");
            words += &format!(" ({} of {} contradict it: {told})", contradictions.len(), region.sites.len());
        }
        let s = &self.statistics;
        if s.tries > 0 {
            words += &format!(
                ", projection failed {} times, {} were out of bounds or in no state",
                s.projection_failed, s.refused
            );
        }
        let shapes = &model.problem.robot.shapes;
        let worst = s.blocked_by.iter().max_by(|a, b| a.1.cmp(b.1).then(b.0.cmp(a.0)));
        if let Some((&(a, b), count)) = worst {
            let collided: u64 = s.blocked_by.values().sum();
            let (a, b) = (&shapes[a.at()].name, &shapes[b.at()].name);
            words += &format!(", {collided} were in collision ({a} and {b} {count} times)");
        }
        words
    }
}
