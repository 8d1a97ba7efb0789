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

pub use crate::planner::{FunnelRow, GoalReport, Planner, Report, Solution, StateRow};
pub use {
    foliate_components as components, foliate_kernels as kernels, foliate_schedulers as schedulers,
    foliate_systems as systems,
};
