//! Once start and goal are connected: stretches of the path on which an object is taken hold of more often than it seems to need.
//!
//! The first sequence that holds may put an object down on the way and take it by another handle, or put it down in the way of
//! the next and move it once more. Where an object changes hands more often along a stretch than [`GraspDistance`] says is needed from
//! its first leaf to its last, another search from the one to the other may find a way with fewer changes. It keeps to a
//! [`Corridor`]: it draws nothing that leads to as many. So it is small: mostly it tries the grasps of one object between two
//! placements.
//!
//! [`GraspDistance`]: crate::heuristic::grasp_distance::GraspDistance

use crate::exploration::entities::{EntityTable, Weight};
use crate::exploration::roadmap_query::roadmap_in;
use crate::exploration::roots::Roots;
use crate::exploration::writer::{Born, add_edge, add_node, add_root, intern_leaf, spawn_graph};
use crate::heuristic::corridor::Corridor;
use crate::heuristic::leaf_heuristic::LeafHeuristic;
use crate::planning_model::model::PlanningModel;
use crate::search::path_extraction::route;
use bevy_ecs::prelude::{Mut, World};
use foliate_components::Pose;
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::roadmap::{EdgeId, Motion, NodeId, Roadmap};
use foliate_components::robot::JointIndex;
use foliate_kernels::collision::{PairId, surely_colliding};

/// Changes of grasp of a stretch at most: longer ones are whole problems of their own.
const LONGEST: u16 = 12;

/// Part of a path that may need fewer grasps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Stretch {
    from: NodeId,
    to: NodeId,
    /// Changes of grasp along it.
    pub changes: u16,
}

/// The path as the estimate sees it.
struct Changes<'a> {
    model: &'a PlanningModel,
    roadmap: Roadmap<'a>,
    leaves: &'a LeafIndex,
    heuristic: &'a LeafHeuristic,
    /// Where the path comes to another leaf: the nodes on both sides, and what changes there, by subject.
    at: Vec<([NodeId; 2], Vec<u16>)>,
}

/// The stretches of the path that may need fewer grasps, those with the fewest changes first, of these the first.
pub(crate) fn stretches(world: &mut World) -> Vec<Stretch> {
    world.resource_scope(|world, mut heuristic: Mut<'_, LeafHeuristic>| {
        let model = world.resource::<PlanningModel>();
        heuristic.distance.grow(&model.graph);
        let (roadmap, roots) = (roadmap_in(world), world.resource::<Roots>());
        let Some((start, goal)) = roots.start.zip(roots.reached_goal(roadmap)) else { return Vec::new() };
        let leaves = world.resource::<LeafIndex>();
        let mut changes = Changes { model, roadmap, leaves, heuristic: &heuristic, at: Vec::new() };
        for pair in route(model, roadmap, start, goal).windows(2) {
            if roadmap.node(pair[0]).leaf != roadmap.node(pair[1]).leaf {
                changes.at.push(([pair[0], pair[1]], changes.between(pair[0], pair[1])));
            }
        }
        let mut found: Vec<Stretch> = Vec::new();
        // A door that is opened for an object and closed behind it has to be taken hold of twice.
        let movable = (0..).zip(model.objects()).filter_map(|(object, entry)| Some((object, entry.root?)));
        for (object, root) in movable {
            if let Some(subject) = heuristic.distance.subject_of_object(object) {
                found.extend(changes.of_object(subject, root));
            }
        }
        found.sort_by_key(|stretch| stretch.changes);
        found
    })
}

