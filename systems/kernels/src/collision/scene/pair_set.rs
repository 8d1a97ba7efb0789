//! The pairs that matter on one leaf.

use crate::collision::scene::body_chains::BodyChains;
use crate::collision::scene::collision_scene::{CollisionScene, PairId};
use crate::kinematics::forward::RigidAttachment;
use foliate_components::robot::{JointIndex, LinkIndex};
use glam::DVec3;

/// The pairs of a scene on a leaf with given rigid attachments: those whose relative pose can change along a motion on the leaf,
/// and those for which it cannot (P1, future work). Built once per leaf or transition and kept by the caller.
#[derive(Clone, Debug)]
pub struct PairSet {
    pub(crate) chains: BodyChains,
    pub(crate) moving: Vec<ActiveGroup>,
    pub(crate) constant: Vec<ActiveGroup>,
    /// By pair of the scene.
    pub(crate) margins: Vec<f64>,
    pub(crate) rigid_pairs: Vec<RigidPair>,
}

/// A group, as a leaf sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActiveGroup {
    pub group: u32,
    /// Number of joints between each cluster and their common ancestor.
    pub apart: (u32, u32),
    /// Where displacements of the two, up to that ancestor, stand among rows by chain link and one more per cluster; behind
    /// them all where no joint is between.
    pub rows: (u32, u32),
    /// The largest margin in the group.
    pub margin: f64,
}

impl PairSet {
    /// The pairs of `scene` where `rigid_attachments` hold. Margins do not apply to the link pairs in `touching` (those that touch
    /// by grasp or placement in either end state); those pairs still must not collide.
    #[must_use]
    pub fn new(
        scene: &CollisionScene,
        rigid_attachments: &[RigidAttachment],
        touching: &[(LinkIndex, LinkIndex)],
    ) -> Self {
        let chains = BodyChains::new(scene, rigid_attachments);
        let touches = |a: LinkIndex, b: LinkIndex| touching.contains(&(a, b)) || touching.contains(&(b, a));
        let link = |i: u32| scene.solids[i as usize].link;
        let margins: Vec<f64> = scene
            .pairs
            .iter()
            .map(|p| if p.margin > 0.0 && touches(link(p.first.0), link(p.second.0)) { 0.0 } else { p.margin })
            .collect();
        let (mut moving, mut constant) = (Vec::new(), Vec::new());
        for (index, group) in scene.groups.iter().enumerate().filter(|(_, g)| !g.fixed) {
            let [a, b] = [group.first, group.second].map(|c| scene.clusters[c as usize].body);
            let (below_a, below_b) = chains.apart(a, b);
            let margin = margins[group.start as usize..group.end as usize].iter().copied().fold(0.0, f64::max);
            let none = (chains.links.len() + scene.clusters.len()) as u32;
            let row = |cluster: u32, body, below: usize| match below {
                0 => none,
                _ => chains.chain_of(body).start + cluster + below as u32,
            };
            let rows = (row(group.first, a, below_a), row(group.second, b, below_b));
            let list = if chains.rigid(a, b) { &mut constant } else { &mut moving };
            list.push(ActiveGroup { group: index as u32, apart: (below_a as u32, below_b as u32), rows, margin });
        }
        Self { chains, moving, constant, margins, rigid_pairs: Vec::new() }
    }

    /// The same pairs along motions that keep some bodies together.
    #[must_use]
    pub fn with_rigid_pairs(self, rigid_pairs: Vec<RigidPair>) -> Self {
        Self { rigid_pairs, ..self }
    }

    /// Of these pairs those between two bodies that are `wanted` (`None` is the world), without margins.
    #[must_use]
    pub fn between(
        &self,
        scene: &CollisionScene,
        wanted: impl Fn(Option<JointIndex>, Option<JointIndex>) -> bool,
    ) -> Self {
        let keep = |active: &&ActiveGroup| {
            let group = &scene.groups[active.group as usize];
            let [a, b] = [group.first, group.second].map(|c| scene.clusters[c as usize].body);
            wanted(a, b) || wanted(b, a)
        };
        let without_margin = |active: &ActiveGroup| ActiveGroup { margin: 0.0, ..*active };
        let select = |list: &[ActiveGroup]| list.iter().filter(keep).map(without_margin).collect();
        Self {
            chains: self.chains.clone(),
            moving: select(&self.moving),
            constant: select(&self.constant),
            margins: vec![0.0; self.margins.len()],
            rigid_pairs: Vec::new(),
        }
    }

    /// A group by number: those that move first, then those that do not.
    #[inline]
    pub(crate) fn active(&self, number: u32) -> &ActiveGroup {
        let number = number as usize;
        match self.moving.get(number) {
            Some(active) => active,
            None => &self.constant[number - self.moving.len()],
        }
    }

    /// The nearest body, itself included, that moves both clusters of a group along; none where that is the world.
    pub(crate) fn ancestor(&self, scene: &CollisionScene, active: &ActiveGroup) -> Option<JointIndex> {
        let group = &scene.groups[active.group as usize];
        let chain = self.chains.chain_of(scene.clusters[group.first as usize].body);
        let links = &self.chains.links[chain.start as usize..chain.end as usize];
        links.get(active.apart.0 as usize).map(|link| JointIndex(link.joint))
    }

    /// Pairs that can change their relative pose on the leaf.
    pub fn moving_pairs<'a>(&'a self, scene: &'a CollisionScene) -> impl Iterator<Item = PairId> + 'a {
        self.moving.iter().flat_map(|active| pairs_of(scene, active.group))
    }

    /// Pairs that keep their relative pose on the leaf: one exact test holds for all of it. Pairs that are fixed by locked
    /// joints are not among them ([`CollisionScene::fixed_pairs`]).
    pub fn constant_pairs<'a>(&'a self, scene: &'a CollisionScene) -> impl Iterator<Item = PairId> + 'a {
        self.constant.iter().flat_map(|active| pairs_of(scene, active.group))
    }

    /// How far the two of a pair must stay apart on this leaf, metres.
    #[must_use]
    pub fn margin(&self, pair: PairId) -> f64 {
        self.margins[pair.at()]
    }
}

fn pairs_of(scene: &CollisionScene, group: u32) -> impl Iterator<Item = PairId> + use<> {
    let group = &scene.groups[group as usize];
    (group.start..group.end).map(PairId)
}

/// Two bodies that keep their relative pose to within little along every motion that a [`PairSet`] is for, whatever joints do:
/// within what [`CertificateSettings::rigid_within`](crate::collision::narrow_phase::settings::CertificateSettings::rigid_within)
/// says; the caller must have proved that of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidPair {
    /// One body; `None` for the world.
    pub a: Option<JointIndex>,
    /// The other.
    pub b: Option<JointIndex>,
    /// A point of the other, in its joint frame (or in the world): what is known is how far it shifts and how far the other
    /// turns about it.
    pub origin: DVec3,
}
