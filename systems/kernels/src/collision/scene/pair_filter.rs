//! Which links are tested against which.

use foliate_components::coverage::LeftOut;
use foliate_components::problem::Margin;
use foliate_components::robot::{DisabledPair, JointIndex, LinkIndex, Robot, Source};
use std::collections::{HashMap, HashSet};

/// What narrows the pairs besides the robot's own disabled pairs. By default nothing does: what is left out is what a file or a host
/// lists.
#[derive(Clone, Copy, Debug, Default)]
pub struct PairRule<'a> {
    /// Link pairs that are not tested. Neighbours are among them where they shall be
    /// ([`adjacent_links`](crate::collision::scene::adjacent::adjacent_links)).
    pub ignored: &'a [DisabledPair],
    /// Distances that link pairs must keep; the largest counts, 0 where there is none.
    pub margins: &'a [Margin],
    /// Joints that never move: they make their bodies one with their parents'.
    pub locked: &'a [JointIndex],
}

impl PairRule<'_> {
    /// Whether a joint never moves: it is locked, or its leader is.
    pub(crate) fn locks(&self, robot: &Robot, joint: JointIndex) -> bool {
        let leader = match robot.joints[joint.at()].source {
            Source::Coordinates { .. } => None,
            Source::Follows { leader, .. } => Some(leader),
        };
        self.locked.contains(&joint) || leader.is_some_and(|leader| self.locked.contains(&leader))
    }
}

/// A rule, ready for look-ups.
pub(crate) struct Rules {
    disabled: HashSet<(LinkIndex, LinkIndex)>,
    adjacent: HashSet<(LinkIndex, LinkIndex)>,
    ignored: HashSet<(LinkIndex, LinkIndex)>,
    margins: HashMap<(LinkIndex, LinkIndex), f64>,
    /// By link.
    bodies: Vec<LinkBody>,
}

/// The part that a link belongs to, and the body; none where it is fixed in the world.
#[derive(Clone, Copy, PartialEq, Eq)]
struct LinkBody {
    part: u32,
    body: Option<JointIndex>,
}

fn ordered(a: LinkIndex, b: LinkIndex) -> (LinkIndex, LinkIndex) {
    (a.min(b), a.max(b))
}

impl Rules {
    pub(crate) fn new(robot: &Robot, rule: &PairRule<'_>) -> Self {
        let mut margins: HashMap<_, f64> = HashMap::new();
        for m in rule.margins {
            let entry = margins.entry(ordered(m.first, m.second)).or_insert(0.0);
            *entry = entry.max(m.distance);
        }
        let ordered = |p: &DisabledPair| ordered(p.first, p.second);
        let (adjacent, ignored): (Vec<_>, Vec<_>) =
            rule.ignored.iter().partition(|pair| pair.reason == DisabledPair::ADJACENT);
        Self {
            disabled: robot.disabled_pairs.iter().map(ordered).collect(),
            adjacent: adjacent.into_iter().map(ordered).collect(),
            ignored: ignored.into_iter().map(ordered).collect(),
            margins,
            bodies: robot.links.iter().map(|link| LinkBody { part: link.part.0, body: link.joint }).collect(),
        }
    }

    /// Why shapes of two links are not tested against each other; `None` where they are. All that lists, counts or tests pairs
    /// asks here.
    pub(crate) fn left_out(&self, a: LinkIndex, b: LinkIndex) -> Option<LeftOut> {
        let (one, other) = (self.bodies[a.at()], self.bodies[b.at()]);
        let pair = ordered(a, b);
        if one == other {
            Some(LeftOut::SameBody)
        } else if one.body.is_none() && other.body.is_none() {
            Some(LeftOut::Environment)
        } else if self.disabled.contains(&pair) {
            Some(LeftOut::Srdf)
        } else if self.ignored.contains(&pair) {
            // Who says so need not be a neighbour as well.
            Some(LeftOut::Ignored)
        } else {
            self.adjacent.contains(&pair).then_some(LeftOut::Adjacent)
        }
    }

    pub(crate) fn margin(&self, a: LinkIndex, b: LinkIndex) -> f64 {
        self.margins.get(&ordered(a, b)).copied().unwrap_or(0.0)
    }
}
