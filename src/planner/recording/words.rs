//! A recording in sentences: how the search ended, what it did, what stood in the way, what is left out.

use crate::planner::recording::document::{BlockedPairEntry, LeftOutEntry, Recording};
use std::collections::BTreeMap;

/// Pairs that are named.
const NAMED: usize = 3;

impl Recording {
    /// What there is to say of the search, a sentence each.
    #[must_use]
    pub fn words(&self) -> Vec<String> {
        let mut words = vec![self.ending()];
        words.extend(self.head.findings.iter().map(|finding| format!("The {}: {}.", finding.at, finding.words)));
        let counts = &self.head.counts;
        words.push(format!(
            "{} steps with {} candidates reached {} configurations on {} leaves, joined by {} certified edges.",
            counts.steps, counts.candidates, counts.nodes, counts.leaves, counts.edges
        ));
        words.extend(self.in_the_way());
        if let Some(member) = self.head.members.iter().find(|member| member.answers) {
            let count = self.head.members.len();
            let told = &member.scheduler;
            words.push(format!("Of {count} searches side by side this is the one of `{told}`, which answers."));
        }
        words.extend(self.left_out());
        words
    }

    /// What is left out so that the file keeps its limit; none where all is there.
    #[must_use]
    pub fn left_out(&self) -> Option<String> {
        left_out(&self.head.left_out)
    }

    fn ending(&self) -> String {
        match &self.head.reason {
            None => "A path was found.".into(),
            Some(reason) => format!("No path was found: {reason}."),
        }
    }

    /// The pairs that stopped most candidates, of all transitions together.
    fn in_the_way(&self) -> Option<String> {
        let pairs = self.head.funnel.iter().flat_map(|row| &row.pairs).chain(&self.head.goal_search.pairs);
        let mut counts = BTreeMap::<&[String; 2], u64>::new();
        pairs.for_each(|BlockedPairEntry { links, count, .. }| {
            let sum = counts.entry(links).or_default();
            *sum = sum.saturating_add(*count);
        });
        let mut counts: Vec<_> = counts.into_iter().collect();
        counts.sort_by_key(|&(links, count)| (std::cmp::Reverse(count), links));
        let named = counts.iter().take(NAMED).map(|([a, b], count)| format!("{a} and {b} ({count} times)"));
        let named: Vec<String> = named.collect();
        (!named.is_empty()).then(|| format!("Most often in each other's way: {}.", named.join("; ")))
    }
}

fn left_out(left: &LeftOutEntry) -> Option<String> {
    let counted = [
        (left.nodes, "nodes, those that came last"),
        (left.edges, "edges"),
        (left.states, "states"),
        (left.transitions, "transitions"),
        (left.funnel, "rows of the funnel"),
        (left.pairs, "pairs of shapes"),
        (left.collisions, "configurations of pairs"),
    ];
    let mut parts: Vec<String> =
        counted.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
    if left.path {
        parts.push("the path".into());
    }
    (!parts.is_empty()).then(|| format!("Left out, so that the file keeps its limit: {}.", parts.join("; ")))
}
