//! Builds the constraint graph of a problem: P1 Algorithm 1, with the waypoints of P0 §III-C.
//!
//! A state is one of the problem's own states (one that demands nothing, where there are none), an injective map from some
//! grippers to handles, and for every object that nothing holds the body on which it lies (or it stays where it is, when it
//! has no surfaces). A transition adds or takes away one grasp, or goes from one of the problem's own states to another.
//! Between two states lie waypoints; for a grasp in HPP's order and numbering (its factory's `_pregrasp`, `_intersec`,
//! `_preplace`):
//!
//! | number | waypoint | holds besides the state's manifold |
//! |---|---|---|
//! | 1 | pre-grasp | the gripper stands back along its x axis |
//! | 2 | intersection | grasp, and what holds while the grasp does not: placement, doors at rest |
//! | 3 | pre-placement | grasp, and the object lifted along the support's normal |
//!
//! Legs 01 and 12 lie in the state without the grasp, 23 in the state with it. HPP's last leg of either direction (34, 10)
//! has no length, because the waypoint already satisfies the target: it is left out.

use crate::carriers::{Chain, grasp_of, is_beyond, root_of};
use crate::resting::carrying_bodies;
use foliate_components::constraint::Grasp;
use foliate_components::graph::{
    ConstraintGraph, ConstraintId, ConstraintKind, GraphConstraint, Leg, State, StateId, Transition, TransitionId,
    TransitionKind,
};
use foliate_components::problem::{GraphOptions, JointRest, Problem, WrittenTransition};
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex, Robot, RootJoint};
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
    #[error(
        "object `{0}` has surfaces, but no support that is not its own is named; name supports or take the surfaces away"
    )]
    NoSupport(String),
    #[error("object `{0}` does not move freely (its root joint is neither a free-flyer nor fixed)")]
    ObjectNotFree(String),
    #[error("handle `{0}`: {1}")]
    Handle(String, String),
    #[error("{user} names constraint number {number}, and the problem has {count}")]
    NoSuchConstraint { user: String, number: u32, count: usize },
    #[error("transition `{transition}` names state number {number}, and the problem has {count} of its own")]
    NoSuchState { transition: String, number: u32, count: usize },
    #[error("resting joint `{0}` has not exactly one coordinate of its own")]
    RestingJoint(String),
    #[error("no state is allowed: every combination of grasps is refused by the rules")]
    NothingAllowed,
}

/// Builds states, transitions and crossed transitions.
///
/// # Errors
/// See [`GraphError`].
pub fn build_constraint_graph(problem: &Problem) -> Result<ConstraintGraph, GraphError> {
    check_objects(problem)?;
    check_numbers(&problem.graph)?;
    check_resting_joints(problem)?;
    let mut builder = Builder::new(problem)?;
    for grasps in allowed_grasp_sets(&problem.graph)? {
        builder.make_states(&grasps)?;
    }
    if builder.graph.states.is_empty() {
        return Err(GraphError::NothingAllowed);
    }
    builder.make_transitions();
    Ok(builder.graph)
}

fn check_objects(problem: &Problem) -> Result<(), GraphError> {
    let (robot, options) = (&problem.robot, &problem.graph);
    for object in &options.objects {
        let part = &robot.parts[object.part.at()];
        if part.root == RootJoint::Planar {
            return Err(GraphError::ObjectNotFree(part.name.clone()));
        }
        let moves = root_of(robot, object.part).is_some();
        if moves && !object.surfaces.is_empty() && carrying_bodies(robot, options, object).is_empty() {
            return Err(GraphError::NoSupport(part.name.clone()));
        }
    }
    Ok(())
}

