//! Rounds the corners of a motion on a leaf of implicit rows: each place becomes the mean of the motion around it, projected onto the
//! leaf. The mean around a corner of two straight lines is a quadratic arc, the same as where no rows are.

use crate::trajectory::smoothing_problem::{AT_WAYPOINT, SHARES, SmoothingProblem};
use foliate_components::candidate::LegParameter;
use foliate_components::graph::leaf::LeafIndex;
use foliate_kernels::constrained_motion::{Scratch, Settings, project};
use foliate_kernels::trajectory::time_at_full_speed;

/// By how often the curve was refused near a knot: the radius there, as a share of the full one. Without a radius the curve follows the
/// motion as it is. Where it is refused once more the robot stops.
const RADII: [f64; 4] = [1.0, 0.4, 0.15, 0.0];

/// How much the radius may change on a way, as a share of it. A radius at a stop is zero.
const SLOPE: f64 = 0.5;

/// Knots in a radius.
const KNOTS_IN_RADIUS: f64 = 6.0;

/// The largest radius, seconds at full speed.
const LARGEST: f64 = 1.0;

/// Where projections fail all radii become this share of themselves.
const SMALLER: [f64; 3] = [1.0, 0.3, 0.0];

/// Whether a curve that was refused so often near a knot is refused for good.
pub(crate) fn is_given_up(refusals: usize) -> bool {
    refusals >= RADII.len()
}

/// Knots on the leaf, without corners.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Rounded {
    /// Whole configurations, end to end.
    pub knots: Vec<f64>,
    /// Where the knots of the stretch lie that are joints of its motions: numbers of knots.
    pub joints: Vec<usize>,
}

/// A part of a stretch between two stops.
pub(crate) struct Rounding<'a> {
    problem: &'a SmoothingProblem<'a>,
    /// Its first knot and its last.
    ends: (usize, usize),
    /// Seconds at full speed from the first knot to each.
    ways: Vec<f64>,
    /// By knot.
    radii: Vec<f64>,
    /// The radius where nothing makes it smaller.
    full: f64,
}

impl<'a> Rounding<'a> {
    /// The part between two knots at which the robot stops.
    pub(crate) fn between(problem: &'a SmoothingProblem<'a>, ends: (usize, usize)) -> Self {
        let stretch = problem.stretch;
        let mut ways = vec![0.0];
        for k in ends.0..ends.1 {
            ways.push(ways[k - ends.0] + problem.edge(k));
        }
        let full = full_radius(&stretch.velocity, &stretch.acceleration);
        let mut rounding = Self { problem, ends, ways, radii: Vec::new(), full };
        rounding.radii = rounding.all_radii();
        rounding
    }

    /// By knot: as large as the refusals near it, the stops and the waypoints allow.
    fn all_radii(&self) -> Vec<f64> {
        let last = self.ways.len() - 1;
        let refusals = &self.problem.refusals[self.ends.0..=self.ends.1];
        let share = |refusals: &usize| RADII.get(*refusals).copied().unwrap_or(0.0);
        let mut radii: Vec<f64> = refusals.iter().map(|refusals| self.full * share(refusals)).collect();
        (radii[0], radii[last]) = (0.0, 0.0);
        let joints = self.joints();
        let mut places = vec![0.0];
        places.extend(joints.iter().map(|&joint| self.ways[joint]));
        places.push(self.ways[last]);
        for (joint, around) in joints.iter().zip(places.windows(3)) {
            let most = SHARES[0] * AT_WAYPOINT * (around[1] - around[0]).min(around[2] - around[1]);
            radii[*joint] = radii[*joint].min(most);
        }
        for k in 1..=last {
            radii[k] = radii[k].min(radii[k - 1] + SLOPE * (self.ways[k] - self.ways[k - 1]));
        }
        for k in (0..last).rev() {
            radii[k] = radii[k].min(radii[k + 1] + SLOPE * (self.ways[k + 1] - self.ways[k]));
        }
        radii
    }

    /// Joints of motions inside, counted from the first knot.
    fn joints(&self) -> Vec<usize> {
        let inside = self.problem.stretch.joints.iter().filter(|joint| **joint > self.ends.0 && **joint < self.ends.1);
        inside.map(|joint| joint - self.ends.0).collect()
    }

    /// The knots without corners. `None` where a projection fails however small the radii are.
    pub(crate) fn rounded(&self, scratch: &mut Scratch) -> Option<Rounded> {
        SMALLER.iter().find_map(|scale| self.with_radii(*scale, scratch))
    }

