//! Plans a stretch of a path again: another search from where it begins to where it ends finds fewer grasps, other leaves or
//! another branch of inverse kinematics. Its path is shortened before it is compared.

use crate::events::{EventSink, StopSignal};
use crate::improvement::changes::changed::Changed;
use crate::improvement::changes::context::{Context, ImprovementScratch};
use crate::improvement::changes::local_change::LocalChange;
use crate::improvement::cost::path_cost;
use crate::improvement::leaf_motion::LeafMotion;
use crate::planning_model::model::PlanningModel;
use crate::planning_model::state_classification::Feasible;
use crate::search::Search;
use crate::search::scheduler::Scheduler;
use foliate_components::outcome::SearchOutcome;
use rand::{Rng, RngExt};
use std::ops::Range;

/// What is searched for, and how.
pub(crate) struct Replanning<'a> {
    pub scheduler: &'a dyn Scheduler,
    pub stop: &'a StopSignal,
    pub seed: u64,
    pub max_steps: u64,
}

/// What a search has found.
pub(crate) struct Replanned {
    /// Motions in place of those of the stretch; none where the search found none.
    pub motions: Option<Vec<LeafMotion>>,
    /// The model of the search: where the graph is lazy it has states and transitions that the other one lacks.
    pub model: PlanningModel,
    /// Candidates of the search, and shortcuts that were tried.
    pub work: u64,
}

/// Changes that are tried per motion of a new path in one round.
const CHANGES: usize = 12;

/// Rounds of a new path that comes close to the one that it is to replace.
const ROUNDS: usize = 4;

/// How much more it may cost to come close.
const CLOSE: f64 = 1.3;

/// Plans the motions of a range again.
pub(crate) fn replan(
    context: &Context<'_>,
    motions: &[LeafMotion],
    range: Range<usize>,
    how: &Replanning<'_>,
    rng: &mut impl Rng,
    scratch: &mut ImprovementScratch,
) -> Replanned {
    let ends = [range.start, range.end - 1].map(|end| context.model.graph.state(motions[end].state));
    if range.len() < motions.len() && ends.iter().any(|state| state.is_passed_through()) {
        return Replanned { motions: None, model: context.model.clone(), work: 0 };
    }
    let mut settings = context.settings.clone();
    settings.seed = how.seed;
    settings.max_steps = how.max_steps;
    let is_whole = range.len() == motions.len();
    let mut search = if is_whole {
        // The goals are the problem's, so that one that leaves something free may be reached elsewhere.
        Search::new(context.model, how.scheduler, settings, how.stop.clone(), EventSink::default())
    } else {
        let size = context.size();
        let root = |motion: &LeafMotion, q: &[f64]| Feasible {
            q: q.to_vec(),
            state: motion.state,
            parameters: motion.parameters.clone(),
            given: None,
        };
        let (first, last) = (&motions[range.start], &motions[range.end - 1]);
        let ends = (root(first, first.start(size)), vec![root(last, last.end(size))]);
        Search::between(context.model, how.scheduler, settings, how.stop.clone(), ends)
    };
    search = search.without_planning_again();
    let outcome = search.run();
    let mut replanned = Replanned { motions: None, model: search.model().clone(), work: search.counter().work() };
    if outcome != SearchOutcome::Solved {
        return replanned;
    }
    let Some(path) = search.path() else { return replanned };
    let Some(mut found) = LeafMotion::of_path(&replanned.model, &path) else { return replanned };
    if !is_whole {
        stay_on_leaves_of_ends(context.size(), &motions[range.clone()], &mut found);
    }
    let context = Context { model: &replanned.model, ..*context };
    let stretch = path_cost(context.cost, context.model, &motions[range.clone()]);
    replanned.work += polish(&context, &mut found, (stretch, how.stop), rng, scratch);
    found[0].starts_at_waypoint = motions[range.start].starts_at_waypoint;
    replanned.motions = Some(found);
    replanned
}

/// Makes a new path shorter, so that it can be compared with one that has been made shorter for long: a round of changes, and further
/// ones while it comes close to `cost`. Returns how many changes were tried.
fn polish(
    context: &Context<'_>,
    motions: &mut Vec<LeafMotion>,
    (cost, stop): (f64, &StopSignal),
    rng: &mut impl Rng,
    scratch: &mut ImprovementScratch,
) -> u64 {
    let mut work = 0;
    let mut own = path_cost(context.cost, context.model, motions);
    for round in 0..ROUNDS {
        if stop.is_raised() || (round > 0 && (own > CLOSE * cost || own < cost)) {
            break;
        }
        for _ in 0..CHANGES * motions.len() {
            let change = match rng.random_range(0..3) {
                0 => LocalChange::Shortcut(rng.random_range(0..motions.len())),
                1 => LocalChange::LimbShortcut,
                _ => LocalChange::WaypointMove,
            };
            work += change.work(motions);
            let change = change.attempt(context, (motions, own), rng, scratch);
            let Some(Changed { range, motions: changed }) = change else { continue };
            let mut better = motions.clone();
            better.splice(range, changed);
            context.unwrap_angles(&mut better);
            let cost = path_cost(context.cost, context.model, &better);
            if cost < own {
                (*motions, own) = (better, cost);
            }
        }
    }
    work
}

/// A path may leave the leaf of its first configuration at once, or reach that of its last one on arrival. The stretch keeps both, by
/// motions that stand still: before it and behind it the path expects them.
fn stay_on_leaves_of_ends(size: usize, old: &[LeafMotion], found: &mut Vec<LeafMotion>) {
    let ends = (old.first().zip(found.first()), old.last().zip(found.last()));
    let start =
        ends.0.filter(|(old, new)| !old.is_on_leaf_of(new)).map(|(old, new)| old.standing_still(new.start(size)));
    let end = ends.1.filter(|(old, new)| !old.is_on_leaf_of(new)).map(|(old, new)| old.standing_still(new.end(size)));
    found.splice(0..0, start);
    found.extend(end);
}
