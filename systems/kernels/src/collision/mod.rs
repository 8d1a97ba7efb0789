//! Clearance: exact distances, verdicts of configurations, certificates of motions (DESIGN §5.5).
//!
//! A [`scene::CollisionScene`] holds what never changes; a [`PairSet`](crate::collision::PairSet) what matters on one leaf;
//! [`verdict::first_collision`](crate::collision::discrete::one::first_collision) judges one configuration, [`first_collisions`] many, [`certificate::certify_motion`](crate::collision::continuous::straight::certify_motion) a straight motion over the
//! continuum and [`polyline::certify_polyline`](crate::collision::continuous::polyline::certify_polyline) many of them in a row; [`minimum::minimum_clearance_along`](crate::collision::continuous::minimum::minimum_clearance_along) says how close the closest pair comes, and where. Cheap bounds come first, of sixteen configurations at once: balls of bodies, balls, boxes and capsules of shapes; then GJK or the meshes' trees.
//! Where bounds from inside overlap, two solids collide for sure.
//! Nothing is ever called free that is not proved so: in doubt, in collision.

pub(crate) mod broad_phase;
pub mod continuous;
pub mod convex;
pub mod discrete;
pub mod distance;
pub mod narrow_phase;
pub mod samples;
pub mod scene;
pub mod solids;

pub use crate::collision::continuous::minimum::{minimum_clearance_along, minimum_clearance_while};
pub use crate::collision::continuous::minimum_settings::{MinimumClearance, MinimumSettings, Nearest};
pub use crate::collision::continuous::polyline::{PolylineVerdict, certify_polyline};
pub use crate::collision::continuous::straight::{MotionVerdict, certify_motion};
pub use crate::collision::convex::gjk::Ask;
pub use crate::collision::discrete::many::{Verdicts, first_collisions, open_to_bounds};
pub use crate::collision::discrete::one::{all_collisions, first_collision, min_clearance, rigid_collisions};
pub use crate::collision::distance::query::clearance;
pub use crate::collision::narrow_phase::scratch::CollisionScratch;
pub use crate::collision::narrow_phase::settings::CertificateSettings;
pub use crate::collision::scene::adjacent::{adjacent_links, adjacent_links_while};
pub use crate::collision::scene::collision_scene::{CollisionScene, Pair, PairId};
pub use crate::collision::scene::pair_filter::PairRule;
pub use crate::collision::scene::pair_query::{Contact, contained, pair_clearance, surely_colliding};
pub use crate::collision::scene::pair_set::{PairSet, Tie};
pub use crate::collision::solids::solid::Solid;
