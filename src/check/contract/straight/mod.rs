//! What is straight beside grasps and placements: `approaches` of grippers to handles, `lifts` of objects off their supports.

mod approaches;
mod lifts;
