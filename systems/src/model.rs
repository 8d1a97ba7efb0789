//! What stays the same during searches: the problem, its constraint graph, and the tables compiled from them.
//!
//! One model serves any number of searches on any number of threads. What belongs to single states and transitions is
//! compiled when it is first asked for, so that a graph with thousands of states starts at once.

use crate::constraint_programs::{LegProgram, parameter_in};
use crate::resting::Resting;
use bevy_ecs::prelude::Resource;
use foliate_components::Pose;
use foliate_components::candidate::PlannedLeg;
use foliate_components::constraint::Grasp;
use foliate_components::graph::{ConstraintGraph, ConstraintId, ConstraintKind, State, StateId, TransitionId};
use foliate_components::leaf::{Leaf, LeafIndex, Parameter};
use foliate_components::path::Attachment;
use foliate_components::pose::{log_so3, pose_to_array};
use foliate_components::problem::Problem;
use foliate_components::roadmap::{NodeId, Roadmap};
use foliate_components::robot::{JointIndex, LinkIndex, PartIndex, Robot, ShapeIndex, Source, SurfaceIndex};
use foliate_kernels::collision::{
    CollisionScene, CollisionScratch, Contact, PairId, PairRule, PairSet, first_collision,
};
use foliate_kernels::kinematics::{Carriage, Kinematics};
use foliate_kernels::projection::CompileError;
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
    legs: Vec<Vec<OnceLock<Compiled>>>,
    interiors: Vec<OnceLock<Compiled>>,
    state_pairs: Vec<OnceLock<PairSet>>,
    /// By transition: pairs of the motions in the state it leaves and in the state it reaches, where there are margins.
    transition_pairs: Vec<[OnceLock<PairSet>; 2]>,
    /// Every pair, for verdicts.
    all_pairs: PairSet,
}

type Compiled = Result<LegProgram, CompileError>;

