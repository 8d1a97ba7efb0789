//! Eight boxes of a mesh at once: how far they are at least from a box of another mesh, or from a convex core.
//!
//! Products and sums are not fused, so that the answers are equal bit for bit at every level of lanes.

use crate::collision::convex::core::{Convex, Core};
use crate::collision::convex::gjk::Relative;
use crate::collision::solids::boxes::Bounds;
use crate::collision::solids::mesh_tree::Block;
use crate::lanes::{F64Row, Isa, Lanes, Mask, Vector3};
use glam::{DMat3, DVec3};

/// Boxes of a block that may be nearer than something, a bit for each, and at most their squared distances.
pub(crate) struct Near {
    pub lanes: u32,
    pub squared: F64Row,
}

/// Whether something at this squared distance is at least `least` away; false in doubt.
#[inline]
pub(crate) fn beyond(squared: f64, least: f64) -> bool {
    least > 0.0 && squared >= least * least
}

/// Of squared distances and gaps along one direction.
#[inline(always)]
fn nearer<I: Isa>(isa: I, block: &Block, squared: I::F64, gap: I::F64, least: f64) -> Near {
    // Compared so that NaN is near.
    let mut lanes = block.lanes() & !I::F64::constant(isa, least).le(gap).bits();
    if least > 0.0 {
        lanes &= !I::F64::constant(isa, least * least).le(squared).bits();
    }
    let mut row = F64Row::default();
    squared.store(&mut row);
    Near { lanes, squared: row }
}

/// How a box along the axes of one frame sees those of a mesh, in another frame.
#[derive(Clone, Debug)]
pub(crate) struct View {
    /// Pose of the mesh in the box's frame.
    X: Relative,
    /// The rotation without signs.
    turned: DMat3,
    /// A direction from the mesh to the box, in the box's frame; zero for none, which leaves no gap.
    n: DVec3,
    /// It without signs, in the box's and in the mesh's frame.
    widths: [DVec3; 2],
    /// It in the mesh's frame, and how far the mesh's origin lies along it.
    n_mesh: DVec3,
    offset: f64,
}

impl View {
    pub(crate) fn new(X: &Relative) -> Self {
        let none = DVec3::ZERO;
        Self { X: *X, turned: X.rotation.abs(), n: none, widths: [none; 2], n_mesh: none, offset: 0.0 }
    }

    pub(crate) fn turn_to(&mut self, n: DVec3) {
        if n != self.n {
            self.n = n;
            self.n_mesh = self.X.direction_back(n);
            self.widths = [n.abs(), self.n_mesh.abs()];
            self.offset = n.dot(self.X.translation);
        }
    }

    /// The gap between two boxes along the direction: far cheaper than all axes, and once a direction has set triangles
    /// apart it sets most of the boxes around them apart.
    #[inline]
    pub(crate) fn gap(&self, single: &Bounds, of_mesh: &Bounds) -> f64 {
        let apart = self.n.dot(single.center) - self.n_mesh.dot(of_mesh.center) - self.offset;
        apart - self.widths[0].dot(single.half) - self.widths[1].dot(of_mesh.half)
    }

    /// Squared distances are the larger of the gaps along the axes of either.
    #[inline(always)]
    pub(crate) fn near<I: Isa>(&self, isa: I, single: &Bounds, block: &Block, least: f64) -> Near {
        let zero = I::F64::constant(isa, 0.0);
        let center = Vector3::<I::F64>::load(isa, &block.centers);
        let half = Vector3::<I::F64>::load(isa, &block.halves);
        let apart =
            combined(isa, &self.X.rotation, center).plus(Vector3::splat(isa, self.X.translation - single.center));
        let beyond_single = past(apart, combined(isa, &self.turned, half).plus(Vector3::splat(isa, single.half)), zero);
        let back = combined(isa, &self.X.rotation.transpose(), apart);
        let reach = half.plus(Vector3::splat(isa, self.turned.transpose() * single.half));
        let beyond_mesh = past(back, reach, zero);
        let squared = dot(beyond_single, beyond_single).max(dot(beyond_mesh, beyond_mesh));
        let reach = dot(half, Vector3::splat(isa, self.widths[1]));
        let gap =
            -dot(apart, Vector3::splat(isa, self.n)) - reach - I::F64::constant(isa, self.widths[0].dot(single.half));
        nearer(isa, block, squared, gap, least)
    }
}

