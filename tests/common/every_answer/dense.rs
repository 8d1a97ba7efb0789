//! A path at many places between its knots: no pair of shapes comes closer than the certificate claims. Pairs are listed
//! afresh from what the path file leaves out; only the exact distance of two solids is the kernels'.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use super::solve::Answer;
use foliate::components::Pose;
use foliate::components::path::{Attachment, Segment};
use foliate::components::robot::configuration::Group;
use foliate::components::robot::{JointIndex, LinkIndex, PartKind, Robot, RootJoint};
use foliate::kernels::collision::{DistanceQuery, Solid, clearance};
use foliate::kernels::kinematics::{Kinematics, RigidAttachment};
use glam::DVec3;
use std::collections::{HashMap, HashSet};

/// Number of samples of a path, about.
const PLACES: usize = 600;
/// How far a distance may be off, metres.
const SLACK: f64 = 1e-9;

/// Two shapes, and how far apart they stay.
struct Pair {
    shapes: (usize, usize),
    least: f64,
}

/// Whether the path keeps what it claims.
pub fn sampled(answer: &Answer) -> Result<(), String> {
    let pairs = pairs(answer)?;
    let robot = &answer.model.problem.robot;
    let kinematics = Kinematics::new(robot);
    let solids: Vec<Solid> = robot.shapes.iter().map(|shape| Solid::of(&shape.geometry)).collect();
    let knots: usize = answer.path.segments.iter().map(|s| s.knots.len()).sum();
    let between = (PLACES / knots.max(1)).clamp(2, 64);
    let mut hints = vec![DVec3::ZERO; pairs.len()];
    for (number, segment) in answer.path.segments.iter().enumerate() {
        let places = Places::new(robot, &kinematics, segment);
        for (knot, ends) in segment.knots.windows(2).enumerate() {
            for step in 0..=between {
                let t = step as f64 / between as f64;
                let X_WJ = match curve_point(robot, segment, knot, t) {
                    Some(q) => places.at(&q, &q, 0.0),
                    None => places.at(&ends[0], &ends[1], t),
                };
                for (pair, hint) in pairs.iter().zip(&mut hints) {
                    let (a, b) = pair.shapes;
                    let ask = DistanceQuery {
                        needed: pair.least,
                        floor: pair.least,
                        ground: pair.least,
                        absolute: 1e-10,
                        relative: 0.0,
                    };
                    let found = clearance(
                        &solids[a],
                        &in_world(robot, a, &X_WJ),
                        &solids[b],
                        &in_world(robot, b, &X_WJ),
                        ask,
                        hint,
                    );
                    if found < pair.least - SLACK {
                        let (a, b) = (&robot.shapes[a].name, &robot.shapes[b].name);
                        let at = knot as f64 + t;
                        let least = pair.least;
                        return Err(format!(
                            "dense: {a} and {b} at {found:e}, claimed {least:e}, segment {number} t {at}"
                        ));
                    }
                }
            }
        }
    }
    Ok(())
}

/// The configuration on a segment's curve behind a knot; none where the segment has no times.
fn curve_point(robot: &Robot, segment: &Segment, knot: usize, t: f64) -> Option<Vec<f64>> {
    let timing = segment.timing.as_ref()?;
    let width = timing.times[knot + 1] - timing.times[knot];
    let number = |i: usize| {
        let [a, b] = [knot, knot + 1].map(|k| segment.knots[k][i]);
        let [v, w] = [knot, knot + 1].map(|k| timing.velocities[k][i] * width);
        let (t2, t3) = (t * t, t * t * t);
        (2.0 * t3 - 3.0 * t2 + 1.0) * a + (t3 - 2.0 * t2 + t) * v + (3.0 * t2 - 2.0 * t3) * b + (t3 - t2) * w
    };
    let mut q: Vec<f64> = (0..segment.knots[knot].len()).map(number).collect();
    for factor in robot.space.factors.iter().filter(|factor| factor.group == Group::FreeFlyer) {
        let numbers = &mut q[factor.q + 3..factor.q + 7];
        let length = numbers.iter().map(|x| x * x).sum::<f64>().sqrt();
        numbers.iter_mut().for_each(|x| *x /= length);
    }
    Some(q)
}

pub fn in_world(robot: &Robot, shape: usize, X_WJ: &[Pose]) -> Pose {
    let shape = &robot.shapes[shape];
    let X_JS = shape.joint_from_shape;
    robot.links[shape.link.at()].joint.map_or(X_JS, |joint| X_WJ[joint.at()] * X_JS)
}

/// The pairs that a path is tested for, as shapes.
pub fn pairs_of(answer: &Answer) -> Result<Vec<(usize, usize)>, String> {
    Ok(pairs(answer)?.into_iter().map(|pair| pair.shapes).collect())
}

