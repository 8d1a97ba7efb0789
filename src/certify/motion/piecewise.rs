//! A motion of some joints: pieces of polynomials, one after the other.

use crate::certify::motion::how::{How, Interpolation, Turns};
use crate::certify::motion::polynomial::Polynomial;
use crate::certify::motion::scaled::Scaled;
use foliate_components::pose::{exp_so3, log_so3};
use foliate_components::robot::{JointIndex, JointType as JointMotion, Robot, Source};
use glam::{DQuat, DVec3};

/// Most points of a motion.
pub const POINTS: usize = 1 << 20;
/// Values beyond this are no angles and no lengths, radians and metres.
pub const FARTHEST: f64 = 1e4;

/// One point of a motion as files give it; all rows in the order of the motion's coordinates, but for quaternions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// Seconds from the start of the trajectory.
    pub time: Option<f64>,
    /// Radians and metres.
    pub positions: Vec<f64>,
    /// Per second; none where the file has none.
    pub velocities: Option<Vec<f64>>,
    /// Per second squared; none where the file has none.
    pub accelerations: Option<Vec<f64>>,
}

/// What moves an axis of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    /// A number.
    Number(Polynomial),
    /// Part of a quaternion, which turns evenly.
    Quaternion,
}

impl Curve {
    /// The number's polynomial.
    fn number(self) -> Polynomial {
        if let Self::Number(polynomial) = self { polynomial } else { Polynomial::default() }
    }
}

/// A root that turns along a segment: on the quaternion geodesic, or by polynomials that are scaled to length 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Index of qx in a configuration.
    pub q: usize,
    /// Orientation at the start.
    pub from: DQuat,
    /// Rotation vector to the end, in the frame at the start; radians.
    pub by: DVec3,
    /// The four numbers before they are scaled, where they follow polynomials.
    pub scaled: Option<Scaled>,
}

/// From one point to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// Seconds, or the number of the point.
    pub start: f64,
    /// Seconds, or 1.
    pub duration: f64,
    /// By coordinate of the motion.
    pub curves: Vec<Curve>,
    /// Roots that turn.
    pub turns: Vec<Turn>,
}

/// An object that a link carries from a time on.
#[derive(Clone, Debug, PartialEq)]
pub struct Attachment {
    /// The object's part.
    pub object: String,
    /// The link that carries it, `part/link`; none from where the object stays in the world again.
    pub link: Option<String>,
    /// From this time on: seconds, or numbers of points where a motion has no times. Before the start is at the start.
    pub time: f64,
}

/// A motion of some of a robot's coordinates; what it does not name stands still.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// The coordinates that move, as indices into a configuration.
    pub coordinates: Vec<usize>,
    /// The segments, each starting where the one before ends.
    pub segments: Vec<Segment>,
    /// Whether times are seconds; otherwise they are numbers of points, and there are no velocities.
    pub timed: bool,
    /// Values of coordinates that the motion does not move but its file gives.
    pub start: Vec<(usize, f64)>,
    /// Who carries what, by the file itself, in order of time.
    pub attachments: Vec<Attachment>,
    /// Remarks.
    pub notes: Vec<String>,
}

/// Why points make no motion: the number of the point, what is wrong, the way out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PointError {
    /// Counted from 0.
    pub point: usize,
    /// What is wrong there.
    pub message: String,
    /// What to do about it.
    pub hint: String,
}

impl PointError {
    pub(crate) fn new(point: usize, message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { point, message: message.into(), hint: hint.into() }
    }
}

impl Motion {
    /// Joins points by curves. A single point is a motion that stands still.
    ///
    /// # Errors
    /// No point; rows of the wrong length; a number that is not finite or larger than 10⁴; times that do not increase, or that
    /// some points lack; velocities or accelerations that the interpolation needs and points lack; quaternions that are not of
    /// length 1.
    pub fn through(
        robot: &Robot,
        coordinates: Vec<usize>,
        points: &[Point],
        interpolation: Interpolation,
        turns: Turns,
    ) -> Result<Self, PointError> {
        let how = How { interpolation, turns, straight: &[], scaled: false };
        Self::through_some(robot, coordinates, points, &how)
    }

