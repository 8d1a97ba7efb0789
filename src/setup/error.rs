//! Why no scene was made.

use crate::scene::SceneError;

/// Why a setup ends without a scene.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SetupError {
    /// A model or a file cannot be read.
    #[error(transparent)]
    Read(#[from] SceneError),
    /// What was asked for is no object, table or seed; the message says what would be one.
    #[error("{0}")]
    Request(String),
    /// The robot has no gripper that is found by its joints.
    #[error(
        "no gripper was found: no two short joints that begin at one link move against each other; name a tool frame or a link of the \
         hand with --gripper LINK (outermost links: {})",
        shortened(links)
    )]
    NoGripper {
        /// Links at which a tool may be.
        links: Vec<String>,
    },
    /// A link that the robot does not have.
    #[error("the robot has no link `{name}` (links: {})", shortened(known))]
    NoLink {
        /// As it was asked for.
        name: String,
        /// Those that there are.
        known: Vec<String>,
    },
    /// An object that no gripper can hold.
    #[error("`{object}` cannot be held: {reason}")]
    NoGrasp {
        /// The object.
        object: String,
        /// Why, with the sizes.
        reason: String,
    },
    /// There is no place on the table from which an object can be taken.
    #[error("{0}")]
    OutOfReach(String),
}

/// A list of names on one line.
fn shortened(names: &[String]) -> String {
    const MOST: usize = 24;
    let shown = names.iter().take(MOST).cloned().collect::<Vec<_>>().join(", ");
    if names.len() > MOST { format!("{shown} and {} more", names.len() - MOST) } else { shown }
}
