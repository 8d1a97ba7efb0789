//! States: "gripper A holds handle B, object C stands on surface D".

use super::ConstraintId;
use crate::robot::indices::{GripperIndex, HandleIndex, JointIndex};

/// Index of a state in [`crate::graph::constraint_graph::ConstraintGraph::states`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct StateId(pub u32);

impl StateId {
    /// The index, for slices.
    #[must_use]
    pub fn at(self) -> usize {
        self.0 as usize
    }
}

/// What the fingers of hands do in a state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Fingers {
    /// All hold still: of empty hands as they travel, of others closed on what they hold.
    #[default]
    Still,
    /// Those of this hand open or close; the others hold still.
    Moving(u32),
    /// Those of all hands may move: where a path begins or ends with hands open as far as they like.
    Free,
    /// Those of this hand hold still wide open, though it holds nothing; the others as ever.
    Wide(u32),
    /// Those of this hand hold still as wide open as a grasp needs, though it holds nothing; the others as ever.
    Ready {
        /// The hand.
        hand: u32,
        /// Who is to hold.
        gripper: GripperIndex,
        /// What is to be held.
        handle: HandleIndex,
    },
    /// They hold still, and the gripper goes to the handle or backs off from it along a line.
    OnLine {
        /// The hand that is open as beside what it is to grasp; `None` where all are as ever.
        open: Option<u32>,
        /// Who is to hold.
        gripper: GripperIndex,
        /// What is to be held.
        handle: HandleIndex,
    },
    /// They hold still, and an object that a hand holds leaves its support or comes back to it along a line.
    Lifting {
        /// The object.
        object: u32,
        /// The body whose supports carry it.
        on: Option<JointIndex>,
    },
}

/// A manifold of configurations, foliated by the complements of its constraints.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// `g1 grasps h1 : g2 grasps h2`, or `free`; in front the name of the problem's own state, where it has such (instead of
    /// `free`), behind it which objects lie on bodies that move (`lid on box`).
    pub name: String,
    /// Number of the problem's own state that this one is a case of; `None` where the problem has none.
    pub written: Option<u32>,
    /// Who holds what, in the order of the problem's grippers.
    pub grasps: Vec<(GripperIndex, HandleIndex)>,
    /// What the fingers of hands do in it. Where they do not all hold still as ever, the state is only passed through: no node lies in
    /// it, and no transition leaves it.
    pub fingers: Fingers,
    /// What holds everywhere in the state (f_S).
    pub manifold: Vec<ConstraintId>,
    /// Those of them with right-hand sides: a leaf of the state gives each a value (g_T).
    pub foliation: Vec<ConstraintId>,
    /// States are tried in falling order of priority when the state of a configuration is asked: more grasps first, because
    /// a configuration that grasps may also satisfy the weaker state without the grasp (HPP's node selector). Among equals
    /// the first counts: the problem's own states in the order in which they are written.
    pub priority: u32,
}

impl State {
    /// Whether only legs of transitions lie in it, and motions of fingers at the ends of paths.
    #[must_use]
    pub fn is_passed_through(&self) -> bool {
        self.fingers != Fingers::Still
    }

    /// About how many bytes it takes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let ids = self.manifold.len() + self.foliation.len();
        (size_of::<Self>() + self.name.len() + size_of_val(self.grasps.as_slice()) + ids * size_of::<ConstraintId>())
            as u64
    }
}
