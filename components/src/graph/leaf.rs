//! Leaves: interned right-hand sides, compared by id.
//!
//! A leaf of a state gives each of the state's foliating constraints a value. Values are interned as *parameters*: two
//! nodes lie on the same leaf if and only if their parameter ids are equal. A node that is reached by aiming at a leaf
//! adopts its ids and with them the exact numbers, so nothing drifts.

use crate::Pose;
use crate::graph::{ConstraintId, StateId};
use crate::robot::indices::JointIndex;
use std::collections::HashMap;

/// Index of a leaf in [`LeafIndex`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct LeafId(pub u32);

/// Index of an interned parameter in [`LeafIndex`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct ParameterId(pub u32);

impl LeafId {
    /// The index, for slices.
    #[must_use]
    pub fn at(self) -> usize {
        self.0 as usize
    }
}

impl ParameterId {
    /// The index, for slices.
    #[must_use]
    pub fn at(self) -> usize {
        self.0 as usize
    }
}

/// The value of one foliating constraint.
///
/// | constraint | `carrier` | `value` |
/// |---|---|---|
/// | placement, rest | the body that carries the object | pose of the object's root joint frame in the carrier's joint frame |
/// | grasp by a handle on the object's root | the gripper's body | the same |
/// | grasp of a handle on any other body | the gripper's body | pose of the handle in the gripper, its free rows at zero |
/// | resting joint | – | a translation whose x is the joint's value, radians or metres |
/// | the problem's own | – | the argument that its parameter rows are measured against |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Whose complement this is a value of.
    pub constraint: ConstraintId,
    /// The body to which an object is attached; `None` for the world, and where there is no object.
    pub carrier: Option<JointIndex>,
    /// The value; lengths in metres.
    pub value: Pose,
}

/// A leaf: a state and one parameter for each of its foliating constraints, in the order of `State::foliation`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Leaf {
    /// The state whose leaf it is.
    pub state: StateId,
    /// One id per foliating constraint.
    pub parameters: Box<[ParameterId]>,
}

/// The leaves and parameters that a search has met, by id.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Resource))]
pub struct LeafIndex {
    parameters: Vec<Parameter>,
    leaves: Vec<Leaf>,
    by_value: HashMap<Leaf, LeafId>,
}

impl LeafIndex {
    /// Adds a parameter that is new by construction (a placement that a projection has just found).
    pub fn add_parameter(&mut self, parameter: Parameter) -> ParameterId {
        self.parameters.push(parameter);
        ParameterId((self.parameters.len() - 1) as u32)
    }

    /// The parameter of the same constraint and carrier within `tolerance` (metres and radians), or a new one.
    ///
    /// For configurations that come from outside (start, goals), so that an object which need not move stands on one
    /// and the same leaf in both. Linear in the parameters met so far: not for the search itself.
    pub fn intern_parameter(&mut self, parameter: Parameter, tolerance: f64) -> ParameterId {
        let near = |other: &Parameter| {
            let (a, b) = (&parameter.value, &other.value);
            other.constraint == parameter.constraint
                && other.carrier == parameter.carrier
                && a.translation.distance(b.translation) <= tolerance
                && a.rotation.angle_between(b.rotation) <= tolerance.max(1e-7)
        };
        match self.parameters.iter().position(near) {
            Some(index) => ParameterId(index as u32),
            None => self.add_parameter(parameter),
        }
    }

    /// An index that knows the same parameters by the same ids, and no leaves.
    #[must_use]
    pub fn without_leaves(&self) -> Self {
        Self { parameters: self.parameters.clone(), ..Self::default() }
    }

    /// The id of a leaf, new if it was never met.
    pub fn intern(&mut self, leaf: Leaf) -> LeafId {
        if let Some(&id) = self.by_value.get(&leaf) {
            return id;
        }
        let id = LeafId(self.leaves.len() as u32);
        self.leaves.push(leaf.clone());
        self.by_value.insert(leaf, id);
        id
    }

    /// The leaf of that id.
    ///
    /// # Panics
    /// If the id is of another index.
    #[must_use]
    pub fn leaf(&self, id: LeafId) -> &Leaf {
        &self.leaves[id.at()]
    }

    /// The parameter of that id.
    ///
    /// # Panics
    /// If the id is of another index.
    #[must_use]
    pub fn parameter(&self, id: ParameterId) -> &Parameter {
        &self.parameters[id.at()]
    }

    /// All leaves, by id.
    #[must_use]
    pub fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }

    /// All parameters, by id.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
}
