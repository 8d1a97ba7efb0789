//! Improvement of a path: fewer grasps, better leaves, shorter motions, arms that move at the same time.
//!
//! A path is a list of motions on leaves (`leaf_motion`) with a `cost`. Every round draws proposals (`proposal`), evaluates them in
//! parallel and commits those that make the path cheaper (`systems`). What a proposal may try is in `changes`. `session` is what a host
//! embeds, with its `settings` and `progress`.

pub mod changes;
pub mod cost;
pub mod leaf_motion;
pub mod progress;
pub mod proposal;
pub mod session;
pub mod settings;
pub mod systems;

pub use crate::improvement::cost::PathCost;
pub use crate::improvement::progress::{ImprovementEnding, Progress};
pub use crate::improvement::session::Improvement;
pub use crate::improvement::settings::ImprovementSettings;
