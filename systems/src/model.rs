//! What stays the same during searches: the problem, its constraint graph, and the tables compiled from them.
//!
//! One model serves any number of searches on any number of threads. What belongs to single states and transitions is
//! compiled when it is first asked for, so that a graph with thousands of states starts at once.

use crate::constraint_programs::LegProgram;
use bevy_ecs::prelude::Resource;
use foliate_components::Pose;
use foliate_components::constraint::{Grasp, Placement};
use foliate_components::graph::{ConstraintGraph, ConstraintId, ConstraintKind, State, StateId, TransitionId};
use foliate_components::leaf::{Leaf, LeafIndex, Parameter};
use foliate_components::problem::Problem;
use foliate_components::robot::{JointIndex, Robot, Source};
use foliate_components::roadmap::{NodeId, Roadmap};
use foliate_kernels::collision::{CollisionScene, PairRule, PairSet};
use foliate_kernels::kinematics::{Carriage, Kinematics};
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

/// See the module.
#[derive(Debug)]
pub struct Model {
    /// The problem.
    pub problem: Problem,
    /// Its constraint graph.
    pub graph: ConstraintGraph,
    /// Forward kinematics.
    pub kinematics: Kinematics,
    /// Solids and pairs.
    pub collision: CollisionScene,
    /// Metres per unit of each velocity coordinate: how far the unit moves the farthest point that it moves.
    pub weights: Vec<f64>,
    /// The same, with zeros for the movable objects, which are determined by leaf and robot.
    pub robot_weights: Vec<f64>,
    objects: Vec<ObjectModel>,
    grasps: Vec<Option<Grasp>>,
    /// Values that the locked joints keep, by configuration index.
    locked: Vec<(usize, f64)>,
    legs: Vec<Vec<OnceLock<LegProgram>>>,
    loops: Vec<OnceLock<LegProgram>>,
    pairs: Vec<OnceLock<PairSet>>,
}

/// A movable object.
#[derive(Clone, Debug)]
pub struct ObjectModel {
    /// Its free-flyer.
    pub root: JointIndex,
    /// How it may lie, where it has surfaces.
    pub placement: Option<Placement>,
}

/// Why a problem cannot be planned for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum ModelError {
    #[error(transparent)]
    Graph(#[from] crate::graph_building::GraphError),
    #[error("{0}")]
    Document(String),
}

