#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod batch;
pub mod certify;
pub mod check;
pub mod diagram;
pub mod inspection;
pub mod memory;
pub mod output;
pub mod path_file;
pub mod planner;
pub mod scene;

pub use foliate_components as components;
pub use foliate_kernels as kernels;
pub use foliate_systems as systems;

pub use planner::{FunnelRow, GoalReport, Planner, Report, Solution, StateRow};
