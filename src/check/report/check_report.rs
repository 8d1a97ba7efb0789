//! What a check found: broken promises, remarks, and the worst values seen.

use crate::check::report::kind::{Kind, Verdict};
use serde::Serialize;
use std::collections::HashMap;

/// Text from the file, fit for one line of a terminal.
pub(crate) fn shown(text: &str) -> String {
    text.chars().take(80).flat_map(char::escape_debug).collect()
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

/// How much was examined.
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
    /// The scene that the path was compared with, if any: its name.
    pub scene: Option<String>,
    /// How much was examined.
    pub counts: Counts,
    /// Smallest distance beyond the margin that was measured.
    pub min_clearance: Option<Extreme>,
    /// Proven lower bound of the distance beyond the margin over the whole path, where it was asked for
    /// ([`crate::check::report::error::CheckOptions::clearance`]): a tenth, or a tenth of a
    /// millimetre, below the smallest that was measured. Metres.
    pub clearance: Option<f64>,
    /// Pairs of links that are not tested and why, where they were asked for ([`crate::check::report::error::CheckOptions::pairs`]).
    pub left_out: Vec<LeftOut>,
    /// Largest residual that was measured.
    pub max_residual: Option<Extreme>,
    /// Largest bound of a residual between samples that the proof rests on.
    pub residual_bound: f64,
    /// Largest distance of a written object from where its carrier takes it.
    pub max_off_carrier: Option<Extreme>,
    /// Smallest distance of a joint from its limit.
    pub nearest_limit: Option<Extreme>,
    /// How long the path takes, seconds; none for a path without times and velocities.
    pub duration: Option<f64>,
    /// Largest share of a velocity limit that is used.
    pub max_velocity: Option<Extreme>,
    /// Largest share of an acceleration limit that is used.
    pub max_acceleration: Option<Extreme>,
    /// Largest share of a jerk limit that is used.
    pub max_jerk: Option<Extreme>,
    #[serde(skip)]
    known: HashMap<(Option<usize>, Kind, String), usize>,
}

/// Remarks beyond this many are left out.
const MOST_NOTES: usize = 500;

/// Where something happened.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Place {
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
    pub(crate) fn is_broken(&self) -> bool {
        self.violations.iter().any(|v| v.kind != Kind::Undecided)
    }

    /// Whether something of this kind is broken.
    #[must_use]
    pub fn has(&self, kind: Kind) -> bool {
        self.violations.iter().any(|v| v.kind == kind)
    }

    pub(crate) fn violate(
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
    pub(crate) fn weaker(&mut self, text: impl Into<String>) {
        if self.scene.is_some() {
            return self.note(text);
        }
        let text = text.into();
        if self.weaker.len() < MOST_NOTES && !self.weaker.contains(&text) {
            self.weaker.push(text);
        }
    }

    pub(crate) fn note(&mut self, text: impl Into<String>) {
        let text = text.into();
        if self.notes.len() < MOST_NOTES && !self.notes.contains(&text) {
            self.notes.push(text);
        }
    }

    pub(crate) fn see_clearance(&mut self, value: f64, segment: usize, t: f64, subject: impl FnOnce() -> String) {
        least(&mut self.min_clearance, value, segment, t, subject);
    }

    pub(crate) fn see_residual(&mut self, value: f64, segment: usize, t: f64, subject: impl FnOnce() -> String) {
        greatest(&mut self.max_residual, value, segment, t, subject);
    }

    pub(crate) fn see_off_carrier(&mut self, value: f64, segment: usize, t: f64, subject: impl FnOnce() -> String) {
        greatest(&mut self.max_off_carrier, value, segment, t, subject);
    }

    /// A share of a limit of velocity, acceleration or jerk.
    pub(crate) fn see_rate(
        &mut self,
        kind: Kind,
        share: f64,
        segment: usize,
        t: f64,
        subject: impl FnOnce() -> String,
    ) {
        let slot = match kind {
            Kind::VelocityLimit => &mut self.max_velocity,
            Kind::AccelerationLimit => &mut self.max_acceleration,
            _ => &mut self.max_jerk,
        };
        greatest(slot, share, segment, t, subject);
    }

    pub(crate) fn see_limit(&mut self, value: f64, segment: usize, t: f64, subject: impl FnOnce() -> String) {
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
