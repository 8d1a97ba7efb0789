//! Which pairs are tested, how far apart they must stay, and that contact by placement needs no exemption.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{at, compose, cuboid, joint, link, place, placed, single};
use foliate_components::Pose;
use foliate_components::coverage::PairCounts;
use foliate_components::problem::Margin;
use foliate_components::robot::model::{JointKind, Model};
use foliate_components::robot::{DisabledPair, JointIndex, PartKind, Robot, RootJoint};
use foliate_kernels::collision::{
    CertificateSettings, CollisionScene, CollisionScratch, MotionVerdict, PairRule, PairSet, adjacent_links,
    certify_motion, first_collision, min_clearance,
};
use foliate_kernels::kinematics::{Kinematics, RigidAttachment};
use glam::DVec3;

/// Three links in a row, 0.3 m apart, each a cube of 0.1 m.
fn chain(has_srdf: bool) -> Model {
    let cube = || vec![(Pose::IDENTITY, cuboid(0.1, 0.1, 0.1))];
    let step = |name: &str, parent| joint(name, JointKind::Revolute, parent, parent + 1, at(0.3, 0.0, 0.0), DVec3::Z);
    Model {
        name: "chain".into(),
        links: ["a", "b", "c"].map(|n| link(n, cube())).into(),
        joints: vec![step("ab", 0), step("bc", 1)],
        disabled_pairs: if has_srdf { vec![("a".into(), "c".into(), "Never".into())] } else { Vec::new() },
        has_srdf,
        ..Model::default()
    }
}

fn names(robot: &Robot, scene: &CollisionScene) -> Vec<String> {
    let name = |s: foliate_components::robot::ShapeIndex| robot.links[scene.solids()[s.at()].link.at()].name.clone();
    scene.pairs().iter().map(|p| format!("{} {}", name(p.first), name(p.second))).collect()
}

#[test]
fn disabled_and_ignored_links_are_left_alone_and_counted() {
    let (with, without) = (chain(true), chain(false));
    let robot = compose(&[
        (&with, placed("p", PartKind::Robot, RootJoint::Fixed, Pose::IDENTITY)),
        (&without, placed("q", PartKind::Robot, RootJoint::Fixed, at(0.0, 2.0, 0.0))),
    ]);
    let scene = CollisionScene::new(&robot, &PairRule::default());
    let own = |part: &str| -> Vec<String> {
        let both = |n: &&String| n.split(' ').all(|w| w.starts_with(part));
        names(&robot, &scene).iter().filter(both).cloned().collect()
    };
    // Neighbours stay, and what an SRDF disables goes.
    assert_eq!(own("p/"), ["p/a p/b", "p/b p/c"]);
    assert_eq!(own("q/"), ["q/a q/b", "q/a q/c", "q/b q/c"]);
    // Between parts: everything but what is fixed on both sides.
    assert_eq!(scene.pairs().len(), 5 + 8);
    let counts = PairCounts { tested: 13, environment: 1, srdf: 1, ..PairCounts::default() };
    assert_eq!(scene.counts(), counts);
    let pair = |a: &str, b: &str| (robot.link(a).unwrap(), robot.link(b).unwrap());
    let ignored = [("q/c", "p/c", "scene"), ("q/b", "q/a", DisabledPair::ADJACENT), ("p/c", "p/a", "scene")];
    let ignored = ignored.map(|(a, b, reason)| {
        let (first, second) = pair(a, b);
        DisabledPair { first, second, reason: reason.into() }
    });
    // A locked first joint fixes link b to the world: nothing between it and the other base remains to be watched.
    let locked = [robot.joint("p/ab").unwrap()];
    let rule = PairRule { ignored: &ignored, locked: &locked, ..PairRule::default() };
    let scene = CollisionScene::new(&robot, &rule);
    let fixed: Vec<String> = scene.fixed_pairs().map(|id| names(&robot, &scene)[id.at()].clone()).collect();
    assert_eq!(fixed, ["p/a p/b", "p/b q/a"]);
    // Where an SRDF disables what the scene ignores too, it is the SRDF's.
    let counts = PairCounts { tested: 9, rigid: 2, environment: 1, srdf: 1, adjacent: 1, ignored: 1, ..counts };
    assert_eq!(scene.counts(), counts);
    // By name they are as many.
    let mut listed = PairCounts { tested: 9, rigid: 2, ..PairCounts::default() };
    scene.left_out(&robot, &rule).iter().for_each(|pair| listed.leave_out(pair.why, 1));
    assert_eq!(listed, counts);
    let every = counts.looked_at() + counts.decided() + counts.environment + counts.same_body;
    assert_eq!(every as usize, robot.shapes.len() * (robot.shapes.len() - 1) / 2);
}