    fn with_radii(&self, scale: f64, scratch: &mut Scratch) -> Option<Rounded> {
        let SmoothingProblem { model, settings, motions, stretch, .. } = *self.problem;
        let motion = &motions[stretch.motions.start];
        let program = model.interior_program(motion.state).ok()?;
        let fresh: Vec<_> = motion.parameters.iter().map(|p| LegParameter::Fresh(*p)).collect();
        let arguments = program.arguments(model, &LeafIndex::default(), motion.state, &fresh, None);
        let solve = Settings {
            tolerance: TIGHT * settings.projection_tolerance,
            iterations: settings.projection_iterations,
            level: settings.level,
            ..Settings::default()
        };
        let mut rounded = Rounded { knots: self.knot(0).to_vec(), joints: Vec::new() };
        let last = self.ways.len() - 1;
        let mut from = 0;
        for to in self.joints().into_iter().chain([last]) {
            for way in self.places(from, to, scale) {
                let mut q = self.mean(way, scale);
                model.problem.robot.space.clamp(&mut q);
                if !project(&program.program, &mut q, &arguments, &solve, scratch).is_converged() {
                    return None;
                }
                rounded.knots.extend_from_slice(&q);
            }
            let size = stretch.velocity.len();
            match to < last {
                true => rounded.joints.push(rounded.knots.len() / size - 1),
                false => rounded.knots.extend_from_slice(self.knot(last)),
            }
            from = to;
        }
        self.is_apart(&rounded).then_some(rounded)
    }

    /// Whether knots are so far apart that their directions mean something.
    fn is_apart(&self, rounded: &Rounded) -> bool {
        let velocity = &self.problem.stretch.velocity;
        let knots: Vec<&[f64]> = rounded.knots.chunks_exact(velocity.len()).collect();
        knots.windows(2).all(|pair| time_at_full_speed(pair[0], pair[1], velocity) > NEAREST)
    }

    fn knot(&self, k: usize) -> &[f64] {
        self.problem.knot(self.ends.0 + k)
    }

    /// Ways of the knots to be, behind knot `from` and up to knot `to`; the end of the part is left out.
    fn places(&self, from: usize, to: usize, scale: f64) -> Vec<f64> {
        let (end, is_last) = (self.ways[to], to + 1 == self.ways.len());
        let mut places = Vec::new();
        let mut way = self.ways[from];
        loop {
            let step = self.spacing(way, scale);
            if way + 1.5 * step >= end {
                break;
            }
            way += step;
            places.push(way);
        }
        if !is_last {
            places.push(end);
        }
        places
    }

    /// The distance between knots at a way.
    fn spacing(&self, way: f64, scale: f64) -> f64 {
        let (piece, _) = self.piece(way);
        let refusals = &self.problem.refusals[self.ends.0 + piece..=self.ends.0 + piece + 1];
        let halvings = refusals.iter().max().map_or(0, |most| *most).min(RADII.len()) as i32;
        let coarse = self.full / KNOTS_IN_RADIUS * 0.5_f64.powi(halvings);
        (scale * self.radius(way) / KNOTS_IN_RADIUS).clamp(0.25 * coarse, coarse)
    }

    /// The piece in which a way lies, and how far along it, in [0, 1].
    fn piece(&self, way: f64) -> (usize, f64) {
        let piece = self.ways.partition_point(|w| *w <= way).clamp(1, self.ways.len() - 1) - 1;
        (piece, ((way - self.ways[piece]) / (self.ways[piece + 1] - self.ways[piece])).clamp(0.0, 1.0))
    }

    fn radius(&self, way: f64) -> f64 {
        let (piece, _) = self.piece(way);
        let from = self.radii[piece] + SLOPE * (way - self.ways[piece]);
        let to = self.radii[piece + 1] + SLOPE * (self.ways[piece + 1] - way);
        from.min(to).min(self.full)
    }

    fn at(&self, way: f64, i: usize) -> f64 {
        let (piece, t) = self.piece(way);
        let (a, b) = (self.knot(piece)[i], self.knot(piece + 1)[i]);
        a + t * (b - a)
    }

    /// The mean of the motion around a way. Differences are summed, so that a coordinate that rests keeps its value.
    fn mean(&self, way: f64, scale: f64) -> Vec<f64> {
        let radius = scale * self.radius(way);
        let size = self.problem.stretch.velocity.len();
        let here: Vec<f64> = (0..size).map(|i| self.at(way, i)).collect();
        if radius <= 0.0 {
            return here;
        }
        let (low, high) = (way - radius, way + radius);
        let (first, _) = self.piece(low);
        let (last, _) = self.piece(high);
        let mut sums = vec![0.0; size];
        for piece in first..=last {
            let (from, to) = (self.ways[piece].max(low), self.ways[piece + 1].min(high));
            if to <= from {
                continue;
            }
            // The motion is linear on a piece: its mean is its value in the middle.
            let middle = from.midpoint(to);
            let t = (middle - self.ways[piece]) / (self.ways[piece + 1] - self.ways[piece]);
            let (a, b) = (self.knot(piece), self.knot(piece + 1));
            for i in 0..size {
                sums[i] += (to - from) * (a[i] + t * (b[i] - a[i]) - here[i]);
            }
        }
        here.iter().zip(&sums).map(|(x, sum)| x + sum / (2.0 * radius)).collect()
    }
}

/// Knots are projected so much closer than in a search: a spline through them amplifies what is left.
const TIGHT: f64 = 1e-2;

/// Knots are not closer than this, seconds at full speed.
const NEAREST: f64 = 1e-5;

/// The radius of an arc through which the slowest coordinate turns by its full speed without slowing down, seconds at full speed.
fn full_radius(velocity: &[f64], acceleration: &[f64]) -> f64 {
    let ramps = velocity.iter().zip(acceleration).filter(|(v, _)| v.is_finite()).map(|(v, a)| v / a);
    (0.5 * ramps.fold(0.0, f64::max)).clamp(0.01, LARGEST)
}
