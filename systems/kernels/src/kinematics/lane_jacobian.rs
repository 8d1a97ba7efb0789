//! Geometric Jacobians of many configurations at once.

use super::jacobian::Column;
use super::lane_forward::LaneKinematics;
use crate::kinematics::lane_steps::POSE_ROWS;
use crate::lanes::{F32Row, F64Row, Isa, Kernel, Lanes, Level, Transform, Vector3};
use foliate_components::Pose;
use foliate_components::robot::JointIndex;
use glam::DVec3;

/// An axis of a body's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Axis {
    /// One of the frame's own, times a factor (±1 where no leader is followed).
    Own(usize, f64),
    Any(DVec3),
}

/// Where the body of a column is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum At {
    World,
    /// Body of the table.
    Body(usize),
    /// One whose pose every lane is given.
    Given(usize),
}

/// A [`Column`] with its body looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LaneColumn {
    pub(crate) variable: usize,
    at: At,
    axis: Axis,
    turns: bool,
}

impl LaneColumn {
    /// `None` where `find` does not know the body.
    pub(crate) fn new(column: &Column, find: impl Fn(Option<JointIndex>) -> Option<At>) -> Option<Self> {
        let (variable, body, axis, turns) = match *column {
            Column::Turn { variable, body, axis } => (variable, Some(body), axis, true),
            Column::Slide { variable, frame, axis } => (variable, frame, axis, false),
        };
        let own = (0..3).find(|&k| axis == DVec3::AXES[k] * axis[k]).map(|k| Axis::Own(k, axis[k]));
        Some(Self { variable, at: find(body)?, axis: own.unwrap_or(Axis::Any(axis)), turns })
    }

    /// The velocity of a point at unit speed and the angular velocity, in the world; `None` for the latter where it is zero.
    #[inline(always)]
    pub(crate) fn twist<V: Lanes>(
        &self,
        isa: V::Isa,
        bodies: &[V::Row],
        given: &[V::Row],
        point: Vector3<V>,
    ) -> (Vector3<V>, Option<Vector3<V>>) {
        let (axis, origin) = self.axis(isa, bodies, given);
        match origin {
            Some(origin) => (axis.cross(point.minus(origin)), Some(axis)),
            None => (axis, None),
        }
    }

    /// The velocity at unit speed of the moment Σ wₖpₖ of points with weights of this sum, in the world.
    #[inline(always)]
    pub(crate) fn moment_velocity<V: Lanes>(
        &self,
        isa: V::Isa,
        bodies: &[V::Row],
        given: &[V::Row],
        (moment, weight): (Vector3<V>, f64),
    ) -> Vector3<V> {
        let weight = V::constant(isa, weight);
        let (axis, origin) = self.axis(isa, bodies, given);
        match origin {
            Some(origin) => axis.cross(origin.scaled_from(weight, moment)),
            None => axis.scaled(weight),
        }
    }

    /// The axis in the world, and, of a turn, a point on it.
    #[inline(always)]
    fn axis<V: Lanes>(&self, isa: V::Isa, bodies: &[V::Row], given: &[V::Row]) -> (Vector3<V>, Option<Vector3<V>>) {
        let rows = match self.at {
            At::Body(body) => &bodies[body * POSE_ROWS..],
            At::Given(slot) => &given[slot * POSE_ROWS..],
            At::World => {
                let axis = match self.axis {
                    Axis::Own(k, factor) => DVec3::AXES[k.min(2)] * factor,
                    Axis::Any(axis) => axis,
                };
                return (Vector3::splat(isa, axis), None); // nothing turns about an axis of the world
            }
        };
        let axis = match self.axis {
            Axis::Own(k, factor) => {
                let own = Vector3::load(isa, &rows[3 * k..]);
                if factor == 1.0 { own } else { own.scaled(V::constant(isa, factor)) }
            }
            Axis::Any(axis) => Transform::<V>::load(isa, rows).rotation.turn(Vector3::splat(isa, axis)),
        };
        (axis, if self.turns { Some(Vector3::load(isa, &rows[9..])) } else { None })
    }
}

/// The Jacobian of a frame that is attached to a chain of joints.
#[derive(Clone, Debug, PartialEq)]
pub struct LaneJacobian {
    columns: Vec<LaneColumn>,
    /// Body on which the frame is, in the table.
    tip: usize,
    frame: DVec3,
}

