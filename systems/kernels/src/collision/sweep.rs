//! Bounds of sixteen samples at once: which pairs are free over their intervals for sure.
//!
//! Everything is computed in single precision from poses in double precision that were rounded once, in the order balls of
//! bodies, balls of shapes, boxes and capsules of shapes. A bound counts where it is at least what is needed plus [`slack`]:
//! centres, axes and sizes carry a few units of rounding each of the largest coordinate M that takes part (three products
//! and sums for a centre: 5 u M with u = 2⁻²⁴, two of them and their difference 12 u M, a frame's axes turned back on it
//! 8 u M, supports 8 u M); 64 u M covers them twice over. A segment's parameters may be off by any amount: what counts is
//! the gap along the direction that they give, which is a bound whatever the direction is.
//!
//! Where it is asked for, a pair that stays open is compared by what lies inside of its solids (inner.rs) as well: overlaps
//! of more than the slack are collisions for sure.

use super::course::{Course, LANES, POSE};
use super::inner::Inner;
use super::outer::{Form, Outer};
use super::pairs::{ActiveGroup, PairSet};
use super::scene::CollisionScene;
use crate::lanes::{F32Row, Isa, Kernel, Lanes, Mask, Rotation, Transform, Vector3};
use foliate_components::robot::Motion;
use glam::DVec3;

/// A pair, and the lanes of a block in which it is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Open {
    /// Number of its group in the pair set.
    pub active: u32,
    /// Index of the pair, or [`ALL`].
    pub pair: u32,
    /// Lane 0 is the lowest bit.
    pub lanes: u16,
}

/// All pairs of the group.
pub(super) const ALL: u32 = u32::MAX;

/// Rounding of single-precision bounds, as a share of the largest coordinate.
const SLACK: f32 = 64.0 / 16_777_216.0;

/// Buffers of the sweep. Rows are valid for one block.
#[derive(Clone, Debug, Default)]
pub(super) struct SweepScratch {
    /// By cluster: centre of its ball in the world.
    centers: Vec<[F32Row; 3]>,
    /// By solid: centre and axes in the world.
    solids: Vec<[F32Row; POSE]>,
    /// By solid: the block for which its rows were computed.
    fresh_solids: Vec<u32>,
    /// By joint: axis in the world.
    axes: Vec<[F32Row; 3]>,
    /// By chain link, one more per cluster, and a last one that is zero: how far the joints from the body up to there can
    /// displace it, metres.
    moved: Vec<F32Row>,
    fresh_clusters: Vec<u32>,
    block: u32,
    /// At most this much do lanes' bounds err in the block, metres.
    slack: F32Row,
}

impl SweepScratch {
    /// Starts a motion.
    pub(super) fn begin(&mut self, scene: &CollisionScene, pairs: &PairSet) {
        self.centers.resize(scene.clusters.len().max(self.centers.len()), Default::default());
        self.solids.resize(scene.solids.len().max(self.solids.len()), Default::default());
        self.axes.resize(scene.joints.len().max(self.axes.len()), Default::default());
        let rows = pairs.tree.links.len() + scene.clusters.len() + 1;
        self.moved.clear();
        self.moved.resize(rows, F32Row::default());
        self.fresh_solids.clear();
        self.fresh_solids.resize(scene.solids.len(), 0);
        self.fresh_clusters.clear();
        self.fresh_clusters.resize(scene.clusters.len(), 0);
        self.block = 0;
    }
}

impl SweepScratch {
    /// At most this far do the clusters of a group come closer within the interval of a lane, metres; to be asked after a
    /// sweep over the group.
    pub(super) fn closer(&self, active: &ActiveGroup, lane: usize) -> f64 {
        f64::from(self.moved[active.rows.0 as usize][lane]) + f64::from(self.moved[active.rows.1 as usize][lane])
    }
}

/// One pass over the open pairs of a block.
pub(super) struct Sweep<'a> {
    pub scene: &'a CollisionScene,
    pub pairs: &'a PairSet,
    pub course: &'a Course,
    pub scratch: &'a mut SweepScratch,
    pub guard: f64,
    /// Lanes of the block that are of interest.
    pub lanes: u16,
    /// Pairs to look at, those of a group side by side.
    pub open: &'a [Open],
    /// Those that stay open.
    pub rest: &'a mut Vec<Open>,
    /// Where collisions that are sure go, if they are of interest.
    pub hits: Option<&'a mut Hits>,
}

