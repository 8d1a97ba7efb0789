//! One step of forward kinematics in lanes: from the pose of a parent to the pose of a body.
//!
//! What never changes is resolved when a step is made: mountings by quarter turns become exchanges of columns, turns about an
//! axis of the frame become plane rotations, followers become coordinates of their leader. A step can also go backwards, from
//! the moved body to the one on which its joint is mounted. Steps are apart from `lane_forward`, because constraint programs
//! make their own tables of them.

use crate::kinematics::joint_table::JointCoordinates;
use crate::lanes::geometry::{Rotation, Transform, Vector3};
use crate::lanes::trigonometry::sin_cos;
use crate::lanes::vector::Lanes;
use foliate_components::robot::{Joint, JointType, Robot};
use glam::{DMat3, DVec3};

/// Rotations that differ from one with entries 0 and ±1 by no more than this are taken for it: URDF files write π/2 with ten
/// digits. Poses then differ from those of [`Kinematics`](crate::kinematics::forward::Kinematics) by as much per joint and metre.
const SNAP: f64 = 1e-10;

/// Rows per body: columns of the rotation, then the translation.
pub const POSE_ROWS: usize = 12;

/// Where a body's parent is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Parent {
    /// It is the world.
    World,
    /// It is the body of the step before, whose pose is in registers still.
    Previous,
    /// It is a body of this table.
    Body(usize),
    /// It is one whose pose every lane is given.
    Given(usize),
}

/// A rotation that never changes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mounting {
    /// Column k is column `from[k]` of the parent, turned around where `flipped[k]`.
    Exchange {
        from: [u8; 3],
        flipped: [bool; 3],
    },
    General(DMat3),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Moving {
    TurnX(JointCoordinates),
    TurnY(JointCoordinates),
    TurnZ(JointCoordinates),
    Turn(JointCoordinates, DVec3),
    Slide(JointCoordinates, DVec3),
    /// x, y, θ from this coordinate on.
    Planar(usize),
    /// Position and quaternion from this coordinate on.
    FreeFlyer(usize),
    /// Not at all: its pose in the parent is given for every lane, and there is no mounting.
    Placed(usize),
}

/// One body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LaneStep {
    pub(crate) parent: Parent,
    mounting: Mounting,
    translation: DVec3,
    moving: Moving,
    /// Whether it is the other way round: the step starts from the body that the joint moves and finds the one on which it is
    /// mounted, as on the way from a foot to the root.
    pub(crate) is_inverse: bool,
}

impl LaneStep {
    /// A body moved by its own joint.
    pub(crate) fn of_joint(robot: &Robot, joint: &Joint, parent: Parent) -> Self {
        let coordinates = JointCoordinates::of(robot, joint);
        let moving = match joint.motion {
            JointType::Revolute { axis } => Moving::turn(coordinates, axis),
            JointType::Prismatic { axis } => Moving::Slide(coordinates, axis),
            JointType::Planar => Moving::Planar(coordinates.q),
            JointType::FreeFlyer => Moving::FreeFlyer(coordinates.q),
        };
        let X_PJ = joint.parent_from_joint;
        let mounting = Mounting::of(DMat3::from_quat(X_PJ.rotation));
        Self { parent, mounting, translation: X_PJ.translation, moving, is_inverse: false }
    }

    /// The body on which a joint is mounted, found from the one that it moves: the joint is undone first. `None` for joints
    /// that move freely.
    pub(crate) fn back_over(robot: &Robot, joint: &Joint, moved: Parent) -> Option<Self> {
        let step = Self::of_joint(robot, joint, moved);
        Some(Self { moving: step.moving.undone()?, is_inverse: true, ..step })
    }

    /// A body whose pose in its parent every lane is given.
    pub(crate) fn placed(parent: Parent, given: usize) -> Self {
        let mounting = Mounting::of(DMat3::IDENTITY);
        Self { parent, mounting, translation: DVec3::ZERO, moving: Moving::Placed(given), is_inverse: false }
    }

    /// The coordinates that move it.
    pub(crate) fn coordinates(&self) -> std::ops::Range<usize> {
        match self.moving {
            Moving::TurnX(c) | Moving::TurnY(c) | Moving::TurnZ(c) | Moving::Turn(c, _) | Moving::Slide(c, _) => {
                c.q..c.q + 1
            }
            Moving::Planar(q) => q..q + 3,
            Moving::FreeFlyer(q) => q..q + 7,
            Moving::Placed(_) => 0..0,
        }
    }

