//! How far one leaf is from many of one state: a pass over the columns of their parameters.

use crate::exploration::parameter_column::ParameterColumn;
use foliate_components::graph::leaf::ParameterId;
use foliate_kernels::lanes::{Isa, Kernel, Level};

/// Leaves that are measured at once.
const BLOCK: usize = 32;

/// The distance between any leaf of one state and any of another, as a function of which values they share.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeafDistanceTable {
    /// Where all values that both have are the same.
    pub least: u16,
    /// Constraints of a subject that shares no other: each adds its own where the values differ.
    pub alone: Vec<Row>,
    /// Constraints of one subject: the largest of those whose values differ is added.
    pub together: Vec<Vec<Row>>,
}

/// A constraint that foliates both states.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// Its position in the foliation of either state.
    pub from: u16,
    pub to: u16,
    /// What another value adds.
    pub extra: u16,
}

/// Which end of a [`LeafDistanceTable`] one leaf stands at, when it is measured against many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    From,
    To,
}

impl LeafDistanceTable {
    /// The distance between two leaves: where there are few this is quicker than columns.
    pub fn distance(&self, from: &[ParameterId], to: &[ParameterId]) -> u16 {
        let extra = |row: &Row| match from[usize::from(row.from)] == to[usize::from(row.to)] {
            true => 0,
            false => row.extra,
        };
        let alone: u16 = self.alone.iter().map(extra).sum();
        let together: u16 = self.together.iter().map(|rows| rows.iter().map(extra).max().unwrap_or(0)).sum();
        self.least + alone + together
    }

    /// What the distances between a leaf with values `one`, which stands at an end, and many others come to.
    pub fn distances<'a>(&self, one: &[ParameterId], end: End, many: &'a [ParameterColumn]) -> Distances<'a> {
        let mut distances =
            Distances { least: self.least, alone: Vec::with_capacity(self.alone.len()), together: Vec::new() };
        let term = |row: &Row| {
            let (value, column) = match end {
                End::From => (one[usize::from(row.from)], &many[usize::from(row.to)]),
                End::To => (one[usize::from(row.to)], &many[usize::from(row.from)]),
            };
            column.has(value).then_some(Term { value, column: column.values(), extra: row.extra })
        };
        for row in &self.alone {
            match term(row) {
                Some(term) => distances.alone.push(term),
                None => distances.least += row.extra,
            }
        }
        for subject in &self.together {
            let absent = subject.iter().filter(|row| term(row).is_none()).map(|row| row.extra).max().unwrap_or(0);
            distances.least += absent;
            // The largest counts, so that of the others only what they are more.
            let more = subject.iter().filter(|row| row.extra > absent).filter_map(term);
            let terms: Vec<_> = more.map(|term| Term { extra: term.extra - absent, ..term }).collect();
            if !terms.is_empty() {
                distances.together.push(terms);
            }
        }
        distances
    }
}

/// How far one leaf is from each of many.
#[derive(Clone, Debug)]
pub(crate) struct Distances<'a> {
    /// From those that have all its values that any has.
    least: u16,
    alone: Vec<Term<'a>>,
    together: Vec<Vec<Term<'a>>>,
}

/// A value that some of the others have.
#[derive(Clone, Copy, Debug)]
struct Term<'a> {
    value: ParameterId,
    column: &'a [ParameterId],
    /// What another value adds.
    extra: u16,
}

impl Distances<'_> {
    /// Whether all are as far, and farther than they would be from any leaf of the same state with more in common.
    pub fn has_nothing_in_common(&self) -> bool {
        self.alone.is_empty() && self.together.is_empty()
    }

    /// Writes the distances of the first leaves, as many as there is room for; answers the smallest.
    pub fn measure(&self, level: Level, out: &mut [u16]) -> u16 {
        level.run(Measure { of: self, out })
    }

    /// The smallest distance of the first `count` leaves; `u16::MAX` where that is none.
    pub fn nearest(&self, level: Level, count: usize) -> u16 {
        if count > 0 && self.has_nothing_in_common() { self.least } else { level.run(Nearest { of: self, count }) }
    }

    /// Lowers what is known of the first leaves to their distances, where these are smaller, and lists those leaves.
    pub fn lower(&self, level: Level, known: &mut [u16], lowered: &mut Vec<usize>) {
        level.run(Lower { of: self, known, lowered });
    }

    /// Distances of a block of leaves; behind the last, those of leaves that share nothing.
    #[inline(always)]
    fn block(&self, start: usize) -> [u16; BLOCK] {
        let mut far = [self.least; BLOCK];
        for term in &self.alone {
            term.add(start, &mut far);
        }
        for subject in &self.together {
            let mut most = [0; BLOCK];
            for term in subject {
                let mut extra = [0; BLOCK];
                term.add(start, &mut extra);
                for index in 0..BLOCK {
                    most[index] = extra[index].max(most[index]);
                }
            }
            for index in 0..BLOCK {
                far[index] += most[index];
            }
        }
        far
    }
}

impl Term<'_> {
    /// Adds what other values cost.
    #[inline(always)]
    fn add(&self, start: usize, far: &mut [u16; BLOCK]) {
        let others = &self.column[start..];
        // Counted through, and blocks of a length that the compiler knows: two compares and one sum that stays in its register.
        match others.first_chunk::<BLOCK>() {
            Some(others) => {
                for index in 0..BLOCK {
                    far[index] += if others[index] == self.value { 0 } else { self.extra };
                }
            }
            None => {
                for (index, far) in far.iter_mut().enumerate() {
                    *far += if others.get(index) == Some(&self.value) { 0 } else { self.extra };
                }
            }
        }
    }
}