/// Numbers come from hosts too, not only from files that have been read with care.
fn check_numbers(options: &GraphOptions) -> Result<(), GraphError> {
    let constraints = |user: &str, numbers: &[u32]| {
        let count = options.constraints.len();
        match numbers.iter().find(|&&n| n as usize >= count) {
            Some(&number) => Err(GraphError::NoSuchConstraint { user: user.into(), number, count }),
            None => Ok(()),
        }
    };
    constraints("`everywhere`", &options.everywhere)?;
    for state in &options.states {
        constraints(&format!("state `{}`", state.name), &state.constraints)?;
    }
    let count = options.states.len();
    for transition in &options.transitions {
        let named = [transition.from, transition.to].into_iter().chain(transition.legs.iter().map(|leg| leg.within));
        if let Some(number) = named.into_iter().find(|&n| n as usize >= count) {
            return Err(GraphError::NoSuchState { transition: transition.name.clone(), number, count });
        }
        for leg in &transition.legs {
            constraints(&format!("transition `{}`", transition.name), &leg.until)?;
        }
    }
    Ok(())
}

fn check_resting_joints(problem: &Problem) -> Result<(), GraphError> {
    use foliate_components::robot::Source;
    for resting in &problem.graph.resting_joints {
        let joint = &problem.robot.joints[resting.joint.at()];
        if joint.motion.configuration_size() != 1 || matches!(joint.source, Source::Follows { .. }) {
            return Err(GraphError::RestingJoint(joint.name.clone()));
        }
    }
    Ok(())
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

/// By object: the body on which it lies; `None` for the world, and for objects that lie nowhere.
type Lying = Vec<Option<JointIndex>>;

/// What tells states apart.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Case {
    /// Number of the problem's own state; 0 where there are none.
    written: usize,
    grasps: Grasps,
    lying: Lying,
}

struct Builder<'a> {
    robot: &'a Robot,
    options: &'a GraphOptions,
    /// By object: the bodies that may carry it where it lies.
    bodies: Vec<Vec<Option<JointIndex>>>,
    /// Documents of the grasps that the table allows.
    grasps: HashMap<(GripperIndex, HandleIndex), Grasp>,
    graph: ConstraintGraph,
    constraint_ids: HashMap<ConstraintKind, ConstraintId>,
    state_ids: HashMap<Case, StateId>,
    /// By state.
    cases: Vec<Case>,
}

/// A grasp that is made or released between two states.
#[derive(Clone, Copy)]
struct Change {
    gripper: GripperIndex,
    handle: HandleIndex,
    /// State without the grasp.
    without: StateId,
    /// State with the grasp.
    with: StateId,
}

impl<'a> Builder<'a> {
    fn new(problem: &'a Problem) -> Result<Self, GraphError> {
        let (robot, options) = (&problem.robot, &problem.graph);
        let mut grasps = HashMap::new();
        for &gripper in &options.grippers {
            for &handle in options.objects.iter().flat_map(|o| &o.handles) {
                if in_table(options, gripper, handle) {
                    let name = || robot.handles[handle.at()].name.clone();
                    let grasp = grasp_of(problem, gripper, handle);
                    grasps.insert((gripper, handle), grasp.map_err(|e| GraphError::Handle(name(), e.to_string()))?);
                }
            }
        }
        let bodies = options
            .objects
            .iter()
            .map(|object| carrying_bodies(robot, options, object).into_iter().map(|(body, _)| body).collect());
        Ok(Self {
            robot,
            options,
            bodies: bodies.collect(),
            grasps,
            graph: ConstraintGraph { objects: options.objects.clone(), ..ConstraintGraph::default() },
            constraint_ids: HashMap::new(),
            state_ids: HashMap::new(),
            cases: Vec::new(),
        })
    }

    /// P1 Algorithm 1, MAKESTATE, for each of the problem's own states and each way to lie.
    fn make_states(&mut self, grasps: &Grasps) -> Result<(), GraphError> {
        let ways = self.ways_to_lie(grasps, |_| None);
        for written in 0..self.options.states.len().max(1) {
            for lying in &ways {
                if self.graph.states.len() >= MOST_STATES {
                    let handles = self.options.objects.iter().map(|o| o.handles.len()).sum();
                    return Err(GraphError::TooManyStates { grippers: self.options.grippers.len(), handles });
                }
                self.make_state(Case { written, grasps: grasps.clone(), lying: lying.clone() });
            }
        }
        Ok(())
    }

