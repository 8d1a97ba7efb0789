//! Constraints that a segment lists besides its attachments: poses, distances, joints at rest. Those on the centre of mass
//! are in `balance`.

use crate::check::leaf::balance;
use crate::check::leaf::case::{Case, inequality, nearest, rows, value};
use crate::check::leaf::on_leaf::Leaf;
use crate::check::motion::reach::Bends;
use crate::check::motion::residual::{Quantity, prove};
use crate::check::motion::segment::At;
use crate::check::report::check_report::{Place, shown};
use crate::check::report::error::CheckError;
use crate::check::report::kind::Kind;
use crate::check::world::documents::Frames;
use crate::path_file::constraint::{Bound, ConstraintEntry};
use glam::DVec3;
use std::f64::consts::PI;

/// Proves one constraint along a segment; what is not known here, or cannot be bounded, is told and not passed over.
pub(crate) fn check(
    leaf: &mut Leaf<'_>,
    entry: &ConstraintEntry,
    frames: &Frames,
    place: &str,
) -> Result<(), CheckError> {
    let mut case = Case::new(entry, frames, place);
    if entry.tolerance > leaf.tolerance() {
        let (subject, tolerance) = (&case.subject, entry.tolerance);
        leaf.report.note(format!("{subject}: its tolerance {tolerance} exceeds the path tolerance"));
    }
    match entry.kind.as_str() {
        "pose" | "relative_pose" => pose(leaf, &case, case.mask()?),
        "position" => {
            let mask = case.mask()?;
            pose(leaf, &case, std::array::from_fn(|i| i < 3 && mask[i]))
        }
        "orientation" => {
            let mask = case.mask()?;
            pose(leaf, &case, std::array::from_fn(|i| i >= 3 && mask[i]))
        }
        "distance" => distance(leaf, &case),
        "tilt" => tilt(leaf, &case),
        "region" => region(leaf, &case),
        "joint" => joint(leaf, &case),
        "centre_of_mass" | "center_of_mass" => balance::centre_of_mass(leaf, &case),
        "centre_of_mass_between" => balance::between(leaf, &case),
        "custom" => {
            case.subject += ": a function of the program's own, not proved here";
            case.unchecked(leaf, "");
            Ok(())
        }
        _ => {
            case.unchecked(leaf, ": this checker knows no such kind");
            Ok(())
        }
    }
}

fn pose(leaf: &mut Leaf<'_>, case: &Case<'_>, mask: [bool; 6]) -> Result<(), CheckError> {
    let entry = case.entry;
    let sided = inequality(entry);
    if sided[3..].contains(&true) {
        case.unchecked(leaf, ": a rotation that must not be negative is not bounded");
        return Ok(());
    }
    if mask[3..].iter().filter(|r| **r).count() == 1 {
        case.unchecked(leaf, ": one rotation alone is not bounded");
        return Ok(());
    }
    let to = case.frame(leaf, "to", entry.to.as_ref())?;
    let frame = case.frame(leaf, "frame", entry.frame.as_ref())?;
    let motion = leaf.motion;
    let to_from_frame = |at: At| motion.frame(&to, at).inverse() * motion.frame(&frame, at);
    let back = value(entry).unwrap_or_else(|| to_from_frame(At::knot(0))).inverse();
    let pose = |at: At| back * to_from_frame(at);
    let forms = rows(mask, sided);
    leaf.prove([&to, &frame], &pose, &case.relation(), &forms);
    Ok(())
}

/// The origin of a frame against planes of another.
fn region(leaf: &mut Leaf<'_>, case: &Case<'_>) -> Result<(), CheckError> {
    let to = case.frame(leaf, "to", case.entry.to.as_ref())?;
    let frame = case.frame(leaf, "frame", case.entry.frame.as_ref())?;
    let motion = leaf.motion;
    let pose = |at: At| motion.frame(&to, at).inverse() * motion.frame(&frame, at);
    let planes: Vec<_> = case.entry.planes.iter().map(balance::plane).collect();
    if planes.is_empty() {
        return case.refuse("planes", "are missing");
    }
    leaf.prove([&to, &frame], &pose, &case.relation(), &planes);
    Ok(())
}

/// The angle between the z axes of two frames.
fn tilt(leaf: &mut Leaf<'_>, case: &Case<'_>) -> Result<(), CheckError> {
    let Some(within) = case.entry.within.filter(|angle| (0.0..=PI).contains(angle)) else {
        return case.refuse("within", "is no angle between 0 and pi");
    };
    let to = case.frame(leaf, "to", case.entry.to.as_ref())?;
    let frame = case.frame(leaf, "frame", case.entry.frame.as_ref())?;
    let motion = leaf.motion;
    let axis = |at: At| (motion.frame(&to, at).rotation.conjugate() * motion.frame(&frame, at).rotation) * DVec3::Z;
    let bends = leaf.reach.bends(to.body, (frame.body, 0.0), motion.knots.len());
    let tilted = Tilted { within, axis: &axis, bends };
    prove(motion, &tilted, "tilted too far", &case.relation(), leaf.report, leaf.work);
    Ok(())
}

