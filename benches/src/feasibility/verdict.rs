//! What a solve tells of a problem, and how soon.

use foliate::planner::outcome_name;
use foliate::{NoSolution, NoSolutionReason, ObjectTries, Planner};
use foliate_components::infeasibility::{GoalFailureKind, Infeasibility, ObjectPlace};
use foliate_components::problem::Problem;
use foliate_systems::events::StopSignal;
use foliate_systems::goals::impossible::common_grasp::no_common_grasp;
use foliate_systems::goals::impossible::survey::why_not_held;
use foliate_systems::goals::objects_to_move;
use foliate_systems::settings::SearchSettings;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// What was told of a problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// There is a certified path, and nothing was said against it.
    Solved,
    /// It was proved that there is none.
    Proved(String),
    /// There is likely none.
    Likely(String),
    /// Goals were given up after a stated number of tries, which is no proof.
    GivenUp(String),
    /// Nothing; how the search ended.
    Nothing(&'static str),
}

impl Verdict {
    /// Whether it says that there is no path, proved or not.
    #[must_use]
    pub fn is_against(&self) -> bool {
        matches!(self, Self::Proved(_) | Self::Likely(_) | Self::GivenUp(_))
    }
}

/// A verdict, and the wall time from the problem to it.
#[derive(Clone, Debug)]
pub struct Told {
    /// What was told.
    pub verdict: Verdict,
    /// How soon.
    pub after: Duration,
}

/// Solves a problem, at most so long, on the threads of the pool in which it is called. A search that says that there is likely no
/// path is not run on.
///
/// # Panics
/// If a planner cannot be made of the problem: a bug of the generator.
#[must_use]
pub fn told(problem: Problem, seed: u64, limit: Duration) -> Told {
    let started = Instant::now();
    let planner = Planner::new(problem).expect("a generated problem has a planner");
    let likely = Arc::new(Mutex::new(None));
    let (first, token) = (likely.clone(), planner.cancel_token());
    let settings = SearchSettings::default().with(|settings| settings.seed = seed);
    let planner = planner.settings(settings).first_path().time_limit(limit).on_likely_impossible(move |rows| {
        let reasons: Vec<String> = rows.iter().flat_map(ObjectTries::reasons).collect();
        first.lock().expect("no callback panics").get_or_insert((reasons.join("; "), started.elapsed()));
        token.cancel();
    });
    let answer = planner.solve();
    let likely = likely.lock().expect("no callback panics").take();
    if let Some((why, after)) = likely {
        return Told { verdict: Verdict::Likely(why), after };
    }
    let verdict = match &answer {
        Ok(_) => Verdict::Solved,
        Err(NoSolution { reason: NoSolutionReason::InfeasibleGoal(why), .. }) if is_proved(why) => {
            Verdict::Proved(why.to_string())
        }
        Err(NoSolution { reason: NoSolutionReason::InfeasibleGoal(why), .. }) => Verdict::GivenUp(why.to_string()),
        Err(_) => Verdict::Nothing(outcome_name(&answer)),
    };
    Told { verdict, after: started.elapsed() }
}

fn is_proved(why: &Infeasibility) -> bool {
    match why {
        Infeasibility::GoalsNotFound(failures) => {
            failures.iter().all(|failure| !matches!(failure.kind, GoalFailureKind::NotFound { .. }))
        }
        _ => true,
    }
}

/// All that a search might say against a problem while it runs, asked whether or not it would be: of every object that has to be moved.
///
/// # Panics
/// If a planner cannot be made of the problem: a bug of the generator.
#[must_use]
pub fn doubts(problem: Problem, seed: u64) -> Vec<String> {
    let planner = Planner::new(problem).expect("a generated problem has a planner");
    let settings = SearchSettings::default().with(|settings| settings.seed = seed);
    let (model, start, with) = (planner.model(), &planner.model().problem.start, (&settings, &StopSignal::default()));
    let mut doubts = Vec::new();
    for object in objects_to_move(model, start) {
        for place in [ObjectPlace::Start, ObjectPlace::Goal] {
            let hindrance = why_not_held(model, with, start, object, place);
            doubts.extend(hindrance.map(|hindrance| hindrance.sentence(&format!("object {object}"), place.words())));
        }
        doubts.extend(no_common_grasp(model, with, start, object).map(|why| why.to_string()));
    }
    doubts
}
