//! TODO(page): what lies in schedulers/portfolio.

pub mod conclusion;
pub mod members;
pub mod roadmap_exchange;
pub(crate) mod rooted;
pub mod scheduler;

pub use crate::schedulers::portfolio::members::{
    Member, WorldCount, WorldCounts, Worlds, enter, pass_branches, take_turns,
};
pub use crate::schedulers::portfolio::scheduler::Portfolio;
