//! Where a solve may start so that it is likely to end well: configurations of an arm from all over its reach, kept with the
//! poses of its hand, of which those nearest to where the hand has to go are found in lanes.
//!
//! A table follows from the robot alone: neither start, goal nor objects are looked at, and no random numbers.

use super::lane_program::{FrameAt, LaneProgram, LaneRows, RowsAt, Target};
use super::program::ConstraintProgram;
use super::scratch::Scratch;
use crate::kinematics::{LaneKinematics, POSE_ROWS};
use crate::lanes::{F32Row, F64Row, Isa, Kernel, Lanes, Level, Transform, Vector3};
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, Motion, Robot, Source};
use glam::{DMat3, DQuat, DVec3};

/// Configurations of a table: enough for most of what more would give, and scanned in two microseconds.
pub const SEEDS: usize = 4096;

/// Metres for which a radian counts where hands are compared.
const RADIAN: f64 = 0.3;

/// Configurations in a block of lanes.
const BLOCK: usize = 16;

/// Configurations of the joints between the world and a body, and where the body is in them.
#[derive(Clone, Debug, PartialEq)]
pub struct SeedTable {
    tip: JointIndex,
    /// Configuration indices of the joints.
    coordinates: Vec<usize>,
    /// One number per coordinate, configuration after configuration.
    configurations: Vec<f64>,
    /// [`POSE_ROWS`] rows per block.
    poses: Vec<F32Row>,
}

/// Where a body is to go: what a program's rows say of it, for one problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeedTarget {
    /// The frame's origin in the body.
    point: DVec3,
    /// Where that is to be, in the world.
    place: DVec3,
    /// Takes a distance in the world to the directions that count.
    directions: DMat3,
    /// Whether all directions count, so that it need not.
    everywhere: bool,
    /// Σ over columns of the body's rotation · these is largest where the frames are aligned as far as that counts.
    alignment: DMat3,
}

impl SeedTable {
    /// The table of a body. `None` where joints that are no single coordinates lie between it and the world, or none at all,
    /// or more than eight: a few thousand configurations say little then.
    #[must_use]
    pub fn new(robot: &Robot, tip: JointIndex) -> Option<Self> {
        let chain = LaneKinematics::chain_to(robot, tip);
        let mut coordinates = Vec::new();
        for joint in chain.bodies().iter().map(|body| &robot.joints[body.at()]) {
            let Source::Coordinates { q, .. } = joint.source else { return None };
            if !matches!(joint.motion, Motion::Revolute { .. } | Motion::Prismatic { .. }) {
                return None;
            }
            coordinates.push(q);
        }
        if coordinates.is_empty() || coordinates.len() > 8 {
            return None;
        }
        let configurations = spread(robot, &coordinates, SEEDS);
        let poses = poses_of(robot, &chain, &coordinates, &configurations);
        Some(Self { tip, coordinates, configurations, poses })
    }

    /// The body.
    #[must_use]
    pub fn tip(&self) -> JointIndex {
        self.tip
    }

    /// The configuration indices that a seed gives numbers for.
    #[must_use]
    pub fn coordinates(&self) -> &[usize] {
        &self.coordinates
    }

    /// Bytes that the table takes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.configurations.as_slice()) + size_of_val(self.poses.as_slice())
    }

    /// Numbers of a seed, as [`Self::coordinates`].
    ///
    /// # Panics
    /// If there is no such seed.
    #[must_use]
    pub fn seed(&self, index: usize) -> &[f64] {
        let width = self.coordinates.len();
        &self.configurations[index * width..][..width]
    }

    /// Sixteen seeds whose hand is near the target, nearest first: of every lane the nearest, so that they lie apart.
    #[must_use]
    pub fn nearest(&self, level: Level, target: &SeedTarget) -> [u32; BLOCK] {
        let (gaps, blocks) = level.run(Scan { poses: &self.poses, target });
        let mut found: [(f32, u32); BLOCK] =
            std::array::from_fn(|lane| (gaps[lane], blocks[lane] as u32 * BLOCK as u32 + lane as u32));
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.map(|(_, seed)| seed)
    }
}

