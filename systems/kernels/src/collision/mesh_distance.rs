//! Distance of a mesh to a convex solid or to another mesh: descent over the trees, the nearer child first, with
//! everything cut off that is farther than what is asked for or already found.

use super::convex::{Convex, Core};
use super::gjk::{Ask, ROUNDING, Relative, core_distance};
use super::mesh_tree::{MeshTree, Node};
use glam::{DMat3, DVec3};

/// Median splits halve: trees over 2³² triangles are 32 deep, and a step leaves at most one node behind per level.
const STACK: usize = 80;

/// Surface distance of a mesh and a convex solid whose pose in the mesh's frame is `X_MC`: a lower bound that is at least
/// `ask.needed` or nearly exact. `hint` is a direction, from the convex solid to the mesh in the mesh's frame, that set
/// triangles apart before (zero for none): neighbouring triangles share it more often than not, and it costs a fraction
/// of finding another.
pub(super) fn mesh_convex_distance(
    mesh: &MeshTree,
    convex: &Convex,
    X_MC: &Relative,
    ask: Ask,
    hint: &mut DVec3,
) -> f64 {
    if mesh.is_empty() {
        return f64::INFINITY;
    }
    let probe = Probe::new(convex, X_MC);
    let mut least = Least::new(&ask);
    let mut slab = Slab::default();
    slab.turn_to(*hint, |n| convex.core.support(X_MC.direction_back(n)), X_MC);
    let mut stack = [(0_u32, 0.0_f64); STACK];
    let mut depth = 1;
    stack[0] = (0, probe.distance_squared(&mesh.nodes[0]));
    while depth > 0 {
        depth -= 1;
        let (index, near) = stack[depth];
        let node = &mesh.nodes[index as usize];
        if beyond(near, least.value + convex.radius) || slab.gap(node) >= least.value + convex.radius {
            continue;
        }
        if node.is_leaf() {
            for triangle in leaf(mesh, node) {
                let core = Core::Triangle(*triangle);
                let ask = least.ask(&ask);
                least.lower(core_distance(&core, &convex.core, X_MC, convex.radius, ask, hint));
                if least.value <= 0.0 {
                    return least.value;
                }
            }
            slab.turn_to(*hint, |n| convex.core.support(X_MC.direction_back(n)), X_MC);
            continue;
        }
        let [first, second] = [index + 1, node.next];
        let first = (first, probe.distance_squared(&mesh.nodes[first as usize]));
        let second = (second, probe.distance_squared(&mesh.nodes[second as usize]));
        let (nearer, farther) = if second.1 < first.1 { (second, first) } else { (first, second) };
        for child in [farther, nearer] {
            if !beyond(child.1, least.value + convex.radius) {
                stack[depth] = child;
                depth += 1;
            }
        }
    }
    least.value - ROUNDING
}

/// Surface distance of two meshes, the second at `X_AB` in the frame of the first. `hint` is as for
/// [`mesh_convex_distance`], from the second to the first in the frame of the first.
pub(super) fn mesh_mesh_distance(a: &MeshTree, b: &MeshTree, X_AB: &Relative, ask: Ask, hint: &mut DVec3) -> f64 {
    if a.is_empty() || b.is_empty() {
        return f64::INFINITY;
    }
    let turned = X_AB.rotation.abs();
    let turned = [turned, turned.transpose()];
    let bound = |i: u32, j: u32| box_distance_squared(&a.nodes[i as usize], &b.nodes[j as usize], X_AB, &turned);
    let mut least = Least::new(&ask);
    let mut slabs = Slabs::default();
    slabs.turn_to(*hint, X_AB);
    let mut stack = [(0_u32, 0_u32, 0.0_f64); 2 * STACK];
    let mut depth = 1;
    stack[0] = (0, 0, bound(0, 0));
    while depth > 0 {
        depth -= 1;
        let (i, j, near) = stack[depth];
        let (node_a, node_b) = (&a.nodes[i as usize], &b.nodes[j as usize]);
        if beyond(near, least.value) || slabs.gap(node_a, node_b) >= least.value {
            continue;
        }
        if node_a.is_leaf() && node_b.is_leaf() {
            meet_leaves(leaf(a, node_a), leaf(b, node_b), X_AB, &ask, &mut least, hint);
            if least.value <= 0.0 {
                return least.value;
            }
            slabs.turn_to(*hint, X_AB);
            continue;
        }
        // Open the larger one.
        let open_a =
            !node_a.is_leaf() && (node_b.is_leaf() || node_a.half.length_squared() >= node_b.half.length_squared());
        let [first, second] = if open_a { [(i + 1, j), (node_a.next, j)] } else { [(i, j + 1), (i, node_b.next)] };
        let first = (first.0, first.1, bound(first.0, first.1));
        let second = (second.0, second.1, bound(second.0, second.1));
        let (nearer, farther) = if second.2 < first.2 { (second, first) } else { (first, second) };
        for child in [farther, nearer] {
            if !beyond(child.2, least.value) {
                stack[depth] = child;
                depth += 1;
            }
        }
    }
    least.value - ROUNDING
}

/// The gap between boxes and a convex core along one direction: far cheaper than all axes, and once a direction has set
/// triangles apart it sets most of the boxes around them apart.
#[derive(Default)]
struct Slab {
    /// From the core to the mesh, in the mesh's frame; zero for none, which leaves no gap.
    n: DVec3,
    widths: DVec3,
    /// Where the core ends along `n`.
    end: f64,
}

