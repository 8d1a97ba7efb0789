//! What a robot program asks of an answer: where its joints are at a time, how fast they move, what the hands hold and when that changes,
//! where objects are.
//!
//! A [`Trajectory`] looks at a path with times and at the robot that moves along it. It comes from
//! [`Solution::trajectory`](crate::Solution::trajectory), or from a path file.
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # use foliate::prelude::*;
//! let solution = Planner::new(foliate::components::samples::swap_two_boxes()?)?.solve_on(1)?;
//! let trajectory = solution.trajectory()?;
//! let joints = trajectory.joints_of("arm")?;
//! for sample in joints.sampled(500.0)? {
//!     println!("{:.3} s: {:?} rad, {:?} rad/s", sample.time, sample.positions, sample.velocities);
//! }
//! for event in trajectory.events() {
//!     println!("{:.3} s: {:?} {} by {}", event.time, event.kind, event.object, event.gripper);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! `curve` evaluates one piece between two knots, `trajectory` finds the piece of a time. `joints` answers for joints by name, `poses` places
//! links and objects, `nearest_pairs` says how close things come, `segments` and `events` tell what is held, `sample_times` cuts the duration into
//! steps, `own_times` makes up times for a path without.

pub(crate) mod curve;
pub(crate) mod error;
pub(crate) mod events;
pub(crate) mod joints;
pub(crate) mod nearest_pairs;
pub(crate) mod own_times;
pub(crate) mod poses;
pub(crate) mod sample_times;
pub(crate) mod segments;
#[allow(clippy::module_inception, reason = "the folder is about this type")]
pub(crate) mod trajectory;

pub use crate::planner::trajectory::curve::Interpolation;
pub use crate::planner::trajectory::error::TrajectoryError;
pub use crate::planner::trajectory::events::TrajectoryEvent;
pub use crate::planner::trajectory::joints::{JointSample, JointSelection};
pub use crate::planner::trajectory::nearest_pairs::{NearestPair, NearestPairs};
pub use crate::planner::trajectory::own_times::TimedMotion;
pub use crate::planner::trajectory::poses::Poses;
pub use crate::planner::trajectory::sample_times::SampleTimes;
pub use crate::planner::trajectory::segments::{Carry, Held, TrajectorySegment};
pub use crate::planner::trajectory::trajectory::Trajectory;
