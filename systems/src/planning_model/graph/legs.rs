//! The legs of grasps and releases, in HPP's order and numbering (its factory's `_pregrasp`, `_intersec`, `_preplace`).
//!
//! | number | waypoint | holds besides the state's manifold |
//! |---|---|---|
//! | 1 | pre-grasp | the gripper stands back along its x axis |
//! | 2 | intersection | grasp, and what holds while the grasp does not: placement, doors at rest |
//! | 3 | pre-placement | grasp, and the object lifted along the support's normal |
//!
//! Legs 01 and 12 lie in the state without the grasp, 23 in the state with it; 12 and 23 in states that are only passed through where they
//! are to be straight. A hand with fingers opens and closes in legs of its own,
//! in states that are only passed through: in one the fingers move, in another they are open though the hand is empty. HPP's last leg
//! of either direction (34, 10) has no length, because the waypoint already satisfies the target: it is left out.

use crate::planning_model::graph::builder::Builder;
use crate::planning_model::graph::states::state_keys::StateKey;
use crate::planning_model::graph::transitions::{Change, leg};
use foliate_components::graph::{ConstraintId, ConstraintKind, Fingers, Leg, Opening, StateId};

/// The states through which a hand with fingers passes between a state without a grasp and one with it.
struct PassingStates {
    /// The hand.
    number: u32,
    /// How far it is open beside the object.
    open: Opening,
    /// Whether it is as far open whenever it is empty; then it need not move its fingers beside an object.
    travels_open: bool,
    /// The grasp holds, and the fingers move.
    moving_full: StateId,
    /// The hand is empty, and the fingers move.
    moving_empty: StateId,
    /// The hand is empty and open.
    beside: StateId,
}

