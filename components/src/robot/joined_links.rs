//! Neighbours: the two links that one joint joins.

use crate::robot::hybrid_robot::{DisabledPair, Part, Robot};
use crate::robot::indices::{JointIndex, LinkIndex};

/// Two links with shapes that one moving joint joins: how they stand to one another depends on that joint alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JoinedLinks {
    /// The joint.
    pub joint: JointIndex,
    /// The link on the side of the root.
    pub first: LinkIndex,
    /// The link beyond the joint.
    pub second: LinkIndex,
}

impl JoinedLinks {
    /// The pair as one that is not tested, for that reason.
    #[must_use]
    pub fn disabled(self, reason: &str) -> DisabledPair {
        DisabledPair { first: self.first, second: self.second, reason: reason.into() }
    }
}

impl Robot {
    /// The pairs of links of a part that one moving joint joins. A link without shapes is looked through: in its place stand the
    /// links with shapes that fixed joints join to it. What else is fixed to either of the two is no neighbour.
    #[must_use]
    pub fn joined_links(&self, part: &Part) -> Vec<JoinedLinks> {
        let seen = Seen::of(self, part);
        let mut pairs = Vec::new();
        for child in part.links.clone() {
            let link = &self.links[child];
            let (Some(joint), Some(parent)) = (link.joint, link.parent) else { continue };
            if self.links[parent.at()].joint == Some(joint) {
                continue;
            }
            let beyond = seen.from(child);
            for first in seen.from(parent.at()) {
                pairs.extend(beyond.iter().map(|&second| JoinedLinks { joint, first, second }));
            }
        }
        pairs
    }
}

/// What is seen from a link through those without shapes.
struct Seen {
    /// Number of the part's first link.
    start: usize,
    has_shapes: Vec<bool>,
    /// By link: those that a fixed joint joins to it.
    fixed: Vec<Vec<usize>>,
}

impl Seen {
    fn of(robot: &Robot, part: &Part) -> Self {
        let start = part.links.start;
        let mut seen =
            Self { start, has_shapes: vec![false; part.links.len()], fixed: vec![Vec::new(); part.links.len()] };
        for shape in robot.shapes.iter().filter(|shape| part.links.contains(&shape.link.at())) {
            seen.has_shapes[shape.link.at() - start] = true;
        }
        for child in part.links.clone() {
            let Some(parent) = robot.links[child].parent.map(LinkIndex::at) else { continue };
            if robot.links[parent].joint == robot.links[child].joint {
                seen.fixed[parent - start].push(child);
                seen.fixed[child - start].push(parent);
            }
        }
        seen
    }

    /// A link, where it has shapes; else the nearest ones that have.
    fn from(&self, link: usize) -> Vec<LinkIndex> {
        let mut visited = vec![link];
        let mut found = Vec::new();
        let mut next = 0;
        while let Some(&at) = visited.get(next) {
            next += 1;
            if self.has_shapes[at - self.start] {
                found.push(LinkIndex(at as u32));
                continue;
            }
            // Fixed joints make a tree: a link that was visited is the one from which this link was reached.
            let others = self.fixed[at - self.start].iter().filter(|other| !visited.contains(other));
            let others: Vec<usize> = others.copied().collect();
            visited.extend(others);
        }
        found.sort_unstable();
        found
    }
}

#[cfg(test)]
mod tests {
    use super::super::model::{JointKind, JointModel, LinkModel, Model};
    use super::*;
    use crate::Pose;
    use crate::robot::shape::geometry::Geometry;
    use crate::samples::models::fixed_robot;
    use glam::DVec3;

    /// Links by name, `-` before those without shapes; joints as (parent, child, whether it moves).
    fn joined(links: &[&str], joints: &[(usize, usize, bool)]) -> Vec<String> {
        let link = |name: &&str| LinkModel {
            name: name.trim_start_matches('-').into(),
            shapes: if name.starts_with('-') {
                Vec::new()
            } else {
                vec![(Pose::identity(), Geometry::Sphere { radius: 0.1 })]
            },
            inertial: None,
        };
        let joint = |(number, &(parent, child, moves)): (usize, &(usize, usize, bool))| JointModel {
            name: number.to_string(),
            kind: if moves { JointKind::Revolute } else { JointKind::Fixed },
            parent,
            child,
            parent_from_joint: Pose::identity(),
            axis: DVec3::Z,
            limits: (-1.0, 1.0),
            velocity_limit: None,
            mimic: None,
        };
        let model = Model {
            links: links.iter().map(link).collect(),
            joints: joints.iter().enumerate().map(joint).collect(),
            ..Model::default()
        };
        let robot = Robot::compose(&[(&model, fixed_robot("p", Pose::identity()))]).expect("composes");
        let name = |l: LinkIndex| robot.links[l.at()].name["p/".len()..].to_owned();
        let pairs = robot.joined_links(&robot.parts[0]);
        let mut names: Vec<_> = pairs.iter().map(|p| format!("{} {}", name(p.first), name(p.second))).collect();
        names.sort();
        names
    }

    #[test]
    fn a_joint_joins_its_two_links_and_nothing_that_is_fixed_to_them() {
        let joints = [(0, 1, false), (0, 2, true), (2, 3, false), (2, 4, true)];
        assert_eq!(joined(&["floor", "wall", "carriage", "lamp", "arm"], &joints), ["carriage arm", "floor carriage"]);
    }

    #[test]
    fn links_without_shapes_are_looked_through_by_fixed_joints_alone() {
        // The base has no shapes: its body and its post stand for it; what is fixed to the post does not.
        let joints = [(0, 1, false), (0, 2, false), (2, 3, false), (0, 4, true), (4, 5, false), (5, 6, true)];
        let links = ["-base", "body", "post", "sign", "-flange", "hand", "finger"];
        assert_eq!(joined(&links, &joints), ["body hand", "hand finger", "post hand"]);
        // Two joints are between these two.
        assert_eq!(joined(&["a", "-cross", "b"], &[(0, 1, true), (1, 2, true)]), Vec::<String>::new());
    }
}
