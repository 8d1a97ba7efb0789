//! The systems of a round: proposals are drawn, evaluated and committed, and the budget is looked at.

use crate::events::StopSignal;
use crate::improvement::changes::context::{Context, ImprovementScratch};
use crate::improvement::changes::leaf_move;
use crate::improvement::changes::limbs::Limbs;
use crate::improvement::changes::local_change::LocalChange;
use crate::improvement::changes::replan::{Replanning, replan};
use crate::improvement::changes::shortcut::LEAST_GAIN;
use crate::improvement::cost::{PathCost, path_cost};
use crate::improvement::leaf_motion::{LeafMotion, grasp_changes, merged};
use crate::improvement::progress::{ImprovementEnding, Milestone, Progress};
use crate::improvement::proposal::{Attempt, Change, Incumbent, Proposal};
use crate::improvement::settings::ImprovementSettings;
use crate::planning_model::model::{Model, PlanningModel};
use crate::runtime::parallel::each;
use crate::runtime::random::{Purpose, stream};
use crate::runtime::scratch_pool::ScratchPool;
use crate::search::scheduler::Scheduler;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Local, Query, Res, ResMut, Resource};
use rand::{Rng, RngExt};
use std::cmp::Reverse;
use std::ops::Range;
use std::sync::Arc;

/// What is minimised.
#[derive(Clone, Debug, Resource)]
pub struct Cost(pub Arc<dyn PathCost>);

/// The scheduler of the searches that plan stretches again.
#[derive(Clone, Resource)]
pub struct Replanner(pub Arc<dyn Scheduler>);

/// Draws the proposals of a round.
pub fn propose(
    model: Res<'_, PlanningModel>,
    search: Res<'_, SearchSettings>,
    settings: Res<'_, ImprovementSettings>,
    incumbent: Res<'_, Incumbent>,
    progress: Res<'_, Progress>,
    mut proposals: Query<'_, '_, &mut Proposal>,
) {
    let mut planned_work = 0;
    for mut proposal in &mut proposals {
        let mut rng = stream(search.seed, Purpose::IMPROVE, progress.rounds, 2 * proposal.number);
        proposal.change = None;
        proposal.work = 0;
        proposal.is_solved = false;
        let share = settings.replanning_share * (progress.work as f64 + 1.0);
        let is_due = ((progress.replanning + planned_work) as f64) < share;
        let stretch = is_due.then(|| draw_stretch(&model, &incumbent.motions, &mut rng)).flatten();
        proposal.attempt = Some(match stretch {
            Some(range) => {
                let max_steps = progress.replanning_steps.max(1);
                planned_work += max_steps * search.candidates as u64;
                Attempt::Replan { range, max_steps }
            }
            None => Attempt::Local(draw_change(&settings, (&model, &incumbent.motions), &mut rng)),
        });
    }
}

/// A change that needs no search.
fn draw_change(
    settings: &ImprovementSettings,
    (model, motions): (&Model, &[LeafMotion]),
    rng: &mut impl Rng,
) -> LocalChange {
    let mut drawn: f64 = rng.random_range(0.0..1.0);
    let mut is = |probability: f64| {
        drawn -= probability;
        drawn < 0.0
    };
    if is(settings.limb_probability) {
        LocalChange::LimbShortcut
    } else if is(settings.waypoint_probability) {
        LocalChange::WaypointMove
    } else if is(settings.leaf_probability) && leaf_move::is_possible(model, motions) {
        LocalChange::LeafMove
    } else {
        LocalChange::Shortcut(draw_motion(motions, rng))
    }
}

