//! Who waits for whom, and which objects to set aside so that the others can go.

/// By object: those whose present placement excludes its target placement.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Dependencies {
    waits_for: Vec<Vec<usize>>,
}

impl Dependencies {
    pub(crate) fn new(waits_for: Vec<Vec<usize>>) -> Self {
        Self { waits_for }
    }

    /// Whether an object waits for another.
    pub(crate) fn waits(&self, object: usize) -> bool {
        !self.waits_for[object].is_empty()
    }

    /// The same where an object rests elsewhere, so that these others wait for it.
    pub(crate) fn moved(&self, object: usize, waiting: &[usize]) -> Self {
        let mut waits_for = self.waits_for.clone();
        for (other, others) in waits_for.iter_mut().enumerate() {
            others.retain(|&waited_for| waited_for != object);
            if waiting.contains(&other) {
                others.push(object);
            }
        }
        Self { waits_for }
    }

    /// Objects to set aside, sorted, so that no object is on a cycle: a small set, not always the smallest, which is NP-hard to
    /// find. Of the objects that are on cycles the one for which most of them wait is taken, of equals the first, until no cycle is left.
    pub(crate) fn to_set_aside(&self) -> Vec<usize> {
        let mut is_left = vec![true; self.waits_for.len()];
        let mut aside = Vec::new();
        loop {
            self.leave_out_free(&mut is_left);
            let mut waiting = vec![0; is_left.len()];
            let left = (0..is_left.len()).filter(|&object| is_left[object]);
            for &other in left.flat_map(|object| &self.waits_for[object]) {
                waiting[other] += u32::from(is_left[other]);
            }
            let more = |most: usize, object: usize| if waiting[object] > waiting[most] { object } else { most };
            let Some(most) = (0..waiting.len()).reduce(more).filter(|&most| waiting[most] > 0) else { break };
            is_left[most] = false;
            aside.push(most);
        }
        aside.sort_unstable();
        aside
    }

    /// Takes out what is in no cycle: what waits for nothing that is left, and what nothing that is left waits for.
    fn leave_out_free(&self, is_left: &mut [bool]) {
        let mut has_changed = true;
        while std::mem::take(&mut has_changed) {
            let mut is_wanted = vec![false; is_left.len()];
            for object in 0..is_left.len() {
                let waits = self.waits_for[object].iter().any(|&other| is_left[other]);
                if is_left[object] && !waits {
                    is_left[object] = false;
                    has_changed = true;
                } else if is_left[object] {
                    self.waits_for[object].iter().for_each(|&other| is_wanted[other] = true);
                }
            }
            for (left, wanted) in is_left.iter_mut().zip(is_wanted) {
                has_changed |= *left && !wanted;
                *left &= wanted;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn aside(waits_for: &[&[usize]]) -> Vec<usize> {
        Dependencies::new(waits_for.iter().map(|others| others.to_vec()).collect()).to_set_aside()
    }

    #[test]
    fn one_object_of_each_cycle_is_set_aside() {
        // A chain; two cycles; two cycles that share an object, with a chain behind them.
        assert_eq!(aside(&[&[1], &[2], &[]]), [0usize; 0]);
        assert_eq!(aside(&[&[1], &[0], &[3], &[4], &[2]]), [0, 2]);
        assert_eq!(aside(&[&[1], &[2], &[0, 3], &[2], &[0]]), [2]);
        // Each waits for all others: all but one.
        assert_eq!(aside(&[&[1, 2, 3], &[0, 2, 3], &[0, 1, 3], &[0, 1, 2]]).len(), 3);
    }

    #[test]
    fn without_what_is_set_aside_all_others_can_go() {
        for seed in 0..200_usize {
            let count = 3 + seed % 20;
            let waits_for: Vec<Vec<usize>> = (0..count)
                .map(|a| {
                    (0..count)
                        .filter(|&b| a != b && (a * 31 + b * 17 + seed * 7919) * 2_654_435_761 % 97 < 14)
                        .collect()
                })
                .collect();
            let aside = Dependencies::new(waits_for.clone()).to_set_aside();
            let mut gone = vec![false; count];
            aside.iter().for_each(|&object| gone[object] = true);
            for _ in 0..count {
                for object in 0..count {
                    gone[object] |= waits_for[object].iter().all(|&other| gone[other]);
                }
            }
            assert!(!gone.contains(&false), "{waits_for:?} without {aside:?}");
        }
    }
}
