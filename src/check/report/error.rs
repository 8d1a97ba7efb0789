//! What a check is asked (its options, the scene to compare with), and why a file cannot be checked at all.

use crate::scene::reading::error::SceneError;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// What a path is compared with.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum SceneChoice {
    /// The scene that the file names, where it can be found; else nothing, which the report says.
    #[default]
    Named,
    /// A shipped scene, or a scene file.
    Given(String),
    /// Nothing but the models: the file is believed in everything that these do not say.
    Nothing,
}

/// How much work a check may be, and what is asked.
#[derive(Clone, Debug)]
pub struct CheckOptions {
    /// Distances and residuals that are computed at most; what is then left is undecided.
    pub work_limit: u64,
    /// Time that a check may take, reading of models included; what is then left is undecided.
    pub time_limit: Option<Duration>,
    /// Where another thread sets this, the check ends; what is then left is undecided.
    pub cancelled: Option<Arc<AtomicBool>>,
    /// What the path is compared with.
    pub scene: SceneChoice,
    /// Whether the smallest clearance is asked for: see
    /// [`CheckReport::clearance`](crate::check::report::check_report::CheckReport::clearance).
    pub clearance: bool,
    /// Whether pairs that are not tested are asked for by name: see
    /// [`CheckReport::left_out`](crate::check::report::check_report::CheckReport::left_out).
    pub pairs: bool,
}

impl Default for CheckOptions {
    fn default() -> Self {
        let scene = SceneChoice::default();
        Self { work_limit: 50_000_000, time_limit: None, cancelled: None, scene, clearance: false, pairs: false }
    }
}

/// Why a file cannot be checked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckError {
    /// The file is not well formed, or does not fit its models.
    #[error("{place}: {message}")]
    Malformed {
        /// JSON path, such as `segments[3].knots[0]`.
        place: String,
        /// What is wrong there.
        message: String,
    },
    /// A model cannot be read.
    #[error("{place}: {error}")]
    Model {
        /// JSON path of the part.
        place: String,
        /// What is wrong with it.
        #[source]
        error: Box<SceneError>,
    },
    /// The scene that the path is to be compared with cannot be read.
    #[error("scene: {0}")]
    Scene(Box<SceneError>),
}

impl CheckError {
    pub(crate) fn malformed(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Malformed { place: place.into(), message: message.into() }
    }
}
