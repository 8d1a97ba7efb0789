//! What a check found: broken promises, remarks, and the worst values seen.

use serde::Serialize;
use std::collections::HashMap;

/// The promise that is broken. Names are those of the path contract's independent checker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// A joint or a robot's root beyond the file's limits.
    Limit,
    /// A joint that follows a leader beyond its model's limits.
    FollowerLimit,
    /// A resting object out of its bounds.
    ObjectBounds,
    /// Consecutive segments do not share their knot bit for bit.
    SharedKnot,
    /// A quaternion that is not unit.
    QuaternionNorm,
    /// Consecutive quaternions on different sides.
    QuaternionSign,
    /// An environment's joint moves.
    EnvironmentMoves,
    /// Time runs backwards.
    Times,
    /// A gripper, handle or surface that is not the SRDF's.
    Document,
    /// A held object is written where its gripper does not take it.
    ObjectOffCarrier,
    /// A placed object moves.
    PlacedObjectMoved,
    /// An object that hangs on nothing moves.
    UnattachedObjectMoved,
    /// A joint of an object moves while nobody holds what is beyond it.
    JointUnheld,
    /// A handle is not in its gripper.
    Grasp,
    /// A handle slips in its gripper.
    GraspConstancy,
    /// An object does not lie on its support.
    Placement,
    /// An object slides on its support.
    PlacementConstancy,
    /// A further constraint does not hold.
    Constraint,
    /// A constraint that this checker cannot prove.
    UncheckedConstraint,
    /// Two solids meet.
    Collision,
    /// Two solids come closer than their margin.
    Margin,
    /// A solid is inside a closed mesh.
    Enclosed,
    /// Free at every sample, but so close that no interval can be covered; or the work limit is reached.
    Undecided,
    /// The path tolerance is not in (0, 1e-3].
    PathTolerance,
    /// The certificate claims more than was measured.
    Certificate,
    /// Many small steps of an object or an unheld joint, each within its tolerance, that add up.
    Drift,
    /// A model file is not the one that the path was planned with.
    Model,
    /// Links that are said to be neighbours and are not.
    NotAdjacent,
    /// The file is not about the parts, documents, limits, margins or ignored pairs of its scene.
    Scene,
    /// The path does not begin at the scene's start.
    Start,
    /// The path does not end at a goal of the scene.
    Goal,
    /// Somebody holds or lies on what the scene does not allow, or an object hangs otherwise than the scene has it.
    Holding,
    /// What the scene demands of a segment is not in the file, or does not hold.
    Demand,
}

/// How a check ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The path answers its scene, over the continuum.
    Proved,
    /// What the file says of itself holds; these are the reasons why that is less than an answer to a scene.
    Relative(Vec<String>),
    /// A promise is broken.
    Refused,
    /// No promise is known to be broken, and not all is proved within the limits of work, time or resolution.
    Undecided,
}

impl Verdict {
    /// One word, as `--json` has it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Proved => "proved",
            Self::Relative(_) => "relative",
            Self::Refused => "refused",
            Self::Undecided => "undecided",
        }
    }
}

/// A group of promises, for people.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Section {
    /// Grippers, handles and surfaces are the models'.
    Documents,
    /// Joint limits and bounds.
    Limits,
    /// Joint knots, quaternions, times, environments.
    Knots,
    /// Objects follow what carries them.
    Carriers,
    /// Grasps, placements, constraints.
    Residuals,
    /// No collision, margins kept.
    Clearance,
    /// The file's own claims.
    Certificate,
    /// The path answers its scene.
    Scene,
}

impl Section {
    /// All sections, in the order in which they are told.
    pub const ALL: [Self; 8] = [
        Self::Documents,
        Self::Limits,
        Self::Knots,
        Self::Carriers,
        Self::Residuals,
        Self::Clearance,
        Self::Certificate,
        Self::Scene,
    ];

    /// One word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Documents => "documents",
            Self::Limits => "limits",
            Self::Knots => "knots",
            Self::Carriers => "carriers",
            Self::Residuals => "residuals",
            Self::Clearance => "clearance",
            Self::Certificate => "certificate",
            Self::Scene => "scene",
        }
    }
}

