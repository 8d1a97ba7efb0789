//! Candidates: extensions under way. A fixed pool of them is spawned once; systems change their fields.

use crate::graph::leaf::{LeafId, Parameter, ParameterId};
use crate::graph::{StateId, TransitionId};
use crate::outcome::Rejection;
use crate::roadmap::{NodeId, TreeId};
use crate::robot::indices::ShapeIndex;

/// One extension: which node, along which transition, towards which leaf, and how far it has come.
///
/// A scheduler's own `Select` system writes `near` and `transition` (and may leave `rejected` set to drop the candidate);
/// everything behind it follows from these.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct Candidate {
    /// Number in the pool; the commit goes by it, and the random stream is keyed by it.
    pub index: u32,
    /// The tree that is extended.
    pub tree: Option<TreeId>,
    /// The node that is extended (q_near).
    pub near: Option<NodeId>,
    /// The transition that is tried (T).
    pub transition: Option<TransitionId>,
    /// The leaf to extend, where one is chosen before the node.
    pub leaf: Option<LeafId>,
    /// Where it is guided: the leaf of another tree that it aims at.
    pub target_leaf: Option<LeafId>,
    /// For a crossed transition: the leaf of another tree that gives the values of the rows that the transition adds.
    pub drawn: Option<LeafId>,
    /// Whether its waypoints have passed the exact verdict of all pairs.
    pub waypoints_are_free: bool,
    /// Why it is rejected.
    pub rejected: Option<Rejection>,
    /// What Commit makes of it.
    pub commit_as: CommitAs,
    /// The pair of shapes that stopped it.
    pub blocked_by: Option<(ShapeIndex, ShapeIndex)>,
    /// Where the search keeps a log: the configuration at which that pair was found too close.
    pub blocked_at: Option<Box<[f64]>>,
}

/// What Commit adds to the roadmap for a candidate. Set by the scheduler, between Select and Project.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CommitAs {
    /// A node where its certified legs end, joined to the near node by an edge.
    #[default]
    Extension,
    /// Two trees on the near node's search side, for a lazy search. The first leg is left out and not certified: its end is the
    /// root of one tree, the end of the legs behind it the root of the other. Between the two is an
    /// [`UnvalidatedEdge`](crate::roadmap::UnvalidatedEdge). Requires that the first leg lies on the near node's leaf.
    DetachedTrees,
}

impl CommitAs {
    /// Whether Validate has to certify its legs.
    #[must_use]
    pub fn needs_certificate(self) -> bool {
        self == Self::Extension
    }
}

impl Candidate {
    /// Whether it is still under way.
    #[must_use]
    pub fn is_alive(&self) -> bool {
        self.rejected.is_none()
    }

    /// Whether steering lost its leaf on the way: what there is of its legs up to there may still be kept.
    #[must_use]
    pub fn is_cut_short(&self) -> bool {
        matches!(self.rejected, Some(Rejection::SteeringFailed(_)))
    }

    /// Drops it for a reason; the first reason stays.
    pub fn reject(&mut self, reason: Rejection) {
        self.rejected.get_or_insert(reason);
    }

    /// Makes it ready for the next step.
    pub fn reset(&mut self) {
        *self = Self { index: self.index, ..Self::default() };
    }
}

/// The value of a foliating constraint along a leg: known to the leaf index, or found by this very candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LegParameter {
    /// Interned already.
    Known(ParameterId),
    /// Found by a projection; interned when the candidate is committed.
    Fresh(Parameter),
}

/// One leg of a candidate: where objects are attached along it, and its knots.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedLeg {
    /// Number of the leg within the transition.
    pub leg: u32,
    /// State in which it lies.
    pub state: StateId,
    /// One per foliating constraint of that state.
    pub parameters: Vec<LegParameter>,
    /// Whole configurations, end to end; at least two once steered, and one in a leg that only enters the target.
    pub knots: Vec<f64>,
    /// Proven clearance beyond the margins, metres.
    pub clearance: f64,
    /// Proven bound of the residual of implicit rows.
    pub residual: f64,
}

/// The bulk numbers of the candidates, one slot each.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Resource))]
pub struct CandidateArena {
    /// Random configurations (q_rand), `size` numbers per candidate.
    pub random: Vec<f64>,
    /// Planned legs per candidate; after validation only what is certified.
    pub legs: Vec<Vec<PlannedLeg>>,
    /// Whether all legs of the transition are there, certified where they need to be (else a prefix).
    pub complete: Vec<bool>,
    size: usize,
}

impl CandidateArena {
    /// Room for `count` candidates of configurations with `size` numbers.
    #[must_use]
    pub fn new(count: usize, size: usize) -> Self {
        Self { random: vec![0.0; count * size], legs: vec![Vec::new(); count], complete: vec![false; count], size }
    }

    /// Length of a configuration.
    #[must_use]
    pub fn configuration_size(&self) -> usize {
        self.size
    }

    /// A candidate's random configuration.
    #[must_use]
    pub fn random_of(&self, candidate: u32) -> &[f64] {
        &self.random[candidate as usize * self.size..][..self.size]
    }
}
