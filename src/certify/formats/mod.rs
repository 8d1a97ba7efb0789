//! Reading motions as others write them, one file per format.
//!
//! `read` finds out which format a file has and calls its reader: `csv`, `numpy`, `ompl`, `ros`, or `own` for path files.
//! Each of them makes a `Table` (`table`). `read` then looks up its names and makes a motion of it.

pub(crate) mod csv;
pub(crate) mod numpy;
pub(crate) mod ompl;
pub(crate) mod own;
pub mod read;
pub(crate) mod ros;
pub(crate) mod ros_time;
pub mod table;

pub use crate::certify::formats::read::{Format, ReadOptions, read, read_bytes};
pub use crate::certify::formats::table::CAP;
