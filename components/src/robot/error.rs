//! Why models do not make a robot, and why a coordinate cannot be set by its name.

use crate::robot::limits::NoRoom;

/// Why models do not make a robot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum ComposeError {
    #[error("two parts are called `{0}`")]
    DuplicatePart(String),
    #[error("part `{part}`: {message}")]
    InPart { part: String, message: String },
    #[error("part `{part}`: {room}")]
    NoRoom { part: String, room: NoRoom },
}

/// Why a coordinate is not set or read by its name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CoordinateError {
    /// Nothing has the name.
    #[error("there is no joint or part `{0}`")]
    Unknown(String),
    /// The part's root is fixed in the world.
    #[error("the root of part `{0}` does not move")]
    FixedRoot(String),
    /// The joint follows another one by `<mimic>`.
    #[error("joint `{0}` follows another one and has no coordinate of its own")]
    Follows(String),
    /// The value is of another kind than the joint.
    #[error("`{name}` takes {takes}")]
    Kind {
        /// The joint or part.
        name: String,
        /// What it takes: a number, a pose, or x, y and theta.
        takes: &'static str,
    },
}
