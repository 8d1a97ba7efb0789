//! Which pairs of shapes were tested, in words and for machines.

use crate::components::coverage::{self, LeftOutPair, PairCounts};
use crate::components::robot::ShapeIndex;
use crate::inspection;
use crate::systems::planning_model::ProblemTables;
use serde_json::{Value, json};

/// The pairs that a problem leaves out.
pub(crate) struct LeftOut {
    /// All of them.
    pub pairs: Vec<LeftOutPair>,
    /// Those that a file leaves out although they do not touch at the start.
    pub apart: Vec<LeftOutPair>,
}

impl LeftOut {
    pub(crate) fn of(tables: &ProblemTables) -> Self {
        let (pairs, problem) = (tables.left_out(), &tables.problem);
        let is_whole = problem.start.len() == problem.robot.space.size();
        let apart = match is_whole && problem.start.iter().all(|x| x.is_finite()) {
            true => inspection::apart(&problem.robot, &tables.collision, &pairs, &problem.start),
            false => Vec::new(),
        };
        Self { pairs, apart }
    }

    /// What a user should know before believing a certificate.
    pub(crate) fn warning(&self) -> Option<String> {
        apart_warning(&self.apart, "the start")
    }
}

/// How many pairs were tested, and how many were not, by reason.
pub(crate) fn sentence(counts: &PairCounts) -> String {
    let mut tested = match counts.looked_at() {
        0 => "none is tested".to_owned(),
        _ => format!("{} tested", counts.tested),
    };
    if counts.rigid > 0 {
        tested.push_str(&format!(", {} held together by locked joints (tested once, at the start)", counts.rigid));
    }
    let without = [(counts.grasped, "grasped"), (counts.placed, "placed")];
    let without: Vec<_> = without.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
    if !without.is_empty() {
        tested.push_str(&format!(" (without their margins where they touch: {})", without.join(", ")));
    }
    let reasons = [
        (counts.srdf, coverage::LeftOut::Srdf),
        (counts.adjacent, coverage::LeftOut::Adjacent),
        (counts.ignored, coverage::LeftOut::Ignored),
        (counts.same_body, coverage::LeftOut::SameBody),
        (counts.environment, coverage::LeftOut::Environment),
    ];
    let left: Vec<_> =
        reasons.iter().filter(|(n, _)| *n > 0).map(|(n, why)| format!("{n} {}", why.describe())).collect();
    if left.is_empty() { tested } else { format!("{tested}; not tested: {}", left.join(", ")) }
}

/// The warning about pairs that are left out although they do not touch somewhere.
pub(crate) fn apart_warning(apart: &[LeftOutPair], place: &str) -> Option<String> {
    let reasons = [coverage::LeftOut::Srdf, coverage::LeftOut::Adjacent, coverage::LeftOut::Ignored];
    let counts = reasons.map(|why| (apart.iter().filter(|pair| pair.why == why).count(), why.describe()));
    let counts: Vec<_> = counts.iter().filter(|(n, _)| *n > 0).map(|(n, why)| format!("{n} {why}")).collect();
    (!apart.is_empty()).then(|| {
        format!(
            "{} pairs of shapes are left out although they do not touch at {place} ({}); --pairs lists them",
            apart.len(),
            counts.join(", ")
        )
    })
}

/// A pair that is left out, in one line.
pub(crate) fn line<'a>(pair: &LeftOutPair, apart: &[LeftOutPair], name: impl Fn(ShapeIndex) -> &'a str) -> String {
    let remark = if apart.contains(pair) { ", and does not touch there" } else { "" };
    format!("{} and {}: {}{remark}", name(pair.first), name(pair.second), pair.why.describe())
}

pub(crate) fn counts_json(counts: &PairCounts) -> Value {
    json!({
        "tested": counts.tested,
        "rigid": counts.rigid,
        "same_body": counts.same_body,
        "environment": counts.environment,
        "srdf": counts.srdf,
        "adjacent": counts.adjacent,
        "ignored": counts.ignored,
        "grasped": counts.grasped,
        "placed": counts.placed,
    })
}

/// Pairs that are left out: shape, shape, reason, whether they are apart although a file leaves them out.
pub(crate) fn list_json<'a>(
    pairs: &[LeftOutPair],
    apart: &[LeftOutPair],
    name: impl Fn(ShapeIndex) -> &'a str,
) -> Vec<Value> {
    let entry = |pair: &LeftOutPair| {
        let why = match pair.why {
            coverage::LeftOut::SameBody => "same_body",
            coverage::LeftOut::Environment => "environment",
            coverage::LeftOut::Srdf => "srdf",
            coverage::LeftOut::Adjacent => "adjacent",
            coverage::LeftOut::Ignored => "ignored",
        };
        json!({ "first": name(pair.first), "second": name(pair.second), "why": why, "apart": apart.contains(pair) })
    };
    pairs.iter().map(entry).collect()
}
