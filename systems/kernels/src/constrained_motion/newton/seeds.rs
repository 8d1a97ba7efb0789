//! Where a solve may start so that it is likely to end well: configurations of an arm from all over its reach, kept with the
//! poses of its hand, of which those nearest to where the hand has to go are found in lanes.
//!
//! A table follows from the robot alone: it uses neither start, goal nor objects, and no random numbers.

use crate::constrained_motion::lane_rows::hand::SeedTarget;
use crate::constrained_motion::program::constraint_program::ConstraintProgram;
use crate::constrained_motion::program::scratch::Scratch;
use crate::kinematics::lane_forward::LaneKinematics;
use crate::kinematics::lane_steps::POSE_ROWS;
use crate::lanes::geometry::{Transform, Vector3};
use crate::lanes::level::{Kernel, Level};
use crate::lanes::vector::{F32Row, F64Row, Isa, Lanes, Mask};
use foliate_components::Pose;
use foliate_components::constraint::Frame;
use foliate_components::robot::{JointIndex, JointType, Robot, Source};
use glam::DVec3;

/// Configurations of a table: enough for most of what more would give, and built in milliseconds.
pub const SEEDS: usize = 8192;

/// Configurations in a block of lanes.
const BLOCK: usize = 16;

/// Rows of a ball.
const BALL_ROWS: usize = 4;

