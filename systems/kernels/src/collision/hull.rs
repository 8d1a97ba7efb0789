//! The convex hull of a mesh, as far as directions see it, and the distance of two hulls: cheap to know, and never more
//! than the distance of what is in them.
//!
//! Two links of a robot that are neighbours of neighbours are as a rule set apart by a plane. To find one takes a dozen
//! supports; to prove the same by the triangles takes hundreds of boxes.

use super::convex::Core;
use super::distance::Solid;
use super::gjk::{Ask, Relative, walk};
use super::mesh_tree::MeshTree;
use foliate_components::Pose;
use glam::DVec3;

/// Of two children one is left behind at every level.
const STACK: usize = 40;

/// A lower bound of the distance of the hulls of two solids, metres: at least `ask.needed`, or within `ask`'s tolerances of
/// the hulls' distance; not positive where the hulls (may) overlap. Poses and `hint` as for
/// [`clearance`](super::distance::clearance): where the result is positive, `hint` is afterwards the unit vector from `b` to
/// `a` along which the solids are at least that far apart.
///
/// Negative infinity where a mesh has no triangles or numbers that are not finite: its hull says nothing.
pub(super) fn hull_distance(a: &Solid, X_WA: &Pose, b: &Solid, X_WB: &Pose, ask: Ask, hint: &mut DVec3) -> f64 {
    if !(has_hull(a) && has_hull(b) && X_WA.is_finite() && X_WB.is_finite()) {
        return f64::NEG_INFINITY;
    }
    let X_AB = Relative::between(X_WA, X_WB);
    let farthest_against = |v: DVec3| support(a, -v) - X_AB.point(support(b, X_AB.direction_back(v)));
    let first = || {
        let between = middle(a) - X_AB.point(middle(b));
        (if between.length_squared() > 1e-20 { between } else { DVec3::X }, false)
    };
    let mut local = X_WA.rotation.conjugate() * *hint;
    let found = walk(farthest_against, first, radius(a) + radius(b), ask, &mut local);
    *hint = (X_WA.rotation * local).normalize_or_zero();
    found
}

fn has_hull(solid: &Solid) -> bool {
    match solid {
        Solid::Convex(_) => true,
        Solid::Mesh(mesh) => mesh.nodes.first().is_some_and(|root| root.half.is_finite()),
    }
}

fn radius(solid: &Solid) -> f64 {
    match solid {
        Solid::Convex(convex) => convex.radius,
        Solid::Mesh(_) => 0.0,
    }
}

fn middle(solid: &Solid) -> DVec3 {
    match solid {
        Solid::Convex(convex) => convex.core.center(),
        Solid::Mesh(mesh) => mesh.nodes.first().map_or(DVec3::ZERO, |root| root.center),
    }
}

fn support(solid: &Solid, d: DVec3) -> DVec3 {
    match solid {
        Solid::Convex(convex) => convex.core.support(d),
        Solid::Mesh(mesh) => mesh.support(d),
    }
}

impl MeshTree {
    /// A vertex that lies farthest in direction `d`; the mesh must not be empty.
    fn support(&self, d: DVec3) -> DVec3 {
        let widths = d.abs();
        let ahead = |index: u32| {
            let node = &self.nodes[index as usize];
            d.dot(node.center) + widths.dot(node.half)
        };
        let (mut best, mut found) = (f64::NEG_INFINITY, DVec3::NAN);
        let mut stack = [(0_u32, f64::INFINITY); STACK];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (mut index, mut bound) = stack[depth];
            // Towards the child that reaches farther, until it is a leaf or can add nothing.
            while bound > best {
                let node = &self.nodes[index as usize];
                if node.is_leaf() {
                    let first = node.next as usize;
                    for triangle in &self.triangles[first..first + node.count as usize] {
                        let p = Core::Triangle(*triangle).support(d);
                        let value = d.dot(p);
                        if value > best {
                            (best, found) = (value, p);
                        }
                    }
                    break;
                }
                let (near, far) = (ahead(index + 1), ahead(node.next));
                let children = if near >= far {
                    [(index + 1, near), (node.next, far)]
                } else {
                    [(node.next, far), (index + 1, near)]
                };
                stack[depth] = children[1];
                depth += 1;
                (index, bound) = children[0];
            }
        }
        found
    }
}
