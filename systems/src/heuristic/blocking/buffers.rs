//! Placements to set objects aside at.

use crate::heuristic::blocking::exclusions::Exclusions;
use crate::heuristic::blocking::order::Order;
use crate::heuristic::placements::drawing::Resting;
use crate::planning_model::model::Model;
use crate::runtime::random::{Purpose, draw, stream};
use foliate_components::Pose;
use foliate_components::graph::leaf::{LeafIndex, ParameterId};
use rand::RngExt;
use std::collections::BTreeMap;

/// Placements that are drawn for an object, beside those of other objects.
const DRAWN: usize = 32;

/// Placements that are looked at when one is chosen.
const LOOKED_AT: usize = 24;

/// A placement that leaves one object more to set aside is so many times less likely.
const CYCLE: f64 = 16.0;

/// A placement is chosen half as often after so many tries.
const PATIENCE: f64 = 2.0;

/// By object: placements at which it may be set aside.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffers {
    of: BTreeMap<usize, Vec<Buffer>>,
}

#[derive(Clone, Copy, Debug)]
struct Buffer {
    parameter: ParameterId,
    tries: u32,
}

impl Buffers {
    /// Chooses a placement for an object that is free in the order's first leaf; the fewer objects then are on cycles, the likelier.
    pub(crate) fn choose(
        &mut self,
        model: &Model,
        leaves: &mut LeafIndex,
        exclusions: &mut Exclusions,
        (order, object): (&Order, usize),
        (seed, rng): (u64, &mut impl RngExt),
        reach: impl Fn(ParameterId) -> f64,
    ) -> Option<ParameterId> {
        let buffers = self.of.entry(object).or_insert_with(|| places(model, leaves, exclusions, (order, object), seed));
        if buffers.is_empty() {
            return None;
        }
        let targets: Vec<_> =
            order.here.iter().zip(&order.there).map(|(here, there)| there.filter(|_| here != there)).collect();
        let mut choices = Vec::with_capacity(LOOKED_AT);
        for _ in 0..LOOKED_AT.min(buffers.len()) {
            let number = rng.random_range(0..buffers.len());
            let Buffer { parameter, tries } = buffers[number];
            if !exclusions.excluded(model, leaves, (object, parameter), &order.here).is_empty() {
                continue;
            }
            let waiting = exclusions.excluded(model, leaves, (object, parameter), &targets);
            let cycles = order.dependencies.moved(object, &waiting).to_set_aside().len();
            let weight = reach(parameter) * CYCLE.powi(-(cycles as i32)) / (1.0 + waiting.len() as f64);
            choices.push((number, weight / (1.0 + f64::from(tries) / PATIENCE)));
        }
        let number = draw(&choices, rng.random())?;
        buffers[number].tries += 1;
        Some(buffers[number].parameter)
    }
}

/// Where an object may be set aside: where others rest first or last, and anywhere.
fn places(
    model: &Model,
    leaves: &mut LeafIndex,
    exclusions: &Exclusions,
    (order, object): (&Order, usize),
    seed: u64,
) -> Vec<Buffer> {
    let number = exclusions.objects[object].object;
    let Some(resting) = Resting::of_object(model, number) else { return Vec::new() };
    let mut rng = stream(seed, Purpose::PLACEMENT, u64::from(number), u32::MAX - 64);
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    let known: Vec<Pose> =
        order.here.iter().chain(&order.there).flatten().map(|&place| leaves.parameter(place).value).collect();
    let mut poses: Vec<Pose> = known.iter().filter_map(|pose| resting.laid_down(pose, &mut X_WJ)).collect();
    let far = |a: usize| known[a % known.len().max(1)];
    for draw in 0..DRAWN {
        if !known.is_empty() {
            poses.extend(resting.draw((&far(draw), &far(3 * draw + 1)), &mut rng, &mut X_WJ));
        }
    }
    let buffer = |pose: &Pose| Buffer { parameter: leaves.add_parameter(resting.parameter(pose)), tries: 0 };
    poses.iter().map(buffer).collect()
}