/// In which lanes something collides for sure, and which lanes need no further look for that.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Hits {
    /// By lane, where it collides: the pair, and minus how far its insides overlap, metres.
    pub pairs: [(u32, f32); LANES],
    pub colliding: u16,
    /// Lanes that are decided, whether they collide or not.
    pub settled: u16,
    /// Lanes that need not be decided where the one before them collides.
    pub followers: u16,
}

impl Hits {
    /// A pair collides in these lanes.
    fn add(&mut self, pair: u32, lanes: u16, overlaps: &F32Row) {
        let mut new = lanes & !self.colliding;
        self.colliding |= lanes;
        while new != 0 {
            let lane = new.trailing_zeros();
            new &= new - 1;
            self.pairs[lane as usize] = (pair, overlaps[lane as usize]);
            self.settle(lane);
        }
    }

    /// A lane collides.
    pub(super) fn settle(&mut self, lane: u32) {
        self.settled |= 1 << lane | following(self.followers, lane);
    }
}

/// The lanes in one row of followers behind a lane.
fn following(followers: u16, lane: u32) -> u16 {
    let behind = u32::from(followers) & (u32::MAX << (lane + 1));
    // What is carried on from the first of them runs up to the first lane that is none.
    let carried = behind.wrapping_add(1 << (lane + 1));
    (behind & !carried) as u16
}

impl Kernel for Sweep<'_> {
    /// What all that is certified keeps, metres.
    type Output = f32;

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> f32 {
        let Sweep { scene, pairs, course, scratch, guard, mut lanes, open, rest, mut hits } = self;
        scratch.block += 1;
        let most = place_axes(isa, scene, course, scratch);
        place_clusters(isa, scene, course, scratch, most);
        let slack = I::F32::load(isa, &scratch.slack);
        let mut least = I::F32::constant(isa, f64::INFINITY);
        let mut at = 0;
        while at < open.len() {
            let number = open[at].active;
            let mut end = at;
            while end < open.len() && open[end].active == number {
                end += 1;
            }
            let run = &open[at..end];
            at = end;
            if lanes == 0 {
                break;
            }
            let active = pairs.active(number);
            // What does not move within the block stands in the first lane, and there for all.
            let is_shared = hits.is_some() && !course.moves_between(active);
            let group = &scene.groups[active.group as usize];
            let closer = approach(isa, scene, pairs, course, scratch, active);
            let (a, b) = (&scratch.centers[group.first as usize], &scratch.centers[group.second as usize]);
            let apart = Vector3::<I::F32>::load(isa, a).minus(Vector3::load(isa, b));
            let radii =
                scene.clusters[group.first as usize].ball.radius + scene.clusters[group.second as usize].ball.radius;
            let free = apart.dot(apart).sqrt() - I::F32::constant(isa, radii) - closer - slack;
            let near = !I::F32::constant(isa, active.margin + guard).le(free);
            least = I::F32::select(near, least, least.min(free));
            let near = near.bits() as u16 & if is_shared { 1 } else { lanes };
            if near == 0 {
                continue;
            }
            let taken = closer + slack;
            let all = run[0].pair == ALL;
            let count = if all { (group.end - group.start) as usize } else { run.len() };
            for place in 0..count {
                let item = match all {
                    true => Open { pair: group.start + place as u32, ..run[0] },
                    false => run[place],
                };
                let mask = item.lanes & near & if is_shared { 1 } else { lanes };
                if mask == 0 {
                    continue;
                }
                let pair = &scene.pairs[item.pair as usize];
                let sides = [pair.first.0, pair.second.0];
                for solid in sides {
                    place_solid(isa, scene, course, scratch, solid as usize);
                }
                let [a, b] = sides.map(|i| (&scene.solids[i as usize].outer, i as usize));
                let keep = I::F32::constant(isa, pairs.margins[item.pair as usize] + guard);
                let (free, still) =
                    look::<I>(isa, [a.0, b.0], [&scratch.solids[a.1], &scratch.solids[b.1]], taken, keep, mask);
                let open = I::F32::select(still, I::F32::constant(isa, f64::INFINITY), free);
                least = least.min(open);
                let mut mask = mask & still.bits() as u16;
                if mask == 0 {
                    continue;
                }
                if let (Some(hits), Some(inner_a), Some(inner_b)) =
                    (&mut hits, &scene.solids[a.1].inner, &scene.solids[b.1].inner)
                    && pairs.margins[item.pair as usize] + guard >= 0.0
                {
                    let rows = [&scratch.solids[a.1], &scratch.solids[b.1]];
                    let overlap = overlap::<I>(isa, [a.0, b.0], [inner_a, inner_b], rows);
                    let sure = (overlap + slack).lt(I::F32::constant(isa, 0.0)).bits() as u16 & mask;
                    if sure != 0 {
                        let mut overlaps = F32Row::default();
                        if is_shared {
                            overlaps = F32Row::splat(overlap.least());
                        } else {
                            overlap.store(&mut overlaps);
                        }
                        hits.add(item.pair, if is_shared { u16::MAX } else { sure }, &overlaps);
                        lanes &= !hits.settled;
                        mask &= !hits.settled;
                    }
                }
                if mask != 0 {
                    rest.push(Open { lanes: mask, ..item });
                }
            }
        }
        least.least()
    }
}

