//! Whether a point is inside a closed mesh.

use crate::collision::solids::boxes::{Bounds, WIDE};
use crate::collision::solids::mesh_tree::MeshTree;
use glam::DVec3;

/// Eight to a block, so trees over 2³² triangles are at most 12 deep, and a step leaves at most seven blocks behind.
const STACK: usize = 12 * WIDE;

impl MeshTree {
    /// Whether a point, in the mesh's frame, is inside the solid; false for meshes that are not closed.
    ///
    /// Rays in several directions count crossings. Inside is where their number is odd, or where they do not balance
    /// (solids that overlap each other). A ray that meets an edge is no witness; without any clean ray, or where two
    /// disagree, the answer is true: in doubt, in collision.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        let Some(around) = self.bounds().filter(|_| self.closed) else { return false };
        if !point.is_finite() {
            return true;
        }
        if (point - around.center).abs().cmpgt(around.half).any() {
            return false;
        }
        let mut clean = self.clean_crossings(point);
        match (clean.next(), clean.next()) {
            (Some(first), Some(second)) => first.tell_inside() || second.tell_inside(),
            _ => true,
        }
    }

    /// Whether a point, in the mesh's frame, is inside the solid beyond doubt: three rays are clean and cross the surface an odd
    /// number of times each.
    pub(crate) fn surely_contains(&self, point: DVec3) -> bool {
        if !self.closed || !point.is_finite() || self.is_empty() {
            return false;
        }
        let mut clean = self.clean_crossings(point);
        (0..3).all(|_| clean.next().is_some_and(|crossings| crossings.count % 2 == 1))
    }

    fn clean_crossings(&self, point: DVec3) -> impl Iterator<Item = Crossings> + '_ {
        RAYS.iter().filter_map(move |&ray| self.crossings(point, DVec3::from_array(ray)))
    }

    /// Where a ray crosses the surface; none where it passes too close to an edge to be sure.
    fn crossings(&self, from: DVec3, direction: DVec3) -> Option<Crossings> {
        let inverse = direction.recip();
        let mut crossings = Crossings { count: 0, balance: 0 };
        let mut stack = [0_u32; STACK];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let block = &self.blocks[stack[depth] as usize];
            for lane in 0..block.count as usize {
                if !ray_meets_box(from, inverse, &block.bounds_of(lane)) {
                    continue;
                }
                let index = block.first + lane as u32;
                if block.corners.is_some() {
                    let side = ray_meets_triangle(from, direction, &self.triangles[index as usize])?;
                    crossings.count += side.unsigned_abs();
                    crossings.balance += side;
                } else {
                    stack[depth] = index;
                    depth += 1;
                }
            }
        }
        Some(crossings)
    }
}

/// How often a ray crosses a surface, and how much more often it leaves than enters.
#[derive(Clone, Copy, Debug)]
struct Crossings {
    count: u32,
    balance: i32,
}

impl Crossings {
    fn tell_inside(self) -> bool {
        self.count % 2 == 1 || self.balance != 0
    }
}

/// Directions that no sane model is aligned with.
const RAYS: [[f64; 3]; 6] = [
    [0.683_012, 0.549_021, 0.481_713],
    [-0.391_207, 0.727_113, -0.564_109],
    [0.311_903, -0.412_021, 0.856_107],
    [-0.771_309, -0.273_107, 0.575_021],
    [0.129_017, 0.913_019, -0.387_011],
    [-0.547_031, -0.631_013, -0.550_127],
];

/// Slab test, widened by rounding; NaN (a coordinate of 0/0) counts as a hit.
fn ray_meets_box(from: DVec3, inverse: DVec3, bounds: &Bounds) -> bool {
    let near = (bounds.center - bounds.half - from) * inverse;
    let far = (bounds.center + bounds.half - from) * inverse;
    let (enter, leave) = (near.min(far).max_element(), near.max(far).min_element());
    let slack = 1e-9 * (1.0 + enter.abs());
    !(enter > leave + slack || leave < -slack)
}

/// 1 where the ray leaves through the triangle's front, −1 where it enters, 0 where it misses; none in doubt.
fn ray_meets_triangle(from: DVec3, direction: DVec3, &[a, b, c]: &[DVec3; 3]) -> Option<i32> {
    let (a, b, c) = (a - from, b - from, c - from);
    // Volumes of ray and edges (Plücker): all of one sign where the line passes inside.
    let volumes = [direction.dot(b.cross(a)), direction.dot(c.cross(b)), direction.dot(a.cross(c))];
    let normal = (b - a).cross(c - a);
    let area = normal.length();
    if area == 0.0 {
        return Some(0); // degenerate: its neighbours close the surface without it
    }
    let edge = (b - a).length().max((c - b).length()).max((a - c).length());
    let reach = a.length().max(b.length()).max(c.length());
    let doubt = 1e-12 * edge * reach;
    let (low, high) = (volumes[0].min(volumes[1]).min(volumes[2]), volumes[0].max(volumes[1]).max(volumes[2]));
    if low < -doubt && high > doubt {
        return Some(0);
    }
    let (height, slope) = (normal.dot(a), normal.dot(direction));
    // In front of the whole triangle, or behind it, edges do not matter.
    let along = a.dot(direction).max(b.dot(direction)).max(c.dot(direction));
    if along < -1e-12 * reach {
        return Some(0);
    }
    if low.abs() <= doubt || high.abs() <= doubt || slope.abs() <= 1e-9 * area || height.abs() <= 1e-12 * area {
        return None;
    }
    let distance = height / slope;
    Some(if distance < 0.0 {
        0
    } else if slope > 0.0 {
        1
    } else {
        -1
    })
}
