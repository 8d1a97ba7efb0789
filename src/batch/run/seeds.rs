//! `A..B`: from A to B, both included, as the tables write it.

use std::fmt;
use std::str::FromStr;

/// Seeds from one to another, both included: `1..20` are twenty seeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seeds {
    first: u64,
    last: u64,
}

/// What is no range of seeds.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no range of seeds; write A..B (both included, A not above B), or one number")]
pub struct SeedsError(String);

impl Seeds {
    /// From `first` to `last`; `None` where `last` comes before `first`.
    #[must_use]
    pub fn new(first: u64, last: u64) -> Option<Self> {
        (first <= last).then_some(Self { first, last })
    }

    /// From 1 to a number.
    pub(crate) fn one_to(last: u64) -> Self {
        Self { first: 1, last: last.max(1) }
    }

    /// The first.
    #[must_use]
    pub fn first(self) -> u64 {
        self.first
    }

    /// How many.
    #[must_use]
    pub fn count(self) -> u64 {
        (self.last - self.first).saturating_add(1)
    }
}

impl FromStr for Seeds {
    type Err = SeedsError;

    fn from_str(text: &str) -> Result<Self, SeedsError> {
        let (first, last) = text.split_once("..").unwrap_or((text, text));
        let number = |digits: &str| digits.parse::<u64>().ok();
        let seeds = number(first).zip(number(last)).and_then(|(first, last)| Self::new(first, last));
        seeds.ok_or_else(|| SeedsError(text.escape_debug().to_string()))
    }
}

impl fmt::Display for Seeds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.first == self.last { write!(f, "{}", self.first) } else { write!(f, "{}..{}", self.first, self.last) }
    }
}

#[cfg(test)]
mod tests {
    use super::Seeds;

    #[test]
    fn both_ends_are_included() {
        let seeds: Seeds = "1..20".parse().unwrap();
        assert_eq!((seeds.first(), seeds.count()), (1, 20));
        assert_eq!("7".parse::<Seeds>().unwrap().count(), 1);
        assert_eq!("0..18446744073709551615".parse::<Seeds>().unwrap().count(), u64::MAX);
    }

    #[test]
    fn nonsense_is_refused() {
        for text in ["", "..", "1..", "..3", "3..1", "1..=3", "-1..2", "1..2..3", "18446744073709551616"] {
            assert!(text.parse::<Seeds>().is_err(), "{text}");
        }
    }
}
