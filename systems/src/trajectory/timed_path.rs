//! A path without times becomes one with times: smooth, as fast as its limits allow, and proved as the curve that it is.

use crate::improvement::leaf_motion::LeafMotion;
use crate::planning_model::model::Model;
use crate::search::timed_certificate::{TimedFault, TimedScratch, certify_timed_path};
use crate::settings::SearchSettings;
use crate::trajectory::rows::{follow_signs, share_joint_knots};
use crate::trajectory::smoothing::{Smoothing, SmoothingScratch};
use crate::trajectory::stretch::Stretch;
use crate::trajectory::timing::{self, StretchError, TimingBuffers};
use foliate_components::path::{ManipulationPath, Segment};
use foliate_components::problem::RateLimits;
use foliate_kernels::trajectory::BlendError;

/// Why a path gets no times.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TimedPathError {
    /// A constraint of a state does not compile.
    #[error("a constraint of a state on the path does not compile")]
    Constraint,
    /// Numbers make no smooth path.
    #[error("segment {segment}: {error}")]
    Smoothing {
        /// The first segment of the stretch, from 0.
        segment: usize,
        /// What is wrong.
        error: BlendError,
    },
    /// Limits allow no motion.
    #[error("segment {segment}: {error}")]
    Timing {
        /// The first segment of the stretch, from 0.
        segment: usize,
        /// What is wrong.
        error: StretchError,
    },
    /// The curve is not proved, however close it is to the path without times.
    #[error("the curve of segment {} is not proved: {:?} at piece {}", fault.segment, fault.kind, fault.piece)]
    Unproved {
        /// What was found last.
        fault: TimedFault,
    },
}

/// How often a curve is refused and made again.
const TRIES: usize = 64;

/// Gives a path times: every stretch between two stops is smoothed and timed, and the whole is certified as a curve. Where it is
/// refused the stretch is made again, closer to the path without times.
///
/// # Errors
/// See [`TimedPathError`].
pub fn timed_path(
    model: &Model,
    settings: &SearchSettings,
    path: &ManipulationPath,
) -> Result<ManipulationPath, TimedPathError> {
    let motions = LeafMotion::of_path(model, path).ok_or(TimedPathError::Constraint)?;
    let limits = RateLimits::of(&model.problem.robot, &model.problem.timing);
    let stretches = Stretch::of_path(model, &motions, &limits);
    let size = model.problem.robot.space.size();
    let mut refusals: Vec<Vec<usize>> = stretches.iter().map(|stretch| vec![0; stretch.knots.len() / size]).collect();
    let mut maker = Maker {
        model,
        settings,
        motions: &motions,
        scratch: SmoothingScratch::default(),
        timing: TimingBuffers::default(),
    };
    maker.scratch.collision.set_level(settings.level);
    let mut made: Vec<Option<Made>> = vec![None; stretches.len()];
    let mut proof = TimedScratch::default();
    let mut tries = 0;
    loop {
        for ((stretch, made), refusals) in stretches.iter().zip(&mut made).zip(&refusals) {
            if made.is_none() {
                *made = Some(maker.make(stretch, refusals)?);
            }
        }
        let mut timed = ManipulationPath { segments: Vec::new(), certificate: path.certificate };
        let mut now = 0.0;
        for made in made.iter().flatten() {
            timed.segments.extend(made.segments.iter().map(|segment| later(segment, now)));
            now += made.duration;
        }
        share_joint_knots(&mut timed.segments);
        follow_signs(model, &mut timed.segments);
        let fault = match certify_timed_path(model, settings, &timed, &mut proof) {
            Ok(certificate) => return Ok(ManipulationPath { certificate, ..timed }),
            Err(fault) => fault,
        };
        let mut segments = 0;
        let is_in = |made: &Option<Made>| {
            segments += made.as_ref().map_or(0, |made| made.segments.len());
            fault.segment < segments
        };
        let Some(index) = made.iter().position(is_in).filter(|_| tries < TRIES) else {
            return Err(TimedPathError::Unproved { fault });
        };
        let row = timed.segments[fault.segment].knots.get(fault.piece).cloned().unwrap_or_default();
        stretches[index].refuse_near(&row, &mut refusals[index]);
        made[index] = None;
        tries += 1;
    }
}

/// A stretch with times that begin at 0.
#[derive(Clone, Debug)]
struct Made {
    segments: Vec<Segment>,
    duration: f64,
}

struct Maker<'a> {
    model: &'a Model,
    settings: &'a SearchSettings,
    motions: &'a [LeafMotion],
    scratch: SmoothingScratch,
    timing: TimingBuffers,
}

impl Maker<'_> {
    fn make(&mut self, stretch: &Stretch, refusals: &[usize]) -> Result<Made, TimedPathError> {
        let segment = stretch.motions.start;
        let (model, settings, motions) = (self.model, self.settings, self.motions);
        let smoothing = Smoothing { model, settings, motions, stretch, refusals };
        let paths = smoothing.paths(&mut self.scratch).map_err(|error| TimedPathError::Smoothing { segment, error })?;
        let (segments, duration) = timing::segments(model, motions, (stretch, &paths), &mut self.timing)
            .map_err(|error| TimedPathError::Timing { segment, error })?;
        Ok(Made { segments, duration })
    }
}

/// A segment that begins by so much later.
fn later(segment: &Segment, by: f64) -> Segment {
    let mut segment = segment.clone();
    if let Some(timing) = &mut segment.timing {
        timing.times.iter_mut().for_each(|time| *time += by);
    }
    segment
}
