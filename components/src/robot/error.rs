//! Why models do not make a robot.

use crate::robot::limits::NoRoom;

/// Why models do not make a robot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum ComposeError {
    #[error("two parts are called `{0}`")]
    DuplicatePart(String),
    #[error("part `{part}`: {message}")]
    InPart { part: String, message: String },
    #[error("part `{part}`: {room}")]
    NoRoom { part: String, room: NoRoom },
}
