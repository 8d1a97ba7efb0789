//! The systems of the pool of placements: it grows before set Select chooses, candidates are aimed at it, and what came of them is
//! counted after set Validate.

use crate::exploration::memory::PlacementBytes;
use crate::exploration::reached_leaves::{ReachedLeaves, StateLeaves};
use crate::exploration::roadmap_query::roadmap_in;
use crate::exploration::roots::Roots;
use crate::exploration::writer;
use crate::heuristic::placements::pool::{Aim, ObjectPlacements, PlacementPool, Side, bits};
use crate::planning_model::model::{Model, PlanningModel};
use crate::runtime::random::{Purpose, draw, stream};
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Entity, Mut, Query, Res, ResMut, With, World};
use foliate_components::Pose;
use foliate_components::candidate::{Candidate, CandidateArena};
use foliate_components::graph::leaf::{Leaf, LeafId, LeafIndex};
use foliate_components::graph::{ConstraintId, ConstraintKind, Transition, TransitionId, TransitionKind};
use foliate_components::roadmap::{NodeId, TreeId};
use rand::RngExt;
use rand::seq::IndexedRandom;

/// Steps before the first placement is drawn: most problems are solved by then.
const FIRST_STEP: u64 = 12;

/// Batches of draws in a step, over all objects.
const BATCHES: usize = 4;

/// A hand of at most so many bodies, a gripper with two fingers, is tested as often as that.
const FEW_BODIES: usize = 4;

/// Of so many candidates one aims at the pool, where there is anything to aim at.
const AIMING: u64 = 4;

/// Of those the share that grasps the object in start or goal by a grasp that bridges want, while there is one.
const APPROACHING: f64 = 0.35;

/// A grasp is approached half as often after so many tries.
const APPROACH_PATIENCE: f64 = 16.0;

/// Placements of an object in goals that are told apart.
const MOST_GOALS: usize = 8;

/// Grows the pool of placements, and aims candidates of set Select at it: each at a leaf that it may reach by setting an object down.
/// Suggested placements are there from the first step on; others are drawn once a search has gone on for a while.
pub fn aim_at_placements(world: &mut World) {
    let step = world.resource::<StepCounter>().step;
    if step < FIRST_STEP && world.resource::<PlanningModel>().problem.suggestions.is_empty() {
        return;
    }
    world.resource_scope(|world, mut pool: Mut<'_, PlacementPool>| {
        world.resource_scope(|world, model: Mut<'_, PlanningModel>| {
            pool.aims.clear();
            let PlacementPool { objects, aims } = &mut *pool;
            let objects = objects.get_or_insert_with(|| pools(world, &model));
            if objects.is_empty() {
                return;
            }
            if step >= FIRST_STEP {
                grow(objects, &model, world.resource::<SearchSettings>().seed);
            }
            let bytes = objects.iter().map(|object| object.bytes(&model)).sum();
            world.insert_resource(PlacementBytes(bytes));
            aim(world, &model, objects, aims);
        });
    });
}

/// The placements of all objects that may need any.
fn pools(world: &World, model: &Model) -> Vec<ObjectPlacements> {
    let (roots, roadmap) = (world.resource::<Roots>(), roadmap_in(world));
    let leaves = world.resource::<LeafIndex>();
    let rests = |node: NodeId, constraint: ConstraintId| {
        let id = model.graph.value(leaves.leaf(roadmap.node(node).leaf), constraint)?;
        let parameter = leaves.parameter(id);
        parameter.carrier.is_none().then_some(parameter.value)
    };
    let of_object = |object: u32| {
        let wanted = ConstraintKind::Placement { object, on: None };
        let constraint = ConstraintId(model.graph.constraints.iter().position(|c| c.kind == wanted)? as u32);
        let starts: Vec<Pose> = roots.start.iter().filter_map(|&start| rests(start, constraint)).collect();
        let mut goals: Vec<Pose> = Vec::new();
        for pose in roots.goals.iter().filter_map(|&goal| rests(goal, constraint)) {
            if goals.len() < MOST_GOALS && !goals.contains(&pose) {
                goals.push(pose);
            }
        }
        let part = model.graph.objects[object as usize].part;
        let is_suggested = model.problem.suggestions.iter().any(|(named, _)| *named == part);
        let stays = starts.iter().any(|start| goals.contains(start));
        if !is_suggested && (stays || starts.is_empty() || goals.is_empty()) {
            return None;
        }
        ObjectPlacements::new(model, object, (&starts, &goals))
    };
    (0..model.objects().len() as u32).filter_map(of_object).collect()
}

