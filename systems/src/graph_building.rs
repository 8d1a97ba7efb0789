//! Builds the constraint graph of a problem: P1 Algorithm 1, with the waypoints of P0 §III-C.
//!
//! A state is an injective map from some grippers to handles, in which every object that nobody holds lies on a support (or
//! stays where it is, when it has no surfaces). A transition adds or takes away one grasp. Between them lie waypoints, in
//! HPP's order and numbering (its factory's `_pregrasp`, `_intersec`, `_preplace`):
//!
//! | number | waypoint | holds besides the state's manifold |
//! |---|---|---|
//! | 1 | pre-grasp | the gripper stands back along its x axis |
//! | 2 | intersection | grasp and placement |
//! | 3 | pre-placement | grasp, and the object lifted along the support's normal |
//!
//! Legs 01 and 12 lie in the state without the grasp, 23 in the state with it. HPP's last leg of either direction (34, 10)
//! has no length, because the waypoint already satisfies the target: it is left out.

use foliate_components::graph::{
    ConstraintGraph, ConstraintId, ConstraintKind, GraphConstraint, Leg, State, StateId, Transition, TransitionId,
    TransitionKind,
};
use foliate_components::problem::{GraphOptions, Problem};
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex, Robot};
use std::collections::HashMap;

/// More states than this are refused: they would not fit a search either (8 grippers × 20 handles make 9·10⁹).
pub const MOST_STATES: usize = 20_000;

/// Why no graph can be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum GraphError {
    #[error(
        "{grippers} grippers and {handles} handles make more than {MOST_STATES} states; \
         name the grasps that may occur (`grasps` or `rules` in the scene)"
    )]
    TooManyStates { grippers: usize, handles: usize },
    #[error("object `{0}` has surfaces, but no support is named; name supports or take the surfaces away")]
    NoSupport(String),
    #[error("support `{0}` is on a body that moves; supports must be fixed in the world")]
    MovingSupport(String),
    #[error("object `{0}` does not move freely (its root joint is not a free-flyer)")]
    ObjectNotFree(String),
    #[error("no state is allowed: every combination of grasps is refused by the rules")]
    NothingAllowed,
}

/// Builds states, transitions and crossed transitions.
///
/// # Errors
/// See [`GraphError`].
pub fn build_constraint_graph(problem: &Problem) -> Result<ConstraintGraph, GraphError> {
    check_objects(problem)?;
    let mut builder = Builder::new(problem);
    for grasps in allowed_grasp_sets(&problem.graph)? {
        builder.make_state(grasps);
    }
    if builder.graph.states.is_empty() {
        return Err(GraphError::NothingAllowed);
    }
    builder.make_transitions();
    Ok(builder.graph)
}

fn check_objects(problem: &Problem) -> Result<(), GraphError> {
    let (robot, options) = (&problem.robot, &problem.graph);
    for support in &options.supports {
        let surface = &robot.surfaces[support.at()];
        if robot.links[surface.link.at()].joint.is_some() {
            return Err(GraphError::MovingSupport(surface.name.clone()));
        }
    }
    for object in &options.objects {
        let part = &robot.parts[object.part.at()];
        if root_of(robot, object.part.at()).is_none() {
            return Err(GraphError::ObjectNotFree(part.name.clone()));
        }
        if !object.surfaces.is_empty() && options.supports.is_empty() {
            return Err(GraphError::NoSupport(part.name.clone()));
        }
    }
    Ok(())
}

/// The free-flyer that moves an object.
fn root_of(robot: &Robot, part: usize) -> Option<JointIndex> {
    use foliate_components::robot::RootJoint;
    let part = &robot.parts[part];
    if part.root == RootJoint::FreeFlyer { part.root_joint } else { None }
}

type Grasps = Vec<(GripperIndex, HandleIndex)>;

