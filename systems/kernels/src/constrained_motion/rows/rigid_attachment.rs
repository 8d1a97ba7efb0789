//! Eliminated objects as templates: which object follows which carrier, and where in a solve's arguments its pose is found.

use crate::constraints::placement;
use crate::kinematics::RigidAttachment;
use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Frame, Placement, Reference, RelativePose};
use foliate_components::robot::JointIndex;

/// An object that follows a carrier, before the arguments of a solve are known.
#[derive(Clone, Debug, PartialEq)]
pub struct AttachmentTemplate {
    /// Free-flyer root of the object.
    pub object: JointIndex,
    /// Body that carries it; `None` for the world.
    pub carrier: Option<JointIndex>,
    /// Where its pose in the carrier comes from.
    pub relation: Relation,
}

/// Where the pose X_CO of a carried object (its root joint's frame) in its carrier's joint frame comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Relation {
    /// It never changes.
    Fixed(Pose),
    /// It is the argument in that slot, bit for bit.
    Argument(usize),
    /// X_CO = X_CA · argument · X_BO: the argument is the pose of a frame B on the object in a frame A on the carrier.
    Between {
        /// Frame A in the carrier.
        X_CA: Pose,
        /// Slot of X_AB.
        slot: usize,
        /// The object's root in frame B.
        X_BO: Pose,
    },
    /// X_CO = X_CB · argument⁻¹ · X_AO: as `Between`, with A on the object and B on the carrier.
    Reversed {
        /// Frame B in the carrier.
        X_CB: Pose,
        /// Slot of X_AB.
        slot: usize,
        /// The object's root in frame A.
        X_AO: Pose,
    },
    /// It lies on a support as the argument in that slot says (a parameter of the placement's complement).
    Hold {
        /// The placement; its supports are all on the carrier.
        placement: Placement,
        /// Slot of the parameter.
        slot: usize,
    },
}

impl AttachmentTemplate {
    /// An object whose pose in the carrier's joint frame never changes.
    #[must_use]
    pub fn fixed(object: JointIndex, carrier: Option<JointIndex>, X_CO: Pose) -> Self {
        Self { object, carrier, relation: Relation::Fixed(X_CO) }
    }

    /// An object whose pose in the carrier's joint frame is an argument.
    #[must_use]
    pub fn argument(object: JointIndex, carrier: Option<JointIndex>, slot: usize) -> Self {
        Self { object, carrier, relation: Relation::Argument(slot) }
    }

    /// The object that a rigid relation determines: frame `b`'s body where it is `object`, else frame `a`'s.
    pub(crate) fn of_rigid(rigid: &RelativePose, object: JointIndex) -> Self {
        let forward = rigid.b.joint == Some(object);
        let (near, far) = if forward { (&rigid.a, &rigid.b) } else { (&rigid.b, &rigid.a) };
        let (X_CN, X_FO) = (near.joint_from_frame, far.joint_from_frame.inverse());
        let relation = match (rigid.reference, forward) {
            (Reference::Identity, _) => Relation::Fixed(X_CN * X_FO),
            (Reference::Fixed(X_AB), true) => Relation::Fixed(X_CN * X_AB * X_FO),
            (Reference::Fixed(X_AB), false) => Relation::Fixed(X_CN * X_AB.inverse() * X_FO),
            (Reference::Argument(slot), true) => Relation::Between { X_CA: X_CN, slot, X_BO: X_FO },
            (Reference::Argument(slot), false) => Relation::Reversed { X_CB: X_CN, slot, X_AO: X_FO },
        };
        Self { object, carrier: near.joint, relation }
    }

    /// The same relation as a constraint with rows: for an object that something else carries already.
    pub(crate) fn as_constraint(&self) -> Constraint {
        let carrier = |X: Pose| Frame { joint: self.carrier, joint_from_frame: X };
        let object = |X_FO: Pose| Frame { joint: Some(self.object), joint_from_frame: X_FO.inverse() };
        let identity = Pose::identity;
        let rigid = |a, b, reference| Constraint::RelativePose(RelativePose::rigid(a, b, reference));
        match &self.relation {
            Relation::Fixed(X_CO) => rigid(carrier(identity()), object(identity()), Reference::Fixed(*X_CO)),
            Relation::Argument(slot) => rigid(carrier(identity()), object(identity()), Reference::Argument(*slot)),
            Relation::Between { X_CA, slot, X_BO } => rigid(carrier(*X_CA), object(*X_BO), Reference::Argument(*slot)),
            Relation::Reversed { X_CB, slot, X_AO } => rigid(object(*X_AO), carrier(*X_CB), Reference::Argument(*slot)),
            Relation::Hold { placement, slot } => Constraint::PlacementHold(placement.clone(), *slot),
        }
    }

    /// The attachment with its pose taken from the arguments; `None` where an argument is missing or names polygons that the
    /// placement does not have.
    #[must_use]
    pub fn resolve(&self, arguments: &[Pose]) -> Option<RigidAttachment> {
        let X_CO = match &self.relation {
            Relation::Fixed(X_CO) => *X_CO,
            Relation::Argument(slot) => *arguments.get(*slot)?,
            Relation::Between { X_CA, slot, X_BO } => *X_CA * *arguments.get(*slot)? * *X_BO,
            Relation::Reversed { X_CB, slot, X_AO } => *X_CB * arguments.get(*slot)?.inverse() * *X_AO,
            Relation::Hold { placement, slot } => placement::hold(placement, arguments.get(*slot)?)?.1,
        };
        Some(RigidAttachment { object: self.object, carrier: self.carrier, X_CO })
    }

    /// The argument that reproduces where the object is now, or `None` where the relation takes none.
    ///
    /// # Panics
    /// If `X_WJ` is too short.
    #[must_use]
    pub fn parameter(&self, X_WJ: &[Pose]) -> Option<Pose> {
        let X_WC = self.carrier.map_or_else(Pose::identity, |carrier| X_WJ[carrier.at()]);
        let X_WO = X_WJ[self.object.at()];
        match &self.relation {
            Relation::Fixed(_) => None,
            Relation::Argument(_) => Some(X_WC.inverse() * X_WO),
            Relation::Between { X_CA, X_BO, .. } => Some((X_WC * *X_CA).inverse() * (X_WO * X_BO.inverse())),
            Relation::Reversed { X_CB, X_AO, .. } => Some((X_WO * X_AO.inverse()).inverse() * (X_WC * *X_CB)),
            Relation::Hold { placement, .. } => Some(placement::parameter(placement, X_WJ)),
        }
    }

    /// The argument slot that the relation reads.
    pub(crate) fn slot(&self) -> Option<usize> {
        match self.relation {
            Relation::Fixed(_) => None,
            Relation::Argument(slot)
            | Relation::Between { slot, .. }
            | Relation::Reversed { slot, .. }
            | Relation::Hold { slot, .. } => Some(slot),
        }
    }
}