/// Bounds of one pair: what each lane keeps, and in which lanes that is not enough.
#[inline(always)]
fn look<I: Isa>(
    isa: I,
    outer: [&Outer; 2],
    rows: [&[F32Row; POSE]; 2],
    taken: I::F32,
    keep: I::F32,
    mask: u16,
) -> (I::F32, <I::F32 as Lanes>::Mask) {
    let (rotation_a, rotation_b) = (Rotation::<I::F32>::load(isa, &rows[0][3..]), Rotation::load(isa, &rows[1][3..]));
    let apart = Vector3::<I::F32>::load(isa, &rows[0][..3]).minus(Vector3::load(isa, &rows[1][..3]));
    let radii = I::F32::splat(isa, outer[0].ball + outer[1].ball);
    let mut free = apart.dot(apart).sqrt() - radii - taken;
    if ((!keep.le(free)).bits() as u16 & mask) == 0 {
        return (free, !keep.le(free));
    }
    let boxes = [matches!(outer[0].form, Form::Box(_)), matches!(outer[1].form, Form::Box(_))];
    if boxes[0] {
        let at = rotation_a.turn_back(apart);
        free = free.max(beside_box(isa, outer[0], &rotation_a, outer[1], &rotation_b, at) - taken);
    }
    if boxes[1] && ((!keep.le(free)).bits() as u16 & mask) != 0 {
        let at = rotation_b.turn_back(apart);
        free = free.max(beside_box(isa, outer[1], &rotation_b, outer[0], &rotation_a, at) - taken);
    }
    if (outer[0].is_long || !boxes[0] || outer[1].is_long || !boxes[1]) && ((!keep.le(free)).bits() as u16 & mask) != 0
    {
        let n = between_axes(isa, outer, &rotation_a, &rotation_b, apart);
        let gap =
            n.dot(apart) - reach_along(isa, outer[0], &rotation_a, n) - reach_along(isa, outer[1], &rotation_b, n);
        free = free.max(gap - taken);
    }
    (free, !keep.le(free))
}

/// At least this far apart are a box and what stands at `at` in its frame: the distance of the box to the other's bounding
/// box along its axes.
#[inline(always)]
fn beside_box<I: Isa>(
    isa: I,
    own: &Outer,
    axes: &Rotation<I::F32>,
    other: &Outer,
    others: &Rotation<I::F32>,
    at: Vector3<I::F32>,
) -> I::F32 {
    let Form::Box(half) = own.form else { return I::F32::constant(isa, f64::NEG_INFINITY) };
    let [x, y, z] = axes.columns;
    let zero = I::F32::constant(isa, 0.0);
    let reach = |n: Vector3<I::F32>| form_along(isa, &other.form, others, n);
    let gap_x = at.x.abs() - half[0] - reach(x);
    let gap_y = at.y.abs() - half[1] - reach(y);
    let gap_z = at.z.abs() - half[2] - reach(z);
    let most = gap_x.max(gap_y).max(gap_z);
    let (x, y, z) = (gap_x.max(zero), gap_y.max(zero), gap_z.max(zero));
    let outside = x.mul_add(x, y.mul_add(y, z * z)).sqrt();
    I::F32::select(zero.lt(most), outside, most)
}