impl Slab {
    fn turn_to(&mut self, n: DVec3, support: impl Fn(DVec3) -> DVec3, X_MC: &Relative) {
        if n != self.n {
            *self = Self { n, widths: n.abs(), end: n.dot(X_MC.point(support(n))) };
        }
    }

    #[inline]
    fn gap(&self, node: &Node) -> f64 {
        self.n.dot(node.center) - self.widths.dot(node.half) - self.end
    }
}

/// As [`Slab`], for the boxes of two meshes.
#[derive(Default)]
struct Slabs {
    /// From the second mesh to the first, in the frame of the first.
    n: DVec3,
    widths: [DVec3; 2],
    /// The same in the frame of the second.
    n_b: DVec3,
    offset: f64,
}

impl Slabs {
    fn turn_to(&mut self, n: DVec3, X_AB: &Relative) {
        if n != self.n {
            let n_b = X_AB.direction_back(n);
            *self = Self { n, widths: [n.abs(), n_b.abs()], n_b, offset: n.dot(X_AB.translation) };
        }
    }

    #[inline]
    fn gap(&self, a: &Node, b: &Node) -> f64 {
        let apart = self.n.dot(a.center) - self.n_b.dot(b.center) - self.offset;
        apart - self.widths[0].dot(a.half) - self.widths[1].dot(b.half)
    }
}

fn leaf<'a>(mesh: &'a MeshTree, node: &Node) -> &'a [[DVec3; 3]] {
    let first = node.next as usize;
    &mesh.triangles[first..first + node.count as usize]
}

fn meet_leaves(a: &[[DVec3; 3]], b: &[[DVec3; 3]], X_AB: &Relative, ask: &Ask, least: &mut Least, hint: &mut DVec3) {
    let here = Relative { rotation: DMat3::IDENTITY, translation: DVec3::ZERO };
    for q in b {
        let q = Core::Triangle([X_AB.point(q[0]), X_AB.point(q[1]), X_AB.point(q[2])]);
        for p in a {
            let ask = least.ask(ask);
            least.lower(core_distance(&Core::Triangle(*p), &q, &here, 0.0, ask, hint));
        }
    }
}

/// Whether something at this squared distance is at least `least` away.
fn beyond(squared: f64, least: f64) -> bool {
    least > 0.0 && squared >= least * least
}

/// The least distance that still matters: nothing farther need be looked at.
struct Least {
    value: f64,
    floor: f64,
}

impl Least {
    fn new(ask: &Ask) -> Self {
        Self { value: ask.needed + 2.0 * ROUNDING, floor: ask.floor + 2.0 * ROUNDING }
    }

    /// What to ask of the next pair of triangles.
    fn ask(&self, ask: &Ask) -> Ask {
        Ask { needed: self.value, floor: self.floor.min(self.value), ..*ask }
    }

    /// Takes in a distance. Once one is too small for what is needed, only what is below the floor still matters.
    fn lower(&mut self, found: f64) {
        if found >= self.value {
            return;
        }
        // NaN is smaller than everything.
        self.value = match found {
            _ if found >= self.floor => self.floor.min(self.value),
            _ if found.is_nan() => f64::NEG_INFINITY,
            _ => found,
        };
    }
}

/// A convex core as boxes see it: its bounding box along the mesh's axes and along its own, and its bounding ball.
struct Probe<'a> {
    X_MC: &'a Relative,
    turned: DMat3,
    center: DVec3,
    half: DVec3,
    own_center: DVec3,
    own_half: DVec3,
    radius: f64,
}

impl<'a> Probe<'a> {
    fn new(convex: &Convex, X_MC: &'a Relative) -> Self {
        let middle = convex.core.center();
        Self {
            X_MC,
            turned: X_MC.rotation.abs().transpose(),
            center: X_MC.point(middle),
            half: convex.core.extents_along(&X_MC.rotation),
            own_center: middle,
            own_half: convex.core.extents_along(&DMat3::IDENTITY),
            radius: convex.core.farthest_from(middle).distance(middle),
        }
    }

    /// At most the squared distance of the core to anything in the node's box.
    #[inline]
    fn distance_squared(&self, node: &Node) -> f64 {
        let apart = (self.center - node.center).abs();
        let along_mesh = (apart - node.half - self.half).max(DVec3::ZERO).length_squared();
        let ball = (apart - node.half).max(DVec3::ZERO).length() - self.radius;
        let here = (self.X_MC.back(node.center) - self.own_center).abs();
        let along_own = (here - self.own_half - self.turned * node.half).max(DVec3::ZERO).length_squared();
        along_mesh.max(along_own).max(ball.max(0.0) * ball.max(0.0))
    }
}

/// At most the squared distance of two boxes: the larger of the gaps along either's axes. `turned` are the rotation between
/// them without signs and its transpose.
#[inline(always)]
fn box_distance_squared(a: &Node, b: &Node, X_AB: &Relative, turned: &[DMat3; 2]) -> f64 {
    let apart = X_AB.point(b.center) - a.center;
    let along_a = (apart.abs() - a.half - turned[0] * b.half).max(DVec3::ZERO).length_squared();
    let apart = X_AB.direction_back(apart);
    let along_b = (apart.abs() - b.half - turned[1] * a.half).max(DVec3::ZERO).length_squared();
    along_a.max(along_b)
}