impl LaneJacobian {
    /// The Jacobian of a frame on `tip` with pose `X_JF` there, moved by `columns`. `None` where the table lacks a body that
    /// is needed.
    #[must_use]
    pub fn new(table: &LaneKinematics, columns: &[Column], tip: JointIndex, X_JF: &Pose) -> Option<Self> {
        let position = |joint: JointIndex| table.bodies().iter().position(|&b| b == joint);
        let find = |joint: Option<JointIndex>| joint.map_or(Some(At::World), |joint| position(joint).map(At::Body));
        let columns = columns.iter().map(|column| LaneColumn::new(column, find)).collect::<Option<Vec<_>>>()?;
        Some(Self { columns, tip: position(tip)?, frame: X_JF.translation })
    }

    /// Number of columns, counted by the variables that they name.
    #[must_use]
    pub fn width(&self) -> usize {
        self.columns.iter().map(|column| column.variable + 1).max().unwrap_or(0)
    }

    /// Velocity of the frame's origin, then angular velocity, both in the world: six rows per variable. `bodies` as the
    /// table writes them.
    ///
    /// # Panics
    /// If a slice is too short.
    #[inline(always)]
    pub fn jacobian_in<V: Lanes>(&self, isa: V::Isa, bodies: &[V::Row], out: &mut [V::Row]) {
        let point = Transform::<V>::load(isa, &bodies[self.tip * POSE_ROWS..]).point(Vector3::splat(isa, self.frame));
        let zero = V::constant(isa, 0.0);
        for column in &self.columns {
            let (linear, angular) = column.twist(isa, bodies, &[], point);
            let angular = match angular {
                Some(angular) => angular,
                None => Vector3::new(zero, zero, zero),
            };
            let rows = &mut out[6 * column.variable..];
            linear.store(rows);
            angular.store(&mut rows[3..]);
        }
    }

    /// Poses and Jacobians for blocks of eight configurations: `q` holds one row per coordinate of the table's robot, `bodies`
    /// [`POSE_ROWS`] rows per body for one block (working memory), `out` six rows per column; `q` and `out` block after block.
    /// Each variable has one column: what follows a leader is not summed up.
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn jacobian_f64(
        &self,
        level: Level,
        table: &LaneKinematics,
        q: &[F64Row],
        bodies: &mut [F64Row],
        out: &mut [F64Row],
    ) {
        level.run(JacobianF64 { jacobian: self, table, q, bodies, out });
    }

    /// As [`Self::jacobian_f64`], for blocks of sixteen in single precision.
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn jacobian_f32(
        &self,
        level: Level,
        table: &LaneKinematics,
        q: &[F32Row],
        bodies: &mut [F32Row],
        out: &mut [F32Row],
    ) {
        level.run(JacobianF32 { jacobian: self, table, q, bodies, out });
    }
}

struct JacobianF64<'a> {
    jacobian: &'a LaneJacobian,
    table: &'a LaneKinematics,
    q: &'a [F64Row],
    bodies: &'a mut [F64Row],
    out: &'a mut [F64Row],
}

impl Kernel for JacobianF64<'_> {
    type Output = ();
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        blocks::<I::F64>(isa, self.jacobian, self.table, self.q, self.bodies, self.out);
    }
}

struct JacobianF32<'a> {
    jacobian: &'a LaneJacobian,
    table: &'a LaneKinematics,
    q: &'a [F32Row],
    bodies: &'a mut [F32Row],
    out: &'a mut [F32Row],
}

impl Kernel for JacobianF32<'_> {
    type Output = ();
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        blocks::<I::F32>(isa, self.jacobian, self.table, self.q, self.bodies, self.out);
    }
}

#[inline(always)]
fn blocks<V: Lanes>(
    isa: V::Isa,
    jacobian: &LaneJacobian,
    table: &LaneKinematics,
    q: &[V::Row],
    bodies: &mut [V::Row],
    out: &mut [V::Row],
) {
    let (size, numbers) = (table.configuration_size(), 6 * jacobian.width());
    if size == 0 || numbers == 0 {
        return;
    }
    for (q, out) in q.chunks_exact(size).zip(out.chunks_exact_mut(numbers)) {
        table.forward_in::<V>(isa, q, bodies);
        jacobian.jacobian_in::<V>(isa, bodies, out);
    }
}
