//! A search scheduler of your own, composed set by set: trees that look close first, and farther away where that fails.
//!
//! Each of the nine sets of a step gets its systems here, as ordinary systems of bevy. Most of them are Foliate's. `shrink_towards`
//! is new; `Reach` is a component of its own on the entity of each transition.
//! Take out what you do not want, and put in what you do: the sets and the fields of `Candidate` are the contract
//! (docs/own-scheduler.md).
//!
//! Run with `cargo run --release --example own_scheduler`.

use bevy_ecs::prelude::*;
use foliate::components::candidate::{Candidate, CandidateArena};
use foliate::components::graph::TransitionId;
use foliate::components::outcome::TransitionStatistics;
use foliate::components::samples::swap_two_boxes;
use foliate::planner::outcome_name;
use foliate::schedulers::Scheduler;
use foliate::systems::exploration::entities::Weight;
use foliate::systems::exploration::roadmap_query::RoadmapQuery;
use foliate::systems::goals::systems::draw_more_goals;
use foliate::systems::heuristic::systems::{choose_leaves, measure_leaves};
use foliate::systems::planning_model::PlanningModel;
use foliate::systems::schedule::{SearchSet, empty_schedule};
use foliate::systems::step::commit::{commit_connections, commit_extensions};
use foliate::systems::step::conclusion::{conclude, report_feedback, report_progress, report_solution};
use foliate::systems::step::connection::connect::{certify_connections, propose_connections};
use foliate::systems::step::projection::project::project_waypoints;
use foliate::systems::step::rendezvous::draw_leaves;
use foliate::systems::step::sampling::{reset_candidates, sample_configurations};
use foliate::systems::step::selection::{gather_weights, select_nodes, select_transitions};
use foliate::systems::step::steering::steer_legs;
use foliate::systems::step::validation::certify_legs;
use foliate::systems::step::waypoints::check_waypoints;
use foliate::{Planner, Report};

/// Trees that first look close to what they have, and farther away where that fails.
pub struct Cautious;

/// How far from its node a transition looks, as a share of the way to a random configuration. On the transition's entity.
#[derive(Component)]
struct Reach(f64);

/// By transition, gathered for the candidates.
#[derive(Default, Resource)]
struct Reaches(Vec<f64>);

impl Scheduler for Cautious {
    fn name(&self) -> &'static str {
        "cautious"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        world.init_resource::<Reaches>();
        let mut schedule = empty_schedule();
        schedule.add_systems((
            (reset_candidates, sample_configurations).chain().in_set(SearchSet::Sample),
            (gather_weights, measure_leaves, choose_leaves, select_nodes, select_transitions)
                .chain()
                .in_set(SearchSet::Select),
            (draw_leaves, add_reaches, adapt_reaches, shrink_towards).chain().in_set(SearchSet::Rendezvous),
            project_waypoints.in_set(SearchSet::Project),
            (check_waypoints, steer_legs).chain().in_set(SearchSet::Steer),
            certify_legs.in_set(SearchSet::Validate),
            (commit_extensions, draw_more_goals).chain().in_set(SearchSet::Commit),
            (propose_connections, certify_connections, commit_connections).chain().in_set(SearchSet::Connect),
            (conclude, report_progress, report_feedback, report_solution).chain().in_set(SearchSet::Conclude),
        ));
        schedule
    }
}

/// A lazy graph grows: transitions that are new have no reach yet.
fn add_reaches(new: Query<'_, '_, Entity, (With<Weight>, Without<Reach>)>, mut commands: Commands<'_, '_>) {
    new.iter().for_each(|transition| {
        commands.entity(transition).insert(Reach(0.3));
    });
}

/// A transition whose projections fail looks farther away, one whose projections succeed stays close.
fn adapt_reaches(
    model: Res<'_, PlanningModel>,
    mut transitions: Query<'_, '_, (&TransitionId, &TransitionStatistics, &mut Reach)>,
    mut reaches: ResMut<'_, Reaches>,
) {
    reaches.0.resize(model.graph.transitions.len(), 1.0);
    for (id, statistics, mut reach) in &mut transitions {
        let failed = 1.0 - statistics.success_rate(foliate::components::outcome::Prior::default());
        reach.0 = 0.2 + 0.8 * failed;
        reaches.0[id.at()] = reach.0;
    }
}

/// Moves each random configuration towards the node that is extended.
fn shrink_towards(
    model: Res<'_, PlanningModel>,
    roadmap: RoadmapQuery<'_, '_>,
    reaches: Res<'_, Reaches>,
    mut arena: ResMut<'_, CandidateArena>,
    candidates: Query<'_, '_, &Candidate>,
) {
    let roadmap = roadmap.view();
    let size = arena.configuration_size();
    for candidate in candidates.iter().filter(|candidate| candidate.is_alive()) {
        let (Some(near), Some(transition)) = (candidate.near, candidate.transition) else { continue };
        let q = &mut arena.random[candidate.index as usize * size..][..size];
        let far = q.to_vec();
        let space = &model.problem.robot.space;
        space.interpolate(roadmap.configuration(near), &far, reaches.0[transition.at()], q);
        model.lock(q);
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for seed in 1..=5 {
        let answer = Planner::new(swap_two_boxes()?)?.scheduler(Cautious).seed(seed).solve();
        let report = Report::of(&answer);
        println!(
            "seed {seed}: {} after {} candidates, {} nodes",
            outcome_name(&answer),
            report.candidates,
            report.nodes
        );
    }
    Ok(())
}
