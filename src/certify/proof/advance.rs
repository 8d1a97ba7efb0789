//! The first contact on a curve, found by conservative advancement (B. Mirtich, Impulse-based dynamic simulation, 1996).
//!
//! A pair whose distance exceeds its margin by d is free until its two shapes may have approached each other by d. How fast they can
//! is bounded over the window (`world::levers`), so each pair has a place up to which it is free; the pair with the
//! earliest is measured next. A pair that stops before a contact is advanced a little further, until the two touch.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::certify::motion::piecewise::Motion;
use crate::certify::world::levers::Moved;
use crate::certify::world::phases::{Certifier, Phase};
use foliate_components::Pose;
use foliate_kernels::collision::{DistanceQuery, PairId, pair_clearance};
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Rounding of poses and distances, metres: taken off every step.
const ROUNDING: f64 = 1e-10;
/// A step over which two shapes approach each other by no more cannot be told from contact, metres.
pub(crate) const RESOLUTION: f64 = 1e-8;
/// How far ahead of a stand contact is looked for, metres of movement.
const LOOK_AHEAD: f64 = 1e-3;
/// Who asks for more than this wants the distance itself, metres.
pub(crate) const MEASURED: f64 = 1e3;
/// How often the place of a contact is halved.
const HALVINGS: u32 = 40;

/// How much may be asked.
pub(crate) struct Budget<'a> {
    /// Distances so far.
    pub spent: u64,
    /// At most so many.
    pub limit: u64,
    /// Whether the host still wants an answer.
    pub go_on: &'a dyn Fn() -> bool,
    /// Whether it does not, or the limit is reached.
    pub is_over: bool,
}

impl Budget<'_> {
    fn spend(&mut self) -> bool {
        self.spent += 1;
        if self.spent >= self.limit || (self.spent.is_multiple_of(64) && !(self.go_on)()) {
            self.is_over = true;
        }
        !self.is_over
    }

    /// Asks the host.
    pub(crate) fn look(&mut self) -> bool {
        self.is_over |= !(self.go_on)();
        !self.is_over
    }
}

/// A pair in contact at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Met {
    pub at: f64,
    pub pair: PairId,
    /// Its distance there, metres.
    pub distance: f64,
}

/// What is found in a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Advanced {
    /// Everything is free up to here.
    pub free_until: f64,
    /// The first contact.
    pub met: Option<Met>,
    /// Where two graze each other closer than can be told.
    pub grazing: Option<(f64, PairId)>,
}

/// A part of one segment, and how fast pairs can approach each other in it.
pub(crate) struct Window<'a> {
    pub certifier: &'a Certifier,
    pub motion: &'a Motion,
    pub phase: &'a Phase,
    pub from: f64,
    pub to: f64,
    moved: Moved,
    q: Vec<f64>,
    X_WJ: Vec<Pose>,
    /// The place for which poses stand.
    placed: f64,
}

