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
