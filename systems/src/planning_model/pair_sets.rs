//! Which pairs of shapes matter where, and whether a configuration keeps them apart.

use crate::planning_model::graph::attachment_order::is_beyond;
use crate::planning_model::model::Model;
use foliate_components::Pose;
use foliate_components::constraint::Frame;
use foliate_components::graph::{ConstraintKind, StateId, TransitionId};
use foliate_components::robot::{JointIndex, LinkIndex, Robot, ShapeIndex};
use foliate_kernels::collision::depth::{PlacedSolid, depth};
use foliate_kernels::collision::{
    CollisionScratch, Contact, PairId, PairSet, RigidPair, all_collisions, first_collision, rigid_collisions,
};
use foliate_kernels::kinematics::RigidAttachment;
use std::borrow::Cow;

/// Pairs of links that touch, by what makes them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Touches {
    pub grasped: Vec<(LinkIndex, LinkIndex)>,
    pub placed: Vec<(LinkIndex, LinkIndex)>,
}

impl Model {
    /// The pairs of shapes on motions of a transition that lie in `state`. Which pairs move depends on who carries whom,
    /// which the state decides; margins are lifted from what touches at either end of the transition.
    #[must_use]
    pub fn pairs(&self, transition: TransitionId, state: StateId, rigid_attachments: &[RigidAttachment]) -> &PairSet {
        let with_rigid_pairs = |pairs: PairSet| Box::new(pairs.with_rigid_pairs(self.rigid_pairs(state)));
        let shared = || {
            self.states[state.at()]
                .pairs
                .get_or_init(|| with_rigid_pairs(PairSet::new(&self.collision, rigid_attachments, &[])))
        };
        if self.problem.margins.is_empty() {
            return shared();
        }
        let ends = self.graph.transition(transition);
        // Motions that only enter the target come after the last leg; they stand still, and margins do not matter.
        let Some(leg) = ends.legs.iter().position(|leg| leg.state == state) else { return shared() };
        self.leg_tables(transition)[leg].pairs.get_or_init(|| {
            let touching = self.touching_along(transition);
            with_rigid_pairs(PairSet::new(&self.collision, rigid_attachments, &touching))
        })
    }

    /// The pairs of shapes of two bodies that are `wanted` (`None` is the world), without margins.
    pub(crate) fn pairs_between(&self, wanted: impl Fn(Option<JointIndex>, Option<JointIndex>) -> bool) -> PairSet {
        self.all_pairs.between(&self.collision, wanted)
    }

    /// What motions in a state keep together, though it is carried by neither: a second hand and what it holds, say.
    fn rigid_pairs(&self, state: StateId) -> Vec<RigidPair> {
        let rigid = self.interior_program(state).map_or(&[][..], |interior| &interior.rigid);
        let rigid_pair =
            |(a, b): &(Frame, Frame)| RigidPair { a: a.joint, b: b.joint, origin: b.joint_from_frame.translation };
        rigid.iter().map(rigid_pair).collect()
    }

    /// The pairs of a motion that is part of a transition which is not travelled to its end: margins are lifted only from what
    /// touches where it begins, or in the states in which its legs lie.
    #[must_use]
    pub fn pairs_on_the_way(
        &self,
        transition: TransitionId,
        states: &[StateId],
        rigid_attachments: &[RigidAttachment],
    ) -> PairSet {
        let from = self.graph.transition(transition).from;
        let touching: Vec<_> = states.iter().chain([&from]).flat_map(|&state| self.touching(state)).collect();
        PairSet::new(&self.collision, rigid_attachments, &touching)
    }

