//! How fast and how curved weighted sums of points move between two knots: what the bounds on balance, distances and
//! functions are made of.
//!
//! Seen from one body, the sum Σ wₖpₖ has ‖f″‖ ≤ Σᵢⱼ |Δᵢ||Δⱼ| cᵢⱼ over the joints i that lie before j or are j, with the
//! cᵢⱼ of a single point's bound (see `residual_bound`), where the moment of the points beyond j takes the point's place:
//! ρⱼ = |wⱼ| × distance of their weighted centre from axis j, and |wⱼ| for a slide. Joints on different branches move
//! different points, so they do not mix. On a curve the |Δᵢ| are the largest speeds, and ρⱼ times the largest acceleration of each
//! joint j is added.

use crate::constrained_motion::bounds::joint_links::{Link, Pace};
use crate::constraints::custom::FunctionMemory;
use crate::kinematics::{AttachmentTree, PointTree, WeightedPoint};
use foliate_components::Pose;
use foliate_components::robot::JointIndex;
use glam::DVec3;

/// A weighted sum of points with the joints that move it.
#[derive(Clone, Debug)]
pub(crate) struct PointRates {
    tree: PointTree,
    /// For each node, from the body outwards.
    links: Vec<Vec<Link>>,
}

/// Buffers of the bounds, so that none of them allocates once they are warm. Any bound may use them in turn; nothing that they
/// hold changes an answer.
#[derive(Clone, Debug, Default)]
pub struct BoundMemory {
    moments: Vec<DVec3>,
    turned: Vec<f64>,
    travelled: Vec<f64>,
    pub(crate) function: FunctionMemory,
}

/// Where a sum starts, and how it moves over one interval of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rates {
    /// The sum at the start, in the world.
    pub start: DVec3,
    /// At least its speed: how far it can come.
    pub speed: f64,
    /// At least the length of its second derivative.
    pub acceleration: f64,
}

impl PointRates {
    /// Seen from the body `from`; `links` gives the free motions of a joint, its own body outwards.
    pub(crate) fn new(
        tree: &AttachmentTree,
        from: Option<JointIndex>,
        points: impl IntoIterator<Item = WeightedPoint>,
        links: impl Fn(JointIndex) -> Vec<Link>,
    ) -> Self {
        let tree = PointTree::new(tree, from, points, |joint| !links(joint).is_empty());
        let outward = |mut links: Vec<Link>, outward: bool| {
            // A root slides, then turns; seen from beyond it is the other way round.
            if !outward {
                links.reverse();
            }
            links
        };
        let links = tree.nodes().iter().map(|node| outward(links(node.joint), node.outward)).collect();
        Self { tree, links }
    }

    /// For a motion with this pace from where bodies are at `start`.
    pub(crate) fn rates(&self, pace: &Pace<'_>, start: &[Pose], memory: &mut BoundMemory) -> Rates {
        let nodes = self.tree.nodes();
        let BoundMemory { moments, turned, travelled, .. } = memory;
        moments.resize(nodes.len(), DVec3::ZERO);
        let total = self.tree.moments(start, moments);
        turned.resize(nodes.len(), 0.0);
        for (index, node) in nodes.iter().enumerate() {
            turned[index] = node.parent.map_or(0.0, |parent| turned[parent]) + turn_of(&self.links[index], pace);
        }
        // From the outermost joint inwards: the moment about an axis changes at most as fast as the joints beyond move it.
        travelled.clear();
        travelled.resize(nodes.len(), 0.0);
        let mut rates = Rates { start: total, speed: 0.0, acceleration: 0.0 };
        for (index, node) in nodes.iter().enumerate().rev() {
            let (mut travel, mut turned_before): (f64, f64) = (travelled[index], turned[index]);
            for link in self.links[index].iter().rev() {
                let (step, bend) = (link.length(pace), link.bend(pace));
                match *link {
                    Link::Turn { body, axis, .. } => {
                        turned_before -= step;
                        let X_WB = &start[body];
                        let lever = moments[index] - node.weight * X_WB.translation;
                        let lever = axis.map_or(lever, |axis| lever.cross(X_WB.rotation * axis));
                        let reach = lever.length() + travel;
                        rates.acceleration += reach * step * (step + 2.0 * turned_before) + reach * bend;
                        travel += reach * step;
                    }
                    Link::Slide { .. } => {
                        rates.acceleration += 2.0 * node.weight.abs() * step * turned_before + node.weight.abs() * bend;
                        travel += node.weight.abs() * step;
                    }
                }
            }
            match node.parent {
                Some(parent) => travelled[parent] += travel,
                None => rates.speed += travel,
            }
        }
        rates
    }

    /// Angular speed and acceleration of the body of a single point, at most.
    pub(crate) fn turning(&self, pace: &Pace<'_>) -> (f64, f64) {
        let turns = self.links.iter().flatten().filter(|link| matches!(link, Link::Turn { .. }));
        let (mut speed, mut acceleration) = (0.0, 0.0);
        for link in turns {
            let step = link.length(pace);
            acceleration += step * speed + link.bend(pace);
            speed += step;
        }
        (speed, acceleration)
    }
}

fn turn_of(links: &[Link], pace: &Pace<'_>) -> f64 {
    links.iter().filter(|link| matches!(link, Link::Turn { .. })).map(|link| link.length(pace)).sum()
}
