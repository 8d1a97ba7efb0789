//! Whether a segment stays on its leaf: grasps and placements are what they should be and do not change, further
//! constraints hold; all of it between the knots too.
//!
//! Errors of relative poses are in R³ × SO(3): position and rotation apart. With all three rotations fixed the error is
//! the angle, with one free the angle between the free axis and where it should be.

use super::attachments::{Attachment, Bond, corners, normal};
use super::documents::Frames;
use super::models::{Frame, shown};
use super::motion::{At, SegmentMotion};
use super::reach::Reach;
use super::report::{CheckReport, Kind, Place};
use super::residual::{Form, Relation, Relative, prove};
use super::{CheckError, Work};
use crate::path_file::{ConstraintEntry, PathFile, SurfaceEntry};
use foliate_components::Pose;
use foliate_components::pose::pose_from_array;
use glam::DVec3;

pub(super) fn check(
    motion: &SegmentMotion<'_>,
    file: &PathFile,
    frames: &Frames,
    attachments: &[Attachment],
    report: &mut CheckReport,
    work: &mut Work,
) -> Result<(), CheckError> {
    let entry = &file.segments[motion.index];
    if attachments.iter().all(|a| a.held.is_none()) && entry.constraints.is_empty() {
        return Ok(());
    }
    let reach = Reach::new(motion);
    let mut leaf = Leaf { motion, file, reach: &reach, report, work };
    for attachment in attachments {
        match &attachment.held {
            Some((.., Bond::Grasp { gripper, handle, mask, complement })) => {
                leaf.grasp(&attachment.name, gripper, handle, *mask, *complement);
            }
            Some((holder, held, Bond::Contact { surface, support })) => {
                let documents = &file.documents.surfaces;
                if let (Some(surface), Some(support)) = (documents.get(surface), documents.get(support)) {
                    leaf.contact(&attachment.name, (&holder.frame, support), (&held.frame, surface));
                }
            }
            None => {}
        }
    }
    for (number, constraint) in entry.constraints.iter().enumerate() {
        let place = format!("segments[{}].constraints[{number}]", motion.index);
        leaf.constraint(constraint, frames, &place)?;
    }
    Ok(())
}

struct Leaf<'l> {
    motion: &'l SegmentMotion<'l>,
    file: &'l PathFile,
    reach: &'l Reach,
    report: &'l mut CheckReport,
    work: &'l mut Work,
}

