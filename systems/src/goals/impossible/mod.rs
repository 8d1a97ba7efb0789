//! Problems without a solution: proofs before the search, and evidence while it runs.
//!
//! `moves` tells which objects have to be moved, and where to. `proofs` refutes goals by the constraint graph, by the lengths of arms
//! (`arm_length`), by the fit of hands (`hand_fit`), and by the sizes of supports (`put_down`). What follows is evidence and no proof: `survey` tries (`tries`) all grasps of an object where
//! it starts or where a goal has it, also beyond joint limits (`beyond`), `hindrance` puts into words what it finds, and `common_grasp` looks for grasps by which an object could
//! be moved from start to goal; both look at `site`s.

pub(crate) mod arm_length;
pub(crate) mod beyond;
pub mod common_grasp;
pub(crate) mod hand_fit;
pub mod hindrance;
pub mod moves;
pub(crate) mod proofs;
pub(crate) mod put_down;
pub(crate) mod site;
pub mod survey;
pub(crate) mod tries;
