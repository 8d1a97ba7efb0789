//! The components of roadmap edges, validated or not, and their motions.

use crate::graph::TransitionId;
use crate::graph::leaf::LeafId;
use crate::roadmap::entity_bytes::{ENTITY_BYTES, TICK_BYTES};
use crate::roadmap::ids::NodeId;

/// A validated edge: its motions are certified. It can be travelled both ways.
///
/// It never changes. The n-th edge that is validated has [`EdgeId`](crate::roadmap::EdgeId) n; a query iterates in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component), component(immutable))]
pub struct RoadmapEdge {
    /// Where its motions start.
    pub from: NodeId,
    /// Where they end.
    pub to: NodeId,
    /// Transition that it travels.
    pub along: TransitionId,
    /// Row of its first motion in the store; [`Roadmap::motions_of`](crate::roadmap::Roadmap::motions_of) reads them.
    pub first_motion: u32,
    /// How many motions follow one another.
    pub motions: u32,
}

/// An edge that is not validated yet, as in a lazy PRM (Bohlin and Kavraki, 2000): its waypoints are free and its motions lie
/// on their leaves, but nothing is certified between the waypoints.
///
/// Its entity becomes a [`RoadmapEdge`] once its motions are certified, and is despawned when they are not free.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component), component(immutable))]
pub struct UnvalidatedEdge {
    /// Where its motions start: the root of a tree.
    pub from: NodeId,
    /// Where they end: the root of another tree. No other unvalidated edge leads there.
    pub to: NodeId,
    /// Transition that it travels.
    pub transition: TransitionId,
    /// The leaf that it was aimed at, where the transition is crossed.
    pub drawn: Option<LeafId>,
    /// One for each leg, end to end; their clearance is not proven.
    pub motions: Vec<Motion>,
}

/// A motion on one leaf: a polyline of whole configurations.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Transition and leg that it travels.
    pub transition: TransitionId,
    /// Number of the leg within the transition.
    pub leg: u32,
    /// The leaf that it stays on.
    pub leaf: LeafId,
    /// Knots, `size` numbers each, at least two.
    pub knots: Vec<f64>,
    /// Proven lower bound of the clearance beyond the margins along the motion, metres.
    pub clearance: f64,
    /// Proven upper bound of the residual of implicit rows along the motion.
    pub residual: f64,
}

impl UnvalidatedEdge {
    /// About how much memory it takes, bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let knots = self.motions.iter().map(|motion| size_of_val(&*motion.knots)).sum::<usize>();
        let entity = ENTITY_BYTES + TICK_BYTES + Self::INDEX_BYTES;
        (entity + size_of::<Self>() + size_of_val(&*self.motions) + knots) as u64
    }

    /// Its place in the index by end: a node's id and an entity, in a tree whose nodes are two thirds full.
    const INDEX_BYTES: usize = (size_of::<NodeId>() + size_of::<u64>()) * 3 / 2;
}
