//! Paths with times: whether they are well formed (`structure`), go on without a jump (`continuity`), keep their limits of velocity,
//! acceleration and jerk (`rates`), and stand still where hands and objects meet and part (`events`).

pub(crate) mod continuity;
pub(crate) mod events;
pub(crate) mod rates;
pub(crate) mod structure;