/// How far a form reaches along a unit vector, from its centre.
#[inline(always)]
fn form_along<I: Isa>(isa: I, form: &Form, axes: &Rotation<I::F32>, n: Vector3<I::F32>) -> I::F32 {
    match *form {
        Form::Box(h) => {
            let [x, y, z] = axes.columns;
            (n.dot(x).abs() * h[0]) + (n.dot(y).abs() * h[1]) + (n.dot(z).abs() * h[2])
        }
        Form::Capsule { radius, half_length } => n.dot(axes.columns[2]).abs() * half_length + radius,
        Form::Cylinder { radius, half_length } => {
            let along = n.dot(axes.columns[2]);
            let across = along.neg_mul_add(along, I::F32::constant(isa, 1.0)).max(I::F32::constant(isa, 0.0));
            along.abs() * half_length + across.sqrt() * radius
        }
    }
}

/// How far a solid reaches along a unit vector, from its centre: the lesser of what its form and its capsule say.
#[inline(always)]
fn reach_along<I: Isa>(isa: I, outer: &Outer, axes: &Rotation<I::F32>, n: Vector3<I::F32>) -> I::F32 {
    let form = form_along(isa, &outer.form, axes, n);
    if !outer.is_long {
        return form;
    }
    form.min(n.dot(axes.columns[outer.along]).abs() * outer.half_length + outer.radius)
}

/// A unit vector along which the solids' axes are (nearly) farthest apart, from the second to the first.
#[inline(always)]
fn between_axes<I: Isa>(
    isa: I,
    outer: [&Outer; 2],
    a: &Rotation<I::F32>,
    b: &Rotation<I::F32>,
    r: Vector3<I::F32>,
) -> Vector3<I::F32> {
    let (ha, hb) = (outer[0].half_length, outer[1].half_length);
    let u = a.columns[outer[0].along].scaled(I::F32::splat(isa, ha));
    let v = b.columns[outer[1].along].scaled(I::F32::splat(isa, hb));
    let (s, t) = nearest::<I>(isa, [(u, ha), (v, hb)], r);
    let w = v.scaled_from(t, u.scaled_plus(s, r));
    let length = w.dot(w).max(I::F32::splat(isa, 1e-20)).sqrt();
    // A little shorter than one, so that rounding makes no gap.
    w.scaled(I::F32::splat(isa, 1.0 - 4.0 * f32::EPSILON) / length)
}

/// Where the axes ± u and ± v, of half these lengths, are (nearly) closest, as shares of u and v; `r` is from the middle of the second to that of
/// the first.
#[inline(always)]
fn nearest<I: Isa>(isa: I, [(u, ha), (v, hb)]: [(Vector3<I::F32>, f32); 2], r: Vector3<I::F32>) -> (I::F32, I::F32) {
    let (uu, vv) = (I::F32::splat(isa, (ha * ha).max(1e-12)), I::F32::splat(isa, (hb * hb).max(1e-12)));
    let (uv, ur, vr) = (u.dot(v), u.dot(r), v.dot(r));
    let (one, back) = (I::F32::splat(isa, 1.0), I::F32::splat(isa, -1.0));
    let determinant = uv.neg_mul_add(uv, uu * vv).max(uu * vv * 1e-5);
    let s = ((uv * vr - vv * ur) / determinant).max(back).min(one);
    let t = (uv.mul_add(s, vr) / vv).max(back).min(one);
    let s = (uv.mul_sub(t, ur) / uu).max(back).min(one);
    (s, t)
}

