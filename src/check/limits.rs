//! Limits and bounds, joint knots, quaternions, environments and times: what needs no geometry. Limits of rates are in `timing`.

use crate::check::motion::curve::{Cubic, Turning};
use crate::check::report::check_report::{CheckReport, Place, shown};
use crate::check::report::kind::Kind;
use crate::check::world::models::{Value, World};
use crate::path_file::document::{PathFile, SegmentEntry};
use foliate_components::robot::{JointType, PartKind};

/// Rounding allowed beyond a limit, radians or metres.
const SLACK: f64 = 1e-9;
/// How far a quaternion's norm may be from one.
const UNIT: f64 = 1e-9;
/// What the length of a quaternion's numbers is at least between knots, before they are scaled to length 1.
const SHORTEST: f64 = 0.5;

pub(super) fn check(file: &PathFile, world: &World, report: &mut CheckReport) {
    note_differences(file, world, report);
    for (index, segment) in file.segments.iter().enumerate() {
        let mut checker = Checker { file, world, segment, index, report };
        for body in 0..world.bodies.len() {
            checker.body(body);
        }
        checker.times();
        if let Some(before) = index.checked_sub(1) {
            checker.shared_knot(&file.segments[before]);
            checker.time_goes_on(&file.segments[before]);
        }
    }
}

/// Where the file's limits are not the models': a scene may set them, and a reader of the file should know.
fn note_differences(file: &PathFile, world: &World, report: &mut CheckReport) {
    for body in &world.bodies {
        let Value::Columns(columns) = &body.value else { continue };
        if body.motion.configuration_size() != 1 {
            continue;
        }
        let (name, (low, high)) = (&file.coordinates[columns[0]], body.limits);
        // A joint of the environment has its value in the file, and does not move.
        let stands = world.parts[body.part].kind == PartKind::Environment;
        match file.limits.get(name) {
            None if stands => {}
            None if low.is_finite() || high.is_finite() => {
                report.note(format!("no limits of {name}: the model's [{low}, {high}] are taken"));
            }
            Some([l, h]) if differ(*l, low) || differ(*h, high) => {
                let text = format!("limits of {name} are [{l}, {h}], the model says [{low}, {high}]");
                let wider = *l < low - SLACK || *h > high + SLACK;
                if wider { report.weaker(text) } else { report.note(text) }
            }
            _ => {}
        }
    }
}

fn differ(a: f64, b: f64) -> bool {
    a != b && (a - b).abs() > SLACK
}

struct Checker<'c> {
    file: &'c PathFile,
    world: &'c World,
    segment: &'c SegmentEntry,
    index: usize,
    report: &'c mut CheckReport,
}

