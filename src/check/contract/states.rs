//! In which of the problem's own states each segment lies: those whose constraints it says, one after another as the
//! problem's transitions allow.

use super::required_constraints::{Said, said};
use crate::check::contract::scene_contract::Contract;
use crate::path_file::document::PathFile;
use foliate_components::problem::WrittenTransition;

impl Contract<'_> {
    /// The state of a segment on a way through all of them; none where there is no such way.
    pub(super) fn state_of(&self, file: &PathFile, segment: usize) -> Option<usize> {
        self.states.get_or_init(|| self.states_of(file)).get(segment).copied().flatten()
    }

    /// A state for every segment, each next to the one before; none where nothing fits.
    fn states_of(&self, file: &PathFile) -> Vec<Option<usize>> {
        let options = &self.problem.graph;
        let fits = |state: usize, segment: usize| {
            options.states[state].constraints.iter().all(|&number| {
                let named = &options.constraints[number as usize];
                said(&self.problem.robot, named, file, segment) != Said::No
            })
        };
        let count = options.states.len();
        // From the last segment backwards: where a way to the end begins.
        let mut ways: Vec<Vec<bool>> = Vec::with_capacity(file.segments.len());
        for segment in (0..file.segments.len()).rev() {
            let next = ways.last();
            let leads = |state: usize| {
                next.is_none_or(|next| (0..count).any(|other| next[other] && self.may_follow(state, other)))
            };
            ways.push((0..count).map(|state| fits(state, segment) && leads(state)).collect());
        }
        ways.reverse();
        let mut before: Option<usize> = None;
        let mut chosen = Vec::with_capacity(ways.len());
        for way in ways {
            let follows = |state: &usize| before.is_none_or(|before| self.may_follow(before, *state));
            let state = (0..count).filter(|&state| way[state]).find(follows);
            chosen.push(state);
            before = state.or(before);
        }
        chosen
    }

    /// Whether a motion may lie in one state and the next motion in another.
    fn may_follow(&self, one: usize, other: usize) -> bool {
        one == other || self.problem.graph.transitions.iter().any(|transition| passes(transition, one, other))
    }
}

/// Whether a transition, in either direction, has one state right before another.
fn passes(transition: &WrittenTransition, one: usize, other: usize) -> bool {
    let within = transition.legs.iter().map(|leg| leg.within);
    let way: Vec<usize> =
        [transition.from].into_iter().chain(within).chain([transition.to]).map(|state| state as usize).collect();
    way.windows(2).any(|pair| (pair[0], pair[1]) == (one, other) || (pair[1], pair[0]) == (one, other))
}
