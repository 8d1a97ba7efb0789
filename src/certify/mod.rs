//! TODO(page): what lies in certify.

pub mod certifier;
pub mod formats;
pub(crate) mod motion;
pub(crate) mod proof;
pub(crate) mod world;

pub use crate::certify::certifier::CertifyOptions;
pub use crate::certify::motion::names::{UnknownName, find_coordinate, find_joint};
pub use crate::certify::motion::piecewise::{
    Attachment, Curve, FARTHEST, Interpolation, Motion, POINTS, Point, PointError, Segment, Turn, Turns,
};
pub use crate::certify::motion::polynomial::{COEFFICIENTS, Polynomial};
pub use crate::certify::world::limits::Rates;
pub use crate::certify::world::phases::{Certifier, CertifyError};
pub use crate::certify::world::report::{
    CertifyReport, ClearanceReport, ContactReport, LimitKind, LimitViolation, LimitsReport, PairCounts, PairName, Peak,
    UndecidedReport, Verdict,
};
