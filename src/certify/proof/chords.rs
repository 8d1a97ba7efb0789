//! The proof over a motion's chords.
//!
//! Curves are cut into pieces so short that the chord of each stays within a tenth of a millimetre of the curve, whatever
//! part of the robot is cut: a joint is off its chord by at most h²/8 · sup|q̈|, and the suprema are those of the
//! polynomials. The polyline is certified in lanes with margins that much larger. Where that fails the curve itself is
//! examined (`advance`), and behind that place lanes continue.

#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::certify::motion::piecewise::{Curve, Motion, Segment};
use crate::certify::proof::advance::{Advanced, Budget, Met, Window};
use crate::certify::world::levers::Drives;
use crate::certify::world::phases::{Certifier, Phase};
use foliate_kernels::collision::{
    CertificateSettings, CollisionScratch, Contact, MinimumClearance, MinimumSettings, PairId, PolylineVerdict,
    certify_polyline, first_collision, minimum_clearance_while,
};

/// How far chords may be off their curves, metres.
pub(crate) const DEVIATION: f64 = 1e-4;
/// Added to margins in lanes: rounding, metres.
const GUARD: f64 = 2e-9;
/// Between two knots no joint turns farther than this, radians: kernels take the shortest way round.
const MOST_TURN: f64 = 1.5;
/// Pieces of a segment at most; what is then farther off its chord is measured on the curve.
const MOST_PIECES: f64 = 4096.0;
/// Configurations that lanes may test in one go.
const SAMPLES: u32 = 100_000;
/// Knots that are certified in one go; a deadline is checked between two of these.
const KNOTS: usize = 1024;
/// The shortest and the first part of a segment that is measured on the curve itself.
const FIRST_STEP: f64 = 1.0 / 64.0;

/// What is proved so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Proved {
    pub free_until: f64,
    pub met: Option<Met>,
    pub grazing: Option<(f64, PairId)>,
    /// Lanes alone keep this distance, metres; 0 where they could not.
    pub distance: f64,
}

/// The least clearance of a part of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Part {
    /// Up to here.
    pub to: f64,
    /// On the chords.
    pub found: MinimumClearance,
    /// The place of the nearest.
    pub place: f64,
    /// How far chords are off their curves, metres.
    pub off: f64,
}

/// Buffers and tables of one proof.
pub(crate) struct Proof<'a> {
    pub certifier: &'a Certifier,
    motion: &'a Motion,
    drives: Drives,
    scratch: &'a mut CollisionScratch,
    knots: Vec<f64>,
    /// Places of the knots.
    places: Vec<f64>,
    /// How much more than a margin lanes keep, so that the curve keeps the margin; metres.
    guard: f64,
    distance: f64,
}

impl<'a> Proof<'a> {
    pub(crate) fn new(certifier: &'a Certifier, motion: &'a Motion, scratch: &'a mut CollisionScratch) -> Self {
        Self {
            certifier,
            motion,
            drives: certifier.drives(motion),
            scratch,
            knots: Vec::new(),
            places: Vec::new(),
            guard: 0.0,
            distance: f64::INFINITY,
        }
    }

