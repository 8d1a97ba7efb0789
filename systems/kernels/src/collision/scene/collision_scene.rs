//! What can collide with what: the solids of a robot, grouped by the rigid bodies that they sit on, and the pairs.

use crate::collision::scene::pair_filter::{PairRule, Rules};
use crate::collision::scene::scene_solid::{SceneSolid, Solids};
use crate::collision::solids::solid::Solid;
use crate::collision::solids::volumes::Ball;
use crate::kinematics::joint_table::{JointEntry, joint_table};
use foliate_components::coverage::{LeftOut, PairCounts};
use foliate_components::robot::configuration::ConfigurationSpace;
use foliate_components::robot::{JointIndex, Robot, Shape, ShapeIndex};
use glam::DVec3;
use std::sync::Arc;

/// Index of a pair in [`CollisionScene::pairs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PairId(pub u32);

impl PairId {
    /// The index as a `usize`, for slices.
    #[must_use]
    pub fn at(self) -> usize {
        self.0 as usize
    }
}

/// Everything about collision that does not change during a search. Immutable and shared by threads.
#[derive(Clone, Debug)]
pub struct CollisionScene {
    pub(crate) solids: Vec<SceneSolid>,
    pub(crate) clusters: Vec<Cluster>,
    pub(crate) groups: Vec<Group>,
    pub(crate) pairs: Vec<Pair>,
    pub(crate) joints: Arc<[JointEntry]>,
    /// By joint: whether it never moves, itself or through its leader.
    pub(crate) locked: Vec<bool>,
    pub(crate) space: ConfigurationSpace,
    counts: PairCounts,
}

/// Shapes that one bounding ball stands for: all shapes of a moving body, or one shape that is fixed to the world (the
/// world as a whole has no useful ball).
#[derive(Clone, Debug)]
pub struct Cluster {
    /// The body; `None` for the world.
    pub body: Option<JointIndex>,
    /// A ball that holds all shapes, in the body's joint frame or in the world.
    pub ball: Ball,
    /// The shapes.
    pub solids: Vec<u32>,
}

/// Two clusters with pairs between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Group {
    /// Index of one cluster.
    pub first: u32,
    /// Index of the other.
    pub second: u32,
    /// Its pairs are `pairs[start..end]`.
    pub start: u32,
    /// End of its pairs.
    pub end: u32,
    /// Whether only locked joints are between the two: tested once at load, never along motions.
    pub fixed: bool,
}

/// Two shapes that must keep apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// One shape.
    pub first: ShapeIndex,
    /// The other.
    pub second: ShapeIndex,
    /// How far apart they must stay, metres (at least 0).
    pub margin: f64,
}

impl CollisionScene {
    /// Prepares all shapes of a robot and lists the pairs that `rule` leaves.
    #[must_use]
    pub fn new(robot: &Robot, rule: &PairRule<'_>) -> Self {
        let mut solids = Solids::new(&|| true);
        let solid = |s: &Shape| solids.of(&s.geometry).unwrap_or_else(|| Solid::of(&s.geometry));
        let solids = robot.shapes.iter().map(solid).collect();
        Self::of_solids(robot, rule, solids)
    }

    /// As [`Self::new`]; none once `go_on` says no. It is asked while trees of meshes are built.
    #[must_use]
    pub fn new_while(robot: &Robot, rule: &PairRule<'_>, go_on: &dyn Fn() -> bool) -> Option<Self> {
        let mut solids = Solids::new(go_on);
        let solids = robot.shapes.iter().map(|s| solids.of(&s.geometry)).collect::<Option<_>>()?;
        Some(Self::of_solids(robot, rule, solids))
    }

    fn of_solids(robot: &Robot, rule: &PairRule<'_>, solids: Vec<Solid>) -> Self {
        let mut scene = Self {
            solids: robot.shapes.iter().zip(solids).map(|(s, solid)| SceneSolid::new(robot, s, solid)).collect(),
            clusters: Vec::new(),
            groups: Vec::new(),
            pairs: Vec::new(),
            joints: joint_table(robot).into(),
            locked: (0..robot.joints.len() as u32).map(|joint| rule.locks(robot, JointIndex(joint))).collect(),
            space: robot.space.clone(),
            counts: PairCounts::default(),
        };
        scene.gather_clusters(robot.joints.len());
        scene.list_pairs(&Rules::new(robot, rule));
        scene
    }

    /// The shapes, in the robot's order.
    #[must_use]
    pub fn solids(&self) -> &[SceneSolid] {
        &self.solids
    }

    /// The clusters of shapes.
    #[must_use]
    pub fn clusters(&self) -> &[Cluster] {
        &self.clusters
    }

