//! Clearance: exact distances, verdicts of configurations, certificates of motions (DESIGN §5.5).
//!
//! A [`scene::CollisionScene`] holds what never changes; a [`pairs::PairSet`] what matters on one leaf;
//! [`verdict::first_collision`] judges one configuration, [`first_collisions`] many, [`certificate::certify_motion`] a straight motion over the
//! continuum and [`polyline::certify_polyline`] many of them in a row. Cheap bounds come first, of sixteen configurations at once: balls of bodies, balls, boxes and capsules of shapes; then GJK or the meshes' trees.
//! Where bounds from inside overlap, two solids collide for sure.
//! Nothing is ever called free that is not proved so: in doubt, in collision.

mod attachment;
pub mod bounds;
pub mod certificate;
pub mod convex;
mod course;
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
pub mod mesh_tree;
mod outer;
mod pair_rule;
pub mod pairs;
mod place_bodies;
pub mod polyline;
mod proof;
pub mod scene;
mod scratch;
mod simplex;
mod sweep;
mod tie;
pub mod velocity_bound;
pub mod verdict;
mod verdicts;

pub use certificate::{CertificateSettings, MotionVerdict, certify_motion};
pub use distance::{Ask, Solid, clearance};
pub use pair_rule::PairRule;
pub use pairs::PairSet;
pub use polyline::{PolylineVerdict, certify_polyline};
pub use scene::{CollisionScene, Pair, PairId};
pub use scratch::CollisionScratch;
pub use tie::Tie;
pub use verdict::{Contact, contained, first_collision, min_clearance, pair_clearance, surely_colliding};
pub use verdicts::{Verdicts, first_collisions, open_to_bounds};
