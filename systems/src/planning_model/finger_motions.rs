//! Motions of fingers at the ends of a path: a start or a goal may have hands open as far as it likes, and the states of the graph have
//! them at one opening.

use crate::planning_model::model::Model;
use crate::planning_model::state_classification::Feasible;
use crate::settings::SearchSettings;
use foliate_components::graph::leaf::{Leaf, LeafIndex};
use foliate_components::graph::{ConstraintId, ConstraintKind, Fingers, StateId};
use foliate_components::infeasibility::Infeasibility;
use foliate_kernels::collision::{CertificateSettings, CollisionScratch, Contact, PolylineVerdict, certify_polyline};

/// Fingers move, and nothing else.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FingerMotion {
    /// The state that is passed through.
    pub state: StateId,
    /// Two whole configurations, end to end.
    pub knots: Vec<f64>,
}

impl Model {
    /// The coordinates of the fingers that move in a state.
    pub fn moving_fingers(&self, fingers: Fingers) -> impl Iterator<Item = usize> + '_ {
        let all = 0..self.problem.graph.hands.len() as u32;
        let moves = move |hand: &u32| match fingers {
            Fingers::Still
            | Fingers::Wide(_)
            | Fingers::Ready { .. }
            | Fingers::OnLine { .. }
            | Fingers::Lifting { .. } => false,
            Fingers::Moving(moving) => moving == *hand,
            Fingers::Free => true,
        };
        all.filter(moves).flat_map(|hand| self.finger_coordinates(hand))
    }

    /// Puts the fingers of a hand where some constraints have them.
    pub(crate) fn put_fingers(&self, hand: u32, at: &[ConstraintId], q: &mut [f64]) {
        for &constraint in at {
            if let ConstraintKind::Finger { hand: of, finger, opening } = self.graph.constraint(constraint).kind
                && of == hand
                && let Some(value) = self.finger_value(hand, finger, opening)
                && let Some(i) = self.finger_coordinates(hand).nth(finger as usize)
            {
                q[i] = value;
            }
        }
    }

    /// A configuration with the fingers of another one.
    pub(crate) fn with_fingers_of(&self, q: &[f64], other: &[f64]) -> Vec<f64> {
        let mut q = q.to_vec();
        self.moving_fingers(Fingers::Free).for_each(|i| q[i] = other[i]);
        q
    }

    /// The motion that leads the fingers of a root from where they are given to where its state has them; `None` where they are there.
    /// None too where the graph lacks the state that is passed through, because it was built by hand.
    pub(crate) fn finger_motion(&self, root: &Feasible) -> Option<FingerMotion> {
        let given = root.given.as_ref()?;
        let of = self.graph.state(root.state);
        let found = self.graph.states.iter().position(|s| {
            let same = (&s.grasps, &s.foliation, s.written) == (&of.grasps, &of.foliation, of.written);
            same && s.fingers == Fingers::Free
        });
        Some(FingerMotion { state: StateId(found? as u32), knots: [&**given, &root.q].concat() })
    }

    /// Checks that the fingers of a root can move to where its state has them.
    ///
    /// # Errors
    /// The pair of shapes that is in the way.
    pub(crate) fn check_finger_motion(
        &self,
        settings: &SearchSettings,
        root: &Feasible,
        scratch: &mut CollisionScratch,
    ) -> Result<(), Infeasibility> {
        if root.given.is_none() {
            return Ok(());
        }
        let Some((motion, along)) = self.finger_motion(root).zip(self.graph.loop_of(root.state)) else {
            return Err(Infeasibility::FingersBlocked { by: None });
        };
        let mut leaves = LeafIndex::default();
        let parameters = root.parameters.iter().map(|p| leaves.add_parameter(*p)).collect();
        let leaf = Leaf { state: motion.state, parameters };
        let rigid_attachments = self.attachments_of_leaf(&leaf, &leaves);
        let pairs = self.pairs(along, motion.state, &rigid_attachments);
        let certificate = CertificateSettings {
            clearance_guard: settings.clearance_guard,
            all_or_nothing: true,
            start_is_free: true,
            ..CertificateSettings::default()
        };
        let (scene, kinematics) = (&self.collision, &self.kinematics);
        match certify_polyline(scene, kinematics, &rigid_attachments, &motion.knots, pairs, &certificate, scratch) {
            PolylineVerdict::Free { .. } => Ok(()),
            PolylineVerdict::FreeUntil { blocked_by, .. } => {
                let shapes = &self.problem.robot.shapes;
                let names = |contact: Contact| {
                    let (a, b) = self.pair_shapes(contact.pair);
                    (shapes[a.at()].name.clone(), shapes[b.at()].name.clone())
                };
                Err(Infeasibility::FingersBlocked { by: blocked_by.map(names) })
            }
        }
    }
}