/// A convex core as the boxes of a mesh see it: its bounding box along the mesh's axes and along its own, and its
/// bounding ball.
pub(crate) struct Probe<'a> {
    core: &'a Core,
    X_MC: &'a Relative,
    turned: DMat3,
    center: DVec3,
    half: DVec3,
    own_center: DVec3,
    own_half: DVec3,
    radius: f64,
    /// From the core to the mesh, in the mesh's frame; zero for none.
    n: DVec3,
    /// Where the core ends along it.
    end: f64,
}

impl<'a> Probe<'a> {
    pub(crate) fn new(convex: &'a Convex, X_MC: &'a Relative) -> Self {
        let core = &convex.core;
        let middle = core.center();
        Self {
            core,
            X_MC,
            turned: X_MC.rotation.abs().transpose(),
            center: X_MC.point(middle),
            half: core.extents_along(&X_MC.rotation),
            own_center: middle,
            own_half: core.extents_along(&DMat3::IDENTITY),
            radius: core.farthest_from(middle).distance(middle),
            n: DVec3::ZERO,
            end: 0.0,
        }
    }

    pub(crate) fn turn_to(&mut self, n: DVec3) {
        if n != self.n {
            self.n = n;
            self.end = n.dot(self.X_MC.point(self.core.support(self.X_MC.direction_back(n))));
        }
    }

    /// As [`View::gap`].
    #[inline]
    pub(crate) fn gap(&self, of_mesh: &Bounds) -> f64 {
        self.n.dot(of_mesh.center) - self.n.abs().dot(of_mesh.half) - self.end
    }

    /// Squared distances are the largest that the boxes and the ball allow.
    #[inline(always)]
    pub(crate) fn near<I: Isa>(&self, isa: I, block: &Block, least: f64) -> Near {
        let zero = I::F64::constant(isa, 0.0);
        let center = Vector3::<I::F64>::load(isa, &block.centers);
        let half = Vector3::<I::F64>::load(isa, &block.halves);
        let apart = center.minus(Vector3::splat(isa, self.center));
        let along_mesh = past(apart, half.plus(Vector3::splat(isa, self.half)), zero);
        let to_ball = past(apart, half, zero);
        let ball = (dot(to_ball, to_ball).sqrt() - I::F64::constant(isa, self.radius)).max(zero);
        let here = center.minus(Vector3::splat(isa, self.X_MC.translation));
        let here = combined(isa, &self.X_MC.rotation.transpose(), here).minus(Vector3::splat(isa, self.own_center));
        let reach = combined(isa, &self.turned, half).plus(Vector3::splat(isa, self.own_half));
        let along_own = past(here, reach, zero);
        let squared = dot(along_mesh, along_mesh).max(dot(along_own, along_own)).max(ball * ball);
        let n = Vector3::splat(isa, self.n);
        let gap = dot(center, n) - dot(half, Vector3::splat(isa, self.n.abs())) - I::F64::constant(isa, self.end);
        nearer(isa, block, squared, gap, least)
    }
}

/// Scalar product, not fused.
#[inline(always)]
pub(crate) fn dot<V: Lanes>(a: Vector3<V>, b: Vector3<V>) -> V {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// A matrix times a vector, not fused.
#[inline(always)]
pub(crate) fn combined<I: Isa>(isa: I, m: &DMat3, v: Vector3<I::F64>) -> Vector3<I::F64> {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    let (x, y, z) = (Vector3::splat(isa, x), Vector3::splat(isa, y), Vector3::splat(isa, z));
    x.scaled(v.x).plus(y.scaled(v.y)).plus(z.scaled(v.z))
}

/// How far centres that are `apart` are beyond the `reach` of their boxes.
#[inline(always)]
fn past<V: Lanes>(apart: Vector3<V>, reach: Vector3<V>, zero: V) -> Vector3<V> {
    let of = Vector3::new(apart.x.abs(), apart.y.abs(), apart.z.abs()).minus(reach);
    Vector3::new(of.x.max(zero), of.y.max(zero), of.z.max(zero))
}
