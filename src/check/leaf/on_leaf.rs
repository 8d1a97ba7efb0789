//! A segment that is to stay on its leaf, and the proof of its grasps, contacts and rests.
//!
//! Errors of relative poses are in R³ × SO(3): position and rotation apart. With all three rotations fixed the error is the
//! angle, with one free the angle between the free axis and where it should be.

use crate::check::leaf::footing::footing;
use crate::check::motion::reach::{Bends, Reach};
use crate::check::motion::residual::{Form, Formed, Relation, prove};
use crate::check::motion::segment::{At, SegmentMotion};
use crate::check::report::check_report::{CheckReport, Place};
use crate::check::report::kind::Kind;
use crate::check::report::work::Work;
use crate::check::world::attachments::Attachment;
use crate::check::world::models::{Frame, Link, corners, normal};
use crate::path_file::constraint::FrameEntry;
use crate::path_file::document::{PathFile, SurfaceEntry};
use foliate_components::Pose;
use foliate_components::robot::PartKind;
use glam::DVec3;

/// A segment under proof.
pub(crate) struct Leaf<'l> {
    pub motion: &'l SegmentMotion<'l>,
    pub file: &'l PathFile,
    pub reach: &'l Reach,
    pub report: &'l mut CheckReport,
    pub work: &'l mut Work,
}

