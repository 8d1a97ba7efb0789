//! Distance of a mesh to a convex solid or to another mesh: descent over the trees, the nearest boxes first, with
//! everything cut off that is farther than what is asked for or already found.

use crate::collision::convex::core::{Convex, Core};
use crate::collision::convex::gjk::{DistanceQuery, ROUNDING, Relative, core_distance};
use crate::collision::distance::boxes_in_lanes::{Probe, View, beyond};
use crate::collision::distance::triangles_in_lanes::{
    Extents, Gaps, beside, crossing, load, load_moved, reaching, to_segment, to_triangle,
};
use crate::collision::solids::boxes::WIDE;
use crate::collision::solids::mesh_tree::{Block, MeshTree};
use crate::lanes::{Isa, Kernel};
use glam::{DMat3, DVec3};

/// Blocks are cut three times in two: trees over 2³² triangles are at most 12 deep.
const DEEP: usize = 12;
/// A step leaves at most seven blocks behind.
const STACK: usize = DEEP * (WIDE - 1) + 1;

/// Surface distance of a mesh and a convex solid whose pose in the mesh's frame is `X_MC`: a lower bound that is at least
/// `query.needed` or nearly exact. `hint` is a direction, from the convex solid to the mesh in the mesh's frame, that set
/// triangles apart before (zero for none): neighbouring triangles share it more often than not, and it costs a fraction
/// of finding another.
pub(crate) fn mesh_convex_distance(
    mesh: &MeshTree,
    convex: &Convex,
    X_MC: &Relative,
    query: DistanceQuery,
    hint: &mut DVec3,
) -> f64 {
    if mesh.is_empty() {
        return f64::INFINITY;
    }
    mesh.lanes.run(ToConvex { mesh, convex, X_MC, query, hint })
}

/// Surface distance of two meshes, the second at `X_AB` in the frame of the first. `hint` is as for
/// [`mesh_convex_distance`], from the second to the first in the frame of the first.
pub(crate) fn mesh_mesh_distance(
    a: &MeshTree,
    b: &MeshTree,
    X_AB: &Relative,
    query: DistanceQuery,
    hint: &mut DVec3,
) -> f64 {
    if a.is_empty() || b.is_empty() {
        return f64::INFINITY;
    }
    a.lanes.run(ToMesh { a, b, X_AB, query, hint })
}

struct ToConvex<'a> {
    mesh: &'a MeshTree,
    convex: &'a Convex,
    X_MC: &'a Relative,
    query: DistanceQuery,
    hint: &'a mut DVec3,
}

impl Kernel for ToConvex<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> f64 {
        let Self { mesh, convex, X_MC, query, hint } = self;
        let mut probe = Probe::new(convex, X_MC);
        let axis = Axis::of(&convex.core, X_MC);
        let mut least = Least::new(&query);
        probe.turn_to(*hint);
        let mut stack = [(0_u32, 0.0_f64); STACK];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (index, near) = stack[depth];
            let block = &mesh.blocks[index as usize];
            let reach = least.value + convex.radius;
            if beyond(near, reach) || probe.gap(&block.bounds) >= reach {
                continue;
            }
            let near = probe.near(isa, block, reach);
            if let Some(corners) = block.corners {
                let mut lanes = near.lanes;
                if lanes == 0 {
                    continue;
                }
                if let Some(axis) = &axis {
                    let eight = load(isa, &mesh.corners[corners as usize]);
                    let gaps = to_segment(isa, &eight, axis.middle, axis.half);
                    lanes &= axis.left_open(&gaps, lanes, convex.radius, &query, &mut least, hint);
                }
                while lanes != 0 {
                    let triangle = mesh.triangles[block.first as usize + lanes.trailing_zeros() as usize];
                    lanes &= lanes - 1;
                    let query = least.query(&query);
                    let core = Core::Triangle(triangle);
                    least.lower(core_distance(&core, &convex.core, X_MC, convex.radius, query, hint));
                }
                if least.value <= 0.0 {
                    return least.value;
                }
                probe.turn_to(*hint);
                continue;
            }
            let (mut lanes, from) = (near.lanes, depth);
            while lanes != 0 {
                let lane = lanes.trailing_zeros();
                lanes &= lanes - 1;
                push_in_order(&mut stack, from, &mut depth, (block.first + lane, near.squared[lane as usize]));
            }
        }
        least.value - ROUNDING
    }
}

