//! A path without times becomes one with times: smooth, as fast as its limits allow, and proved as the curve that it is.

use crate::improvement::leaf_motion::LeafMotion;
use crate::planning_model::model::Model;
use crate::search::timed_certificate::{TimedFault, TimedScratch, certify_timed_path, certify_timed_segment};
use crate::settings::SearchSettings;
use crate::trajectory::rows::{follow_signs, share_joint_knots};
use crate::trajectory::smoothing::SmoothingScratch;
use crate::trajectory::smoothing_problem::SmoothingProblem;
use crate::trajectory::stretch::Stretch;
use crate::trajectory::timing::{self, StretchError, TimingBuffers};
use foliate_components::path::{Certificate, ManipulationPath, Segment};
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
    let settings = &settings.clone().for_problem(&model.problem);
    let motions = LeafMotion::of_path(model, path).ok_or(TimedPathError::Constraint)?;
    let limits = RateLimits::of(&model.problem.robot, &model.problem.timing);
    let stretches = Stretch::of_path(model, &motions, &limits);
    let mut maker = Maker {
        model,
        settings,
        motions: &motions,
        smoothing: SmoothingScratch::default(),
        timing: TimingBuffers::default(),
        proof: TimedScratch::default(),
        tries: 0,
    };
    maker.smoothing.collision.set_level(settings.level);
    let size = model.problem.robot.space.size();
    let mut refusals: Vec<Vec<usize>> = stretches.iter().map(|stretch| vec![0; stretch.knots.len() / size]).collect();
    let mut made = Vec::with_capacity(stretches.len());
    for (stretch, refusals) in stretches.iter().zip(&refusals) {
        made.push(maker.make(stretch, refusals)?);
    }
    loop {
        let timed = whole(model, &made, path.certificate);
        let fault = match certify_timed_path(model, settings, &timed, &mut maker.proof) {
            Ok(certificate) => return Ok(ManipulationPath { certificate, ..timed }),
            Err(fault) => fault,
        };
        let mut segments = 0;
        let is_in = |made: &Made| {
            segments += made.segments.len();
            fault.segment < segments
        };
        let index = made.iter().position(is_in).ok_or(TimedPathError::Unproved { fault })?;
        let knot = timed.segments[fault.segment].knots.get(fault.piece).cloned().unwrap_or_default();
        made[index] = maker.make_again(&stretches[index], &mut refusals[index], (knot, fault))?;
    }
}

/// The stretches, one after the other.
fn whole(model: &Model, made: &[Made], certificate: Certificate) -> ManipulationPath {
    let mut path = ManipulationPath { segments: Vec::new(), certificate, corrections: model.snapped.clone() };
    let mut now = 0.0;
    for made in made {
        path.segments.extend(made.segments.iter().map(|segment| later(segment, now)));
        now += made.duration;
    }
    share_joint_knots(model, &mut path.segments);
    follow_signs(model, &mut path.segments);
    path
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
    smoothing: SmoothingScratch,
    timing: TimingBuffers,
    proof: TimedScratch,
    /// How often a curve was refused.
    tries: usize,
}

impl Maker<'_> {
    fn make(&mut self, stretch: &Stretch, refusals: &[usize]) -> Result<Made, TimedPathError> {
        let segment = stretch.motions.start;
        let (model, settings, motions) = (self.model, self.settings, self.motions);
        let problem = SmoothingProblem { model, settings, motions, stretch, refusals };
        let paths = problem.paths(&mut self.smoothing).map_err(|error| TimedPathError::Smoothing { segment, error })?;
        let (segments, duration) = timing::segments(model, motions, (stretch, &paths), &mut self.timing)
            .map_err(|error| TimedPathError::Timing { segment, error })?;
        Ok(Made { segments, duration })
    }
}

impl Maker<'_> {
    /// Makes a stretch again that was refused near a knot, until its own segments are proved.
    fn make_again(
        &mut self,
        stretch: &Stretch,
        refusals: &mut [usize],
        (mut knot, mut fault): (Vec<f64>, TimedFault),
    ) -> Result<Made, TimedPathError> {
        loop {
            self.tries += 1;
            if self.tries > TRIES {
                return Err(TimedPathError::Unproved { fault });
            }
            stretch.refuse_near(&knot, refusals);
            let made = self.make(stretch, refusals)?;
            let refused = made.segments.iter().find_map(|segment| {
                let found = certify_timed_segment(self.model, self.settings, segment, &mut self.proof).err()?;
                Some((segment, found))
            });
            let Some((segment, found)) = refused else { return Ok(made) };
            knot = segment.knots.get(found.piece).cloned().unwrap_or_default();
            fault = TimedFault { segment: fault.segment, ..found };
        }
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
