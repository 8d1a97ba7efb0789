//! Why constraints do not compile, and the checks on numbers of rows that report it.

use foliate_components::robot::JointIndex;

/// Why constraints make no program.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum CompileError {
    #[error("constraint {constraint} names joint {joint:?}, and the robot has {joints} joints")]
    NoSuchJoint { constraint: usize, joint: JointIndex, joints: usize },
    #[error("`{0}` cannot be carried: it is not a free-flyer that is attached to the world")]
    NotAnObject(String),
    #[error("`{0}` would carry itself")]
    Cycle(String),
    #[error("`{0}` cannot be locked: it has not exactly one coordinate of its own")]
    NotLockable(String),
    #[error("constraint {0} is a placement whose supports are on several bodies, and cannot carry its object")]
    SeveralSupports(usize),
    #[error("constraint {0} is a placement without polygons")]
    EmptyPlacement(usize),
    #[error("constraint {constraint} makes no sense: {problem}")]
    Malformed { constraint: usize, problem: &'static str },
    #[error("the kinematics were compiled for another robot")]
    OtherRobot,
}

/// More rows than any balance needs; what a solve works with grows with their square.
const MOST_ROWS: usize = 64;

pub(crate) fn fits_rows(rows: usize) -> Option<&'static str> {
    match rows {
        0 => Some("it has no rows"),
        1..=MOST_ROWS => None,
        _ => Some("it has more than 64 rows"),
    }
}

pub(crate) fn fit(constraint: usize, problem: Option<&'static str>) -> Result<(), CompileError> {
    problem.map_or(Ok(()), |problem| Err(CompileError::Malformed { constraint, problem }))
}
