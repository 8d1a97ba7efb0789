//! Sixteen configurations' bodies, placed in lanes.

use crate::collision::samples::interval::POSE;
use crate::kinematics::joint_table::{JointCoordinates, JointEntry};
use crate::lanes::geometry::{Rotation, Transform, Vector3};
use crate::lanes::level::Kernel;
use crate::lanes::trigonometry::sin_cos;
use crate::lanes::vector::{F32Row, F64Row, Isa, Lanes};
use foliate_components::Pose;
use foliate_components::robot::JointType;
use glam::{DMat3, DVec3};

pub(crate) fn rows_of(motion: JointType) -> usize {
    match motion {
        JointType::Revolute { .. } | JointType::Prismatic { .. } => 1,
        JointType::Planar => 3,
        JointType::FreeFlyer => 7,
    }
}

pub(crate) fn numbers_of(X: &Pose) -> [f64; POSE] {
    let r = DMat3::from_quat(X.rotation).to_cols_array();
    let t = X.translation;
    [r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8], t.x, t.y, t.z]
}

impl JointEntry {
    /// By how much it turns and slides along a straight motion, and how far from zero its translation is at most.
    pub(crate) fn moves_by(&self, q: &[f64], delta: &[f64]) -> (f64, f64, f64) {
        let JointCoordinates { q: i, v: j, multiplier, offset } = self.coordinates;
        let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        match self.motion {
            JointType::Revolute { .. } => ((multiplier * delta[j]).abs(), 0.0, 0.0),
            JointType::Prismatic { .. } => {
                let value = |x: f64| (multiplier * x + offset).abs();
                (0.0, (multiplier * delta[j]).abs(), value(q[i]).max(value(q[i] + delta[j])))
            }
            JointType::Planar => {
                let end = [q[i] + delta[j], q[i + 1] + delta[j + 1]];
                (delta[j + 2].abs(), length(&delta[j..j + 2]), length(&q[i..i + 2]).max(length(&end)))
            }
            JointType::FreeFlyer => {
                let end = [q[i] + delta[j], q[i + 1] + delta[j + 1], q[i + 2] + delta[j + 2]];
                (length(&delta[j + 3..j + 6]), length(&delta[j..j + 3]), length(&q[i..i + 3]).max(length(&end)))
            }
        }
    }
}

/// A body that moves along the motion, and what moves it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub body: u32,
    /// The body that it is attached to; none for the world.
    pub parent: Option<u32>,
    /// Where it is attached (with joint: at zero).
    pub hangs: Pose,
    pub motion: Option<JointType>,
    /// First of its rows in `values`.
    pub value: u32,
}

/// Forward kinematics of the bodies that move, with carried objects.
pub(crate) struct PlaceBodies<'a> {
    pub steps: &'a [Step],
    pub values: &'a [[F64Row; 2]],
    pub start: &'a [Pose],
    pub body_moves: &'a [bool],
    pub exact: &'a mut [[[F64Row; POSE]; 2]],
    pub poses: &'a mut [[F32Row; POSE]],
}

impl Kernel for PlaceBodies<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        for step in self.steps {
            for half in 0..2 {
                let values = &self.values[step.value as usize..];
                let hung: Transform<I::F64> = match step.parent {
                    None => Transform::splat(isa, &step.hangs),
                    Some(parent) if self.body_moves[parent as usize] => {
                        Transform::load(isa, &self.exact[parent as usize][half])
                            .times(&Transform::splat(isa, &step.hangs))
                    }
                    Some(parent) => Transform::splat(isa, &(self.start[parent as usize] * step.hangs)),
                };
                let placed = match step.motion {
                    None => hung,
                    Some(JointType::Revolute { axis }) => {
                        let angle = I::F64::load(isa, &values[0][half]);
                        Transform { rotation: turned(hung.rotation, axis, angle), translation: hung.translation }
                    }
                    Some(JointType::Prismatic { axis }) => {
                        let by = I::F64::load(isa, &values[0][half]);
                        let along = Vector3::splat(isa, axis).scaled(by);
                        Transform { rotation: hung.rotation, translation: hung.point(along) }
                    }
                    Some(JointType::Planar) => {
                        let (x, y) = (I::F64::load(isa, &values[0][half]), I::F64::load(isa, &values[1][half]));
                        let at = hung.point(Vector3::new(x, y, I::F64::constant(isa, 0.0)));
                        let angle = I::F64::load(isa, &values[2][half]);
                        Transform { rotation: turned(hung.rotation, DVec3::Z, angle), translation: at }
                    }
                    Some(JointType::FreeFlyer) => {
                        let row = [
                            I::F64::load(isa, &values[0][half]),
                            I::F64::load(isa, &values[1][half]),
                            I::F64::load(isa, &values[2][half]),
                            I::F64::load(isa, &values[3][half]),
                            I::F64::load(isa, &values[4][half]),
                            I::F64::load(isa, &values[5][half]),
                            I::F64::load(isa, &values[6][half]),
                        ];
                        let own = Transform {
                            rotation: Rotation::from_quaternion(row[3], row[4], row[5], row[6]),
                            translation: Vector3::new(row[0], row[1], row[2]),
                        };
                        hung.times(&own)
                    }
                };
                let rows = &mut self.exact[step.body as usize][half];
                placed.store(rows);
                let rounded = &mut self.poses[step.body as usize];
                for number in 0..POSE {
                    for lane in 0..8 {
                        rounded[number].0[8 * half + lane] = rows[number].0[lane] as f32;
                    }
                }
            }
        }
    }
}

/// A frame, turned about an axis of its own.
#[inline(always)]
fn turned<V: Lanes>(frame: Rotation<V>, axis: DVec3, angle: V) -> Rotation<V> {
    let (sine, cosine) = sin_cos(angle);
    let [x, y, z] = frame.columns;
    if axis.x.abs() == 1.0 {
        let sine = sine * V::constant(angle.isa(), axis.x);
        Rotation { columns: [x, y.scaled_plus(cosine, z.scaled(sine)), z.scaled_plus(cosine, y.scaled(-sine))] }
    } else if axis.y.abs() == 1.0 {
        let sine = sine * V::constant(angle.isa(), axis.y);
        Rotation { columns: [x.scaled_plus(cosine, z.scaled(-sine)), y, z.scaled_plus(cosine, x.scaled(sine))] }
    } else if axis.z.abs() == 1.0 {
        let sine = sine * V::constant(angle.isa(), axis.z);
        Rotation { columns: [x.scaled_plus(cosine, y.scaled(sine)), y.scaled_plus(cosine, x.scaled(-sine)), z] }
    } else {
        // Rodrigues: c + (1 − c) a aᵀ + s [a]×, column by column.
        let isa = angle.isa();
        let a = Vector3::<V>::splat(isa, axis);
        let rest = V::constant(isa, 1.0) - cosine;
        let (ax, ay, az) = (a.scaled(rest * a.x), a.scaled(rest * a.y), a.scaled(rest * a.z));
        let (sx, sy, sz) = (a.x * sine, a.y * sine, a.z * sine);
        let own = Rotation {
            columns: [
                Vector3::new(ax.x + cosine, ax.y + sz, ax.z - sy),
                Vector3::new(ay.x - sz, ay.y + cosine, ay.z + sx),
                Vector3::new(az.x + sy, az.y - sx, az.z + cosine),
            ],
        };
        frame.times(&own)
    }
}