impl Leaf<'_> {
    pub(crate) fn tolerance(&self) -> f64 {
        self.file.certificate.path_tolerance
    }

    /// Proves forms of the pose of a frame in another one.
    pub(crate) fn prove(
        &mut self,
        [to, frame]: [&Frame; 2],
        pose: &dyn Fn(At) -> Pose,
        relation: &Relation<'_>,
        forms: &[Named],
    ) {
        let end = (frame.body, frame.body_from_frame.translation.length());
        let bends = self.reach.bends(to.body, end, self.motion.knots.len());
        self.prove_forms(pose, &bends, relation, forms);
    }

    /// Proves forms of a pose of which it is known how it moves.
    pub(crate) fn prove_forms(
        &mut self,
        pose: &dyn Fn(At) -> Pose,
        bends: &Bends,
        relation: &Relation<'_>,
        forms: &[Named],
    ) {
        for (what, form) in forms {
            let quantity = Formed { form, pose, bends };
            prove(self.motion, &quantity, what, relation, self.report, self.work);
        }
    }

    pub(crate) fn grasp(
        &mut self,
        subject: &str,
        gripper: &Frame,
        handle: &Frame,
        mask: [bool; 6],
        complement: [bool; 6],
    ) {
        if !mask.iter().chain(&complement).any(|row| *row) {
            let place = Place { segment: Some(self.motion.index), t: None };
            self.report.violate(place, Kind::Grasp, format!("{subject}: fixes nothing"), None, None);
        }
        let motion = self.motion;
        let pose = |at: At| motion.frame(gripper, at).inverse() * motion.frame(handle, at);
        let tolerance = self.tolerance();
        let mut prove = |kind, forms: &[Named]| {
            self.prove([gripper, handle], &pose, &Relation { kind, subject, tolerance }, forms);
        };
        prove(Kind::Grasp, &zero(mask));
        prove(Kind::GraspConstancy, &frozen(&pose(At::knot(0)), mask, complement));
    }

    pub(crate) fn contact(
        &mut self,
        subject: &str,
        support: (&Frame, &SurfaceEntry),
        (held, surface): (&Link, &SurfaceEntry),
    ) {
        let motion = self.motion;
        let object = &held.frame;
        let pose = |at: At| motion.frame(support.0, at).inverse() * motion.frame(object, at);
        let first = pose(At::knot(0));
        let tolerance = self.tolerance();
        let forms = self.contact_forms(&first, (held, surface), support.1);
        if forms.is_empty() {
            let place = Place { segment: Some(motion.index), t: None };
            let subject = format!("{subject}: the object cannot rest on any polygon of that surface");
            self.report.violate(place, Kind::Placement, subject, None, None);
        }
        let mut prove = |kind, forms: &[Named]| {
            self.prove([support.0, object], &pose, &Relation { kind, subject, tolerance }, forms);
        };
        prove(Kind::Placement, &forms);
        prove(Kind::PlacementConstancy, &frozen(&first, [false; 6], [true; 6]));
    }

    /// What rests without polygons rests on something that is fixed in the world: what moves carries only what it holds, or
    /// what lies on one of its surfaces.
    pub(crate) fn stands(&mut self, attachment: &Attachment, holder: &Link) {
        let fixed = |part: usize| self.motion.world.parts[part].kind == PartKind::Environment;
        if holder.frame.body.is_some() && !fixed(holder.part) {
            let place = Place { segment: Some(self.motion.index), t: None };
            let subject = format!("{}: which is not fixed in the world", attachment.name);
            self.report.violate(place, Kind::Placement, subject, None, None);
        }
    }

    /// What rests without polygons is held up by a constraint: its height and both its tilts at least.
    pub(crate) fn says_how(&mut self, attachment: &Attachment) {
        let motion = self.motion;
        let object = &motion.world.parts[attachment.part].name;
        let of_object = |frame: &Option<FrameEntry>| {
            frame.as_ref().is_some_and(|frame| frame.parts().0.split('/').next() == Some(object))
        };
        let entries = &self.file.segments[motion.index].constraints;
        let says = entries.iter().any(|entry| {
            let rows = entry.mask.unwrap_or_default();
            entry.kind == "pose"
                && of_object(&entry.frame) != of_object(&entry.to)
                && rows.iter().filter(|r| **r).count() >= 3
        });
        if !says {
            let place = Place { segment: Some(motion.index), t: None };
            let subject = format!("{}: no constraint says how it rests", attachment.name);
            self.report.violate(place, Kind::Placement, subject, None, None);
        }
    }

    /// How it rests is said by a constraint; here that it stays.
    pub(crate) fn rest(&mut self, subject: &str, support: &Frame, object: &Frame) {
        let motion = self.motion;
        let pose = |at: At| motion.frame(support, at).inverse() * motion.frame(object, at);
        let relation = Relation { kind: Kind::PlacementConstancy, subject, tolerance: self.tolerance() };
        self.prove([support, object], &pose, &relation, &frozen(&pose(At::knot(0)), [false; 6], [true; 6]));
    }

    /// Errors of the pair of polygons that fits best at the first knot: opposite normals, the gap, and what must be over the support
    /// there. Empty where no polygon of the surface can carry the object.
    fn contact_forms(
        &self,
        first: &Pose,
        (held, surface): (&Link, &SurfaceEntry),
        support: &SurfaceEntry,
    ) -> Vec<Named> {
        let mut best: Option<(f64, Vec<Named>)> = None;
        for lower in support.polygons.iter().map(|p| corners(support, p)) {
            for upper in surface.polygons.iter().map(|p| corners(surface, p)) {
                let Some(forms) = self.polygon_forms(held, &upper, &lower) else { continue };
                let worst = forms.iter().map(|(_, form)| form.error_at(first)).sum();
                if best.as_ref().is_none_or(|(least, _)| worst < *least) {
                    best = Some((worst, forms));
                }
            }
        }
        best.map_or_else(Vec::new, |(_, forms)| forms)
    }

    fn polygon_forms(&self, held: &Link, upper: &[DVec3], lower: &[DVec3]) -> Option<Vec<Named>> {
        let (up, down) = (normal(lower)?, normal(upper)?);
        let (file, world) = (self.file, self.motion.world);
        let footing = footing(world, held, file.rests, (upper, down), self.tolerance())?;
        let mean = |corners: &[DVec3]| corners.iter().sum::<DVec3>() / corners.len() as f64;
        let (centre, gap) = (mean(upper), file.placement_margin);
        let edges = lower.iter().zip(lower.iter().cycle().skip(1));
        let plane =
            |(a, b): (&DVec3, &DVec3)| (*b - *a).cross(up).try_normalize().map(|n| (n, n.dot(*a) - footing.margin));
        let planes: Vec<_> = edges.filter_map(plane).collect();
        let mut forms = vec![
            ("normals not opposite", Form::Direction { local: down, wanted: -up }),
            ("gap is not the margin", Form::Height { point: centre, normal: up, offset: up.dot(mean(lower)) + gap }),
        ];
        let over = |(what, point): (_, DVec3)| (what, Form::Outside { point, planes: planes.clone() });
        forms.extend(footing.points.into_iter().map(over));
        Some(forms)
    }
}

/// A form with its name.
pub(crate) type Named = (&'static str, Form);

/// The rows of a mask are zero.
pub(crate) fn zero(mask: [bool; 6]) -> Vec<Named> {
    let mut forms = translation(&Pose::identity(), [mask[0], mask[1], mask[2]]);
    forms.extend(rotation(&Pose::identity(), [mask[3], mask[4], mask[5]]));
    forms
}

/// Errors of the rows of the complement against the first pose. Rotations are told together with those of the mask:
/// what is fixed and what is frozen leaves nothing free, or one axis.
fn frozen(first: &Pose, mask: [bool; 6], complement: [bool; 6]) -> Vec<Named> {
    let mut forms = translation(first, [complement[0], complement[1], complement[2]]);
    if complement[3..].contains(&true) {
        forms.extend(rotation(first, std::array::from_fn(|i| mask[i + 3] || complement[i + 3])));
    }
    forms
}

fn translation(wanted: &Pose, rows: [bool; 3]) -> Vec<Named> {
    let form = Form::Rows { from: wanted.translation, rows };
    if rows.contains(&true) { vec![("translation", form)] } else { Vec::new() }
}

fn rotation(wanted: &Pose, rows: [bool; 3]) -> Vec<Named> {
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
