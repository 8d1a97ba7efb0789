//! How the points of a motion are joined.

/// How to go from point to point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Interpolation {
    /// What the two points allow, as ROS's `joint_trajectory_controller` does: quintic with accelerations, cubic with velocities, else
    /// linear
    #[default]
    Auto,
    /// Straight from point to point; velocities and accelerations are ignored
    Linear,
    /// Cubic Hermite splines through positions and velocities
    Cubic,
    /// Quintic splines through positions, velocities and accelerations
    Quintic,
}

/// Which way a joint without limits turns from one point to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Turns {
    /// As the file's format means it: the shortest way in path matrices of OMPL, as written in all others
    #[default]
    Format,
    /// Numbers are interpolated as they stand: from 3 to -3 by way of 0
    AsWritten,
    /// The shortest way: from 3 to -3 by way of π
    Shortest,
}

/// How points are joined.
pub(crate) struct How<'h> {
    pub(crate) interpolation: Interpolation,
    pub(crate) turns: Turns,
    /// Columns that go straight from point to point whatever the others do.
    pub(crate) straight: &'h [usize],
    /// Whether the numbers of quaternions follow the interpolation, and are scaled to length 1.
    pub(crate) scaled: bool,
}
