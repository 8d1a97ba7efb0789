//! An object that a gripper holds is no faster than the scene lets it be.
//!
//! Within a step that takes h seconds the velocity of a point p is the mean one, to within ½ h sup‖p″‖ ([`Bends`]). Steps are halved until
//! that decides.

use crate::check::contract::required_constraints::is_held;
use crate::check::contract::scene_contract::Contract;
use crate::check::motion::reach::{Bends, Reach};
use crate::check::motion::segment::{At, SegmentMotion};
use crate::check::report::check_report::{CheckReport, Place};
use crate::check::report::error::CheckError;
use crate::check::report::kind::Kind;
use crate::check::report::work::Work;
use crate::check::world::documents::Frames;
use glam::DVec3;

/// Rounding allowed beyond a limit, as a share of it.
const SLACK: f64 = 1e-9;
/// A step of which the bound adds less than this share of the limit is not halved further: in doubt it is too fast.
const FINEST: f64 = 1e-6;

impl Contract<'_> {
    /// Proves the limits of `object_speed` along a segment with times.
    pub(in crate::check) fn held_speeds(
        &self,
        motion: &SegmentMotion<'_>,
        frames: &Frames,
        report: &mut CheckReport,
        work: &mut Work,
    ) -> Result<(), CheckError> {
        let Some(timed) = motion.timed else { return Ok(()) };
        for &(part, limit) in &self.problem.timing.object_speed {
            let name = &self.problem.robot.parts[part.at()].name;
            if !is_held(motion, name) {
                continue;
            }
            let frame = frames.named(motion.world, name, || "scene".into())?;
            let end = (frame.body, frame.body_from_frame.translation.length());
            let speed = Speed {
                limit,
                origin: &|at: At| motion.frame(&frame, at).translation,
                bends: Reach::new(motion).bends(None, end, motion.knots.len()),
            };
            for knot in 0..motion.last() {
                let duration = timed.times[knot + 1] - timed.times[knot];
                // Two knots of one time are the same.
                let Some((share, value)) = (duration > 0.0).then(|| speed.beyond(knot, duration, work)).flatten()
                else {
                    continue;
                };
                let subject = format!("{name} is faster than it may be while it is held");
                report.violate(Place::at(motion.index, knot as f64 + share), Kind::Demand, subject, value, limit);
                break;
            }
        }
        Ok(())
    }
}

/// A point whose speed is limited.
struct Speed<'a> {
    /// m/s.
    limit: f64,
    origin: &'a dyn Fn(At) -> DVec3,
    bends: Bends,
}

impl Speed<'_> {
    /// Where between a knot and the next the point is too fast, or not proved to be slow enough, and how fast. None where it is proved,
    /// or where there is no work left.
    fn beyond(&self, knot: usize, duration: f64, work: &mut Work) -> Option<(f64, f64)> {
        let allowed = self.limit * (1.0 + SLACK);
        if self.bends.speed[knot] / duration <= allowed {
            return None;
        }
        let at = |fraction: f64| (self.origin)(At { knot, fraction });
        let mut stack = vec![(0.0, at(0.0), 1.0, at(1.0))];
        while let Some((low, at_low, high, at_high)) = stack.pop() {
            let share = high - low;
            let mean = at_low.distance(at_high) / (share * duration);
            let spread = 0.5 * share * self.bends.point[knot] / duration;
            // Compared so that NaN is too fast.
            let is_slow = mean + spread <= allowed;
            if is_slow {
                continue;
            }
            let may_be_slow = mean <= allowed && spread > FINEST * self.limit;
            if !may_be_slow {
                return Some((low, mean));
            }
            if !work.spend(1) {
                return None;
            }
            let middle = low.midpoint(high);
            let at_middle = at(middle);
            stack.push((middle, at_middle, high, at_high));
            stack.push((low, at_low, middle, at_middle));
        }
        None
    }
}
