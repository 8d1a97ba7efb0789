//! Which configurations the trees of a local plan grow towards.

use crate::step::local_planner::leaf_space::{LeafScratch, LeafSpace};
use crate::step::projection::project::UNINVOLVED_STILL;
use foliate_components::robot::configuration::{ConfigurationSpace, Group};
use rand::{Rng, RngExt};

/// Share of the draws that may lie anywhere, and to which a tree may grow in one motion.
const ANYWHERE: f64 = 0.5;

/// Of the other draws, the share that lies around the straight motion between both ends.
const BETWEEN: f64 = 0.4;

/// Of the other draws, the share that keeps still what both ends have in common.
const STILL: f64 = 0.75;

/// Joints on which nothing depends may be in the way all the same: after so much work they move in half of the draws.
const EASY: u64 = 64;
const HARD_STILL: f64 = 0.5;

/// A configuration of a leaf to which a tree grows.
pub struct Draw {
    /// The whole configuration.
    pub q: Vec<f64>,
    /// Whether a tree grows to it in short steps.
    pub is_local: bool,
}

/// Draws a configuration of the leaf, after so much `work` on the plan. `None` where the draw cannot be projected onto it.
pub fn draw(
    leaf: &LeafSpace<'_>,
    (a, b): (&[f64], &[f64]),
    work: u64,
    rng: &mut impl Rng,
    scratch: &mut LeafScratch,
) -> Option<Draw> {
    let model = leaf.model;
    let space = &model.problem.robot.space;
    let mut q = vec![0.0; a.len()];
    space.random(rng, &mut q);
    let [range, kind, along, away, still, uninvolved]: [f64; 6] = [(); 6].map(|()| rng.random());
    let is_local = range >= ANYWHERE;
    if is_local && kind < BETWEEN {
        let mut middle = vec![0.0; q.len()];
        space.interpolate(a, b, along, &mut middle);
        let far = q.clone();
        space.interpolate(&middle, &far, away, &mut q);
    }
    if is_local && still < STILL {
        keep_common(space, (a, b), &mut q);
    }
    if uninvolved < if work < EASY { UNINVOLVED_STILL } else { HARD_STILL } {
        model.uninvolved.iter().for_each(|&index| q[index] = a[index]);
    }
    model.lock(&mut q);
    leaf.project(&mut q, scratch).then_some(Draw { q, is_local })
}

/// Copies what both ends have in common: a rotation as a whole, for a quaternion of numbers from two others is none.
fn keep_common(space: &ConfigurationSpace, (a, b): (&[f64], &[f64]), q: &mut [f64]) {
    for factor in &space.factors {
        let (numbers, rotation) = match factor.group {
            Group::FreeFlyer => (factor.q..factor.q + 3, factor.q + 3..factor.q + 7),
            Group::Plane => (factor.q..factor.q + 3, 0..0),
            Group::Real | Group::Circle => (factor.q..factor.q + 1, 0..0),
        };
        numbers.filter(|&index| a[index] == b[index]).for_each(|index| q[index] = a[index]);
        if a[rotation.clone()] == b[rotation.clone()] {
            q[rotation.clone()].copy_from_slice(&a[rotation]);
        }
    }
}