fn grow(objects: &mut [ObjectPlacements], model: &Model, seed: u64) {
    let mut wanting: Vec<_> = objects.iter_mut().filter(|object| object.wants_draws()).collect();
    // Those with the fewest draws first, so that none is left behind.
    wanting.sort_by_key(|object| (object.draws, object.object));
    for object in wanting.into_iter().take(BATCHES) {
        // A hand of many bodies takes longer to test.
        let batches = (BATCHES * FEW_BODIES / object.hands.bodies().max(FEW_BODIES)).max(1);
        for _ in 0..batches {
            if object.wants_draws() {
                object.draw_batch(model, seed);
            }
        }
    }
}

/// A leaf on which the object is held, and where it is to be set down.
struct Holding {
    leaf: LeafId,
    bridge: usize,
}

fn aim(world: &mut World, model: &Model, objects: &mut [ObjectPlacements], aims: &mut Vec<Aim>) {
    let (step, seed) = (world.resource::<StepCounter>().step, world.resource::<SearchSettings>().seed);
    let mut candidates: Vec<(Entity, u32)> = world
        .query_filtered::<(Entity, &Candidate), With<Candidate>>()
        .iter(world)
        .filter(|(_, candidate)| candidate.is_alive() && candidate.near.is_none())
        .map(|(entity, candidate)| (entity, candidate.index))
        .collect();
    let pool = world.resource::<CandidateArena>().complete.len() as u64;
    candidates.retain(|&(_, index)| (step * pool + u64::from(index)) % AIMING == AIMING / 2);
    candidates.sort_by_key(|&(_, index)| index);
    for (entity, index) in candidates {
        let mut rng = stream(seed, Purpose::AIM, step, index);
        let number = rng.random_range(0..objects.len());
        let object = &mut objects[number];
        let side = if rng.random() { Side::Start } else { Side::Goal };
        let held = held_grasps(world, model, object, side);
        let aim = match rng.random::<f64>() < APPROACHING {
            true => approach(world, model, object, (side, held), &mut rng),
            false => None,
        };
        let aim = aim.or_else(|| {
            let holding = choose(world, model, object, (side, held), &mut rng)?;
            let (transition, target) = release(world, model, object, &holding)?;
            object.bridges[holding.bridge].tries[side as usize] += 1;
            aims.push(Aim { candidate: index as usize, object: number, bridge: holding.bridge, side });
            Some((holding.leaf, transition, Some(target)))
        });
        let Some((leaf, transition, target)) = aim else { continue };
        let tree = side_of(world, side);
        if let Some(mut candidate) = world.get_mut::<Candidate>(entity) {
            candidate.tree = tree;
            candidate.leaf = Some(leaf);
            candidate.transition = Some(transition);
            candidate.target_leaf = target;
        }
    }
}

/// The root of a side.
fn root_of(world: &World, side: Side) -> Option<NodeId> {
    let roots = world.resource::<Roots>();
    match side {
        Side::Start => roots.start,
        Side::Goal => roots.goals.first().copied(),
    }
}

fn side_of(world: &World, side: Side) -> Option<TreeId> {
    Some(roadmap_in(world).side_of(root_of(world, side)?))
}

/// The leaves that a side has reached in states in which the object is held by a grasp.
fn held_by<'w>(
    world: &'w World,
    model: &'w Model,
    side: Side,
    constraint: ConstraintId,
) -> impl Iterator<Item = &'w StateLeaves> {
    let reached = side_of(world, side).map_or(&[][..], |tree| world.resource::<ReachedLeaves>().of_tree(tree));
    reached.iter().filter(move |leaves| model.graph.state(leaves.state).manifold.contains(&constraint))
}

/// The grasps by which a side has held the object.
fn held_grasps(world: &World, model: &Model, object: &ObjectPlacements, side: Side) -> u64 {
    let is_held = |grasp: &usize| {
        let constraint = object.hands.grasps[*grasp].constraint;
        held_by(world, model, side, constraint).next().is_some()
    };
    (0..object.hands.grasps.len()).filter(is_held).fold(0, |all, grasp| all | 1 << grasp)
}

