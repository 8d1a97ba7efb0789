//! Stretches: the motions of a path from one stop to the next. The robot stops wherever the leaf changes.

use crate::improvement::leaf_motion::{LeafMotion, grasp_changes};
use crate::planning_model::model::Model;
use foliate_components::problem::RateLimits;
use foliate_components::robot::Source;
use foliate_kernels::trajectory::time_at_full_speed;
use std::ops::Range;

/// Motions of one leaf, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// Its motions, by number.
    pub motions: Range<usize>,
    /// Whole configurations, end to end; none twice in a row.
    pub knots: Vec<f64>,
    /// The knots at which one motion ends and the next begins, by number.
    pub joints: Vec<usize>,
    /// Limits of the coordinates that count; infinite for objects that follow a carrier.
    pub velocity: Vec<f64>,
    /// As `velocity`.
    pub acceleration: Vec<f64>,
    /// As `velocity`.
    pub jerk: Vec<f64>,
    /// By coordinate: whether it is of an object that follows a carrier.
    pub carried: Vec<bool>,
    /// Whether a hand takes or lets go of something where it begins.
    pub begins_with_grasp_change: bool,
}

impl Stretch {
    /// The stretches of a path.
    pub(crate) fn of_path(model: &Model, motions: &[LeafMotion], limits: &RateLimits) -> Vec<Self> {
        let mut stretches = Vec::new();
        let mut start = 0;
        for end in 1..=motions.len() {
            let goes_on = motions.get(end).is_some_and(|next| motions[end - 1].is_on_leaf_of(next));
            if !goes_on {
                stretches.push(Self::of_motions(model, motions, start..end, limits));
                start = end;
            }
        }
        stretches
    }

    fn of_motions(model: &Model, motions: &[LeafMotion], range: Range<usize>, limits: &RateLimits) -> Self {
        let size = model.problem.robot.space.size();
        let mut carried = vec![false; size];
        for rigid_attachment in &motions[range.start].rigid_attachments {
            let joint = &model.problem.robot.joints[rigid_attachment.object.at()];
            if let Source::Coordinates { q, .. } = joint.source {
                carried[q..q + joint.motion.configuration_size()].fill(true);
            }
        }
        let counted = |all: &[f64]| -> Vec<f64> {
            all.iter().zip(&carried).map(|(limit, carried)| if *carried { f64::INFINITY } else { *limit }).collect()
        };
        let [velocity, acceleration, jerk] =
            [&limits.velocity, &limits.acceleration, &limits.jerk].map(|all| counted(all));
        let mut knots: Vec<f64> = Vec::new();
        let mut joints = Vec::new();
        for index in range.clone() {
            if index > range.start {
                joints.push(knots.len() / size - 1);
            }
            for q in motions[index].knots.chunks_exact(size) {
                push_apart(&mut knots, q, &velocity);
            }
        }
        end_exactly(&mut knots, motions[range.end - 1].end(size), &velocity);
        let before = range.start.checked_sub(1).map(|index| &motions[index]);
        let changes = before.map_or(0, |before| grasp_changes(model, before, &motions[range.start]));
        let begins_with_grasp_change = changes > 0;
        Self { motions: range, knots, joints, velocity, acceleration, jerk, carried, begins_with_grasp_change }
    }
}

impl Stretch {
    /// Counts a refusal at the knot that is nearest to a configuration, and at its neighbours.
    pub(crate) fn refuse_near(&self, q: &[f64], refusals: &mut [usize]) {
        let size = self.velocity.len();
        let distance = |k: &usize| time_at_full_speed(q, &self.knots[k * size..][..size], &self.velocity);
        let nearest = (0..refusals.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
        let last = (nearest + 1).min(refusals.len().saturating_sub(1));
        refusals[nearest.saturating_sub(1)..=last].iter_mut().for_each(|count| *count += 1);
    }
}

/// Knots that are closer than this are one, in seconds at full speed.
pub(crate) const APART: f64 = 1e-6;

/// Adds a knot that is far enough from the last one.
fn push_apart(knots: &mut Vec<f64>, q: &[f64], velocity: &[f64]) {
    let is_apart = |last: usize| time_at_full_speed(&knots[last..], q, velocity) > APART;
    if knots.len().checked_sub(q.len()).is_none_or(is_apart) {
        knots.extend_from_slice(q);
    }
}

/// Makes the last knot the end of the stretch. Where that is too close to the last knot it takes its place, unless it is the only one.
fn end_exactly(knots: &mut Vec<f64>, end: &[f64], velocity: &[f64]) {
    let last = knots.len() - end.len();
    if knots[last..] == *end {
        return;
    }
    if last == 0 && time_at_full_speed(&knots[last..], end, velocity) > 0.0 {
        knots.extend_from_slice(end);
    } else {
        knots[last..].copy_from_slice(end);
    }
}