struct Measure<'a> {
    of: &'a Distances<'a>,
    out: &'a mut [u16],
}

impl Kernel for Measure<'_> {
    type Output = u16;

    #[inline(always)]
    fn run<I: Isa>(self, _: I) -> u16 {
        let mut least = [u16::MAX; BLOCK];
        for (number, out) in self.out.chunks_mut(BLOCK).enumerate() {
            let far = self.of.block(number * BLOCK);
            lower(&mut least, &far, out.len());
            match out.first_chunk_mut::<BLOCK>() {
                Some(out) => *out = far,
                None => out.copy_from_slice(&far[..out.len()]),
            }
        }
        smallest(&least)
    }
}

pub(crate) struct Nearest<'a> {
    of: &'a Distances<'a>,
    count: usize,
}

impl Kernel for Nearest<'_> {
    type Output = u16;

    #[inline(always)]
    fn run<I: Isa>(self, _: I) -> u16 {
        let mut least = [u16::MAX; BLOCK];
        for start in (0..self.count).step_by(BLOCK) {
            let far = self.of.block(start);
            lower(&mut least, &far, self.count - start);
        }
        smallest(&least)
    }
}

struct Lower<'a> {
    of: &'a Distances<'a>,
    known: &'a mut [u16],
    lowered: &'a mut Vec<usize>,
}

impl Kernel for Lower<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self, _: I) {
        for (number, known) in self.known.chunks_mut(BLOCK).enumerate() {
            let start = number * BLOCK;
            let far = self.of.block(start);
            // Most blocks have none; which one has is looked for where there is one.
            if let Some(known) = known.first_chunk::<BLOCK>() {
                let mut any = false;
                for index in 0..BLOCK {
                    any |= far[index] < known[index];
                }
                if !any {
                    continue;
                }
            }
            for (index, (known, &far)) in known.iter_mut().zip(&far).enumerate() {
                if far < *known {
                    *known = far;
                    self.lowered.push(start + index);
                }
            }
        }
    }
}

/// Lowers the first `count` numbers to distances.
#[inline(always)]
fn lower(least: &mut [u16; BLOCK], far: &[u16; BLOCK], count: usize) {
    if count >= BLOCK {
        for index in 0..BLOCK {
            least[index] = far[index].min(least[index]);
        }
    } else {
        for index in 0..count {
            least[index] = far[index].min(least[index]);
        }
    }
}

#[inline(always)]
fn smallest(numbers: &[u16; BLOCK]) -> u16 {
    let mut least = u16::MAX;
    for &number in numbers {
        least = least.min(number);
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What blocks are to say, one leaf after another.
    fn one_by_one(
        pair: &LeafDistanceTable,
        one: &[ParameterId],
        end: End,
        many: &[ParameterColumn],
        index: usize,
    ) -> u16 {
        let extra = |row: &Row| {
            let (own, other) = match end {
                End::From => (one[usize::from(row.from)], many[usize::from(row.to)].values()[index]),
                End::To => (one[usize::from(row.to)], many[usize::from(row.from)].values()[index]),
            };
            if own == other { 0 } else { row.extra }
        };
        let alone: u16 = pair.alone.iter().map(extra).sum();
        let together: u16 = pair.together.iter().map(|rows| rows.iter().map(extra).max().unwrap_or(0)).sum();
        pair.least + alone + together
    }

    fn column(values: impl Iterator<Item = ParameterId>) -> ParameterColumn {
        let mut column = ParameterColumn::default();
        values.for_each(|value| column.push(value));
        column
    }

    #[test]
    fn blocks_say_what_leaf_by_leaf_is_true() {
        let row = |from, to, extra| Row { from, to, extra };
        let pair = LeafDistanceTable {
            least: 3,
            alone: vec![row(0, 1, 2), row(1, 0, 4)],
            together: vec![vec![row(2, 3, 1), row(3, 2, 5)], vec![row(0, 2, 7)]],
        };
        let number = |row: usize, leaf: usize| ParameterId(((leaf * (row + 3) * 31 + leaf / 7) % 5) as u32);
        let unknown = ParameterId(99);
        for count in [0, 1, 31, 32, 33, 400] {
            // One leaf more than is asked about.
            let many: Vec<_> = (0..4).map(|row| column((0..=count).map(|leaf| number(row, leaf)))).collect();
            // Values that no leaf has, in one row after another.
            for absent in 0..16 {
                let own = |row| if absent >> row & 1 == 1 { unknown } else { number(row, 11) };
                let one: Vec<ParameterId> = (0..4).map(own).collect();
                let ends = [End::From, End::To];
                for (end, level) in Level::available().into_iter().flat_map(|level| ends.map(|end| (end, level))) {
                    let distances = pair.distances(&one, end, &many);
                    let wanted: Vec<u16> = (0..count).map(|index| one_by_one(&pair, &one, end, &many, index)).collect();
                    let least = wanted.iter().copied().min().unwrap_or(u16::MAX);
                    let mut out = vec![0; count];
                    assert_eq!(distances.measure(level, &mut out), least);
                    assert_eq!(out, wanted);
                    assert_eq!(distances.nearest(level, count), least);
                    let before: Vec<u16> = (0..count).map(|index| if index % 3 == 0 { 6 } else { 14 }).collect();
                    let (mut known, mut lowered) = (before.clone(), Vec::new());
                    distances.lower(level, &mut known, &mut lowered);
                    let lower = |index: &usize| wanted[*index] < before[*index];
                    assert_eq!(lowered, (0..count).filter(lower).collect::<Vec<_>>());
                    assert!(known.iter().zip(&before).zip(&wanted).all(|((known, a), b)| known == a.min(b)));
                }
            }
        }
    }
}
