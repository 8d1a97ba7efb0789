//! Constraints as data: what they relate and which of their rows are zero, parameters or inequalities.
//!
//! Right-hand sides are never stored here: a row that depends on one names the *slot* of the argument list in which a
//! solve finds it. Every argument is a pose (a locked joint's value travels as the x of a translation).

use crate::constraint::{
    CentreOfMass, CentreOfMassBetween, Custom, Distance, Locked, LockedValue, Placement, Reference, Region,
    RelativePose, Row, Tilt,
};
use crate::robot::indices::JointIndex;
/// One constraint of a state or a transition.
#[derive(Clone, Debug, PartialEq)]
pub enum Constraint {
    /// Two frames in a relative pose: grasps, pre-grasps, feet on the ground, anything rigid.
    RelativePose(RelativePose),
    /// An object lies on a support (the five rows P_f = 0); which polygons touch is found at each evaluation.
    Placement(Placement),
    /// The rows P̄_f equal the leaf parameter in the slot; the parameter says which polygons touch.
    PlacementComplement(Placement, usize),
    /// Both: the object lies on the polygon and at the place that the leaf parameter in the slot says.
    PlacementHold(Placement, usize),
    /// A joint keeps its value.
    Locked(Locked),
    /// Where the centre of mass is in a frame: fixed, frozen, or inside half-spaces.
    CentreOfMass(CentreOfMass),
    /// The centre of mass is over the line between two feet.
    CentreOfMassBetween(CentreOfMassBetween),
    /// Two points at a distance.
    Distance(Distance),
    /// Two axes within an angle.
    Tilt(Tilt),
    /// A point within a box.
    Region(Region),
    /// A function of a host's own.
    Custom(Custom),
}

impl Constraint {
    /// Whether some of its rows are parameters: it foliates the states it holds in.
    #[must_use]
    pub fn foliates(&self) -> bool {
        match self {
            Self::RelativePose(pose) => pose.rows.contains(&Some(Row::Parameter)),
            Self::CentreOfMass(balance) => balance.rows.iter().any(|plane| plane.row == Row::Parameter),
            Self::Placement(_)
            | Self::CentreOfMassBetween(_)
            | Self::Distance(_)
            | Self::Tilt(_)
            | Self::Region(_)
            | Self::Custom(_) => false,
            Self::PlacementComplement(..) | Self::PlacementHold(..) => true,
            Self::Locked(locked) => matches!(locked.value, LockedValue::Argument(_)),
        }
    }

    /// The bodies that it depends on; `None` for the world.
    #[must_use]
    pub fn bodies(&self) -> Vec<Option<JointIndex>> {
        match self {
            Self::RelativePose(pose) => vec![pose.a.joint, pose.b.joint],
            Self::Placement(placement)
            | Self::PlacementComplement(placement, _)
            | Self::PlacementHold(placement, _) => {
                placement.object.iter().chain(&placement.supports).map(|polygon| polygon.frame.joint).collect()
            }
            Self::Locked(locked) => vec![Some(locked.joint)],
            Self::CentreOfMass(balance) => {
                balance.masses.bodies().iter().map(|mass| mass.body).chain([balance.frame.joint]).collect()
            }
            Self::CentreOfMassBetween(balance) => {
                let feet = [balance.first.joint, balance.second.joint];
                balance.masses.bodies().iter().map(|mass| mass.body).chain(feet).collect()
            }
            Self::Distance(apart) => vec![apart.a.joint, apart.b.joint],
            Self::Tilt(tilt) => vec![tilt.a.joint, tilt.b.joint],
            Self::Region(region) => vec![region.a.joint, region.b.joint],
            Self::Custom(own) => own.0.frames().iter().map(|frame| frame.joint).collect(),
        }
    }

    /// The same with its parameter rows measured against the argument in `slot`; unchanged where it has none.
    #[must_use]
    pub fn at_slot(&self, slot: usize) -> Self {
        if !self.foliates() {
            return self.clone();
        }
        match self.clone() {
            Self::RelativePose(pose) => {
                Self::RelativePose(RelativePose { reference: Reference::Argument(slot), ..pose })
            }
            Self::PlacementComplement(placement, _) => Self::PlacementComplement(placement, slot),
            Self::PlacementHold(placement, _) => Self::PlacementHold(placement, slot),
            Self::Locked(locked) => Self::Locked(Locked { value: LockedValue::Argument(slot), ..locked }),
            Self::CentreOfMass(balance) => {
                Self::CentreOfMass(CentreOfMass { reference: Reference::Argument(slot), ..balance })
            }
            other => other,
        }
    }

    /// Only the rows that are no parameters: what holds on every leaf; `None` where nothing is left.
    #[must_use]
    pub fn without_parameters(&self) -> Option<Self> {
        match self {
            Self::RelativePose(pose) => {
                let rows = pose.rows.map(|row| row.filter(|&row| row != Row::Parameter));
                let reference = match pose.reference {
                    Reference::Argument(_) => Reference::Identity,
                    kept => kept,
                };
                let left = RelativePose { rows, reference, ..*pose };
                (left.dimension() > 0).then_some(Self::RelativePose(left))
            }
            Self::PlacementComplement(..) => None,
            Self::PlacementHold(placement, _) => Some(Self::Placement(placement.clone())),
            Self::Locked(locked) => matches!(locked.value, LockedValue::Fixed(_)).then_some(Self::Locked(*locked)),
            Self::CentreOfMass(balance) => {
                let rows: Vec<_> = balance.rows.iter().filter(|plane| plane.row != Row::Parameter).copied().collect();
                let left = CentreOfMass { rows, reference: Reference::Identity, ..balance.clone() };
                (!left.rows.is_empty()).then_some(Self::CentreOfMass(left))
            }
            other @ (Self::Placement(_)
            | Self::CentreOfMassBetween(_)
            | Self::Distance(_)
            | Self::Tilt(_)
            | Self::Region(_)
            | Self::Custom(_)) => Some(other.clone()),
        }
    }
}