/// Minus how far two solids overlap at least; positive where what lies inside of them does not say.
#[inline(always)]
fn overlap<I: Isa>(isa: I, outer: [&Outer; 2], inner: [&Inner; 2], rows: [&[F32Row; POSE]; 2]) -> I::F32 {
    let (a, b) = (Rotation::<I::F32>::load(isa, &rows[0][3..]), Rotation::load(isa, &rows[1][3..]));
    let apart = Vector3::<I::F32>::load(isa, &rows[0][..3]).minus(Vector3::load(isa, &rows[1][..3]));
    let (from_a, from_b) = (off_center::<I>(isa, inner[0], &a), off_center::<I>(isa, inner[1], &b));
    let r = apart.plus(from_a).minus(from_b);
    let (ha, hb) = (inner[0].half_length, inner[1].half_length);
    let u = a.columns[inner[0].along].scaled(I::F32::splat(isa, ha));
    let v = b.columns[inner[1].along].scaled(I::F32::splat(isa, hb));
    let (s, t) = nearest::<I>(isa, [(u, ha), (v, hb)], r);
    // Of the point on either axis: where it is, from the centre of the other's outer bounds.
    let p = u.scaled_plus(s, apart.plus(from_a));
    let q = v.scaled_plus(t, from_b.minus(apart));
    let between = p.minus(v.scaled_plus(t, from_b));
    let radii = I::F32::splat(isa, inner[0].radius + inner[1].radius);
    let mut least = between.dot(between).sqrt() - radii;
    if inner[0].fills {
        let beyond = outside::<I>(isa, &outer[0].form, a.turn_back(q));
        least = least.min(beyond - I::F32::splat(isa, inner[1].radius));
    }
    if inner[1].fills {
        let beyond = outside::<I>(isa, &outer[1].form, b.turn_back(p));
        least = least.min(beyond - I::F32::splat(isa, inner[0].radius));
    }
    least
}

/// From the centre of the outer bounds to that of the inner ones, in the world.
#[inline(always)]
fn off_center<I: Isa>(isa: I, inner: &Inner, axes: &Rotation<I::F32>) -> Vector3<I::F32> {
    let [x, y, z] = inner.middle;
    axes.turn(Vector3::new(I::F32::splat(isa, x), I::F32::splat(isa, y), I::F32::splat(isa, z)))
}

/// How far a point, in its frame, is from a form; 0 inside.
#[inline(always)]
fn outside<I: Isa>(isa: I, form: &Form, p: Vector3<I::F32>) -> I::F32 {
    let zero = I::F32::constant(isa, 0.0);
    match *form {
        Form::Box(half) => {
            let (x, y, z) = (p.x.abs() - half[0], p.y.abs() - half[1], p.z.abs() - half[2]);
            let (x, y, z) = (x.max(zero), y.max(zero), z.max(zero));
            x.mul_add(x, y.mul_add(y, z * z)).sqrt()
        }
        Form::Cylinder { radius, half_length } => {
            let across = (p.x.mul_add(p.x, p.y * p.y).sqrt() - radius).max(zero);
            let along = (p.z.abs() - half_length).max(zero);
            across.mul_add(across, along * along).sqrt()
        }
        Form::Capsule { radius, half_length } => {
            let along = (p.z.abs() - half_length).max(zero);
            let from_axis = p.x.mul_add(p.x, p.y.mul_add(p.y, along * along)).sqrt();
            (from_axis - radius).max(zero)
        }
    }
}

/// Centres of the clusters' balls, and from them how much rounding there is.
#[inline(always)]
fn place_clusters<I: Isa>(
    isa: I,
    scene: &CollisionScene,
    course: &Course,
    scratch: &mut SweepScratch,
    mut most: I::F32,
) {
    for index in 0..scene.clusters.len() {
        let (cluster, rows) = (&scene.clusters[index], &mut scratch.centers[index]);
        if scratch.block == 1 || course.body_moves(cluster.body) {
            let center = Vector3::<I::F32>::splat(isa, cluster.ball.center);
            let center = match cluster.body {
                Some(body) => Transform::load(isa, &course.poses[body.at()]).point(center),
                None => center,
            };
            center.store(rows);
        }
        let center = Vector3::<I::F32>::load(isa, rows);
        let farthest = center.x.abs().max(center.y.abs()).max(center.z.abs());
        most = most.max(farthest + I::F32::constant(isa, cluster.ball.radius));
    }
    (most * SLACK).store(&mut scratch.slack);
}

