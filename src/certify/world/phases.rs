//! What a motion moves in: the scene at its start, and who carries what from when on.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::certify::motion::names;
use crate::certify::motion::names::UnknownName;
use crate::certify::motion::piecewise::{Attachment, Motion};
use crate::certify::world::levers::{Drives, Levers, slides};
use crate::certify::world::report::{PairCounts, PairName};
use foliate_components::Pose;
use foliate_components::problem::Problem;
use foliate_components::robot::{DisabledPair, JointType as JointMotion, LinkIndex, Robot};
use foliate_kernels::collision::{CollisionScene, PairId, PairRule, PairSet};
use foliate_kernels::kinematics::{Kinematics, RigidAttachment};
use std::collections::HashSet;

/// Why a motion cannot be examined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum CertifyError {
    #[error("{0}")]
    Name(#[from] UnknownName),
    #[error(
        "`{0}` cannot be carried: its root does not move freely in the scene; only parts with `root = \"freeflyer\"` can be attached"
    )]
    NotFree(String),
    #[error("`{object}` cannot be carried by `{link}`, which moves with it")]
    CarriesItself { object: String, link: String },
    #[error("the motion moves `{0}` itself while it is attached: leave its coordinates out, or do not attach it")]
    MovesAttached(String),
    #[error("the motion names coordinate {0}, and a configuration has {1}")]
    Coordinate(usize, usize),
}

/// A scene in which motions are certified. Built once, used for any number of motions, on any number of threads.
#[derive(Clone, Debug)]
pub struct Certifier {
    pub(crate) problem: Problem,
    pub(crate) kinematics: Kinematics,
    pub(crate) scene: CollisionScene,
    /// Links between which margins do not matter: objects and what the scene lets them stand on.
    resting: Vec<(LinkIndex, LinkIndex)>,
    counts: PairCounts,
}

/// A part of a motion in which everything is attached to the same things.
#[derive(Clone, Debug)]
pub(crate) struct Phase {
    /// Places of the motion.
    pub from: f64,
    pub to: f64,
    pub rigid_attachments: Vec<RigidAttachment>,
    pub pairs: PairSet,
    /// Where everything stands that does not move.
    pub base: Vec<f64>,
    pub levers: Levers,
}

impl Certifier {
    /// Prepares a scene: its start is the world. Tested are the pairs of shapes that planning in the scene tests, but for
    /// those between the links (or parts) that `touch` names.
    ///
    /// # Errors
    /// A name that the scene does not have.
    pub fn new(problem: &Problem, touch: &[(String, String)]) -> Result<Self, CertifyError> {
        let robot = &problem.robot;
        let mut ignored = problem.ignored_pairs.clone();
        let mut allowed = HashSet::new();
        for (first, second) in touch {
            let (first, second) = (names::links(robot, first)?, names::links(robot, second)?);
            allowed.extend(first.iter().flat_map(|&a| second.iter().map(move |&b| (a.min(b), a.max(b)))));
        }
        // What is left out for another reason is counted there.
        for pair in robot.disabled_pairs.iter().chain(&problem.ignored_pairs) {
            allowed.remove(&(pair.first.min(pair.second), pair.first.max(pair.second)));
        }
        let touching = allowed.iter().map(|&(a, b)| shapes_between(robot, a, b)).sum();
        let reason = || String::from("touching is allowed");
        ignored.extend(allowed.into_iter().map(|(first, second)| DisabledPair { first, second, reason: reason() }));
        // No joint is locked: whatever the motion moves, moves.
        let rule = PairRule { ignored: &ignored, margins: &problem.margins, locked: &[] };
        let scene = CollisionScene::new(robot, &rule);
        let counts = count(&scene, touching);
        Ok(Self {
            kinematics: Kinematics::new(robot),
            resting: resting(problem),
            problem: problem.clone(),
            scene,
            counts,
        })
    }

