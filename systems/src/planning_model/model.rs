//! What stays the same during searches: the problem, its constraint graph, and the tables compiled from them.
//!
//! One model serves any number of searches on any number of threads. What belongs to single states and transitions is
//! compiled when it is first asked for, so that a graph with thousands of states starts at once. Where the graph is lazy,
//! every search lets a model of its own grow, which shares all but the graph with the one it started from.

use crate::planning_model::graph::attachment_order::{Carriers, grasp_of};
use crate::planning_model::graph::checks::GraphError;
use crate::planning_model::graph::lazy_graph::LazyGraph;
use crate::planning_model::graph::states::state_keys::StateKey;
use crate::planning_model::leg_program::LegProgram;
use crate::planning_model::objects::{ModelError, ObjectModel, object_models};
use crate::planning_model::problem_tables::ProblemTables;
use bevy_ecs::prelude::Resource;
use foliate_components::constraint::{Constraint, Grasp};
use foliate_components::graph::{ConstraintGraph, ConstraintId, ConstraintKind, StateId, TransitionId};
use foliate_components::problem::Problem;
use foliate_components::roadmap::{NodeId, Roadmap};
use foliate_components::robot::Source;
use foliate_kernels::collision::PairSet;
use foliate_kernels::constrained_motion::CompileError;
use std::ops::Deref;
use std::sync::{Arc, OnceLock};

/// The model as a resource of a world.
#[derive(Clone, Debug, Resource)]
pub struct PlanningModel(pub Arc<Model>);

impl Deref for PlanningModel {
    type Target = Model;

    fn deref(&self) -> &Model {
        &self.0
    }
}

impl PlanningModel {
    /// Makes the transitions that leave a state come into being, and the states that they lead to. Who shares the model
    /// keeps what it had.
    pub fn expand(&mut self, state: StateId) {
        if !self.graph.is_expanded(state) {
            Arc::make_mut(&mut self.0).expand(state);
        }
    }
}

/// See the module.
#[derive(Clone, Debug)]
pub struct Model {
    tables: Arc<ProblemTables>,
    /// The constraint graph.
    pub graph: ConstraintGraph,
    /// [`ProblemTables::weights`] with zeros for the movable objects, which are determined by leaf and robot.
    pub robot_weights: Vec<f64>,
    pub(crate) objects: Vec<ObjectModel>,
    /// What the graph grows from, where it is lazy.
    pub(crate) lazy_graph: Option<LazyGraph>,
    /// By constraint.
    grasps: Vec<Option<Grasp>>,
    pub(crate) states: Vec<Arc<StateTables>>,
    pub(crate) transitions: Vec<Arc<TransitionTables>>,
}

impl Deref for Model {
    type Target = ProblemTables;

    fn deref(&self) -> &ProblemTables {
        &self.tables
    }
}

/// What is compiled of a state. Of most states of a large graph nothing ever is: what is not there takes a word.
#[derive(Debug, Default)]
pub(crate) struct StateTables {
    pub(crate) interior: OnceLock<Box<Compiled>>,
    pub(crate) carriers: OnceLock<Box<Carriers>>,
    pub(crate) pairs: OnceLock<Box<PairSet>>,
    /// Every pair, with the margins of the state, where there are margins.
    pub(crate) verdict: OnceLock<Box<PairSet>>,
}

/// What is compiled of a transition.
#[derive(Debug, Default)]
pub(crate) struct TransitionTables {
    /// Empty until one of them is asked for.
    legs: OnceLock<Box<[LegTables]>>,
    /// Every pair, with the margins of the transition, where there are margins.
    pub(crate) verdict: OnceLock<Box<PairSet>>,
}

#[derive(Debug, Default)]
pub(crate) struct LegTables {
    pub(crate) program: OnceLock<Box<Compiled>>,
    /// Pairs of its motions, where there are margins.
    pub(crate) pairs: OnceLock<Box<PairSet>>,
}

type Compiled = Result<LegProgram, CompileError>;