impl Leaf<'_> {
    fn tolerance(&self) -> f64 {
        self.file.certificate.path_tolerance
    }

    fn prove(&mut self, pose: &dyn Fn(At) -> Pose, frames: [&Frame; 2], relations: Vec<Relation<'_>>) {
        let end = |f: &Frame| (f.body, f.body.map_or(0.0, |_| f.body_from_frame.translation.length()));
        let (joints, length) = self.reach.way(end(frames[0]), end(frames[1]));
        let travel = self.reach.total(&joints, self.motion.knots.len());
        let relative = Relative { pose, travel, length };
        for relation in relations.iter().filter(|r| !r.forms.is_empty()) {
            prove(self.motion, &relative, relation, self.report, self.work);
        }
    }

    fn grasp(&mut self, subject: &str, gripper: &Frame, handle: &Frame, mask: [bool; 6], complement: [bool; 6]) {
        let motion = self.motion;
        let pose = |at: At| motion.frame(gripper, at).inverse() * motion.frame(handle, at);
        let tolerance = self.tolerance();
        let relations = vec![
            Relation { kind: Kind::Grasp, subject, tolerance, forms: zero(&Pose::identity(), mask) },
            Relation {
                kind: Kind::GraspConstancy,
                subject,
                tolerance,
                forms: frozen(&pose(At::knot(0)), mask, complement),
            },
        ];
        self.prove(&pose, [gripper, handle], relations);
    }

    fn contact(&mut self, subject: &str, support: (&Frame, &SurfaceEntry), surface: (&Frame, &SurfaceEntry)) {
        let motion = self.motion;
        let pose = |at: At| motion.frame(support.0, at).inverse() * motion.frame(surface.0, at);
        let first = pose(At::knot(0));
        let tolerance = self.tolerance();
        let forms = contact_forms(&first, surface.1, support.1, self.file.placement_margin);
        let relations = vec![
            Relation { kind: Kind::Placement, subject, tolerance, forms },
            Relation {
                kind: Kind::PlacementConstancy,
                subject,
                tolerance,
                forms: frozen(&first, [false; 6], [true; 6]),
            },
        ];
        self.prove(&pose, [support.0, surface.0], relations);
    }

    fn constraint(&mut self, entry: &ConstraintEntry, frames: &Frames, place: &str) -> Result<(), CheckError> {
        let subject = format!("{} of {} in {}", shown(&entry.kind), shown(&entry.frame), shown(&entry.to));
        let tolerance = entry.tolerance;
        if tolerance > self.tolerance() {
            self.report.note(format!("{subject}: its tolerance {tolerance} exceeds the path tolerance"));
        }
        let mut rows = entry.mask;
        let is_mass = matches!(entry.kind.as_str(), "centre_of_mass" | "center_of_mass");
        match entry.kind.as_str() {
            "pose" | "relative_pose" => {}
            "position" | "centre_of_mass" | "center_of_mass" => rows[3..].fill(false),
            "orientation" => rows[..3].fill(false),
            _ => {
                self.unchecked(&format!("{subject}: this checker knows no such kind"));
                return Ok(());
            }
        }
        if rows[3..].iter().filter(|r| **r).count() == 1 {
            self.unchecked(&format!("{subject}: one rotation alone is not bounded"));
            return Ok(());
        }
        let world = self.motion.world;
        let to = frames.named(world, &entry.to, || format!("{place}.to"))?;
        if is_mass {
            return self.centre_of_mass(entry, &to, rows, &subject, place);
        }
        let frame = frames.named(world, &entry.frame, || format!("{place}.frame"))?;
        let motion = self.motion;
        let to_from_frame = |at: At| motion.frame(&to, at).inverse() * motion.frame(&frame, at);
        let back = value(entry).unwrap_or_else(|| to_from_frame(At::knot(0))).inverse();
        let pose = |at: At| back * to_from_frame(at);
        let forms = zero(&Pose::identity(), rows);
        self.prove(
            &pose,
            [&to, &frame],
            vec![Relation { kind: Kind::Constraint, subject: &subject, tolerance, forms }],
        );
        Ok(())
    }

    fn unchecked(&mut self, subject: &str) {
        let place = Place { segment: Some(self.motion.index), t: None };
        self.report.violate(place, Kind::UncheckedConstraint, subject, None, None);
    }

    /// The centre of mass of a part as a point in `to`: a mean of points of links, so no farther and no faster than
    /// the worst of them; all joints on the way to any link count.
    fn centre_of_mass(
        &mut self,
        entry: &ConstraintEntry,
        to: &Frame,
        rows: [bool; 6],
        subject: &str,
        place: &str,
    ) -> Result<(), CheckError> {
        let owner = entry.frame.split('/').next().unwrap_or_default();
        let motion = self.motion;
        let Some(part) = motion.world.part(owner) else {
            let message = format!("there is no part `{}`", shown(owner));
            return Err(CheckError::malformed(format!("{place}.frame"), message));
        };
        let masses = &motion.world.masses[part];
        let total: f64 = masses.iter().map(|(_, mass)| mass).sum();
        let has_mass = total > 0.0 && total.is_finite();
        if !has_mass {
            let message = format!("`{}` has no mass, so no centre of mass", shown(owner));
            return Err(CheckError::malformed(format!("{place}.frame"), message));
        }
        let centre = |at: At| {
            let sum: DVec3 = masses.iter().map(|(frame, mass)| motion.frame(frame, at).translation * *mass).sum();
            Pose::from_translation(motion.frame(to, at).inverse().transform_point(sum / total))
        };
        let back = value(entry).unwrap_or_else(|| centre(At::knot(0))).inverse();
        let pose = |at: At| back * centre(at);
        let end = |f: &Frame| (f.body, f.body_from_frame.translation.length());
        let (mut joints, mut length) = (Vec::new(), 0.0_f64);
        for (frame, _) in masses {
            let (on_the_way, far) = self.reach.way(end(to), end(frame));
            joints.extend(on_the_way);
            length = length.max(far);
        }
        joints.sort_unstable();
        joints.dedup();
        let travel = self.reach.total(&joints, motion.knots.len());
        let forms = zero(&Pose::identity(), rows);
        let relation = Relation { kind: Kind::Constraint, subject, tolerance: entry.tolerance, forms };
        prove(motion, &Relative { pose: &pose, travel, length }, &relation, self.report, self.work);
        Ok(())
    }
}

