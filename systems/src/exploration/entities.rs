//! The entities of a search's world by dense id, the nodes that are new in it, and the weights of transitions.

use bevy_ecs::prelude::{Component, Entity, Resource};
use foliate_components::roadmap::NodeId;

/// Entities by dense id, for the commit's own use.
#[derive(Clone, Debug, Default, Resource)]
pub struct EntityTable {
    /// By transition.
    pub transitions: Vec<Entity>,
    /// By state.
    pub states: Vec<Entity>,
    /// By leaf.
    pub leaves: Vec<Entity>,
    /// By candidate.
    pub candidates: Vec<Entity>,
}

/// Nodes that have been added since connections were last proposed.
#[derive(Clone, Debug, Default, Resource)]
pub struct NewNodes(pub Vec<NodeId>);

/// The weight by which a transition is drawn; on the transition's entity, so that a host's system may change it.
#[derive(Clone, Copy, Debug, PartialEq, Component)]
pub struct Weight(pub f64);

/// Weights by transition, gathered at the start of every step.
#[derive(Clone, Debug, Default, Resource)]
pub struct TransitionWeights(pub Vec<f64>);
