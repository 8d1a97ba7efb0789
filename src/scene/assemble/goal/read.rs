//! Goals in turn, and what `any` of a goal lists.

use crate::scene::assemble::goal::coordinates::{coordinates, moving_object};
use crate::scene::assemble::goal::demands;
use crate::scene::assemble::graph::written::several;
use crate::scene::assemble::names::configuration::Reader;
use crate::scene::reading::error::SceneError;
use crate::scene::reading::keys::{Item, Keys};
use foliate_components::Pose;
use foliate_components::problem::{Goal, GraphOptions, OtherHands, PartialGoal};
use foliate_components::robot::{PartIndex, Robot};

/// Most goals of a scene.
const GOALS: usize = 10_000;
/// What a goal has that names no whole configuration.
const REQUIREMENTS: &str = "or any of `objects`, `on`, `within`, `hands`, `held`, `coordinates`, `near`, `constraints` and `any`, \
                            which are not empty";

pub(crate) fn read(
    item: &Item<'_>,
    reader: &Reader<'_>,
    start: &[f64],
    graph: &GraphOptions,
) -> Result<Vec<Goal>, SceneError> {
    let items = item.list()?;
    let many = |count: usize| {
        let message = format!("{count} goals are given, 1 to {GOALS} are read");
        item.error(message).hint("a problem has at least one goal")
    };
    if items.is_empty() || items.len() > GOALS {
        return Err(many(items.len()));
    }
    let mut goals = Vec::new();
    for item in &items {
        goals.extend(goal(item, reader, start, graph)?);
        if goals.len() > GOALS {
            return Err(many(goals.len()));
        }
    }
    Ok(goals)
}

/// One table: one goal, or as many as its `any` lists.
fn goal(item: &Item<'_>, reader: &Reader<'_>, start: &[f64], graph: &GraphOptions) -> Result<Vec<Goal>, SceneError> {
    let mut keys = item.keys()?;
    let whole = keys.optional("configuration");
    let any = keys.optional("any");
    let common = partial(&mut keys, reader, graph)?;
    keys.finish()?;
    let wrong = || item.error("wants either `configuration` alone").hint(REQUIREMENTS);
    match (whole, any, common == PartialGoal::default()) {
        (Some(whole), None, true) => Ok(vec![Goal::Configuration(reader.whole_goal(&whole, start)?)]),
        (None, None, false) => Ok(vec![Goal::Partial(common)]),
        (None, Some(any), _) => alternatives(&any, &common, reader, graph),
        _ => Err(wrong()),
    }
}

/// What `any` lists, each with what all of them share.
fn alternatives(
    any: &Item<'_>,
    common: &PartialGoal,
    reader: &Reader<'_>,
    graph: &GraphOptions,
) -> Result<Vec<Goal>, SceneError> {
    let items = any.list()?;
    if items.is_empty() || items.len() > GOALS {
        return Err(any.error(format!("{} goals are given, 1 to {GOALS} are read", items.len())));
    }
    let read = |item: &Item<'_>| {
        let mut keys = item.keys()?;
        let own = partial(&mut keys, reader, graph)?;
        keys.finish()?;
        match own == PartialGoal::default() {
            true => Err(item.error("asks for nothing").hint(REQUIREMENTS)),
            false => Ok(Goal::Partial(both(common, own))),
        }
    };
    items.iter().map(read).collect()
}

/// What two goals ask together.
fn both(common: &PartialGoal, mut own: PartialGoal) -> PartialGoal {
    let common = common.clone();
    own.poses.extend(common.poses);
    own.coordinates.extend(common.coordinates);
    own.constraints.extend(common.constraints);
    own.lying.extend(common.lying);
    own.near.extend(common.near);
    own.hands.extend(common.hands);
    own.held.extend(common.held);
    if common.other_hands == OtherHands::Anything {
        own.other_hands = OtherHands::Anything;
    }
    own
}

/// What a goal asks: all of it holds, everything else is free.
fn partial(keys: &mut Keys<'_>, reader: &Reader<'_>, graph: &GraphOptions) -> Result<PartialGoal, SceneError> {
    let (mut goal, robot) = (PartialGoal::default(), reader.robot);
    if let Some(item) = keys.optional("objects") {
        goal.poses = poses(&item, robot)?;
    }
    if let Some(item) = keys.optional("coordinates") {
        goal.coordinates = coordinates(&item, reader)?;
    }
    if let Some(item) = keys.optional("near") {
        goal.near = demands::near(&item, reader)?;
    }
    if let Some(item) = keys.optional("constraints") {
        let numbers = several(&item, graph.constraints.iter().map(|c| c.name.as_str()), "constraint")?;
        goal.constraints = numbers.into_iter().map(|i| graph.constraints[i as usize].clone()).collect();
    }
    if let Some(item) = keys.optional("within") {
        goal.constraints.extend(demands::within(&item, robot)?);
    }
    if let Some(item) = keys.optional("on") {
        goal.lying = demands::on(&item, robot, graph)?;
    }
    if let Some(item) = keys.optional("hands") {
        (goal.hands, goal.other_hands) = demands::hands(&item, robot, graph)?;
    }
    if let Some(item) = keys.optional("held") {
        goal.held = demands::held(&item, robot, graph)?;
    }
    Ok(goal)
}

/// Poses of freely moving objects.
fn poses(item: &Item<'_>, robot: &Robot) -> Result<Vec<(PartIndex, Pose)>, SceneError> {
    item.keys()?
        .entries()
        .into_iter()
        .map(|(name, item)| Ok((moving_object(name, &item, robot)?, item.pose()?)))
        .collect()
}
