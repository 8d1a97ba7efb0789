//! What members exchange: leaves that one of them has reached, with the certified ways to them.
//!
//! Every member posts into a queue of its own at the end of its work. Between two rounds the queues are emptied in the order
//! of the members, so what a member adopts, and which ids it gives it, depends on counted work alone. A member that has adopted a
//! branch extends it, aims at it and connects to it like its own.

use crate::portfolio::rooted::{Rooted, other_end};
use bevy_ecs::prelude::{Mut, Resource, World};
use crossbeam_channel::{Receiver, Sender, unbounded};
use foliate_components::graph::leaf::{Leaf, LeafId, LeafIndex, Parameter, ParameterId};
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::roadmap::{EdgeId, Motion, NodeId, Roadmap};
use foliate_systems::exploration::roadmap_query::roadmap_in;
use foliate_systems::exploration::roots::{GivenRoots, Roots};
use foliate_systems::exploration::writer;
use std::collections::{HashMap, HashSet};

/// Where a node or a parameter was created: ids differ from member to member, this does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Origin {
    world: u32,
    id: u32,
}

/// The origin of what all have from the beginning: start, goals and their leaves.
const COMMON: u32 = u32::MAX;

/// The ids of a member by origin and back.
#[derive(Debug, Default)]
struct Register {
    origins: Vec<Origin>,
    here: HashMap<Origin, u32>,
}

impl Register {
    fn common(count: usize) -> Self {
        let mut register = Self::default();
        register.fill(COMMON, count);
        register
    }

    /// What has no origin yet was created in `world`.
    fn fill(&mut self, world: u32, count: usize) {
        for id in self.origins.len() as u32..count as u32 {
            self.add(Origin { world, id });
        }
    }

    fn add(&mut self, origin: Origin) {
        self.here.insert(origin, self.origins.len() as u32);
        self.origins.push(origin);
    }
}

/// A leaf in a form that all members understand.
#[derive(Debug)]
struct PostedLeaf {
    state: StateId,
    parameters: Vec<(Origin, Parameter)>,
}

/// A node on the way to a leaf.
#[derive(Debug)]
struct PostedNode {
    origin: Origin,
    q: Vec<f64>,
    /// Of a goal that was given with fingers elsewhere: the configuration as it was given.
    given: Option<Vec<f64>>,
    leaf: PostedLeaf,
    /// How it was reached; `None` for a goal that was drawn during the search.
    way: Option<Way>,
}

/// An edge in a form that all members understand.
#[derive(Debug)]
struct Way {
    /// The node at its other end, which is nearer to the root.
    from: Origin,
    /// Whether its motions lead away from the root.
    outwards: bool,
    along: TransitionId,
    motions: Vec<(PostedLeaf, Motion)>,
}

/// A leaf that a tree has reached for the first time in some member: the nodes on the way there from the start or a goal, as
/// far as the others do not have them.
#[derive(Debug)]
pub struct Branch(Vec<PostedNode>);

/// A world's part in the exchange.
#[derive(Debug, Resource)]
pub struct Correspondence {
    /// The number of the world.
    number: u32,
    outbox: Sender<Branch>,
    nodes: Register,
    parameters: Register,
    told: Told,
}

/// Which leaves and nodes the others have been told of.
#[derive(Debug, Default)]
struct Told {
    rooted: Rooted,
    nodes: Vec<bool>,
    /// Leaves by the root of the tree that has reached them; only asked, never walked through.
    leaves: HashSet<(NodeId, LeafId)>,
}

impl Correspondence {
    /// Opens the correspondence of a world that has nothing but its roots, and its queue.
    pub fn open(world: &mut World, number: u32) -> Receiver<Branch> {
        let (outbox, queue) = unbounded();
        let nodes = Register::common(roadmap_in(world).nodes().len());
        let parameters = Register::common(world.resource::<LeafIndex>().parameters().len());
        let mut this = Self { number, outbox, nodes, parameters, told: Told::default() };
        // The others begin with the same roots.
        this.untold(world);
        world.insert_resource(this);
        queue
    }

    /// Gives an origin to whatever has been born in this world.
    fn register(&mut self, world: &World) {
        self.nodes.fill(self.number, roadmap_in(world).nodes().len());
        self.parameters.fill(self.number, world.resource::<LeafIndex>().parameters().len());
    }

    /// The branches that the others have not been told of; they count as told from now on.
    fn untold(&mut self, world: &World) -> Vec<Branch> {
        self.register(world);
        let mut told = std::mem::take(&mut self.told);
        let branches = self.branches(world, &mut told);
        self.told = told;
        branches
    }

    /// Everything there is to tell, for one who knows nothing but the common roots.
    fn all(&mut self, world: &World) -> Vec<Branch> {
        self.register(world);
        self.branches(world, &mut Told::default())
    }

