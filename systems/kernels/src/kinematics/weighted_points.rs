//! Weighted sums of points on many bodies, seen from one body: where a centre of mass is, and how joints move it.
//!
//! Read from that body outwards, every joint moves what lies beyond it: the motion of the sum is the joint's motion of the
//! *moment* Σ wₖpₖ of the points beyond. One pass over the tree finds all moments; nothing is computed once per point
//! and joint.

use super::attachment_tree::AttachmentTree;
use super::jacobian::Column;
use foliate_components::Pose;
use foliate_components::robot::JointIndex;
use glam::DVec3;

/// A point on a body with its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedPoint {
    /// The body; `None` where the point is fixed in the world.
    pub body: Option<JointIndex>,
    /// Any number.
    pub weight: f64,
    /// In the body's joint frame, or in the world; metres.
    pub point: DVec3,
}

/// The joints between one body and weighted points, read from that body outwards.
#[derive(Clone, Debug, Default)]
pub struct PointTree {
    /// Inner ones first.
    nodes: Vec<PointNode>,
    /// The points with the node that moves them; `None` where no joint does.
    points: Vec<(Option<usize>, WeightedPoint)>,
}

/// One joint with what lies beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointNode {
    /// The node before it, nearer to the body from which one looks.
    pub parent: Option<usize>,
    /// The joint.
    pub joint: JointIndex,
    /// Whether the joint's own body lies beyond it, as seen from where one looks; otherwise its parent does.
    pub outward: bool,
    /// Sum of the weights of the points beyond.
    pub weight: f64,
}

impl PointTree {
    /// The joints between the body `from` and the points; only those that `moves` names become nodes.
    #[must_use]
    pub fn new(
        tree: &AttachmentTree,
        from: Option<JointIndex>,
        points: impl IntoIterator<Item = WeightedPoint>,
        moves: impl Fn(JointIndex) -> bool,
    ) -> Self {
        let mut built = Self::default();
        for point in points {
            let (up, down) = tree.between(from, point.body);
            let path = up.into_iter().map(|joint| (joint, false)).chain(down.into_iter().map(|joint| (joint, true)));
            let mut node = None;
            for (joint, outward) in path.filter(|&(joint, _)| !tree.is_carried(joint) && moves(joint)) {
                let next = built.child(node, joint, outward);
                built.nodes[next].weight += point.weight;
                node = Some(next);
            }
            built.points.push((node, point));
        }
        built
    }

    fn child(&mut self, parent: Option<usize>, joint: JointIndex, outward: bool) -> usize {
        let same = |node: &PointNode| (node.parent, node.joint, node.outward) == (parent, joint, outward);
        self.nodes.iter().position(same).unwrap_or_else(|| {
            self.nodes.push(PointNode { parent, joint, outward, weight: 0.0 });
            self.nodes.len() - 1
        })
    }

    /// The joints, inner ones first.
    #[must_use]
    pub fn nodes(&self) -> &[PointNode] {
        &self.nodes
    }

    /// The points with the node that moves them.
    pub(crate) fn points(&self) -> &[(Option<usize>, WeightedPoint)] {
        &self.points
    }

    /// Writes for each node the moment Σ wₖpₖ of the points beyond, in the world, and returns that of all points.
    ///
    /// # Panics
    /// If a slice is too short.
    #[inline]
    pub fn moments(&self, X_WJ: &[Pose], moments: &mut [DVec3]) -> DVec3 {
        let moments = &mut moments[..self.nodes.len()];
        moments.fill(DVec3::ZERO);
        let mut total = DVec3::ZERO;
        for &(node, WeightedPoint { body, weight, point }) in &self.points {
            let in_world = body.map_or(point, |body| X_WJ[body.at()].transform_point(point));
            match node {
                Some(node) => moments[node] += weight * in_world,
                None => total += weight * in_world,
            }
        }
        for (index, node) in self.nodes.iter().enumerate().rev() {
            let beyond = moments[index];
            match node.parent {
                Some(parent) => moments[parent] += beyond,
                None => total += beyond,
            }
        }
        total
    }

    /// How the velocity coordinates that `variable` numbers move the sum, as seen from the body `from`; with each column
    /// the node whose points it moves.
    #[must_use]
    pub fn columns(&self, tree: &AttachmentTree, variable: impl Fn(usize) -> Option<usize>) -> Vec<MomentColumn> {
        let mut columns = Vec::new();
        let mut own = Vec::new();
        for (index, node) in self.nodes.iter().enumerate() {
            tree.columns_of(node.joint, if node.outward { 1.0 } else { -1.0 }, &variable, &mut own);
            let weight = node.weight;
            columns.extend(own.drain(..).map(|column| MomentColumn { node: index, weight, column }));
        }
        columns
    }
}

/// What one velocity coordinate does to a weighted sum of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MomentColumn {
    /// The node of the tree whose points it moves.
    pub node: usize,
    /// Sum of their weights.
    pub weight: f64,
    /// The motion.
    pub column: Column,
}

impl MomentColumn {
    /// The velocity of the sum at unit speed, in the axes of the world; `moments` as [`PointTree::moments`] writes them.
    ///
    /// # Panics
    /// If a slice is too short.
    #[inline]
    #[must_use]
    pub fn velocity(&self, X_WJ: &[Pose], moments: &[DVec3]) -> DVec3 {
        match self.column {
            Column::Turn { body, axis, .. } => {
                let X_WB = &X_WJ[body.at()];
                (X_WB.rotation * axis).cross(moments[self.node] - self.weight * X_WB.translation)
            }
            Column::Slide { frame: Some(body), axis, .. } => X_WJ[body.at()].rotation * (axis * self.weight),
            Column::Slide { frame: None, axis, .. } => axis * self.weight,
        }
    }
}
