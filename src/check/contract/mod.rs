//! The scene is the contract: whether a path answers *this* problem.
//!
//! What the scene says is read by its loader into a problem; everything is then compared and evaluated here. The file's own
//! word counts for nothing where the scene has one: parts and models (`parts`), documents, limits, margins and pairs
//! (`claims`, `rate_limits`), the ends of the path (`ends`; `snapped`: what was moved onto a state; `goals`: what goals ask of hands and supports), who holds what and what lies where (`holding`), how fast
//! held objects are (`held_speeds`), how straight grippers go to handles and objects leave supports (`straight`), and the constraints that hold in each segment's state (`required_constraints`, which asks `states` for it). All of these are methods of `scene_contract`'s
//! `Contract`.

pub(crate) mod claims;
pub(crate) mod ends;
pub(crate) mod goals;
pub(crate) mod held_speeds;
pub(crate) mod holding;
pub(crate) mod parts;
pub(crate) mod rate_limits;
pub(crate) mod required_constraints;
pub(crate) mod scene_contract;
pub(crate) mod snapped;
pub(crate) mod states;
pub(crate) mod straight;