/// A grasp of the object where it rests in start or goal that bridges want and by which the side has not held it yet.
fn approach(
    world: &World,
    model: &Model,
    object: &mut ObjectPlacements,
    (side, held): (Side, u64),
    rng: &mut impl RngExt,
) -> Option<(LeafId, TransitionId, Option<LeafId>)> {
    let tries = &object.approaches[side as usize];
    let weigh = |(grasp, wanted): (usize, f64)| match held & 1 << grasp == 0 {
        true => (grasp, wanted / (1.0 + f64::from(tries[grasp]) / APPROACH_PATIENCE)),
        false => (grasp, 0.0),
    };
    let choices: Vec<_> = object.wanted_at_root(side).map(weigh).collect();
    let grasp = draw(&choices, rng.random())?;
    object.approaches[side as usize][grasp] += 1;
    let wanted = object.hands.grasps[grasp].constraint;
    let root = roadmap_in(world).node(root_of(world, side)?);
    let leads = |transition: &Transition| {
        let holds = |state| model.graph.state(state).manifold.contains(&wanted);
        transition.kind == TransitionKind::Regular && holds(transition.to) && !holds(transition.from)
    };
    let leading: Vec<_> = model.graph.leaving(root.state).filter(|(_, t)| leads(t)).map(|(id, _)| id).collect();
    Some((root.leaf, *leading.choose(rng)?, None))
}

/// Chooses a placement, and a leaf on which the side holds the object by a grasp that fits.
fn choose(
    world: &World,
    model: &Model,
    object: &ObjectPlacements,
    (side, held): (Side, u64),
    rng: &mut impl RngExt,
) -> Option<Holding> {
    let weigh = |bridge: usize| {
        let entry = &object.bridges[bridge];
        (bridge, if entry.grasps[side as usize] & held == 0 { 0.0 } else { entry.weight(side) })
    };
    let choices: Vec<_> = (0..object.bridges.len()).map(weigh).collect();
    let bridge = draw(&choices, rng.random())?;
    let fitting: Vec<usize> = bits(object.bridges[bridge].grasps[side as usize] & held).collect();
    let constraint = object.hands.grasps[*fitting.choose(rng)?].constraint;
    let states: Vec<_> = held_by(world, model, side, constraint).collect();
    let leaf = *states.choose(rng)?.leaves.choose(rng)?;
    Some(Holding { leaf, bridge })
}

/// The crossed transition that sets the object down, and the leaf that it then lies on.
fn release(
    world: &mut World,
    model: &Model,
    object: &mut ObjectPlacements,
    holding: &Holding,
) -> Option<(TransitionId, LeafId)> {
    let placed = object.resting.constraint;
    let from = world.resource::<LeafIndex>().leaf(holding.leaf).clone();
    let leads = |&(_, transition): &(TransitionId, &Transition)| {
        transition.kind == TransitionKind::Crossed && transition.adds == [placed]
    };
    let (id, transition) = model.graph.leaving(from.state).find(leads)?;
    let bridge = &mut object.bridges[holding.bridge];
    let parameter = *bridge.id.get_or_insert_with(|| world.resource_mut::<LeafIndex>().add_parameter(bridge.parameter));
    let value = |&constraint: &ConstraintId| match constraint == placed {
        true => Some(parameter),
        false => model.graph.value(&from, constraint),
    };
    let parameters = model.graph.state(transition.to).foliation.iter().map(value).collect::<Option<_>>()?;
    Some((id, writer::intern_leaf(world, Leaf { state: transition.to, parameters })))
}

/// Set Validate, after the certificates: remembers what became of the candidates that were aimed at placements.
pub fn learn_from_placements(
    mut pool: ResMut<'_, PlacementPool>,
    arena: Res<'_, CandidateArena>,
    candidates: Query<'_, '_, &Candidate>,
) {
    let PlacementPool { objects, aims } = &mut *pool;
    let Some(objects) = objects.as_mut().filter(|_| !aims.is_empty()) else { return };
    let alive = |index: usize| candidates.iter().any(|c| c.index as usize == index && c.is_alive());
    for Aim { candidate, object, bridge, side } in std::mem::take(aims) {
        let reached = alive(candidate) && !arena.legs[candidate].is_empty();
        objects[object].bridges[bridge].succeeded[side as usize] += u32::from(reached);
    }
}
