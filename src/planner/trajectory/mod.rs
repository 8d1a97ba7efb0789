//! What a robot program asks of an answer: where its joints are at a time, how fast they move, what the hands hold and when that changes,
//! where objects are.
//!
//! A [`Trajectory`] looks at a path with times and at the robot that moves along it. It comes from
//! [`Solution::trajectory`](crate::Solution::trajectory), or from a path file.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # use foliate::prelude::*;
//! # let planner = Planner::new(foliate::components::samples::swap_two_boxes()?)?.seed(7);
//! # let mut solution = planner.solve_on(1)?;
//! # for segment in &mut solution.path.segments {
//! #     let count = segment.knots.len();
//! #     let start = segment.state.0 as f64; // any times
//! #     let _ = start;
//! #     segment.timing = Some(foliate::components::path::SegmentTiming {
//! #         times: vec![0.0; count], velocities: vec![vec![0.0; segment.knots[0].len()]; count] });
//! # }
//! # let mut now = 0.0;
//! # for timing in solution.path.segments.iter_mut().filter_map(|s| s.timing.as_mut()) {
//! #     for (k, time) in timing.times.iter_mut().enumerate() { if k > 0 { now += 1.0; } *time = now; }
//! # }
//! let trajectory = solution.trajectory()?;
//! let joints = trajectory.joints_of("arm")?;
//! for sample in joints.sampled(500.0)? {
//!     assert_eq!(sample.positions.len(), joints.names().len()); // send it to the controller
//! }
//! for event in trajectory.events() {
//!     println!("{:.3} s: {:?} {} by {}", event.time, event.kind, event.object, event.gripper);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! `curve` evaluates one piece between two knots, `trajectory` finds the piece of a time. `joints` answers for joints by name, `poses` places
//! links and objects, `segments` and `events` tell what is held, `sample_times` cuts the duration into steps.

pub(crate) mod curve;
pub(crate) mod error;
pub(crate) mod events;
pub(crate) mod joints;
pub(crate) mod poses;
pub(crate) mod sample_times;
pub(crate) mod segments;
#[allow(clippy::module_inception, reason = "the folder is about this type")]
pub(crate) mod trajectory;

pub use crate::planner::trajectory::curve::Interpolation;
pub use crate::planner::trajectory::error::TrajectoryError;
pub use crate::planner::trajectory::events::TrajectoryEvent;
pub use crate::planner::trajectory::joints::{JointSample, JointSelection};
pub use crate::planner::trajectory::poses::Poses;
pub use crate::planner::trajectory::sample_times::SampleTimes;
pub use crate::planner::trajectory::segments::{Held, TrajectorySegment};
pub use crate::planner::trajectory::trajectory::Trajectory;
