//! Where the grid points of a path lie.

use crate::trajectory::spline::Spline;
use crate::trajectory::time_optimal::counted::Counted;
use crate::trajectory::time_optimal::error::TimingError;
use crate::trajectory::time_optimal::settings::TimingSettings;

/// A part of the path between two grid points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    /// Parameters of its ends.
    pub ends: [f64; 2],
    /// The piece of the path on which it lies, of a straight run the first.
    pub piece: usize,
    /// Whether all coordinates that count move along a straight line at constant rates.
    pub straight: bool,
}

impl Interval {
    pub fn width(&self) -> f64 {
        self.ends[1] - self.ends[0]
    }
}

/// Relative change of a derivative up to which a piece is straight. Acceleration changes by so much.
const STRAIGHT: f64 = 1e-11;

/// Parts of a straight piece on which a ceiling of the path velocity is asked for.
const STRAIGHT_PARTS: usize = 16;

/// What a piece of the path is.
enum Kind {
    Still,
    Straight,
    Curved,
}

/// Lays the grid: straight pieces that follow one another become one interval, curved pieces are cut into equal parts, towards a rest
/// at the ends of the path in halving steps. With a ceiling straight pieces are cut into equal parts too.
pub(super) fn lay(
    path: &Spline,
    counted: &Counted,
    settings: TimingSettings,
    has_ceiling: bool,
    out: &mut Vec<Interval>,
) -> Result<(), TimingError> {
    out.clear();
    for piece in 0..path.pieces() {
        let ends = [path.parameters()[piece], path.parameters()[piece + 1]];
        match kind(path, piece, counted)? {
            Kind::Still => {}
            Kind::Straight if has_ceiling => {
                cut(ends, STRAIGHT_PARTS, [false; 2], |ends| out.push(Interval { ends, piece, straight: true }));
            }
            Kind::Straight => match out.last_mut() {
                Some(run) if run.straight && run.ends[1] == ends[0] => run.ends[1] = ends[1],
                _ => out.push(Interval { ends, piece, straight: true }),
            },
            Kind::Curved => {
                let rests = [piece == 0, piece + 1 == path.pieces()];
                let parts = parts(path, piece, counted, settings);
                cut(ends, parts, rests, |ends| out.push(Interval { ends, piece, straight: false }));
            }
        }
    }
    Ok(())
}

fn kind(path: &Spline, piece: usize, counted: &Counted) -> Result<Kind, TimingError> {
    let (mut moves, mut bend, mut largest) = (false, 0.0_f64, 0.0_f64);
    let width = path.width(piece);
    for (coordinate, by_acceleration) in counted.coordinates.iter().zip(&counted.by_acceleration) {
        let cubic = path.cubic(piece, *coordinate);
        let ([q0, q1], [v0, v1]) = (cubic.positions, cubic.velocities);
        let mean = (q1 - q0) / width;
        let top = mean.abs().max(v0.abs()).max(v1.abs());
        let rounding = 4.0 * f64::EPSILON * q0.abs().max(q1.abs()) / width;
        moves |= top > 0.0 && *by_acceleration > 0.0;
        largest = largest.max(top);
        bend = bend.max((mean - v0).abs().max((mean - v1).abs()) - rounding);
    }
    if moves {
        return Ok(if bend <= STRAIGHT * largest { Kind::Straight } else { Kind::Curved });
    }
    let stands = |i: usize| {
        let cubic = path.cubic(piece, i);
        cubic.positions[0] == cubic.positions[1] && cubic.velocities == [0.0, 0.0]
    };
    if (0..path.size()).all(stands) { Ok(Kind::Still) } else { Err(TimingError::Unlimited { piece }) }
}

/// How many equal parts a curved piece is cut into, see [`TimingSettings`].
fn parts(path: &Spline, piece: usize, counted: &Counted, settings: TimingSettings) -> usize {
    let width = path.width(piece);
    let (mut turn, mut bend) = (0.0_f64, 0.0_f64);
    let mut lengths = [0.0_f64; SAMPLES];
    for (&coordinate, by_velocity) in counted.coordinates.iter().zip(&counted.by_velocity) {
        let cubic = path.cubic(piece, coordinate);
        turn = turn.max(cubic.top_acceleration() * width * by_velocity);
        bend = bend.max(cubic.jerk().abs() * width * width * by_velocity);
        for (k, length) in lengths.iter_mut().enumerate() {
            let u = k as f64 / (SAMPLES - 1) as f64;
            *length = length.max(cubic.velocity(u).abs() * by_velocity);
        }
    }
    let mean = lengths.iter().sum::<f64>() / SAMPLES as f64;
    // Where a path nearly turns back the tangent is short, and what is lost on an interval is large.
    let length = lengths.iter().fold(mean, |least, length| least.min(*length)).max(SHORTEST * mean);
    // A parabola over a width differs from its chord by an eighth of its second derivative times the squared width.
    let parts = (turn / (settings.turn * length)).max((bend / (8.0 * settings.bulge * length)).sqrt());
    // Not a number where nothing has a velocity limit.
    if parts.is_nan() { MOST_PARTS / 8 } else { (parts.ceil() as usize).clamp(1, MOST_PARTS) }
}

/// Shares of the mean length of the tangent below which it does not count as shorter.
const SHORTEST: f64 = 0.2;
/// Points of a piece at which the length of its tangent is measured.
const SAMPLES: usize = 5;
/// Most parts of a piece.
const MOST_PARTS: usize = 256;

/// How often the intervals next to a rest are halved.
const HALVINGS: i32 = 5;

/// Cuts [from, to] into equal parts; those next to a rest are halved towards it again and again.
fn cut(ends: [f64; 2], parts: usize, rests: [bool; 2], mut part: impl FnMut([f64; 2])) {
    let [from, to] = ends;
    let parts = if rests == [true; 2] { parts.max(2) } else { parts };
    let width = (to - from) / parts as f64;
    let mut last = from;
    let mut until = |parameter: f64| {
        part([last, parameter]);
        last = parameter;
    };
    if rests[0] {
        (1..=HALVINGS).rev().for_each(|k| until(from + width * 0.5_f64.powi(k)));
    }
    for k in 1..parts {
        until(from + width * k as f64);
    }
    if rests[1] {
        (1..=HALVINGS).for_each(|k| until(to - width * 0.5_f64.powi(k)));
    }
    until(to);
}
