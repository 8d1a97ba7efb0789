//! Varied instances of a problem: other starts and goals of its objects, fewer objects, parts elsewhere or of other sizes, more obstacles.
//!
//! `options` say what varies. An instance follows from its number and the seed alone, however many were made before. What is in the scene, where
//! parts stand and how large they are is changed in the text of the scene (`edit`, `removal`), which is then read again; where objects lie is
//! drawn on the supports (`places`). Draws that start or end where no path could are refused, and `rejections` counts why. `variations` makes
//! instances of both.

pub(crate) mod edit;
pub(crate) mod options;
pub(crate) mod places;
pub(crate) mod rejections;
pub(crate) mod removal;
pub(crate) mod variations;

pub use crate::batch::vary::options::{MovedPart, Obstacles, SizedPart, Span, Vary, Which};
pub use crate::batch::vary::rejections::{Rejection, Rejections, RejectionsError};
pub use crate::batch::vary::variations::{Instance, NoInstance, Variations};
