//! What seems to keep every hand from an object, in words.

use std::fmt;

/// What seems to keep every hand from an object at a place: evidence and no proof.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Hindrance {
    /// No configuration has a hand at the object.
    OutOfReach(OutOfReach),
    /// In each configuration with a hand at the object something collides that no search can move.
    Blocked(Blocked),
}

/// What keeps every hand from an object, by the grasp that comes nearest.
#[derive(Clone, Debug, PartialEq)]
pub struct OutOfReach {
    /// The gripper.
    pub gripper: String,
    /// The handle.
    pub handle: String,
    /// What is missing.
    pub shortfall: Shortfall,
    /// Coordinates of robots at a bound where the gripper is nearest.
    pub at_limits: Vec<String>,
}

/// What is missing for a grasp.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shortfall {
    /// A joint would have to go beyond its limit, radians or metres.
    Limit {
        /// The joint.
        joint: String,
        /// What it would need.
        needed: f64,
        /// What it may do.
        limit: f64,
    },
    /// The gripper stays so far from the handle, metres.
    Distance(f64),
    /// With the object in the gripper it stays so far from where it shall lie, metres.
    Support(f64),
}

/// What is in the way of a hand, by how many configurations of the robots it collides in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Blocked {
    /// The part that collides in most configurations.
    pub obstacle: String,
    /// Configurations in which it collides, of those that were looked at wholly.
    pub meets_obstacle: u64,
    /// Configurations that were looked at wholly.
    pub compared: u64,
    /// Configurations with a hand at the object; something collides in all of them.
    pub configurations: u64,
    /// The two shapes that collide most often.
    pub shapes: (String, String),
    /// Their links.
    pub links: (String, String),
    /// Grasps that were tried.
    pub grasps: usize,
    /// Those of them of which no configuration was found.
    pub out_of_reach: usize,
}

impl Hindrance {
    /// The sentence about an object: `box1` and `where it starts` make "`box1` is likely out of reach where it starts: …".
    #[must_use]
    pub fn sentence(&self, object: &str, place: &str) -> String {
        match self {
            Self::OutOfReach(reach) => format!("`{object}` is likely out of reach {place}: {reach}"),
            Self::Blocked(blocked) => format!("every grasp of `{object}` is likely blocked {place}: {blocked}"),
        }
    }
}

impl fmt::Display for Hindrance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfReach(reach) => reach.fmt(f),
            Self::Blocked(blocked) => blocked.fmt(f),
        }
    }
}

impl fmt::Display for OutOfReach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { gripper, handle, shortfall, at_limits } = self;
        match shortfall {
            Shortfall::Limit { joint, needed, limit } => {
                write!(f, "for {gripper} to hold {handle}, {joint} would need {needed:.4}, and its limit is {limit:.4}")
            }
            Shortfall::Distance(metres) => {
                write!(f, "{gripper} comes no nearer to {handle} than {:.0} mm", metres * 1e3)
            }
            Shortfall::Support(metres) => {
                write!(f, "with {handle} in {gripper} it comes no nearer to that place than {:.0} mm", metres * 1e3)
            }
        }?;
        match at_limits.len() {
            0 => Ok(()),
            1 => write!(f, ", where {} is at its limit", at_limits[0]),
            _ => write!(f, ", where {} are at their limits", at_limits.join(" and ")),
        }
    }
}

impl fmt::Display for Blocked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { obstacle, meets_obstacle, compared, configurations, shapes: (a, b), grasps, out_of_reach, .. } =
            self;
        write!(
            f,
            "{obstacle} is in the way in {meets_obstacle} of {compared} configurations (most often {a} with {b})"
        )?;
        if configurations > compared {
            write!(f, ", and something collides in {} more", configurations - compared)?;
        }
        match (grasps, out_of_reach) {
            (_, 0) => Ok(()),
            (grasps, missed) => write!(f, "; {missed} of {grasps} grasps are out of reach"),
        }
    }
}
