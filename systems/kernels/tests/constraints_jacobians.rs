//! Every Jacobian agrees with central differences on the configuration space's own group.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

use foliate_components::Pose;
use foliate_components::constraint::{Frame, Grasp, Mask, Placement as Contact, Reference, RelativePose, Row, rows};
use foliate_components::pose::exp_so3;
use foliate_components::robot::{JointIndex, LinkIndex, PartKind, Robot, RootJoint};
use foliate_components::samples::models;
use foliate_kernels::constraints::{RowsOut, locked, placement, placement_of, relative_pose};
use foliate_kernels::kinematics::{AttachmentTree, Kinematics, RigidAttachment, geometric_jacobian};
use glam::DVec3;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const STEP: f64 = 1e-6;
const CLOSE: f64 = 2e-8;

/// One of everything: a fixed arm, arms on a planar and on a free-flyer root, a hand with a mimic finger, objects with
/// and without joints of their own, a table.
fn world() -> Robot {
    let size = DVec3::new(0.1, 0.14, 0.2);
    let tilted = Pose::from_parts(DVec3::new(0.3, -0.2, 0.5), exp_so3(DVec3::new(0.4, -0.3, 0.9)));
    let (arm, two, hand) = (models::seven_axis_arm(), models::two_joint_arm(), models::two_finger_hand());
    let (block, lid, table) =
        (models::block(size), models::box_with_lid(size), models::table(DVec3::new(1.2, 0.8, 0.1)));
    Robot::compose(&[
        (&arm, models::fixed_robot("arm", tilted)),
        (&two, models::part("rover", PartKind::Robot, RootJoint::Planar, tilted)),
        (&two, models::part("drone", PartKind::Robot, RootJoint::FreeFlyer, tilted)),
        (&hand, models::fixed_robot("hand", tilted)),
        (&block, models::movable_object("block")),
        (&block, models::movable_object("other")),
        (&lid, models::movable_object("lid")),
        (&table, models::environment("table", Pose::identity())),
    ])
    .unwrap()
}

struct Setting {
    robot: Robot,
    kinematics: Kinematics,
    rigid_attachments: Vec<RigidAttachment>,
}

impl Setting {
    fn new(rigid_attachments: impl FnOnce(&Robot) -> Vec<RigidAttachment>) -> Self {
        let robot = world();
        Self { kinematics: Kinematics::new(&robot), rigid_attachments: rigid_attachments(&robot), robot }
    }

    fn tree(&self) -> AttachmentTree {
        AttachmentTree::with_carried(&self.robot, self.rigid_attachments.iter().map(|c| (c.object, c.carrier)))
    }

    fn poses(&self, q: &[f64]) -> Vec<Pose> {
        let mut X_WJ = vec![Pose::identity(); self.kinematics.bodies()];
        self.kinematics.forward(q, &mut X_WJ);
        self.kinematics.carry(q, &self.rigid_attachments, &mut X_WJ);
        X_WJ
    }

    /// Central differences of `value`, or `None` where it is not smooth there.
    fn differences<const N: usize>(
        &self,
        q: &[f64],
        value: impl Fn(&[Pose]) -> Option<[f64; N]>,
    ) -> Option<Vec<[f64; N]>> {
        let space = &self.robot.space;
        let (mut v, mut moved) = (vec![0.0; space.dimension()], q.to_vec());
        let mut columns = Vec::new();
        for k in 0..space.dimension() {
            let mut at = |step: f64| {
                v[k] = step;
                space.integrate(q, &v, &mut moved);
                v[k] = 0.0;
                value(&self.poses(&moved))
            };
            let (forward, backward) = (at(STEP)?, at(-STEP)?);
            columns.push(std::array::from_fn(|i| (forward[i] - backward[i]) / (2.0 * STEP)));
        }
        Some(columns)
    }

    fn random(&self, rng: &mut ChaCha8Rng) -> Vec<f64> {
        let mut q = self.robot.space.neutral();
        self.robot.space.random(rng, &mut q);
        q
    }
}