/// A floor with a wall fixed to it, a carriage that runs along the floor at a height, and a hand that turns on the carriage.
fn cell(height: f64, hand: f64, limits: (f64, f64)) -> Model {
    let mut rail = joint("rail", JointKind::Prismatic, 0, 2, at(0.0, 0.0, 0.05 + height + 0.1), DVec3::X);
    rail.limits = (-1.2, 1.2);
    let mut wrist = joint("wrist", JointKind::Revolute, 3, 4, Pose::IDENTITY, DVec3::Z);
    wrist.limits = limits;
    Model {
        links: vec![
            link("floor", vec![(Pose::IDENTITY, cuboid(3.0, 1.0, 0.1))]),
            link("wall", vec![(Pose::IDENTITY, cuboid(0.1, 1.0, 0.7))]),
            link("carriage", vec![(Pose::IDENTITY, cuboid(0.3, 0.3, 0.2))]),
            link("mount", Vec::new()),
            link("hand", vec![(at(hand, 0.0, 0.0), cuboid(0.1, 0.1, 0.1))]),
        ],
        joints: vec![
            joint("wall_mount", JointKind::Fixed, 0, 1, at(0.5, 0.0, 0.4), DVec3::Z),
            rail,
            joint("flange", JointKind::Fixed, 2, 3, at(0.0, 0.0, 0.1), DVec3::Z),
            wrist,
        ],
        ..Model::default()
    }
}

#[test]
fn neighbours_are_joined_by_one_joint_and_touch_wherever_it_is() {
    let adjacent = |model: &Model| -> Vec<String> {
        let robot = compose(&[(model, placed("p", PartKind::Robot, RootJoint::Fixed, Pose::IDENTITY))]);
        let name = |l: foliate_components::robot::LinkIndex| robot.links[l.at()].name["p/".len()..].to_owned();
        let pairs = adjacent_links(&robot, robot.part("p").unwrap());
        assert!(pairs.iter().all(|p| p.reason == DisabledPair::ADJACENT));
        pairs.iter().map(|p| format!("{} {}", name(p.first), name(p.second))).collect()
    };
    let turn = (-3.0, 3.0);
    // The carriage slides on the floor; the wall, which is fixed to the floor, is in its way.
    assert_eq!(adjacent(&cell(0.0, 0.0, turn)), ["floor carriage", "carriage hand"]);
    assert_eq!(adjacent(&cell(-0.01, 0.0, turn)), ["floor carriage", "carriage hand"]);
    // It hovers: nothing touches, and nothing is left out.
    assert_eq!(adjacent(&cell(0.01, 0.0, turn)), ["carriage hand"]);
    // A hand that reaches beside the carriage on half of its turn.
    let mut half = cell(0.0, 0.24, turn);
    half.joints[3].parent_from_joint = at(0.06, 0.0, 0.0);
    assert_eq!(adjacent(&half), ["floor carriage"]);
    half.joints[3].limits = (2.5, 3.5);
    assert_eq!(adjacent(&half), ["floor carriage", "carriage hand"]);
    half.joints[3].kind = JointKind::Continuous;
    half.joints[3].limits = (f64::NEG_INFINITY, f64::INFINITY);
    assert_eq!(adjacent(&half), ["floor carriage"]);
    // A carriage that leaves the floor at the end of its rail.
    let mut long = cell(0.0, 0.0, turn);
    long.joints[1].limits = (-1.2, 2.0);
    assert_eq!(adjacent(&long), ["carriage hand"]);
}

struct Shelf {
    robot: Robot,
    kinematics: Kinematics,
}

/// A box of 10 cm that flies over a board whose upper side is at z = 0.
fn shelf() -> Shelf {
    let (cube, board) =
        (single(vec![(Pose::IDENTITY, cuboid(0.1, 0.1, 0.1))]), single(vec![(Pose::IDENTITY, cuboid(2.0, 2.0, 0.05))]));
    let robot = compose(&[
        (&cube, placed("box", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY)),
        (&board, placed("board", PartKind::Environment, RootJoint::Fixed, at(0.0, 0.0, -0.025))),
    ]);
    Shelf { kinematics: Kinematics::new(&robot), robot }
}

impl Shelf {
    fn at(&self, pose: Pose) -> Vec<f64> {
        let mut q = self.robot.space.neutral();
        place(&self.robot, &mut q, "box", pose);
        q
    }
}