/// Configurations spread evenly within bounds: the additive recurrence of the generalised golden ratio.
fn spread(robot: &Robot, coordinates: &[usize], count: usize) -> Vec<f64> {
    let width = coordinates.len();
    let mut ratio = 1.5_f64;
    for _ in 0..60 {
        ratio = (1.0 + ratio).powf(1.0 / (width as f64 + 1.0));
    }
    let mut configurations = Vec::with_capacity(count * width);
    for index in 0..count {
        for (k, &q) in coordinates.iter().enumerate() {
            let step = ratio.powi(-(k as i32 + 1));
            let share = (0.5 + step * (index as f64 + 1.0)).fract();
            // What turns without end has no bounds; one turn is all there is.
            let low = robot.space.lower[q].max(-std::f64::consts::PI * 2.0);
            let high = robot.space.upper[q].min(std::f64::consts::PI * 2.0);
            let turns = high - low > std::f64::consts::TAU + 1e-9 && robot.space.upper[q].is_infinite();
            let (low, high) = if turns { (-std::f64::consts::PI, std::f64::consts::PI) } else { (low, high) };
            configurations.push(low + share * (high - low));
        }
    }
    configurations
}

/// At the level that every machine has, so that a table is the same everywhere.
fn poses_of(robot: &Robot, chain: &LaneKinematics, coordinates: &[usize], configurations: &[f64]) -> Vec<F32Row> {
    let (size, width) = (robot.space.size(), coordinates.len());
    let mut q = vec![F64Row::default(); size];
    let mut bodies = vec![F64Row::default(); chain.bodies().len() * POSE_ROWS];
    let count = configurations.len() / width;
    let mut poses = vec![F32Row::default(); count / BLOCK * POSE_ROWS];
    for half in 0..count / 8 {
        for lane in 0..8 {
            let seed = &configurations[(half * 8 + lane) * width..][..width];
            coordinates.iter().zip(seed).for_each(|(&coordinate, &x)| q[coordinate][lane] = x);
        }
        chain.forward_f64(Level::scalar(), &q, &mut bodies);
        let tip = &bodies[bodies.len() - POSE_ROWS..];
        let rows = &mut poses[half / 2 * POSE_ROWS..][..POSE_ROWS];
        for (row, from) in rows.iter_mut().zip(tip) {
            let at = half % 2 * 8;
            row.0[at..at + 8].iter_mut().zip(from.iter()).for_each(|(to, &from)| *to = from as f32);
        }
    }
    poses
}

/// For each lane the smallest gap, and the block where it is.
struct Scan<'a> {
    poses: &'a [F32Row],
    target: &'a SeedTarget,
}

impl Kernel for Scan<'_> {
    type Output = (F32Row, F32Row);

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> (F32Row, F32Row) {
        let SeedTarget { point, place, directions, everywhere, alignment } = self.target;
        let (point, place) = (Vector3::<I::F32>::splat(isa, *point), Vector3::<I::F32>::splat(isa, *place));
        let rows = directions.transpose();
        let [dx, dy, dz] = [rows.x_axis, rows.y_axis, rows.z_axis];
        let (dx, dy, dz) = (Vector3::splat(isa, dx), Vector3::splat(isa, dy), Vector3::splat(isa, dz));
        let [ax, ay, az] = [alignment.x_axis, alignment.y_axis, alignment.z_axis];
        let (ax, ay, az) = (Vector3::splat(isa, ax), Vector3::splat(isa, ay), Vector3::splat(isa, az));
        let mut least = I::F32::splat(isa, f32::MAX);
        let (mut nearest, mut number) = (I::F32::splat(isa, 0.0), I::F32::splat(isa, 0.0));
        for block in self.poses.chunks_exact(POSE_ROWS) {
            let body = Transform::<I::F32>::load(isa, block);
            let mut apart = body.point(point).minus(place);
            if !everywhere {
                apart = Vector3::new(dx.dot(apart), dy.dot(apart), dz.dot(apart));
            }
            let [x, y, z] = body.rotation.columns;
            let aligned = x.dot(ax) + y.dot(ay) + z.dot(az);
            let gap = apart.dot(apart) - aligned;
            let nearer = gap.lt(least);
            least = I::F32::select(nearer, gap, least);
            nearest = I::F32::select(nearer, number, nearest);
            number = number + 1.0;
        }
        let (mut gaps, mut blocks) = (F32Row::default(), F32Row::default());
        least.store(&mut gaps);
        nearest.store(&mut blocks);
        (gaps, blocks)
    }
}

/// What a program's rows say of the one body that a seed table knows.
#[derive(Clone, Debug)]
pub(super) struct Hand {
    pub tip: JointIndex,
    /// The frame on the body.
    X_JF: Pose,
    /// Whether it is the first frame that moves, and the second that stands still.
    is_first: bool,
    /// The first frame where it stands still, and the reference seen from it; or the second frame, and the reference itself.
    stands: usize,
    target: Option<usize>,
    fixed: Pose,
    rows: RowsAt,
}

