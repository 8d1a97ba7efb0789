//! What distinguishes the states of a constraint graph, and what each of them requires. Both follow from the problem's documents, so
//! a state need not exist to be known.

use crate::planning_model::graph::attachment_order::{Chain, grasp_of, is_beyond, root_of};
use crate::planning_model::graph::checks::GraphError;
use crate::planning_model::graph::states::own_constraints::own_constraints;
use crate::planning_model::graph::support_placement::{LiftLines, carrying_bodies, lift_lines};
use foliate_components::constraint::{ApproachBound, Grasp};
use foliate_components::graph::{ConstraintKind, Fingers, Opening};
use foliate_components::problem::{GraphOptions, JointRest, Problem};
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex, Robot};
use std::collections::HashMap;

/// Who holds what, in the order of the problem's grippers.
pub(crate) type Grasps = Vec<(GripperIndex, HandleIndex)>;

/// By object: the body on which it lies; `None` for the world, and for objects that lie nowhere.
pub(crate) type Lying = Vec<Option<JointIndex>>;

/// What tells states apart.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct StateKey {
    /// Number of the problem's own state; 0 where there are none.
    pub written: usize,
    pub grasps: Grasps,
    pub lying: Lying,
    /// Only legs of transitions lie in states in which they do not hold still as ever.
    pub fingers: Fingers,
}

/// What is read of a problem once.
#[derive(Clone, Debug)]
pub(crate) struct Documents {
    /// By object: the bodies that may carry it where it lies.
    pub bodies: Vec<Vec<Option<JointIndex>>>,
    /// Documents of the grasps that the table allows.
    pub grasps: HashMap<(GripperIndex, HandleIndex), Grasp>,
    /// Lifts that are straight.
    pub lifts: LiftLines,
}

impl Documents {
    /// Reads a problem.
    ///
    /// # Errors
    /// A handle whose mask makes no grasp.
    pub fn new(problem: &Problem) -> Result<Self, GraphError> {
        let (robot, options) = (&problem.robot, &problem.graph);
        let mut grasps = HashMap::new();
        for &gripper in &options.grippers {
            for handle in handles(options) {
                if in_table(options, gripper, handle) {
                    let name = || robot.handles[handle.at()].name.clone();
                    let grasp = grasp_of(problem, gripper, handle);
                    grasps.insert(
                        (gripper, handle),
                        grasp.map_err(|source| GraphError::Handle { handle: name(), source })?,
                    );
                }
            }
        }
        let bodies = options
            .objects
            .iter()
            .map(|object| carrying_bodies(robot, options, object).into_iter().map(|(body, _)| body).collect());
        Ok(Self { bodies: bodies.collect(), grasps, lifts: lift_lines(robot, options) })
    }
}

/// The handles of all objects, in their order.
pub(crate) fn handles(options: &GraphOptions) -> impl Iterator<Item = HandleIndex> {
    options.objects.iter().flat_map(|o| o.handles.iter().copied())
}

fn in_table(options: &GraphOptions, gripper: GripperIndex, handle: HandleIndex) -> bool {
    options.grasps.as_ref().is_none_or(|table| table.contains(&(gripper, handle)))
}

/// All injective maps from grippers to handles among the grasps that `may` be, by increasing cardinal (P1 Alg. 1 lines
/// 7-8), without those that the rules refuse; `None` where there are more than `most`.
pub(crate) fn grasp_sets(
    options: &GraphOptions,
    may: impl Fn(GripperIndex, HandleIndex) -> bool,
    most: usize,
) -> Option<Vec<Grasps>> {
    let mut sets: Vec<Grasps> = vec![Vec::new()];
    for &gripper in &options.grippers {
        let known = sets.len();
        let wanted: Vec<_> = handles(options).filter(|&h| in_table(options, gripper, h) && may(gripper, h)).collect();
        for index in 0..known {
            for &handle in &wanted {
                if sets[index].iter().any(|&(_, h)| h == handle) {
                    continue;
                }
                let mut larger = sets[index].clone();
                larger.push((gripper, handle));
                sets.push(larger);
                if sets.len() > most {
                    return None;
                }
            }
        }
    }
    sets.retain(|grasps| rules_allow(options, grasps));
    // Stable: within a cardinal the order of grippers and handles stays.
    sets.sort_by_key(Vec::len);
    Some(sets)
}

/// The first rule that applies decides; once there are rules, a state to which none applies is refused (HPP's reading).
fn rules_allow(options: &GraphOptions, grasps: &Grasps) -> bool {
    let holds = |gripper| grasps.iter().find(|&&(g, _)| g == gripper).map(|&(_, h)| h);
    let deciding = options.rules.iter().find(|rule| rule.grasps.iter().all(|&(g, h)| holds(g) == h));
    deciding.map_or(options.rules.is_empty(), |rule| rule.allowed)
}

/// A problem and its documents, to be asked.
#[derive(Clone, Copy)]
pub(crate) struct StateKeys<'a> {
    pub robot: &'a Robot,
    pub options: &'a GraphOptions,
    pub documents: &'a Documents,
}

