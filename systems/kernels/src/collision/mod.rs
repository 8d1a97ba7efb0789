//! Clearance: exact distances, verdicts of configurations, certificates of motions (DESIGN §5.5).
//!
//! A [`scene::CollisionScene`] holds what never changes; a [`pairs::PairSet`] what matters on one leaf;
//! [`verdict::first_collision`] judges one configuration, [`first_collisions`] many, [`certificate::certify_motion`] a straight motion over the
//! continuum and [`polyline::certify_polyline`] many of them in a row; [`minimum::minimum_clearance_along`] says how close the closest pair comes, and where. Cheap bounds come first, of sixteen configurations at once: balls of bodies, balls, boxes and capsules of shapes; then GJK or the meshes' trees.
//! Where bounds from inside overlap, two solids collide for sure.
//! Nothing is ever called free that is not proved so: in doubt, in collision.

mod adjacent;
mod around;
mod attachment;
pub mod bounds;
pub mod certificate;
pub mod convex;
mod course;
mod coverage;
pub mod distance;
mod gjk;
pub mod hull;
mod inner;
mod interval;
mod lane_boxes;
mod lane_triangles;
mod look;
mod mesh_distance;
mod mesh_inside;
pub mod mesh_record;
pub mod mesh_tree;
pub mod minimum;
mod outer;
mod pair_rule;
pub mod pairs;
mod place_bodies;
mod point_rows;
pub mod polyline;
mod proof;
pub mod scene;
mod scratch;
mod simplex;
mod solids;
mod sweep;
mod tie;
mod triangle_order;
pub mod velocity_bound;
pub mod verdict;
mod verdicts;

pub use adjacent::{adjacent_links, adjacent_links_while};
pub use certificate::{CertificateSettings, MotionVerdict, certify_motion};
pub use distance::{Ask, Solid, clearance};
pub use minimum::{MinimumClearance, MinimumSettings, Nearest, minimum_clearance_along, minimum_clearance_while};
pub use pair_rule::PairRule;
pub use pairs::PairSet;
pub use polyline::{PolylineVerdict, certify_polyline};
pub use scene::{CollisionScene, Pair, PairId};
pub use scratch::CollisionScratch;
pub use tie::Tie;
pub use verdict::{
    Contact, all_collisions, contained, first_collision, min_clearance, pair_clearance, rigid_collisions,
    surely_colliding,
};
pub use verdicts::{Verdicts, first_collisions, open_to_bounds};