impl LaneProgram {
    /// The hand that a lone relative pose brings to something that does not move, and on whose joints alone it depends.
    pub(super) fn hand(&self, bodies: &[usize], robot: &Robot) -> Option<Hand> {
        let [LaneRows::Pose(pose)] = self.blocks.as_slice() else { return None };
        let reference = |target: &Target| match target {
            Target::Frame => Some((None, Pose::identity())),
            Target::Fixed(pose) => Some((None, *pose)),
            Target::Given(slot) | Target::Reference(slot) => Some((Some(*slot), Pose::identity())),
        };
        let (target, fixed) = reference(&pose.target)?;
        let (at, X_JF, is_first, stands) = match (pose.a, pose.b) {
            (FrameAt::Given(stands), FrameAt::Body(at, X_JF)) => (at, X_JF, false, stands),
            (FrameAt::Body(at, X_JF), FrameAt::Given(stands)) => (at, X_JF, true, stands),
            _ => return None,
        };
        // A hand may carry what the rows look at: then it is the table of the body beneath that moves by joints.
        let tip = JointIndex(*bodies.get(at)? as u32);
        let mut chain = std::iter::successors(Some(tip), |&j| robot.joints[j.at()].parent);
        let moves = |joint: JointIndex| match robot.joints[joint.at()].source {
            Source::Coordinates { q, .. } => self.moves.iter().any(|change| change.coordinate == q),
            Source::Follows { .. } => false,
        };
        let all = chain.all(moves);
        (all && self.steps.len() == self.moves.len()).then_some(Hand {
            tip,
            X_JF,
            is_first,
            stands,
            target,
            fixed,
            rows: pose.out,
        })
    }
}

impl ConstraintProgram {
    /// The body that solves of this program bring somewhere with its own joints alone, for which a [`SeedTable`] has seeds.
    #[must_use]
    pub fn hand(&self) -> Option<JointIndex> {
        self.hand.as_ref().map(|hand| hand.tip)
    }

    /// Where arguments and the configuration `q` (of which only what does not move counts) want that body. `None` where there
    /// is none, or arguments do not fit.
    #[must_use]
    pub fn seed_target(&self, q: &[f64], arguments: &[Pose], scratch: &mut Scratch) -> Option<SeedTarget> {
        let (hand, lanes) = (self.hand.as_ref()?, self.lanes.as_ref()?);
        if !self.fits(q, arguments) {
            return None;
        }
        scratch.prepare(self);
        if !self.resolve(arguments, scratch) {
            return None;
        }
        super::bodies::run(&self.bodies.still, q, &scratch.carriages, &mut scratch.X_WJ);
        let given =
            |slot: usize| lanes.givens[slot].pose(arguments, &scratch.carriages, &scratch.decoded, &scratch.X_WJ);
        // Where the moving frame is to be: the target itself, or the first frame from which the second is seen at it.
        let stands = given(hand.stands);
        let X_WF = match (hand.is_first, hand.target) {
            (false, Some(slot)) => given(slot),
            (false, None) => stands * hand.fixed,
            (true, Some(slot)) => stands * given(slot).inverse(),
            (true, None) => stands * hand.fixed.inverse(),
        };
        Some(hand.target_at(&X_WF, if hand.is_first { X_WF.rotation } else { stands.rotation }))
    }
}

impl Hand {
    /// `axes` are those of the translation rows.
    fn target_at(&self, X_WF: &Pose, axes: DQuat) -> SeedTarget {
        let counts = |row: usize| f64::from(u8::from(self.rows.row[row] != usize::MAX && !self.rows.inequality[row]));
        let directions =
            DMat3::from_diagonal(DVec3::new(counts(0), counts(1), counts(2))) * DMat3::from_quat(axes.conjugate());
        // A free turn about one axis leaves that axis to be compared; two free turns leave nothing that is worth it.
        let turns = [counts(3), counts(4), counts(5)];
        let weights = match turns.iter().sum::<f64>() {
            3.0 => [1.0; 3],
            2.0 => std::array::from_fn(|k| if turns[k] == 0.0 { 2.0 } else { 0.0 }),
            _ => [0.0; 3],
        };
        let (own, wanted) = (DMat3::from_quat(self.X_JF.rotation), DMat3::from_quat(X_WF.rotation));
        // Σ wₖ (R·oₖ)·aₖ over the columns o of the frame in the body and a of where it is to be.
        let mut alignment = DMat3::ZERO;
        for (k, weight) in weights.into_iter().enumerate() {
            let (o, a) = (own.col(k), wanted.col(k) * (weight * RADIAN * RADIAN));
            alignment += DMat3::from_cols(a * o.x, a * o.y, a * o.z);
        }
        SeedTarget {
            point: self.X_JF.translation,
            place: X_WF.translation,
            directions,
            everywhere: (0..3).all(|row| counts(row) == 1.0),
            alignment,
        }
    }
}