/// How far an axis is tilted beyond what it may.
struct Tilted<'a> {
    within: f64,
    /// In the frame from whose z axis the angle is measured.
    axis: &'a dyn Fn(At) -> DVec3,
    bends: Bends,
}

impl Tilted<'_> {
    /// For a height of the axis's tip: the cosine of the angle. What is not a number stays one.
    fn beyond(&self, height: f64) -> f64 {
        let angle = if height.is_nan() { f64::NAN } else { height.clamp(-1.0, 1.0).acos() };
        if angle <= self.within { 0.0 } else { angle - self.within }
    }
}

impl Quantity for Tilted<'_> {
    type Sample = f64;

    fn sample(&self, at: At) -> f64 {
        (self.axis)(at).z
    }

    fn error(&self, height: f64) -> f64 {
        self.beyond(height)
    }

    /// A unit vector that turns with ω has a second derivative of ω² + |ω′| at most, and so has its height.
    fn bound(&self, knot: usize, share: f64, [a, b]: [f64; 2]) -> f64 {
        let (turn, turn_bend) = (self.bends.turn[knot], self.bends.turn_bend[knot]);
        let swell = (turn * turn + turn_bend) * share * share / 8.0;
        // Either being no number makes the sum none.
        self.beyond(a.min(b) - swell + 0.0 * (a + b))
    }

    fn travel(&self, knot: usize) -> f64 {
        self.bends.travel[knot]
    }
}

fn distance(leaf: &mut Leaf<'_>, case: &Case<'_>) -> Result<(), CheckError> {
    let entry = case.entry;
    let to = case.frame(leaf, "to", entry.to.as_ref())?;
    let frame = case.frame(leaf, "frame", entry.frame.as_ref())?;
    let motion = leaf.motion;
    let vector = |at: At| (motion.frame(&to, at).inverse() * motion.frame(&frame, at)).translation;
    let end = (frame.body, frame.body_from_frame.translation.length());
    let apart = Apart {
        length: entry.length.unwrap_or_else(|| vector(At::knot(0)).length()),
        bound: entry.bound.unwrap_or_default(),
        bends: leaf.reach.bends(to.body, end, motion.knots.len()),
        vector: &vector,
    };
    prove(motion, &apart, "length", &case.relation(), leaf.report, leaf.work);
    Ok(())
}

/// The length of a vector against what it should be.
struct Apart<'a> {
    length: f64,
    bound: Bound,
    bends: Bends,
    vector: &'a dyn Fn(At) -> DVec3,
}

impl Apart<'_> {
    /// How far lengths between these are off at worst.
    fn off(&self, least: f64, most: f64) -> f64 {
        let (short, long) = (self.length - least, most - self.length);
        match self.bound {
            Bound::Equal => short.max(long),
            Bound::AtLeast => short.max(0.0),
            Bound::AtMost => long.max(0.0),
        }
    }
}

impl Quantity for Apart<'_> {
    type Sample = DVec3;

    fn sample(&self, at: At) -> DVec3 {
        (self.vector)(at)
    }

    fn error(&self, vector: DVec3) -> f64 {
        let length = vector.length();
        self.off(length, length)
    }

    fn bound(&self, knot: usize, share: f64, [a, b]: [DVec3; 2]) -> f64 {
        let swell = self.bends.point[knot] * share * share / 8.0;
        self.off(nearest(a, b) - swell, a.length().max(b.length()) + swell)
    }

    fn travel(&self, knot: usize) -> f64 {
        self.bends.travel[knot]
    }
}

/// Of a joint of one coordinate the extremes between knots are known.
pub(crate) fn joint(leaf: &mut Leaf<'_>, case: &Case<'_>) -> Result<(), CheckError> {
    let Some(name) = &case.entry.joint else { return case.refuse("joint", "is missing") };
    let motion = leaf.motion;
    let body = motion.world.bodies.iter().position(|b| &b.name == name);
    let Some(body) = body.filter(|&b| motion.world.bodies[b].motion.configuration_size() == 1) else {
        return case.refuse("joint", format!("there is no joint `{}` of one coordinate", shown(name)));
    };
    let wanted = case.entry.position.unwrap_or_else(|| motion.scalar(body, At::knot(0)));
    for (knot, error) in motion.farthest_from(body, wanted).enumerate() {
        // Compared so that NaN is off.
        let fine = error <= case.entry.tolerance;
        if !fine {
            let place = Place::at(motion.index, knot as f64);
            leaf.report.violate(place, Kind::Constraint, &case.subject, error, case.entry.tolerance);
        }
        leaf.report.see_residual(error, motion.index, knot as f64, || case.subject.clone());
    }
    Ok(())
}
