//! The attachment tree: who moves whom on a leaf. An object that is carried is attached to its carrier.

use crate::collision::scene::collision_scene::CollisionScene;
use crate::kinematics::RigidAttachment;
use crate::kinematics::joint_table::JointEntry;
use foliate_components::robot::{JointIndex, JointType};
use glam::DVec3;

/// Joints between the world and each body, with how far the body reaches from each.
#[derive(Clone, Debug, Default)]
pub(crate) struct AttachmentTree {
    /// By body: the nearest body, itself included, that moves on its own; none where it is fixed to the world.
    class: Vec<Option<JointIndex>>,
    /// By body: what it is attached to, its carrier where it is carried.
    parents: Vec<Option<JointIndex>>,
    /// By body: its chain, distal joints first.
    chains: Vec<Chain>,
    pub(crate) links: Vec<ChainLink>,
}

/// A range of [`AttachmentTree::links`].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Chain {
    pub start: u32,
    pub end: u32,
}

/// A joint above a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChainLink {
    pub joint: u32,
    /// At least the distance of any point of the body from the joint's axis (free-flyers: origin), whatever the joints
    /// between them do, not counting how far those of them that translate are from zero; infinite where a rigid attachment is
    /// between them. Metres.
    pub reach: f64,
}

/// One step up the tree.
struct Up<'a> {
    parent: Option<JointIndex>,
    offset: DVec3,
    /// The joint, where it moves its body (a carried object's does not).
    joint: Option<&'a JointEntry>,
}

impl AttachmentTree {
    pub(crate) fn new(scene: &CollisionScene, rigid_attachments: &[RigidAttachment]) -> Self {
        let up = |body: JointIndex| -> Up<'_> {
            match rigid_attachments.iter().rev().find(|c| c.object == body) {
                Some(c) => Up { parent: c.carrier, offset: c.X_CO.translation, joint: None },
                None => {
                    let joint = &scene.joints[body.at()];
                    Up { parent: joint.parent, offset: joint.X_PJ.translation, joint: Some(joint) }
                }
            }
        };
        let mut tree = Self { chains: vec![Chain::default(); scene.joints.len()], ..Self::default() };
        for body in 0..scene.joints.len() {
            let body = JointIndex(body as u32);
            let class = tree.ancestors(body, &up).find(|(body, step)| step.joint.is_some() && !scene.locked[body.at()]);
            let class = class.map(|(b, _)| b);
            tree.class.push(class);
            tree.parents.push(up(body).parent);
        }
        for cluster in &scene.clusters {
            let Some(body) = cluster.body else { continue };
            let chain = tree.chain(scene, &cluster.solids, body, &up);
            tree.chains[body.at()] = chain;
        }
        tree
    }

    /// A body and its ancestors. Rigid attachments that form a circle end after as many steps as there are bodies.
    fn ancestors<'a>(
        &self,
        body: JointIndex,
        up: &'a impl Fn(JointIndex) -> Up<'a>,
    ) -> impl Iterator<Item = (JointIndex, Up<'a>)> {
        let first = Some((body, up(body)));
        std::iter::successors(first, move |(_, step)| step.parent.map(|p| (p, up(p)))).take(self.chains.len())
    }

    fn chain<'a>(
        &mut self,
        scene: &CollisionScene,
        solids: &[u32],
        body: JointIndex,
        up: &'a impl Fn(JointIndex) -> Up<'a>,
    ) -> Chain {
        let start = self.links.len() as u32;
        let own = |axis: Option<DVec3>| radius_about(scene, solids, axis);
        // How far the body reaches from the origin of the frame below, and where that frame's origin is in this one.
        let mut below: Option<(f64, DVec3, bool)> = None;
        let steps: Vec<_> = self.ancestors(body, up).collect();
        for (index, step) in steps {
            let axis = step.joint.and_then(|j| match j.motion {
                JointType::Revolute { axis } => Some(axis),
                JointType::Planar => Some(DVec3::Z),
                JointType::Prismatic { .. } | JointType::FreeFlyer => None,
            });
            let (about_axis, about_origin) = match below {
                None => (own(axis), own(None)),
                Some((reach, offset, stays)) => {
                    // A frame that does not translate keeps its distance from this joint's axis.
                    let across = match axis {
                        Some(axis) if stays => offset.reject_from(axis).length(),
                        _ => offset.length(),
                    };
                    (across + reach, offset.length() + reach)
                }
            };
            if step.joint.is_some() {
                self.links.push(ChainLink { joint: index.0, reach: about_axis });
            }
            let stays = step.joint.is_none_or(|j| matches!(j.motion, JointType::Revolute { .. }));
            // How an object is attached to its carrier differs from leaf to leaf, and one tree serves them all: beyond it only
            // distances at the sample bound anything.
            let reach = if step.joint.is_some() { about_origin } else { f64::INFINITY };
            below = Some((reach, step.offset, stays));
        }
        Chain { start, end: self.links.len() as u32 }
    }

    /// Whether two bodies keep their relative pose on the leaf.
    pub(crate) fn rigid(&self, a: Option<JointIndex>, b: Option<JointIndex>) -> bool {
        let class = |body: Option<JointIndex>| body.and_then(|b| self.class[b.at()]);
        class(a) == class(b)
    }

    /// What a body is attached to; none where that is the world.
    pub(crate) fn parent(&self, body: JointIndex) -> Option<JointIndex> {
        self.parents[body.at()]
    }

    /// The joints above a body.
    pub(crate) fn chain_of(&self, body: Option<JointIndex>) -> Chain {
        body.map_or(Chain::default(), |b| self.chains[b.at()])
    }

    /// How many joints, counted from each of the bodies, are below their nearest common ancestor.
    pub(crate) fn apart(&self, a: Option<JointIndex>, b: Option<JointIndex>) -> (usize, usize) {
        let joints = |body| {
            let chain = self.chain_of(body);
            &self.links[chain.start as usize..chain.end as usize]
        };
        let (a, b) = (joints(a), joints(b));
        let common = a.iter().rev().zip(b.iter().rev()).take_while(|(x, y)| x.joint == y.joint).count();
        (a.len() - common, b.len() - common)
    }
}

/// At least the distance of any point of a body's solids from an axis through the body's origin, or from the origin.
fn radius_about(scene: &CollisionScene, solids: &[u32], axis: Option<DVec3>) -> f64 {
    let from = |p: DVec3| match axis {
        Some(axis) => p.reject_from(axis).length(),
        None => p.length(),
    };
    let of = |&i: &u32| {
        let solid = &scene.solids[i as usize];
        let (ball, capsule) = (&solid.ball, &solid.capsule);
        let ends = from(capsule.middle + capsule.half).max(from(capsule.middle - capsule.half));
        (from(ball.center) + ball.radius).min(ends + capsule.radius)
    };
    solids.iter().map(of).fold(0.0, f64::max)
}