    pub(crate) fn motion(&self) -> &'a Motion {
        self.motion
    }

    /// Whether a pair moves somewhere in a phase.
    pub(crate) fn moves(&self, phase: &'a Phase) -> impl Fn(PairId) -> bool + use<'a> {
        let mut all = vec![(0.0, 0.0); self.certifier.robot().joints.len()];
        for segment in &self.motion.segments {
            for (sum, rate) in all.iter_mut().zip(self.drives.rates(segment, (0.0, 1.0), 1)) {
                *sum = (f64::max(sum.0, rate.0), f64::max(sum.1, rate.1));
            }
        }
        let moved = phase.levers.moved(&all);
        let (scene, levers) = (&self.certifier.scene, &phase.levers);
        move |pair| {
            let pair = &scene.pairs()[pair.at()];
            let cluster = |shape: foliate_components::robot::ShapeIndex| scene.solids()[shape.at()].cluster;
            levers.between(&moved, cluster(pair.first), cluster(pair.second)) > 0.0
        }
    }

    /// The first pair that is too close, or inside of one another, at the start of a phase.
    pub(crate) fn at_start(&mut self, phase: &Phase) -> Option<Contact> {
        let (mut q, mut X_WJ) = (Vec::new(), Vec::new());
        self.certifier.poses(self.motion, phase, phase.from, &mut q, &mut X_WJ);
        first_collision(&self.certifier.scene, &X_WJ, &phase.pairs, 0.0, self.scratch)
    }

    /// Goes through a phase whose start is free.
    pub(crate) fn go(&mut self, phase: &Phase, budget: &mut Budget<'_>) -> Proved {
        let mut from = phase.from;
        let mut step = FIRST_STEP;
        let mut proved = Proved { free_until: phase.to, met: None, grazing: None, distance: f64::INFINITY };
        while from < phase.to {
            let free_until = match self.refute(phase, from) {
                Ok(to) => {
                    proved.distance = proved.distance.min(self.distance);
                    from = to;
                    if from < phase.to && !budget.look() {
                        proved.free_until = proved.free_until.min(from);
                        return proved;
                    }
                    continue;
                }
                Err(free_until) => free_until,
            };
            // Lanes came no farther than the last window: measure more of the curve at once.
            step = if free_until > from { self.step_at(free_until) } else { 2.0 * step };
            from = from.max(free_until);
            let to = (from + step).min(phase.to).min(from.floor() + 1.0);
            let mut window = Window::new((self.certifier, self.motion, phase), (from, to));
            let Advanced { free_until, met, grazing } = window.advance(budget);
            proved.distance = 0.0;
            if proved.grazing.is_none() {
                proved.free_until = if free_until < to || met.is_some() { free_until } else { phase.to };
                proved.grazing = grazing;
            }
            if met.is_some() {
                proved.met = met;
                return proved;
            }
            if !budget.look() {
                proved.free_until = proved.free_until.min(free_until);
                return proved;
            }
            from = to;
        }
        proved
    }

    /// The least clearance of all pairs of a phase, from a place on as far as one search goes.
    pub(crate) fn minimum(
        &mut self,
        phase: &Phase,
        from: f64,
        deviation: f64,
        settings: &MinimumSettings,
        budget: &mut Budget<'_>,
    ) -> Part {
        self.cut(phase, from, deviation);
        let (scene, kinematics) = (&self.certifier.scene, &self.certifier.kinematics);
        let settings = MinimumSettings { max_queries: budget.limit.saturating_sub(budget.spent), ..*settings };
        let (knots, pairs, how) = (&self.knots, &phase.pairs, (&settings, budget.go_on));
        let found =
            minimum_clearance_while(scene, kinematics, &phase.rigid_attachments, knots, pairs, how, self.scratch);
        budget.spent += found.queries;
        budget.is_over |= found.is_cut_short;
        let last = self.places.len() - 1;
        let place = |t: f64| {
            let piece = (t as usize).min(last);
            let (a, b) = (self.places[piece], self.places[(piece + 1).min(last)]);
            a + (t - piece as f64) * (b - a)
        };
        let place = found.nearest.map_or(from, |nearest| place(nearest.t));
        Part { to: self.places[last], found, place, off: self.guard + GUARD }
    }

    /// Certifies in lanes that from a place on all pairs of a phase keep their margins: up to which place they do as far as one
    /// search goes, or up to which they do with certainty where lanes could not show it.
    fn refute(&mut self, phase: &Phase, from: f64) -> Result<f64, f64> {
        self.cut(phase, from, DEVIATION);
        let settings = CertificateSettings {
            clearance_guard: self.guard + GUARD,
            start_is_free: true,
            max_samples: SAMPLES,
            ..CertificateSettings::default()
        };
        let (scene, kinematics) = (&self.certifier.scene, &self.certifier.kinematics);
        let (knots, pairs) = (&self.knots, &phase.pairs);
        match certify_polyline(scene, kinematics, &phase.rigid_attachments, knots, pairs, &settings, self.scratch) {
            PolylineVerdict::Free { min_clearance_lower_bound } => {
                self.distance = min_clearance_lower_bound - self.guard;
                Ok(self.places.last().map_or(phase.to, |&to| to.max(from)))
            }
            PolylineVerdict::FreeUntil { piece, t, .. } => {
                let (a, b) = (self.places[piece], self.places[(piece + 1).min(self.places.len() - 1)]);
                // The place is rounded, and with it how the robot stands: a little before is free with certainty.
                Err((a + t * (b - a) - 1e-12 * (1.0 + b)).max(from))
            }
        }
    }

    /// How much of a segment to measure on the curve itself at first.
    fn step_at(&self, place: f64) -> f64 {
        let next = self.places.partition_point(|&p| p <= place);
        let piece = match (self.places.get(next.wrapping_sub(1)), self.places.get(next)) {
            (Some(a), Some(b)) => b - a,
            _ => FIRST_STEP,
        };
        piece.clamp(1e-4, FIRST_STEP)
    }

    /// Knots from a place to the end of a phase, or as many as are certified in one go, close enough to each other.
    fn cut(&mut self, phase: &Phase, from: f64, deviation: f64) {
        self.knots.clear();
        self.places.clear();
        self.guard = 0.0;
        let mut index = from as usize;
        let mut place = from;
        self.add_knot(phase, place);
        while let Some(segment) = self.motion.segments.get(index).filter(|_| place < phase.to) {
            if self.places.len() > KNOTS {
                return;
            }
            let (low, high) = (place - index as f64, (phase.to - index as f64).min(1.0));
            let pieces = self.pieces(phase, segment, (low, high), deviation);
            for piece in 1..=pieces {
                let u = low + (high - low) * (piece as f64 / pieces as f64);
                self.add_knot(phase, index as f64 + u);
            }
            index += 1;
            place = index as f64;
        }
    }

    fn add_knot(&mut self, phase: &Phase, place: f64) {
        let start = self.knots.len();
        self.knots.extend_from_slice(&phase.base);
        self.motion.write(place, &mut self.knots[start..]);
        self.places.push(place);
    }

    /// Into how many pieces part of a segment is cut; the guard grows to how far the chords are off.
    fn pieces(&mut self, phase: &Phase, segment: &Segment, (low, high): (f64, f64), deviation: f64) -> usize {
        let turn = |p: &Curve| match p {
            Curve::Number(p) => (high - low) * p.derivative().largest(low, high),
            Curve::Quaternion => 0.0,
        };
        let scaled = || segment.turns.iter().filter_map(|turn| turn.scaled);
        let by_quaternion = scaled().map(|scaled| (high - low) * scaled.rates(low, high).0);
        let turn = segment.curves.iter().map(turn).chain(by_quaternion).fold(0.0, f64::max);
        let for_turns = (turn / MOST_TURN).ceil().max(1.0);
        let bent = |c: &Curve| matches!(c, Curve::Number(p) if p.degree() > 1);
        let curved = segment.curves.iter().any(bent) || scaled().next().is_some();
        if !curved {
            return for_turns.min(MOST_PIECES) as usize;
        }
        let bends = self.drives.rates(segment, (low, high), 2);
        let moved = phase.levers.moved(&bends);
        // In one piece.
        let off = (high - low).powi(2) / 8.0 * phase.levers.most(&moved);
        let pieces = (off / deviation).sqrt().ceil().max(for_turns).min(MOST_PIECES);
        self.guard = self.guard.max(off / (pieces * pieces));
        pieces as usize
    }
}
