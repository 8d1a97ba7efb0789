//! Samples of a motion: its intervals, the poses of bodies at their middles, and how far bodies move within them.
//!
//! `interval` defines a part of a motion and its sample. `joint_rate` bounds how one joint moves, along a straight motion or a
//! curve; `motion_bound` makes of it, in double precision, how far two bodies approach within one interval. `pieces` holds the
//! pieces of a polyline or a curve, and `way` evaluates them. `place_bodies` computes forward kinematics of sixteen samples in
//! lanes. `motion_samples` fills a block with sixteen intervals, their poses and the motion of every joint.

pub(crate) mod interval;
pub(crate) mod joint_rate;
pub mod motion_bound;
pub(crate) mod motion_samples;
pub(crate) mod pieces;
pub(crate) mod place_bodies;
pub(crate) mod way;
