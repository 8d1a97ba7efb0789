//! Why models do not make a robot, and why a coordinate cannot be set by its name.

use crate::robot::limits::NoRoom;

/// Why models do not make a robot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum ComposeError {
    #[error("two parts are called `{0}`")]
    DuplicatePart(String),
    #[error("part `{part}`: {source}")]
    InPart { part: String, source: PartError },
    #[error("part `{part}`: {room}")]
    NoRoom { part: String, room: NoRoom },
}

/// What is wrong with the model of one part.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum PartError {
    #[error("the model has no links")]
    NoLinks,
    #[error("two links are called `{0}`")]
    DuplicateLink(String),
    #[error("two joints are called `{0}`")]
    DuplicateJoint(String),
    #[error("joint `{0}` names a link that does not exist")]
    NoSuchLink(String),
    #[error("link `{link}` is the child of two joints (one is `{joint}`)")]
    TwoParents { link: String, joint: String },
    #[error("the joints form a cycle: every link is some joint's child")]
    NoRoot,
    #[error("links `{first}` and `{second}` are both roots; a model has one")]
    TwoRoots { first: String, second: String },
    #[error("link `{0}` is on a cycle of joints")]
    Cycle(String),
    #[error("joint `{joint}` mimics `{leader}`, which is not a joint of this part")]
    NoSuchLeader { joint: String, leader: String },
    #[error("joint `{joint}` mimics `{leader}`: only joints of one coordinate can be coupled")]
    NotCoupled { joint: String, leader: String },
    #[error("joint `{joint}` mimics itself, by way of `{leader}`")]
    MimicsItself { joint: String, leader: String },
    #[error("{what} `{name}` is on link `{link}`, which does not exist")]
    NoLinkOf { what: &'static str, name: String, link: String },
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
    /// A number that is infinite or none.
    #[error("`{0}` has a number that is not finite")]
    NotFinite(String),
    /// A quaternion whose length is not 1.
    #[error("the quaternion of `{0}` is no rotation: its length is not 1")]
    NoRotation(String),
}
