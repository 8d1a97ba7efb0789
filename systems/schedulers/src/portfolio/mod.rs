//! Several searches of one problem, the members of a portfolio, which alternate by counted work.
//!
//! Each member is a search with a world of its own. The members are a resource of the host's world, whose schedule consists of
//! the systems here. In a round every member does equal work, in parallel where there are threads. Then members exchange what
//! they have reached ([`roadmap_exchange`]), and the portfolio may end ([`conclusion`]). Of the members that solve the problem in
//! a round the first in order answers, whichever was quicker, and its world becomes the one that the host sees.
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