    /// As [`Self::through`], with more to say about how.
    pub(crate) fn through_some(
        robot: &Robot,
        coordinates: Vec<usize>,
        points: &[Point],
        &How { interpolation, turns, straight, scaled }: &How<'_>,
    ) -> Result<Self, PointError> {
        check(points, coordinates.len())?;
        let timed = points[0].time.is_some();
        let roots = quaternions(robot, &coordinates)?;
        let free = turning_freely(robot, &coordinates, turns);
        let mut segments = Vec::with_capacity(points.len().max(2) - 1);
        let mut before: Option<Vec<f64>> = None;
        for index in 0..points.len().max(2) - 1 {
            let (a, b) = (&points[index], &points[(index + 1).min(points.len() - 1)]);
            let from = before.take().unwrap_or_else(|| a.positions.clone());
            let to = unwrapped(&from, &b.positions, &free);
            let start = a.time.unwrap_or(index as f64);
            let duration = if points.len() == 1 { 1.0 } else { b.time.map_or(1.0, |end| end - start) };
            let ends = Ends { a, b, from: &from, to: &to, duration, straight };
            let mut curves =
                ends.curves(interpolation).map_err(|(message, hint)| PointError::new(index, message, hint))?;
            let mut turning = Vec::with_capacity(roots.len());
            for root in &roots {
                let numbers = Scaled::of(root.columns.map(|c| curves[c].number())).filter(|_| scaled);
                if numbers.is_some_and(|numbers| numbers.is_near_zero()) {
                    let hint = "give points closer to each other";
                    return Err(PointError::new(index, "its quaternion passes near zero on the way to the next", hint));
                }
                root.columns.iter().for_each(|&c| curves[c] = Curve::Quaternion);
                let (one, other) = (root.read(a, index)?, root.read(b, index + 1)?);
                turning.push(Turn { q: root.q, from: one, by: log_so3(one.conjugate() * other), scaled: numbers });
            }
            segments.push(Segment { start, duration, curves, turns: turning });
            before = Some(to);
        }
        let (start, attachments, notes) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self { coordinates, segments, timed, start, attachments, notes })
    }

    /// When it begins, seconds or number of a point.
    #[must_use]
    pub fn starts(&self) -> f64 {
        self.segments.first().map_or(0.0, |s| s.start)
    }

    /// When it ends.
    #[must_use]
    pub fn ends(&self) -> f64 {
        self.segments.last().map_or(0.0, |s| s.start + s.duration)
    }

    /// The time at a place: number of the segment, and how much of it.
    #[must_use]
    pub fn time(&self, place: f64) -> f64 {
        let (segment, u) = self.split(place);
        segment.map_or(0.0, |s| s.start + u * s.duration)
    }

    /// The place at a time, the nearest where that is outside.
    #[must_use]
    pub fn place(&self, time: f64) -> f64 {
        let index = self.segments.partition_point(|s| s.start <= time).saturating_sub(1);
        let Some(segment) = self.segments.get(index) else { return 0.0 };
        index as f64 + ((time - segment.start) / segment.duration).clamp(0.0, 1.0)
    }

    pub(crate) fn split(&self, place: f64) -> (Option<&Segment>, f64) {
        let index = (place.max(0.0) as usize).min(self.segments.len().saturating_sub(1));
        (self.segments.get(index), (place - index as f64).clamp(0.0, 1.0))
    }

    /// Writes the coordinates that move into a configuration.
    pub fn write(&self, place: f64, q: &mut [f64]) {
        let (Some(segment), u) = self.split(place) else { return };
        for (&index, curve) in self.coordinates.iter().zip(&segment.curves) {
            if let Curve::Number(p) = curve {
                q[index] = p.at(u);
            }
        }
        for turn in &segment.turns {
            let turned = match &turn.scaled {
                Some(scaled) => scaled.at(u),
                None => (turn.from * exp_so3(turn.by * u)).normalize(),
            };
            q[turn.q..turn.q + 4].copy_from_slice(&turned.to_array());
        }
    }

    /// The highest degree of its polynomials.
    #[must_use]
    pub fn degree(&self) -> usize {
        let of = |c: &Curve| if let Curve::Number(p) = c { p.degree() } else { 1 };
        self.segments.iter().flat_map(|s| s.curves.iter().map(of)).max().unwrap_or(0)
    }
}