    #[inline(always)]
    pub(crate) fn mounted_on_world<V: Lanes>(&self, isa: V::Isa) -> Transform<V> {
        let rotation = match &self.mounting {
            Mounting::General(r) => Rotation::splat(isa, r),
            Mounting::Exchange { from, flipped } => {
                let column = |k: usize| {
                    let axis = DVec3::AXES[usize::from(from[k]).min(2)];
                    if flipped[k] { -axis } else { axis }
                };
                Rotation::splat(isa, &DMat3::from_cols(column(0), column(1), column(2)))
            }
        };
        Transform { rotation, translation: Vector3::splat(isa, self.translation) }
    }

    /// The joint's frame at zero.
    #[inline(always)]
    pub(crate) fn mounted<V: Lanes>(&self, isa: V::Isa, parent: &Transform<V>) -> Transform<V> {
        let [a, b, c] = parent.rotation.columns;
        let mut translation = parent.translation;
        // Most mountings move along one axis or two.
        let DVec3 { x, y, z } = self.translation;
        if x != 0.0 {
            translation = a.scaled_plus(V::constant(isa, x), translation);
        }
        if y != 0.0 {
            translation = b.scaled_plus(V::constant(isa, y), translation);
        }
        if z != 0.0 {
            translation = c.scaled_plus(V::constant(isa, z), translation);
        }
        let columns = match &self.mounting {
            Mounting::General(r) => parent.rotation.times(&Rotation::splat(isa, r)).columns,
            Mounting::Exchange { from, flipped } => {
                let mut columns = match from {
                    [0, 1, 2] => [a, b, c],
                    [0, 2, 1] => [a, c, b],
                    [1, 0, 2] => [b, a, c],
                    [1, 2, 0] => [b, c, a],
                    [2, 0, 1] => [c, a, b],
                    _ => [c, b, a],
                };
                if flipped[0] {
                    columns[0] = columns[0].negated();
                }
                if flipped[1] {
                    columns[1] = columns[1].negated();
                }
                if flipped[2] {
                    columns[2] = columns[2].negated();
                }
                columns
            }
        };
        Transform { rotation: Rotation { columns }, translation }
    }

    /// The joint's frame where its coordinates have moved it.
    #[inline(always)]
    pub(crate) fn moved<V: Lanes>(
        &self,
        isa: V::Isa,
        at: Transform<V>,
        q: &[V::Row],
        given: &[V::Row],
    ) -> Transform<V> {
        let Transform { rotation, translation } = at;
        let [x, y, z] = rotation.columns;
        let columns = match self.moving {
            Moving::TurnX(coordinate) => {
                let (s, c) = sin_cos(coordinate.value_in_lanes::<V>(isa, q));
                let (y, z) = turned(s, c, y, z);
                [x, y, z]
            }
            Moving::TurnY(coordinate) => {
                let (s, c) = sin_cos(coordinate.value_in_lanes::<V>(isa, q));
                let (z, x) = turned(s, c, z, x);
                [x, y, z]
            }
            Moving::TurnZ(coordinate) => {
                let (s, c) = sin_cos(coordinate.value_in_lanes::<V>(isa, q));
                let (x, y) = turned(s, c, x, y);
                [x, y, z]
            }
            Moving::Turn(coordinate, axis) => {
                // The quaternion of half the angle about the axis.
                let half = coordinate.value_in_lanes::<V>(isa, q) * V::constant(isa, 0.5);
                let (s, c) = sin_cos(half);
                let axis = Vector3::splat(isa, axis).scaled(s);
                rotation.times(&Rotation::from_quaternion(axis.x, axis.y, axis.z, c)).columns
            }
            Moving::Slide(coordinate, axis) => {
                let along = rotation.turn(Vector3::splat(isa, axis));
                let translation = along.scaled_plus(coordinate.value_in_lanes::<V>(isa, q), translation);
                return Transform { rotation, translation };
            }
            Moving::Planar(i) => {
                let (dx, dy) = (V::load(isa, &q[i]), V::load(isa, &q[i + 1]));
                let translation = x.scaled_plus(dx, y.scaled_plus(dy, translation));
                let (s, c) = sin_cos(V::load(isa, &q[i + 2]));
                let (x, y) = turned(s, c, x, y);
                return Transform { rotation: Rotation { columns: [x, y, z] }, translation };
            }
            Moving::FreeFlyer(i) => {
                let own = Transform {
                    translation: Vector3::load(isa, &q[i..]),
                    rotation: Rotation::from_quaternion(
                        V::load(isa, &q[i + 3]),
                        V::load(isa, &q[i + 4]),
                        V::load(isa, &q[i + 5]),
                        V::load(isa, &q[i + 6]),
                    ),
                };
                return at.times(&own);
            }
            Moving::Placed(slot) => return at.times(&Transform::load(isa, &given[slot * POSE_ROWS..])),
        };
        Transform { rotation: Rotation { columns }, translation }
    }
}

