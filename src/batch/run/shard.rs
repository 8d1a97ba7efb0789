//! `i/n`: the i-th of n parts of a batch.

use std::fmt;
use std::str::FromStr;

/// One of several parts of a batch. Which part a row is in follows from its identity alone, so that parts may be solved anywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: u32,
    of: u32,
}

/// What is no part of a batch.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no part of a batch; write i/n with 1 <= i <= n, say 2/8")]
pub struct ShardError(String);

impl Shard {
    /// Part `number` of `of`, counted from 1; `None` where there is no such part.
    #[must_use]
    pub fn new(number: u32, of: u32) -> Option<Self> {
        (1..=of).contains(&number).then_some(Self { number, of })
    }

    /// Whether the row of an identity is in this part.
    #[must_use]
    pub fn has(self, id: &str) -> bool {
        // Identities are hashes: any of their digits are spread evenly.
        let digits = id.get(..16).and_then(|digits| u64::from_str_radix(digits, 16).ok()).unwrap_or_default();
        digits % u64::from(self.of) == u64::from(self.number - 1)
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let number = |digits: &str| digits.parse::<u32>().ok();
        let parts = text.split_once('/').and_then(|(part, all)| Self::new(number(part)?, number(all)?));
        parts.ok_or_else(|| ShardError(text.escape_debug().to_string()))
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::Shard;

    #[test]
    fn every_row_is_in_one_part() {
        let ids: Vec<String> = (0..300_u64).map(|n| format!("{:032x}", u128::from(n) << 70)).collect();
        let parts: Vec<Shard> = (1..=7).map(|number| Shard::new(number, 7).unwrap()).collect();
        assert!(ids.iter().all(|id| parts.iter().filter(|part| part.has(id)).count() == 1));
        assert!(parts.iter().all(|part| ids.iter().any(|id| part.has(id))));
    }

    #[test]
    fn parts_are_read_and_nonsense_is_refused() {
        assert_eq!("2/8".parse::<Shard>().unwrap().to_string(), "2/8");
        for text in ["", "1", "0/3", "4/3", "1/0", "-1/3", "1/3/5", "a/b"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
