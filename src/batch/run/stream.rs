//! Plans for many problems, one answer after the other.

use crate::batch::run::pool::Pool;
use crate::planner::answer::{NoSolution, Solution};
use crate::planner::solving::Planner;
use foliate_systems::events::CancelToken;
use std::collections::VecDeque;
use std::io;

/// Planners that are taken ahead of the answers, per thread. One that takes long holds the others up only once they are so far ahead.
const AHEAD: usize = 32;

/// The answers to many problems, in their order.
///
/// Dropped before the end, it cancels the searches that are under way.
#[derive(Debug)]
pub struct PlanBatch<I> {
    planners: I,
    pool: Pool<Result<Solution, NoSolution>>,
    /// Of the planners whose answers have not been given.
    tokens: VecDeque<CancelToken>,
}

/// Plans for each problem, so many side by side, each on one thread, and gives the answers in the order of the problems. Planners are taken
/// as they are needed, at most 32 for each thread ahead of the answers: any number of them takes the same memory. Answers do not depend
/// on `threads`.
///
/// ```
/// use foliate::batch::plan_batch;
/// use foliate::prelude::*;
/// # let problem = foliate::components::samples::move_one_box()?;
/// let planner = |seed| Ok::<_, Error>(Planner::new(problem.clone())?.seed(seed).first_path());
/// let planners = (1..=3).map(planner).collect::<Result<Vec<_>, _>>()?;
/// let answers = plan_batch(planners, 2)?;
/// assert_eq!(answers.filter(Result::is_ok).count(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The operating system refuses the threads.
pub fn plan_batch<I>(planners: I, threads: usize) -> io::Result<PlanBatch<I::IntoIter>>
where
    I: IntoIterator<Item = Planner>,
{
    Ok(PlanBatch { planners: planners.into_iter(), pool: Pool::new(threads)?, tokens: VecDeque::new() })
}

impl<I: Iterator<Item = Planner>> Iterator for PlanBatch<I> {
    type Item = Result<Solution, NoSolution>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.pool.len() < AHEAD * self.pool.threads() {
            let Some(planner) = self.planners.next() else { break };
            self.tokens.push_back(planner.cancel_token());
            self.pool.add(move || planner.solve());
        }
        let answer = self.pool.take();
        self.tokens.pop_front();
        answer
    }
}

impl<I> Drop for PlanBatch<I> {
    fn drop(&mut self) {
        self.tokens.iter().for_each(CancelToken::cancel);
    }
}
