//! The solves of a batch, numbered in the order of its rows, and the identity of each row.

use crate::batch::run::seeds::Seeds;
use crate::scene::sources::source::hexadecimal;
use sha2::{Digest, Sha256};

/// One solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Case {
    /// Number of the problem.
    pub entry: usize,
    /// Number of the scheduler.
    pub scheduler: usize,
    /// Number of the settings.
    pub variant: usize,
    /// Number of the varied instance, where the problem is varied.
    pub instance: Option<u64>,
    pub seed: u64,
}

/// All solves: of each problem with each scheduler and all settings, each instance with each seed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cases {
    pub entries: usize,
    pub schedulers: usize,
    pub variants: usize,
    /// How many instances of each problem; `None` where problems are not varied.
    pub instances: Option<u64>,
    pub seeds: Seeds,
}

impl Cases {
    /// How many there are.
    pub(crate) fn count(&self) -> u64 {
        self.groups().saturating_mul(self.in_a_group())
    }

    /// Pairs of problem, scheduler and settings.
    pub(crate) fn groups(&self) -> u64 {
        (self.entries as u64).saturating_mul(self.schedulers as u64).saturating_mul(self.variants as u64)
    }

    fn in_a_group(&self) -> u64 {
        self.instances.unwrap_or(1).saturating_mul(self.seeds.count())
    }

    /// The solve of a number.
    pub(crate) fn case(&self, number: usize) -> Case {
        let (group, within) = (number as u64 / self.in_a_group(), number as u64 % self.in_a_group());
        let (instance, seed) = (within / self.seeds.count(), within % self.seeds.count());
        let (rest, variant) = (group as usize / self.variants, group as usize % self.variants);
        Case {
            entry: rest / self.schedulers,
            scheduler: rest % self.schedulers,
            variant,
            instance: self.instances.map(|_| instance),
            seed: self.seeds.first() + seed,
        }
    }

    /// The number of the group that a solve is in.
    pub(crate) fn group(&self, number: usize) -> usize {
        (number as u64 / self.in_a_group()) as usize
    }
}

/// The identity of a row: a hash of all that decides it, by name.
pub(crate) fn identity(parts: &[(&str, &str)]) -> String {
    /// Hexadecimal digits that are kept: of 10⁹ rows two are equal with a probability of 10⁻²¹.
    const DIGITS: usize = 32;
    let mut hash = Sha256::new();
    for (name, value) in parts {
        // Lengths first: no two lists of parts are the same text.
        hash.update(format!("{} {} {name} {value}\n", name.len(), value.len()));
    }
    let mut text = hexadecimal(&hash.finalize().into());
    text.truncate(DIGITS);
    text
}

#[cfg(test)]
mod tests {
    use super::{Cases, identity};
    use crate::batch::run::seeds::Seeds;
    use std::collections::HashSet;

    #[test]
    fn numbers_run_through_all_solves_in_order() {
        let seeds = Seeds::new(5, 6).unwrap();
        let cases = Cases { entries: 2, schedulers: 2, variants: 3, instances: Some(4), seeds };
        assert_eq!((cases.count(), cases.groups()), (96, 12));
        let all: Vec<_> = (0..96).map(|number| cases.case(number)).collect();
        let key = |number: usize| {
            let case = all[number];
            (case.entry, case.scheduler, case.variant, case.instance, case.seed)
        };
        assert!((1..96).all(|number| key(number - 1) < key(number)));
        assert_eq!((key(0), key(95)), ((0, 0, 0, Some(0), 5), (1, 1, 2, Some(3), 6)));
        assert_eq!((cases.group(0), cases.group(7), cases.group(8), cases.group(95)), (0, 0, 1, 11));
        let plain = Cases { instances: None, ..cases };
        assert_eq!((plain.count(), plain.case(1).instance, plain.case(1).seed), (24, None, 6));
    }

    #[test]
    fn identities_differ_where_a_part_differs() {
        let parts = [("seed", "1"), ("scheduler", "mrrt")];
        let ids = [
            identity(&parts),
            identity(&[("seed", "2"), ("scheduler", "mrrt")]),
            identity(&[("seed", "1 scheduler"), ("", "mrrt")]),
            identity(&[("seed", "1")]),
        ];
        assert_eq!(ids.iter().collect::<HashSet<_>>().len(), 4);
        assert!(ids.iter().all(|id| id.len() == 32) && identity(&parts) == ids[0]);
    }
}
