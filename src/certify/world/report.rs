//! What is found out about a motion.

use serde::Serialize;

/// What is proved of the clearance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Free over the continuum, from start to end.
    Free,
    /// Two things touch, or come closer than their margin.
    Contact,
    /// Neither could be shown within the resolution, or within limits of time and work.
    Undecided,
}

/// Two collision shapes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PairName {
    /// Links, `part/link`.
    pub links: [String; 2],
    /// Shapes: the link's name and the number of the shape on it.
    pub shapes: [String; 2],
}

/// A contact. Times are seconds, or numbers of points where the motion has no times.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ContactReport {
    /// Here the pair is in contact, or closer than its margin. The first contact lies between `free_until` of the report and here.
    pub at: f64,
    /// Which pair.
    pub pair: PairName,
    /// The distance that it has to keep, metres.
    pub margin: f64,
    /// How deep the one gets into the other before they part again: no shift shorter than this sets them apart; metres. None where they
    /// only come closer than their margin, or only touch.
    pub depth: Option<f64>,
    /// Where they are that deep.
    pub deepest_at: f64,
    /// The least distance in that time, metres; not positive in contact.
    pub least_distance: f64,
    /// One of the two lies inside the other.
    pub contained: bool,
    /// Up to about here they stay that close.
    pub until: f64,
}

/// Where nothing could be shown.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UndecidedReport {
    /// From here on.
    pub at: f64,
    /// Which pair, where it is one.
    pub pair: Option<PairName>,
    /// Why.
    pub reason: String,
}

/// How close things come, beyond their margins.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClearanceReport {
    /// No pair comes closer than its margin and this, metres; proved.
    pub at_least: f64,
    /// What was measured, metres, where the least clearance was asked for.
    pub measured: Option<f64>,
    /// Where that is.
    pub at: Option<f64>,
    /// Between which two.
    pub pair: Option<PairName>,
}

/// Which limit is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LimitKind {
    /// Radians or metres.
    Position,
    /// Per second.
    Velocity,
    /// Per second squared.
    Acceleration,
    /// The velocity jumps, so that no acceleration is large enough; per second.
    VelocityJump,
}

/// A joint that leaves its limits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimitViolation {
    /// `part/joint`.
    pub joint: String,
    /// Which limit.
    pub kind: LimitKind,
    /// The limit that is broken worst.
    pub limit: f64,
    /// From here on, for the first time.
    pub first_at: f64,
    /// The value that is farthest outside.
    pub worst: f64,
    /// Where that is.
    pub worst_at: f64,
}

/// The joint that is nearest to a limit of its velocity or acceleration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Peak {
    /// `part/joint`.
    pub joint: String,
    /// Its largest magnitude.
    pub value: f64,
    /// Its limit.
    pub limit: f64,
    /// Where.
    pub at: f64,
}

/// What is found out about the limits of joints.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LimitsReport {
    /// What is broken, in order of time.
    pub violations: Vec<LimitViolation>,
    /// Joints whose positions were checked, continuously.
    pub positions: usize,
    /// Joints whose velocities were checked.
    pub velocities: usize,
    /// Joints whose accelerations were checked.
    pub accelerations: usize,
    /// The largest share of a velocity limit.
    pub velocity_peak: Option<Peak>,
    /// The largest share of an acceleration limit.
    pub acceleration_peak: Option<Peak>,
}

/// How many pairs of collision shapes were tested, and how many were not, by reason.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PairCounts {
    /// Tested.
    pub tested: u64,
    /// Not tested: on links that fixed joints make one body.
    pub same_body: u64,
    /// Not tested: both belong to the environment, or are fixed to it.
    pub environment: u64,
    /// Not tested: an SRDF disables them.
    pub srdf: u64,
    /// Not tested: links that one joint joins, and that touch wherever it is.
    pub adjacent: u64,
    /// Not tested: the scene ignores them.
    pub ignored: u64,
    /// Not tested: the caller lets them touch.
    pub touch_allowed: u64,
    /// Tested without their margin: what holds an object and the object, an object and its supports.
    pub without_margin: u64,
}

/// What is known of a motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CertifyReport {
    /// Of the clearance.
    pub verdict: Verdict,
    /// When it begins and ends: seconds, or numbers of points.
    pub span: [f64; 2],
    /// Whether times are seconds.
    pub timed: bool,
    /// Joints and roots that the motion moves.
    pub coordinates: usize,
    /// Its curves.
    pub segments: usize,
    /// Their highest degree.
    pub degree: usize,
    /// Up to here it is proved free.
    pub free_until: f64,
    /// The first contact, if there is one.
    pub contact: Option<ContactReport>,
    /// Where nothing could be shown, if anywhere before a contact.
    pub undecided: Option<UndecidedReport>,
    /// How close things come; only where the motion is free.
    pub clearance: Option<ClearanceReport>,
    /// Joint limits.
    pub limits: LimitsReport,
    /// Which pairs were tested.
    pub pairs: PairCounts,
    /// Distances that were asked for one by one, beyond what lanes decided.
    pub distances: u64,
    /// Remarks.
    pub notes: Vec<String>,
}

impl CertifyReport {
    /// Whether everything is proved: no contact, all limits kept.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.verdict == Verdict::Free && self.limits.violations.is_empty()
    }

    /// Whether something is shown to be wrong.
    #[must_use]
    pub fn failed(&self) -> bool {
        self.verdict == Verdict::Contact || !self.limits.violations.is_empty()
    }
}