/// All pairs of shapes on different bodies, but those that the file or an SRDF leaves out, and those of two environments.
fn pairs(answer: &Answer) -> Result<Vec<Pair>, String> {
    let robot = &answer.model.problem.robot;
    let ordered = |a: LinkIndex, b: LinkIndex| (a.min(b), a.max(b));
    let mut left_out: HashSet<_> = robot.disabled_pairs.iter().map(|p| ordered(p.first, p.second)).collect();
    for [first, second, _] in &answer.file.ignored_pairs {
        let link = |name: &str| robot.link(name).ok_or_else(|| format!("dense: no link `{name}`"));
        left_out.insert(ordered(link(first)?, link(second)?));
    }
    let mut margins: HashMap<_, f64> = HashMap::new();
    for margin in &answer.model.problem.margins {
        let entry = margins.entry(ordered(margin.first, margin.second)).or_insert(0.0);
        *entry = entry.max(margin.distance);
    }
    let claim = answer.path.certificate.min_clearance;
    let part = |link: LinkIndex| &robot.parts[robot.links[link.at()].part.at()];
    let mut pairs = Vec::new();
    for (a, one) in robot.shapes.iter().enumerate() {
        for (b, other) in robot.shapes.iter().enumerate().skip(a + 1) {
            let links = ordered(one.link, other.link);
            let joints = (robot.links[one.link.at()].joint, robot.links[other.link.at()].joint);
            let kinds = (part(one.link).kind, part(other.link).kind);
            let fixed = kinds == (PartKind::Environment, PartKind::Environment);
            if joints.0 == joints.1 || fixed || left_out.contains(&links) {
                continue;
            }
            let Some(claim) = claim else {
                return Err(format!("dense: nothing is claimed, but {} and {} are a pair", one.name, other.name));
            };
            // What touches by grasp or placement need not keep its margin: asked of pairs without objects alone.
            let free = kinds.0 == PartKind::Object || kinds.1 == PartKind::Object;
            let margin = if free { 0.0 } else { margins.get(&links).copied().unwrap_or(0.0) };
            pairs.push(Pair { shapes: (a, b), least: claim.max(0.0) + margin });
        }
    }
    Ok(pairs)
}

/// Where all bodies are along a segment: joints and robots' roots as interpolated, objects on what carries them.
pub struct Places<'r> {
    robot: &'r Robot,
    kinematics: &'r Kinematics,
    rigid_attachments: Vec<RigidAttachment>,
}

impl<'r> Places<'r> {
    pub fn new(robot: &'r Robot, kinematics: &'r Kinematics, segment: &Segment) -> Self {
        let first = &segment.knots[0];
        let mut X_WJ = vec![Pose::IDENTITY; kinematics.bodies()];
        kinematics.forward(first, &mut X_WJ);
        let pose = |joint: Option<JointIndex>| joint.map_or(Pose::IDENTITY, |j| X_WJ[j.at()]);
        let mut rigid_attachments: Vec<RigidAttachment> = Vec::new();
        for attachment in &segment.attachments {
            let joint = |link: LinkIndex| robot.links[link.at()].joint;
            let (object, carrier) = match *attachment {
                Attachment::Grasp { object, gripper, carrier: true, .. } => {
                    (object, joint(robot.grippers[gripper.at()].link))
                }
                Attachment::Contact { object, support, .. } => (object, joint(robot.surfaces[support.0.at()].link)),
                Attachment::Rest { object, on } => (object, on.and_then(joint)),
                Attachment::Grasp { .. } => continue,
            };
            let part = &robot.parts[robot.joints[object.at()].part.at()];
            if part.root == RootJoint::FreeFlyer && !rigid_attachments.iter().any(|c| c.object == object) {
                rigid_attachments.push(RigidAttachment {
                    object,
                    carrier,
                    X_CO: pose(carrier).inverse() * pose(Some(object)),
                });
            }
        }
        Self { robot, kinematics, rigid_attachments: in_order(robot, rigid_attachments) }
    }

    pub fn at(&self, a: &[f64], b: &[f64], t: f64) -> Vec<Pose> {
        let mut q = vec![0.0; self.robot.space.size()];
        self.robot.space.interpolate(a, b, t, &mut q);
        let mut X_WJ = vec![Pose::IDENTITY; self.kinematics.bodies()];
        self.kinematics.forward(&q, &mut X_WJ);
        self.kinematics.carry(&q, &self.rigid_attachments, &mut X_WJ);
        X_WJ
    }
}

/// What carries comes before what it carries.
fn in_order(robot: &Robot, mut waiting: Vec<RigidAttachment>) -> Vec<RigidAttachment> {
    let mut sorted: Vec<RigidAttachment> = Vec::new();
    while !waiting.is_empty() {
        let part = |joint: JointIndex| robot.joints[joint.at()].part;
        let ready =
            |c: &RigidAttachment| c.carrier.is_none_or(|on| !waiting.iter().any(|w| part(w.object) == part(on)));
        let next = waiting.iter().position(ready).unwrap_or(0);
        sorted.push(waiting.remove(next));
    }
    sorted
}
