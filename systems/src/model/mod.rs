//! What stays the same during searches: the problem, its constraint graph, and the tables compiled from them.
//!
//! One model serves any number of searches on any number of threads. What belongs to single states and transitions is
//! compiled when it is first asked for, so that a graph with thousands of states starts at once. Where the graph is lazy,
//! every search lets a model of its own grow, which shares all but the graph with the one it started from.

mod clearance;
mod hanging;

pub use hanging::{hanging, solid_grasp};

use crate::constraint_programs::LegProgram;
use crate::events::StopSignal;
use crate::graph::building::GraphError;
use crate::graph::carriers::{Carriers, grasp_of, root_of};
use crate::graph::cases::Case;
use crate::graph::growth::Growth;
use crate::graph::resting::{Resting, RestingPlace};
use bevy_ecs::prelude::Resource;
use foliate_components::constraint::{Constraint, Grasp, Locked, LockedValue};
use foliate_components::coverage::LeftOutPair;
use foliate_components::graph::{ConstraintGraph, ConstraintId, ConstraintKind, StateId, TransitionId};
use foliate_components::problem::{JointRest, Problem};
use foliate_components::roadmap::{NodeId, Roadmap};
use foliate_components::robot::{JointIndex, Robot, Source};
use foliate_kernels::collision::{CollisionScene, PairRule, PairSet};
use foliate_kernels::constrained_motion::{CompileError, SeedTable};
use foliate_kernels::kinematics::Kinematics;
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

    /// Makes the state of a configuration come into being, where the graph is lazy and the configuration has the right
    /// length and finite numbers; `None` where it lies in no state.
    pub fn reach(&mut self, q: &[f64], tolerance: f64) -> Option<StateId> {
        if !self.graph.lazy {
            return crate::membership::state_at(self, q, tolerance);
        }
        let case = crate::membership::case_at(self, q, tolerance)?;
        let known = self.growth.as_ref().and_then(|growth| growth.known(&case));
        known.or_else(|| Arc::make_mut(&mut self.0).reach(case))
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
    objects: Vec<ObjectModel>,
    /// What the graph grows from, where it is lazy.
    growth: Option<Growth>,
    /// By constraint.
    grasps: Vec<Option<Grasp>>,
    states: Vec<Arc<StateTables>>,
    transitions: Vec<Arc<TransitionTables>>,
}

impl Deref for Model {
    type Target = ProblemTables;

    fn deref(&self) -> &ProblemTables {
        &self.tables
    }
}

/// What a problem says whatever of its graph is there: nearly all of it follows from the files of its models, and it is what takes
/// long. Any number of models may share it.
#[derive(Debug)]
pub struct ProblemTables {
    /// The problem.
    pub problem: Problem,
    /// Forward kinematics.
    pub kinematics: Kinematics,
    /// Solids and pairs.
    pub collision: CollisionScene,
    /// Metres per unit of each velocity coordinate: how far the unit moves the farthest point that it moves.
    pub weights: Vec<f64>,
    /// Values that the locked joints keep, by configuration index.
    locked: Vec<(usize, f64)>,
    /// All joints that never move.
    still: Vec<JointIndex>,
    /// Every pair, for verdicts.
    all_pairs: PairSet,
    /// Starts for solves that bring a gripper somewhere, by the body that carries it: built in a millisecond when first asked
    /// for, 0.4 MB each. They follow from the robots' models alone.
    seeds: Vec<(JointIndex, OnceLock<Option<SeedTable>>)>,
}

/// What is compiled of a state. Of most states of a large graph nothing ever is: what is not there takes a word.
#[derive(Debug, Default)]
struct StateTables {
    interior: OnceLock<Box<Compiled>>,
    carriers: OnceLock<Box<Carriers>>,
    pairs: OnceLock<Box<PairSet>>,
    /// Every pair, with the margins of the state, where there are margins.
    verdict: OnceLock<Box<PairSet>>,
}

/// What is compiled of a transition.
#[derive(Debug, Default)]
struct TransitionTables {
    /// Empty until one of them is asked for.
    legs: OnceLock<Box<[LegTables]>>,
    /// Every pair, with the margins of the transition, where there are margins.
    verdict: OnceLock<Box<PairSet>>,
}

