//! Whether a segment stays on its leaf: grasps and placements are what they should be and do not change, further constraints
//! hold; all of it between the knots too.
//!
//! `check` runs the proof of a segment. `on_leaf` proves attachments, and is what `constraint` and `balance` prove listed
//! constraints with; `case` is one of these with its place in the file. `carriers`, `articulation` and `drift` check the
//! knots: objects follow their carriers, joints of objects rest, steps do not add up.

pub(crate) mod articulation;
pub(crate) mod balance;
pub(crate) mod carriers;
pub(crate) mod case;
pub(crate) mod check;
pub(crate) mod constraint;
pub(crate) mod drift;
pub(crate) mod footing;
pub(crate) mod on_leaf;
