//! Several searches of one problem, each in a world of its own, that take turns by counted work.
//!
//! The worlds are a resource of the world that the host knows, whose schedule is made of the systems here. In a round every
//! world has a turn of equal work, side by side where there are threads; then what they have reached is handed on
//! ([`roadmap_exchange`]), and it is asked whether it is over ([`conclusion`]). Of the worlds that solve the problem in a
//! round the first answers, whichever was quicker, and its world becomes the one that the host sees.
//!
//! [`scheduler`] composes the systems of [`members`] and [`conclusion`]. `members` posts and takes over branches by
//! `roadmap_exchange`, which asks `rooted` which nodes are connected to a root.

pub mod conclusion;
pub mod members;
pub mod roadmap_exchange;
pub(crate) mod rooted;
pub mod scheduler;

pub use crate::portfolio::members::{
    Member, MemberCount, MemberCounts, PortfolioMembers, enter, pass_branches, take_turns,
};
pub use crate::portfolio::scheduler::Portfolio;
