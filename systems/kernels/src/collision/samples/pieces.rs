//! The pieces of a motion: how joints move on each of them, and where the configurations of samples come from.
//!
//! A straight piece is a difference of configurations, a piece of a curve one polynomial per coordinate.

use crate::collision::samples::interval::Sample;
use crate::collision::samples::motion_bound::MotionBound;
use crate::collision::samples::way::Way;
use crate::collision::scene::collision_scene::CollisionScene;
use crate::collision::scene::pair_set::PairSet;
use crate::curve::cubic::Cubic;
use crate::curve::hermite::{HermiteCurve, normalise_quaternions};
use crate::kinematics::joint_table::JointEntry;
use foliate_components::Pose;

/// See the module. Buffers are reused from motion to motion.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pieces {
    /// Numbers of a configuration, of a velocity, and of joints.
    size: usize,
    dimension: usize,
    joints: usize,
    /// Of a polyline, by piece: the configuration space's difference.
    deltas: Vec<f64>,
    /// Of a curve, by piece and coordinate.
    cubics: Vec<Cubic>,
    /// By knot and joint: path lengths of rotation (radians) and translation (metres) up to there. On a piece of a curve the
    /// farthest that the joint gets from an end counts as its length.
    lengths: Vec<(f64, f64)>,
    /// By joint: the farthest that its translation is from zero, metres.
    pub(crate) travel: Vec<f64>,
}

impl Pieces {
    /// No piece.
    pub(crate) fn start_over(&mut self, scene: &CollisionScene) {
        (self.size, self.dimension, self.joints) = (scene.space.size(), scene.space.dimension(), scene.joints.len());
        self.deltas.clear();
        self.cubics.clear();
        self.lengths.clear();
        self.lengths.resize(self.joints, (0.0, 0.0));
        self.travel.clear();
        self.travel.resize(self.joints, 0.0);
    }

    /// Straight pieces from knot to knot.
    pub(crate) fn begin(&mut self, scene: &CollisionScene, knots: &[f64]) {
        self.start_over(scene);
        let (size, dimension) = (self.size, self.dimension);
        let pieces = (knots.len() / size).saturating_sub(1);
        self.deltas.resize(pieces * dimension, 0.0);
        for piece in 0..pieces {
            let (a, b) = (&knots[piece * size..][..size], &knots[(piece + 1) * size..][..size]);
            scene.space.difference(a, b, &mut self.deltas[piece * dimension..][..dimension]);
            self.add(scene, |joint, pieces| joint.moves_by(a, &pieces.deltas[piece * dimension..][..dimension]));
        }
    }

    /// The pieces of a curve.
    pub(crate) fn begin_curve(&mut self, scene: &CollisionScene, curve: &HermiteCurve<'_>) {
        self.start_over(scene);
        curve.write_cubics(self.size, &mut self.cubics);
        for piece in 0..curve.pieces() {
            self.add(scene, |joint, pieces| joint.moves_along(&pieces.cubics[piece * pieces.size..][..pieces.size]));
        }
    }

    /// Adds a piece, given by how far each joint turns, slides, and gets from zero.
    fn add(&mut self, scene: &CollisionScene, moves: impl Fn(&JointEntry, &Self) -> (f64, f64, f64)) {
        let before = self.lengths.len() - self.joints;
        for (index, joint) in scene.joints.iter().enumerate() {
            let (turn, slide, travel) = moves(joint, self);
            let (turned, slid) = self.lengths[before + index];
            self.lengths.push((turned + turn, slid + slide));
            self.travel[index] = self.travel[index].max(travel);
        }
    }

    /// Which joints move somewhere.
    pub(crate) fn moving_joints(&self, out: &mut Vec<bool>) {
        out.clear();
        // Compared so that NaN moves.
        let moves = |&(turned, slid): &(f64, f64)| !(turned == 0.0 && slid == 0.0);
        out.extend(self.lengths[self.lengths.len() - self.joints..].iter().map(moves));
    }

    /// How far a joint can turn and slide from where a sample has it.
    pub(crate) fn moves_within(&self, joint: &JointEntry, index: usize, sample: Sample) -> (f64, f64) {
        let at = |knot: u32| self.lengths[knot as usize * self.joints + index];
        match sample {
            Sample::Knot { first, middle, last } => {
                let (a, m, b) = (at(first), at(middle), at(last));
                ((m.0 - a.0).max(b.0 - m.0), (m.1 - a.1).max(b.1 - m.1))
            }
            Sample::Inside { piece, t, half_width } => match self.cubics_of(piece) {
                Some(cubics) => joint.moves_within(cubics, t, half_width),
                None => {
                    let (a, b) = (at(piece), at(piece + 1));
                    ((b.0 - a.0) * half_width, (b.1 - a.1) * half_width)
                }
            },
        }
    }

    /// Where the configuration of a sample comes from.
    pub(crate) fn way<'a>(&'a self, knots: &'a [f64], sample: Sample) -> Way<'a> {
        let knot = |number: u32| &knots[number as usize * self.size..][..self.size];
        match sample {
            Sample::Knot { middle, .. } => Way::Knot(knot(middle)),
            Sample::Inside { piece, t, .. } => match self.cubics_of(piece) {
                Some(cubics) => Way::Curve(cubics, t),
                None => Way::Straight(knot(piece), self.delta(piece), t),
            },
        }
    }

    /// The configuration at a parameter of a piece.
    pub(crate) fn configuration(&self, scene: &CollisionScene, knots: &[f64], (piece, t): (u32, f64), q: &mut [f64]) {
        match self.cubics_of(piece) {
            Some(cubics) => {
                q.iter_mut().zip(cubics).for_each(|(x, cubic)| *x = cubic.at(t));
                normalise_quaternions(&scene.space, q);
            }
            None => {
                let (from, to) = knots[piece as usize * self.size..][..2 * self.size].split_at(self.size);
                scene.space.interpolate(from, to, t, q);
            }
        }
    }

    /// Starts the bound in double precision on a piece.
    pub(crate) fn begin_bound(
        &self,
        (scene, pairs): (&CollisionScene, &PairSet),
        knots: &[f64],
        piece: u32,
        bound: &mut MotionBound,
    ) {
        match self.cubics_of(piece) {
            Some(cubics) => bound.begin_curve(scene, pairs, cubics),
            None => bound.begin(scene, pairs, &knots[piece as usize * self.size..][..self.size], self.delta(piece)),
        }
    }

    /// Goes with that bound to the part of the piece within `half_width` of `t`, where bodies have the poses `X_WJ`.
    pub(crate) fn look_at_bound(
        &self,
        scene: &CollisionScene,
        (piece, t, half_width): (u32, f64, f64),
        X_WJ: &[Pose],
        bound: &mut MotionBound,
    ) {
        match self.cubics_of(piece) {
            Some(cubics) => bound.look_at_curve(scene, X_WJ, cubics, (t, half_width)),
            None => bound.look_at(scene, X_WJ, half_width),
        }
    }

    fn cubics_of(&self, piece: u32) -> Option<&[Cubic]> {
        (!self.cubics.is_empty()).then(|| &self.cubics[piece as usize * self.size..][..self.size])
    }

    fn delta(&self, piece: u32) -> &[f64] {
        &self.deltas[piece as usize * self.dimension..][..self.dimension]
    }
}