    /// The pairs of clusters that have pairs of shapes.
    #[must_use]
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// All pairs, those of a group side by side.
    #[must_use]
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// Pairs that are held together by locked joints alone: to be tested once, at load.
    pub fn fixed_pairs(&self) -> impl Iterator<Item = PairId> + '_ {
        self.groups.iter().filter(|g| g.fixed).flat_map(|g| (g.start..g.end).map(PairId))
    }

    /// How many pairs of shapes are tested, and how many are left out, by reason; `grasped` and `placed` are what a path says.
    #[must_use]
    pub fn counts(&self) -> PairCounts {
        self.counts
    }

    /// Number of bodies: the length of the pose slices that queries expect.
    #[must_use]
    pub fn bodies(&self) -> usize {
        self.joints.len()
    }

    /// Whether both shapes of a pair are convex.
    pub(crate) fn is_convex(&self, id: PairId) -> bool {
        let pair = &self.pairs[id.at()];
        [pair.first, pair.second].iter().all(|s| matches!(self.solids[s.at()].solid, Solid::Convex(_)))
    }

    fn gather_clusters(&mut self, bodies: usize) {
        let mut of_body: Vec<Option<u32>> = vec![None; bodies];
        for index in 0..self.solids.len() {
            let body = self.solids[index].body;
            let known = body.and_then(|b| of_body[b.at()]);
            let cluster = known.unwrap_or_else(|| {
                let ball = self.solids[index].ball;
                self.clusters.push(Cluster { body, ball, solids: Vec::new() });
                self.clusters.len() as u32 - 1
            });
            if let Some(body) = body {
                of_body[body.at()] = Some(cluster);
            }
            self.clusters[cluster as usize].solids.push(index as u32);
            self.solids[index].cluster = cluster;
        }
        for cluster in self.clusters.iter_mut().filter(|c| c.solids.len() > 1) {
            cluster.ball = ball_of_all(&self.solids, &cluster.solids);
        }
    }

    fn list_pairs(&mut self, rules: &Rules) {
        let class = rigid_classes(&self.joints, &self.locked);
        let class_of = |body: Option<JointIndex>| body.and_then(|b| class[b.at()]);
        for first in 0..self.clusters.len() {
            let count = self.clusters[first].solids.len() as u64;
            self.counts.leave_out(LeftOut::SameBody, count * (count - 1) / 2);
            for second in first + 1..self.clusters.len() {
                let (a, b) = (&self.clusters[first], &self.clusters[second]);
                let start = self.pairs.len() as u32;
                for (&i, &j) in a.solids.iter().flat_map(|i| b.solids.iter().map(move |j| (i, j))) {
                    let (one, other) = (self.solids[i as usize].link, self.solids[j as usize].link);
                    match rules.left_out(one, other) {
                        Some(why) => self.counts.leave_out(why, 1),
                        None => {
                            let margin = rules.margin(one, other);
                            self.pairs.push(Pair { first: ShapeIndex(i), second: ShapeIndex(j), margin });
                        }
                    }
                }
                let end = self.pairs.len() as u32;
                if end > start {
                    let fixed = class_of(a.body) == class_of(b.body);
                    self.groups.push(Group { first: first as u32, second: second as u32, start, end, fixed });
                    let count = if fixed { &mut self.counts.rigid } else { &mut self.counts.tested };
                    *count += u64::from(end - start);
                }
            }
        }
    }
}

/// For each body the nearest ancestor, or itself, whose joint is not locked; none where that is the world.
fn rigid_classes(joints: &[JointEntry], locked: &[bool]) -> Vec<Option<JointIndex>> {
    let mut class: Vec<Option<JointIndex>> = Vec::with_capacity(joints.len());
    for (index, (joint, &is_locked)) in joints.iter().zip(locked).enumerate() {
        let parent = joint.parent.and_then(|p| class.get(p.at()).copied().flatten());
        class.push(if is_locked { parent } else { Some(JointIndex(index as u32)) });
    }
    class
}

fn ball_of_all(solids: &[SceneSolid], members: &[u32]) -> Ball {
    let members: Vec<&SceneSolid> = members.iter().map(|&i| &solids[i as usize]).collect();
    let center = members.iter().map(|s| s.ball.center).sum::<DVec3>() / members.len().max(1) as f64;
    // Balls stand for meshes here, whose every vertex would be visited hundreds of times.
    let farthest = |from: DVec3| {
        let points = members.iter().map(|s| match s.solid {
            Solid::Convex(_) => s.X_JS.transform_point(crate::collision::solids::solid::farthest(
                &s.solid,
                s.X_JS.inverse_transform_point(from),
            )),
            Solid::Mesh(_) => s.ball.center + (s.ball.center - from).normalize_or(DVec3::X) * s.ball.radius,
        });
        points.max_by(|a, b| a.distance_squared(from).total_cmp(&b.distance_squared(from))).unwrap_or(from)
    };
    Ball::bounding(center, farthest)
}
