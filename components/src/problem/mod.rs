//! A problem: what is to be moved where (`definition`), which hands open and close (`hand`), how fast joints may move and how long hands
//! take (`timing`, `rate_limits`), and what a path costs (`cost`).

pub mod cost;
pub mod definition;
pub mod hand;
pub mod rate_limits;
pub mod timing;

pub use crate::problem::cost::CostOptions;
pub use crate::problem::definition::{
    Goal, GraphOptions, JointRest, Margin, NamedConstraint, ObjectOptions, PartialGoal, Problem, RestingJoint,
    RestingPlane, Rule, WrittenLeg, WrittenState, WrittenTransition,
};
pub use crate::problem::hand::{Approach, Finger, Hand};
pub use crate::problem::rate_limits::RateLimits;
pub use crate::problem::timing::{NumberLimit, TimingOptions};