    /// All pairs on motions of a transition, with the margins that hold along it.
    pub(crate) fn pairs_with_margins(
        &self,
        transition: TransitionId,
        state: StateId,
        rigid_attachments: &[RigidAttachment],
    ) -> Cow<'_, PairSet> {
        if self.problem.margins.is_empty() {
            return Cow::Borrowed(self.pairs(transition, state, rigid_attachments));
        }
        let touching = self.touching_along(transition);
        Cow::Owned(
            PairSet::new(&self.collision, rigid_attachments, &touching).with_rigid_pairs(self.rigid_pairs(state)),
        )
    }

    /// The links that touch by grasp or placement at either end of a transition.
    fn touching_along(&self, transition: TransitionId) -> Vec<(LinkIndex, LinkIndex)> {
        let touches = self.touches_along(transition);
        [touches.grasped, touches.placed].concat()
    }

    /// The same, by what makes them touch.
    pub(crate) fn touches_along(&self, transition: TransitionId) -> Touches {
        let ends = self.graph.transition(transition);
        let mut touches = self.touches(ends.from);
        let others = self.touches(ends.to);
        touches.grasped.extend(others.grasped);
        touches.placed.extend(others.placed);
        touches
    }

    /// The links that touch by grasp or placement in a state.
    fn touching(&self, state: StateId) -> Vec<(LinkIndex, LinkIndex)> {
        let touches = self.touches(state);
        [touches.grasped, touches.placed].concat()
    }

    /// The links that touch in a state: fingers are attached to a gripper's body, and touch too.
    fn touches(&self, state: StateId) -> Touches {
        let robot = &self.problem.robot;
        let mut touches = Touches::default();
        let touch = |links: &mut Vec<_>, first: &[LinkIndex], second: &[LinkIndex]| {
            links.extend(first.iter().flat_map(|&a| second.iter().map(move |&b| (a, b))));
        };
        for &constraint in &self.graph.state(state).manifold {
            match self.graph.constraint(constraint).kind {
                ConstraintKind::Grasp { gripper, handle } => {
                    let hand = links_beyond(robot, robot.grippers[gripper.at()].link);
                    touch(&mut touches.grasped, &hand, &links_with(robot, robot.handles[handle.at()].link));
                }
                ConstraintKind::Placement { object, on } => {
                    let place = self.objects[object as usize].placement_on(on);
                    for surface in &self.graph.objects[object as usize].surfaces {
                        let lying = links_with(robot, robot.surfaces[surface.at()].link);
                        for support in place.iter().flat_map(|place| &place.supports) {
                            touch(&mut touches.placed, &lying, &links_with(robot, robot.surfaces[support.at()].link));
                        }
                    }
                    if let Some(floor) = place.and_then(|place| place.touches) {
                        let part = self.graph.objects[object as usize].part;
                        let lying = links_with(robot, robot.parts[part.at()].root_link);
                        touch(&mut touches.placed, &lying, &links_with(robot, floor));
                    }
                }
                _ => {}
            }
        }
        touches
    }

    /// Every pair, with the margins of a state: lifted from what touches there.
    fn verdict_pairs(&self, state: StateId) -> &PairSet {
        let verdict = || Box::new(PairSet::new(&self.collision, &[], &self.touching(state)));
        match self.problem.margins.is_empty() {
            true => &self.all_pairs,
            false => self.states[state.at()].verdict.get_or_init(verdict),
        }
    }

    /// All pairs of shapes that are too close where the bodies are, margins of touching pairs in `state` lifted.
    #[must_use]
    pub fn all_collisions(&self, state: StateId, X_WJ: &[Pose], guard: f64) -> Vec<Contact> {
        all_collisions(&self.collision, X_WJ, self.verdict_pairs(state), guard)
    }

    /// Likewise of the pairs that locked joints hold together, which are tested nowhere else.
    #[must_use]
    pub fn rigid_collisions(&self, state: StateId, X_WJ: &[Pose], guard: f64) -> Vec<Contact> {
        rigid_collisions(&self.collision, X_WJ, self.verdict_pairs(state), guard)
    }

    /// How deep the shapes of a pair are in each other where the bodies are, metres: no shift shorter than this sets them apart.
    /// `None` where no point is known to be inside both. Slow: for messages.
    #[must_use]
    pub fn overlap(&self, pair: PairId, X_WJ: &[Pose]) -> Option<f64> {
        let placed = |shape: ShapeIndex| {
            let solid = &self.collision.solids()[shape.at()];
            let pose = solid.body.map_or(Pose::identity(), |body| X_WJ[body.at()]) * solid.X_JS;
            PlacedSolid { geometry: &self.problem.robot.shapes[shape.at()].geometry, solid: &solid.solid, pose }
        };
        let (first, second) = self.pair_shapes(pair);
        depth(placed(first), placed(second))
    }

    /// How far a pair must stay apart in a state, metres.
    #[must_use]
    pub fn margin_in(&self, state: StateId, pair: PairId) -> f64 {
        self.verdict_pairs(state).margin(pair)
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
        first_collision(&self.collision, X_WJ, self.verdict_pairs(state), guard, scratch)
    }

    /// The first pair of shapes that is too close at a waypoint of a transition: margins are lifted from what touches at
    /// either end, as along its motions.
    #[must_use]
    pub fn first_collision_along(
        &self,
        transition: TransitionId,
        X_WJ: &[Pose],
        guard: f64,
        scratch: &mut CollisionScratch,
    ) -> Option<Contact> {
        first_collision(&self.collision, X_WJ, self.waypoint_pairs(transition), guard, scratch)
    }

    /// Every pair, with the margins that hold at the waypoints of a transition: lifted from what touches at either end.
    #[must_use]
    pub fn waypoint_pairs(&self, transition: TransitionId) -> &PairSet {
        let verdict = || Box::new(PairSet::new(&self.collision, &[], &self.touching_along(transition)));
        match self.problem.margins.is_empty() {
            true => &self.all_pairs,
            false => self.transitions[transition.at()].verdict.get_or_init(verdict),
        }
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
}

/// The links that are one body with a link, itself included; of what is fixed in the world only the link itself.
fn links_with(robot: &Robot, link: LinkIndex) -> Vec<LinkIndex> {
    let body = robot.links[link.at()].joint;
    let part = &robot.parts[robot.links[link.at()].part.at()];
    let same = |&other: &usize| other == link.at() || (body.is_some() && robot.links[other].joint == body);
    part.links.clone().filter(same).map(|l| LinkIndex(l as u32)).collect()
}

/// The links that are one body with a link or move with it: a hand's fingers.
fn links_beyond(robot: &Robot, link: LinkIndex) -> Vec<LinkIndex> {
    let Some(body) = robot.links[link.at()].joint else { return vec![link] };
    let part = &robot.parts[robot.links[link.at()].part.at()];
    let beyond = |&other: &usize| is_beyond(robot, robot.links[other].joint, body);
    part.links.clone().filter(beyond).map(|l| LinkIndex(l as u32)).collect()
}