/// All allowed injective maps from grippers to handles, by increasing cardinal (P1 Alg. 1 lines 7-8).
fn allowed_grasp_sets(options: &GraphOptions) -> Result<Vec<Grasps>, GraphError> {
    let handles: Vec<HandleIndex> = options.objects.iter().flat_map(|o| o.handles.iter().copied()).collect();
    let too_many = GraphError::TooManyStates { grippers: options.grippers.len(), handles: handles.len() };
    let mut sets: Vec<Grasps> = vec![Vec::new()];
    for &gripper in &options.grippers {
        let known = sets.len();
        for index in 0..known {
            for &handle in &handles {
                let taken = sets[index].iter().any(|&(_, h)| h == handle);
                if taken || !in_table(options, gripper, handle) {
                    continue;
                }
                let mut larger = sets[index].clone();
                larger.push((gripper, handle));
                sets.push(larger);
                if sets.len() > MOST_STATES {
                    return Err(too_many);
                }
            }
        }
    }
    sets.retain(|grasps| rules_allow(options, grasps));
    // Stable: within a cardinal the order of grippers and handles stays.
    sets.sort_by_key(Vec::len);
    Ok(sets)
}

fn in_table(options: &GraphOptions, gripper: GripperIndex, handle: HandleIndex) -> bool {
    options.grasps.as_ref().is_none_or(|table| table.contains(&(gripper, handle)))
}

/// The first rule that applies decides; once there are rules, a state to which none applies is refused (HPP's reading).
fn rules_allow(options: &GraphOptions, grasps: &Grasps) -> bool {
    let holds = |gripper| grasps.iter().find(|&&(g, _)| g == gripper).map(|&(_, h)| h);
    let deciding = options.rules.iter().find(|rule| rule.grasps.iter().all(|&(g, h)| holds(g) == h));
    deciding.map_or(options.rules.is_empty(), |rule| rule.allowed)
}

struct Builder<'a> {
    robot: &'a Robot,
    options: &'a GraphOptions,
    graph: ConstraintGraph,
    constraint_ids: HashMap<ConstraintKind, ConstraintId>,
    state_ids: HashMap<Grasps, StateId>,
}

/// A grasp that is made or released between two states.
#[derive(Clone, Copy)]
struct Change {
    gripper: GripperIndex,
    handle: HandleIndex,
    /// Index of the handle's object.
    object: usize,
    /// State without the grasp.
    without: StateId,
    /// State with the grasp.
    with: StateId,
}

impl<'a> Builder<'a> {
    fn new(problem: &'a Problem) -> Self {
        Self {
            robot: &problem.robot,
            options: &problem.graph,
            graph: ConstraintGraph { objects: problem.graph.objects.clone(), ..ConstraintGraph::default() },
            constraint_ids: HashMap::new(),
            state_ids: HashMap::new(),
        }
    }

    /// P1 Algorithm 1, MAKESTATE.
    fn make_state(&mut self, grasps: Grasps) {
        let mut manifold = Vec::new();
        for object in 0..self.options.objects.len() {
            if !grasps.iter().any(|&(_, h)| self.object_of(h) == object) {
                manifold.push(self.resting_constraint(object));
            }
        }
        for &(gripper, handle) in &grasps {
            manifold.push(self.constraint(ConstraintKind::Grasp { gripper, handle }));
        }
        let foliation = manifold.iter().copied().filter(|&c| self.graph.constraint(c).foliates).collect();
        let id = StateId(self.graph.states.len() as u32);
        let name = self.state_name(&grasps);
        self.state_ids.insert(grasps.clone(), id);
        let priority = grasps.len() as u32;
        self.graph.states.push(State { name, grasps, manifold, foliation, priority });
    }

    /// What holds an object in place while nobody holds it.
    fn resting_constraint(&mut self, object: usize) -> ConstraintId {
        let rests = self.rests(object);
        let object = object as u32;
        self.constraint(if rests { ConstraintKind::Placement { object } } else { ConstraintKind::Rest { object } })
    }

