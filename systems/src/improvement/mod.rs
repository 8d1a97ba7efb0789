//! Improvement of a path: fewer grasps, better leaves, shorter motions, arms that move at the same time.
//!
//! A path is a list of motions on leaves (`leaf_motion`) with a `cost`. Every round draws proposals (`proposal`), evaluates them in
//! parallel and commits those that make the path cheaper (`systems`). A proposal is a `shortcut` of a motion, a `limb_shortcut` of
//! some coordinates (`limbs`), a `waypoint_move` of a grasp, or a stretch that is planned again (`replan`). `session` is what a host embeds, with its `settings`
//! and `progress`.

pub(crate) mod context;
pub mod cost;
pub mod leaf_motion;
pub(crate) mod limb_shortcut;
pub mod limbs;
pub mod progress;
pub mod proposal;
pub(crate) mod replan;
pub mod session;
pub mod settings;
pub(crate) mod shortcut;
pub mod systems;
pub(crate) mod waypoint_move;

pub use crate::improvement::cost::PathCost;
pub use crate::improvement::progress::{ImprovementEnding, Progress};
pub use crate::improvement::session::Improvement;
pub use crate::improvement::settings::ImprovementSettings;
