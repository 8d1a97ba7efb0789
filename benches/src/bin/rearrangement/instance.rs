//! Generated instances: where boxes start and where they shall end.
//!
//! What stands where says what must move before what: the *dependency graph* has an edge from a box to the box that stands on its goal
//! (Han et al., *Complexity results and fast methods for optimal tabletop rearrangement with overhand grasps*, IJRR 2018). Here every place is one start or none and one
//! goal or none, so that the graph is made of chains and cycles. A chain is solved from its free end, a grasp a box. A cycle
//! takes one grasp more where one arm solves it: some box has to wait at a place of its own.

use foliate_components::problem::Problem;

use foliate_components::samples::rearrangements::{ARM_DISTANCE, BOX_SIDE, rearrange_boxes};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

/// A point of the table, metres.
type Place = (f64, f64);

/// Distance of neighbouring places, and where they are dense, metres.
const APART: f64 = 0.085;
const DENSE: f64 = 1.3 * BOX_SIDE;

/// Boxes per place of a dense instance.
const FILLED: f64 = 0.75;

/// Most boxes in a chain or a cycle.
const LONGEST: usize = 4;

/// How goals lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Each box can go straight to its goal, in some order: chains.
    Monotone,
    /// Cycles: of each a box must wait somewhere else.
    Cyclic,
    /// Three quarters of the table's places are taken at the start, and at the goal.
    Dense,
}

/// An instance.
#[derive(Clone, Debug)]
pub struct Instance {
    pub arms: usize,
    table: Place,
    pub starts: Vec<Place>,
    pub goals: Vec<Place>,
}

impl Kind {
    pub const ALL: [Self; 3] = [Self::Monotone, Self::Cyclic, Self::Dense];

    pub fn name(self) -> &'static str {
        match self {
            Self::Monotone => "monotone",
            Self::Cyclic => "cyclic",
            Self::Dense => "dense",
        }
    }

    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

impl Instance {
    pub fn new(kind: Kind, arms: usize, boxes: usize, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        if kind == Kind::Dense {
            return Self::dense(arms, boxes, &mut rng);
        }
        let mut instance = Self { arms, table: (1.7, 1.7), starts: Vec::new(), goals: Vec::new() };
        for (arm, count) in shares(boxes, arms) {
            let mut places = reachable(arm);
            places.shuffle(&mut rng);
            let mut left = count;
            while left > 0 {
                let length = (2 + places.len() % (LONGEST - 1)).min(left);
                let mut stops: Vec<Place> = places.drain(..length).collect();
                // What a single box is left with is a chain.
                let end = if kind == Kind::Cyclic && length > 1 { Some(stops[0]) } else { places.pop() };
                instance.starts.extend_from_slice(&stops);
                stops.remove(0);
                instance.goals.extend(stops.into_iter().chain(end));
                left -= length;
            }
        }
        instance
    }

    /// Places in a square that both arms reach, which is all of the table.
    fn dense(arms: usize, boxes: usize, rng: &mut ChaCha8Rng) -> Self {
        let count = (boxes as f64 / FILLED).ceil() as usize;
        let columns = (count as f64).sqrt().ceil() as usize;
        let rows = count.div_ceil(columns);
        let at = |number: usize, count: usize| (number as f64 - 0.5 * (count - 1) as f64) * DENSE;
        let mut places: Vec<Place> =
            (0..count).map(|place| (at(place % columns, columns), at(place / columns, rows))).collect();
        places.shuffle(rng);
        let starts = places[..boxes].to_vec();
        places.shuffle(rng);
        let goals = places[..boxes].to_vec();
        Self { arms, table: (columns as f64 * DENSE, rows as f64 * DENSE), starts, goals }
    }

    pub fn problem(&self) -> Result<Problem, Box<dyn std::error::Error>> {
        Ok(rearrange_boxes(self.arms, self.table, &self.starts, &self.goals)?)
    }

    /// Fewest grasps that any answer has: one for each box that moves, and with one arm one for each cycle.
    pub fn fewest_grasps(&self) -> usize {
        let moved = self.starts.iter().zip(&self.goals).filter(|(start, goal)| start != goal).count();
        moved + if self.arms == 1 { self.cycles() } else { 0 }
    }

    fn cycles(&self) -> usize {
        let next = |at: usize| self.starts.iter().position(|start| *start == self.goals[at]);
        // A box is counted where it is the first of its cycle.
        let closes = |&first: &usize| {
            let mut at = first;
            while let Some(then) = next(at).filter(|&then| then > first) {
                at = then;
            }
            next(at) == Some(first) && at != first
        };
        (0..self.starts.len()).filter(closes).count()
    }
}

/// How many boxes each arm has.
fn shares(boxes: usize, arms: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..arms).map(move |arm| (arm, boxes / arms + usize::from(arm < boxes % arms)))
}

/// Places that an arm can reach from above; of two arms each has its own half of the table.
fn reachable(arm: usize) -> Vec<Place> {
    let side = if arm == 0 { -1.0 } else { 1.0 };
    let steps = |most: f64| (-(most / APART) as i32..=(most / APART) as i32).map(|n| f64::from(n) * APART);
    let places = steps(0.8).flat_map(|x| (0..9).map(move |row| (x, side * (0.5 * APART + f64::from(row) * APART))));
    let reach = |&(x, y): &Place| {
        let (along, aside) = (ARM_DISTANCE - side * y, x);
        let far = along.hypot(aside);
        (0.34..0.74).contains(&far) && along > -0.05
    };
    places.filter(reach).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instances_are_what_they_are_called() {
        for boxes in [5, 10, 20, 40] {
            for arms in [1, 2] {
                let of = |kind| Instance::new(kind, arms, boxes, 7);
                assert_eq!(of(Kind::Monotone).cycles(), 0);
                assert!(of(Kind::Cyclic).cycles() >= boxes / (LONGEST + 1));
                for kind in Kind::ALL {
                    let instance = of(kind);
                    assert_eq!((instance.starts.len(), instance.goals.len()), (boxes, boxes));
                    let mut goals = instance.goals.clone();
                    goals.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
                    goals.dedup();
                    assert_eq!(goals.len(), boxes, "{kind:?}");
                }
            }
        }
    }
}