    fn branches(&self, world: &World, told: &mut Told) -> Vec<Branch> {
        let roadmap = roadmap_in(world);
        let common = |&node: &usize| self.nodes.origins[node].world == COMMON;
        told.nodes.extend((told.nodes.len()..roadmap.nodes().len()).map(|node| common(&node)));
        let mut branches = Vec::new();
        for node in told.rooted.grow(roadmap, world.resource::<Roots>()) {
            let reached = (told.rooted.root(node), roadmap.node(node).leaf);
            if told.leaves.insert(reached) && !told.nodes[node.at()] {
                branches.push(self.branch(world, told, node));
            }
        }
        branches
    }

    /// The way to a node, from the first node that the others do not have.
    fn branch(&self, world: &World, told: &mut Told, mut node: NodeId) -> Branch {
        let (roadmap, leaves) = (roadmap_in(world), world.resource::<LeafIndex>());
        let given = world.resource::<GivenRoots>();
        let mut nodes = Vec::new();
        while !std::mem::replace(&mut told.nodes[node.at()], true) {
            let edge = told.rooted.edge(node);
            nodes.push(PostedNode {
                origin: self.nodes.origins[node.at()],
                q: roadmap.configuration(node).to_vec(),
                given: given.of(node).map(<[f64]>::to_vec),
                leaf: self.posted(leaves, roadmap.node(node).leaf),
                way: edge.map(|edge| self.way(roadmap, leaves, edge, node)),
            });
            let Some(edge) = edge else { break };
            node = other_end(roadmap, edge, node);
        }
        nodes.reverse();
        Branch(nodes)
    }

    fn way(&self, roadmap: Roadmap<'_>, leaves: &LeafIndex, edge: EdgeId, node: NodeId) -> Way {
        let row = roadmap.edge(edge);
        let motions = roadmap.motions_of(edge).iter();
        let motions = motions.map(|motion| (self.posted(leaves, motion.leaf), motion.clone())).collect();
        let from = self.nodes.origins[other_end(roadmap, edge, node).at()];
        Way { from, outwards: row.to == node, along: row.along, motions }
    }

    fn posted(&self, leaves: &LeafIndex, leaf: LeafId) -> PostedLeaf {
        let leaf = leaves.leaf(leaf);
        let posted = |&id: &ParameterId| (self.parameters.origins[id.at()], *leaves.parameter(id));
        PostedLeaf { state: leaf.state, parameters: leaf.parameters.iter().map(posted).collect() }
    }

    fn adopt(&mut self, world: &mut World, branch: &Branch) {
        self.register(world);
        for posted in &branch.0 {
            if self.nodes.here.contains_key(&posted.origin) {
                continue;
            }
            let leaf = self.local(world, &posted.leaf);
            match &posted.way {
                Some(way) => {
                    let Some(&from) = self.nodes.here.get(&way.from) else { return };
                    let motions = way.motions.iter().map(|(leaf, motion)| (self.local(world, leaf), motion.clone()));
                    let motions = motions.collect();
                    writer::add_branch(world, (NodeId(from), way.along, way.outwards), &posted.q, leaf, motions);
                }
                None => {
                    let first_goal = world.resource::<Roots>().goals.first().copied();
                    let root = writer::add_root(world, &posted.q, leaf, first_goal);
                    world.resource_mut::<Roots>().goals.push(root);
                    let given = posted.given.clone().map(|given| (root, given));
                    world.resource_mut::<GivenRoots>().0.extend(given);
                }
            }
            self.nodes.add(posted.origin);
            self.told.nodes.resize(self.nodes.origins.len(), true);
        }
    }

    fn local(&mut self, world: &mut World, leaf: &PostedLeaf) -> Leaf {
        let mut index = world.resource_mut::<LeafIndex>();
        let local = |&(origin, value): &(Origin, Parameter)| match self.parameters.here.get(&origin) {
            Some(&id) => ParameterId(id),
            None => {
                self.parameters.add(origin);
                index.add_parameter(value)
            }
        };
        Leaf { state: leaf.state, parameters: leaf.parameters.iter().map(local).collect() }
    }
}

/// Posts the leaves that the member has reached since the last call.
pub fn post_reached_leaves(world: &mut World) {
    world.resource_scope(|world, mut correspondence: Mut<'_, Correspondence>| {
        for branch in correspondence.untold(world) {
            // A closed receiver needs no branch.
            let _ = correspondence.outbox.send(branch);
        }
    });
}

/// All that a member could post to one that has just entered.
pub fn all_branches(world: &mut World) -> Vec<Branch> {
    world.resource_scope(|world, mut correspondence: Mut<'_, Correspondence>| correspondence.all(world))
}

/// Takes over a branch of another world.
pub fn adopt(world: &mut World, branch: &Branch) {
    world.resource_scope(|world, mut correspondence: Mut<'_, Correspondence>| correspondence.adopt(world, branch));
}
