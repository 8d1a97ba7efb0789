//! Promise: whose waypoints are judged together changes nothing. Every candidate is refused for the leg for which it would be refused
//! alone, or not at all, with margins and without, on any number of threads.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use bevy_ecs::prelude::*;
use common::{model, search, seeded};
use foliate_components::Pose;
use foliate_components::candidate::{Candidate, CandidateArena};
use foliate_components::graph::TransitionKind;
use foliate_components::outcome::Rejection;
use foliate_components::problem::{Margin, Problem};
use foliate_components::robot::{LinkIndex, PartKind, ShapeIndex};
use foliate_components::samples::{swap_two_boxes, swap_with_crossed_foliations};
use foliate_kernels::collision::CollisionScratch;
use foliate_schedulers::{Scheduler, mrrt::Mrrt};
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::schedule::SearchSet;
use foliate_systems::settings::SearchSettings;
use foliate_systems::step::{steering, waypoints};
use std::sync::{Arc, Mutex};

/// What has to come of each candidate that is under way.
#[derive(Default, Resource)]
struct Alone(Vec<(u32, Option<Rejection>)>);

/// What came of the candidates that have waypoints: by step.
type Blocked = Vec<Option<(Rejection, (ShapeIndex, ShapeIndex))>>;

#[derive(Clone, Default, Resource)]
struct Seen(Arc<Mutex<Blocked>>);

fn ask_alone(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    arena: Res<'_, CandidateArena>,
    candidates: Query<'_, '_, &Candidate>,
    mut alone: ResMut<'_, Alone>,
) {
    let size = arena.configuration_size();
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    let mut scratch = CollisionScratch::new();
    alone.0.clear();
    for candidate in candidates.iter().filter(|c| c.is_alive()) {
        let transition = candidate.transition.unwrap();
        if model.graph.transition(transition).kind == TransitionKind::Loop {
            continue;
        }
        let blocked = arena.legs[candidate.index as usize].iter().find(|leg| {
            model.kinematics.forward(&leg.knots[leg.knots.len() - size..], &mut X_WJ);
            model.first_collision_along(transition, &X_WJ, settings.clearance_guard, &mut scratch).is_some()
        });
        alone.0.push((candidate.index, blocked.map(|leg| Rejection::WaypointBlocked(leg.leg as u8))));
    }
}

fn compare(
    alone: Res<'_, Alone>,
    arena: Res<'_, CandidateArena>,
    seen: Res<'_, Seen>,
    candidates: Query<'_, '_, &Candidate>,
) {
    for (index, expected) in &alone.0 {
        let candidate = candidates.iter().find(|c| c.index == *index).unwrap();
        assert_eq!(candidate.rejected, *expected, "candidate {index}");
        assert_eq!(candidate.waypoints_are_free, expected.is_none());
        assert_eq!(arena.legs[*index as usize].is_empty(), expected.is_some());
        assert_eq!(candidate.blocked_by.is_some(), expected.is_some());
        seen.0.lock().unwrap().push(expected.map(|reason| (reason, candidate.blocked_by.unwrap())));
    }
}

/// `mrrt`, watched.
struct Watched(Seen);

impl Scheduler for Watched {
    fn name(&self) -> &'static str {
        "watched"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        world.init_resource::<Alone>();
        world.insert_resource(self.0.clone());
        let mut schedule = Mrrt.schedule(world);
        schedule.add_systems((
            ask_alone.in_set(SearchSet::Steer).before(waypoints::check_waypoints),
            compare.in_set(SearchSet::Steer).after(waypoints::check_waypoints).before(steering::steer_legs),
        ));
        schedule
    }
}

fn watch(model: &PlanningModel, threads: usize, candidates: usize) -> Blocked {
    let seen = Seen::default();
    // Some are solved within a few steps.
    for seed in 1..=4 {
        let settings = seeded(seed).with(|s| (s.candidates, s.max_steps) = (candidates, 20));
        search(model, &Watched(seen.clone()), settings, threads);
    }
    let blocked = seen.0.lock().unwrap();
    blocked.clone()
}

fn with_margins() -> Problem {
    let mut problem = swap_with_crossed_foliations().unwrap();
    let robot = &problem.robot;
    let arm = robot.parts.iter().find(|part| part.kind == PartKind::Robot).unwrap();
    for object in &problem.graph.objects {
        let second = robot.parts[object.part.0 as usize].root_link;
        let keep = |first: usize| Margin { first: LinkIndex(first as u32), second, distance: 0.03 };
        problem.margins.extend(arm.links.clone().map(keep));
    }
    problem
}

#[test]
fn as_if_each_were_asked_alone() {
    for problem in [swap_two_boxes().unwrap(), with_margins()] {
        let model = model(problem);
        for candidates in [1, 16, 40] {
            let one = watch(&model, 1, candidates);
            let blocked = one.iter().flatten().count();
            println!("{blocked} of {} candidates are refused", one.len());
            if candidates == 16 {
                assert!(blocked > 10 && blocked + 10 < one.len(), "{blocked} of {}", one.len());
            }
            // Also what is named as in the way.
            assert_eq!(one, watch(&model, 3, candidates));
        }
    }
}
