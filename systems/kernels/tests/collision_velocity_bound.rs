//! No two points of a pair come closer within an interval than the velocity bound says.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{bench, mover, place, random_configuration, random_pose};
use foliate_components::Pose;
use foliate_components::robot::configuration::{Group, quaternion};
use foliate_components::robot::{JointIndex, Robot};
use foliate_kernels::collision::samples::motion_bound::MotionBound;
use foliate_kernels::collision::scene::SceneSolid;
use foliate_kernels::collision::{CollisionScene, PairId, PairRule, PairSet, Solid};
use foliate_kernels::curve::{Cubic, HermiteCurve};
use foliate_kernels::kinematics::{Kinematics, RigidAttachment};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

#[derive(Default)]
struct Tally {
    checked: usize,
    tightest: f64,
    tightest_along: f64,
    /// How often the directional bound is the smaller one.
    smaller: usize,
    ratios: Vec<f64>,
}

/// A random point on the surface of a solid, in its body's frame.
fn point_of(solid: &SceneSolid, rng: &mut ChaCha8Rng) -> DVec3 {
    let d = collision_models::random_vector(rng, 1.0);
    let p = match &solid.solid {
        Solid::Convex(convex) => convex.core.support(d) + d.normalize() * convex.radius,
        Solid::Mesh(_) => unreachable!("no meshes in these models"),
    };
    solid.X_JS.transform_point(p)
}

fn poses(kinematics: &Kinematics, rigid_attachments: &[RigidAttachment], q: &[f64]) -> Vec<Pose> {
    let mut X_WJ = vec![Pose::IDENTITY; kinematics.bodies()];
    kinematics.forward(q, &mut X_WJ);
    kinematics.carry(q, rigid_attachments, &mut X_WJ);
    X_WJ
}

/// A body and its ancestors, carried objects below their carriers.
fn ancestors(robot: &Robot, rigid_attachments: &[RigidAttachment], body: Option<JointIndex>) -> Vec<JointIndex> {
    let up = |&body: &JointIndex| match rigid_attachments.iter().find(|c| c.object == body) {
        Some(c) => c.carrier,
        None => robot.joints[body.at()].parent,
    };
    std::iter::successors(body, up).collect()
}

fn common_ancestor(
    robot: &Robot,
    rigid_attachments: &[RigidAttachment],
    a: Option<JointIndex>,
    b: Option<JointIndex>,
) -> Option<JointIndex> {
    let other = ancestors(robot, rigid_attachments, b);
    ancestors(robot, rigid_attachments, a).into_iter().find(|j| other.contains(j))
}

/// A motion on u ∈ [0, 1].
enum Way<'a> {
    Straight(&'a [f64], &'a [f64]),
    Curve(HermiteCurve<'a>),
}

impl Way<'_> {
    fn at(&self, robot: &Robot, u: f64, q: &mut [f64]) {
        match self {
            Self::Straight(a, b) => robot.space.interpolate(a, b, u, q),
            Self::Curve(curve) => curve.at(&robot.space, 0, u, q),
        }
    }
}

fn check_motion(
    robot: &Robot,
    rigid_attachments: &[RigidAttachment],
    way: &Way<'_>,
    rng: &mut ChaCha8Rng,
    tally: &mut Tally,
) {
    let (scene, kinematics) = (CollisionScene::new(robot, &PairRule::default()), Kinematics::new(robot));
    let pairs = PairSet::new(&scene, rigid_attachments, &[]);
    let mut bound = MotionBound::default();
    let size = robot.space.size();
    let cubics: Vec<Cubic> = match way {
        Way::Straight(a, b) => {
            let mut delta = vec![0.0; robot.space.dimension()];
            robot.space.difference(a, b, &mut delta);
            bound.begin(&scene, &pairs, a, &delta);
            Vec::new()
        }
        Way::Curve(curve) => {
            let cubics: Vec<_> = (0..size).map(|i| curve.cubic(size, 0, i)).collect();
            bound.begin_curve(&scene, &pairs, &cubics);
            cubics
        }
    };
    let moving: Vec<PairId> = pairs.moving_pairs(&scene).collect();
    for _ in 0..6 {
        let half = 0.5 * 2.0_f64.powi(-rng.random_range(0..6));
        let middle = rng.random_range(half..=1.0 - half);
        let mut q = robot.space.neutral();
        way.at(robot, middle, &mut q);
        let X_mid = poses(&kinematics, rigid_attachments, &q);
        match way {
            Way::Straight(..) => bound.look_at(&scene, &X_mid, half),
            Way::Curve(_) => bound.look_at_curve(&scene, &X_mid, &cubics, (middle, half)),
        }
        for _ in 0..40 {
            let id = moving[rng.random_range(0..moving.len())];
            let closer = bound.of_pair(&scene, &pairs, id, &X_mid);
            let pair = scene.pairs()[id.at()];
            let (one, other) = (&scene.solids()[pair.first.at()], &scene.solids()[pair.second.at()]);
            let in_world = |s: &SceneSolid, p: DVec3, X: &[Pose]| s.body.map_or(p, |j| X[j.at()].transform_point(p));
            let n = collision_models::random_vector(rng, 1.0).normalize();
            let along = bound.of_pair_along(&scene, &pairs, id, &X_mid, n);
            // The direction is fixed in the frame of the nearest common ancestor.
            let ancestor = common_ancestor(robot, rigid_attachments, one.body, other.body);
            let frame = |X: &[Pose]| ancestor.map_or(Pose::IDENTITY, |j| X[j.at()]);
            let local = frame(&X_mid).rotation.inverse() * n;
            let mut most_along = 0.0_f64;
            let mut most = 0.0_f64;
            for _ in 0..10 {
                let (p, r) = (point_of(one, rng), point_of(other, rng));
                let before = in_world(one, p, &X_mid).distance(in_world(other, r, &X_mid));
                way.at(robot, middle + half * rng.random_range(-1.0..=1.0), &mut q);
                let X_now = poses(&kinematics, rigid_attachments, &q);
                let now = in_world(one, p, &X_now).distance(in_world(other, r, &X_now));
                most = most.max((now - before).abs());
                let gap = |X: &[Pose]| (in_world(one, p, X) - in_world(other, r, X)).dot(frame(X).rotation * local);
                most_along = most_along.max((gap(&X_now) - gap(&X_mid)).abs());
            }
            assert!(
                most <= closer + 1e-9,
                "{} and {}: {most} > {closer}",
                robot.shapes[pair.first.at()].name,
                robot.shapes[pair.second.at()].name
            );
            assert!(most_along <= along + 1e-9, "along {n}: {most_along} > {along}");
            tally.checked += 1;
            if along > 0.0 {
                tally.tightest_along = tally.tightest_along.max(most_along / along);
                tally.smaller += usize::from(along < closer);
            }
            if closer > 0.0 {
                tally.tightest = tally.tightest.max(most / closer);
                tally.ratios.push(most / closer);
            }
        }
    }
}