/// The axis of a round core, in the mesh's frame, and how far the core lies around it.
struct Axis {
    middle: DVec3,
    half: DVec3,
    radius: f64,
}

impl Axis {
    fn of(core: &Core, X_MC: &Relative) -> Option<Self> {
        let (half_length, radius) = match *core {
            Core::Point => (0.0, 0.0),
            Core::Segment { half_length } => (half_length, 0.0),
            Core::Cylinder { radius, half_length } => (half_length, radius),
            Core::Box { .. } | Core::Triangle(_) => return None,
        };
        Some(Self { middle: X_MC.translation, half: X_MC.rotation.z_axis * half_length, radius })
    }

    /// The triangles for which GJK is to be asked; of the others it takes in what the gaps to the axis say.
    #[inline]
    fn left_open(
        &self,
        gaps: &Gaps,
        lanes: u32,
        radius: f64,
        query: &DistanceQuery,
        least: &mut Least,
        hint: &mut DVec3,
    ) -> u32 {
        let mut open = 0;
        for lane in (0..WIDE).filter(|lane| lanes >> lane & 1 == 1) {
            let [lower, upper] = [gaps.lower[lane], gaps.upper[lane]].map(|gap| gap - self.radius - radius);
            if lower >= least.value {
                continue;
            }
            // What is around a cylinder's axis reaches beyond its ends.
            if self.radius == 0.0 && gaps.lower[lane] > 0.0 && least.query(query).is_settled(lower, upper) {
                least.lower(lower);
            } else {
                open |= 1 << lane;
            }
        }
        let tightest = gaps.tightest(lanes);
        if gaps.lower[tightest] > 0.0 {
            *hint = -gaps.direction(tightest);
        }
        open
    }
}

struct ToMesh<'a> {
    a: &'a MeshTree,
    b: &'a MeshTree,
    X_AB: &'a Relative,
    query: DistanceQuery,
    hint: &'a mut DVec3,
}

impl Kernel for ToMesh<'_> {
    type Output = f64;

    // Long: one descent of two trees at once; its cases share the stack and the least distance.
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> f64 {
        let Self { a, b, X_AB, query, hint } = self;
        let X_BA = X_AB.inverse();
        let mut least = Least::new(&query);
        let mut views = Views { of_b: View::new(X_AB), of_a: View::new(&X_BA) };
        views.turn_to(*hint, X_AB);
        let mut stack = [(0_u32, 0_u32, 0.0_f64); 2 * STACK];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (i, j, near) = stack[depth];
            let (block_a, block_b) = (&a.blocks[i as usize], &b.blocks[j as usize]);
            if beyond(near, least.value) || views.of_b.gap(&block_a.bounds, &block_b.bounds) >= least.value {
                continue;
            }
            if block_a.corners.is_some()
                && let Some(corners) = block_b.corners
            {
                let near = views.of_a.near(isa, &block_b.bounds, block_a, least.value);
                let mut lanes = near.lanes;
                if lanes == 0 {
                    continue;
                }
                let eight = load_moved(isa, &b.corners[corners as usize], X_AB);
                let extents = Extents::of(&eight);
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    let near = block_b.lanes() & beside(isa, &extents, &block_a.bounds_of(lane), least.value);
                    let triangle = &a.triangles[block_a.first as usize + lane];
                    // Of a triangle without numbers no number.
                    let start = hint.dot(triangle[0]).min(hint.dot(triangle[1])).min(hint.dot(triangle[2]));
                    let mut meeting = near & reaching(isa, &eight, *hint, start, least.value);
                    if meeting != 0 {
                        meeting &= crossing(isa, &eight, triangle, least.value);
                    }
                    if meeting != 0 {
                        let gaps = to_triangle(isa, &eight, triangle);
                        take_in(&gaps, meeting, (triangle, b, block_b, X_AB), &query, &mut least, hint);
                    }
                }
                if least.value <= 0.0 {
                    return least.value;
                }
                views.turn_to(*hint, X_AB);
                continue;
            }
            let (half_a, half_b) = (block_a.bounds.half.length_squared(), block_b.bounds.half.length_squared());
            // Open the larger one.
            let open_a = block_a.corners.is_none() && (block_b.corners.is_some() || half_a >= half_b);
            let (view, single, wide) =
                if open_a { (&views.of_a, block_b, block_a) } else { (&views.of_b, block_a, block_b) };
            let near = view.near(isa, &single.bounds, wide, least.value);
            let (mut lanes, from) = (near.lanes, depth);
            while lanes != 0 {
                let lane = lanes.trailing_zeros();
                lanes &= lanes - 1;
                let (child, near) = (wide.first + lane, near.squared[lane as usize]);
                let pair = if open_a { (child, j, near) } else { (i, child, near) };
                push_in_order(&mut stack, from, &mut depth, pair);
            }
        }
        least.value - ROUNDING
    }
}