impl Checker<'_> {
    fn violate(&mut self, t: f64, kind: Kind, subject: String, value: f64, limit: f64) {
        self.report.violate(Place::at(self.index, t), kind, subject, value, limit);
    }

    fn body(&mut self, index: usize) {
        let body = &self.world.bodies[index];
        let part = &self.world.parts[body.part];
        match &body.value {
            Value::Still => {}
            Value::Follows { .. } => self.follower(index),
            Value::Columns(columns) if part.kind == PartKind::Environment => self.environment(columns),
            Value::Columns(columns) if part.root == Some(index) && part.floats => {
                self.quaternions(columns, &body.name);
                let knots = self.resting_knots(&part.name);
                columns.iter().for_each(|&c| self.column(c, &knots, Kind::ObjectBounds));
            }
            Value::Columns(columns) => {
                let numbers = if body.motion == JointType::FreeFlyer { &columns[..3] } else { &columns[..] };
                numbers.iter().for_each(|&c| self.limited(c, body.limits));
                if body.motion == JointType::FreeFlyer {
                    self.quaternions(columns, &body.name);
                    self.turning(&columns[3..]);
                }
            }
        }
    }

    /// Knots that begin or end a segment in which the object rests: placed, or attached to nothing.
    fn resting_knots(&self, part: &str) -> Vec<usize> {
        let mut mine = self.segment.attachments.iter().filter(|a| a.object.split('/').next() == Some(part)).peekable();
        let rests = mine.peek().is_none() || mine.any(|a| a.gripper.is_none());
        let last = self.segment.knots.len() - 1;
        if rests { vec![0, last] } else { Vec::new() }
    }

    fn limits_of(&self, column: usize, otherwise: (f64, f64)) -> (f64, f64) {
        let given = self.file.limits.get(&self.file.coordinates[column]);
        given.map_or(otherwise, |[low, high]| (*low, *high))
    }

    /// Extremes along the whole segment: those of a straight line are at the knots.
    fn limited(&mut self, column: usize, model: (f64, f64)) {
        let (low, high) = self.limits_of(column, model);
        let name = &self.file.coordinates[column];
        for knot in 0..self.intervals() {
            let (least, most) = Cubic::of(self.segment, column, knot).range();
            self.range(knot, Kind::Limit, name, (least, most), (low, high));
            let slack = (least - low).min(high - most);
            if slack.is_finite() {
                self.report.see_limit(slack, self.index, knot as f64, || shown(name));
            }
        }
    }

    /// Intervals between knots; a single knot is one.
    fn intervals(&self) -> usize {
        (self.segment.knots.len() - 1).max(1)
    }

    fn column(&mut self, column: usize, knots: &[usize], kind: Kind) {
        let limits = self.limits_of(column, (f64::NEG_INFINITY, f64::INFINITY));
        let name = &self.file.coordinates[column];
        for &knot in knots {
            self.value(knot, kind, name, self.segment.knots[knot][column], limits);
        }
    }

    fn value(&mut self, knot: usize, kind: Kind, name: &str, value: f64, limits: (f64, f64)) {
        self.range(knot, kind, name, (value, value), limits);
    }

    fn range(&mut self, knot: usize, kind: Kind, name: &str, (least, most): (f64, f64), (low, high): (f64, f64)) {
        if least < low - SLACK {
            self.violate(knot as f64, kind, format!("{} below", shown(name)), least, low);
        }
        if most > high + SLACK {
            self.violate(knot as f64, kind, format!("{} above", shown(name)), most, high);
        }
    }

    /// A follower is where its leader has it, extremes between knots included.
    fn follower(&mut self, index: usize) {
        let (body, led) = (&self.world.bodies[index], self.world.led(index));
        let Some(column) = led.column else { return };
        for knot in 0..self.intervals() {
            let (low, high) = Cubic::of(self.segment, column, knot).range();
            let (a, b) = (led.factor * low + led.offset, led.factor * high + led.offset);
            self.range(knot, Kind::FollowerLimit, &body.name, (a.min(b), a.max(b)), body.limits);
        }
    }

    fn environment(&mut self, columns: &[usize]) {
        let first = &self.file.segments[0].knots[0];
        for &column in columns {
            let moved = |row: &Vec<f64>| (row[column] - first[column]).abs();
            let speeds = self.segment.velocities.iter().flatten().map(|row| row[column].abs());
            let most = self.segment.knots.iter().map(moved).chain(speeds).fold(0.0, f64::max);
            if most > 0.0 {
                let place = Place { segment: Some(self.index), t: None };
                let name = shown(&self.file.coordinates[column]);
                self.report.violate(place, Kind::EnvironmentMoves, name, most, 0.0);
            }
        }
    }

    fn quaternion(&self, columns: &[usize], knot: usize) -> [f64; 4] {
        std::array::from_fn(|i| self.segment.knots[knot][columns[i]])
    }

    fn quaternions(&mut self, columns: &[usize], name: &str) {
        let name = name.strip_suffix("/root_joint").unwrap_or(name);
        for knot in 0..self.segment.knots.len() {
            let here = self.quaternion(&columns[3..], knot);
            let norm = dot(here, here).sqrt();
            if (norm - 1.0).abs() > UNIT {
                self.violate(knot as f64, Kind::QuaternionNorm, shown(name), norm, 1.0);
            }
            if knot + 1 < self.segment.knots.len() {
                let across = dot(here, self.quaternion(&columns[3..], knot + 1));
                if across < 0.0 {
                    self.violate(knot as f64, Kind::QuaternionSign, shown(name), across, 0.0);
                }
                if self.segment.velocities.is_some() {
                    let shortest = self.curve(&columns[3..], knot).shortest();
                    // Compared so that NaN is too short.
                    let long_enough = shortest >= SHORTEST;
                    if !long_enough {
                        let subject = format!("{} between knots, before it is scaled", shown(name));
                        self.violate(knot as f64, Kind::QuaternionNorm, subject, shortest, SHORTEST);
                    }
                }
            }
        }
    }

    fn curve(&self, columns: &[usize], knot: usize) -> Turning {
        Turning(std::array::from_fn(|i| Cubic::of(self.segment, columns[i], knot)))
    }

    /// Limits of quaternion entries along the way, where the file gives any.
    fn turning(&mut self, columns: &[usize]) {
        for (entry, &column) in columns.iter().enumerate() {
            let name = &self.file.coordinates[column];
            let Some(&[low, high]) = self.file.limits.get(name) else { continue };
            if low <= -1.0 && high >= 1.0 {
                continue; // as every unit quaternion
            }
            let last = self.segment.knots.len() - 1;
            for knot in 0..self.intervals() {
                let range = match &self.segment.velocities {
                    Some(_) => self.curve(columns, knot).range(entry),
                    None => {
                        extremes(self.quaternion(columns, knot), self.quaternion(columns, (knot + 1).min(last)), entry)
                    }
                };
                self.range(knot, Kind::Limit, name, range, (low, high));
            }
        }
    }

    /// Time does not run backwards, and nothing moves in no time.
    fn times(&mut self) {
        let Some(times) = &self.segment.times else { return };
        for (knot, pair) in times.windows(2).enumerate() {
            let passed = pair[1] - pair[0];
            if passed < 0.0 {
                self.violate(knot as f64, Kind::Times, "time runs backwards".into(), passed, 0.0);
            } else if passed == 0.0 && self.segment.knots[knot] != self.segment.knots[knot + 1] {
                self.violate(knot as f64, Kind::Times, "a motion in no time".into(), passed, 0.0);
            }
        }
    }

    /// From segment to segment too: all of them have times or none.
    fn time_goes_on(&mut self, before: &SegmentEntry) {
        match (&before.times, &self.segment.times) {
            (None, None) => {}
            (Some(before), Some(times)) => {
                let passed = times.first().zip(before.last()).map_or(0.0, |(now, then)| now - then);
                if passed < 0.0 {
                    self.violate(0.0, Kind::Times, "time runs backwards between segments".into(), passed, 0.0);
                }
            }
            _ => {
                let place = Place { segment: Some(self.index), t: None };
                self.report.violate(place, Kind::Times, "some segments have times and some have none", None, None);
            }
        }
    }

    /// Bit for bit: zeros of different sign differ.
    fn shared_knot(&mut self, before: &SegmentEntry) {
        let Some(last) = before.knots.last() else { return };
        let first = &self.segment.knots[0];
        for (column, name) in self.file.coordinates.iter().enumerate() {
            if last[column].to_bits() != first[column].to_bits() {
                self.violate(0.0, Kind::SharedKnot, shown(name), first[column] - last[column], 0.0);
            }
        }
    }
}

