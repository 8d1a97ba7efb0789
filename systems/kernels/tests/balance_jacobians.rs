//! Jacobians of balance, distances and functions agree with central differences on the configuration space's own group,
//! with objects in the hand, roots of every kind and a mimic joint.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

mod heavy_world;

use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Frame, Row};
use foliate_components::robot::{JointIndex, Robot};
use foliate_kernels::constraints::centre_of_mass::{self, MassColumns};
use foliate_kernels::constraints::com_between::{self, StanceColumns};
use foliate_kernels::constraints::custom::{self, FunctionColumns, FunctionMemory};
use foliate_kernels::constraints::{RowsOut, distance, parameter};
use foliate_kernels::kinematics::{AttachmentTree, Column, Kinematics, RigidAttachment};
use glam::DVec3;
use heavy_world::{Draw, held, poses, world};

const STEP: f64 = 1e-6;
const CLOSE: f64 = 2e-8;
const ROUNDS: u64 = 40;

struct Setting {
    robot: Robot,
    kinematics: Kinematics,
    rigid_attachments: Vec<RigidAttachment>,
}

impl Setting {
    fn both() -> [Self; 2] {
        let of = |rigid_attachments: fn(&Robot) -> Vec<RigidAttachment>| {
            let robot = world();
            Self { kinematics: Kinematics::new(&robot), rigid_attachments: rigid_attachments(&robot), robot }
        };
        [of(|_| Vec::new()), of(held)]
    }

    fn tree(&self) -> AttachmentTree {
        AttachmentTree::with_carried(&self.robot, self.rigid_attachments.iter().map(|c| (c.object, c.carrier)))
    }

    fn columns(&self, from: Option<JointIndex>, to: &Frame) -> Vec<Column> {
        self.tree().columns(from, to.joint, Some)
    }

    fn poses(&self, q: &[f64]) -> Vec<Pose> {
        poses(&self.kinematics, &self.rigid_attachments, q)
    }

    /// The rows and their Jacobian, and both again from `value` by central differences; satisfied inequalities are zero.
    fn compare(
        &self,
        what: &str,
        rows: &[Row],
        q: &[f64],
        linearise: impl FnOnce(&[Pose], RowsOut<'_>),
        value: impl Fn(&[Pose], &mut [f64]),
    ) {
        let (space, count) = (&self.robot.space, rows.len());
        let (mut values, mut jacobian) = (vec![0.0; count], vec![0.0; count * space.dimension()]);
        linearise(&self.poses(q), RowsOut { values: &mut values, jacobian: &mut jacobian, stride: count });
        let at = |v: &[f64]| {
            let (mut moved, mut values) = (q.to_vec(), vec![0.0; count]);
            space.integrate(q, v, &mut moved);
            value(&self.poses(&moved), &mut values);
            values
        };
        let mut v = vec![0.0; space.dimension()];
        let now = at(&v);
        let silent = |row: usize| rows[row] == Row::Inequality && now[row] >= 0.0;
        for row in 0..count {
            let expected = if silent(row) { 0.0 } else { now[row] };
            assert!((values[row] - expected).abs() < 1e-12, "{what}: row {row}: {} {expected}", values[row]);
        }
        for k in 0..v.len() {
            v[k] = STEP;
            let forward = at(&v);
            v[k] = -STEP;
            let backward = at(&v);
            v[k] = 0.0;
            for row in 0..count {
                let slope = if silent(row) { 0.0 } else { (forward[row] - backward[row]) / (2.0 * STEP) };
                let ours = jacobian[k * count + row];
                let off = (ours - slope).abs();
                assert!(off < CLOSE * (1.0 + slope.abs()), "{what}: row {row}, column {k}: {ours} {slope}");
            }
        }
    }
}

#[test]
fn the_centre_of_mass_in_any_frame() {
    for setting in Setting::both() {
        let mut draw = Draw::new(1);
        for _ in 0..ROUNDS {
            let balance = draw.balance(&setting.robot, [Row::Zero, Row::Parameter, Row::Inequality]);
            let argument = Pose::from_translation(draw.vector(0.5));
            let from = balance.frame.joint;
            let columns = MassColumns::new(&setting.tree(), from, &balance.masses, |_| true, Some);
            let mut moments = vec![DVec3::ZERO; columns.moments()];
            let rows: Vec<_> = balance.rows.iter().map(|plane| plane.row).collect();
            let q = draw.configuration(&setting.robot);
            let linearise = |X_WJ: &[Pose], out: RowsOut<'_>| {
                centre_of_mass::linearise(&balance, &argument, &columns, X_WJ, &mut moments, out);
            };
            let value = |X_WJ: &[Pose], values: &mut [f64]| {
                centre_of_mass::value(&balance, &[argument], X_WJ, values);
            };
            setting.compare("centre of mass", &rows, &q, linearise, value);
        }
    }
}