impl Kind {
    /// The name in messages and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Limit => "limit",
            Self::FollowerLimit => "follower-limit",
            Self::ObjectBounds => "object-bounds",
            Self::SharedKnot => "shared-knot",
            Self::QuaternionNorm => "quaternion-norm",
            Self::QuaternionSign => "quaternion-sign",
            Self::EnvironmentMoves => "environment-moves",
            Self::Times => "times",
            Self::Document => "document",
            Self::ObjectOffCarrier => "object-off-carrier",
            Self::PlacedObjectMoved => "placed-object-moved",
            Self::UnattachedObjectMoved => "unattached-object-moved",
            Self::JointUnheld => "joint-unheld",
            Self::Grasp => "grasp",
            Self::GraspConstancy => "grasp-constancy",
            Self::Placement => "placement",
            Self::PlacementConstancy => "placement-constancy",
            Self::Constraint => "constraint",
            Self::UncheckedConstraint => "unchecked-constraint",
            Self::Collision => "collision",
            Self::Margin => "margin",
            Self::Enclosed => "enclosed",
            Self::Undecided => "undecided",
            Self::PathTolerance => "path-tolerance",
            Self::Certificate => "certificate",
            Self::Drift => "drift",
            Self::Model => "model",
            Self::NotAdjacent => "not-adjacent",
            Self::Scene => "scene",
            Self::Start => "start",
            Self::Goal => "goal",
            Self::Holding => "holding",
            Self::Demand => "demand",
        }
    }

    /// The group it belongs to.
    #[must_use]
    pub fn section(self) -> Section {
        match self {
            Self::Document | Self::Model | Self::NotAdjacent => Section::Documents,
            Self::Limit | Self::FollowerLimit | Self::ObjectBounds => Section::Limits,
            Self::SharedKnot | Self::QuaternionNorm | Self::QuaternionSign | Self::EnvironmentMoves | Self::Times => {
                Section::Knots
            }
            Self::ObjectOffCarrier
            | Self::PlacedObjectMoved
            | Self::UnattachedObjectMoved
            | Self::JointUnheld
            | Self::Drift => Section::Carriers,
            Self::Grasp
            | Self::GraspConstancy
            | Self::Placement
            | Self::PlacementConstancy
            | Self::Constraint
            | Self::UncheckedConstraint => Section::Residuals,
            Self::Collision | Self::Margin | Self::Enclosed | Self::Undecided => Section::Clearance,
            Self::PathTolerance | Self::Certificate => Section::Certificate,
            Self::Scene | Self::Start | Self::Goal | Self::Holding | Self::Demand => Section::Scene,
        }
    }
}

/// One broken promise. Equal ones (same segment, kind and subject) are counted; `t` is the first, `value` the worst.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Violation {
    /// Segment, counted from 0; none for the file as a whole.
    pub segment: Option<usize>,
    /// Parameter in knots: 2.25 is a quarter of the way from knot 2 to knot 3.
    pub t: Option<f64>,
    /// What is broken.
    pub kind: Kind,
    /// By whom.
    pub subject: String,
    /// The amount, SI units.
    pub value: Option<f64>,
    /// What would have been allowed.
    pub limit: Option<f64>,
    /// How often.
    pub count: usize,
}

impl std::fmt::Display for Violation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.segment {
            Some(segment) => write!(f, "segment {segment}")?,
            None => f.write_str("file")?,
        }
        if let Some(t) = self.t {
            write!(f, " t={t:.6}")?;
        }
        write!(f, ": {}: {}", self.kind.name(), self.subject)?;
        if let Some(value) = self.value {
            write!(f, ": {value:.6e}")?;
        }
        if let Some(limit) = self.limit {
            write!(f, " (allowed {limit:.6e})")?;
        }
        if self.count > 1 {
            write!(f, ", {} times", self.count)?;
        }
        Ok(())
    }
}

/// An extreme value, and where it was seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Extreme {
    /// SI units.
    pub value: f64,
    /// Segment.
    pub segment: usize,
    /// Parameter in knots.
    pub t: f64,
    /// Of what.
    pub subject: String,
}

/// How much was looked at.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Parts.
    pub parts: usize,
    /// Rigid bodies that move.
    pub bodies: usize,
    /// Collision shapes.
    pub shapes: usize,
    /// Pairs of shapes that are tested: along the motion, or once where they do not move against each other.
    pub pairs: usize,
    /// Pairs of which one is tested along some motion. The others do not move against each other in any segment.
    pub pairs_moving: usize,
    /// Not tested: on one link, or on links that fixed joints make one body.
    pub pairs_of_one_body: usize,
    /// Not tested: both stand fixed in the world.
    pub pairs_of_the_environment: usize,
    /// Not tested: an SRDF disables them.
    pub pairs_disabled_by_srdf: usize,
    /// Not tested: neighbours, which touch wherever the joint between them is.
    pub pairs_adjacent: usize,
    /// Not tested: the file ignores them.
    pub pairs_ignored_by_file: usize,
    /// Segments.
    pub segments: usize,
    /// Knots.
    pub knots: usize,
    /// Distances that were computed.
    pub distance_queries: u64,
    /// Residuals that were evaluated.
    pub residual_samples: u64,
}

/// A pair of links of which no shapes are tested against each other.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// One link.
    pub first: String,
    /// The other.
    pub second: String,
    /// Why.
    pub reason: String,
}

