//! Proposals: changes of a path that are drawn, evaluated in parallel, and committed in order.

use crate::improvement::changes::local_change::LocalChange;
use crate::improvement::leaf_motion::LeafMotion;
use crate::planning_model::model::PlanningModel;
use crate::search::path_clearance::pair_counts;
use crate::search::path_extraction::proved_clearance;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Component, Resource};
use foliate_components::path::{Certificate, ManipulationPath};
use std::ops::Range;

/// The path so far.
#[derive(Clone, Debug, Resource)]
pub struct Incumbent {
    /// Its motions; each begins with the knot with which the one before ends.
    pub motions: Vec<LeafMotion>,
    /// What it costs.
    pub cost: f64,
    /// What was proven of the path that it comes from.
    pub certificate: Certificate,
}

impl Incumbent {
    /// The path of these motions.
    #[must_use]
    pub fn path(&self, model: &PlanningModel, settings: &SearchSettings) -> ManipulationPath {
        let certificate = Certificate { max_residual: 0.0, ..self.certificate };
        let segments = Vec::with_capacity(self.motions.len());
        let mut path = ManipulationPath { segments, certificate, corrections: model.snapped.clone() };
        let mut moved = 0.0_f64;
        for motion in &self.motions {
            let segment = motion.segment(model);
            let (leaf, leaves) = motion.leaf();
            let gap = model.carrier_gap(&leaf, &leaves, &segment.knots);
            path.certificate.max_residual = path.certificate.max_residual.max(motion.residual).max(gap.residual);
            moved = moved.max(gap.moved);
            path.segments.push(segment);
        }
        path.certificate.min_clearance = proved_clearance(model, settings, &path, moved);
        path.certificate.pairs = pair_counts(model, &path);
        path
    }
}

/// What a proposal tries.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Attempt {
    /// A change that needs no search.
    Local(LocalChange),
    /// Another search between the ends of these motions, of at most so many steps.
    Replan {
        /// The motions that it replaces.
        range: Range<usize>,
        /// Its budget.
        max_steps: u64,
    },
}

/// A change of the path. Number n draws from stream n of its round.
#[derive(Clone, Debug, Component)]
pub struct Proposal {
    /// Counted from 0; the order in which proposals are committed where they gain as much.
    pub number: u32,
    /// What is tried; `None` where the round has no more proposals.
    pub attempt: Option<Attempt>,
    /// What came of it.
    pub change: Option<Change>,
    /// What the attempt took: candidates and shortcuts.
    pub work: u64,
    /// Whether its search found a path.
    pub is_solved: bool,
}

/// A change that is certified.
#[derive(Clone, Debug)]
pub struct Change {
    /// What was tried.
    pub attempt: Attempt,
    /// The motions that it replaces.
    pub range: Range<usize>,
    /// What stands in their place.
    pub motions: Vec<LeafMotion>,
    /// What the path would cost with this change alone.
    pub cost: f64,
    /// The model that the motions' states and transitions are of, where its graph has grown beyond the incumbent's.
    pub model: Option<PlanningModel>,
}
