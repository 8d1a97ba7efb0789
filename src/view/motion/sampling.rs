//! Samples of a motion that may be joined by straight lines.

use crate::planner::trajectory::error::TrajectoryError;
use crate::planner::trajectory::poses::Poses;
use crate::planner::trajectory::trajectory::Trajectory;
use foliate_components::robot::configuration::{ConfigurationSpace, Group};

/// How far a number between two samples may be off, metres and radians.
const OFF: f64 = 5e-4;
/// Longest time between two samples, seconds.
const LONGEST: f64 = 0.25;
/// How often a stretch is cut in two.
const CUTS: u32 = 14;
/// Most numbers of all samples; a longer motion is sampled more coarsely.
const NUMBERS: usize = 1 << 21;

/// Samples in the order of time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Samples {
    /// Seconds from the start of the motion.
    pub times: Vec<f64>,
    pub configurations: Vec<Vec<f64>>,
    /// How far a number between two samples is off, half way and at the quarters.
    pub deviation: f64,
}

/// Samples at the ends of all segments and as many between as it takes, as far as there is room.
///
/// # Errors
/// More segments than there is room for.
pub(crate) fn samples(trajectory: &Trajectory<'_>) -> Result<Samples, TrajectoryError> {
    let allowed = NUMBERS / trajectory.robot().space.size().max(1);
    let segments = trajectory.path().segments.len();
    if segments >= allowed {
        let message = "a page has no room for so many segments of so many coordinates";
        return Err(TrajectoryError::Malformed { segment: allowed.saturating_sub(1), message });
    }
    let mut off = OFF;
    let mut longest = LONGEST.max(trajectory.duration() / (allowed - segments) as f64);
    loop {
        if let Some(samples) = sampled(trajectory, (off, longest), allowed) {
            return Ok(samples);
        }
        // Numbers of which the straight lines are metres off are nothing to look at: what counts then is that this ends soon.
        off *= if off > 1.0 { 1e6 } else { 4.0 };
        longest *= 4.0;
    }
}

/// None where it takes more samples than are allowed. Without cuts it takes one more than there are segments.
fn sampled(trajectory: &Trajectory<'_>, (off, longest): (f64, f64), allowed: usize) -> Option<Samples> {
    let mut sampler = Sampler {
        poses: trajectory.poses(),
        space: &trajectory.robot().space,
        start: trajectory.start(),
        off,
        longest,
        left: allowed,
        samples: Samples::default(),
    };
    let segments = trajectory.segments();
    for segment in &segments {
        let (from, to) = (sampler.at(segment.start), sampler.before(segment.start, segment.end));
        sampler.push(segment.start, from.clone())?;
        sampler.between((segment.start, from), (segment.end, to), 0)?;
    }
    if let Some(last) = segments.last() {
        let q = sampler.at(last.end);
        sampler.push(last.end, q)?;
    }
    Some(sampler.samples)
}

struct Sampler<'t> {
    poses: Poses<'t>,
    space: &'t ConfigurationSpace,
    start: f64,
    off: f64,
    longest: f64,
    /// How many samples may still be made.
    left: usize,
    samples: Samples,
}

impl Sampler<'_> {
    fn at(&mut self, time: f64) -> Vec<f64> {
        self.poses.place(time);
        self.poses.configuration().to_vec()
    }

    /// Where a stretch ends: the next segment begins there, and answers for that time itself.
    fn before(&mut self, from: f64, to: f64) -> Vec<f64> {
        self.at(if to > from { to.next_down() } else { to })
    }

    /// None where no more may be made.
    fn push(&mut self, time: f64, q: Vec<f64>) -> Option<()> {
        self.left = self.left.checked_sub(1)?;
        let time = time - self.start;
        // In single precision two times may be one; the later sample is nearer to what follows.
        if self.samples.times.last().is_some_and(|last| *last as f32 >= time as f32) {
            self.samples.configurations.pop();
            self.samples.times.pop();
        }
        self.samples.times.push(time);
        self.samples.configurations.push(q);
        Some(())
    }

    /// Samples between two, which are there or will be; none where no more may be made.
    fn between(&mut self, from: (f64, Vec<f64>), to: (f64, Vec<f64>), cuts: u32) -> Option<()> {
        let at = |share: f64| from.0 + share * (to.0 - from.0);
        let middle = self.at(at(0.5));
        let mut off = distance(self.space, &from.1, &to.1, 0.5, &middle);
        for share in [0.25, 0.75] {
            let here = self.at(at(share));
            off = off.max(distance(self.space, &from.1, &to.1, share, &here));
        }
        if cuts == CUTS || (off <= self.off && to.0 - from.0 <= self.longest) {
            self.samples.deviation = self.samples.deviation.max(off);
            return Some(());
        }
        let middle = (at(0.5), middle);
        self.between(from, middle.clone(), cuts + 1)?;
        self.push(middle.0, middle.1.clone())?;
        self.between(middle, to, cuts + 1)
    }
}

/// How far a configuration is from the straight line between two, at a share of it: the largest number, of quaternions the angle.
fn distance(space: &ConfigurationSpace, from: &[f64], to: &[f64], share: f64, q: &[f64]) -> f64 {
    let straight = |i: usize| (from[i] + share * (to[i] - from[i]) - q[i]).abs();
    let mut farthest = 0.0_f64;
    for factor in &space.factors {
        let numbers = match factor.group {
            Group::FreeFlyer | Group::Plane => 3,
            Group::Real | Group::Circle => 1,
        };
        farthest = (factor.q..factor.q + numbers).map(straight).fold(farthest, f64::max);
        if factor.group == Group::FreeFlyer {
            let at = |q: &[f64]| foliate_components::robot::configuration::quaternion(q, factor.q);
            farthest = farthest.max(at(from).slerp(at(to), share).angle_between(at(q)));
        }
    }
    farthest
}