impl LaneStep {
    /// The body on which the joint is mounted, from the joint's frame at zero.
    #[inline(always)]
    pub(crate) fn unmounted<V: Lanes>(&self, isa: V::Isa, at: &Transform<V>) -> Transform<V> {
        let [x, y, z] = at.rotation.columns;
        let columns = match &self.mounting {
            Mounting::General(r) => at.rotation.times(&Rotation::splat(isa, &r.transpose())).columns,
            Mounting::Exchange { from, flipped } => {
                let x = if flipped[0] { x.negated() } else { x };
                let y = if flipped[1] { y.negated() } else { y };
                let z = if flipped[2] { z.negated() } else { z };
                match from {
                    [0, 1, 2] => [x, y, z],
                    [0, 2, 1] => [x, z, y],
                    [1, 0, 2] => [y, x, z],
                    [1, 2, 0] => [z, x, y],
                    [2, 0, 1] => [y, z, x],
                    _ => [z, y, x],
                }
            }
        };
        let rotation = Rotation { columns };
        let reach = rotation.turn(Vector3::splat(isa, self.translation));
        Transform { rotation, translation: at.translation.minus(reach) }
    }
}

/// Two axes turned about the third.
#[inline(always)]
fn turned<V: Lanes>(s: V, c: V, x: Vector3<V>, y: Vector3<V>) -> (Vector3<V>, Vector3<V>) {
    (x.scaled_plus(c, y.scaled(s)), x.scaled_from(s, y.scaled(c)))
}

impl JointCoordinates {
    fn negated(self) -> Self {
        Self { multiplier: -self.multiplier, offset: -self.offset, ..self }
    }

    #[inline(always)]
    fn value_in_lanes<V: Lanes>(self, isa: V::Isa, q: &[V::Row]) -> V {
        V::load(isa, &q[self.q]).mul_add(V::constant(isa, self.multiplier), V::constant(isa, self.offset))
    }
}

impl Moving {
    /// The way back; `None` where more than one coordinate moves.
    fn undone(self) -> Option<Self> {
        Some(match self {
            Self::TurnX(coordinate) => Self::TurnX(coordinate.negated()),
            Self::TurnY(coordinate) => Self::TurnY(coordinate.negated()),
            Self::TurnZ(coordinate) => Self::TurnZ(coordinate.negated()),
            Self::Turn(coordinate, axis) => Self::Turn(coordinate.negated(), axis),
            Self::Slide(coordinate, axis) => Self::Slide(coordinate.negated(), axis),
            Self::Planar(_) | Self::FreeFlyer(_) | Self::Placed(_) => return None,
        })
    }

    /// A turn about a unit axis; one about an axis of the frame is known as such.
    fn turn(coordinate: JointCoordinates, axis: DVec3) -> Self {
        let along = |k: usize, own: DVec3| {
            let sign = if axis[k] < 0.0 { -1.0 } else { 1.0 };
            let near = (axis - own * sign).abs().max_element() <= SNAP;
            let JointCoordinates { multiplier, offset, .. } = coordinate;
            near.then_some(JointCoordinates { multiplier: sign * multiplier, offset: sign * offset, ..coordinate })
        };
        if let Some(about) = along(0, DVec3::X) {
            Self::TurnX(about)
        } else if let Some(about) = along(1, DVec3::Y) {
            Self::TurnY(about)
        } else if let Some(about) = along(2, DVec3::Z) {
            Self::TurnZ(about)
        } else {
            Self::Turn(coordinate, axis)
        }
    }
}

impl Mounting {
    fn of(r: DMat3) -> Self {
        let (mut from, mut flipped) = ([0; 3], [false; 3]);
        for (k, column) in [r.x_axis, r.y_axis, r.z_axis].into_iter().enumerate() {
            let along = (0..3).find(|&i| (column.abs() - DVec3::AXES[i]).abs().max_element() <= SNAP);
            let Some(along) = along else { return Self::General(r) };
            from[k] = along as u8;
            flipped[k] = column[along] < 0.0;
        }
        Self::Exchange { from, flipped }
    }
}