/// A stretch with grasp changes inside: the whole path; a loop, which begins and ends on one leaf; or what lies between any two
/// places where the leaf changes. Of a path without grasp changes the whole.
fn draw_stretch(model: &PlanningModel, motions: &[LeafMotion], rng: &mut impl Rng) -> Option<Range<usize>> {
    let changes = |range: Range<usize>| {
        motions[range].windows(2).map(|pair| grasp_changes(model, &pair[0], &pair[1])).sum::<usize>()
    };
    let whole = 0..motions.len();
    if changes(whole.clone()) == 0 {
        return Some(whole);
    }
    let ends: Vec<usize> =
        (0..=motions.len()).filter(|&i| motions.get(i).is_none_or(|motion| !motion.starts_at_waypoint)).collect();
    match rng.random_range(0..3) {
        0 => Some(whole),
        1 => {
            let is_loop = |&(a, b): &(usize, usize)| motions[a].is_on_leaf_of(&motions[b - 1]) && changes(a..b) > 0;
            let pairs = ends.iter().flat_map(|&a| ends.iter().map(move |&b| (a, b))).filter(|(a, b)| a < b);
            let loops: Vec<_> = pairs.filter(is_loop).collect();
            let (a, b) = *loops.get(rng.random_range(0..loops.len().max(1)))?;
            Some(a..b)
        }
        _ => {
            let [a, b] = [(); 2].map(|()| ends[rng.random_range(0..ends.len())]);
            let range = a.min(b)..a.max(b);
            (range.len() > 1 && changes(range.clone()) > 0).then_some(range)
        }
    }
}

/// A motion, by its number of knots.
fn draw_motion(motions: &[LeafMotion], rng: &mut impl Rng) -> usize {
    let corners = |motion: &LeafMotion| if motion.is_implicit { 8 } else { motion.knots.len() };
    let all: usize = motions.iter().map(corners).sum();
    let mut left = rng.random_range(0..all.max(1));
    motions
        .iter()
        .position(|motion| {
            let here = left < corners(motion);
            left = left.saturating_sub(corners(motion));
            here
        })
        .unwrap_or(0)
}

/// Evaluates all proposals of a round in parallel: each by itself against the same path.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn evaluate(
    model: Res<'_, PlanningModel>,
    search: Res<'_, SearchSettings>,
    settings: Res<'_, ImprovementSettings>,
    stop: Res<'_, StopSignal>,
    cost: Res<'_, Cost>,
    limbs: Res<'_, Limbs>,
    scheduler: Res<'_, Replanner>,
    incumbent: Res<'_, Incumbent>,
    progress: Res<'_, Progress>,
    mut proposals: Query<'_, '_, &mut Proposal>,
    buffers: Local<'_, ScratchPool<ImprovementScratch>>,
) {
    let with_room = with_room(&search, &settings);
    let context =
        Context { model: &model, settings: &search, with_room: &with_room, cost: cost.0.as_ref(), limbs: &limbs };
    let buffers = &*buffers;
    let mut pool: Vec<_> = proposals.iter_mut().collect();
    each(
        &mut pool,
        || buffers.borrow(),
        |scratch, proposal| {
            if stop.is_raised() {
                return;
            }
            scratch.collision.set_level(search.level);
            let mut rng = stream(search.seed, Purpose::IMPROVE, progress.rounds, 2 * proposal.number + 1);
            let how = Replanning { scheduler: scheduler.0.as_ref(), stop: &stop, seed: rng.random(), max_steps: 0 };
            evaluate_one(&context, &incumbent, &how, proposal, &mut rng, scratch);
        },
    );
}

/// The settings of a search, with the clearance that shortcuts keep.
fn with_room(search: &SearchSettings, settings: &ImprovementSettings) -> SearchSettings {
    search.clone().with(|s| s.clearance_guard = s.clearance_guard.max(settings.shortcut_clearance))
}

fn evaluate_one(
    context: &Context<'_>,
    incumbent: &Incumbent,
    how: &Replanning<'_>,
    proposal: &mut Proposal,
    rng: &mut impl Rng,
    scratch: &mut ImprovementScratch,
) {
    let motions = &incumbent.motions;
    let Some(attempt) = proposal.attempt.clone() else { return };
    let (found, model) = match &attempt {
        Attempt::Local(change) => {
            proposal.work = change.work(motions);
            let changed = change.attempt(context, (motions, incumbent.cost), rng, scratch);
            (changed.map(|changed| (changed.range, changed.motions)), None)
        }
        Attempt::Replan { range, max_steps } => {
            let how = Replanning { max_steps: *max_steps, ..*how };
            let replanned = replan(context, motions, range.clone(), &how, rng, scratch);
            proposal.work = replanned.work;
            proposal.is_solved = replanned.motions.is_some();
            let model = context.model.graph.lazy.then_some(replanned.model);
            (replanned.motions.map(|motions| (range.clone(), motions)), model)
        }
    };
    let Some((range, changed)) = found else { return };
    let model_of_change = model.as_ref().unwrap_or(context.model);
    if !(Context { model: model_of_change, ..*context }).are_within_bounds(&changed) {
        return;
    }
    let mut whole = [&motions[..range.start], &changed, &motions[range.end..]].concat();
    context.unwrap_angles(&mut whole);
    let cost = path_cost(context.cost, model_of_change, &whole);
    // Compared so that NaN is no gain.
    if cost < incumbent.cost - LEAST_GAIN {
        proposal.change = Some(Change { attempt, range, motions: changed, cost, model });
    }
}