impl Changes<'_> {
    /// By subject: changes of grasp that are needed between two nodes.
    fn between(&self, a: NodeId, b: NodeId) -> Vec<u16> {
        let leaf = |node: NodeId| self.leaves.leaf(self.roadmap.node(node).leaf);
        self.heuristic.distance.of_each_subject(&self.model.graph, leaf(a), leaf(b)).collect()
    }

    /// The stretches on which an object changes hands twice more than it needs to, each as far as it reaches without more
    /// than that.
    fn of_object(&self, subject: usize, root: JointIndex) -> Vec<Stretch> {
        let own: Vec<usize> = (0..self.at.len()).filter(|&change| self.at[change].1[subject] > 0).collect();
        let ends = |first: usize, last: usize| (self.at[own[first]].0[0], self.at[own[last]].0[1]);
        let excess = |first: usize, last: usize| {
            let taken: u16 = own[first..=last].iter().map(|&change| self.at[change].1[subject]).sum();
            let (from, to) = ends(first, last);
            taken.saturating_sub(self.between(from, to)[subject])
        };
        let mut found = Vec::new();
        for first in 0..own.len() {
            let Some(shortest) = (first + 1..own.len()).find(|&last| excess(first, last) > 1) else { break };
            let least = excess(first, shortest);
            let last = (shortest + 1..own.len()).take_while(|&last| excess(first, last) == least).last();
            let last = last.unwrap_or(shortest);
            if first > 0 && excess(first - 1, last) == least {
                continue;
            }
            let (from, to) = ends(first, last);
            let along = &self.at[own[first]..=own[last]];
            let changes = along.iter().flat_map(|(_, of)| of).sum();
            let is_alone = along.len() == last - first + 1;
            if changes <= LONGEST && (is_alone || !self.is_in_the_way(root, (from, to))) {
                found.push(Stretch { from, to, changes });
            }
        }
        found
    }

    /// Whether an object that is moved at once from where it is before a stretch to where it is behind it is in the way of others:
    /// at the beginning there, and at the end here. Then it has to be put aside, as where two objects change places.
    fn is_in_the_way(&self, object: JointIndex, (from, to): (NodeId, NodeId)) -> bool {
        let roots: Vec<JointIndex> = self.model.objects().iter().filter_map(|other| other.root).collect();
        let poses = |node: NodeId| self.model.kinematics.poses(self.roadmap.configuration(node));
        let (before, behind) = (poses(from), poses(to));
        let scene = &self.model.collision;
        let body = |cluster: u32| scene.clusters()[cluster as usize].body;
        let is_against_others = |first: Option<JointIndex>, second: Option<JointIndex>| {
            first == Some(object) && second.is_some_and(|other| roots.contains(&other))
        };
        let overlaps = |others: &[Pose], own: &[Pose]| {
            let mut X_WJ = others.to_vec();
            X_WJ[object.at()] = own[object.at()];
            let groups = scene.groups().iter().filter(|group| {
                let (first, second) = (body(group.first), body(group.second));
                is_against_others(first, second) || is_against_others(second, first)
            });
            groups
                .flat_map(|group| group.start..group.end)
                .any(|pair| surely_colliding(scene, PairId(pair), &X_WJ).is_some())
        };
        overlaps(&before, &behind) && overlaps(&behind, &before)
    }
}

/// Makes the empty world of another search ready to look for a way with fewer changes of grasp than a stretch has.
pub(crate) fn look_for_fewer(world: &World, stretch: Stretch, other: &mut World) {
    let (roadmap, leaves) = (roadmap_in(world), world.resource::<LeafIndex>());
    other.insert_resource(leaves.without_leaves());
    let ours = &world.resource::<EntityTable>().transitions;
    let theirs = other.resource::<EntityTable>().transitions.clone();
    for (&ours, theirs) in ours.iter().zip(theirs) {
        if let Some(&weight) = world.get::<Weight>(ours) {
            other.entity_mut(theirs).insert(weight);
        }
    }
    let leaf = |node: NodeId| leaves.leaf(roadmap.node(node).leaf).clone();
    let (from, to) = (leaf(stretch.from), leaf(stretch.to));
    let start = add_root(other, roadmap.configuration(stretch.from), from.clone(), None);
    let goal = add_root(other, roadmap.configuration(stretch.to), to.clone(), None);
    other.insert_resource(Roots { start: Some(start), goals: vec![goal] });
    let most = stretch.changes.saturating_sub(1);
    other.resource_mut::<LeafHeuristic>().corridor = Some(Corridor { from, to, most });
}

/// Takes the way that another search has found for a stretch into the roadmap.
pub(crate) fn adopt(world: &mut World, stretch: Stretch, other: &World) {
    let (roadmap, roots, leaves) = (roadmap_in(other), other.resource::<Roots>(), other.resource::<LeafIndex>());
    let Some((start, goal)) = roots.start.zip(roots.reached_goal(roadmap)) else { return };
    let model = other.resource::<PlanningModel>();
    if model.graph.lazy {
        // Its graph is the one here and what has come into being since.
        world.insert_resource(model.clone());
        spawn_graph(world);
    }
    let mut index = world.resource_mut::<LeafIndex>();
    for &parameter in &leaves.parameters()[index.parameters().len()..] {
        index.add_parameter(parameter);
    }
    let mut before = stretch.from;
    for pair in route(model, roadmap, start, goal).windows(2) {
        let leads_on = |edge: &EdgeId| [roadmap.edge(*edge).from, roadmap.edge(*edge).to].contains(&pair[1]);
        let Some(edge) = roadmap.edges_at(pair[0]).find(leads_on) else { return };
        let next = if pair[1] == goal {
            stretch.to
        } else {
            let leaf = intern_leaf(world, leaves.leaf(roadmap.node(pair[1]).leaf).clone());
            add_node(world, roadmap.configuration(pair[1]), leaf, Born::InTreeOf(before))
        };
        let mut here = |motion: &Motion| {
            let leaf = intern_leaf(world, leaves.leaf(motion.leaf).clone());
            Motion { leaf, ..motion.clone() }
        };
        let motions = roadmap.motions_of(edge).iter().map(&mut here).collect();
        let row = roadmap.edge(edge);
        let ends = if row.from == pair[0] { (before, next) } else { (next, before) };
        add_edge(world, ends, row.along, motions);
        before = next;
    }
}
