//! Motions of fingers at the ends of a path: a start or a goal may have hands open as far as it likes, and the states of the graph have
//! them at one opening.

use crate::planning_model::model::Model;
use crate::planning_model::state_classification::Feasible;
use crate::settings::SearchSettings;
use foliate_components::graph::leaf::{Leaf, LeafIndex};
use foliate_components::graph::{Fingers, StateId};
use foliate_components::infeasibility::Infeasibility;
use foliate_kernels::collision::{CertificateSettings, CollisionScratch, PolylineVerdict, certify_polyline};

/// Some fingers move, and nothing else.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FingerMotion {
    /// The hand that moves them.
    pub hand: u32,
    /// The state that is passed through.
    pub state: StateId,
    /// Two whole configurations, end to end.
    pub knots: Vec<f64>,
}

impl Model {
    /// A configuration with the fingers of another one.
    pub(crate) fn with_fingers_of(&self, q: &[f64], other: &[f64]) -> Vec<f64> {
        let mut q = q.to_vec();
        let hands = 0..self.problem.graph.hands.len() as u32;
        hands.flat_map(|hand| self.finger_coordinates(hand)).for_each(|i| q[i] = other[i]);
        q
    }

    /// The motions that lead the fingers of a root from where they are given to where its state has them, hand by hand. `None` where the
    /// graph lacks a state that is passed through, because it was built by hand.
    pub(crate) fn finger_motions(&self, root: &Feasible) -> Option<Vec<FingerMotion>> {
        let Some(given) = &root.given else { return Some(Vec::new()) };
        let mut motions = Vec::new();
        let mut at = given.clone();
        for hand in 0..self.problem.graph.hands.len() as u32 {
            let mut next = at.clone();
            self.finger_coordinates(hand).for_each(|i| next[i] = root.q[i]);
            if next != at {
                let state = self.passing_state(root.state, hand)?;
                motions.push(FingerMotion { hand, state, knots: [&*at, &next].concat() });
                at = next;
            }
        }
        Some(motions)
    }

    /// The state that differs from another one in that the fingers of a hand may move.
    fn passing_state(&self, state: StateId, hand: u32) -> Option<StateId> {
        let of = self.graph.state(state);
        let found = self.graph.states.iter().position(|s| {
            let same = (&s.grasps, &s.foliation, s.written) == (&of.grasps, &of.foliation, of.written);
            same && s.fingers == Fingers::Moving(hand)
        });
        found.map(|index| StateId(index as u32))
    }

    /// Checks that the fingers of a root can move to where its state has them.
    ///
    /// # Errors
    /// The hand, and the pair of shapes that is in the way.
    pub(crate) fn check_finger_motions(
        &self,
        settings: &SearchSettings,
        root: &Feasible,
        scratch: &mut CollisionScratch,
    ) -> Result<(), Infeasibility> {
        let robot = &self.problem.robot;
        let blocked = |hand: u32, by: Option<(String, String)>| {
            let gripper = self.problem.graph.hands[hand as usize].grippers.first();
            let name = gripper.map_or_else(|| "?".into(), |gripper| robot.grippers[gripper.at()].name.clone());
            Infeasibility::FingersBlocked { gripper: name, by }
        };
        let motions = self.finger_motions(root).ok_or_else(|| blocked(0, None))?;
        let mut leaves = LeafIndex::default();
        let parameters: Box<[_]> = root.parameters.iter().map(|p| leaves.add_parameter(*p)).collect();
        for motion in motions {
            let leaf = Leaf { state: motion.state, parameters: parameters.clone() };
            let rigid_attachments = self.attachments_of_leaf(&leaf, &leaves);
            let Some(along) =
                self.graph.loop_of(root.state).or_else(|| self.graph.leaving(root.state).next().map(|t| t.0))
            else {
                continue;
            };
            let pairs = self.pairs(along, motion.state, &rigid_attachments);
            let certificate = CertificateSettings {
                clearance_guard: settings.clearance_guard,
                all_or_nothing: true,
                start_is_free: true,
                ..CertificateSettings::default()
            };
            let (scene, kinematics) = (&self.collision, &self.kinematics);
            let verdict =
                certify_polyline(scene, kinematics, &rigid_attachments, &motion.knots, pairs, &certificate, scratch);
            if let PolylineVerdict::FreeUntil { blocked_by, .. } = verdict {
                let names = |contact: foliate_kernels::collision::Contact| {
                    let (a, b) = self.pair_shapes(contact.pair);
                    (robot.shapes[a.at()].name.clone(), robot.shapes[b.at()].name.clone())
                };
                return Err(blocked(motion.hand, blocked_by.map(names)));
            }
        }
        Ok(())
    }
}
