//! A motion between two configurations of a leaf where the straight one is not free: a planning problem of its own.
//!
//! Two trees grow from the ends and connect greedily (RRT-Connect: Kuffner and LaValle, ICRA 2000), projected onto the leaf where
//! rows are implicit (CBiRRT: Berenson et al., ICRA 2009). Blocked extensions are retracted along the obstacle (Zhang and
//! Manocha, ICRA 2008).
//!
//! `leaf_space` makes and certifies motions of the leaf, `retraction` turns blocked ones aside, `sampling` draws configurations, `tree` holds what
//! has been reached, `rrt_connect` grows the trees.

pub mod leaf_space;
pub mod retraction;
pub mod rrt_connect;
pub mod sampling;
pub mod tree;
