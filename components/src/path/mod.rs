//! What a planner answers: a manipulation path, segment by segment.
//!
//! `manipulation_path` holds configurations, times and what was proven. `events` finds where hands and objects meet and part,
//! `fingers` the joints that open and close a hand.

pub mod events;
pub mod fingers;
pub mod manipulation_path;

pub use crate::path::events::{Event, EventKind, events, knot_of_event};
pub use crate::path::fingers::fingers;
pub use crate::path::manipulation_path::{
    Attachment, Certificate, ManipulationPath, PathConstraint, Segment, SegmentTiming,
};