impl<'a> StateKeys<'a> {
    pub fn new(problem: &'a Problem, documents: &'a Documents) -> Self {
        Self { robot: &problem.robot, options: &problem.graph, documents }
    }

    /// Whether grasps make a state: each in the table, no handle in two grippers, and the rules agree.
    pub fn are_allowed(&self, grasps: &Grasps) -> bool {
        let known = |&(gripper, handle): &(GripperIndex, HandleIndex)| {
            let once = grasps.iter().filter(|&&(_, h)| h == handle).count() == 1;
            once && self.documents.grasps.contains_key(&(gripper, handle))
        };
        grasps.iter().all(known) && rules_allow(self.options, grasps)
    }

    /// What the grasps carry; no object lies anywhere yet.
    pub fn held(&self, grasps: &Grasps) -> Chain<'a> {
        let mut chain = Chain::new(self.robot, &self.options.objects);
        let documents = self.documents;
        let grasps = grasps.iter().filter_map(|&(g, h)| Some((self.object_of(h), documents.grasps.get(&(g, h))?)));
        chain.hold(grasps, |_, _| ());
        chain
    }

    /// Every way in which the objects that nothing holds may lie, none on itself by way of others, on bodies that they `may`
    /// lie on. `None` where there are more than `most`.
    pub fn ways_to_lie(
        &self,
        grasps: &Grasps,
        may: impl Fn(usize, Option<JointIndex>) -> bool,
        most: usize,
    ) -> Option<Vec<Lying>> {
        let held = self.held(grasps);
        let bodies = &self.documents.bodies;
        let mut ways = vec![(held.clone(), vec![None; bodies.len()])];
        for (object, bodies) in bodies.iter().enumerate() {
            if bodies.is_empty() || held.is_carried(object) || self.root(object).is_none() {
                continue;
            }
            let bodies: Vec<_> = bodies.iter().copied().filter(|&body| may(object, body)).collect();
            let mut longer = Vec::new();
            for (chain, lying) in &ways {
                for &body in &bodies {
                    let (mut chain, mut lying) = (chain.clone(), lying.clone());
                    if chain.attach(object, body) {
                        lying[object] = body;
                        longer.push((chain, lying));
                    }
                }
                if longer.len() > most {
                    return None;
                }
            }
            ways = longer;
        }
        Some(ways.into_iter().map(|(_, lying)| lying).collect())
    }

    /// What holds everywhere in a state, each constraint once.
    pub fn manifold(&self, key: &StateKey) -> Vec<ConstraintKind> {
        let held = self.held(&key.grasps);
        let mut manifold = Vec::new();
        for object in 0..self.options.objects.len() {
            if self.root(object).is_some() && !held.is_carried(object) {
                manifold.push(self.resting_constraint(object, key.lying[object]));
            }
        }
        manifold.extend(key.grasps.iter().map(|&(gripper, handle)| ConstraintKind::Grasp { gripper, handle }));
        for joint in 0..self.options.resting_joints.len() {
            if !self.is_let_go(joint, &key.grasps) {
                manifold.push(ConstraintKind::JointRest { joint: joint as u32 });
            }
        }
        manifold.extend(self.fingers(key));
        if let Fingers::OnLine { gripper, handle, .. } = key.fingers {
            manifold.extend(self.on_line(gripper, handle));
        }
        if let Fingers::Lifting { object, on } = key.fingers {
            manifold.push(ConstraintKind::Lift { object, on });
        }
        let is_held = |part| {
            let holds =
                |&(_, handle): &_| self.options.objects.get(self.object_of(handle)).is_some_and(|o| o.part == part);
            key.grasps.iter().any(holds)
        };
        manifold.extend(own_constraints(self.options, key.written, is_held));
        manifold
    }

    /// Where the fingers of all hands are that hold still.
    fn fingers<'k>(&'k self, key: &'k StateKey) -> impl Iterator<Item = ConstraintKind> + 'k {
        let opening = move |hand: u32| match key.fingers {
            Fingers::Moving(moving) if moving == hand => None,
            Fingers::Free => None,
            Fingers::Wide(wide) if wide == hand => Some(Opening::Wide),
            Fingers::Ready { hand: ready, gripper, handle } if ready == hand => {
                Some(Opening::Ready { gripper, handle })
            }
            Fingers::OnLine { open: Some(open), gripper, handle } if open == hand => Some(self.beside(gripper, handle)),
            _ => Some(self.opening(hand, &key.grasps)),
        };
        let hands = (0u32..).zip(&self.options.hands);
        hands.filter_map(move |(number, hand)| Some((number, hand, opening(number)?))).flat_map(
            |(number, hand, opening)| {
                (0..hand.fingers.len() as u32).map(move |finger| ConstraintKind::Finger {
                    hand: number,
                    finger,
                    opening,
                })
            },
        )
    }

    /// How far a hand is open while it does not move its fingers.
    fn opening(&self, hand: u32, grasps: &Grasps) -> Opening {
        let grippers = &self.options.hands[hand as usize].grippers;
        let held = grasps.iter().find(|(gripper, _)| grippers.contains(gripper));
        held.map_or_else(|| self.travel(hand), |&(gripper, handle)| Opening::Closed { gripper, handle })
    }

    /// How far a hand is open while it is empty.
    pub fn travel(&self, hand: u32) -> Opening {
        if self.options.hands[hand as usize].travels_open() { Opening::Wide } else { Opening::Travel }
    }

    /// The hand of a gripper that holds nothing yet with another of its grippers: it opens and closes with a grasp.
    pub fn hand_of(&self, gripper: GripperIndex, without: &Grasps) -> Option<u32> {
        let hand = self.options.hands.iter().position(|hand| hand.grippers.contains(&gripper))?;
        let record = &self.options.hands[hand];
        let is_empty = without.iter().all(|(gripper, _)| !record.grippers.contains(gripper));
        (is_empty && !record.fingers.is_empty()).then_some(hand as u32)
    }

    /// What keeps an object in place while no gripper holds it.
    pub fn resting_constraint(&self, object: usize, on: Option<JointIndex>) -> ConstraintKind {
        let rests = !self.documents.bodies[object].is_empty();
        let object = object as u32;
        if rests { ConstraintKind::Placement { object, on } } else { ConstraintKind::Rest { object } }
    }

    /// Whether a handle beyond a resting joint is held.
    fn is_let_go(&self, joint: usize, grasps: &Grasps) -> bool {
        let joint = self.options.resting_joints[joint].joint;
        let body = |handle: HandleIndex| self.robot.links[self.robot.handles[handle.at()].link.at()].joint;
        grasps.iter().any(|&(_, handle)| is_beyond(self.robot, body(handle), joint))
    }

    /// The free-flyer of an object.
    pub fn root(&self, object: usize) -> Option<JointIndex> {
        root_of(self.robot, self.options.objects.get(object)?.part)
    }

    /// The object of a handle. Handles of the graph belong to its objects by construction.
    fn object_of(&self, handle: HandleIndex) -> usize {
        self.options.objects.iter().position(|o| o.handles.contains(&handle)).unwrap_or(usize::MAX)
    }

    /// The grasps with one more, in the order of the problem's grippers.
    pub fn sorted_with(&self, grasps: &Grasps, gripper: GripperIndex, handle: HandleIndex) -> Grasps {
        let mut more = grasps.clone();
        more.push((gripper, handle));
        let rank = |g: GripperIndex| self.options.grippers.iter().position(|&x| x == g);
        more.sort_by_key(|&(g, _)| rank(g));
        more
    }

    /// Whether there is room to stand back before a grasp.
    pub fn has_pregrasp(&self, gripper: GripperIndex, handle: HandleIndex) -> bool {
        self.robot.grippers[gripper.at()].clearance + self.robot.handles[handle.at()].clearance > 0.0
    }

    /// A constraint's name, and whether it has parameters.
    pub fn describe(&self, kind: ConstraintKind) -> (String, bool) {
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
            ConstraintKind::Approach { gripper, handle, bound } => {
                let (g, h) = documents(gripper, handle);
                let what = match bound {
                    ApproachBound::Line => "is on the line to",
                    ApproachBound::Aim => "points at",
                    ApproachBound::Roll => "is not rolled against",
                };
                (format!("{g} {what} {}", h.name), false)
            }
            ConstraintKind::Placement { object, on } => (placed("place", object, on), true),
            ConstraintKind::Preplacement { object, on } => (placed("preplace", object, on), false),
            ConstraintKind::Lift { object, on } => (placed("lift", object, on), true),
            ConstraintKind::Rest { object } => (format!("rest_{}", self.object_name(object as usize)), true),
            ConstraintKind::JointRest { joint } => {
                let resting = &self.options.resting_joints[joint as usize];
                let stays = matches!(resting.rest, JointRest::Stays);
                (format!("rest_{}", self.robot.joints[resting.joint.at()].name), stays)
            }
            ConstraintKind::Finger { hand, finger, opening } => {
                let finger = self.options.hands[hand as usize].fingers[finger as usize].joint;
                let finger = &self.robot.joints[finger.at()].name;
                let name = match opening {
                    Opening::Travel => format!("travel_{finger}"),
                    Opening::Wide => format!("open_{finger}"),
                    Opening::Ready { handle, .. } => {
                        format!("open_{finger}_for_{}", self.robot.handles[handle.at()].name)
                    }
                    Opening::Closed { handle, .. } => {
                        format!("close_{finger}_on_{}", self.robot.handles[handle.at()].name)
                    }
                };
                (name, false)
            }
            ConstraintKind::Given { constraint } | ConstraintKind::WhileHeld { constraint } => {
                let given = &self.options.constraints[constraint as usize];
                (given.name.clone(), given.constraint.foliates())
            }
        }
    }
}
