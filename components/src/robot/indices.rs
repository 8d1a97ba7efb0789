//! Indices of what a robot is made of, one type each, so that none is taken for another.

/// Index of a part in [`Robot::parts`](crate::robot::hybrid_robot::Robot::parts).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PartIndex(pub u32);
/// Index of a moving joint in [`Robot::joints`](crate::robot::hybrid_robot::Robot::joints). A joint also names the rigid *body* that it moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JointIndex(pub u32);
/// Index of a link in [`Robot::links`](crate::robot::hybrid_robot::Robot::links).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LinkIndex(pub u32);
/// Index of a collision shape in [`Robot::shapes`](crate::robot::hybrid_robot::Robot::shapes).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ShapeIndex(pub u32);
/// Index of a gripper in [`Robot::grippers`](crate::robot::hybrid_robot::Robot::grippers).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GripperIndex(pub u32);
/// Index of a handle in [`Robot::handles`](crate::robot::hybrid_robot::Robot::handles).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct HandleIndex(pub u32);
/// Index of a contact surface in [`Robot::surfaces`](crate::robot::hybrid_robot::Robot::surfaces).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SurfaceIndex(pub u32);

macro_rules! usable_as_index {
    ($($index:ident),*) => {$(
        impl $index {
            /// The index as a `usize`, for slices.
            #[must_use]
            pub fn at(self) -> usize {
                self.0 as usize
            }
        }
    )*};
}
usable_as_index!(PartIndex, JointIndex, LinkIndex, ShapeIndex, GripperIndex, HandleIndex, SurfaceIndex);
