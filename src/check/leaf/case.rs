//! One constraint of a segment with its place in the file, and what the proofs of all kinds of constraints share.

use crate::check::leaf::on_leaf::{Leaf, Named, zero};
use crate::check::motion::residual::{Form, Relation};
use crate::check::report::check_report::{Place, shown};
use crate::check::report::error::CheckError;
use crate::check::report::kind::Kind;
use crate::check::world::documents::Frames;
use crate::check::world::models::Frame;
use crate::path_file::constraint::{ConstraintEntry, FrameEntry};
use foliate_components::Pose;
use foliate_components::pose::pose_from_array;
use glam::DVec3;

/// A constraint with where it stands.
pub(crate) struct Case<'c> {
    pub entry: &'c ConstraintEntry,
    pub frames: &'c Frames,
    /// JSON path of the constraint.
    pub place: &'c str,
    /// For people.
    pub subject: String,
}

impl<'c> Case<'c> {
    pub(crate) fn new(entry: &'c ConstraintEntry, frames: &'c Frames, place: &'c str) -> Self {
        Self { entry, frames, place, subject: subject(entry) }
    }

    pub(crate) fn refuse<T>(&self, key: &str, message: impl Into<String>) -> Result<T, CheckError> {
        Err(CheckError::malformed(format!("{}.{key}", self.place), message))
    }

    pub(crate) fn relation(&self) -> Relation<'_> {
        Relation { kind: Kind::Constraint, subject: &self.subject, tolerance: self.entry.tolerance }
    }

    pub(crate) fn unchecked(&self, leaf: &mut Leaf<'_>, why: &str) {
        let place = Place { segment: Some(leaf.motion.index), t: None };
        leaf.report.violate(place, Kind::UncheckedConstraint, format!("{}{why}", self.subject), None, None);
    }

    pub(crate) fn mask(&self) -> Result<[bool; 6], CheckError> {
        self.entry.mask.map_or_else(|| self.refuse("mask", "is missing"), Ok)
    }

    /// The frame of a key, which must be there.
    pub(crate) fn frame(&self, leaf: &Leaf<'_>, key: &str, entry: Option<&FrameEntry>) -> Result<Frame, CheckError> {
        let Some(entry) = entry else { return self.refuse(key, "is missing") };
        let (name, within) = entry.parts();
        let mut frame = self.frames.named(leaf.motion.world, name, || format!("{}.{key}", self.place))?;
        if let Some(row) = within {
            let Some(pose) = pose_from_array(*row) else { return self.refuse(key, "is no pose") };
            frame.body_from_frame *= pose;
        }
        Ok(frame)
    }
}

pub(crate) fn subject(entry: &ConstraintEntry) -> String {
    let told = |frame: &Option<FrameEntry>| frame.as_ref().map(|f| shown(f.parts().0)).unwrap_or_default();
    let kind = shown(&entry.kind);
    let about = match (&entry.joint, entry.parts.is_empty()) {
        (Some(joint), _) => format!("{kind} {}", shown(joint)),
        (None, false) => format!("{kind} of {}", shown(&entry.parts.join(", "))),
        (None, true) if entry.frame.is_none() => kind,
        (None, true) => format!("{kind} of {} in {}", told(&entry.frame), told(&entry.to)),
    };
    if entry.name.is_empty() { about } else { format!("{} ({about})", shown(&entry.name)) }
}

/// Rows of the mask that must not be negative; the others are zero.
pub(crate) fn inequality(entry: &ConstraintEntry) -> [bool; 6] {
    entry.inequality.unwrap_or_default()
}

/// Rows of the mask are zero, or not negative.
pub(crate) fn rows(mask: [bool; 6], sided: [bool; 6]) -> Vec<Named> {
    let mut forms = zero(std::array::from_fn(|i| mask[i] && !sided[i]));
    let negative = |i: usize| (-DVec3::AXES[i], 0.0);
    let planes: Vec<_> = (0..3).filter(|&i| mask[i] && sided[i]).map(negative).collect();
    if !planes.is_empty() {
        forms.push(("negative", Form::Outside { point: DVec3::ZERO, planes }));
    }
    forms
}

/// The value of a constraint that has one.
pub(crate) fn value(entry: &ConstraintEntry) -> Option<Pose> {
    entry.value.and_then(pose_from_array)
}

/// How near the origin the straight line from one point to another comes.
pub(crate) fn nearest(a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let square = along.length_squared();
    let fraction = if square > 0.0 { (-a.dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    (a + along * fraction).length()
}
