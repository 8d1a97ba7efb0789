//! The planning model: what stays the same during searches, and the queries on it.
//!
//! `graph` enumerates the constraint graph. `problem_tables` holds what follows from the problem without its graph,
//! `hands` how hands open and close, `objects` how each object may rest, `leg_program` the form of a compiled leg. `model` holds all of these and compiles the
//! tables of single states and transitions when they are first needed. The other files query the model: `attachments` what
//! carries each object and where that puts it, `programs` the constraints of a leg or a state as a constraint program, `pair_sets`
//! which pairs of shapes count, `state_classification` which state and leaf a configuration lies in and why it may be no start
//! or goal, `finger_motions` how hands open and close at the ends of a path,
//! `path_constraints` the constraints of a leaf for output.

pub mod attachments;
pub(crate) mod finger_motions;
pub mod graph;
pub mod hands;
pub mod leg_program;
pub mod model;
pub mod objects;
pub(crate) mod pair_sets;
pub(crate) mod path_constraints;
pub mod problem_tables;
pub(crate) mod programs;
pub mod state_classification;

pub use crate::planning_model::graph::attachment_order::{pose_on_carrier, solid_grasp};
pub use crate::planning_model::model::{Model, PlanningModel};
pub use crate::planning_model::objects::{ModelError, ObjectModel};
pub use crate::planning_model::problem_tables::ProblemTables;