impl Builder<'_> {
    /// 01 approach, 12 reach the grasp, 23 lift. A hand with fingers opens at the end of 01 (1o) and closes at that of 12 (2c).
    pub(super) fn grasping_legs(&mut self, name: &str, change: Change) -> Vec<Leg> {
        let Change { gripper, handle, without, with } = change;
        let hand = self.passing_states(change);
        let mut legs = Vec::new();
        if self.state_keys.has_pregrasp(gripper, handle) {
            let target = vec![self.constraint(ConstraintKind::Pregrasp { gripper, handle })];
            legs.push(leg(name, "01", without, target, false));
            if let Some(hand) = hand.as_ref().filter(|hand| !hand.travels_open) {
                let mut target = self.opening(hand.number, hand.open);
                target.push(self.constraint(ConstraintKind::Pregrasp { gripper, handle }));
                legs.push(leg(name, "1o", hand.moving_empty, target, true));
            }
        }
        let beside = self.beside(change, hand.as_ref().filter(|_| !legs.is_empty()));
        let next = hand.as_ref().map_or(with, |hand| hand.moving_full);
        legs.push(leg(name, "12", beside, self.difference(next, beside), !legs.is_empty()));
        if let Some(hand) = &hand {
            let mut target = self.opening(hand.number, Opening::Closed { gripper, handle });
            target.extend(self.lost(change));
            legs.push(leg(name, "2c", hand.moving_full, target, true));
        }
        let lifted = self.lifted(&self.difference(without, with));
        if !lifted.is_empty() {
            legs.push(leg(name, "23", self.lifting(with, &lifted), lifted, true));
        }
        legs
    }

    /// 43 approach with the object, 32 put down, 21 retreat. A hand with fingers opens at the end of 32 (2o) and travels on as it does
    /// from the end of 21 (1c).
    pub(super) fn releasing_legs(&mut self, name: &str, change: Change) -> Vec<Leg> {
        let Change { gripper, handle, without, with } = change;
        let hand = self.passing_states(change);
        let lost = self.lost(change);
        let mut legs = Vec::new();
        let lifted = self.lifted(&lost);
        let down = self.lifting(with, &lifted);
        if !lifted.is_empty() {
            legs.push(leg(name, "43", with, lifted, false));
        }
        let stays = lost.is_empty();
        if !stays {
            legs.push(leg(name, "32", down, lost.clone(), !legs.is_empty()));
        }
        let has_pregrasp = self.state_keys.has_pregrasp(gripper, handle);
        if let Some(hand) = &hand {
            let target = self.opening(hand.number, hand.open).into_iter().chain(lost).collect();
            legs.push(leg(name, "2o", hand.moving_full, target, true));
        }
        // Where another hand keeps the object, this one only backs off: random motion belongs to the loop of that state.
        if has_pregrasp {
            let beside = self.beside(change, hand.as_ref());
            let target = vec![self.constraint(ConstraintKind::Pregrasp { gripper, handle })];
            legs.push(leg(name, "21", beside, target, true));
            if let Some(hand) = hand.as_ref().filter(|hand| !hand.travels_open) {
                let mut target = self.opening(hand.number, self.state_keys.travel(hand.number));
                target.push(self.constraint(ConstraintKind::Pregrasp { gripper, handle }));
                legs.push(leg(name, "1c", hand.moving_empty, target, true));
            }
        } else if stays {
            legs.push(leg(name, "21", without, Vec::new(), false));
        }
        legs
    }

    /// The state in which a hand goes to a grasp or backs off: open where it has opened, on a line where it has to be.
    fn beside(&mut self, Change { gripper, handle, without, .. }: Change, opened: Option<&PassingStates>) -> StateId {
        if !self.state_keys.has_line(gripper, handle) {
            return opened.map_or(without, |hand| hand.beside);
        }
        let open = opened.filter(|hand| !hand.travels_open).map(|hand| hand.number);
        let fingers = Fingers::OnLine { open, gripper, handle };
        let key = StateKey::clone(&self.key(without));
        self.passing_state(StateKey { fingers, ..key })
    }

    /// What no longer holds once a grasp is made, fingers aside: where the object lies, doors at rest.
    fn lost(&self, change: Change) -> Vec<ConstraintId> {
        let is_finger = |&c: &ConstraintId| matches!(self.graph.constraint(c).kind, ConstraintKind::Finger { .. });
        self.difference(change.without, change.with).into_iter().filter(|c| !is_finger(c)).collect()
    }

    /// The fingers of a hand at an opening.
    fn opening(&mut self, hand: u32, opening: Opening) -> Vec<ConstraintId> {
        let count = self.state_keys.options.hands[hand as usize].fingers.len() as u32;
        (0..count).map(|finger| self.constraint(ConstraintKind::Finger { hand, finger, opening })).collect()
    }

    /// The states through which a hand with fingers passes when it makes or releases a grasp.
    fn passing_states(&mut self, change: Change) -> Option<PassingStates> {
        let (without, with) = (self.key(change.without), self.key(change.with));
        let number = self.state_keys.hand_of(change.gripper, &without.grasps)?;
        let Change { gripper, handle, .. } = change;
        let open = self.state_keys.beside(gripper, handle);
        let beside = match open {
            Opening::Ready { .. } => Fingers::Ready { hand: number, gripper, handle },
            _ => Fingers::Wide(number),
        };
        let travels_open = self.state_keys.travel(number) == open;
        let mut at = |key: &StateKey, fingers: Fingers| self.passing_state(StateKey { fingers, ..key.clone() });
        Some(PassingStates {
            number,
            open,
            travels_open,
            moving_full: at(&with, Fingers::Moving(number)),
            moving_empty: if travels_open { change.without } else { at(&without, Fingers::Moving(number)) },
            beside: if travels_open { change.without } else { at(&without, beside) },
        })
    }

    /// The state between where an object lies and its pre-placement: on a line where the problem asks for that.
    fn lifting(&mut self, with: StateId, lifted: &[ConstraintId]) -> StateId {
        let line = lifted.iter().find_map(|&c| match self.graph.constraint(c).kind {
            ConstraintKind::Preplacement { object, on } => {
                self.state_keys.documents.lifts.contains_key(&(object, on)).then_some((object, on))
            }
            _ => None,
        });
        let Some((object, on)) = line else { return with };
        let key = StateKey::clone(&self.key(with));
        self.passing_state(StateKey { fingers: Fingers::Lifting { object, on }, ..key })
    }

    /// The pre-placements of those of the constraints that are placements.
    fn lifted(&mut self, constraints: &[ConstraintId]) -> Vec<ConstraintId> {
        if self.state_keys.options.preplacement_distance <= 0.0 {
            return Vec::new();
        }
        let placed = constraints.iter().filter_map(|&c| match self.graph.constraint(c).kind {
            ConstraintKind::Placement { object, on } => Some(ConstraintKind::Preplacement { object, on }),
            _ => None,
        });
        let placed: Vec<_> = placed.collect();
        placed.into_iter().map(|kind| self.constraint(kind)).collect()
    }
}