/// Everything that a check found.
#[derive(Clone, Debug, Default, Serialize)]
pub struct CheckReport {
    /// Broken promises, in the order in which they were found.
    pub violations: Vec<Violation>,
    /// Remarks that break nothing.
    pub notes: Vec<String>,
    /// Why what is proved is less than an answer to a scene; empty where it is one.
    pub weaker: Vec<String>,
    /// The scene that the path was held against, if any: its name.
    pub scene: Option<String>,
    /// How much was looked at.
    pub counts: Counts,
    /// Smallest distance beyond the margin that was measured.
    pub min_clearance: Option<Extreme>,
    /// Proven lower bound of the distance beyond the margin over the whole path, where it was asked for
    /// ([`super::CheckOptions::clearance`]): a tenth, or a tenth of a millimetre, below the smallest that was measured. Metres.
    pub clearance: Option<f64>,
    /// Pairs of links that are not tested and why, where they were asked for ([`super::CheckOptions::pairs`]).
    pub left_out: Vec<LeftOut>,
    /// Largest residual that was measured.
    pub max_residual: Option<Extreme>,
    /// Largest bound of a residual between samples that the proof rests on.
    pub residual_bound: f64,
    /// Largest distance of a written object from where its carrier takes it.
    pub max_off_carrier: Option<Extreme>,
    /// Smallest distance of a joint from its limit.
    pub nearest_limit: Option<Extreme>,
    #[serde(skip)]
    known: HashMap<(Option<usize>, Kind, String), usize>,
}

/// Remarks beyond this many are left out.
const MOST_NOTES: usize = 500;

/// Where something happened.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    pub segment: Option<usize>,
    pub t: Option<f64>,
}

impl Place {
    /// The file as a whole.
    pub const FILE: Self = Self { segment: None, t: None };

    pub fn at(segment: usize, t: f64) -> Self {
        Self { segment: Some(segment), t: Some(t) }
    }
}

impl CheckReport {
    /// Whether nothing is broken, and nothing is left undecided.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.violations.is_empty()
    }

    /// How the check ended.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        if self.is_broken() {
            Verdict::Refused
        } else if !self.violations.is_empty() {
            Verdict::Undecided
        } else if self.weaker.is_empty() {
            Verdict::Proved
        } else {
            Verdict::Relative(self.weaker.clone())
        }
    }

    /// Whether a promise is known to be broken.
    pub(super) fn is_broken(&self) -> bool {
        self.violations.iter().any(|v| v.kind != Kind::Undecided)
    }

    /// Whether something of this kind is broken.
    #[must_use]
    pub fn has(&self, kind: Kind) -> bool {
        self.violations.iter().any(|v| v.kind == kind)
    }

    pub(super) fn violate(
        &mut self,
        place: Place,
        kind: Kind,
        subject: impl Into<String>,
        value: impl Into<Option<f64>>,
        limit: impl Into<Option<f64>>,
    ) {
        let (subject, value, limit) = (subject.into(), value.into(), limit.into());
        let key = (place.segment, kind, subject.clone());
        let Some(&index) = self.known.get(&key) else {
            self.known.insert(key, self.violations.len());
            self.violations.push(Violation {
                segment: place.segment,
                t: place.t,
                kind,
                subject,
                value,
                limit,
                count: 1,
            });
            return;
        };
        let known = &mut self.violations[index];
        known.count += 1;
        known.t = match (known.t, place.t) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        let off = |v: f64| (v - known.limit.unwrap_or(0.0)).abs();
        if let (Some(new), Some(old)) = (value, known.value)
            && off(new) > off(old)
        {
            known.value = Some(new);
        }
    }

    /// The file claims less than the models say. Against a scene that is a remark: the scene is what counts.
    pub(super) fn weaker(&mut self, text: impl Into<String>) {
        if self.scene.is_some() {
            return self.note(text);
        }
        let text = text.into();
        if self.weaker.len() < MOST_NOTES && !self.weaker.contains(&text) {
            self.weaker.push(text);
        }
    }

    pub(super) fn note(&mut self, text: impl Into<String>) {
        let text = text.into();
        if self.notes.len() < MOST_NOTES && !self.notes.contains(&text) {
            self.notes.push(text);
        }
    }

    pub(super) fn see_clearance(&mut self, value: f64, segment: usize, t: f64, subject: impl FnOnce() -> String) {
        least(&mut self.min_clearance, value, segment, t, subject);
    }

    pub(super) fn see_residual(&mut self, value: f64, segment: usize, t: f64, subject: impl FnOnce() -> String) {
        greatest(&mut self.max_residual, value, segment, t, subject);
    }

    pub(super) fn see_off_carrier(&mut self, value: f64, segment: usize, t: f64, subject: impl FnOnce() -> String) {
        greatest(&mut self.max_off_carrier, value, segment, t, subject);
    }

    pub(super) fn see_limit(&mut self, value: f64, segment: usize, t: f64, subject: impl FnOnce() -> String) {
        least(&mut self.nearest_limit, value, segment, t, subject);
    }
}

fn least(slot: &mut Option<Extreme>, value: f64, segment: usize, t: f64, subject: impl FnOnce() -> String) {
    if slot.as_ref().is_none_or(|known| value < known.value) {
        *slot = Some(Extreme { value, segment, t, subject: subject() });
    }
}

fn greatest(slot: &mut Option<Extreme>, value: f64, segment: usize, t: f64, subject: impl FnOnce() -> String) {
    if slot.as_ref().is_none_or(|known| value > known.value) {
        *slot = Some(Extreme { value, segment, t, subject: subject() });
    }
}