#[derive(Debug, Default)]
struct LegTables {
    program: OnceLock<Box<Compiled>>,
    /// Pairs of its motions, where there are margins.
    pairs: OnceLock<Box<PairSet>>,
}

type Compiled = Result<LegProgram, CompileError>;

/// A movable object.
#[derive(Clone, Debug)]
pub struct ObjectModel {
    /// Its free-flyer; none for a part that is fixed in the world and only has joints (doors, drawers).
    pub root: Option<JointIndex>,
    /// What it may rest on, by body; without any, it stays where it is.
    pub resting: Vec<RestingPlace>,
}

impl ObjectModel {
    /// How it rests on a body's supports.
    #[must_use]
    pub fn resting_on(&self, body: Option<JointIndex>) -> Option<&RestingPlace> {
        self.resting.iter().find(|place| place.on == body)
    }
}

/// Why a problem cannot be planned for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum ModelError {
    #[error(transparent)]
    Graph(#[from] GraphError),
    #[error("{0}")]
    Document(String),
}

impl Model {
    /// What does not depend on the graph, to be shared with other models.
    #[must_use]
    pub fn tables(&self) -> &Arc<ProblemTables> {
        &self.tables
    }

    /// Builds graph and tables. A graph of more than [`MOST_STATES`](crate::graph::building::MOST_STATES) states is lazy: it
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
        match crate::graph::building::build_constraint_graph(&tables.problem) {
            Ok(graph) => Self::on_graph(tables, graph),
            Err(GraphError::TooManyStates { .. }) => Self::growing_on(tables),
            Err(other) => Err(other.into()),
        }
    }

    /// Builds the tables of a problem whose graph is to grow, however small it is.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn growing(problem: Problem) -> Result<Self, ModelError> {
        Self::growing_on(Arc::new(ProblemTables::new(problem)))
    }

    fn growing_on(tables: Arc<ProblemTables>) -> Result<Self, ModelError> {
        let (graph, growth) = Growth::new(&tables.problem)?;
        Self::assemble(tables, graph, Some(growth))
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
        growth: Option<Growth>,
    ) -> Result<Self, ModelError> {
        let problem = &tables.problem;
        let robot = &problem.robot;
        crate::sampling::bounded_roots(robot).map_err(ModelError::Document)?;
        let objects = object_models(problem, &graph)?;
        let grasps = graph
            .constraints
            .iter()
            .map(|c| match c.kind {
                ConstraintKind::Grasp { gripper, handle } | ConstraintKind::Pregrasp { gripper, handle } => {
                    let name = &robot.handles[handle.at()].name;
                    let grasp = grasp_of(problem, gripper, handle);
                    grasp.map(Some).map_err(|e| ModelError::Document(format!("handle `{name}`: {e}")))
                }
                _ => Ok(None),
            })
            .collect::<Result<_, _>>()?;
        let robot_weights = robot_weights(&tables, &objects);
        let (states, transitions) = (Vec::new(), Vec::new());
        let mut model = Self { tables, graph, robot_weights, objects, growth, grasps, states, transitions };
        model.catch_up();
        Ok(model)
    }

    /// Gives tables to what has come into being.
    fn catch_up(&mut self) {
        let growth = self.growth.as_ref();
        let grasp = |kind| match kind {
            ConstraintKind::Grasp { gripper, handle } | ConstraintKind::Pregrasp { gripper, handle } => {
                growth.and_then(|growth| growth.grasp(gripper, handle)).cloned()
            }
            _ => None,
        };
        self.grasps.extend(self.graph.constraints[self.grasps.len()..].iter().map(|c| grasp(c.kind)));
        self.states.resize_with(self.graph.states.len(), Arc::default);
        self.transitions.resize_with(self.graph.transitions.len(), Arc::default);
    }

    /// See [`PlanningModel::expand`].
    pub fn expand(&mut self, state: StateId) {
        let Some(growth) = &mut self.growth else { return };
        growth.expand(&self.tables.problem, &mut self.graph, state);
        self.catch_up();
    }

    fn reach(&mut self, case: Case) -> Option<StateId> {
        let state = self.growth.as_mut()?.reach(&self.tables.problem, &mut self.graph, case);
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
    pub(crate) fn growth(&self) -> Option<&Growth> {
        self.growth.as_ref()
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

    /// The program of a transition's leg.
    ///
    /// # Errors
    /// What a graph that was built by hand may ask for and no program can say.
    pub fn leg_program(&self, transition: TransitionId, leg: usize) -> Result<&LegProgram, &CompileError> {
        let program = &self.leg_tables(transition)[leg].program;
        program.get_or_init(|| Box::new(LegProgram::of_leg(self, transition, leg))).as_ref().as_ref()
    }

    fn leg_tables(&self, transition: TransitionId) -> &[LegTables] {
        let legs = self.graph.transition(transition).legs.len();
        self.transitions[transition.at()].legs.get_or_init(|| (0..legs).map(|_| LegTables::default()).collect())
    }

    /// The program of motions within a state.
    ///
    /// # Errors
    /// As [`Self::leg_program`].
    pub fn interior_program(&self, state: StateId) -> Result<&LegProgram, &CompileError> {
        let interior = &self.states[state.at()].interior;
        interior.get_or_init(|| Box::new(LegProgram::of_state(self, state))).as_ref().as_ref()
    }

    /// A constraint of the problem's own, or a joint's rest, as kernels know it; parameter rows name slot 0.
    #[must_use]
    pub fn constraint(&self, constraint: ConstraintId) -> Option<Constraint> {
        self.constraint_of(self.graph.constraint(constraint).kind)
    }

    /// The node nearest to `q` among `nodes`, by weighted distance; ties by lowest id.
    pub fn nearest(
        &self,
        roadmap: &Roadmap,
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

/// Room for a table for each body that carries a gripper.
fn seed_tables(robot: &Robot) -> Vec<(JointIndex, OnceLock<Option<SeedTable>>)> {
    let mut tips: Vec<JointIndex> =
        robot.grippers.iter().filter_map(|gripper| robot.links[gripper.link.at()].joint).collect();
    tips.sort_unstable();
    tips.dedup();
    tips.into_iter().map(|tip| (tip, OnceLock::new())).collect()
}

impl ProblemTables {
    /// Starts for solves that bring this body somewhere, where it carries a gripper and hangs on an arm of its own.
    #[must_use]
    pub fn seeds(&self, tip: JointIndex) -> Option<&SeedTable> {
        let (_, table) = self.seeds.iter().find(|(body, _)| *body == tip)?;
        table.get_or_init(|| SeedTable::new(&self.problem.robot, tip)).as_ref()
    }

    /// Builds them: bounds of all shapes first.
    #[must_use]
    pub fn new(problem: Problem) -> Self {
        let still = locked_joints(&problem);
        let collision = CollisionScene::new(&problem.robot, &pair_rule(&problem, &still));
        Self::on_scene(problem, still, collision)
    }

    /// As [`Self::new`]; none once the signal is raised: to build the bounds of large meshes takes long.
    #[must_use]
    pub fn new_until(problem: Problem, stop: &StopSignal) -> Option<Self> {
        let still = locked_joints(&problem);
        let rule = pair_rule(&problem, &still);
        let collision = CollisionScene::new_while(&problem.robot, &rule, &|| !stop.is_raised())?;
        Some(Self::on_scene(problem, still, collision))
    }

    fn on_scene(problem: Problem, still: Vec<JointIndex>, collision: CollisionScene) -> Self {
        let robot = &problem.robot;
        Self {
            kinematics: Kinematics::new(robot),
            weights: coordinate_weights(robot),
            locked: locked_coordinates(&problem),
            all_pairs: PairSet::new(&collision, &[], &[]),
            seeds: seed_tables(robot),
            collision,
            still,
            problem,
        }
    }

    /// The pairs of shapes that are never tested, with the reason.
    #[must_use]
    pub fn left_out(&self) -> Vec<LeftOutPair> {
        self.collision.left_out(&self.problem.robot, &pair_rule(&self.problem, &self.still))
    }

    /// A constraint of the problem's own, or a joint's rest, as kernels know it; parameter rows name slot 0.
    #[must_use]
    pub fn constraint_of(&self, kind: ConstraintKind) -> Option<Constraint> {
        let options = &self.problem.graph;
        match kind {
            ConstraintKind::Given { constraint } => {
                options.constraints.get(constraint as usize).map(|given| given.constraint.clone())
            }
            ConstraintKind::JointRest { joint } => options.resting_joints.get(joint as usize).map(|resting| {
                let value = match resting.rest {
                    JointRest::Stays => LockedValue::Argument(0),
                    JointRest::At(value) => LockedValue::Fixed(value),
                };
                Constraint::Locked(Locked { joint: resting.joint, value })
            }),
            _ => None,
        }
    }
}

/// Which pairs are tested: as the problem says, which names neighbours too.
fn pair_rule<'a>(problem: &'a Problem, still: &'a [JointIndex]) -> PairRule<'a> {
    PairRule { ignored: &problem.ignored_pairs, margins: &problem.margins, locked: still }
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

fn object_models(problem: &Problem, graph: &ConstraintGraph) -> Result<Vec<ObjectModel>, ModelError> {
    let (robot, options) = (&problem.robot, &problem.graph);
    let model = |object: &foliate_components::problem::ObjectOptions| {
        let failed = |e: &str| ModelError::Document(format!("object `{}`: {e}", robot.parts[object.part.at()].name));
        let Some(root) = root_of(robot, object.part) else {
            return Ok(ObjectModel { root: None, resting: Vec::new() });
        };
        let resting = RestingPlace::of_object(robot, options, object).map_err(|e| failed(&e))?;
        let off_root = |place: &RestingPlace| match &place.resting {
            Resting::Surfaces(lying) => lying.object_joint() != Some(root),
            Resting::Plane { .. } => false,
        };
        if resting.iter().any(off_root) {
            return Err(failed("its contact surfaces are on a link that moves against its root"));
        }
        Ok(ObjectModel { root: Some(root), resting })
    };
    graph.objects.iter().map(model).collect()
}

/// Joints that never move: those that the problem locks, and those between equal bounds.
fn locked_joints(problem: &Problem) -> Vec<JointIndex> {
    let all = (0..problem.robot.joints.len() as u32).map(JointIndex);
    let named = |joint: JointIndex| problem.graph.locked.iter().any(|&(locked, _)| locked == joint);
    all.filter(|&joint| named(joint) || problem.robot.joints[joint.at()].is_immovable()).collect()
}

fn locked_coordinates(problem: &Problem) -> Vec<(usize, f64)> {
    let coordinate = |&(joint, value): &(JointIndex, f64)| match problem.robot.joints[joint.at()].source {
        Source::Coordinates { q, .. } => Some((q, value)),
        Source::Follows { .. } => None,
    };
    problem.graph.locked.iter().filter_map(coordinate).collect()
}

/// For each velocity coordinate the reach of what it moves: chain lengths beyond the joint plus the radius of the shapes,
/// at least a centimetre; 1 for translations.
fn coordinate_weights(robot: &Robot) -> Vec<f64> {
    let mut reach = vec![0.01_f64; robot.joints.len()];
    for shape in &robot.shapes {
        let Some(joint) = robot.links[shape.link.at()].joint else { continue };
        let far = shape.joint_from_shape.translation.length() + shape.geometry.radius_about_origin();
        reach[joint.at()] = reach[joint.at()].max(far);
    }
    // Children stand behind their parents, so one backward pass reaches the roots.
    for index in (0..robot.joints.len()).rev() {
        let joint = &robot.joints[index];
        if let Some(parent) = joint.parent {
            let beyond = reach[index] + joint.parent_from_joint.translation.length();
            reach[parent.at()] = reach[parent.at()].max(beyond);
        }
    }
    let mut weights = vec![1.0; robot.space.dimension()];
    for (joint, reach) in robot.joints.iter().zip(reach) {
        use foliate_components::robot::Motion;
        let Source::Coordinates { v, .. } = joint.source else { continue };
        match joint.motion {
            Motion::Revolute { .. } => weights[v] = reach,
            Motion::Prismatic { .. } => {}
            Motion::Planar => weights[v + 2] = reach,
            Motion::FreeFlyer => weights[v + 3..v + 6].fill(reach),
        }
    }
    weights
}
