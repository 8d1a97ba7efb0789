//! Which configurations the trees of a local plan grow towards.

use crate::step::local_planner::leaf_space::{LeafScratch, LeafSpace};
use rand::{Rng, RngExt};

/// Share of the draws that lie around the straight motion between both ends. The others are anywhere.
const BETWEEN: f64 = 0.4;

/// Share of the draws that keep still what both ends have in common.
const STILL: f64 = 0.75;

/// Draws a configuration of the leaf. `None` where the draw cannot be projected onto it.
pub fn draw(
    leaf: &LeafSpace<'_>,
    (a, b): (&[f64], &[f64]),
    rng: &mut impl Rng,
    scratch: &mut LeafScratch,
) -> Option<Vec<f64>> {
    let model = leaf.model;
    let space = &model.problem.robot.space;
    let mut q = vec![0.0; a.len()];
    space.random(rng, &mut q);
    let [kind, along, away, still]: [f64; 4] = [(); 4].map(|()| rng.random());
    if kind < BETWEEN {
        let mut middle = vec![0.0; q.len()];
        space.interpolate(a, b, along, &mut middle);
        let far = q.clone();
        space.interpolate(&middle, &far, away, &mut q);
    }
    if still < STILL {
        for (index, x) in q.iter_mut().enumerate().filter(|&(index, _)| a[index] == b[index]) {
            *x = a[index];
        }
    }
    model.uninvolved.iter().for_each(|&index| q[index] = a[index]);
    model.lock(&mut q);
    leaf.project(&mut q, scratch).then_some(q)
}