#[test]
fn margins_hold_unless_the_pair_touches() {
    let shelf = shelf();
    let (first, second) = (shelf.robot.link("board/body").unwrap(), shelf.robot.link("box/body").unwrap());
    let margins = [Margin { first, second, distance: 0.02 }];
    let scene = CollisionScene::new(&shelf.robot, &PairRule { margins: &margins, ..PairRule::default() });
    let mut scratch = CollisionScratch::new();
    let (strict, waived) = (PairSet::new(&scene, &[], &[]), PairSet::new(&scene, &[], &[(second, first)]));
    let mut verdict = |pairs: &PairSet, height: f64| {
        let mut X_WJ = [Pose::IDENTITY];
        shelf.kinematics.forward(&shelf.at(at(0.3, 0.2, 0.05 + height)), &mut X_WJ);
        first_collision(&scene, &X_WJ, pairs, 1e-5, &mut scratch).map(|c| c.clearance)
    };
    assert!(verdict(&strict, 0.0201).is_none());
    let short = verdict(&strict, 0.0199).unwrap();
    assert!(short > 0.0190 && short <= 0.0199);
    assert!(verdict(&waived, 0.001).is_none());
    assert!(verdict(&waived, -0.001).unwrap() <= 0.0);
    let certify = |pairs: &PairSet, to: f64, s: &mut CollisionScratch| {
        let (a, b) = (shelf.at(at(0.0, 0.0, 0.25)), shelf.at(at(0.1, 0.0, 0.05 + to)));
        certify_motion(&scene, &shelf.kinematics, &[], &a, &b, pairs, &CertificateSettings::default(), s)
    };
    assert!(
        matches!(certify(&strict, 0.021, &mut scratch), MotionVerdict::Free { min_clearance_lower_bound: c } if c >= 0.02)
    );
    let MotionVerdict::FreeUntil { t, .. } = certify(&strict, 0.0, &mut scratch) else { panic!("margin ignored") };
    // The gap goes from 0.2 to 0, the margin is met at 90 %.
    assert!(t > 0.89 && t <= 0.9, "{t}");
    assert!(matches!(certify(&waived, 0.001, &mut scratch), MotionVerdict::Free { .. }));
}

#[test]
fn a_box_may_slide_turn_and_rise_a_millimetre_above_its_support() {
    let shelf = shelf();
    let scene = CollisionScene::new(&shelf.robot, &PairRule::default());
    let pairs = PairSet::new(&scene, &[], &[]);
    let rest = |x: f64, angle: f64, up: f64| {
        shelf.at(Pose::from_parts(DVec3::new(x, 0.0, 0.051 + up), glam::DQuat::from_rotation_z(angle)))
    };
    let mut scratch = CollisionScratch::new();
    for (to, what) in [(rest(0.0, 0.0, 0.1), "rise"), (rest(0.5, 0.0, 0.0), "slide"), (rest(0.5, 1.0, 0.0), "turn")] {
        let settings = CertificateSettings::default();
        let from = rest(0.0, 0.0, 0.0);
        let verdict = certify_motion(&scene, &shelf.kinematics, &[], &from, &to, &pairs, &settings, &mut scratch);
        assert!(matches!(verdict, MotionVerdict::Free { .. }), "{what}: {verdict:?}");
    }
    // One millimetre and a half deeper is too deep.
    let settings = CertificateSettings::default();
    let (from, to) = (rest(0.0, 0.0, 0.0), rest(0.5, 0.0, -0.0015));
    let verdict = certify_motion(&scene, &shelf.kinematics, &[], &from, &to, &pairs, &settings, &mut scratch);
    let MotionVerdict::FreeUntil { t, .. } = verdict else { panic!("went through the board") };
    assert!(t > 0.63 && t < 0.667, "{t}");
}

#[test]
fn what_is_placed_or_carried_together_is_constant() {
    let cube = single(vec![(Pose::IDENTITY, cuboid(0.1, 0.1, 0.1))]);
    let chain = chain(true);
    let robot = compose(&[
        (&chain, placed("arm", PartKind::Robot, RootJoint::Fixed, Pose::IDENTITY)),
        (&cube, placed("one", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY)),
        (&cube, placed("two", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY)),
    ]);
    let scene = CollisionScene::new(&robot, &PairRule::default());
    let all = scene.pairs().len();
    let (one, two) = (JointIndex(2), JointIndex(3));
    let carry = |object, carrier| RigidAttachment { object, carrier, X_CO: at(0.0, 0.0, 0.3) };
    let constant = |rigid_attachments: &[RigidAttachment]| {
        let set = PairSet::new(&scene, rigid_attachments, &[]);
        assert_eq!(set.moving_pairs(&scene).count() + set.constant_pairs(&scene).count(), all);
        set.constant_pairs(&scene).map(|id| names(&robot, &scene)[id.at()].clone()).collect::<Vec<_>>()
    };
    assert!(constant(&[]).is_empty());
    assert_eq!(
        constant(&[carry(one, None), carry(two, None)]),
        ["arm/a one/body", "arm/a two/body", "one/body two/body"]
    );
    assert_eq!(constant(&[carry(one, Some(JointIndex(1)))]), ["arm/c one/body"]);
    let stacked = [carry(one, Some(JointIndex(0))), carry(two, Some(one))];
    assert_eq!(constant(&stacked), ["arm/b one/body", "arm/b two/body", "one/body two/body"]);
    // A circle of carriers is nonsense, and must end.
    constant(&[carry(one, Some(two)), carry(two, Some(one))]);
    let X_WJ = vec![Pose::IDENTITY; 4];
    let set = PairSet::new(&scene, &stacked, &[]);
    assert!(min_clearance(&scene, &X_WJ, set.constant_pairs(&scene)).unwrap().clearance <= 0.0);
}
