//! Two trees on a leaf that grow from both ends of a motion and connect greedily.

use crate::step::local_planner::leaf_space::{Extension, LeafScratch, LeafSpace, MotionAttempt};
use crate::step::local_planner::sampling;
use crate::step::local_planner::tree::Tree;
use foliate_components::roadmap::{Motion, NodeId};
use foliate_kernels::collision::TestOrder;
use rand::Rng;

/// A tree grows towards a local draw by at most so much, weighted metres, or by this share of the distance between the ends if that is more:
/// about as far as a hand moves when one joint of an arm turns by a radian, or farther where a base has to drive.
const STEP: f64 = 1.0;
const STEP_SHARE: f64 = 0.75;

/// So often a blocked motion is turned aside.
const MAX_RETRACTIONS: usize = 3;

/// What is turned aside has to come so far, weighted metres.
const MIN_PROGRESS: f64 = 0.02;

/// What has grown so far between two configurations of a leaf.
#[derive(Clone, Debug, Default)]
pub struct LocalPlan {
    trees: [Tree; 2],
    /// Which pairs blocked motions last.
    order: TestOrder,
    /// Work that was done: motions that were tried, long ones on implicit rows several times.
    pub work: u64,
    /// What became of the motions that the last growth tried.
    pub attempts: Vec<MotionAttempt>,
}

/// How far a tree has been extended.
struct Reached {
    vertex: u32,
    /// Whether it is where the tree was to be extended to.
    arrives: bool,
}

/// A certified motion between two nodes of the roadmap on one leaf.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedMotion {
    /// Where it begins.
    pub from: NodeId,
    /// Where it ends.
    pub to: NodeId,
    /// The motion.
    pub motion: Motion,
}

impl LocalPlan {
    /// Trees from two nodes on the leaf.
    #[must_use]
    pub fn between(ends: [(NodeId, &[f64]); 2]) -> Self {
        let trees = ends.map(|(node, q)| {
            let mut tree = Tree::default();
            tree.add_node(node, q);
            tree
        });
        Self { trees, order: TestOrder::default(), work: 0, attempts: Vec::new() }
    }

    /// Lets the trees grow until about so much work is done. `ends` are the configurations between which the motion is wanted.
    pub fn grow(
        &mut self,
        leaf: &LeafSpace<'_>,
        ends: (&[f64], &[f64]),
        budget: u64,
        rng: &mut impl Rng,
        scratch: &mut LeafScratch,
    ) -> Option<PlannedMotion> {
        scratch.work = 0;
        scratch.attempts.clear();
        std::mem::swap(&mut scratch.order, &mut self.order);
        let step = STEP.max(leaf.distance(ends.0, ends.1) * STEP_SHARE);
        let mut meeting = None;
        while meeting.is_none() && scratch.work < budget {
            // The smaller tree grows, the other one connects.
            let growing = usize::from(self.trees[1].len() < self.trees[0].len());
            // A draw that cannot be projected is work, too.
            scratch.work += 1;
            let drawn = sampling::draw(leaf, ends, self.work + scratch.work, rng, scratch);
            meeting = drawn.and_then(|draw| {
                let step = if draw.is_local { step } else { f64::INFINITY };
                self.grow_towards(leaf, (growing, step), &draw.q, scratch)
            });
        }
        std::mem::swap(&mut scratch.order, &mut self.order);
        self.work += scratch.work;
        self.attempts.clone_from(&scratch.attempts);
        self.planned(leaf, meeting?)
    }

    /// Extends a tree towards a configuration, and the other one to where that leads. Where they meet, the vertex of each.
    fn grow_towards(
        &mut self,
        leaf: &LeafSpace<'_>,
        (growing, step): (usize, f64),
        q: &[f64],
        scratch: &mut LeafScratch,
    ) -> Option<[u32; 2]> {
        let Reached { vertex: new, .. } = self.extend(leaf, growing, q, step, scratch)?;
        let q = self.trees[growing].configuration(new, q.len()).to_vec();
        let Reached { vertex: other, arrives } = self.extend(leaf, 1 - growing, &q, f64::INFINITY, scratch)?;
        arrives.then_some(if growing == 0 { [new, other] } else { [other, new] })
    }

    /// Extends a tree from its nearest vertex towards a configuration, by a weighted distance of at most `step`, and aside where
    /// something is in the way.
    fn extend(
        &mut self,
        leaf: &LeafSpace<'_>,
        tree: usize,
        q: &[f64],
        step: f64,
        scratch: &mut LeafScratch,
    ) -> Option<Reached> {
        let (size, space) = (q.len(), &leaf.model.problem.robot.space);
        let tree = &mut self.trees[tree];
        let near = tree.nearest(q, space, &leaf.model.robot_weights);
        let from = tree.configuration(near, size);
        let far = leaf.distance(from, q);
        let mut target = q.to_vec();
        if far > step {
            space.interpolate(from, q, step / far, &mut target);
            if !leaf.project(&mut target, scratch) {
                return None;
            }
        }
        let motion = leaf.extend(from, &target, scratch)?;
        let (arrives, mut blocked_by) = (motion.arrives, motion.blocked_by);
        let mut vertex = tree.add(near, motion, size);
        for _ in 0..MAX_RETRACTIONS {
            let Some(pair) = blocked_by else { break };
            let here = tree.configuration(vertex, size);
            let Some(aside) = leaf.retract(here, &target, pair, scratch) else { break };
            let Some(motion) = leaf.extend(here, &aside, scratch) else { break };
            if leaf.distance(here, motion.end(size)) < MIN_PROGRESS {
                break;
            }
            blocked_by = motion.blocked_by;
            vertex = tree.add(vertex, motion, size);
        }
        Some(Reached { vertex, arrives })
    }

    /// The motion through the vertices at which the trees meet.
    fn planned(&self, leaf: &LeafSpace<'_>, meeting: [u32; 2]) -> Option<PlannedMotion> {
        let size = leaf.model.problem.robot.space.size();
        let [(from, out), (to, back)] = [0, 1].map(|tree| self.trees[tree].path_to(meeting[tree]));
        let mut knots: Vec<f64> = Vec::new();
        let mut append = |more: &[f64]| {
            let start = if knots.is_empty() { 0 } else { size };
            knots.extend_from_slice(&more[start..]);
        };
        out.iter().for_each(|motion| append(&motion.knots));
        for motion in back.iter().rev() {
            let backwards: Vec<f64> = motion.knots.chunks_exact(size).rev().flatten().copied().collect();
            append(&backwards);
        }
        let all = || out.iter().chain(&back);
        let least = |bound: fn(&Extension) -> f64| all().map(|motion| bound(motion)).fold(f64::INFINITY, f64::min);
        let motion = Motion {
            transition: leaf.transition,
            leg: 0,
            leaf: leaf.leaf,
            knots,
            clearance: least(|motion| motion.clearance),
            residual: all().map(|motion| motion.residual).fold(0.0, f64::max),
        };
        Some(PlannedMotion { from: from?, to: to?, motion })
    }

    /// About how much memory it takes, bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.trees.iter().map(Tree::bytes).sum::<u64>() + self.order.bytes()
    }
}