    fn constraint(&mut self, kind: ConstraintKind) -> ConstraintId {
        if let Some(&id) = self.constraint_ids.get(&kind) {
            return id;
        }
        let object_name = |object: u32| {
            let part = self.options.objects[object as usize].part;
            self.robot.parts[part.at()].name.as_str()
        };
        let documents = |gripper: GripperIndex, handle: HandleIndex| {
            (self.robot.grippers[gripper.at()].name.as_str(), &self.robot.handles[handle.at()])
        };
        let (name, foliates) = match kind {
            ConstraintKind::Grasp { gripper, handle } => {
                let (g, h) = documents(gripper, handle);
                (format!("{g} grasps {}", h.name), h.mask.iter().any(|fixed| !fixed))
            }
            ConstraintKind::Pregrasp { gripper, handle } => {
                let (g, h) = documents(gripper, handle);
                (format!("{g} pregrasps {}", h.name), false)
            }
            ConstraintKind::Placement { object } => (format!("place_{}", object_name(object)), true),
            ConstraintKind::Preplacement { object } => (format!("preplace_{}", object_name(object)), false),
            ConstraintKind::Rest { object } => (format!("rest_{}", object_name(object)), true),
        };
        let id = ConstraintId(self.graph.constraints.len() as u32);
        self.graph.constraints.push(GraphConstraint { name, kind, foliates });
        self.constraint_ids.insert(kind, id);
        id
    }

    /// P1 Algorithm 1, lines 11-16 and MAKETRANSITIONS, grouped by the state that is left.
    fn make_transitions(&mut self) {
        for index in 0..self.graph.states.len() {
            let state = StateId(index as u32);
            let mut leaving = vec![self.loop_transition(state)];
            for change in self.changes_at(state) {
                leaving.extend(self.transitions_of(state, change));
            }
            // Loops explore the leaf that a tree is on; one in eight extensions is enough (measured, see ARCHITECTURE).
            let others: f64 = leaving[1..].iter().map(|t| t.weight).sum();
            leaving[0].weight = if others > 0.0 { others / 7.0 } else { 1.0 };
            self.graph.transitions.extend(leaving);
        }
        self.link_reverses();
    }

    /// Every grasp that can be made or released from a state.
    fn changes_at(&self, state: StateId) -> Vec<Change> {
        let grasps = &self.graph.state(state).grasps;
        let mut changes = Vec::new();
        for &gripper in &self.options.grippers {
            if let Some(&(_, handle)) = grasps.iter().find(|&&(g, _)| g == gripper) {
                let fewer: Grasps = grasps.iter().copied().filter(|&(g, _)| g != gripper).collect();
                if let Some(&without) = self.state_ids.get(&fewer) {
                    let object = self.object_of(handle);
                    changes.push(Change { gripper, handle, object, without, with: state });
                }
                continue;
            }
            for (object, options) in self.options.objects.iter().enumerate() {
                for &handle in &options.handles {
                    if let Some(&with) = self.state_ids.get(&self.sorted_with(grasps, gripper, handle)) {
                        changes.push(Change { gripper, handle, object, without: state, with });
                    }
                }
            }
        }
        changes
    }

    /// The grasps with one more, in the order of the problem's grippers.
    fn sorted_with(&self, grasps: &Grasps, gripper: GripperIndex, handle: HandleIndex) -> Grasps {
        let mut more = grasps.clone();
        more.push((gripper, handle));
        let rank = |g: GripperIndex| self.options.grippers.iter().position(|&x| x == g);
        more.sort_by_key(|&(g, _)| rank(g));
        more
    }

    fn loop_transition(&self, state: StateId) -> Transition {
        let name = format!("Loop | {}", self.abbreviation(state));
        let leg = Leg { name: name.clone(), state, target: Vec::new(), drawn: Vec::new(), short: false };
        Transition {
            name,
            from: state,
            to: state,
            kind: TransitionKind::Loop,
            weight: 1.0,
            legs: vec![leg],
            adds: Vec::new(),
            reverse: None,
        }
    }