/// Metres: blocks within the first of these around where the hand has to go are looked at before those within the next.
const ROUNDS: [f32; 5] = [0.05, 0.15, 0.3, 0.5, f32::INFINITY];

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
    /// The point of the body by which blocks are cells of space: the origin of its gripper.
    point: DVec3,
    /// By sixteen blocks, [`BALL_ROWS`] rows: the centre and the radius of a ball around that point in all their configurations.
    balls: Vec<F32Row>,
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
            if !matches!(joint.motion, JointType::Revolute { .. } | JointType::Prismatic { .. }) {
                return None;
            }
            coordinates.push(q);
        }
        if coordinates.is_empty() || coordinates.len() > 8 {
            return None;
        }
        let point = gripper_on(robot, tip);
        let spread = spread(robot, &coordinates, SEEDS);
        let places = places_of(&poses_of(robot, &chain, &coordinates, &spread), point);
        let mut order: Vec<usize> = (0..SEEDS).collect();
        into_cells(&mut order, &places);
        let width = coordinates.len();
        let configurations: Vec<f64> = order.iter().flat_map(|&i| &spread[i * width..][..width]).copied().collect();
        let places: Vec<DVec3> = order.iter().map(|&i| places[i]).collect();
        let poses = poses_of(robot, &chain, &coordinates, &configurations);
        Some(Self { tip, coordinates, configurations, poses, point, balls: balls_around(&places) })
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
        size_of_val(self.configurations.as_slice())
            + size_of_val(self.poses.as_slice())
            + size_of_val(self.balls.as_slice())
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

    /// Sixteen seeds whose hand is near the target, nearest first. The first is the nearest of all; the others are the
    /// nearest of their lanes in the cells that could hold it, so that they lie apart.
    #[must_use]
    pub fn nearest(&self, level: Level, target: &SeedTarget) -> [u32; BLOCK] {
        let (gaps, blocks) = level.run(Scan { table: self, target });
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

/// The origin of a gripper that a body carries; of the body itself where it carries none.
fn gripper_on(robot: &Robot, tip: JointIndex) -> DVec3 {
    let frames = robot.grippers.iter().map(|gripper| Frame::on_link(robot, gripper.link, &gripper.link_from_gripper));
    let on_tip = frames.filter(|frame| frame.joint == Some(tip));
    on_tip.map(|frame| frame.joint_from_frame.translation).next().unwrap_or(DVec3::ZERO)
}

/// Where a point of the hand is in each configuration.
fn places_of(poses: &[F32Row], point: DVec3) -> Vec<DVec3> {
    let place = |rows: &[F32Row], lane: usize| {
        let number = |row: usize| f64::from(rows[row][lane]);
        let column = |k: usize| DVec3::new(number(3 * k), number(3 * k + 1), number(3 * k + 2));
        column(0) * point.x + column(1) * point.y + column(2) * point.z + column(3)
    };
    poses.chunks_exact(POSE_ROWS).flat_map(|rows| (0..BLOCK).map(move |lane| place(rows, lane))).collect()
}

/// Puts configurations whose hands are near each other into one block: halves along the longest side, again and again.
fn into_cells(order: &mut [usize], places: &[DVec3]) {
    if order.len() <= BLOCK {
        return;
    }
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &i in &*order {
        (low, high) = (low.min(places[i]), high.max(places[i]));
    }
    let axis = (high - low).max_position();
    let half = order.len() / 2;
    order.select_nth_unstable_by(half, |&a, &b| places[a][axis].total_cmp(&places[b][axis]).then(a.cmp(&b)));
    let (left, right) = order.split_at_mut(half);
    into_cells(left, places);
    into_cells(right, places);
}

/// A ball around each block's places, with room for rounding.
fn balls_around(places: &[DVec3]) -> Vec<F32Row> {
    let blocks = places.len() / BLOCK;
    let mut balls = vec![F32Row::default(); blocks.div_ceil(BLOCK) * BALL_ROWS];
    for (number, places) in places.chunks_exact(BLOCK).enumerate() {
        let centre = places.iter().sum::<DVec3>() / BLOCK as f64;
        let radius = places.iter().map(|place| place.distance(centre)).fold(0.0, f64::max);
        let rows = &mut balls[number / BLOCK * BALL_ROWS..][..BALL_ROWS];
        for (row, x) in rows.iter_mut().zip([centre.x, centre.y, centre.z, radius + 1e-4]) {
            row[number % BLOCK] = x as f32;
        }
    }
    balls
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

/// For each lane the smallest gap, and the block where it is, among blocks that may hold the smallest of all.
struct Scan<'a> {
    table: &'a SeedTable,
    target: &'a SeedTarget,
}

/// A target in lanes.
#[derive(Clone, Copy)]
struct Wanted<V> {
    point: Vector3<V>,
    place: Vector3<V>,
    directions: [Vector3<V>; 3],
    everywhere: bool,
    alignment: [Vector3<V>; 3],
}

impl<V: Lanes> Wanted<V> {
    #[inline(always)]
    fn splat(isa: V::Isa, target: &SeedTarget) -> Self {
        let (rows, columns) = (target.directions.transpose(), target.alignment);
        let splat = [rows.x_axis, rows.y_axis, rows.z_axis, columns.x_axis, columns.y_axis, columns.z_axis];
        let [dx, dy, dz, ax, ay, az] = splat;
        Self {
            point: Vector3::splat(isa, target.point),
            place: Vector3::splat(isa, target.place),
            directions: [Vector3::splat(isa, dx), Vector3::splat(isa, dy), Vector3::splat(isa, dz)],
            everywhere: target.everywhere,
            alignment: [Vector3::splat(isa, ax), Vector3::splat(isa, ay), Vector3::splat(isa, az)],
        }
    }

    /// How far bodies are from the target: squared metres, less what their rotations agree.
    #[inline(always)]
    fn gap(&self, body: &Transform<V>) -> V {
        let mut apart = body.point(self.point).minus(self.place);
        if !self.everywhere {
            let [x, y, z] = self.directions;
            apart = Vector3::new(x.dot(apart), y.dot(apart), z.dot(apart));
        }
        let [x, y, z] = body.rotation.columns;
        let [ax, ay, az] = self.alignment;
        apart.dot(apart) - (x.dot(ax) + y.dot(ay) + z.dot(az))
    }
}

impl Kernel for Scan<'_> {
    type Output = (F32Row, F32Row);

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> (F32Row, F32Row) {
        let Self { table, target } = self;
        let wanted = Wanted::<I::F32>::splat(isa, target);
        let most = target.most_alignment();
        // How far the place is at least from a point of the block's hands: the table's point is another than the target's.
        let aside = table.point.distance(target.point) as f32;
        let mut distances = [F32Row::default(); SEEDS / BLOCK / BLOCK];
        for (rows, out) in table.balls.chunks_exact(BALL_ROWS).zip(&mut distances) {
            let centre =
                Vector3::new(I::F32::load(isa, &rows[0]), I::F32::load(isa, &rows[1]), I::F32::load(isa, &rows[2]));
            let apart = centre.minus(wanted.place);
            let reach = I::F32::load(isa, &rows[3]) + aside;
            let zero = I::F32::splat(isa, 0.0);
            let distance = (apart.dot(apart).sqrt() - reach).max(zero);
            // Where not all directions count, what is far may be near in those that do.
            if target.everywhere { distance.store(out) } else { zero.store(out) }
        }
        let mut least = I::F32::splat(isa, f32::MAX);
        let mut nearest = I::F32::splat(isa, 0.0);
        let (mut best, mut inner) = (f32::MAX, -1.0);
        for outer in ROUNDS {
            for (group, distances) in distances.iter().enumerate() {
                let distance = I::F32::load(isa, distances);
                let here = distance.lt(I::F32::splat(isa, outer)) & I::F32::splat(isa, inner).le(distance);
                let mut bits = here.bits();
                while bits != 0 {
                    let lane = bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    if distances[lane] * distances[lane] - most > best {
                        continue;
                    }
                    let block = group * BLOCK + lane;
                    let body = Transform::<I::F32>::load(isa, &table.poses[block * POSE_ROWS..]);
                    let gap = wanted.gap(&body);
                    let nearer = gap.lt(least);
                    least = I::F32::select(nearer, gap, least);
                    nearest = I::F32::select(nearer, I::F32::splat(isa, block as f32), nearest);
                    best = least.least();
                }
            }
            inner = outer;
            if outer * outer - most > best {
                break;
            }
        }
        let (mut gaps, mut blocks) = (F32Row::default(), F32Row::default());
        least.store(&mut gaps);
        nearest.store(&mut blocks);
        (gaps, blocks)
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
        crate::constrained_motion::rows::bodies::run(
            &self.bodies.still,
            q,
            &scratch.rigid_attachments,
            &mut scratch.X_WJ,
        );
        let given = |slot: usize| {
            lanes.givens[slot].pose(arguments, &scratch.rigid_attachments, &scratch.decoded, &scratch.X_WJ)
        };
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