fn held(robot: &Robot) -> Vec<RigidAttachment> {
    let X_CO = Pose::from_parts(DVec3::new(0.1, 0.02, 0.2), exp_so3(DVec3::new(1.0, 0.5, -0.3)));
    let (hand, block) = (robot.joint("arm/w2"), robot.joint("block/root_joint").unwrap());
    let (other, lid) = (robot.joint("other/root_joint").unwrap(), robot.joint("lid/root_joint").unwrap());
    vec![
        RigidAttachment { object: block, carrier: hand, X_CO },
        RigidAttachment { object: other, carrier: None, X_CO },
        RigidAttachment { object: lid, carrier: Some(block), X_CO },
    ]
}

fn random_pose(rng: &mut ChaCha8Rng) -> Pose {
    let mut number = || rng.random_range(-1.0..1.0);
    let (t, r) = (DVec3::new(number(), number(), number()), DVec3::new(number(), number(), number()));
    Pose::from_parts(t * 0.3, exp_so3(r))
}

fn random_frame(robot: &Robot, rng: &mut ChaCha8Rng) -> Frame {
    let link = LinkIndex(rng.random_range(0..robot.links.len() as u32));
    Frame::on_link(robot, link, &random_pose(rng))
}

fn compare<const N: usize>(jacobian: &[f64], expected: &[[f64; N]], what: &str) {
    for (k, column) in expected.iter().enumerate() {
        for (i, &value) in column.iter().enumerate() {
            let ours = jacobian[k * N + i];
            assert!((ours - value).abs() < CLOSE * (1.0 + value.abs()), "{what}: row {i}, column {k}: {ours} {value}");
        }
    }
}

#[test]
fn frames_move_as_the_geometric_jacobian_says() {
    for setting in [Setting::new(|_| Vec::new()), Setting::new(held)] {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let width = setting.robot.space.dimension();
        for _ in 0..20 {
            let q = setting.random(&mut rng);
            let frame = placement_of(&random_frame(&setting.robot, &mut rng));
            let X_WJ = setting.poses(&q);
            let now = frame.in_world(&X_WJ);
            let columns = setting.tree().columns(None, frame.joint, Some);
            let mut jacobian = vec![0.0; 6 * width];
            geometric_jacobian(&columns, &X_WJ, now.translation, &mut jacobian);
            let value = |X_WJ: &[Pose]| {
                let X = frame.in_world(X_WJ);
                let turn = foliate_components::pose::log_so3(X.rotation * now.rotation.conjugate());
                Some([X.translation.x, X.translation.y, X.translation.z, turn.x, turn.y, turn.z])
            };
            compare(&jacobian, &setting.differences(&q, value).unwrap(), "frame");
        }
    }
}

