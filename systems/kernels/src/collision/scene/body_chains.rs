//! The joints between the world and each body on a leaf, and how far the body reaches from each.

use crate::collision::scene::collision_scene::CollisionScene;
use crate::kinematics::RigidAttachment;
use crate::kinematics::attachment_tree::AttachmentTree;
use foliate_components::robot::{JointIndex, JointType};
use glam::DVec3;
use std::sync::Arc;

/// The attachment tree of a leaf, with a chain of joints for each body.
#[derive(Clone, Debug)]
pub(crate) struct BodyChains {
    tree: AttachmentTree,
    /// By body: the nearest body, itself included, that moves on its own; none where it is fixed to the world.
    class: Vec<Option<JointIndex>>,
    /// By body: its chain, distal joints first.
    chains: Vec<Chain>,
    pub(crate) links: Vec<ChainLink>,
}

/// A range of [`BodyChains::links`].
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

impl BodyChains {
    /// Where an object is attached twice the last attachment counts, as in forward kinematics. One that would close a circle of
    /// carriers is left out.
    pub(crate) fn new(scene: &CollisionScene, rigid_attachments: &[RigidAttachment]) -> Self {
        let mut tree = AttachmentTree::of_table(Arc::clone(&scene.joints));
        for attachment in rigid_attachments.iter().rev() {
            tree.hang(attachment.object, attachment.carrier);
        }
        let bodies = (0..scene.joints.len() as u32).map(JointIndex);
        let moves = |body: &JointIndex| !tree.is_carried(*body) && !scene.locked[body.at()];
        let class = bodies.map(|body| tree.line(body).find(moves)).collect();
        let mut chains = Self { tree, class, chains: vec![Chain::default(); scene.joints.len()], links: Vec::new() };
        for cluster in &scene.clusters {
            if let Some(body) = cluster.body {
                chains.chains[body.at()] = chains.chain(scene, rigid_attachments, &cluster.solids, body);
            }
        }
        chains
    }

    fn chain(
        &mut self,
        scene: &CollisionScene,
        rigid_attachments: &[RigidAttachment],
        solids: &[u32],
        body: JointIndex,
    ) -> Chain {
        let start = self.links.len() as u32;
        let own = |axis: Option<DVec3>| radius_about(scene, solids, axis);
        // How far the body reaches from the origin of the frame below, and where that frame's origin is in this one.
        let mut below: Option<(f64, DVec3, bool)> = None;
        for index in self.tree.line(body) {
            let attachment = rigid_attachments.iter().rev().find(|c| c.object == index);
            let attachment = attachment.filter(|_| self.tree.is_carried(index));
            // A carried object's own joint does not move it.
            let joint = attachment.is_none().then(|| self.tree.joint(index));
            let origin = attachment.map_or(self.tree.joint(index).X_PJ.translation, |c| c.X_CO.translation);
            let axis = joint.and_then(|j| match j.motion {
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
            if joint.is_some() {
                self.links.push(ChainLink { joint: index.0, reach: about_axis });
            }
            let stays = joint.is_none_or(|j| matches!(j.motion, JointType::Revolute { .. }));
            // How an object is attached to its carrier differs from leaf to leaf, and one tree serves them all: beyond it only
            // distances at the sample bound anything.
            let reach = if joint.is_some() { about_origin } else { f64::INFINITY };
            below = Some((reach, origin, stays));
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
        self.tree.parent(body)
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