    /// The regular transition of a change as seen from `from`, and its crossed twin where the target's foliation adds rows.
    fn transitions_of(&mut self, from: StateId, change: Change) -> Vec<Transition> {
        let grasping = from == change.without;
        let to = if grasping { change.with } else { change.without };
        let sign = if grasping { '>' } else { '<' };
        let (gripper, handle) =
            (&self.robot.grippers[change.gripper.at()].name, &self.robot.handles[change.handle.at()].name);
        let name = format!("{gripper} {sign} {handle} | {}", self.abbreviation(from));
        let source = self.graph.state(from).foliation.clone();
        let adds: Vec<_> = self.graph.state(to).foliation.iter().copied().filter(|c| !source.contains(c)).collect();
        let legs = if grasping { self.grasping_legs(&name, change) } else { self.releasing_legs(&name, change) };
        let regular = Transition {
            name,
            from,
            to,
            kind: TransitionKind::Regular,
            weight: 1.0,
            legs,
            adds: adds.clone(),
            reverse: None,
        };
        if adds.is_empty() {
            return vec![regular];
        }
        let crossed = self.crossed_twin(&regular, adds);
        vec![regular, crossed]
    }

    /// P1 §III-B: the same legs, with the added rows' right-hand sides drawn from the leaves of other trees.
    fn crossed_twin(&self, regular: &Transition, adds: Vec<ConstraintId>) -> Transition {
        let mut crossed = Transition {
            name: format!("{}_ls", regular.name),
            kind: TransitionKind::Crossed,
            adds: adds.clone(),
            ..regular.clone()
        };
        for leg in &mut crossed.legs {
            leg.name = leg.name.replace(&regular.name, &crossed.name);
            leg.drawn = leg.target.iter().copied().filter(|&c| self.leads_to(c, &adds)).collect();
        }
        crossed
    }

    /// Whether a constraint of a waypoint can already carry the drawn value of one of `adds`.
    fn leads_to(&self, target: ConstraintId, adds: &[ConstraintId]) -> bool {
        let kind = self.graph.constraint(target).kind;
        adds.iter().any(|&added| match (kind, self.graph.constraint(added).kind) {
            (ConstraintKind::Preplacement { object }, ConstraintKind::Placement { object: placed }) => object == placed,
            (ConstraintKind::Pregrasp { gripper, handle }, ConstraintKind::Grasp { gripper: g, handle: h }) => {
                gripper == g && handle == h
            }
            (a, b) => a == b,
        })
    }

    /// 01 approach, 12 close, 23 lift.
    fn grasping_legs(&mut self, name: &str, change: Change) -> Vec<Leg> {
        let Change { gripper, handle, object, without, with } = change;
        let mut waypoints = Vec::new();
        if self.has_pregrasp(change) {
            waypoints.push(("01", without, ConstraintKind::Pregrasp { gripper, handle }));
        }
        waypoints.push(("12", without, ConstraintKind::Grasp { gripper, handle }));
        if self.has_preplacement(change) {
            waypoints.push(("23", with, ConstraintKind::Preplacement { object: object as u32 }));
        }
        let first = waypoints[0].0;
        waypoints
            .into_iter()
            .map(|(number, state, kind)| self.leg(name, number, state, Some(kind), number != first))
            .collect()
    }