/// Commits the changes of a round, the best first, and then those that do not touch the same motions. A round that was stopped changes
/// nothing.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn commit(
    mut model: ResMut<'_, PlanningModel>,
    search: Res<'_, SearchSettings>,
    settings: Res<'_, ImprovementSettings>,
    stop: Res<'_, StopSignal>,
    cost: Res<'_, Cost>,
    limbs: Res<'_, Limbs>,
    mut incumbent: ResMut<'_, Incumbent>,
    mut progress: ResMut<'_, Progress>,
    mut proposals: Query<'_, '_, &mut Proposal>,
) {
    progress.rounds += 1;
    if stop.is_raised() {
        progress.ending = Some(ImprovementEnding::Stopped);
        return;
    }
    let mut proposals: Vec<_> = proposals.iter_mut().collect();
    progress.count(&proposals, settings.first_steps);
    proposals.retain(|proposal| proposal.change.is_some());
    let gain = |proposal: &Proposal| proposal.change.as_ref().map_or(f64::INFINITY, |change| change.cost);
    proposals.sort_by(|a, b| gain(a).total_cmp(&gain(b)).then(a.number.cmp(&b.number)));
    let mut accepted: Vec<Change> = Vec::new();
    for mut proposal in proposals {
        let Some(change) = proposal.change.take() else { continue };
        let is_apart = |other: &Change| change.range.end <= other.range.start || other.range.end <= change.range.start;
        // Two models that have grown apart cannot be joined.
        let grows = change.model.is_some();
        if accepted.iter().all(is_apart) && !(grows && accepted.iter().any(|other| other.model.is_some())) {
            accepted.push(change);
        }
    }
    if accepted.is_empty() {
        return;
    }
    let with_room = with_room(&search, &settings);
    let (best, others) = (accepted[0].cost, accepted.len() > 1);
    let grown = accepted.iter().find_map(|change| change.model.clone());
    if let Some(grown) = grown {
        *model = grown;
    }
    let context =
        Context { model: &model, settings: &search, with_room: &with_room, cost: cost.0.as_ref(), limbs: &limbs };
    let (mut motions, mut total) = with_changes(&context, &incumbent.motions, &accepted);
    // Where two changes meet on one stretch they may cost more together than one of them alone.
    if others && total > best {
        accepted.truncate(1);
        (motions, total) = with_changes(&context, &incumbent.motions, &accepted);
    }
    accepted.iter().for_each(|change| progress.changes.count(Some(&change.attempt)));
    (incumbent.motions, incumbent.cost) = (motions, total);
    let milestone = Milestone { work: progress.work, cost: incumbent.cost };
    progress.history.push(milestone);
}

/// The path with some changes that do not touch the same motions, and what it costs.
fn with_changes(context: &Context<'_>, motions: &[LeafMotion], changes: &[Change]) -> (Vec<LeafMotion>, f64) {
    let mut motions = motions.to_vec();
    let mut changes: Vec<&Change> = changes.iter().collect();
    changes.sort_by_key(|change| Reverse(change.range.start));
    for change in changes {
        motions.splice(change.range.clone(), change.motions.iter().cloned());
    }
    motions = merged(context.model, motions);
    context.unwrap_angles(&mut motions);
    let cost = path_cost(context.cost, context.model, &motions);
    (motions, cost)
}

/// Ends the improvement where its work is spent.
pub fn conclude(settings: Res<'_, ImprovementSettings>, mut progress: ResMut<'_, Progress>) {
    if progress.work >= settings.max_work {
        progress.ending.get_or_insert(ImprovementEnding::Work);
    }
}