/// A movable object.
#[derive(Clone, Debug)]
pub struct ObjectModel {
    /// Its free-flyer.
    pub root: JointIndex,
    /// What it may rest on; without, it stays where it is.
    pub resting: Option<Resting>,
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
        let locked_joints = locked_joints(&problem);
        let rule = PairRule {
            ignored: &problem.ignored_pairs,
            margins: &problem.margins,
            locked: &locked_joints,
            // The problem names them.
            ignore_neighbours_without_srdf: false,
        };
        let collision = CollisionScene::new(robot, &rule);
        let weights = coordinate_weights(robot);
        let mut robot_weights = weights.clone();
        for object in &objects {
            if let Source::Coordinates { v, .. } = robot.joints[object.root.at()].source {
                robot_weights[v..v + 6].fill(0.0);
            }
        }
        Ok(Self {
            kinematics: Kinematics::new(robot),
            weights,
            robot_weights,
            grasps,
            locked: locked_coordinates(&problem),
            legs: graph.transitions.iter().map(|t| t.legs.iter().map(|_| OnceLock::new()).collect()).collect(),
            interiors: graph.states.iter().map(|_| OnceLock::new()).collect(),
            state_pairs: graph.states.iter().map(|_| OnceLock::new()).collect(),
            transition_pairs: graph.transitions.iter().map(|_| [OnceLock::new(), OnceLock::new()]).collect(),
            all_pairs: PairSet::new(&collision, &[], &[]),
            collision,
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
    ///
    /// # Errors
    /// What a graph that was built by hand may ask for and no program can say.
    pub fn leg_program(&self, transition: TransitionId, leg: usize) -> Result<&LegProgram, &CompileError> {
        self.legs[transition.at()][leg].get_or_init(|| LegProgram::of_leg(self, transition, leg)).as_ref()
    }

    /// The program of motions within a state.
    ///
    /// # Errors
    /// As [`Self::leg_program`].
    pub fn interior_program(&self, state: StateId) -> Result<&LegProgram, &CompileError> {
        self.interiors[state.at()].get_or_init(|| LegProgram::of_state(self, state)).as_ref()
    }

    /// The pairs of shapes on motions of a transition that lie in `state`. Which pairs move depends on who carries whom,
    /// which the state decides; margins are lifted from what touches at either end of the transition.
    #[must_use]
    pub fn pairs(&self, transition: TransitionId, state: StateId, carriages: &[Carriage]) -> &PairSet {
        if self.problem.margins.is_empty() {
            return self.state_pairs[state.at()].get_or_init(|| PairSet::new(&self.collision, carriages, &[]));
        }
        let ends = self.graph.transition(transition);
        let side = usize::from(state != ends.from);
        self.transition_pairs[transition.at()][side].get_or_init(|| {
            let mut touching = self.touching(ends.from);
            touching.extend(self.touching(ends.to));
            PairSet::new(&self.collision, carriages, &touching)
        })
    }

    /// The links that touch by grasp or placement in a state.
    fn touching(&self, state: StateId) -> Vec<(LinkIndex, LinkIndex)> {
        let robot = &self.problem.robot;
        let mut links = Vec::new();
        for &constraint in &self.graph.state(state).manifold {
            match self.graph.constraint(constraint).kind {
                ConstraintKind::Grasp { gripper, handle } | ConstraintKind::Pregrasp { gripper, handle } => {
                    links.push((robot.grippers[gripper.at()].link, robot.handles[handle.at()].link));
                }
                ConstraintKind::Placement { object } | ConstraintKind::Preplacement { object } => {
                    for surface in &self.graph.objects[object as usize].surfaces {
                        let on = |s: &SurfaceIndex| (robot.surfaces[surface.at()].link, robot.surfaces[s.at()].link);
                        links.extend(self.problem.graph.supports.iter().map(on));
                    }
                }
                ConstraintKind::Rest { .. } => {}
            }
        }
        links
    }

    /// The first pair of shapes that is too close where the bodies are, margins of touching pairs in `state` lifted.
    #[must_use]
    pub fn first_collision(
        &self,
        state: StateId,
        X_WJ: &[Pose],
        guard: f64,
        scratch: &mut CollisionScratch,
    ) -> Option<Contact> {
        if self.problem.margins.is_empty() {
            return first_collision(&self.collision, X_WJ, &self.all_pairs, guard, scratch);
        }
        let pairs = PairSet::new(&self.collision, &[], &self.touching(state));
        first_collision(&self.collision, X_WJ, &pairs, guard, scratch)
    }

    /// Names of the shapes of a pair.
    #[must_use]
    pub fn pair_shapes(&self, pair: PairId) -> (ShapeIndex, ShapeIndex) {
        let pair = self.collision.pairs()[pair.at()];
        (pair.first, pair.second)
    }

    /// Names of the shapes of a pair, for messages.
    #[must_use]
    pub fn pair_name(&self, pair: PairId) -> String {
        let (a, b) = self.pair_shapes(pair);
        let shapes = &self.problem.robot.shapes;
        format!("{} and {}", shapes[a.at()].name, shapes[b.at()].name)
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
            let (carrier, X_CO) = solid_grasp(self.grasp(constraint)?);
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

    /// How every object hangs on what carries it, along a leg.
    #[must_use]
    pub fn carriages_of_leg(&self, leg: &PlannedLeg, leaves: &LeafIndex) -> Vec<Carriage> {
        self.carriages(leg.state, |constraint| parameter_in(self, leaves, leg.state, &leg.parameters, constraint))
    }

    /// What every object hangs on, on a leaf, for output; an object's carrier comes first.
    #[must_use]
    pub fn attachments(&self, leaf: &Leaf, leaves: &LeafIndex) -> Vec<Attachment> {
        let state = self.graph.state(leaf.state);
        let mut attachments = Vec::new();
        for (index, object) in self.objects.iter().enumerate() {
            let carrier = self.carrier_of(state, index);
            for &constraint in &state.manifold {
                match self.graph.constraint(constraint).kind {
                    ConstraintKind::Grasp { gripper, handle }
                        if self.graph.objects[index].handles.contains(&handle) =>
                    {
                        let carrier = carrier == Some(constraint);
                        attachments.push(Attachment::Grasp { object: object.root, gripper, handle, carrier });
                    }
                    ConstraintKind::Placement { object: o } if o as usize == index => {
                        attachments.extend(self.contact(leaf, leaves, constraint, index));
                    }
                    ConstraintKind::Rest { object: o } if o as usize == index => {
                        attachments.push(Attachment::Rest { object: object.root });
                    }
                    _ => {}
                }
            }
        }
        attachments
    }

    /// Which surfaces touch where an object lies on a leaf.
    fn contact(&self, leaf: &Leaf, leaves: &LeafIndex, constraint: ConstraintId, object: usize) -> Option<Attachment> {
        let position = self.graph.state(leaf.state).foliation.iter().position(|&c| c == constraint)?;
        let parameter = leaves.parameter(leaf.parameters[position]);
        let model = &self.objects[object];
        let Some(Resting::Surfaces(lying)) = &model.resting else {
            return Some(Attachment::Rest { object: model.root });
        };
        let mut X_WJ = vec![Pose::identity(); self.kinematics.bodies()];
        X_WJ[model.root.at()] = parameter.carrier_from_object;
        let touching = foliate_kernels::constraints::placement::contact(lying, &X_WJ);
        let surface = numbered(&self.problem.robot, &self.graph.objects[object].surfaces, touching.object)?;
        let support = numbered(&self.problem.robot, &self.problem.graph.supports, touching.support)?;
        Some(Attachment::Contact { object: model.root, surface, support })
    }

    /// How far the objects' coordinates in the knots of a motion are from where their carriers take them: at the joint
    /// knots of two segments an object has the next leaf's exact pose. Metres and radians.
    #[must_use]
    pub fn carrier_gap(&self, leaf: &Leaf, leaves: &LeafIndex, knots: &[Vec<f64>]) -> f64 {
        let carriages = self.carriages_of_leaf(leaf, leaves);
        let mut X_WJ = vec![Pose::identity(); self.kinematics.bodies()];
        let mut gap = 0.0_f64;
        for q in knots {
            self.kinematics.forward(q, &mut X_WJ);
            let written: Vec<Pose> = carriages.iter().map(|c| X_WJ[c.object.at()]).collect();
            self.kinematics.carry(q, &carriages, &mut X_WJ);
            for (carriage, written) in carriages.iter().zip(written) {
                let carried = X_WJ[carriage.object.at()];
                let turn = log_so3(written.rotation.conjugate() * carried.rotation).length();
                gap = gap.max(carried.translation.distance(written.translation)).max(turn);
            }
        }
        gap
    }

    /// Whether an object is outside the bounds of its coordinates.
    #[must_use]
    pub fn object_out_of_bounds(&self, q: &[f64]) -> bool {
        let space = &self.problem.robot.space;
        self.objects.iter().any(|object| match self.problem.robot.joints[object.root.at()].source {
            Source::Coordinates { q: first, .. } => {
                (first..first + 3).any(|i| !(q[i] >= space.lower[i] - 1e-9 && q[i] <= space.upper[i] + 1e-9))
            }
            Source::Follows { .. } => false,
        })
    }

    /// Puts the movable objects of `q` where `poses` say, or else where `start` has them.
    pub fn place_objects(&self, start: &[f64], poses: &[(PartIndex, Pose)], q: &mut [f64]) {
        for (record, object) in self.graph.objects.iter().zip(&self.objects) {
            let Source::Coordinates { q: first, .. } = self.problem.robot.joints[object.root.at()].source else {
                continue;
            };
            let numbers = match poses.iter().find(|(part, _)| *part == record.part) {
                Some((_, pose)) => pose_to_array(pose),
                None => std::array::from_fn(|i| start[first + i]),
            };
            q[first..first + 7].copy_from_slice(&numbers);
        }
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

/// The surface and the number in it of the `count`-th polygon of some surfaces.
fn numbered(robot: &Robot, surfaces: &[SurfaceIndex], mut count: usize) -> Option<(SurfaceIndex, u32)> {
    for &surface in surfaces {
        let polygons = robot.surfaces[surface.at()].polygons.len();
        if count < polygons {
            return Some((surface, count as u32));
        }
        count -= polygons;
    }
    None
}

fn object_models(problem: &Problem, graph: &ConstraintGraph) -> Result<Vec<ObjectModel>, ModelError> {
    let (robot, options) = (&problem.robot, &problem.graph);
    let model = |object: &foliate_components::problem::ObjectOptions| {
        let part = &robot.parts[object.part.at()];
        let root = part
            .root_joint
            .ok_or_else(|| ModelError::Document(format!("object `{}` does not move freely", part.name)))?;
        let resting = Resting::of_object(robot, options, object);
        let resting = resting.map_err(|e| ModelError::Document(format!("object `{}`: {e}", part.name)))?;
        Ok(ObjectModel { root, resting })
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

/// How a solid grasp carries: the gripper's body, and the pose of the object's root in it when both frames coincide.
#[must_use]
pub fn solid_grasp(grasp: &Grasp) -> (Option<JointIndex>, Pose) {
    (grasp.gripper.joint, grasp.gripper.joint_from_frame * grasp.handle.joint_from_frame.inverse())
}

/// The pose of an object's root in its carrier, from the poses of all bodies.
#[must_use]
pub fn hanging(object: JointIndex, carrier: Option<JointIndex>, X_WJ: &[Pose]) -> Pose {
    match carrier {
        Some(carrier) => X_WJ[carrier.at()].inverse() * X_WJ[object.at()],
        None => X_WJ[object.at()],
    }
}