#[test]
fn the_centre_of_mass_between_two_feet() {
    for setting in Setting::both() {
        let mut draw = Draw::new(2);
        for round in 0..ROUNDS {
            let balance = draw.between(&setting.robot, (round % 2 == 0).then_some(0.4));
            let masses = MassColumns::new(&setting.tree(), None, &balance.masses, |_| true, Some);
            let mut moments = vec![DVec3::ZERO; masses.moments()];
            let feet = [&balance.first, &balance.second].map(|foot| setting.columns(None, foot));
            let columns = StanceColumns { masses, feet };
            let rows: Vec<_> =
                (0..com_between::dimension(&balance)).map(|row| com_between::kind(&balance, row)).collect();
            let q = draw.configuration(&setting.robot);
            let X_WJ = setting.poses(&q);
            let foot = |frame: &Frame| {
                let X = frame.joint.map_or(Pose::identity(), |j| X_WJ[j.at()]) * frame.joint_from_frame;
                X.translation.truncate()
            };
            if foot(&balance.first).distance(foot(&balance.second)) < 0.05 {
                continue; // the line between the feet turns too fast for differences
            }
            let linearise = |X_WJ: &[Pose], out: RowsOut<'_>| {
                com_between::linearise(&balance, &columns, X_WJ, &mut moments, out);
            };
            let value = |X_WJ: &[Pose], values: &mut [f64]| com_between::value(&balance, X_WJ, values);
            setting.compare("between feet", &rows, &q, linearise, value);
        }
    }
}

#[test]
fn distances() {
    for setting in Setting::both() {
        let mut draw = Draw::new(3);
        let (mut silent, mut spoken) = (0, 0);
        for round in 0..2 * ROUNDS {
            let row = if round % 3 == 0 { Row::Zero } else { Row::Inequality };
            let apart = draw.distance(&setting.robot, row, round % 2 == 0);
            if apart.a.joint == apart.b.joint {
                continue;
            }
            let columns = setting.columns(apart.a.joint, &apart.b);
            let q = draw.configuration(&setting.robot);
            let linearise = |X_WJ: &[Pose], out: RowsOut<'_>| distance::linearise(&apart, &columns, X_WJ, out);
            let value = |X_WJ: &[Pose], values: &mut [f64]| values[0] = distance::value(&apart, X_WJ);
            setting.compare("distance", &[row], &q, linearise, value);
            let satisfied = row == Row::Inequality && distance::value(&apart, &setting.poses(&q)) >= 0.0;
            if satisfied { silent += 1 } else { spoken += 1 }
        }
        assert!(silent > 5 && spoken > 5, "{silent} {spoken}");
    }
}

#[test]
fn points_that_coincide_still_part() {
    let [setting, _] = Setting::both();
    let mut draw = Draw::new(4);
    let frame = draw.frame(&setting.robot);
    let a = Frame::of_joint(setting.robot.joint("arm/w2").unwrap());
    let apart = foliate_components::constraint::Distance { a, b: a, length: 0.1, row: Row::Zero, at_most: false };
    let columns = setting.columns(None, &frame);
    let mut jacobian = vec![0.0; setting.robot.space.dimension()];
    let mut values = [0.0];
    let X_WJ = setting.poses(&draw.configuration(&setting.robot));
    distance::linearise(&apart, &columns, &X_WJ, RowsOut { values: &mut values, jacobian: &mut jacobian, stride: 1 });
    assert_eq!(values, [-0.1]);
    assert!(jacobian.iter().all(|j| j.is_finite()));
}

#[test]
fn a_function_of_the_hosts_own() {
    for setting in Setting::both() {
        let mut draw = Draw::new(5);
        for _ in 0..ROUNDS {
            let own = draw.gaze(&setting.robot);
            let columns = FunctionColumns::new(&own, |frame| setting.columns(None, frame));
            let mut memory = FunctionMemory::default();
            let q = draw.configuration(&setting.robot);
            let linearise = |X_WJ: &[Pose], out: RowsOut<'_>| columns.linearise(X_WJ, &mut memory, out);
            let value = |X_WJ: &[Pose], values: &mut [f64]| values.copy_from_slice(&custom::value(&own, X_WJ));
            setting.compare("function", own.0.rows(), &q, linearise, value);
        }
    }
}

/// The argument that is read where the bodies are makes the parameter rows zero there, and is the same wherever they are.
#[test]
fn parameters_reproduce_the_place() {
    let [_, setting] = Setting::both();
    let mut draw = Draw::new(6);
    for _ in 0..ROUNDS {
        let balance = draw.balance(&setting.robot, [Row::Parameter, Row::Zero, Row::Parameter]);
        let q = draw.configuration(&setting.robot);
        let X_WJ = setting.poses(&q);
        let argument = parameter(&setting.robot, &Constraint::CentreOfMass(balance.clone()), &q, &X_WJ);
        let mut values = [0.0; 3];
        centre_of_mass::value(&balance, &[argument], &X_WJ, &mut values);
        assert!(values[0].abs() < 1e-12 && values[2].abs() < 1e-12, "{values:?}");
        // What is across both normals says nothing about the leaf.
        let across = balance.rows[0].normal.cross(balance.rows[2].normal);
        assert!(argument.translation.dot(across).abs() < 1e-12);
    }
}
