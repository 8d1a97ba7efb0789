//! Samples of a motion: its intervals, the poses of bodies at their middles, and how far bodies move within them.
//!
//! `interval` defines a part of a polyline and its sample. `place_bodies` computes forward kinematics of sixteen samples in
//! lanes. `motion_samples` builds on both: it fills a block with sixteen intervals, their poses and the motion of every joint.
//! `motion_bound` bounds in double precision how far two bodies approach within one interval; `motion_samples` takes from it
//! only the limit below which directions are used.

pub(crate) mod interval;
pub mod motion_bound;
pub(crate) mod motion_samples;
pub(crate) mod place_bodies;
