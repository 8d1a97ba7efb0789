//! Constraints on configurations (P0 §II-B, §II-C): a file each, the sum of them in [`Constraint`], and the rows that they give.

pub(crate) mod bounded;
pub(crate) mod centre_of_mass;
pub(crate) mod custom;
pub(crate) mod footing;
pub(crate) mod grasp;
pub mod kind;
pub(crate) mod locked;
pub(crate) mod mask;
pub(crate) mod placement;
pub(crate) mod relative_pose;
pub(crate) mod rests;
pub(crate) mod row;

pub use crate::constraint::bounded::{Distance, Region, Tilt};
pub use crate::constraint::centre_of_mass::{BodyMass, CentreOfMass, CentreOfMassBetween, Masses, NoMass, PlaneRow};
pub use crate::constraint::custom::{Curvature, Custom, Function, Gradient};
pub use crate::constraint::grasp::{ApproachBound, Grasp};
pub use crate::constraint::kind::Constraint;
pub use crate::constraint::locked::{Locked, LockedValue};
pub use crate::constraint::mask::{Mask, MaskError};
pub use crate::constraint::placement::{Placement, PlacementError, Polygon, Side};
pub use crate::constraint::relative_pose::{Frame, Reference, RelativePose};
pub use crate::constraint::rests::Rests;
pub use crate::constraint::row::{Row, Rows, parameter_of, rows};