impl Model {
    /// What does not depend on the graph, to be shared with other models.
    #[must_use]
    pub fn tables(&self) -> &Arc<ProblemTables> {
        &self.tables
    }

    /// Builds graph and tables. A graph of more than [`MOST_STATES`](crate::planning_model::graph::checks::MOST_STATES) states is lazy: it
    /// has no state yet.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn new(problem: Problem) -> Result<Self, ModelError> {
        Self::of(Arc::new(ProblemTables::new(problem)))
    }

    /// As [`Self::new`], where the tables of the problem are there already.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn of(tables: Arc<ProblemTables>) -> Result<Self, ModelError> {
        match crate::planning_model::graph::enumeration::build_constraint_graph(&tables.problem) {
            Ok(graph) => Self::on_graph(tables, graph),
            Err(GraphError::TooManyStates { .. }) => Self::lazy_on(tables),
            Err(other) => Err(other.into()),
        }
    }

    /// Builds the tables of a problem whose graph is to grow, however small it is.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn new_lazy(problem: Problem) -> Result<Self, ModelError> {
        Self::lazy_on(Arc::new(ProblemTables::new(problem)))
    }

    fn lazy_on(tables: Arc<ProblemTables>) -> Result<Self, ModelError> {
        let (graph, lazy_graph) = LazyGraph::new(&tables.problem)?;
        Self::assemble(tables, graph, Some(lazy_graph))
    }

    /// Builds the tables of a problem whose graph is given, by hand say. The graph is taken as whole.
    ///
    /// # Errors
    /// Documents that make no constraint.
    pub fn with_graph(problem: Problem, graph: ConstraintGraph) -> Result<Self, ModelError> {
        Self::on_graph(Arc::new(ProblemTables::new(problem)), graph)
    }

    fn on_graph(tables: Arc<ProblemTables>, mut graph: ConstraintGraph) -> Result<Self, ModelError> {
        graph.lazy = false;
        graph.index();
        Self::assemble(tables, graph, None)
    }

    fn assemble(
        tables: Arc<ProblemTables>,
        graph: ConstraintGraph,
        lazy_graph: Option<LazyGraph>,
    ) -> Result<Self, ModelError> {
        let problem = &tables.problem;
        let robot = &problem.robot;
        crate::planning_model::problem_tables::bounded_roots(robot)?;
        let objects = object_models(problem, &graph)?;
        let grasps = graph
            .constraints
            .iter()
            .map(|c| match c.kind {
                ConstraintKind::Grasp { gripper, handle } | ConstraintKind::Pregrasp { gripper, handle } => {
                    let name = || robot.handles[handle.at()].name.clone();
                    let grasp = grasp_of(problem, gripper, handle);
                    grasp.map(Some).map_err(|source| ModelError::Grasp { handle: name(), source })
                }
                _ => Ok(None),
            })
            .collect::<Result<_, _>>()?;
        let robot_weights = robot_weights(&tables, &objects);
        let (states, transitions) = (Vec::new(), Vec::new());
        let mut model = Self { tables, graph, robot_weights, objects, lazy_graph, grasps, states, transitions };
        model.catch_up();
        Ok(model)
    }

    /// Gives tables to what has come into being.
    fn catch_up(&mut self) {
        let lazy_graph = self.lazy_graph.as_ref();
        let grasp = |kind| match kind {
            ConstraintKind::Grasp { gripper, handle } | ConstraintKind::Pregrasp { gripper, handle } => {
                lazy_graph.and_then(|lazy_graph| lazy_graph.grasp(gripper, handle)).cloned()
            }
            _ => None,
        };
        self.grasps.extend(self.graph.constraints[self.grasps.len()..].iter().map(|c| grasp(c.kind)));
        self.states.resize_with(self.graph.states.len(), Arc::default);
        self.transitions.resize_with(self.graph.transitions.len(), Arc::default);
    }

    /// See [`PlanningModel::expand`].
    pub fn expand(&mut self, state: StateId) {
        let Some(lazy_graph) = &mut self.lazy_graph else { return };
        lazy_graph.expand(&self.tables.problem, &mut self.graph, state);
        self.catch_up();
    }

    pub(crate) fn reach(&mut self, key: StateKey) -> Option<StateId> {
        let state = self.lazy_graph.as_mut()?.reach(&self.tables.problem, &mut self.graph, key);
        self.catch_up();
        state
    }

    /// At most about so many bytes do the programs take that are compiled when a transition is first tried (measured on sixteen arms
    /// and 60 boxes: 60 to 100 bytes per velocity coordinate and leg), and where there are margins the pair sets. What was tried
    /// decides, not what this process has compiled, so that budgets do not depend on other searches.
    #[must_use]
    pub fn bytes_to_try(&self, transition: TransitionId) -> u64 {
        let legs = self.graph.transition(transition).legs.len();
        let pair_sets = if self.problem.margins.is_empty() { 0 } else { legs as u64 + 1 };
        (legs * 100 * self.problem.robot.space.dimension()) as u64 + pair_sets * self.bytes_of_pairs()
    }

    /// About so many bytes does a pair set take: what is compiled of a state when something first moves in it.
    #[must_use]
    pub fn bytes_of_pairs(&self) -> u64 {
        30 * self.collision.pairs().len() as u64
    }

    /// What the graph grows from, where it is lazy.
    pub(crate) fn lazy_graph(&self) -> Option<&LazyGraph> {
        self.lazy_graph.as_ref()
    }

    /// Sets the locked joints of a configuration to their values.
    pub fn lock(&self, q: &mut [f64]) {
        for &(index, value) in &self.locked {
            q[index] = value;
        }
    }

    /// The movable objects, in the graph's order.
    #[must_use]
    pub fn objects(&self) -> &[ObjectModel] {
        &self.objects
    }

    /// The documents of a grasp or pre-grasp constraint.
    #[must_use]
    pub fn grasp(&self, constraint: ConstraintId) -> Option<&Grasp> {
        self.grasps[constraint.at()].as_ref()
    }

    pub(crate) fn leg_tables(&self, transition: TransitionId) -> &[LegTables] {
        let legs = self.graph.transition(transition).legs.len();
        self.transitions[transition.at()].legs.get_or_init(|| (0..legs).map(|_| LegTables::default()).collect())
    }

    /// A constraint of the problem's own, or a joint's rest, as kernels know it; parameter rows name slot 0.
    #[must_use]
    pub fn constraint(&self, constraint: ConstraintId) -> Option<Constraint> {
        self.constraint_of(self.graph.constraint(constraint).kind)
    }

    /// The node nearest to `q` among `nodes`, by weighted distance; ties by lowest id.
    pub fn nearest(
        &self,
        roadmap: Roadmap<'_>,
        q: &[f64],
        nodes: impl Iterator<Item = NodeId>,
        weights: &[f64],
    ) -> Option<NodeId> {
        let space = &self.problem.robot.space;
        let distance = |node: NodeId| (space.distance(q, roadmap.configuration(node), weights), node);
        nodes.map(distance).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|(_, node)| node)
    }

    /// Weighted length of a polyline of configurations, metres.
    #[must_use]
    pub fn length(&self, knots: &[f64]) -> f64 {
        let space = &self.problem.robot.space;
        let knots: Vec<&[f64]> = knots.chunks_exact(space.size()).collect();
        knots.windows(2).map(|pair| space.distance(pair[0], pair[1], &self.weights)).sum()
    }
}

/// Weights of the robots' coordinates alone.
fn robot_weights(tables: &ProblemTables, objects: &[ObjectModel]) -> Vec<f64> {
    let mut weights = tables.weights.clone();
    for root in objects.iter().filter_map(|object| object.root) {
        if let Source::Coordinates { v, .. } = tables.problem.robot.joints[root.at()].source {
            weights[v..v + 6].fill(0.0);
        }
    }
    weights
}