/// Two points in a row.
struct Ends<'a> {
    a: &'a Point,
    b: &'a Point,
    from: &'a [f64],
    to: &'a [f64],
    duration: f64,
    straight: &'a [usize],
}

impl Ends<'_> {
    fn curves(&self, wanted: Interpolation) -> Result<Vec<Curve>, (String, String)> {
        let velocities = self.a.velocities.as_ref().zip(self.b.velocities.as_ref());
        let accelerations = self.a.accelerations.as_ref().zip(self.b.accelerations.as_ref());
        let timed = self.a.time.is_some();
        let lacks = |what: &str| {
            let missing = if timed { what } else { "times" };
            (format!("has no {missing}"), format!("give {missing}, or choose another --interpolation"))
        };
        let degree = match wanted {
            Interpolation::Linear => 1,
            Interpolation::Auto if !timed || velocities.is_none() => 1,
            Interpolation::Auto if accelerations.is_none() => 3,
            Interpolation::Cubic if timed => 3,
            Interpolation::Cubic => return Err(lacks("velocities")),
            Interpolation::Quintic if timed => 5,
            Interpolation::Quintic => return Err(lacks("accelerations")),
            Interpolation::Auto => 5,
        };
        let t = self.duration;
        let curve = |i: usize| -> Result<Curve, (String, String)> {
            let (from, to) = (self.from[i], self.to[i]);
            if degree == 1 || self.straight.contains(&i) {
                return Ok(Curve::Number(Polynomial::linear(from, to)));
            }
            let (v, w) = velocities.ok_or_else(|| lacks("velocities"))?;
            if degree == 3 {
                return Ok(Curve::Number(Polynomial::cubic((from, v[i] * t), (to, w[i] * t))));
            }
            let (a, b) = accelerations.ok_or_else(|| lacks("accelerations"))?;
            let ends = ([from, v[i] * t, a[i] * t * t], [to, w[i] * t, b[i] * t * t]);
            Ok(Curve::Number(Polynomial::quintic(ends.0, ends.1)))
        };
        (0..self.from.len()).map(curve).collect()
    }
}

fn check(points: &[Point], width: usize) -> Result<(), PointError> {
    let Some(first) = points.first() else {
        return Err(PointError::new(0, "there is no point", "a motion has at least one"));
    };
    if points.len() > POINTS {
        return Err(PointError::new(POINTS, format!("more than {POINTS} points"), "cut the motion up"));
    }
    for (index, point) in points.iter().enumerate() {
        let rows = [Some(&point.positions), point.velocities.as_ref(), point.accelerations.as_ref()];
        for (row, what) in rows.into_iter().zip(["positions", "velocities", "accelerations"]) {
            let Some(row) = row else { continue };
            if row.len() != width {
                let message = format!("has {} {what}, and {width} joints are named", row.len());
                return Err(PointError::new(index, message, ""));
            }
            let cap = if what == "positions" { FARTHEST } else { FARTHEST * FARTHEST };
            if let Some(column) = row.iter().position(|x| x.is_nan() || x.abs() > cap) {
                let message = format!("{what}[{column}] is {}", row[column]);
                return Err(PointError::new(index, message, format!("numbers are finite and at most {cap:e}")));
            }
        }
        if point.velocities.is_none() && point.accelerations.is_some() {
            let hint = "no controller interpolates this way: give velocities, or leave accelerations out";
            return Err(PointError::new(index, "has accelerations and no velocities", hint));
        }
        if point.time.is_some() != first.time.is_some() {
            return Err(PointError::new(index, "some points have times and some have none", "give all or none"));
        }
        let Some(time) = point.time else { continue };
        let before = index.checked_sub(1).and_then(|i| points[i].time);
        let is_later = before.is_none_or(|before| time > before);
        if !(time.abs() <= 1e9 && is_later) {
            let message = match before {
                Some(before) => format!("its time is {time} s, that of the point before is {before} s"),
                None => format!("its time is {time} s"),
            };
            return Err(PointError::new(index, message, "times are finite and increase strictly"));
        }
    }
    Ok(())
}

