//! Which links are tested against which (DESIGN §5.5).

use foliate_components::problem::Margin;
use foliate_components::robot::{DisabledPair, JointIndex, LinkIndex, Robot};
use std::collections::{HashMap, HashSet};

/// What narrows the pairs besides the robot's own disabled pairs.
#[derive(Clone, Copy, Debug)]
pub struct PairRule<'a> {
    /// Link pairs that are not tested.
    pub ignored: &'a [DisabledPair],
    /// Distances that link pairs must keep; the largest counts, 0 where there is none.
    pub margins: &'a [Margin],
    /// Joints that never move: they make their bodies one with their parents'.
    pub locked: &'a [JointIndex],
    /// Whether, in parts that came without an SRDF, bodies joined by one moving joint are left alone.
    pub ignore_neighbours_without_srdf: bool,
}

impl Default for PairRule<'_> {
    fn default() -> Self {
        Self { ignored: &[], margins: &[], locked: &[], ignore_neighbours_without_srdf: true }
    }
}

/// A rule, ready for look-ups.
pub(super) struct Rules {
    ignored: HashSet<(LinkIndex, LinkIndex)>,
    margins: HashMap<(LinkIndex, LinkIndex), f64>,
    /// By link: its body's index and, where neighbours count as ignored, the body's parent (one more than the joint's
    /// index; 0 is the world).
    bodies: Vec<LinkBody>,
}

struct LinkBody {
    part: u32,
    body: usize,
    parent: Option<usize>,
}

fn ordered(a: LinkIndex, b: LinkIndex) -> (LinkIndex, LinkIndex) {
    (a.min(b), a.max(b))
}

impl Rules {
    pub(super) fn new(robot: &Robot, rule: &PairRule<'_>) -> Self {
        let pairs = robot.disabled_pairs.iter().chain(rule.ignored);
        let mut margins: HashMap<_, f64> = HashMap::new();
        for m in rule.margins {
            let entry = margins.entry(ordered(m.first, m.second)).or_insert(0.0);
            *entry = entry.max(m.distance);
        }
        let number = |joint: Option<JointIndex>| joint.map_or(0, |j| j.at() + 1);
        let bodies = robot.links.iter().map(|link| {
            let leave_alone = rule.ignore_neighbours_without_srdf && !robot.parts[link.part.at()].has_srdf;
            LinkBody {
                part: link.part.0,
                body: number(link.joint),
                parent: link.joint.filter(|_| leave_alone).map(|j| number(robot.joints[j.at()].parent)),
            }
        });
        Self { ignored: pairs.map(|p| ordered(p.first, p.second)).collect(), margins, bodies: bodies.collect() }
    }

    pub(super) fn tested(&self, a: LinkIndex, b: LinkIndex) -> bool {
        let (one, other) = (&self.bodies[a.at()], &self.bodies[b.at()]);
        let neighbours = one.part == other.part && (one.parent == Some(other.body) || other.parent == Some(one.body));
        !neighbours && !self.ignored.contains(&ordered(a, b))
    }

    pub(super) fn margin(&self, a: LinkIndex, b: LinkIndex) -> f64 {
        self.margins.get(&ordered(a, b)).copied().unwrap_or(0.0)
    }
}