impl<'a> Window<'a> {
    /// A window within one segment: both ends lie between the same whole numbers.
    pub(crate) fn new(
        (certifier, motion, phase): (&'a Certifier, &'a Motion, &'a Phase),
        (from, to): (f64, f64),
    ) -> Self {
        let index = (from as usize).min(motion.segments.len().saturating_sub(1));
        let local = (from - index as f64, (to - index as f64).min(1.0));
        let rates = match motion.segments.get(index) {
            Some(segment) => certifier.drives(motion).rates(segment, local, 1),
            None => vec![(0.0, 0.0); certifier.robot().joints.len()],
        };
        let moved = phase.levers.moved(&rates);
        let (q, X_WJ) = (Vec::new(), Vec::new());
        Self { certifier, motion, phase, from, to, moved, q, X_WJ, placed: f64::NAN }
    }

    /// How fast a pair can approach, metres per segment.
    fn speed(&self, pair: PairId) -> f64 {
        let (scene, pair) = (&self.certifier.scene, &self.certifier.scene.pairs()[pair.at()]);
        let cluster = |shape: foliate_components::robot::ShapeIndex| scene.solids()[shape.at()].cluster;
        self.phase.levers.between(&self.moved, cluster(pair.first), cluster(pair.second))
    }

    fn go_to(&mut self, place: f64) {
        if place != self.placed {
            self.certifier.poses(self.motion, self.phase, place, &mut self.q, &mut self.X_WJ);
            self.placed = place;
        }
    }

    /// A lower bound of how much farther apart a pair is than it has to be: at least `enough`, or nearly exact.
    pub(crate) fn gap(&mut self, pair: PairId, place: f64, enough: f64, budget: &mut Budget<'_>) -> f64 {
        self.go_to(place);
        budget.spend();
        let wanted = self.phase.pairs.margin(pair);
        // A distance beyond what counts, or one that is asked for itself, is wanted as it is.
        let relative = if wanted > 0.0 || enough > MEASURED { 0.0 } else { 0.02 };
        let ask = DistanceQuery { absolute: 1e-9, relative, ..DistanceQuery::exact(wanted + enough) };
        pair_clearance(&self.certifier.scene, pair, &self.X_WJ, ask, &mut DVec3::ZERO.clone()) - wanted
    }

    /// Looks for the first contact in the window, among all pairs.
    pub(crate) fn advance(&mut self, budget: &mut Budget<'_>) -> Advanced {
        let (from, to) = (self.from, self.to);
        let mut found = Advanced { free_until: to, met: None, grazing: None };
        let mut heap: BinaryHeap<Reverse<(u64, u32)>> = BinaryHeap::new();
        let scene = &self.certifier.scene;
        let key = |place: f64, pair: PairId| Reverse((place.max(0.0).to_bits(), pair.0));
        let moving = self.phase.pairs.moving_pairs(scene).filter(|&p| self.speed(p) > 0.0);
        heap.extend(moving.map(|p| key(from, p)));
        let mut end = to;
        while let Some(Reverse((bits, pair))) = heap.pop() {
            let (place, pair) = (f64::from_bits(bits), PairId(pair));
            if place >= end {
                break;
            }
            if budget.is_over {
                found.free_until = found.free_until.min(place);
                break;
            }
            let speed = self.speed(pair);
            let gap = self.gap(pair, place, speed * (end - place) + ROUNDING, budget);
            let next = place + (gap - ROUNDING) / speed;
            // Written so that NaN comes to a stand.
            let moves_on = gap > RESOLUTION && next > place;
            if moves_on {
                heap.push(key(next, pair));
                continue;
            }
            found.free_until = found.free_until.min(place);
            match self.push_on(pair, (place, end), speed, budget) {
                Ok(met) => {
                    end = end.min(met.at);
                    if found.met.is_none_or(|known| met.at < known.at) {
                        found.met = Some(met);
                    }
                }
                Err(next) => {
                    found.grazing = found.grazing.or(Some((place, pair)));
                    heap.push(key(next, pair));
                }
            }
        }
        found
    }

    /// A pair has come to a stand: where it is in contact just ahead, or where to go on.
    fn push_on(
        &mut self,
        pair: PairId,
        (place, end): (f64, f64),
        speed: f64,
        budget: &mut Budget<'_>,
    ) -> Result<Met, f64> {
        let mut by = RESOLUTION;
        let mut free = place;
        let mut ahead = place;
        loop {
            let gap = self.gap(pair, ahead, 0.0, budget);
            // Compared so that NaN is in contact.
            let apart = gap > 0.0;
            if !apart {
                return Ok(self.narrow(pair, (free, ahead), gap, budget));
            }
            if by > LOOK_AHEAD || ahead >= end || budget.is_over {
                return Err((place + LOOK_AHEAD / speed).max(ahead));
            }
            free = ahead;
            ahead = (place + by / speed).min(end);
            by *= 2.0;
        }
    }

    /// Halves the way between a place without and one with contact.
    fn narrow(&mut self, pair: PairId, (mut free, mut at): (f64, f64), mut gap: f64, budget: &mut Budget<'_>) -> Met {
        for _ in 0..HALVINGS {
            let middle = free.midpoint(at);
            if middle <= free || middle >= at || budget.is_over {
                break;
            }
            let found = self.gap(pair, middle, 0.0, budget);
            if found > 0.0 {
                free = middle;
            } else {
                (at, gap) = (middle, found);
            }
        }
        Met { at, pair, distance: gap + self.phase.pairs.margin(pair) }
    }
}
