//! Proving a path file right or wrong, against the scene that it answers and the models as they are.
//!
//! Nothing of the search is trusted: bodies, limits and pairs are rebuilt from the models, motions are read as the path
//! contract says, and where the planner certifies clearance by covering intervals around samples, this marches forward along
//! each pair's own clock; distances are computed by code of its own. What cannot be proved counts as broken, or as undecided
//! where work, time or resolution end first.
//!
//! A path answers a problem: the scene is the contract ([`SceneChoice`]), and what the file says of itself is compared with
//! it. Without a scene only what the file says is proved, and [`CheckReport::verdict`] says so.
//!
//! [`check`] answers with a [`CheckReport`], or with a [`CheckError`] where the file or a model cannot be read.
//!
//! `prove` runs the proof: `structure` checks the form of the file, `world` rebuilds its bodies, `limits` needs numbers
//! only, and `timing` proves the times of a path: limits of rates, continuity, events. Segment by segment `leaf` proves the constraints and `clearance` the distances, which `distance` computes; `motion`
//! is where things are on the way. `contract` compares the file with its scene. All of them write into `report`.

pub(crate) mod clearance;
pub(crate) mod contract;
pub(crate) mod distance;
pub(crate) mod leaf;
pub(crate) mod limits;
pub(crate) mod motion;
pub mod prove;
pub mod report;
pub(crate) mod structure;
pub(crate) mod timing;
pub(crate) mod world;

pub use crate::check::prove::{check, check_problem};
pub use crate::check::report::check_report::{CheckReport, Counts, Extreme, LeftOut, Violation};
pub use crate::check::report::error::{CheckError, CheckOptions, SceneChoice};
pub use crate::check::report::kind::{Kind, Section, Verdict};