    /// The robot, with all parts.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.problem.robot
    }

    pub(crate) fn pair_name(&self, id: PairId) -> PairName {
        let (robot, pair) = (&self.problem.robot, &self.scene.pairs()[id.at()]);
        let shapes = [pair.first, pair.second].map(|s| &robot.shapes[s.at()]);
        PairName {
            links: shapes.map(|s| robot.links[s.link.at()].name.clone()),
            shapes: shapes.map(|s| s.name.clone()),
        }
    }

    /// Poses of all bodies at a place of a motion; `q` is the configuration, objects where they stood when the phase began.
    pub(crate) fn poses(&self, motion: &Motion, phase: &Phase, place: f64, q: &mut Vec<f64>, X_WJ: &mut Vec<Pose>) {
        q.clear();
        q.extend_from_slice(&phase.base);
        motion.write(place, q);
        X_WJ.resize(self.kinematics.bodies(), Pose::identity());
        self.kinematics.forward(q, X_WJ);
        self.kinematics.carry(q, &phase.rigid_attachments, X_WJ);
    }

    /// How many pairs are tested on a motion, and how many are not.
    pub(crate) fn counts(&self, phases: &[Phase]) -> PairCounts {
        let lifted = |phase: &Phase| {
            let all = self.scene.pairs().iter().enumerate();
            all.filter(|(i, p)| p.margin > 0.0 && phase.pairs.margin(PairId(*i as u32)) <= 0.0).count()
        };
        PairCounts { without_margin: phases.first().map_or(0, lifted) as u64, ..self.counts.clone() }
    }

    /// Cuts a motion where something is attached or let go.
    pub(crate) fn phases(&self, motion: &Motion, attachments: &[Attachment]) -> Result<Vec<Phase>, CertifyError> {
        let robot = self.robot();
        let size = robot.space.size();
        if let Some(&c) = motion.coordinates.iter().chain(motion.start.iter().map(|(c, _)| c)).find(|&&c| c >= size) {
            return Err(CertifyError::Coordinate(c, size));
        }
        let mut base = self.problem.start.clone();
        motion.start.iter().for_each(|&(i, value)| base[i] = value);
        motion.write(0.0, &mut base);
        let slides = slides(robot, motion, &base);
        let mut events = self.events(motion, attachments)?;
        let touching = self.touching(&events);
        let end = motion.segments.len() as f64;
        let (mut phases, mut rigid_attachments, mut from) = (Vec::new(), Vec::<RigidAttachment>::new(), 0.0);
        let mut X_WJ = vec![Pose::identity(); self.kinematics.bodies()];
        loop {
            // What happens at the start of this phase.
            let now = events.partition_point(|e| e.place <= from);
            if now > 0 {
                let mut q = base.clone();
                motion.write(from, &mut q);
                self.kinematics.forward(&q, &mut X_WJ);
                self.kinematics.carry(&q, &rigid_attachments, &mut X_WJ);
                self.kinematics.write_back(&rigid_attachments, &X_WJ, &mut base);
                for event in events.drain(..now) {
                    event.happen(robot, &mut rigid_attachments, &X_WJ)?;
                }
            }
            let to = events.first().map_or(end, |e| e.place);
            phases.push(Phase {
                from,
                to,
                pairs: PairSet::new(&self.scene, &rigid_attachments, &touching),
                levers: Levers::new(robot, &self.scene, &rigid_attachments, &slides),
                rigid_attachments: rigid_attachments.clone(),
                base: base.clone(),
            });
            if events.is_empty() {
                return Ok(phases);
            }
            from = to;
        }
    }

    fn events(&self, motion: &Motion, attachments: &[Attachment]) -> Result<Vec<Event>, CertifyError> {
        let robot = self.robot();
        let mut events = Vec::new();
        for (attachment, by_file) in
            motion.attachments.iter().map(|a| (a, true)).chain(attachments.iter().map(|a| (a, false)))
        {
            let part = names::part(robot, &attachment.object)?;
            let root = robot.parts[part.at()].root_joint;
            let object = root.filter(|&j| robot.joints[j.at()].motion == JointMotion::FreeFlyer);
            let object = object.ok_or_else(|| CertifyError::NotFree(attachment.object.clone()))?;
            let q = match robot.joints[object.at()].source {
                foliate_components::robot::Source::Coordinates { q, .. } => q..q + 7,
                foliate_components::robot::Source::Follows { .. } => 0..0,
            };
            if !by_file && motion.coordinates.iter().any(|c| q.contains(c)) {
                return Err(CertifyError::MovesAttached(attachment.object.clone()));
            }
            let link = attachment.link.as_ref().map(|name| names::link(robot, name)).transpose()?;
            let place = motion.place(attachment.time);
            events.push(Event { place, object, link, part: robot.parts[part.at()].links.clone() });
        }
        events.sort_by(|a, b| a.place.total_cmp(&b.place));
        Ok(events)
    }

    /// The links between which margins do not matter: those of objects and of hands that hold them at some time, and of what
    /// objects may stand on.
    fn touching(&self, events: &[Event]) -> Vec<(LinkIndex, LinkIndex)> {
        let mut touching = self.resting.clone();
        for event in events {
            let Some(link) = event.link else { continue };
            let hand = names::links_beyond(self.robot(), link);
            let object = event.part.clone().map(|l| LinkIndex(l as u32));
            touching.extend(object.flat_map(|o| hand.iter().map(move |&h| (h, o))));
        }
        touching
    }

    pub(crate) fn drives(&self, motion: &Motion) -> Drives {
        Drives::new(self.robot(), motion)
    }
}

