//! How far one leaf is from many of one state: a pass over the columns of their parameters.

use foliate_components::leaf::ParameterId;
use foliate_kernels::lanes::{Isa, Kernel, Level};

/// Leaves that are measured at once.
const BLOCK: usize = 32;

/// The distance between any leaf of one state and any of another, as a function of which values they share.
#[derive(Clone, Debug, Default)]
pub(crate) struct StatePair {
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
    pub from: usize,
    pub to: usize,
    /// What another value adds.
    pub extra: u16,
}

/// Which end of a [`StatePair`] one leaf stands at, when it is measured against many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    From,
    To,
}

/// The values of one leaf, the end at which it stands, and those of many at the other end, in columns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OneToMany<'a> {
    pub one: &'a [ParameterId],
    pub end: End,
    pub many: &'a [Vec<ParameterId>],
}

impl StatePair {
    /// Writes the distances of the first of many leaves, as many as there is room for; answers the smallest.
    pub fn measure(&self, level: Level, leaves: OneToMany<'_>, out: &mut [u16]) -> u16 {
        level.run(Measure { pair: self, leaves, out })
    }

    /// The smallest distance of the first `count` of many leaves; `u16::MAX` where that is none.
    pub fn nearest(&self, level: Level, leaves: OneToMany<'_>, count: usize) -> u16 {
        level.run(Nearest { pair: self, leaves, count })
    }

    /// Lowers what is known of the first of many leaves to their distances, where these are smaller, and lists those leaves.
    pub fn lower(&self, level: Level, leaves: OneToMany<'_>, known: &mut [u16], lowered: &mut Vec<usize>) {
        lowered.clear();
        level.run(Lower { pair: self, leaves, known, lowered });
    }

    /// Distances of a block of leaves; behind the last, those of leaves that share nothing.
    #[inline(always)]
    fn block(&self, leaves: OneToMany<'_>, start: usize) -> [u16; BLOCK] {
        let mut far = [self.least; BLOCK];
        for row in &self.alone {
            row.add(leaves, start, &mut far);
        }
        for subject in &self.together {
            let mut most = [0; BLOCK];
            for row in subject {
                let mut extra = [0; BLOCK];
                row.add(leaves, start, &mut extra);
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

impl Row {
    /// Adds what values other than that of the one leaf cost.
    #[inline(always)]
    fn add(&self, leaves: OneToMany<'_>, start: usize, far: &mut [u16; BLOCK]) {
        let (value, others) = match leaves.end {
            End::From => (leaves.one[self.from], &leaves.many[self.to][start..]),
            End::To => (leaves.one[self.to], &leaves.many[self.from][start..]),
        };
        // Counted through, and blocks of a length that the compiler knows: two compares and one sum that stays in its register.
        match others.first_chunk::<BLOCK>() {
            Some(others) => {
                for index in 0..BLOCK {
                    far[index] += if others[index] == value { 0 } else { self.extra };
                }
            }
            None => {
                for (index, far) in far.iter_mut().enumerate() {
                    *far += if others.get(index) == Some(&value) { 0 } else { self.extra };
                }
            }
        }
    }
}

struct Measure<'a> {
    pair: &'a StatePair,
    leaves: OneToMany<'a>,
    out: &'a mut [u16],
}

impl Kernel for Measure<'_> {
    type Output = u16;

    #[inline(always)]
    fn run<I: Isa>(self, _: I) -> u16 {
        let mut least = [u16::MAX; BLOCK];
        for (number, out) in self.out.chunks_mut(BLOCK).enumerate() {
            let far = self.pair.block(self.leaves, number * BLOCK);
            lower(&mut least, &far, out.len());
            match out.first_chunk_mut::<BLOCK>() {
                Some(out) => *out = far,
                None => out.copy_from_slice(&far[..out.len()]),
            }
        }
        smallest(&least)
    }
}

struct Nearest<'a> {
    pair: &'a StatePair,
    leaves: OneToMany<'a>,
    count: usize,
}

impl Kernel for Nearest<'_> {
    type Output = u16;

    #[inline(always)]
    fn run<I: Isa>(self, _: I) -> u16 {
        let mut least = [u16::MAX; BLOCK];
        for start in (0..self.count).step_by(BLOCK) {
            let far = self.pair.block(self.leaves, start);
            lower(&mut least, &far, self.count - start);
        }
        smallest(&least)
    }
}

struct Lower<'a> {
    pair: &'a StatePair,
    leaves: OneToMany<'a>,
    known: &'a mut [u16],
    lowered: &'a mut Vec<usize>,
}

impl Kernel for Lower<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self, _: I) {
        for (number, known) in self.known.chunks_mut(BLOCK).enumerate() {
            let start = number * BLOCK;
            let far = self.pair.block(self.leaves, start);
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
    fn one_by_one(pair: &StatePair, leaves: OneToMany<'_>, index: usize) -> u16 {
        let extra = |row: &Row| {
            let (own, other) = match leaves.end {
                End::From => (leaves.one[row.from], leaves.many[row.to][index]),
                End::To => (leaves.one[row.to], leaves.many[row.from][index]),
            };
            if own == other { 0 } else { row.extra }
        };
        let alone: u16 = pair.alone.iter().map(extra).sum();
        let together: u16 = pair.together.iter().map(|rows| rows.iter().map(extra).max().unwrap_or(0)).sum();
        pair.least + alone + together
    }

    #[test]
    fn blocks_say_what_leaf_by_leaf_is_true() {
        let row = |from, to, extra| Row { from, to, extra };
        let pair = StatePair {
            least: 3,
            alone: vec![row(0, 1, 2), row(1, 0, 4)],
            together: vec![vec![row(2, 3, 1), row(3, 2, 5)], vec![row(0, 2, 7)]],
        };
        let number = |row: usize, leaf: usize| ParameterId(((leaf * (row + 3) * 31 + leaf / 7) % 5) as u32);
        let one: Vec<ParameterId> = (0..4).map(|row| number(row, 11)).collect();
        for count in [0, 1, 31, 32, 33, 400] {
            // One leaf more than is asked about.
            let many: Vec<Vec<_>> = (0..4).map(|row| (0..=count).map(|leaf| number(row, leaf)).collect()).collect();
            let ends = [End::From, End::To];
            for (end, level) in Level::available().into_iter().flat_map(|level| ends.map(|end| (end, level))) {
                let leaves = OneToMany { one: &one, end, many: &many };
                let wanted: Vec<u16> = (0..count).map(|index| one_by_one(&pair, leaves, index)).collect();
                let least = wanted.iter().copied().min().unwrap_or(u16::MAX);
                let mut out = vec![0; count];
                assert_eq!(pair.measure(level, leaves, &mut out), least);
                assert_eq!(out, wanted);
                assert_eq!(pair.nearest(level, leaves, count), least);
                let before: Vec<u16> = (0..count).map(|index| if index % 3 == 0 { 6 } else { 14 }).collect();
                let (mut known, mut lowered) = (before.clone(), Vec::new());
                pair.lower(level, leaves, &mut known, &mut lowered);
                let lower = |index: &usize| wanted[*index] < before[*index];
                assert_eq!(lowered, (0..count).filter(lower).collect::<Vec<_>>());
                assert!(known.iter().zip(&before).zip(&wanted).all(|((known, a), b)| known == a.min(b)));
            }
        }
    }
}