/// How boxes of either mesh see those of the other.
struct Views {
    of_b: View,
    of_a: View,
}

impl Views {
    /// `n` points from the second to the first, in the frame of the first.
    fn turn_to(&mut self, n: DVec3, X_AB: &Relative) {
        self.of_b.turn_to(n);
        self.of_a.turn_to(-X_AB.direction_back(n));
    }
}

/// What the gaps between a triangle and some of eight say; where they do not settle it GJK is asked.
#[inline]
fn take_in(
    gaps: &Gaps,
    mut lanes: u32,
    (triangle, b, block_b, X_AB): (&[DVec3; 3], &MeshTree, &Block, &Relative),
    query: &DistanceQuery,
    least: &mut Least,
    hint: &mut DVec3,
) {
    let tightest = gaps.tightest(lanes);
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize;
        lanes &= lanes - 1;
        let (lower, upper) = (gaps.lower[lane], gaps.upper[lane]);
        if lower >= least.value {
            continue;
        }
        let wanted = least.query(query);
        if lower > 0.0 && wanted.is_settled(lower, upper) {
            least.lower(lower);
            continue;
        }
        let here = Relative { rotation: DMat3::IDENTITY, translation: DVec3::ZERO };
        let other = b.triangles[block_b.first as usize + lane].map(|p| X_AB.point(p));
        let found = core_distance(&Core::Triangle(*triangle), &Core::Triangle(other), &here, 0.0, wanted, hint);
        least.lower(found);
    }
    if gaps.lower[tightest] > 0.0 {
        *hint = gaps.direction(tightest);
    }
}

/// Pushes an entry so that those from `from` on lie with the nearest last.
#[inline]
fn push_in_order<T: Copy + Entry>(stack: &mut [T], from: usize, depth: &mut usize, entry: T) {
    let mut at = *depth;
    while at > from && stack[at - 1].near() < entry.near() {
        stack[at] = stack[at - 1];
        at -= 1;
    }
    stack[at] = entry;
    *depth += 1;
}

/// What is still to be visited.
trait Entry {
    /// At most its squared distance.
    fn near(&self) -> f64;
}

impl Entry for (u32, f64) {
    fn near(&self) -> f64 {
        self.1
    }
}

impl Entry for (u32, u32, f64) {
    fn near(&self) -> f64 {
        self.2
    }
}

/// The least distance that still matters: nothing farther need be visited.
struct Least {
    value: f64,
    floor: f64,
    ground: f64,
}

impl Least {
    fn new(query: &DistanceQuery) -> Self {
        let raised = |x: f64| x + 2.0 * ROUNDING;
        Self { value: raised(query.needed), floor: raised(query.floor), ground: raised(query.ground) }
    }

    /// What to ask of the next pair of triangles.
    fn query(&self, query: &DistanceQuery) -> DistanceQuery {
        let floor = self.floor.min(self.value);
        DistanceQuery { needed: self.value, floor, ground: self.ground.min(floor), ..*query }
    }

    /// Takes in a distance. Once one is too small for what is needed, only what is below the floor still matters, and once
    /// one is below that, what is below the ground.
    fn lower(&mut self, found: f64) {
        if found >= self.value {
            return;
        }
        // NaN is smaller than everything.
        self.value = match found {
            _ if found >= self.floor => self.floor.min(self.value),
            _ if found >= self.ground => self.ground.min(self.value),
            _ if found.is_nan() => f64::NEG_INFINITY,
            _ => found,
        };
    }
}