/// A quaternion among the coordinates of a motion.
struct QuaternionColumns {
    q: usize,
    columns: [usize; 4],
}

impl QuaternionColumns {
    fn read(&self, point: &Point, index: usize) -> Result<DQuat, PointError> {
        let numbers = self.columns.map(|c| point.positions[c]);
        let length = numbers.iter().map(|x| x * x).sum::<f64>().sqrt();
        // Compared so that NaN is refused.
        let is_one = (length - 1.0).abs() < 1e-3;
        if !is_one {
            let message = format!("the quaternion {numbers:?} has length {length:.4}");
            return Err(PointError::new(index, message, "order is x y z w; a rotation has length 1"));
        }
        Ok(DQuat::from_array(numbers).normalize())
    }
}

fn quaternions(robot: &Robot, coordinates: &[usize]) -> Result<Vec<QuaternionColumns>, PointError> {
    let mut found = Vec::new();
    for joint in &robot.joints {
        let (JointMotion::FreeFlyer, Source::Coordinates { q, .. }) = (joint.motion, joint.source) else { continue };
        let column = |i: usize| coordinates.iter().position(|&c| c == q + 3 + i);
        match [column(0), column(1), column(2), column(3)] {
            [Some(x), Some(y), Some(z), Some(w)] => found.push(QuaternionColumns { q: q + 3, columns: [x, y, z, w] }),
            [None, None, None, None] => {}
            _ => {
                let message = format!("of the orientation of `{}` only a part is named", joint.name);
                return Err(PointError::new(0, message, "name qx, qy, qz and qw, or none"));
            }
        }
    }
    Ok(found)
}

/// By coordinate of the motion: whether it goes the shortest way round.
fn turning_freely(robot: &Robot, coordinates: &[usize], turns: Turns) -> Vec<bool> {
    let is_circle = |index: usize| {
        robot.joints.iter().enumerate().any(|(j, joint)| {
            let Source::Coordinates { q, .. } = joint.source else { return false };
            match joint.motion {
                JointMotion::Revolute { .. } => q == index && is_unlimited(robot, JointIndex(j as u32)),
                JointMotion::Planar => q + 2 == index,
                JointMotion::Prismatic { .. } | JointMotion::FreeFlyer => false,
            }
        })
    };
    coordinates.iter().map(|&index| turns == Turns::Shortest && is_circle(index)).collect()
}

fn is_unlimited(robot: &Robot, joint: JointIndex) -> bool {
    let joint = &robot.joints[joint.at()];
    joint.lower[0] == f64::NEG_INFINITY && joint.upper[0] == f64::INFINITY
}

/// The next row, with full turns added so that it is the shortest way there.
fn unwrapped(from: &[f64], to: &[f64], free: &[bool]) -> Vec<f64> {
    let next = |((&from, &to), &free): ((&f64, &f64), &bool)| match free {
        true => to - std::f64::consts::TAU * ((to - from) / std::f64::consts::TAU).round(),
        false => to,
    };
    from.iter().zip(to).zip(free).map(next).collect()
}