/// The straight motion between two configurations, and a curve between them with random velocities.
fn check_both(
    robot: &Robot,
    rigid_attachments: &[RigidAttachment],
    (a, b): (&[f64], &[f64]),
    rng: &mut ChaCha8Rng,
    tallies: &mut [Tally; 2],
) {
    check_motion(robot, rigid_attachments, &Way::Straight(a, b), rng, &mut tallies[0]);
    let mut knots = [a, b].concat();
    for factor in robot.space.factors.iter().filter(|f| f.group == Group::FreeFlyer) {
        // Two quaternions on one side of the sphere.
        let (from, to) = (quaternion(a, factor.q), quaternion(b, factor.q));
        if from.dot(to) < 0.0 {
            knots[a.len() + factor.q + 3..][..4].iter_mut().for_each(|x| *x = -*x);
        }
    }
    let pace = 10.0_f64.powf(rng.random_range(-2.0..0.0));
    let velocities: Vec<f64> = knots.iter().map(|_| pace * rng.random_range(-1.0..=1.0)).collect();
    let curve = HermiteCurve { knots: &knots, velocities: &velocities, times: &[0.0, 0.8] };
    assert!(curve.is_sound(&robot.space));
    check_motion(robot, rigid_attachments, &Way::Curve(curve), rng, &mut tallies[1]);
}

fn report(name: &str, mut tally: Tally) {
    tally.ratios.sort_by(f64::total_cmp);
    let median = tally.ratios[tally.ratios.len() / 2];
    println!(
        "{name}: {} intervals, motion/bound median {median:.3}, largest {:.3}; along a direction largest {:.3}, smaller {}",
        tally.checked, tally.tightest, tally.tightest_along, tally.smaller
    );
    assert!(tally.tightest > 0.3, "a bound that nothing comes near is no bound worth having");
}

#[test]
fn holds_for_two_arms_with_held_and_placed_boxes() {
    let robot = bench();
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    let mut tallies = <[Tally; 2]>::default();
    let root = |part: &str| robot.parts[robot.part(part).unwrap().at()].root_joint.unwrap();
    for round in 0..60 {
        let (a, b) = (random_configuration(&robot, &mut rng), random_configuration(&robot, &mut rng));
        let held = RigidAttachment {
            object: root("box1"),
            carrier: robot.joint(if round % 2 == 0 { "robot/left_j6" } else { "robot/right_j3" }),
            X_CO: random_pose(&mut rng, 0.3),
        };
        let on_it = RigidAttachment {
            object: root("box2"),
            carrier: if round % 3 == 0 { None } else { Some(root("box1")) },
            X_CO: random_pose(&mut rng, 0.3),
        };
        let rigid_attachments = [held, on_it];
        check_both(&robot, &rigid_attachments[..round % 3], (&a, &b), &mut rng, &mut tallies);
    }
    let [straight, curved] = tallies;
    report("two arms", straight);
    report("two arms on curves", curved);
}

#[test]
fn holds_for_planar_roots_prismatic_lifts_and_followers() {
    let robot = mover();
    let mut rng = ChaCha8Rng::seed_from_u64(22);
    let mut tallies = <[Tally; 2]>::default();
    for round in 0..60 {
        let (a, mut b) = (random_configuration(&robot, &mut rng), random_configuration(&robot, &mut rng));
        if round % 4 == 0 {
            place(&robot, &mut b, "flyer", random_pose(&mut rng, 2.0));
        }
        check_both(&robot, &[], (&a, &b), &mut rng, &mut tallies);
    }
    let [straight, curved] = tallies;
    report("lift", straight);
    report("lift on curves", curved);
}
