//! How much is spent on a better path, and on what.

use bevy_ecs::prelude::Resource;

/// Settings of an improvement. Take the defaults and change what differs.
#[derive(Clone, Debug, PartialEq, Resource)]
#[non_exhaustive]
pub struct ImprovementSettings {
    /// Counted work after which the improvement ends: candidates of searches, and shortcuts that were tried. `u64::MAX` for no
    /// limit.
    pub max_work: u64,
    /// Changes that are drawn at once. Part of the answer, so never derived from the number of threads.
    pub proposals: usize,
    /// The share of the work that goes into planning stretches again.
    pub replanning_share: f64,
    /// How often some coordinates alone are shortened, of all that is not planned again.
    pub limb_probability: f64,
    /// How often the waypoints of a grasp change are moved, of all that is not planned again.
    pub waypoint_probability: f64,
    /// How often a leaf is moved, of all that is not planned again, where the path has one that can be moved. The rest are
    /// shortcuts of all coordinates.
    pub leaf_probability: f64,
    /// Clearance that shortcuts keep beyond every margin, metres: corners will be rounded, and curves leave the straight line.
    pub shortcut_clearance: f64,
    /// Steps of the first search, by which the length of the others is measured.
    pub first_steps: u64,
}

impl Default for ImprovementSettings {
    fn default() -> Self {
        Self {
            max_work: 10_000,
            proposals: 8,
            replanning_share: 0.5,
            limb_probability: 0.3,
            waypoint_probability: 0.3,
            leaf_probability: 0.1,
            shortcut_clearance: 5e-4,
            first_steps: 16,
        }
    }
}

impl ImprovementSettings {
    /// These settings with changes.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }
}
