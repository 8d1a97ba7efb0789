//! SRDF: disabled pairs, named configurations, and the grippers, handles and contact surfaces of manipulation planning.
//!
//! The manipulation tags are those of the Humanoid Path Planner: frames are given in their link, by text (`x y z  qw qx qy
//! qz`) or by attributes (`xyz` with `rpy`, `wxyz` or `xyzw`); tags of others are left out.
//!
//! `read` goes through a document by a `Reader` (`reader`). Its methods lie with what they read: `frames`, `contact`
//! (with `flat`, for polygons that are a little bent), `disabled`, `states`, `end_effectors`. `known` lists what is read.

pub(crate) mod contact;
pub(crate) mod disabled;
pub(crate) mod end_effectors;
pub(crate) mod flat;
pub(crate) mod frames;
pub(crate) mod known;
pub(crate) mod read;
pub(crate) mod reader;
pub(crate) mod states;
