//! A problem: what is to be moved where (`definition`) and where that may end (`goal`), which hands open and close (`hand`), what is straight
//! beside grasps (`lines`), how fast joints may move and how long hands
//! take (`timing`, `rate_limits`), what a path costs (`cost`), and how exact a start has to be (`start_tolerance`).

pub mod cost;
pub mod definition;
pub mod goal;
pub mod hand;
pub(crate) mod lines;
pub mod rate_limits;
pub mod start_tolerance;
pub mod timing;

pub use crate::problem::cost::CostOptions;
pub use crate::problem::definition::{
    ApproachLine, GraphOptions, JointRest, Lift, Margin, ObjectOptions, PROJECTION_TOLERANCE, Problem, RestingJoint,
    RestingPlane, Rule, WhileHeld, WrittenLeg, WrittenState, WrittenTransition,
};
pub use crate::problem::goal::{Goal, Holding, NamedConstraint, OtherHands, PartialGoal};
pub use crate::problem::hand::{Approach, Finger, Hand};
pub use crate::problem::rate_limits::RateLimits;
pub use crate::problem::start_tolerance::{Correction, Moved, StartTolerance};
pub use crate::problem::timing::{NumberLimit, TimingOptions};