    /// What the grasps carry; no object lies anywhere yet.
    fn held(&self, grasps: &Grasps) -> Chain<'a> {
        let mut chain = Chain::new(self.robot, &self.options.objects);
        let grasps = grasps.iter().filter_map(|&(g, h)| Some((self.object_of(h), self.grasps.get(&(g, h))?)));
        chain.hold(grasps, |_, _| ());
        chain
    }

    /// Every way in which the objects that nothing holds may lie, none on itself by way of others; `known` fixes bodies.
    fn ways_to_lie(&self, grasps: &Grasps, known: impl Fn(usize) -> Option<Option<JointIndex>>) -> Vec<Lying> {
        let held = self.held(grasps);
        let mut ways = vec![(held.clone(), vec![None; self.bodies.len()])];
        for (object, bodies) in self.bodies.iter().enumerate() {
            if bodies.is_empty() || held.is_carried(object) || self.root(object).is_none() {
                continue;
            }
            let known = known(object);
            let mut longer = Vec::new();
            for (chain, lying) in &ways {
                for &body in bodies.iter().filter(|&&body| known.is_none_or(|known| known == body)) {
                    let (mut chain, mut lying) = (chain.clone(), lying.clone());
                    if chain.hang(object, body) {
                        lying[object] = body;
                        longer.push((chain, lying));
                    }
                }
                if longer.len() > MOST_STATES {
                    break;
                }
            }
            ways = longer;
        }
        ways.into_iter().map(|(_, lying)| lying).collect()
    }

    fn make_state(&mut self, case: Case) {
        let held = self.held(&case.grasps);
        let mut manifold = Vec::new();
        for object in 0..self.options.objects.len() {
            if self.root(object).is_some() && !held.is_carried(object) {
                manifold.push(self.resting_constraint(object, case.lying[object]));
            }
        }
        for &(gripper, handle) in &case.grasps {
            manifold.push(self.constraint(ConstraintKind::Grasp { gripper, handle }));
        }
        for joint in 0..self.options.resting_joints.len() {
            if !self.is_let_go(joint, &case.grasps) {
                manifold.push(self.constraint(ConstraintKind::JointRest { joint: joint as u32 }));
            }
        }
        let own = self.options.states.get(case.written).map_or(&[][..], |state| &state.constraints);
        for &constraint in self.options.everywhere.iter().chain(own) {
            let id = self.constraint(ConstraintKind::Given { constraint });
            if !manifold.contains(&id) {
                manifold.push(id);
            }
        }
        let foliation = manifold.iter().copied().filter(|&c| self.graph.constraint(c).foliates).collect();
        let id = StateId(self.graph.states.len() as u32);
        self.graph.states.push(State {
            name: self.state_name(&case),
            written: (!self.options.states.is_empty()).then_some(case.written as u32),
            grasps: case.grasps.clone(),
            manifold,
            foliation,
            priority: case.grasps.len() as u32,
        });
        self.state_ids.insert(case.clone(), id);
        self.cases.push(case);
    }

    /// Whether a handle beyond a resting joint is held.
    fn is_let_go(&self, joint: usize, grasps: &Grasps) -> bool {
        let joint = self.options.resting_joints[joint].joint;
        let body = |handle: HandleIndex| self.robot.links[self.robot.handles[handle.at()].link.at()].joint;
        grasps.iter().any(|&(_, handle)| is_beyond(self.robot, body(handle), joint))
    }

    /// The free-flyer of an object.
    fn root(&self, object: usize) -> Option<JointIndex> {
        root_of(self.robot, self.options.objects.get(object)?.part)
    }

    /// What holds an object in place while nobody holds it.
    fn resting_constraint(&mut self, object: usize, on: Option<JointIndex>) -> ConstraintId {
        let rests = !self.bodies[object].is_empty();
        let object = object as u32;
        self.constraint(if rests { ConstraintKind::Placement { object, on } } else { ConstraintKind::Rest { object } })
    }

    fn constraint(&mut self, kind: ConstraintKind) -> ConstraintId {
        if let Some(&id) = self.constraint_ids.get(&kind) {
            return id;
        }
        let (name, foliates) = self.describe(kind);
        let id = ConstraintId(self.graph.constraints.len() as u32);
        self.graph.constraints.push(GraphConstraint { name, kind, foliates });
        self.constraint_ids.insert(kind, id);
        id
    }

    /// A constraint's name, and whether it has parameters.
    fn describe(&self, kind: ConstraintKind) -> (String, bool) {
        let documents = |gripper: GripperIndex, handle: HandleIndex| {
            (self.robot.grippers[gripper.at()].name.as_str(), &self.robot.handles[handle.at()])
        };
        let placed = |verb: &str, object: u32, on: Option<JointIndex>| {
            let name = format!("{verb}_{}", self.object_name(object as usize));
            on.map_or(name.clone(), |body| format!("{name}_on_{}", self.body_name(body)))
        };
        match kind {
            ConstraintKind::Grasp { gripper, handle } => {
                let (g, h) = documents(gripper, handle);
                let frozen = h.mask.iter().zip(&h.mask_complement).any(|(zero, kept)| *kept && !zero);
                (format!("{g} grasps {}", h.name), frozen)
            }
            ConstraintKind::Pregrasp { gripper, handle } => {
                let (g, h) = documents(gripper, handle);
                (format!("{g} pregrasps {}", h.name), false)
            }
            ConstraintKind::Placement { object, on } => (placed("place", object, on), true),
            ConstraintKind::Preplacement { object, on } => (placed("preplace", object, on), false),
            ConstraintKind::Rest { object } => (format!("rest_{}", self.object_name(object as usize)), true),
            ConstraintKind::JointRest { joint } => {
                let resting = &self.options.resting_joints[joint as usize];
                let stays = matches!(resting.rest, JointRest::Stays);
                (format!("rest_{}", self.robot.joints[resting.joint.at()].name), stays)
            }
            ConstraintKind::Given { constraint } => {
                let given = &self.options.constraints[constraint as usize];
                (given.name.clone(), given.constraint.foliates())
            }
        }
    }

    fn object_name(&self, object: usize) -> &str {
        &self.robot.parts[self.options.objects[object].part.at()].name
    }

    /// What a body that moves is called: its part, or its link where the part has several.
    fn body_name(&self, body: JointIndex) -> &str {
        let part = &self.robot.parts[self.robot.joints[body.at()].part.at()];
        let link = part.links.clone().find(|&l| self.robot.links[l].joint == Some(body));
        match link {
            Some(link) if part.root_joint != Some(body) => &self.robot.links[link].name,
            _ => &part.name,
        }
    }

    /// P1 Algorithm 1, lines 11-16 and MAKETRANSITIONS, grouped by the state that is left.
    fn make_transitions(&mut self) {
        for index in 0..self.graph.states.len() {
            let state = StateId(index as u32);
            let mut leaving = vec![self.loop_transition(state)];
            for change in self.changes_at(state) {
                leaving.extend(self.transitions_of(state, change));
            }
            let options = self.options;
            for written in &options.transitions {
                leaving.extend(self.written_transitions(state, written));
            }
            // Loops explore the leaf that a tree is on; one in eight extensions is enough (measured, see ARCHITECTURE).
            let others: f64 = leaving[1..].iter().map(|t| t.weight).sum();
            leaving[0].weight = if others > 0.0 { others / 7.0 } else { 1.0 };
            self.graph.transitions.extend(leaving);
        }
        self.link_reverses();
    }

    /// Every grasp that can be made or released from a state, with every way to lie of what is let go.
    fn changes_at(&self, state: StateId) -> Vec<Change> {
        let case = &self.cases[state.at()];
        let mut changes = Vec::new();
        for &gripper in &self.options.grippers {
            if let Some(&(_, handle)) = case.grasps.iter().find(|&&(g, _)| g == gripper) {
                let fewer: Grasps = case.grasps.iter().copied().filter(|&(g, _)| g != gripper).collect();
                let without = self.states_with(case, fewer);
                changes.extend(without.into_iter().map(|without| Change { gripper, handle, without, with: state }));
                continue;
            }
            for &handle in self.options.objects.iter().flat_map(|o| &o.handles) {
                if !self.grasps.contains_key(&(gripper, handle)) {
                    continue;
                }
                let with = self.states_with(case, self.sorted_with(&case.grasps, gripper, handle));
                changes.extend(with.into_iter().map(|with| Change { gripper, handle, without: state, with }));
            }
        }
        changes
    }

    /// The states with other grasps in which what lies in `case` and lies still, lies where it did.
    fn states_with(&self, case: &Case, grasps: Grasps) -> Vec<StateId> {
        let before = self.held(&case.grasps);
        let lies = |object: usize| (!before.is_carried(object)).then(|| case.lying[object]);
        let ways = self.ways_to_lie(&grasps, lies);
        let id = |lying| {
            let case = Case { written: case.written, grasps: grasps.clone(), lying };
            self.state_ids.get(&case).copied()
        };
        ways.into_iter().filter_map(id).collect()
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
        let (to, sign) = if grasping { (change.with, '>') } else { (change.without, '<') };
        let (gripper, handle) =
            (&self.robot.grippers[change.gripper.at()].name, &self.robot.handles[change.handle.at()].name);
        let name = match self.lying_name(&self.cases[change.without.at()], Some(&self.cases[change.with.at()])) {
            lying if lying.is_empty() || grasping => format!("{gripper} {sign} {handle} | {}", self.abbreviation(from)),
            lying => format!("{gripper} {sign} {handle}, {} | {}", lying.join(", "), self.abbreviation(from)),
        };
        let legs = if grasping { self.grasping_legs(&name, change) } else { self.releasing_legs(&name, change) };
        self.with_twin(name, from, to, legs)
    }

    /// A transition of the problem's own with the grasps of a state, and its crossed twin.
    fn written_transitions(&mut self, from: StateId, written: &WrittenTransition) -> Vec<Transition> {
        let case = self.cases[from.at()].clone();
        let at = |number: u32| self.state_ids.get(&Case { written: number as usize, ..case.clone() }).copied();
        if case.written != written.from as usize {
            return Vec::new();
        }
        let (Some(to), Some(within)) =
            (at(written.to), written.legs.iter().map(|leg| at(leg.within)).collect::<Option<Vec<_>>>())
        else {
            return Vec::new();
        };
        let name = format!("{} | {}", written.name, self.abbreviation(from));
        let mut legs: Vec<Leg> = Vec::new();
        for (number, (leg, &state)) in written.legs.iter().zip(&within).enumerate() {
            let until = leg.until.iter().map(|&constraint| self.constraint(ConstraintKind::Given { constraint }));
            let target: Vec<ConstraintId> = until.collect();
            let name = format!("{name}_{number}{}", number + 1);
            legs.push(Leg { name, state, target, drawn: Vec::new(), short: leg.short });
        }
        if legs.is_empty() {
            let name = format!("{name}_01");
            legs.push(Leg { name, state: from, target: Vec::new(), drawn: Vec::new(), short: false });
        }
        // Where a leg ends, the next one's state must hold.
        for number in 0..legs.len() {
            let next = legs.get(number + 1).map_or(to, |leg| leg.state);
            let here = &self.graph.state(legs[number].state).manifold;
            let mut target: Vec<_> = legs[number].target.iter().copied().filter(|c| !here.contains(c)).collect();
            for constraint in self.difference(next, legs[number].state) {
                if !target.contains(&constraint) {
                    target.push(constraint);
                }
            }
            legs[number].target = target;
        }
        self.with_twin(name, from, to, legs)
    }

    /// What `state` demands and `other` does not.
    fn difference(&self, state: StateId, other: StateId) -> Vec<ConstraintId> {
        let other = &self.graph.state(other).manifold;
        self.graph.state(state).manifold.iter().copied().filter(|c| !other.contains(c)).collect()
    }

    /// A regular transition, and its crossed twin where the target's foliation has rows to aim at.
    fn with_twin(&self, name: String, from: StateId, to: StateId, legs: Vec<Leg>) -> Vec<Transition> {
        let source = &self.graph.state(from).foliation;
        let adds: Vec<_> = self.graph.state(to).foliation.iter().copied().filter(|c| !source.contains(c)).collect();
        let kind = TransitionKind::Regular;
        let regular = Transition { name, from, to, kind, weight: 1.0, legs, adds: adds.clone(), reverse: None };
        if adds.is_empty() {
            return vec![regular];
        }
        let crossed = self.crossed_twin(&regular, adds);
        // Rows that hold at the start already cannot be aimed at.
        if crossed.legs.iter().all(|leg| leg.drawn.is_empty()) {
            return vec![regular];
        }
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
        let wanted = led_to(self.graph.constraint(target).kind);
        adds.iter().any(|&added| self.graph.constraint(added).kind == wanted)
    }

    /// 01 approach, 12 close, 23 lift.
    fn grasping_legs(&mut self, name: &str, change: Change) -> Vec<Leg> {
        let Change { gripper, handle, without, with } = change;
        let mut legs = Vec::new();
        if self.has_pregrasp(change) {
            let target = vec![self.constraint(ConstraintKind::Pregrasp { gripper, handle })];
            legs.push(leg(name, "01", without, target, false));
        }
        legs.push(leg(name, "12", without, self.difference(with, without), !legs.is_empty()));
        let lifted = self.lifted(&self.difference(without, with));
        if !lifted.is_empty() {
            legs.push(leg(name, "23", with, lifted, true));
        }
        legs
    }

    /// 43 approach with the object, 32 put down and shut, 21 retreat.
    fn releasing_legs(&mut self, name: &str, change: Change) -> Vec<Leg> {
        let Change { gripper, handle, without, with } = change;
        let lost = self.difference(without, with);
        let mut legs = Vec::new();
        let lifted = self.lifted(&lost);
        if !lifted.is_empty() {
            legs.push(leg(name, "43", with, lifted, false));
        }
        let stays = lost.is_empty();
        if !stays {
            legs.push(leg(name, "32", with, lost, !legs.is_empty()));
        }
        // Where another hand keeps the object, this one only backs off: random motion belongs to the loop of that state.
        if self.has_pregrasp(change) {
            let target = vec![self.constraint(ConstraintKind::Pregrasp { gripper, handle })];
            legs.push(leg(name, "21", without, target, true));
        } else if stays {
            legs.push(leg(name, "21", without, Vec::new(), false));
        }
        legs
    }

    fn has_pregrasp(&self, change: Change) -> bool {
        self.robot.grippers[change.gripper.at()].clearance + self.robot.handles[change.handle.at()].clearance > 0.0
    }

    /// The pre-placements of those of the constraints that are placements.
    fn lifted(&mut self, constraints: &[ConstraintId]) -> Vec<ConstraintId> {
        if self.options.preplacement_distance <= 0.0 {
            return Vec::new();
        }
        let placed = constraints.iter().filter_map(|&c| match self.graph.constraint(c).kind {
            ConstraintKind::Placement { object, on } => Some(ConstraintKind::Preplacement { object, on }),
            _ => None,
        });
        let placed: Vec<_> = placed.collect();
        placed.into_iter().map(|kind| self.constraint(kind)).collect()
    }

    /// The object of a handle. Handles of the graph belong to its objects by construction.
    fn object_of(&self, handle: HandleIndex) -> usize {
        self.options.objects.iter().position(|o| o.handles.contains(&handle)).unwrap_or(usize::MAX)
    }

    fn state_name(&self, case: &Case) -> String {
        let grasp = |&(g, h): &(GripperIndex, HandleIndex)| {
            format!("{} grasps {}", self.robot.grippers[g.at()].name, self.robot.handles[h.at()].name)
        };
        let written = self.options.states.get(case.written).map(|state| state.name.clone());
        let mut words: Vec<String> = written.into_iter().chain(case.grasps.iter().map(grasp)).collect();
        if words.is_empty() {
            words.push("free".into());
        }
        words.extend(self.lying_name(case, None));
        words.join(" : ")
    }

    /// `lid on box` for every object that lies on a body which moves, and not in the other case.
    fn lying_name(&self, case: &Case, other: Option<&Case>) -> Vec<String> {
        let lies = |object: usize| {
            let body =
                case.lying[object].filter(|_| other.is_none_or(|other| other.lying[object] != case.lying[object]));
            body.map(|body| format!("{} on {}", self.object_name(object), self.body_name(body)))
        };
        (0..case.lying.len()).filter_map(lies).collect()
    }

    /// HPP's short names: `0-1:1-0` for gripper 0 on handle 1 and gripper 1 on handle 0, `f` for free.
    fn abbreviation(&self, state: StateId) -> String {
        let case = &self.cases[state.at()];
        let handles: Vec<_> = self.options.objects.iter().flat_map(|o| &o.handles).collect();
        let short = |&(gripper, handle): &(GripperIndex, HandleIndex)| {
            let g = self.options.grippers.iter().position(|&x| x == gripper).unwrap_or_default();
            let h = handles.iter().position(|&&x| x == handle).unwrap_or_default();
            format!("{g}-{h}")
        };
        let grasps = case.grasps.iter().map(short).collect::<Vec<_>>().join(":");
        let written = self.options.states.get(case.written).map(|state| state.name.clone());
        let mut words: Vec<String> = written.into_iter().chain((!grasps.is_empty()).then_some(grasps)).collect();
        if words.is_empty() {
            words.push("f".into());
        }
        words.extend(self.lying_name(case, None));
        words.join(" : ")
    }

    /// A motion travelled backwards is one of a transition back: where there are several, the one with the same legs.
    fn link_reverses(&mut self) {
        let mut regular: HashMap<(StateId, StateId), Vec<TransitionId>> = HashMap::new();
        for (index, transition) in self.graph.transitions.iter().enumerate() {
            if transition.kind == TransitionKind::Regular {
                let ends = (transition.from, transition.to);
                regular.entry(ends).or_default().push(TransitionId(index as u32));
            }
        }
        let reverse = |index: usize, transition: &Transition| {
            if transition.kind == TransitionKind::Loop {
                return Some(TransitionId(index as u32));
            }
            let back = regular.get(&(transition.to, transition.from))?;
            let same = |&&id: &&TransitionId| {
                let legs = &self.graph.transition(id).legs;
                legs.iter().map(|l| l.state).eq(transition.legs.iter().rev().map(|l| l.state))
            };
            back.iter().find(same).or(back.first()).copied()
        };
        let reverses: Vec<_> = self.graph.transitions.iter().enumerate().map(|(i, t)| reverse(i, t)).collect();
        for (transition, reverse) in self.graph.transitions.iter_mut().zip(reverses) {
            transition.reverse = reverse;
        }
    }
}

fn leg(name: &str, number: &str, state: StateId, target: Vec<ConstraintId>, short: bool) -> Leg {
    Leg { name: format!("{name}_{number}"), state, target, drawn: Vec::new(), short }
}

/// The constraint whose value a waypoint's constraint leads to.
#[must_use]
pub fn led_to(kind: ConstraintKind) -> ConstraintKind {
    match kind {
        ConstraintKind::Preplacement { object, on } => ConstraintKind::Placement { object, on },
        ConstraintKind::Pregrasp { gripper, handle } => ConstraintKind::Grasp { gripper, handle },
        other => other,
    }
}