fn dot(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Smallest and largest value of an entry on the geodesic between two unit quaternions: a cos + b sin of the angle.
fn extremes(a: [f64; 4], b: [f64; 4], entry: usize) -> (f64, f64) {
    let along = dot(a, b);
    let across: [f64; 4] = std::array::from_fn(|i| b[i] - along * a[i]);
    let length = dot(across, across).sqrt();
    let (low, high) = (a[entry].min(b[entry]), a[entry].max(b[entry]));
    if length < 1e-12 {
        return (low, high);
    }
    let (x, y) = (a[entry], across[entry] / length);
    let (arc, crest, amplitude) = (length.atan2(along), y.atan2(x), x.hypot(y));
    let inside = |angle: f64| angle > 0.0 && angle < arc;
    let trough = if crest <= 0.0 { crest + std::f64::consts::PI } else { crest - std::f64::consts::PI };
    (if inside(trough) { -amplitude } else { low }, if inside(crest) { amplitude } else { high })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_of_a_geodesic_are_those_of_fine_samples() {
        let unit = |q: [f64; 4]| q.map(|x| x / dot(q, q).sqrt());
        let numbers = [0.3, -0.8, 0.1, 0.9, -0.4, 0.7, 0.2, -0.5, 0.6, 0.05, -0.9, 0.35];
        for start in 0..5 {
            let a = unit(std::array::from_fn(|i| numbers[start + i]));
            let mut b = unit(std::array::from_fn(|i| numbers[(start + 6 + i) % 12]));
            if dot(a, b) < 0.0 {
                b = b.map(|x| -x);
            }
            let angle = dot(a, b).acos();
            for entry in 0..4 {
                let sampled = (0..=1000).map(|i| {
                    let f = f64::from(i) / 1000.0;
                    (((1.0 - f) * angle).sin() * a[entry] + (f * angle).sin() * b[entry]) / angle.sin()
                });
                let (low, high) = sampled.fold((1.0_f64, -1.0_f64), |(l, h), x| (l.min(x), h.max(x)));
                let found = extremes(a, b, entry);
                assert!((found.0 - low).abs() < 1e-5 && (found.1 - high).abs() < 1e-5, "{found:?} {low} {high}");
            }
        }
    }
}
