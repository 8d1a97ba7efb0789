//! Clearance: exact distances, verdicts of configurations, certificates of motions.
//!
//! A [`CollisionScene`] holds what never changes; a [`PairSet`] what matters on one leaf. [`first_collision`] judges one
//! configuration, [`first_collisions`] many, [`certify_motion`] a straight motion over the continuum and [`certify_polyline`]
//! many of them in a row, [`certify_curve`] a curve over time; [`minimum_clearance_along`] says how close the closest pair comes, and
//! where. Cheap bounds come first,
//! of sixteen configurations at once: balls of bodies, balls, boxes and capsules of shapes; then GJK or the meshes' trees.
//! Where inscribed volumes overlap, two solids collide with certainty.
//! Nothing is ever called free that is not proved so: in doubt, in collision.
//!
//! `convex` and `solids` define solids, `distance` computes the distance of two, `depth` how deep one is in the other. `scene` puts the solids of a robot together and
//! selects pairs. `samples` cuts motions into intervals and places their bodies. `broad_phase` bounds sixteen samples at once,
//! `narrow_phase` asks exactly what these bounds leave open. `discrete` (configurations) and `continuous` (motions) use both.

pub(crate) mod broad_phase;
pub mod continuous;
pub mod convex;
pub mod depth;
pub mod discrete;
pub mod distance;
pub mod narrow_phase;
pub mod samples;
pub mod scene;
pub mod solids;

pub use crate::collision::continuous::curve::{CurveVerdict, certify_curve, minimum_clearance_on_curve};
pub use crate::collision::continuous::minimum::{minimum_clearance_along, minimum_clearance_while};
pub use crate::collision::continuous::minimum_settings::{MinimumClearance, MinimumSettings, Nearest};
pub use crate::collision::continuous::polyline::{PolylineVerdict, certify_polyline};
pub use crate::collision::continuous::straight::{MotionVerdict, certify_motion};
pub use crate::collision::convex::gjk::DistanceQuery;
pub use crate::collision::discrete::along_motion::TestOrder;
pub use crate::collision::discrete::many::{Verdicts, first_collisions, open_to_bounds};
pub use crate::collision::discrete::one::{all_collisions, first_collision, min_clearance, rigid_collisions};
pub use crate::collision::distance::query::clearance;
pub use crate::collision::narrow_phase::scratch::CollisionScratch;
pub use crate::collision::narrow_phase::settings::CertificateSettings;
pub use crate::collision::scene::adjacent::{adjacent_links, adjacent_links_while};
pub use crate::collision::scene::collision_scene::{CollisionScene, Pair, PairId};
pub use crate::collision::scene::pair_filter::PairRule;
pub use crate::collision::scene::pair_query::{
    Contact, body_poses, contained, hull_gap_along, pair_clearance, separating_direction, surely_colliding,
};
pub use crate::collision::scene::pair_set::{PairSet, RigidPair};
pub use crate::collision::solids::solid::Solid;