#[test]
fn relative_poses_between_any_two_bodies() {
    for (seed, setting) in [(2, Setting::new(|_| Vec::new())), (3, Setting::new(held))] {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let width = setting.robot.space.dimension();
        for _ in 0..60 {
            let q = setting.random(&mut rng);
            let (a, b) = (random_frame(&setting.robot, &mut rng), random_frame(&setting.robot, &mut rng));
            let (a, b, reference) = (placement_of(&a), placement_of(&b), random_pose(&mut rng));
            let X_WJ = setting.poses(&q);
            let value = |X_WJ: &[Pose]| Some(relative_pose::value(&a, &b, &reference, X_WJ));
            let now = value(&X_WJ).unwrap();
            if DVec3::new(now[3], now[4], now[5]).length() > 3.0 {
                continue; // the logarithm's cut
            }
            let columns = setting.tree().columns(a.joint, b.joint, Some);
            let mut jacobian = vec![0.0; 6 * width];
            relative_pose::jacobian(&a, &b, &reference, &columns, &X_WJ, &mut jacobian);
            compare(&jacobian, &setting.differences(&q, value).unwrap(), "relative pose");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn every_mask_picks_its_rows_in_order(bits in 0u8..64, seed in 0u64..1000) {
        let setting = Setting::new(held);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let width = setting.robot.space.dimension();
        let mask = Mask(std::array::from_fn(|i| bits >> i & 1 == 1));
        let X_WJ = setting.poses(&setting.random(&mut rng));
        let (a, b) = (random_frame(&setting.robot, &mut rng), random_frame(&setting.robot, &mut rng));
        let (a, b, reference) = (placement_of(&a), placement_of(&b), random_pose(&mut rng));
        let columns = setting.tree().columns(a.joint, b.joint, Some);
        let mut whole = vec![0.0; 6 * width];
        relative_pose::jacobian(&a, &b, &reference, &columns, &X_WJ, &mut whole);
        let all = relative_pose::value(&a, &b, &reference, &X_WJ);
        let (mut values, mut jacobian) = (vec![0.0; mask.count()], vec![0.0; mask.count() * width]);
        let stride = values.len();
        let out = RowsOut { values: &mut values, jacobian: &mut jacobian, stride };
        relative_pose::linearise(&a, &b, &reference, &rows(mask, Mask::NONE), &columns, &X_WJ, out);
        for (row, i) in (0..6).filter(|&i| mask.0[i]).enumerate() {
            prop_assert_eq!(values[row], all[i]);
            for column in 0..width {
                prop_assert_eq!(jacobian[column * stride + row], whole[column * 6 + i]);
            }
        }
    }
}

#[test]
fn a_satisfied_inequality_is_silent_and_a_violated_one_speaks() {
    let setting = Setting::new(|_| Vec::new());
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let width = setting.robot.space.dimension();
    let (mut silent, mut spoken) = (0, 0);
    for _ in 0..20 {
        let X_WJ = setting.poses(&setting.random(&mut rng));
        let b = Frame::of_joint(setting.robot.joint("arm/w2").unwrap());
        let (a, b) = (placement_of(&Frame::world(random_pose(&mut rng))), placement_of(&b));
        let only_z = [None, None, Some(Row::Inequality), None, None, None];
        let columns = setting.tree().columns(a.joint, b.joint, Some);
        let (mut values, mut jacobian) = ([0.0], vec![0.0; width]);
        let stride = values.len();
        let out = RowsOut { values: &mut values, jacobian: &mut jacobian, stride };
        relative_pose::linearise(&a, &b, &Pose::identity(), &only_z, &columns, &X_WJ, out);
        let z = relative_pose::value(&a, &b, &Pose::identity(), &X_WJ)[2];
        assert_eq!(values[0], z.min(0.0));
        assert_eq!(jacobian.iter().all(|&j| j == 0.0), z >= 0.0);
        if z >= 0.0 { silent += 1 } else { spoken += 1 }
    }
    assert!(silent > 0 && spoken > 0);
}

#[test]
fn grasps_and_pregrasps_through_carriages() {
    let setting = Setting::new(held);
    let robot = &setting.robot;
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let width = robot.space.dimension();
    for (gripper, handle) in
        [("arm/hand", "other/top"), ("drone/tip", "block/side"), ("rover/tip", "lid/knob"), ("arm/hand", "lid/side")]
    {
        let grasp = Grasp::new(robot, robot.gripper(gripper).unwrap(), robot.handle(handle).unwrap()).unwrap();
        for constraint in [grasp.constraint(), grasp.pregrasp(), grasp.hold(0), grasp.complement(0)] {
            check_relative_pose(&setting, &constraint, &mut rng, width);
        }
    }
}

fn check_relative_pose(setting: &Setting, constraint: &RelativePose, rng: &mut ChaCha8Rng, width: usize) {
    let (a, b) = (placement_of(&constraint.a), placement_of(&constraint.b));
    let columns = setting.tree().columns(a.joint, b.joint, Some);
    let reference = Pose::from_rotation(exp_so3(DVec3::Z * 0.4));
    for _ in 0..5 {
        let q = setting.random(rng);
        let X_WJ = setting.poses(&q);
        let value = |X_WJ: &[Pose]| Some(relative_pose::value(&a, &b, &reference, X_WJ));
        let now = value(&X_WJ).unwrap();
        if DVec3::new(now[3], now[4], now[5]).length() > 3.0 {
            continue;
        }
        let mut jacobian = vec![0.0; 6 * width];
        relative_pose::jacobian(&a, &b, &reference, &columns, &X_WJ, &mut jacobian);
        compare(&jacobian, &setting.differences(&q, value).unwrap(), "grasp");
    }
}

#[test]
fn a_pregrasp_stands_back_along_the_grippers_own_x() {
    let setting = Setting::new(|_| Vec::new());
    let robot = &setting.robot;
    let (gripper, handle) = (robot.gripper("arm/hand").unwrap(), robot.handle("block/top").unwrap());
    let grasp = Grasp::new(robot, gripper, handle).unwrap();
    assert!((grasp.standoff - 0.055).abs() < 1e-15);
    // Put the block where the pre-grasp is satisfied: its handle is the stand-off ahead of the gripper.
    let mut X_WJ = setting.poses(&robot.space.neutral());
    let X_WG = placement_of(&grasp.gripper).in_world(&X_WJ);
    let X_WH = X_WG * Pose::from_translation(DVec3::X * 0.055);
    X_WJ[grasp.handle.joint.unwrap().at()] = X_WH * grasp.handle.joint_from_frame.inverse();
    let of =
        |c: &RelativePose| relative_pose::value(&placement_of(&c.a), &placement_of(&c.b), &Pose::identity(), &X_WJ);
    assert!(of(&grasp.pregrasp()).iter().all(|e| e.abs() < 1e-12));
    assert!((of(&grasp.constraint())[0] - 0.055).abs() < 1e-12);
}

/// A placement of both faces of a block on the table and on the other block.
fn contact(robot: &Robot) -> Contact {
    let surface = |name| robot.surface(name).unwrap();
    let object = [surface("block/bottom"), surface("block/top")];
    Contact::new(robot, &object, &[surface("table/top"), surface("other/top")], 1e-3).unwrap()
}

#[test]
fn placements_inside_and_outside_on_several_polygons() {
    for (seed, setting) in [(7, Setting::new(|_| Vec::new())), (8, Setting::new(held))] {
        let robot = &setting.robot;
        let width = robot.space.dimension();
        let flat = contact(robot);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut seen = std::collections::HashSet::new();
        for round in 0..120 {
            let placement = if round % 2 == 0 { flat.clone() } else { flat.lifted(0.05) };
            let q = setting.random(&mut rng);
            let X_WJ = setting.poses(&q);
            let now = placement::contact(&placement, &X_WJ);
            let support = &placement.supports[now.support];
            let columns = setting.tree().columns(support.frame.joint, placement.object_joint(), Some);
            let value = |X_WJ: &[Pose]| {
                let same = placement::contact(&placement, X_WJ) == now;
                same.then(|| placement::value(&placement, now, X_WJ))
            };
            let turn = foliate_components::pose::log_so3(placement::pose(&placement, now, &X_WJ).rotation);
            let Some(expected) = setting.differences(&q, value).filter(|_| turn.length() < 3.0) else { continue };
            let (mut values, mut jacobian) = ([0.0; 5], vec![0.0; 5 * width]);
            let stride = values.len();
            let out = RowsOut { values: &mut values, jacobian: &mut jacobian, stride };
            placement::linearise(&placement, now, &columns, &X_WJ, out);
            assert_eq!(values, placement::value(&placement, now, &X_WJ));
            compare(&jacobian, &expected, "contact");
            seen.insert((now.object, now.support, now.inside));
        }
        assert!(seen.len() >= 5, "{seen:?}");
    }
}

#[test]
fn complements_and_holds_of_placements() {
    let setting = Setting::new(|_| Vec::new());
    let robot = &setting.robot;
    let width = robot.space.dimension();
    let placement = contact(robot);
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    for _ in 0..40 {
        let q = setting.random(&mut rng);
        let X_WJ = setting.poses(&q);
        let parameter = placement::parameter(&placement, &X_WJ);
        let target = placement::decode(&placement, &parameter).unwrap();
        let (contact, X_SO) = target;
        let support = placement_of(&placement.supports[contact.support].frame);
        let object = placement_of(&placement.object[contact.object].frame);
        let columns = setting.tree().columns(support.joint, object.joint, Some);
        let six = |X_WJ: &[Pose]| Some(relative_pose::value(&support, &object, &X_SO, X_WJ));
        let now = six(&X_WJ).unwrap();
        if DVec3::new(now[3], now[4], now[5]).length() > 3.0 {
            continue;
        }
        let three = |X_WJ: &[Pose]| six(X_WJ).map(|v| [v[1], v[2], v[3]]);
        let (mut values, mut jacobian) = ([0.0; 6], vec![0.0; 6 * width]);
        let stride = values.len();
        let out = RowsOut { values: &mut values, jacobian: &mut jacobian, stride };
        placement::linearise_hold(&placement, &target, &columns, &X_WJ, out);
        compare(&jacobian, &setting.differences(&q, six).unwrap(), "hold");
        let (mut values, mut jacobian) = ([0.0; 3], vec![0.0; 3 * width]);
        let stride = values.len();
        let out = RowsOut { values: &mut values, jacobian: &mut jacobian, stride };
        placement::linearise_complement(&placement, &target, &columns, &X_WJ, out);
        compare(&jacobian, &setting.differences(&q, three).unwrap(), "complement");
    }
}

#[test]
fn the_complement_says_which_polygons_touch() {
    let setting = Setting::new(|_| Vec::new());
    let robot = &setting.robot;
    let placement = contact(robot);
    let mut rng = ChaCha8Rng::seed_from_u64(10);
    for _ in 0..200 {
        let X_WJ = setting.poses(&setting.random(&mut rng));
        let contact = placement::contact(&placement, &X_WJ);
        let parameter = placement::parameter(&placement, &X_WJ);
        let (decoded, X_SO) = placement::decode(&placement, &parameter).unwrap();
        assert_eq!((decoded.object, decoded.support), (contact.object, contact.support));
        assert_eq!(X_SO.translation.x, -placement.margin);
        // Put the object where the explicit form says: it is in contact, and its parameter is the same.
        let (_, X_CO) = placement::hold(&placement, &parameter).unwrap();
        let carrier = placement.supports[contact.support].frame.joint;
        let X_WC = carrier.map_or_else(Pose::identity, |c| X_WJ[c.at()]);
        let mut placed = X_WJ.clone();
        placed[placement.object_joint().unwrap().at()] = X_WC * X_CO;
        let value = placement::value(&placement, decoded, &placed);
        assert!(value.iter().all(|e| e.abs() < 1e-12), "{value:?}");
        if contact.inside {
            let again = placement::parameter(&placement, &placed);
            assert!((again.translation - parameter.translation).length() < 1e-12);
            assert!(again.rotation.dot(parameter.rotation).abs() > 1.0 - 1e-12);
        }
    }
    let nowhere = Pose::from_translation(DVec3::Y * 1e3);
    assert!(placement::decode(&placement, &nowhere).is_none());
    assert!(placement::decode(&placement, &Pose::from_translation(DVec3::Y * f64::NAN)).is_none());
}

#[test]
fn a_locked_joint_is_one_row() {
    let (q, h) = (0.3, STEP);
    let numeric = (locked::value(q + h, 0.1) - locked::value(q - h, 0.1)) / (2.0 * h);
    assert!((numeric - locked::jacobian()).abs() < CLOSE);
}

#[test]
fn objects_do_not_carry_themselves() {
    let robot = world();
    let (block, other) = (robot.joint("block/root_joint").unwrap(), robot.joint("other/root_joint").unwrap());
    let mut tree = AttachmentTree::new(&robot);
    assert!(tree.hang(block, Some(other)));
    assert!(!tree.hang(other, Some(block)), "a cycle of two");
    assert!(!tree.hang(block, None), "carried twice");
    assert!(!tree.hang(other, Some(other)), "a cycle of one");
    assert_eq!(tree.chain(Some(block)).collect::<Vec<_>>(), [block, other]);
    assert_eq!(tree.between(Some(block), Some(other)), (vec![block], Vec::<JointIndex>::new()));
}

#[test]
fn a_reference_is_read_in_the_axes_of_frame_a() {
    let setting = Setting::new(|_| Vec::new());
    let (a, b) = (Frame::world(Pose::from_rotation(exp_so3(DVec3::Z))), Frame::world(Pose::from_translation(DVec3::X)));
    let rigid = RelativePose::rigid(a, b, Reference::Identity);
    assert!(rigid.is_rigid() && rigid.dimension() == 6);
    let X_WJ = setting.poses(&setting.robot.space.neutral());
    let (a, b) = (placement_of(&a), placement_of(&b));
    let X_AB = relative_pose::pose(&a, &b, &X_WJ);
    assert!(relative_pose::value(&a, &b, &X_AB, &X_WJ).iter().all(|e| e.abs() < 1e-15));
}
