//! TODO(page): what lies in goals.

pub(crate) mod programs;
pub(crate) mod region;
pub mod sampler;
pub mod systems;

pub use crate::goals::sampler::GoalSampler;
pub use crate::goals::systems::draw_more_goals;