fn value(entry: &ConstraintEntry) -> Option<Pose> {
    entry.value.and_then(pose_from_array)
}

/// Errors of the rows of a mask against a reference.
fn zero(wanted: &Pose, mask: [bool; 6]) -> Vec<(&'static str, Form)> {
    let mut forms = translation(wanted, [mask[0], mask[1], mask[2]]);
    forms.extend(rotation(wanted, [mask[3], mask[4], mask[5]]));
    forms
}

/// Errors of the rows of the complement against the first pose. Rotations are told together with those of the mask:
/// what is fixed and what is frozen leaves nothing free, or one axis.
fn frozen(first: &Pose, mask: [bool; 6], complement: [bool; 6]) -> Vec<(&'static str, Form)> {
    let mut forms = translation(first, [complement[0], complement[1], complement[2]]);
    if complement[3..].contains(&true) {
        forms.extend(rotation(first, std::array::from_fn(|i| mask[i + 3] || complement[i + 3])));
    }
    forms
}

fn translation(wanted: &Pose, rows: [bool; 3]) -> Vec<(&'static str, Form)> {
    let form = Form::Rows { from: wanted.translation, rows };
    if rows.contains(&true) { vec![("translation", form)] } else { Vec::new() }
}

fn rotation(wanted: &Pose, rows: [bool; 3]) -> Vec<(&'static str, Form)> {
    let form = match rows {
        [false, false, false] => return Vec::new(),
        [true, true, true] => Form::Rotation { wanted: wanted.rotation },
        // One free: its axis. One fixed alone is refused where files are read; here it is held to more than it asks.
        [false, true, true] => direction(wanted, DVec3::X),
        [true, false, true] => direction(wanted, DVec3::Y),
        [true, true, false] => direction(wanted, DVec3::Z),
        _ => Form::Rotation { wanted: wanted.rotation },
    };
    vec![("rotation", form)]
}

fn direction(wanted: &Pose, axis: DVec3) -> Form {
    Form::Direction { local: axis, wanted: wanted.rotation * axis }
}

/// Errors of the pair of polygons that fits best at the first knot: opposite normals, the gap, and the object's centre
/// (mean of its corners) inside the support.
fn contact_forms(
    first: &Pose,
    surface: &SurfaceEntry,
    support: &SurfaceEntry,
    margin: f64,
) -> Vec<(&'static str, Form)> {
    let mut best: Option<(f64, Vec<(&'static str, Form)>)> = None;
    for lower in support.polygons.iter().map(|p| corners(support, p)) {
        for upper in surface.polygons.iter().map(|p| corners(surface, p)) {
            let Some(forms) = polygon_forms(&upper, &lower, margin) else { continue };
            let worst = forms.iter().map(|(_, form)| form.error_at(first)).sum();
            if best.as_ref().is_none_or(|(least, _)| worst < *least) {
                best = Some((worst, forms));
            }
        }
    }
    best.map_or_else(Vec::new, |(_, forms)| forms)
}

fn polygon_forms(upper: &[DVec3], lower: &[DVec3], margin: f64) -> Option<Vec<(&'static str, Form)>> {
    let (up, down) = (normal(lower)?, normal(upper)?);
    let mean = |corners: &[DVec3]| corners.iter().sum::<DVec3>() / corners.len() as f64;
    let centre = mean(upper);
    let edges = lower.iter().zip(lower.iter().cycle().skip(1));
    let plane = |(a, b): (&DVec3, &DVec3)| (*b - *a).cross(up).try_normalize().map(|n| (n, n.dot(*a)));
    Some(vec![
        ("normals not opposite", Form::Direction { local: down, wanted: -up }),
        ("gap is not the margin", Form::Height { point: centre, normal: up, offset: up.dot(mean(lower)) + margin }),
        ("centre outside the support", Form::Outside { point: centre, planes: edges.filter_map(plane).collect() }),
    ])
}
