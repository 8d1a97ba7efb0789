//! Axis-aligned boxes and triangles of a mesh, and their layout in lanes.
//!
//! `Bounds` is a box, `Extent` accumulates one over triangles and marks coordinates that are not finite. `in_lanes` puts eight
//! triangles side by side. The types are apart because building, records, tree and distance queries all use them.

use crate::lanes::vector::{F64Row, Row};
use foliate_components::robot::shape::Mesh;
use glam::DVec3;

/// Boxes in a block, and triangles in one of the last.
pub(crate) const WIDE: usize = 8;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub center: DVec3,
    pub half: DVec3,
}

/// The least and largest coordinates of some triangles, and whether all of these are finite.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    low: DVec3,
    high: DVec3,
    whole: bool,
}

/// Coordinates of the three corners of eight triangles; lanes that are not used repeat the first.
pub(crate) type Corners = [[F64Row; 3]; 3];

pub(crate) fn in_rows(of: impl Fn(usize) -> DVec3) -> [F64Row; 3] {
    let points: [DVec3; WIDE] = std::array::from_fn(of);
    [Row(points.map(|p| p.x)), Row(points.map(|p| p.y)), Row(points.map(|p| p.z))]
}

/// One coordinate that is not finite spoils the triangle: minima and maxima over its corners are then no numbers either.
fn whole_or_nothing(triangle: [DVec3; 3]) -> [DVec3; 3] {
    if triangle.iter().all(|p| p.is_finite()) { triangle } else { [DVec3::NAN; 3] }
}

/// The triangles of a mesh by number; with corners that are no numbers where a vertex is not there.
pub(crate) fn corners_of(mesh: &Mesh) -> impl Fn(usize) -> [DVec3; 3] + '_ {
    let corner = |i: u32| mesh.vertices.get(i as usize).copied().unwrap_or(DVec3::NAN);
    move |t| whole_or_nothing(mesh.triangles.get(t).map_or([DVec3::NAN; 3], |t| t.map(corner)))
}

impl Extent {
    /// Of nothing.
    pub(crate) const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, whole: true };

    pub(crate) fn of(triangle: &[DVec3; 3]) -> Self {
        let [a, b, c] = *triangle;
        Self { low: a.min(b).min(c), high: a.max(b).max(c), whole: a.is_finite() && b.is_finite() && c.is_finite() }
    }

    /// Of both.
    pub(crate) fn and(self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high), whole: self.whole && other.whole }
    }

    /// Of them together.
    pub(crate) fn of_all(extents: impl Iterator<Item = Self>) -> Self {
        extents.fold(Self::EMPTY, |all, one| all.and(&one))
    }

    pub(crate) fn bounds(&self) -> Bounds {
        if !self.whole {
            // A box that nothing is far from.
            return Bounds { center: DVec3::ZERO, half: DVec3::INFINITY };
        }
        Bounds { center: (self.low + self.high) * 0.5, half: (self.high - self.low) * (0.5 * (1.0 + 1e-15)) }
    }
}

/// Up to eight triangles in lanes.
pub(crate) fn in_lanes(triangles: &[[DVec3; 3]]) -> Corners {
    let corner = |c: usize| in_rows(|lane| triangles.get(lane).unwrap_or(&triangles[0])[c]);
    [corner(0), corner(1), corner(2)]
}
