//! The changes that need no search, by kind.

use crate::improvement::changes::changed::Changed;
use crate::improvement::changes::context::{Context, ImprovementScratch};
use crate::improvement::changes::{leaf_move, limb_shortcut, shortcut, waypoint_move};
use crate::improvement::leaf_motion::LeafMotion;
use rand::Rng;

/// A change that needs no search: the path goes on through the same states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LocalChange {
    /// A straight line between two points of this motion.
    Shortcut(usize),
    /// A straight line of some coordinates, whatever the others do.
    LimbShortcut,
    /// Other configurations for the waypoints of a grasp change.
    WaypointMove,
    /// Another leaf: another place for an object that is put down on the way, or another grasp.
    LeafMove,
}

/// Counted work of a change whose configurations are projected onto implicit rows.
const PROJECTING: u64 = 8;

impl LocalChange {
    /// Tries it on a path that costs `cost`. What comes back is certified.
    pub(crate) fn attempt(
        self,
        context: &Context<'_>,
        (motions, cost): (&[LeafMotion], f64),
        rng: &mut impl Rng,
        scratch: &mut ImprovementScratch,
    ) -> Option<Changed> {
        match self {
            Self::Shortcut(index) => {
                let shorter = shortcut::attempt(context, &motions[index], rng, scratch)?;
                Some(Changed { range: index..index + 1, motions: vec![shorter] })
            }
            Self::LimbShortcut => limb_shortcut::attempt(context, motions, cost, rng, scratch),
            Self::WaypointMove => waypoint_move::attempt(context, motions, cost, rng, scratch),
            Self::LeafMove => leaf_move::attempt(context, motions, cost, rng, scratch),
        }
    }

    /// Counted work of one try.
    pub(crate) fn work(self, motions: &[LeafMotion]) -> u64 {
        let projects = match self {
            Self::Shortcut(index) => motions[index].is_implicit,
            // Implicit rows do not depend on the coordinates that it moves.
            Self::LimbShortcut => false,
            Self::WaypointMove | Self::LeafMove => motions.iter().any(|motion| motion.is_implicit),
        };
        if projects { PROJECTING } else { 1 }
    }
}
