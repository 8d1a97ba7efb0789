//! Why a path gets no times.

use crate::trajectory::spline::SplineError;

/// Why a path gets no times.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TimingError {
    /// The path is no spline.
    #[error(transparent)]
    Path(#[from] SplineError),
    /// The path has no knots.
    #[error("the path has no knots")]
    Empty,
    /// There is not one limit of velocity and one of acceleration for each coordinate.
    #[error("there must be one limit of velocity and one of acceleration for each coordinate")]
    LimitCount,
    /// A limit is negative or not a number.
    #[error("a limit of coordinate {coordinate} is negative or not a number")]
    Limit {
        /// Which.
        coordinate: usize,
    },
    /// A coordinate moves, and one of its limits is 0.
    #[error("coordinate {coordinate} moves, but a limit of its velocity or acceleration is 0")]
    Immovable {
        /// Which.
        coordinate: usize,
    },
    /// No coordinate that moves on a piece has an acceleration limit: from rest it would take no time.
    #[error("on piece {piece} of the path only coordinates without acceleration limits move")]
    Unlimited {
        /// Which.
        piece: usize,
    },
    /// Lengths or limits are so small or so large that times are no numbers.
    #[error("lengths or limits of the path are too small or too large to compute its times")]
    Precision,
}
