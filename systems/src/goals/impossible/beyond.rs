//! Grasps that joints reach only beyond their limits: which joint, and by how much.

use crate::events::StopSignal;
use crate::goals::impossible::hindrance::Shortfall;
use crate::goals::impossible::site::Site;
use crate::goals::impossible::tries::{converges, solve};
use crate::goals::programs::GoalProgram;
use crate::planning_model::model::PlanningModel;
use crate::planning_model::state_classification::coordinate;
use crate::settings::SearchSettings;
use foliate_components::graph::StateId;
use foliate_kernels::constrained_motion::Scratch;

/// Tries to see how far beyond their limits joints would have to go.
const TRIES: u32 = 32;
/// By so little a limit may be exceeded where it is kept, radians and metres.
const SAME: f64 = 1e-5;
/// Times that a configuration beyond the limits is brought nearer to them.
const NEARER: u32 = 4;
/// Likewise where one joint alone may stay beyond its limit.
const ALONE: u32 = 64;

/// A problem, and the same with wider limits.
pub(super) struct Limits<'a> {
    pub model: &'a PlanningModel,
    pub wide: &'a PlanningModel,
    pub settings: &'a SearchSettings,
    pub stop: &'a StopSignal,
}

impl Limits<'_> {
    /// Of the tries of a grasp beyond the limits the one that needs least, and which. A joint that alone would have to go beyond its limit is
    /// told before one that is only the farthest of several.
    pub fn beyond(&self, site: &Site, state: StateId) -> Option<(f64, Shortfall)> {
        let program = GoalProgram::new(self.wide, self.settings, &site.goal, &site.q, state, true).ok()?;
        let mut scratch = Scratch::default();
        let mut best: Option<(f64, Vec<f64>, usize)> = None;
        for number in (0..TRIES).take_while(|_| !self.stop.is_raised()) {
            let found = solve(self.wide, self.settings, &program, (&site.q, state, number), &mut scratch);
            let (mut q, mut is_converged) = found;
            // From the nearest configuration within the limits the next one is less beyond them.
            for _ in 0..=NEARER {
                let worst = (0..q.len()).map(|index| (index, self.over(&q, index))).max_by(|a, b| a.1.total_cmp(&b.1));
                let Some((index, excess)) = worst.filter(|(_, excess)| is_converged && *excess > 0.0) else { break };
                if best.as_ref().is_none_or(|(least, ..)| excess < *least) {
                    best = Some((excess, q.clone(), index));
                }
                self.within_limits(&mut q, None);
                is_converged = converges(self.settings, &program, &mut q, &mut scratch);
            }
        }
        let (excess, q, farthest) = best?;
        let candidates = (0..q.len()).filter(|&index| self.over(&q, index) > 0.0);
        let alone = candidates.filter_map(|index| self.alone(&program, &q, index, &mut scratch));
        let alone = alone.min_by(|a, b| a.0.total_cmp(&b.0));
        let (excess, index, needed) = alone.unwrap_or((excess, farthest, q[farthest]));
        let space = &self.model.problem.robot.space;
        let limit = if needed < space.lower[index] { space.lower[index] } else { space.upper[index] };
        let joint = coordinate(&self.model.problem.robot, index);
        Some((excess, Shortfall::Limit { joint, needed, limit }))
    }

    /// How far a coordinate is beyond its limits; negative within them.
    fn over(&self, q: &[f64], index: usize) -> f64 {
        let space = &self.model.problem.robot.space;
        (space.lower[index] - q[index]).max(q[index] - space.upper[index])
    }

    /// Moves the coordinates that are beyond their limits onto them, but for one.
    fn within_limits(&self, q: &mut [f64], but: Option<usize>) {
        let space = &self.model.problem.robot.space;
        for index in (0..q.len()).filter(|&index| Some(index) != but) {
            if self.over(q, index) > 0.0 {
                q[index] = q[index].max(space.lower[index]).min(space.upper[index]);
            }
        }
    }

    /// How far a coordinate has to be beyond its limit where all others keep theirs, its number, and its value there; `None` where that
    /// is not found from a configuration in which others are beyond theirs too.
    fn alone(
        &self,
        program: &GoalProgram,
        from: &[f64],
        index: usize,
        scratch: &mut Scratch,
    ) -> Option<(f64, usize, f64)> {
        let mut q = from.to_vec();
        for _ in (0..ALONE).take_while(|_| !self.stop.is_raised()) {
            self.within_limits(&mut q, Some(index));
            if !converges(self.settings, program, &mut q, scratch) {
                return None;
            }
            let others = (0..q.len()).filter(|&other| other != index);
            if others.map(|other| self.over(&q, other)).fold(0.0, f64::max) <= SAME {
                let excess = self.over(&q, index);
                return (excess > 0.0).then_some((excess, index, q[index]));
            }
        }
        None
    }
}