impl Model {
    /// Builds graph and tables.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn new(problem: Problem) -> Result<Self, ModelError> {
        let graph = crate::graph_building::build_constraint_graph(&problem)?;
        Self::with_graph(problem, graph)
    }

    /// Builds the tables of a problem whose graph is given, by hand say.
    ///
    /// # Errors
    /// Documents that make no constraint.
    pub fn with_graph(problem: Problem, graph: ConstraintGraph) -> Result<Self, ModelError> {
        let robot = &problem.robot;
        let objects = object_models(&problem, &graph)?;
        let grasps = graph
            .constraints
            .iter()
            .map(|c| match c.kind {
                ConstraintKind::Grasp { gripper, handle } | ConstraintKind::Pregrasp { gripper, handle } => {
                    let name = &robot.handles[handle.at()].name;
                    let grasp = Grasp::new(robot, gripper, handle);
                    grasp.map(Some).map_err(|e| ModelError::Document(format!("handle `{name}`: {e}")))
                }
                _ => Ok(None),
            })
            .collect::<Result<_, _>>()?;
        let locked_joints: Vec<JointIndex> = problem.graph.locked.iter().map(|&(joint, _)| joint).collect();
        let rule =
            PairRule { ignored: &problem.ignored_pairs, margins: &problem.margins, locked: &locked_joints };
        let weights = coordinate_weights(robot);
        let mut robot_weights = weights.clone();
        for object in &objects {
            if let Source::Coordinates { v, .. } = robot.joints[object.root.at()].source {
                robot_weights[v..v + 6].fill(0.0);
            }
        }
        Ok(Self {
            kinematics: Kinematics::new(robot),
            collision: CollisionScene::new(robot, &rule),
            weights,
            robot_weights,
            grasps,
            locked: locked_coordinates(&problem),
            legs: graph.transitions.iter().map(|t| t.legs.iter().map(|_| OnceLock::new()).collect()).collect(),
            loops: graph.states.iter().map(|_| OnceLock::new()).collect(),
            pairs: graph.states.iter().map(|_| OnceLock::new()).collect(),
            objects,
            graph,
            problem,
        })
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
    #[must_use]
    pub fn leg_program(&self, transition: TransitionId, leg: usize) -> &LegProgram {
        self.legs[transition.at()][leg].get_or_init(|| LegProgram::of_leg(self, transition, leg))
    }

    /// The program of motions within a state.
    #[must_use]
    pub fn state_program(&self, state: StateId) -> &LegProgram {
        self.loops[state.at()].get_or_init(|| LegProgram::of_state(self, state))
    }

    /// The pairs of shapes whose relative motion changes within a state.
    #[must_use]
    pub fn moving_pairs(&self, state: StateId, carriages: &[Carriage]) -> &PairSet {
        // Which pairs move depends on who carries whom, which the state decides, not on how.
        self.pairs[state.at()].get_or_init(|| PairSet::new(&self.collision, carriages))
    }

    /// What carries an object in a state: the constraint whose value says how.
    #[must_use]
    pub fn carrier_of(&self, state: &State, object: usize) -> Option<ConstraintId> {
        let handles = &self.graph.objects[object].handles;
        state.manifold.iter().copied().find(|&c| match self.graph.constraint(c).kind {
            ConstraintKind::Placement { object: o } | ConstraintKind::Rest { object: o } => o as usize == object,
            ConstraintKind::Grasp { handle, .. } => handles.contains(&handle),
            ConstraintKind::Pregrasp { .. } | ConstraintKind::Preplacement { .. } => false,
        })
    }

    /// How every object hangs on what carries it, in a state whose foliating constraints have the values `parameter`.
    pub fn carriages<'a>(
        &self,
        state: StateId,
        parameter: impl Fn(ConstraintId) -> Option<&'a Parameter>,
    ) -> Vec<Carriage> {
        let state = self.graph.state(state);
        let carriage = |(index, object): (usize, &ObjectModel)| {
            let constraint = self.carrier_of(state, index)?;
            if let Some(value) = parameter(constraint) {
                let (carrier, X_CO) = (value.carrier, value.carrier_from_object);
                return Some(Carriage { object: object.root, carrier, X_CO });
            }
            let (carrier, X_CO) = self.grasp(constraint)?.carried();
            Some(Carriage { object: object.root, carrier, X_CO })
        };
        self.objects.iter().enumerate().filter_map(carriage).collect()
    }

    /// How every object hangs on what carries it, on a leaf.
    #[must_use]
    pub fn carriages_of_leaf(&self, leaf: &Leaf, leaves: &LeafIndex) -> Vec<Carriage> {
        let foliation = &self.graph.state(leaf.state).foliation;
        self.carriages(leaf.state, |constraint| {
            let position = foliation.iter().position(|&c| c == constraint)?;
            Some(leaves.parameter(leaf.parameters[position]))
        })
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

fn object_models(problem: &Problem, graph: &ConstraintGraph) -> Result<Vec<ObjectModel>, ModelError> {
    let (robot, options) = (&problem.robot, &problem.graph);
    let model = |object: &foliate_components::problem::ObjectOptions| {
        let part = &robot.parts[object.part.at()];
        let root = part
            .root_joint
            .ok_or_else(|| ModelError::Document(format!("object `{}` does not move freely", part.name)))?;
        let placement = if object.surfaces.is_empty() {
            None
        } else {
            let placement =
                Placement::new(robot, &object.surfaces, &options.supports, options.placement_margin);
            Some(placement.map_err(|e| ModelError::Document(format!("object `{}`: {e}", part.name)))?)
        };
        Ok(ObjectModel { root, placement })
    };
    graph.objects.iter().map(model).collect()
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

/// The pose of an object's root in its carrier, from the poses of all bodies.
#[must_use]
pub fn hanging(object: JointIndex, carrier: Option<JointIndex>, X_WJ: &[Pose]) -> Pose {
    match carrier {
        Some(carrier) => X_WJ[carrier.at()].inverse() * X_WJ[object.at()],
        None => X_WJ[object.at()],
    }
}