/// Something is attached or let go.
struct Event {
    place: f64,
    object: foliate_components::robot::JointIndex,
    link: Option<LinkIndex>,
    /// The object's links.
    part: std::ops::Range<usize>,
}

impl Event {
    fn happen(
        self,
        robot: &Robot,
        rigid_attachments: &mut Vec<RigidAttachment>,
        X_WJ: &[Pose],
    ) -> Result<(), CertifyError> {
        rigid_attachments.retain(|c| c.object != self.object);
        let Some(link) = self.link else { return Ok(()) };
        let carrier = robot.links[link.at()].joint;
        let mut above = carrier;
        for _ in 0..=robot.joints.len() {
            let Some(body) = above else { break };
            if body == self.object {
                let name = |l: usize| robot.links[l].name.clone();
                return Err(CertifyError::CarriesItself { object: name(self.part.start), link: name(link.at()) });
            }
            let carried = rigid_attachments.iter().find(|c| c.object == body);
            above = carried.map_or(robot.joints[body.at()].parent, |c| c.carrier);
        }
        let X_WO = X_WJ[self.object.at()];
        let X_CO = carrier.map_or(X_WO, |c| X_WJ[c.at()].inverse() * X_WO);
        rigid_attachments.push(RigidAttachment { object: self.object, carrier, X_CO });
        Ok(())
    }
}

/// How many pairs of shapes two links have that could be tested.
fn shapes_between(robot: &Robot, a: LinkIndex, b: LinkIndex) -> u64 {
    let (one, other) = (&robot.links[a.at()], &robot.links[b.at()]);
    if one.joint == other.joint && (one.joint.is_none() || one.part == other.part) {
        return 0;
    }
    let on = |link: LinkIndex| robot.shapes.iter().filter(|s| s.link == link).count() as u64;
    on(a) * on(b)
}

fn count(scene: &CollisionScene, touch_allowed: u64) -> PairCounts {
    let counts = scene.counts();
    PairCounts {
        tested: counts.looked_at(),
        same_body: counts.same_body,
        environment: counts.environment,
        srdf: counts.srdf,
        adjacent: counts.adjacent,
        ignored: counts.ignored.saturating_sub(touch_allowed),
        touch_allowed,
        without_margin: 0,
    }
}

/// Links of objects and of what the scene lets them stand on.
fn resting(problem: &Problem) -> Vec<(LinkIndex, LinkIndex)> {
    let (robot, graph) = (&problem.robot, &problem.graph);
    let mut touching = Vec::new();
    for object in &graph.objects {
        let supports = graph.supports.iter().map(|s| robot.surfaces[s.at()].link);
        let lying = object.surfaces.iter().map(|s| robot.surfaces[s.at()].link);
        let mut touch = |one: LinkIndex, other: LinkIndex| {
            let (one, other) = (names::links_with(robot, one), names::links_with(robot, other));
            touching.extend(one.iter().flat_map(|&a| other.iter().map(move |&b| (a, b))));
        };
        for lying in lying {
            supports.clone().for_each(|support| touch(lying, support));
        }
        if let Some(on) = object.plane.and_then(|plane| plane.on) {
            touch(robot.parts[object.part.at()].root_link, on);
        }
    }
    touching
}
