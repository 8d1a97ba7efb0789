//! Robots that drive: their roots are drawn within bounds, weigh as far as they move things, and take the arm to what a
//! fixed one could not reach. A root without bounds is refused, because nothing could be drawn evenly.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]
#![allow(non_snake_case, reason = "pose names carry their frames")]

mod common;

use common::{model, search, seeded, stop_within};
use foliate_components::Pose;
use foliate_components::candidate::CandidateArena;
use foliate_components::constraint::Rests;
use foliate_components::outcome::SearchOutcome;
use foliate_components::pose::pose_from_array;
use foliate_components::problem::{Goal, GraphOptions, ObjectOptions, Problem};
use foliate_components::robot::{PartIndex, PartKind, PartPlacement, Robot, RootJoint};
use foliate_components::samples::models::{block, environment, movable_object, part, seven_axis_arm, table};
use foliate_kernels::collision::adjacent_links;
use foliate_schedulers::mrrt::Mrrt;
use foliate_systems::events::EventSink;
use foliate_systems::planning_model::{Model, ModelError};
use foliate_systems::search::Search;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const BOUNDS: [(f64, f64); 3] = [(-1.0, 0.0), (-1.5, 1.5), (-1.5, 1.5)];

/// An arm on a base that drives along a table; the box shall go from one end to the other.
fn mobile_arm(root: RootJoint, root_bounds: Vec<(f64, f64)>) -> Problem {
    let (arm, board, cube) = (seven_axis_arm(), table(DVec3::new(0.6, 3.0, 0.05)), block(DVec3::splat(0.06)));
    let at = |z| Pose::from_translation(DVec3::Z * z);
    let base = PartPlacement { root_bounds, ..part("base", PartKind::Robot, root, at(0.3)) };
    let robot = Robot::compose(&[
        (&arm, base),
        (&board, environment("table", Pose::from_translation(DVec3::new(0.6, 0.0, 0.0)))),
        (&cube, movable_object("box")),
    ])
    .unwrap();
    let graph = GraphOptions {
        grippers: vec![robot.gripper("base/hand").unwrap()],
        objects: vec![ObjectOptions {
            part: robot.part("box").unwrap(),
            handles: vec![robot.handle("box/top").unwrap()],
            surfaces: vec![robot.surface("box/bottom").unwrap()],
            plane: None,
        }],
        supports: vec![robot.surface("table/top").unwrap()],
        placement_margin: 1e-3,
        preplacement_distance: 0.05,
        rests: Rests::Centre,
        ..GraphOptions::default()
    };
    let mut start = robot.space.neutral();
    let arm_at = robot.space.size() - 14;
    start[arm_at..arm_at + 7].copy_from_slice(&[0.0, -0.6, 0.0, 1.4, 0.0, 0.8, 0.0]);
    let root = robot.parts[robot.part("box").unwrap().0 as usize].root_joint.unwrap();
    assert_eq!(robot.joints[root.at()].name, "box/root_joint");
    start[arm_at + 7..].copy_from_slice(&[0.6, -1.3, 0.031, 0.0, 0.0, 0.0, 1.0]);
    let goal = pose_from_array([0.6, 1.3, 0.031, 0.0, 0.0, 0.0, 1.0]).unwrap();
    let goals = vec![Goal::object_poses(vec![(robot.part("box").unwrap(), goal)])];
    let ignored_pairs =
        (0..robot.parts.len() as u32).flat_map(|part| adjacent_links(&robot, PartIndex(part))).collect();
    Problem { graph, ignored_pairs, ..Problem::new("mobile arm", robot, start, goals) }
}

#[test]
fn a_root_without_bounds_is_refused_by_name_and_axis() {
    let refused = |problem| match Model::new(problem) {
        Err(ModelError::UnboundedRoot(why)) => why.to_string(),
        other => format!("{:?}", other.map(|_| "accepted")),
    };
    let why = refused(mobile_arm(RootJoint::Planar, Vec::new()));
    assert!(why.contains("base/root_joint") && why.contains("along x") && why.contains("without bounds"), "{why}");
    let why = refused(mobile_arm(RootJoint::FreeFlyer, vec![(-1.0, 1.0), (-1.0, 1.0)]));
    assert!(why.contains("along z"), "{why}");
    // The angle of a planar root may be unlimited.
    assert!(Model::new(mobile_arm(RootJoint::Planar, BOUNDS[..2].to_vec())).is_ok());
}

#[test]
fn random_configurations_keep_to_the_bounds_of_roots() {
    for (root, bounds) in [(RootJoint::Planar, BOUNDS.to_vec()), (RootJoint::FreeFlyer, vec![(-0.2, 0.1); 3])] {
        let model = model(mobile_arm(root, bounds));
        let mut search = Search::new(&model, &Mrrt, seeded(3), stop_within(60), EventSink::default());
        let space = &model.problem.robot.space;
        let mut spread = vec![(f64::INFINITY, f64::NEG_INFINITY); space.size()];
        for _ in 0..20 {
            search.step();
            for q in search.world().resource::<CandidateArena>().random.chunks_exact(space.size()) {
                assert_eq!(space.first_out_of_bounds(q, 0.0), None);
                for (range, &x) in spread.iter_mut().zip(q) {
                    *range = (range.0.min(x), range.1.max(x));
                }
            }
        }
        for (i, range) in spread.iter().enumerate().take(2) {
            let whole = space.upper[i] - space.lower[i];
            assert!(range.1 - range.0 > 0.8 * whole, "number {i} was drawn in {range:?} only");
        }
    }
}

/// The weight of a root's turn is an upper bound of how far a turn of one radian moves anything, and not a wild one.
#[test]
fn the_turn_of_a_root_weighs_as_far_as_it_moves_things() {
    let problem = mobile_arm(RootJoint::Planar, BOUNDS.to_vec());
    let model = Model::new(problem).unwrap();
    let robot = &model.problem.robot;
    let weights = &model.weights[..3];
    assert_eq!(&weights[..2], [1.0, 1.0]);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    let mut farthest = 0.0_f64;
    for _ in 0..2000 {
        let mut q = robot.space.neutral();
        robot.space.random(&mut rng, &mut q);
        // Stretched as often as not.
        if rng.random::<bool>() {
            q[3..10].fill(0.0);
        }
        model.kinematics.forward(&q, &mut X_WJ);
        let (base, arm) = (DVec3::new(q[0], q[1], 0.3), robot.part("base").unwrap());
        for shape in &robot.shapes {
            let link = &robot.links[shape.link.at()];
            if link.part == arm
                && let Some(joint) = link.joint
            {
                let at = (X_WJ[joint.at()] * shape.joint_from_shape).translation - base;
                farthest = farthest.max((at * DVec3::new(1.0, 1.0, 0.0)).length());
            }
        }
    }
    assert!(weights[2] >= farthest, "{} < {farthest}", weights[2]);
    // A stretched arm that stands upright reaches as far up as it would sideways.
    assert!(weights[2] < 4.0, "a weight of {} would drown the joints", weights[2]);
}

#[test]
fn a_base_takes_its_arm_to_what_is_out_of_reach() {
    let model = model(mobile_arm(RootJoint::Planar, BOUNDS.to_vec()));
    for seed in 1..=3 {
        let (outcome, search) = search(&model, &Mrrt, seeded(seed), 2);
        assert_eq!(outcome, SearchOutcome::Solved);
        let path = search.path().unwrap();
        let space = &model.problem.robot.space;
        for knot in path.segments.iter().flat_map(|s| &s.knots) {
            assert_eq!(space.first_out_of_bounds(knot, 1e-9), None);
        }
    }
}
