//! TODO(page): what lies in planning_model.

pub mod attachments;
pub(crate) mod collision_messages;
pub mod graph;
pub mod leg_program;
pub mod model;
pub mod objects;
pub(crate) mod pair_sets;
pub(crate) mod path_constraints;
pub mod problem_tables;
pub(crate) mod programs;
pub mod state_classification;

pub use crate::planning_model::graph::attachment_order::{hanging, solid_grasp};
pub use crate::planning_model::model::{Model, PlanningModel};
pub use crate::planning_model::objects::{ModelError, ObjectModel};
pub use crate::planning_model::problem_tables::ProblemTables;