/// Axes of the joints that move; also the largest coordinate of their origins.
#[inline(always)]
fn place_axes<I: Isa>(isa: I, scene: &CollisionScene, course: &Course, scratch: &mut SweepScratch) -> I::F32 {
    let mut most = I::F32::constant(isa, 0.0);
    for index in 0..scene.joints.len() {
        if !course.joint_moves(index as u32) {
            continue;
        }
        let origin = Vector3::<I::F32>::load(isa, &course.poses[index][9..]);
        most = most.max(origin.x.abs()).max(origin.y.abs()).max(origin.z.abs());
        let axis = match scene.joints[index].motion {
            Motion::Revolute { axis } => axis,
            Motion::Planar => DVec3::Z,
            Motion::Prismatic { .. } | Motion::FreeFlyer => continue,
        };
        let rotation = Rotation::<I::F32>::load(isa, &course.poses[index][..9]);
        rotation.turn(Vector3::splat(isa, axis)).store(&mut scratch.axes[index]);
    }
    most
}

#[inline(always)]
fn place_solid<I: Isa>(isa: I, scene: &CollisionScene, course: &Course, scratch: &mut SweepScratch, index: usize) {
    let solid = &scene.solids[index];
    let fresh = scratch.fresh_solids[index];
    if fresh == scratch.block || (fresh > 0 && !course.body_moves(solid.body)) {
        return;
    }
    scratch.fresh_solids[index] = scratch.block;
    let vector = |v: [f32; 3]| {
        Vector3::<I::F32>::new(I::F32::splat(isa, v[0]), I::F32::splat(isa, v[1]), I::F32::splat(isa, v[2]))
    };
    let own = Transform {
        rotation: Rotation {
            columns: [vector(solid.outer.axes[0]), vector(solid.outer.axes[1]), vector(solid.outer.axes[2])],
        },
        translation: vector(solid.outer.center),
    };
    let placed = match solid.body {
        Some(body) => Transform::load(isa, &course.poses[body.at()]).times(&own),
        None => own,
    };
    let rows = &mut scratch.solids[index];
    placed.translation.store(&mut rows[..3]);
    placed.rotation.store(&mut rows[3..]);
}

/// At most this far do the two clusters of a group come closer within each lane's interval.
#[inline(always)]
fn approach<I: Isa>(
    isa: I,
    scene: &CollisionScene,
    pairs: &PairSet,
    course: &Course,
    scratch: &mut SweepScratch,
    active: &ActiveGroup,
) -> I::F32 {
    if course.is_still() {
        return I::F32::constant(isa, 0.0);
    }
    let group = &scene.groups[active.group as usize];
    for (cluster, count) in [(group.first as usize, active.apart.0), (group.second as usize, active.apart.1)] {
        if count > 0 && scratch.fresh_clusters[cluster] != scratch.block {
            scratch.fresh_clusters[cluster] = scratch.block;
            accumulate(isa, scene, pairs, course, scratch, cluster);
        }
    }
    let moved = &scratch.moved;
    I::F32::load(isa, &moved[active.rows.0 as usize]) + I::F32::load(isa, &moved[active.rows.1 as usize])
}

/// As the velocity bound accumulates, in lanes.
#[inline(always)]
fn accumulate<I: Isa>(
    isa: I,
    scene: &CollisionScene,
    pairs: &PairSet,
    course: &Course,
    scratch: &mut SweepScratch,
    cluster: usize,
) {
    let chain = pairs.tree.chain_of(scene.clusters[cluster].body);
    let base = chain.start as usize + cluster;
    let center = Vector3::<I::F32>::load(isa, &scratch.centers[cluster]);
    let ball = I::F32::constant(isa, scene.clusters[cluster].ball.radius) + I::F32::load(isa, &scratch.slack);
    let mut moved = I::F32::constant(isa, 0.0);
    moved.store(&mut scratch.moved[base]);
    for place in 0..(chain.end - chain.start) as usize {
        let index = chain.start as usize + place;
        let joint = pairs.tree.links[index].joint;
        if course.joint_moves(joint) {
            let joint = joint as usize;
            let origin = Vector3::<I::F32>::load(isa, &course.poses[joint][9..]);
            let out = center.minus(origin);
            let lever = match scene.joints[joint].motion {
                Motion::FreeFlyer | Motion::Prismatic { .. } => out,
                Motion::Revolute { .. } | Motion::Planar => out.cross(Vector3::load(isa, &scratch.axes[joint])),
            };
            let radius = (lever.dot(lever).sqrt() + ball + moved).min(I::F32::splat(isa, course.reach[index]));
            let (turn, slide) = (I::F32::load(isa, &course.turns[joint]), I::F32::load(isa, &course.slides[joint]));
            moved = turn.mul_add(radius, moved) + slide;
        }
        moved.store(&mut scratch.moved[base + place + 1]);
    }
}

