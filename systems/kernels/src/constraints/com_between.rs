//! The centre of mass over the line between two feet (P0 §IV-A d; HPP's `ComBetweenFeet`).

use super::{centre_of_mass, placement_of};
use foliate_components::Pose;
use foliate_components::constraint::CentreOfMassBetween;
use glam::{DVec2, DVec3};

/// Feet that are nearer to each other than this, seen from above, have no line between them; metres.
const CLOSEST: f64 = 1e-9;

/// What the rows are made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stance {
    /// The centre of mass in the world.
    pub center: DVec3,
    /// The feet in the world.
    pub feet: [DVec3; 2],
    /// Horizontal unit vector from the first foot to the second.
    pub along: DVec3,
}

impl Stance {
    pub(super) fn new(balance: &CentreOfMassBetween, X_WJ: &[Pose]) -> Self {
        let foot = |frame| placement_of(frame).in_world(X_WJ).translation;
        let feet = [foot(&balance.first), foot(&balance.second)];
        let across: DVec2 = (feet[1] - feet[0]).truncate();
        let apart = across.length();
        let center = centre_of_mass::centre(&balance.masses, X_WJ);
        if apart < CLOSEST {
            return Self { center, feet, along: DVec3::X };
        }
        Self { center, feet, along: (across / apart).extend(0.0) }
    }

    /// Horizontal, to the left of the line.
    pub(super) fn sideways(&self) -> DVec3 {
        DVec3::Z.cross(self.along)
    }

    /// `[height above the middle, sideways, beyond the first foot, before the second]`.
    pub(super) fn rows(&self) -> [f64; 4] {
        let [first, second] = self.feet;
        let above = self.center.z - 0.5 * (first.z + second.z);
        let from_first = self.center - first;
        let beyond = self.along.dot(from_first);
        [above, self.sideways().dot(from_first), beyond, self.along.dot(second - self.center)]
    }
}

/// Number of rows: three, and one for the height where it is given.
#[must_use]
pub fn dimension(balance: &CentreOfMassBetween) -> usize {
    3 + usize::from(balance.height.is_some())
}

/// The rows `[c_z − mid_z − height, sideways, c·u − first·u, second·u − c·u]`, without the first where the height is free;
/// metres. The last two are inequalities.
///
/// # Panics
/// If a slice is too short.
pub fn value(balance: &CentreOfMassBetween, X_WJ: &[Pose], values: &mut [f64]) {
    let rows = Stance::new(balance, X_WJ).rows();
    let all = balance.height.map(|height| rows[0] - height).into_iter().chain(rows[1..].iter().copied());
    values.iter_mut().zip(all).for_each(|(value, row)| *value = row);
}
