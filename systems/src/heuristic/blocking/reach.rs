//! Which grasps can hold an object where it is placed: what came of the tries, over all leaves.

use foliate_components::graph::ConstraintId;
use foliate_components::graph::leaf::ParameterId;
use std::collections::HashMap;

/// What is left at least of the likelihood of a grasp that was never found at a placement.
const FLOOR: f64 = 0.01;

/// A grasp that is as unlikely is taken for out of reach.
const HARDLY: f64 = 0.02;

/// By grasp and placement: searches for a configuration, and how many have found one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reach {
    counts: HashMap<(ConstraintId, ParameterId), (u32, u32)>,
}

impl Reach {
    /// Remembers a search for a configuration with a grasp at a placement.
    pub(crate) fn count(&mut self, grasp: ConstraintId, placement: ParameterId, was_found: bool) {
        let (tries, found) = self.counts.entry((grasp, placement)).or_default();
        *tries += 1;
        *found += u32::from(was_found);
    }

    /// How likely it is that there is one: 1 before anything was tried.
    pub(crate) fn likelihood(&self, grasp: ConstraintId, placement: ParameterId) -> f64 {
        let (tries, found) = self.counts.get(&(grasp, placement)).copied().unwrap_or_default();
        (f64::from(1 + found) / f64::from(1 + tries)).powi(2).max(FLOOR)
    }

    /// Whether there is hardly any.
    pub(crate) fn is_out(&self, grasp: ConstraintId, placement: ParameterId) -> bool {
        self.likelihood(grasp, placement) < HARDLY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_never_found_is_out_of_reach_and_what_was_is_not() {
        let (grasp, place) = (ConstraintId(3), ParameterId(5));
        let mut reach = Reach::default();
        assert!(reach.likelihood(grasp, place) > 0.99 && !reach.is_out(grasp, place));
        (0..7).for_each(|_| reach.count(grasp, place, false));
        assert!(
            reach.is_out(grasp, place) && !reach.is_out(grasp, ParameterId(6)) && !reach.is_out(ConstraintId(4), place)
        );
        (0..1000).for_each(|_| reach.count(grasp, place, false));
        assert!(reach.likelihood(grasp, place) >= FLOOR);
        (0..1000).for_each(|_| reach.count(grasp, place, true));
        assert!(!reach.is_out(grasp, place));
    }
}