/// Whether one direction sets a pair apart in lanes.
pub(super) struct Along<'a> {
    pub scene: &'a CollisionScene,
    pub pairs: &'a PairSet,
    pub course: &'a Course,
    pub scratch: &'a mut SweepScratch,
    pub guard: f64,
    pub open: Open,
    /// A unit vector from the second solid to the first in the world, in lane `found_in`.
    pub n: DVec3,
    pub found_in: usize,
}

impl Kernel for Along<'_> {
    /// The lanes that stay open, and what the others keep.
    type Output = (u16, f32);

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> (u16, f32) {
        let Along { scene, pairs, course, scratch, guard, open, n, found_in } = self;
        let active = pairs.active(open.active);
        let closer = approach(isa, scene, pairs, course, scratch, active);
        let pair = &scene.pairs[open.pair as usize];
        let sides = [pair.first.at(), pair.second.at()];
        for solid in sides {
            place_solid(isa, scene, course, scratch, solid);
        }
        // The direction stays with the bodies' nearest common ancestor.
        let n = match pairs.ancestor(scene, active) {
            Some(body) if course.body_moves(Some(body)) => {
                let rows = &course.poses[body.at()];
                let v = |i: usize| {
                    DVec3::new(rows[i][found_in].into(), rows[i + 1][found_in].into(), rows[i + 2][found_in].into())
                };
                let own = DVec3::new(v(0).dot(n), v(3).dot(n), v(6).dot(n));
                Rotation::<I::F32>::load(isa, &rows[..9]).turn(Vector3::splat(isa, own))
            }
            _ => Vector3::splat(isa, n),
        };
        // A little shorter than one, so that rounding makes no gap.
        let n = n.scaled(I::F32::splat(isa, 1.0 - 8.0 * f32::EPSILON));
        let [a, b] = sides.map(|i| &scratch.solids[i]);
        let (at_a, at_b) = (Vector3::<I::F32>::load(isa, &a[..3]), Vector3::load(isa, &b[..3]));
        let (axes_a, axes_b) = (Rotation::load(isa, &a[3..]), Rotation::load(isa, &b[3..]));
        let [outer_a, outer_b] = sides.map(|i| &scene.solids[i].outer);
        let gap = n.dot(at_a.minus(at_b))
            - support::<I>(isa, outer_a, &axes_a, n.negated())
            - support::<I>(isa, outer_b, &axes_b, n);
        let free = gap - closer - I::F32::load(isa, &scratch.slack);
        let near = !I::F32::constant(isa, pairs.margins[open.pair as usize] + guard).le(free);
        let mask = <I::F32 as Lanes>::Mask::from_bits(isa, u32::from(open.lanes));
        let kept = I::F32::select(near | !mask, I::F32::constant(isa, f64::INFINITY), free);
        (near.bits() as u16 & open.lanes, kept.least())
    }
}

/// How far a solid, or its hull, reaches along a direction from its centre.
#[inline(always)]
fn support<I: Isa>(isa: I, outer: &Outer, axes: &Rotation<I::F32>, n: Vector3<I::F32>) -> I::F32 {
    if outer.hull.is_empty() {
        return form_along(isa, &outer.form, axes, n);
    }
    let d = axes.turn_back(n);
    let mut most = I::F32::constant(isa, f64::NEG_INFINITY);
    for p in &outer.hull {
        most = most.max(d.x * p[0] + (d.y * p[1] + d.z * p[2]));
    }
    most + outer.hull_slack
}

/// All lanes of a block that has this many intervals.
pub(super) fn all_lanes(intervals: usize) -> u16 {
    u16::MAX >> (LANES - intervals.min(LANES))
}
