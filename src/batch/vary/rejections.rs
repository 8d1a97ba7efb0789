//! Why draws were no instance, counted.

use std::fmt;
use std::str::FromStr;

/// Why a draw is no instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rejection {
    /// A place is beyond the edge of the support, the bounds of the object or those that are asked for.
    Outside,
    /// The object would not rest there as the scene demands.
    Unstable,
    /// Something collides at the start.
    StartCollides,
    /// Something collides at a goal.
    GoalCollides,
    /// The start cannot be planned from for another reason.
    Start,
    /// A goal cannot be planned to for another reason.
    Goal,
    /// The changed scene cannot be read.
    Scene,
}

/// Draws that were no instance, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rejections([u64; Rejection::ALL.len()]);

/// What is no list of counts.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no list of reasons and counts")]
pub struct RejectionsError(String);

impl Rejection {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Outside, Self::Unstable, Self::StartCollides, Self::GoalCollides, Self::Start, Self::Goal, Self::Scene];

    /// Its name in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Outside => "outside",
            Self::Unstable => "unstable",
            Self::StartCollides => "start_collides",
            Self::GoalCollides => "goal_collides",
            Self::Start => "start",
            Self::Goal => "goal",
            Self::Scene => "scene",
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Outside => "beyond an edge or bounds",
            Self::Unstable => "not resting as demanded",
            Self::StartCollides => "colliding at the start",
            Self::GoalCollides => "colliding at a goal",
            Self::Start => "no start for another reason",
            Self::Goal => "no goal for another reason",
            Self::Scene => "a scene that cannot be read",
        }
    }
}

impl Rejections {
    /// Counts one more.
    pub fn add(&mut self, reason: Rejection) {
        self.0[reason as usize] += 1;
    }

    /// Adds the counts of others.
    pub fn add_all(&mut self, others: &Self) {
        self.0.iter_mut().zip(others.0).for_each(|(count, other)| *count += other);
    }

    /// How often this was the reason.
    #[must_use]
    pub fn count(&self, reason: Rejection) -> u64 {
        self.0[reason as usize]
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(|count| *count == 0)
    }

    fn listed(&self) -> impl Iterator<Item = (Rejection, u64)> {
        let counts = self.0;
        Rejection::ALL.into_iter().map(move |reason| (reason, counts[reason as usize])).filter(|(_, count)| *count > 0)
    }

    /// As a sentence has it: `12 beyond an edge or bounds, 3 colliding at the start`.
    #[must_use]
    pub fn words(&self) -> String {
        let words: Vec<String> = self.listed().map(|(reason, count)| format!("{count} {}", reason.words())).collect();
        words.join(", ")
    }
}

/// As results have it: `outside=12 start_collides=3`.
impl fmt::Display for Rejections {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words: Vec<String> = self.listed().map(|(reason, count)| format!("{}={count}", reason.name())).collect();
        f.write_str(&words.join(" "))
    }
}

impl FromStr for Rejections {
    type Err = RejectionsError;

    fn from_str(text: &str) -> Result<Self, RejectionsError> {
        let mut counts = Self::default();
        for word in text.split_whitespace() {
            let entry = word.split_once('=').and_then(|(name, count)| {
                let reason = Rejection::ALL.into_iter().find(|reason| reason.name() == name)?;
                Some((reason, count.parse::<u64>().ok()?))
            });
            let (reason, count) = entry.ok_or_else(|| RejectionsError(text.escape_debug().to_string()))?;
            counts.0[reason as usize] += count;
        }
        Ok(counts)
    }
}

#[cfg(test)]
mod tests {
    use super::{Rejection, Rejections};

    #[test]
    fn counts_are_written_and_read_back() {
        let mut counts = Rejections::default();
        assert_eq!((counts.to_string(), counts.is_empty()), (String::new(), true));
        counts.add(Rejection::GoalCollides);
        counts.add(Rejection::Outside);
        counts.add(Rejection::Outside);
        assert_eq!(counts.to_string(), "outside=2 goal_collides=1");
        assert_eq!(counts.words(), "2 beyond an edge or bounds, 1 colliding at a goal");
        assert_eq!(counts.to_string().parse(), Ok(counts));
        let mut both = counts;
        both.add_all(&counts);
        assert_eq!(both.count(Rejection::Outside), 4);
        for text in ["outside", "outside=-1", "elsewhere=1", "outside=1,unstable=2"] {
            assert!(text.parse::<Rejections>().is_err(), "{text}");
        }
        for (number, reason) in Rejection::ALL.into_iter().enumerate() {
            assert_eq!(reason as usize, number);
        }
    }
}
