//! Random problems as files: robots, objects, environments and scenes. Everything is drawn from
//! a seed and the number of an attempt, so that a problem is named by two numbers.
#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]
#![allow(dead_code, unused_imports, reason = "each test uses its part")]

pub mod draw;
pub mod environment;
mod kept;
pub mod model;
pub mod objects;
mod problems;
pub mod robot;
pub mod scene;
pub mod shapes;

pub use scene::{Kind, RandomScene};