    /// 43 approach with the object, 32 put down, 21 retreat.
    fn releasing_legs(&mut self, name: &str, change: Change) -> Vec<Leg> {
        let Change { gripper, handle, object, without, with } = change;
        let held_otherwise = self.held_otherwise(change);
        let mut legs = Vec::new();
        if !held_otherwise {
            let lifted = self.has_preplacement(change);
            if lifted {
                let kind = ConstraintKind::Preplacement { object: object as u32 };
                legs.push(self.leg(name, "43", with, Some(kind), false));
            }
            let rest = self.resting_constraint(object);
            let kind = self.graph.constraint(rest).kind;
            legs.push(self.leg(name, "32", with, Some(kind), lifted));
        }
        // Where another hand keeps the object, this one only backs off: random motion belongs to the loop of that state.
        if self.has_pregrasp(change) {
            legs.push(self.leg(name, "21", without, Some(ConstraintKind::Pregrasp { gripper, handle }), true));
        } else if held_otherwise {
            legs.push(self.leg(name, "21", without, None, false));
        }
        legs
    }

    fn leg(&mut self, name: &str, number: &str, state: StateId, target: Option<ConstraintKind>, short: bool) -> Leg {
        let target = target.map(|kind| self.constraint(kind)).into_iter().collect();
        Leg { name: format!("{name}_{number}"), state, target, drawn: Vec::new(), short }
    }

    fn has_pregrasp(&self, change: Change) -> bool {
        self.robot.grippers[change.gripper.at()].clearance + self.robot.handles[change.handle.at()].clearance > 0.0
    }

    /// Whether an object needs something to rest on.
    fn rests(&self, object: usize) -> bool {
        let options = &self.options.objects[object];
        !options.surfaces.is_empty() || options.plane.is_some()
    }

    fn has_preplacement(&self, change: Change) -> bool {
        self.rests(change.object) && self.options.preplacement_distance > 0.0 && !self.held_otherwise(change)
    }

    /// Whether another gripper holds the object in both states.
    fn held_otherwise(&self, change: Change) -> bool {
        self.graph.state(change.without).grasps.iter().any(|&(_, h)| self.object_of(h) == change.object)
    }

    /// The object of a handle. Handles of the graph belong to its objects by construction.
    fn object_of(&self, handle: HandleIndex) -> usize {
        self.options.objects.iter().position(|o| o.handles.contains(&handle)).unwrap_or(usize::MAX)
    }

    fn state_name(&self, grasps: &Grasps) -> String {
        if grasps.is_empty() {
            return "free".into();
        }
        let name = |&(g, h): &(GripperIndex, HandleIndex)| {
            format!("{} grasps {}", self.robot.grippers[g.at()].name, self.robot.handles[h.at()].name)
        };
        grasps.iter().map(name).collect::<Vec<_>>().join(" : ")
    }

    /// HPP's short names: `0-1:1-0` for gripper 0 on handle 1 and gripper 1 on handle 0, `f` for free.
    fn abbreviation(&self, state: StateId) -> String {
        let grasps = &self.graph.state(state).grasps;
        if grasps.is_empty() {
            return "f".into();
        }
        let handles: Vec<_> = self.options.objects.iter().flat_map(|o| &o.handles).collect();
        let short = |&(gripper, handle): &(GripperIndex, HandleIndex)| {
            let g = self.options.grippers.iter().position(|&x| x == gripper).unwrap_or_default();
            let h = handles.iter().position(|&&x| x == handle).unwrap_or_default();
            format!("{g}-{h}")
        };
        grasps.iter().map(short).collect::<Vec<_>>().join(":")
    }

    fn link_reverses(&mut self) {
        let regular: HashMap<(StateId, StateId), TransitionId> = (0..)
            .map(TransitionId)
            .zip(&self.graph.transitions)
            .filter(|(_, t)| t.kind == TransitionKind::Regular)
            .map(|(id, t)| ((t.from, t.to), id))
            .collect();
        for (index, transition) in self.graph.transitions.iter_mut().enumerate() {
            transition.reverse = match transition.kind {
                TransitionKind::Loop => Some(TransitionId(index as u32)),
                TransitionKind::Regular | TransitionKind::Crossed => {
                    regular.get(&(transition.to, transition.from)).copied()
                }
            };
        }
    }
}
