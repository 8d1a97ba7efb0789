//! The first collision among samples of a motion from a free configuration.
//!
//! Most motions of a tree are blocked at once, and by few pairs of bodies. Groups of pairs that collided last are tested first,
//! exactly too, so that a motion that is blocked at its first samples costs a fraction of all groups.

use crate::collision::broad_phase::open_pairs::{ALL, Hits, Open, all_lanes};
use crate::collision::discrete::many::Verdicts;
use crate::collision::narrow_phase::scratch::CollisionScratch;
use crate::collision::samples::interval::LANES;
use crate::collision::scene::collision_scene::PairId;
use crate::collision::scene::pair_query::Contact;

/// So many groups are tested before the others.
const FIRST: usize = 8;

/// The order in which groups of pairs are tested: those that collided most recently first. The verdict of a motion does not depend on
/// it, but which of several colliding pairs is named does: for equal answers begin with a new one.
#[derive(Clone, Debug, Default)]
pub struct TestOrder(Vec<u32>);

impl TestOrder {
    /// All groups, those of the pairs' own order at first.
    fn fit(&mut self, groups: usize) {
        if self.0.len() != groups {
            self.0.clear();
            self.0.extend(0..groups as u32);
        }
    }

    /// The group that this is true of has collided.
    fn collided(&mut self, has: impl Fn(u32) -> bool) {
        if let Some(place) = self.0.iter().position(|&group| has(group)) {
            self.0[..=place].rotate_right(1);
        }
    }

    /// About how much memory it takes, bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        (self.0.capacity() * size_of::<u32>()) as u64
    }
}

impl Verdicts<'_> {
    /// The first of up to sixteen samples of a motion that collides, as its number, and a pair that does. `motion` is the configuration
    /// from which it starts, which is known to be free, and then the samples: pairs that keep their relative pose in all of them are free,
    /// too.
    ///
    /// # Panics
    /// If `motion` is not a whole number of configurations, is empty, or has more than sixteen samples.
    pub fn first_on_motion(
        &self,
        motion: &[f64],
        order: &mut TestOrder,
        scratch: &mut CollisionScratch,
    ) -> Option<(usize, PairId)> {
        let count = motion.len() / self.scene.space.size() - 1;
        assert!(count <= LANES, "more than sixteen samples");
        if count == 0 {
            return None;
        }
        order.fit(self.pairs.moving.len());
        let mut buffers = std::mem::take(&mut scratch.verdicts);
        self.place(motion, 1, &mut buffers, scratch);
        buffers.found.clear();
        buffers.found.resize(count, None);
        let all = all_lanes(count);
        let mut hits = Hits { followers: all & !1, ..Hits::default() };
        let (first, others) = order.0.split_at(FIRST.min(order.0.len()));
        for (groups, is_placed) in [(first, false), (others, true)] {
            let lanes = all & !hits.settled;
            if lanes == 0 {
                break;
            }
            buffers.open.clear();
            buffers.rest.clear();
            let moves = |group: &u32| scratch.motion_samples.moves_between(self.pairs.active(*group));
            let open = |&active: &u32| Open { active, pair: ALL, lanes };
            buffers.open.extend(groups.iter().filter(|group| moves(group)).map(open));
            self.bound((lanes, is_placed), Some(&mut hits), &mut buffers, scratch);
            self.ask_exactly(&mut hits, &mut buffers, scratch);
        }
        let pair = |sample: usize, contact: Option<Contact>| match contact {
            Some(contact) => Some(contact.pair),
            None => (hits.colliding >> sample & 1 == 1).then_some(PairId(hits.pairs[sample].0)),
        };
        let found =
            buffers.found.iter().enumerate().find_map(|(sample, contact)| Some((sample, pair(sample, *contact)?)));
        scratch.verdicts = buffers;
        let (_, pair) = found?;
        order.collided(|group| {
            let group = &self.scene.groups[self.pairs.active(group).group as usize];
            (group.start..group.end).contains(&pair.0)
        });
        found
    }
}
