//! The system that draws goals during a search, and how a start or a goal becomes the root of a tree.
//!
//! It writes the roadmap, which the sampling in `region` and `sampler` does not know.

use crate::events::StopSignal;
use crate::exploration::roadmap_query::roadmap_in;
use crate::exploration::roots::{GivenRoots, Roots};
use crate::exploration::writer;
use crate::goals::sampler::{GoalSampler, LATER_TRIES};
use crate::planning_model::model::PlanningModel;
use crate::planning_model::state_classification::Feasible;
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Mut, World};
use foliate_components::graph::leaf::{Leaf, LeafIndex};
use foliate_components::roadmap::NodeId;

/// Makes a start or a goal the root of a tree.
pub(crate) fn add_feasible_root(world: &mut World, root: Feasible) -> NodeId {
    writer::spawn_graph(world);
    let tolerance = world.resource::<SearchSettings>().projection_tolerance;
    let mut index = world.resource_mut::<LeafIndex>();
    let parameters = root.parameters.into_iter().map(|p| index.intern_parameter(p, tolerance)).collect();
    let node = writer::add_root(world, &root.q, Leaf { state: root.state, parameters });
    if let Some(given) = root.given {
        world.resource_mut::<GivenRoots>().0.push((node, given));
    }
    node
}

/// Set Commit, after the extensions: draws more configurations of goals that leave something free. Every step while there
/// is none yet; else after [`SearchSettings::goal_interval`] steps, and each time after twice as many.
pub fn draw_more_goals(world: &mut World) {
    world.resource_scope(|world, mut sampler: Mut<'_, GoalSampler>| {
        let step = world.resource::<StepCounter>().step;
        let goals = world.resource::<Roots>().goals.len();
        let settings = world.resource::<SearchSettings>().clone();
        if sampler.regions.is_empty() || !sampler.is_due(&settings, step, goals) {
            return;
        }
        let found = world.resource_scope(|world, mut model: Mut<'_, PlanningModel>| {
            sampler.draw(&mut model, &settings, world.resource::<StopSignal>(), LATER_TRIES)
        });
        writer::spawn_graph(world);
        for goal in found {
            add_goal_root(world, goal);
        }
    });
}

fn add_goal_root(world: &mut World, goal: Feasible) {
    let (roadmap, roots) = (roadmap_in(world), world.resource::<Roots>());
    if roots.goals.iter().any(|&root| roadmap.configuration(root) == goal.q) {
        return;
    }
    let root = add_feasible_root(world, goal);
    world.resource_mut::<Roots>().goals.push(root);
}
