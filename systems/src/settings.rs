//! What a user may change about a search. Each field states its meaning and unit; defaults serve every shipped scene.

use bevy_ecs::prelude::Resource;
use foliate_components::problem::{PROJECTION_TOLERANCE, Problem};
use foliate_kernels::lanes::Level;

/// How a node to extend is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Selection {
    /// As `LeafFirst` for some candidates; the others ([`SearchSettings::guided_probability`]) take a leaf that is few grasps
    /// from what another tree has reached, and a transition that leads towards it ([`crate::heuristic::leaf_heuristic`]).
    #[default]
    Guided,
    /// A tree, then one of the states it has reached, one of the leaves in it, and the node of that leaf nearest to q_rand;
    /// all but the node uniformly. Nodes crowd on few leaves and leaves in few states, so this spreads effort over what
    /// matters: who holds what, and where objects are.
    LeafFirst,
    /// A tree, then one of the states it has reached, then the node of that state nearest to q_rand (HPP's M-RRT).
    StateFirst,
    /// The node nearest to q_rand in the whole roadmap (P1 §III-A step 2).
    Nearest,
}

/// Settings of a search. Take the defaults and change what differs: [`Self::with`].
#[derive(Clone, Debug, PartialEq, Resource)]
#[non_exhaustive]
pub struct SearchSettings {
    /// Seed of every random stream.
    pub seed: u64,
    /// B: candidates per step. Part of the problem's answer, so never derived from the number of threads.
    pub candidates: usize,
    /// Steps after which the search gives up; 0 for no limit.
    pub max_steps: u64,
    /// Roadmap nodes after which the search gives up, a bound on memory.
    pub max_nodes: usize,
    /// Bytes of the roadmap ([`RoadmapStore::bytes`](foliate_components::roadmap::RoadmapStore::bytes)), of a lazy graph
    /// ([`ConstraintGraph::bytes`](foliate_components::graph::ConstraintGraph::bytes)) and of what was compiled of it
    /// ([`Model::bytes_to_try`](crate::planning_model::model::Model::bytes_to_try)), after which the search gives up: motions with implicit
    /// rows have many knots, so that nodes alone bound nothing.
    pub max_bytes: u64,
    /// How a node to extend is chosen.
    pub selection: Selection,
    /// Of a guided selection: probability that a candidate is guided.
    pub guided_probability: f64,
    /// Loops, motions that stay in their state, are drawn with their weight times this.
    pub loop_weight: f64,
    /// Probability that coordinates on which a waypoint does not depend stay where they are instead of moving to q_rand: an
    /// arm that has nothing to do with a grasp then keeps still.
    pub still_probability: f64,
    /// A new node is tried against this many nodes of its leaf in each other tree, nearest first.
    pub connect_neighbours: usize,
    /// Residual at which a projection has converged, metres and radians (largest row); the problem may say a larger one
    /// ([`Problem::projection_tolerance`]).
    pub projection_tolerance: f64,
    /// Newton iterations per projection.
    pub projection_iterations: u32,
    /// Instructions with which lanes work. Part of the answer: results are equal bit for bit only at one level.
    pub level: Level,
    /// Bound that residuals keep between knots, metres and radians.
    pub path_tolerance: f64,
    /// Clearance required beyond every margin, metres: allows for the rounding of other checkers.
    pub clearance_guard: f64,
    /// How close to the truth the end of a blocked motion's valid prefix has to be, as a share of the motion. What ends well
    /// in front of an obstacle is quicker to prove and a better place to go on from.
    pub prefix_resolution: f64,
    /// Residual at which a given start or goal counts as lying in a state, metres and radians.
    pub classification_tolerance: f64,
    /// How many configurations to look for at once where a goal leaves something free.
    pub goal_samples: usize,
    /// Tries for such a goal after which, with no goal found at all, the search ends as infeasible.
    pub goal_tries: u32,
    /// Steps after which as many more configurations are looked for, since the first may be out of reach; then after twice as
    /// many, and so on. 0 for never.
    pub goal_interval: u64,
    /// Steps in which stretches of a first path are planned again that seem to need fewer grasps, as a share of the steps of the
    /// search; 0 for none. Schedulers that ask for it do so ([`PlanAgain`](crate::search::PlanAgain)).
    pub regrasp_share: f64,
    /// Steps between two reports of feedback to the host; 0 for one at the end only.
    pub feedback_interval: u64,
    /// Keeps a log for a recording of the search ([`SearchLog`](crate::exploration::search_log::SearchLog)). No part of the answer.
    pub log: bool,
}

impl SearchSettings {
    /// These settings with changes:
    ///
    /// ```
    /// # use foliate_systems::settings::SearchSettings;
    /// let settings = SearchSettings::default().with(|s| s.max_steps = 1000);
    /// # assert_eq!(settings.max_steps, 1000);
    /// ```
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    /// These settings for a problem: constraints are met no more exactly than it asks.
    #[must_use]
    pub fn for_problem(self, problem: &Problem) -> Self {
        let tolerance = self.projection_tolerance.max(problem.projection_tolerance);
        self.with(|s| s.projection_tolerance = tolerance)
    }
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self {
            seed: 1,
            candidates: 16,
            max_steps: 0,
            max_nodes: 2_000_000,
            max_bytes: 4 << 30,
            selection: Selection::default(),
            guided_probability: 0.5,
            loop_weight: 1.0,
            still_probability: 0.75,
            connect_neighbours: 7,
            projection_tolerance: PROJECTION_TOLERANCE,
            projection_iterations: 40,
            level: Level::detected(),
            path_tolerance: 2e-4,
            clearance_guard: 1e-5,
            prefix_resolution: 0.125,
            classification_tolerance: 1e-4,
            goal_samples: 8,
            goal_tries: 4096,
            goal_interval: 64,
            regrasp_share: 0.5,
            feedback_interval: 64,
            log: false,
        }
    }
}
