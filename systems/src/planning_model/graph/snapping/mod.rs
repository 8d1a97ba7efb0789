//! A start or a goal that is a little off a state is moved onto the nearest one: cameras see poses to millimetres, and constraints
//! hold to far less.
//!
//! `nearby` finds the states that a configuration is near to, over all combinations of who holds what and what lies where.
//! `correction` moves it onto one of them: objects first, joints only where poses of objects cannot do it. `snap` takes the smallest
//! correction; `farther` says what would have to be moved where none is within the tolerance.

pub(crate) mod correction;
pub(crate) mod farther;
pub(crate) mod nearby;
pub(crate) mod snap;

pub(crate) use crate::planning_model::graph::snapping::farther::nearest_state;
pub(crate) use crate::planning_model::graph::snapping::snap::snap;
