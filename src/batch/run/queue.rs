//! Which solve of a batch comes next: of what is expected to take longest. A batch then ends with short solves, and no thread waits long for
//! the last one. The order changes no row.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Solves that wait, in groups: the same problem, scheduler and settings.
#[derive(Debug)]
pub(crate) struct Queue {
    groups: Vec<Group>,
}

/// Solves that are expected to take as long as each other.
#[derive(Debug)]
struct Group {
    waiting: VecDeque<usize>,
    /// Size of a configuration: what is expected as long as no row is known.
    size: usize,
    /// Time of the rows that are known, and how many.
    known: (Duration, u32),
    /// Beginnings of the solves that are under way.
    under_way: Vec<Instant>,
}

impl Group {
    fn mean(&self) -> Option<Duration> {
        self.known.0.checked_div(self.known.1)
    }

    /// What a solve takes: the mean of the known rows, or what the one under way has taken by now; and the size where nothing is known.
    fn expected(&self) -> Expected {
        let longest = self.under_way.iter().map(Instant::elapsed).max();
        match self.mean().or(longest) {
            Some(time) => Expected::Time(time),
            None => Expected::Unknown(self.size),
        }
    }
}

/// In the order in which solves are taken: what is unknown is tried first, so that it is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Expected {
    Time(Duration),
    Unknown(usize),
}

impl Queue {
    /// Groups by the size of their configurations.
    pub(crate) fn new(sizes: impl IntoIterator<Item = usize>) -> Self {
        let group = |size| Group { waiting: VecDeque::new(), size, known: (Duration::ZERO, 0), under_way: Vec::new() };
        Self { groups: sizes.into_iter().map(group).collect() }
    }

    /// Adds a solve behind those of its group.
    pub(crate) fn push(&mut self, group: usize, solve: usize) {
        self.groups[group].waiting.push_back(solve);
    }

    /// Says how long a solve of a group took, in an earlier run say.
    pub(crate) fn know(&mut self, group: usize, time: Duration) {
        let known = &mut self.groups[group].known;
        *known = (known.0 + time, known.1 + 1);
    }

    /// The next solve, with its group and the time of its beginning.
    pub(crate) fn take(&mut self) -> Option<(usize, usize, Instant)> {
        let waiting = self.groups.iter().enumerate().filter(|(_, group)| !group.waiting.is_empty());
        // Of equals the first: `max_by_key` takes the last.
        let (number, _) = waiting.rev().max_by_key(|(_, group)| group.expected())?;
        let group = &mut self.groups[number];
        let solve = group.waiting.pop_front()?;
        let now = Instant::now();
        group.under_way.push(now);
        Some((number, solve, now))
    }

    /// Says that a solve that was taken has ended.
    pub(crate) fn ended(&mut self, group: usize, began: Instant, time: Duration) {
        let under_way = &mut self.groups[group].under_way;
        if let Some(at) = under_way.iter().position(|&other| other == began) {
            under_way.swap_remove(at);
        }
        self.know(group, time);
    }

    /// How long all that waits and is under way takes on one thread; `None` while nothing is known of some of it.
    pub(crate) fn left(&self) -> Option<Duration> {
        let busy = self.groups.iter().filter(|group| !group.waiting.is_empty() || !group.under_way.is_empty());
        busy.map(|group| {
            let mean = group.mean()?;
            let under_way = group.under_way.iter().map(|began| mean.saturating_sub(began.elapsed()));
            Some(mean.saturating_mul(group.waiting.len() as u32) + under_way.sum::<Duration>())
        })
        .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::Queue;
    use std::time::Duration;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn what_takes_longest_comes_first_and_what_is_unknown_before_it() {
        let mut queue = Queue::new([7, 14, 9]);
        for solve in 0..9 {
            queue.push(solve / 3, solve);
        }
        assert_eq!(queue.left(), None);
        // The largest of unknown ones; each once.
        let first: Vec<_> = (0..3).map(|_| queue.take().unwrap()).collect();
        assert_eq!(first.iter().map(|(_, solve, _)| *solve).collect::<Vec<_>>(), [3, 6, 0]);
        for ((group, _, began), time) in first.into_iter().zip([SECOND, 3 * SECOND, 2 * SECOND]) {
            queue.ended(group, began, time);
        }
        assert_eq!(queue.left(), Some(12 * SECOND));
        let order: Vec<usize> = std::iter::from_fn(|| queue.take()).map(|(_, solve, _)| solve).collect();
        assert_eq!(order, [7, 8, 1, 2, 4, 5]);
        assert!(queue.take().is_none());
    }

    #[test]
    fn rows_of_an_earlier_run_are_known() {
        let mut queue = Queue::new([7, 7]);
        queue.know(1, SECOND);
        queue.know(0, 5 * SECOND);
        queue.know(1, 3 * SECOND);
        queue.push(0, 0);
        queue.push(1, 1);
        queue.push(1, 2);
        assert_eq!(queue.left(), Some(9 * SECOND));
        assert_eq!(queue.take().unwrap().1, 0);
    }
}
