//! What a robot program asks of an answer is answered from the path's curve: joints by name, poses, what is held, events.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

mod common;

use common::timed::rest_to_rest;
use foliate::components::path::{EventKind, ManipulationPath, Segment, SegmentTiming};
use foliate::components::problem::Problem;
use foliate::components::robot::{JointIndex, PartKind, PartPlacement, Robot, RootJoint};
use foliate::components::samples::models::two_finger_hand;
use foliate::components::samples::swap_two_boxes;
use foliate::prelude::*;
use foliate::trajectory::Interpolation;

/// A solved problem whose path has simple times, from rest to rest.
fn solved() -> (Problem, Solution) {
    let problem = swap_two_boxes().unwrap();
    let mut solution = Planner::new(problem.clone()).unwrap().seed(7).first_path().solve_on(1).unwrap();
    rest_to_rest(&problem, &mut solution.path);
    (problem, solution)
}

#[test]
fn a_path_without_times_says_so() {
    let solution = Planner::new(swap_two_boxes().unwrap()).unwrap().seed(7).first_path().solve_on(1).unwrap();
    assert!(matches!(solution.trajectory(), Err(TrajectoryError::NoTimes)));
}

#[test]
fn joints_are_where_the_curve_has_them_and_the_last_sample_is_the_end() {
    let (_, solution) = solved();
    let trajectory = solution.trajectory().unwrap();
    let robot = trajectory.robots().next().unwrap();
    let joints = trajectory.joints_of(robot).unwrap();
    assert_eq!(joints.names(), trajectory.joint_names(robot).unwrap());
    let samples: Vec<_> = joints.sampled(500.0).unwrap().collect();
    assert!(samples.len() > 500);
    let (first, last) = (&samples[0], &samples[samples.len() - 1]);
    assert_eq!((first.time, last.time), (0.0, trajectory.end()));
    assert_eq!(trajectory.duration(), trajectory.end());
    let knots = (&solution.path.segments[0].knots[0], solution.path.segments.last().unwrap().knots.last().unwrap());
    let of = |knot: &Vec<f64>| -> Vec<f64> {
        let robot = trajectory.robot();
        joints
            .indices()
            .iter()
            .map(|j| match robot.joints[j.at()].source {
                foliate::components::robot::Source::Coordinates { q, .. } => knot[q],
                foliate::components::robot::Source::Follows { .. } => panic!("nothing follows here"),
            })
            .collect()
    };
    // Bit for bit at the ends.
    assert_eq!((first.positions.clone(), last.positions.clone()), (of(knots.0), of(knots.1)));
    // Between them what moves is the integral of how fast it moves.
    for pair in samples.windows(2) {
        let by = pair[1].time - pair[0].time;
        for i in 0..joints.names().len() {
            let mean = 0.5 * (pair[0].velocities[i] + pair[1].velocities[i]);
            let moved = pair[1].positions[i] - pair[0].positions[i];
            assert!((moved - mean * by).abs() < 1e-4, "{} {}: {moved} {}", pair[0].time, joints.names()[i], mean * by);
        }
    }
    // Outside it stands at the ends.
    assert_eq!(joints.at(-5.0).positions, first.positions);
    assert_eq!(joints.at(1e9).positions, last.positions);
    assert_eq!(joints.at(f64::NAN).positions, first.positions);
}

#[test]
fn events_are_where_what_is_held_changes() {
    let (_, solution) = solved();
    let trajectory = solution.trajectory().unwrap();
    let (segments, events) = (trajectory.segments(), trajectory.events());
    assert_eq!(segments.len(), solution.path.segments.len());
    assert!(segments.windows(2).all(|pair| pair[0].end == pair[1].start));
    assert!(events.iter().any(|e| e.kind == EventKind::Grasp) && events.iter().any(|e| e.kind == EventKind::Release));
    for event in &events {
        let (before, after) = (&segments[event.segment - 1], &segments[event.segment]);
        assert_eq!((event.time, before.end), (after.start, after.start));
        let holds = |segment: &foliate::trajectory::TrajectorySegment<'_>| {
            segment.held.iter().any(|h| (h.gripper, h.object, h.handle) == (event.gripper, event.object, event.handle))
        };
        let (wanted_before, wanted_after) = (event.kind == EventKind::Release, event.kind == EventKind::Grasp);
        assert_eq!((holds(before), holds(after)), (wanted_before, wanted_after), "{event:?}");
        // All joints stand still then.
        let robot = trajectory.robots().next().unwrap();
        assert!(trajectory.joints_of(robot).unwrap().at(event.time).velocities.iter().all(|v| *v == 0.0));
    }
    // From the time of a grasp on the object is held.
    let grasp = events.iter().find(|e| e.kind == EventKind::Grasp).unwrap();
    assert!(trajectory.segment_at(grasp.time).held.iter().any(|h| h.object == grasp.object));
}

#[test]
fn a_held_object_keeps_its_pose_in_the_hand_and_others_stay() {
    let (problem, solution) = solved();
    let trajectory = solution.trajectory().unwrap();
    let mut poses = trajectory.poses();
    let mut held_somewhere = 0;
    for segment in trajectory.segments() {
        for object in trajectory.objects() {
            let link = trajectory.link(object).unwrap();
            let holder = segment.held.iter().find(|held| held.object == object);
            let hand =
                holder.map(|held| problem.robot.grippers[problem.robot.gripper(held.gripper).unwrap().at()].link);
            let mut first = None;
            for step in 0..=20 {
                let time = segment.start + (segment.end - segment.start) * f64::from(step) / 20.0 * 0.999_999;
                poses.place(time);
                let pose = hand.map_or(poses.link(link), |hand| poses.link(hand).inverse() * poses.link(link));
                let first = *first.get_or_insert(pose);
                assert!((pose.translation - first.translation).length() < 1e-12, "{object} {time}");
                assert!((pose.rotation - first.rotation).length() < 1e-12, "{object} {time}");
                let asked = trajectory.pose(object, time).unwrap();
                assert_eq!(asked, poses.link(link));
                // The configuration says the same.
                let Ok(CoordinateValue::Pose(written)) = problem.robot.get(poses.configuration(), object) else {
                    panic!("{object} flies freely")
                };
                assert!((written.translation - asked.translation).length() < 1e-9);
            }
            held_somewhere += usize::from(hand.is_some());
        }
    }
    assert!(held_somewhere >= 2, "{held_somewhere}");
    // At the end everything is where the last knot has it.
    let end = trajectory.configuration(trajectory.end());
    let written = solution.path.segments.last().unwrap().knots.last().unwrap();
    assert!(end.iter().zip(written).all(|(a, b)| (a - b).abs() < 1e-6), "{end:?} {written:?}");
}

#[test]
fn names_that_lead_nowhere_say_what_there_is() {
    let (_, solution) = solved();
    let trajectory = solution.trajectory().unwrap();
    let robot = trajectory.robots().next().unwrap();
    let told = trajectory.joints_of("nobody").unwrap_err().to_string();
    assert!(told.contains("nobody") && told.contains(robot), "{told}");
    let joint = trajectory.joint_names(robot).unwrap()[0];
    let told = trajectory.joints(&["no_joint"]).unwrap_err().to_string();
    assert!(told.contains(joint), "{told}");
    // A bare name will do.
    let bare = joint.split_once('/').unwrap().1;
    assert_eq!(trajectory.joints(&[bare]).unwrap().names(), [joint]);
    assert!(trajectory.pose("nothing", 0.0).is_err());
    assert!(matches!(trajectory.sample_times(-1.0), Err(TrajectoryError::Rate(_))));
}

/// A hand whose right finger mimics the left one.
fn hand() -> Robot {
    let placement = PartPlacement {
        name: "hand".into(),
        kind: PartKind::Robot,
        root: RootJoint::Fixed,
        world_from_root: Pose::identity(),
        mimic_follows: true,
        root_bounds: Vec::new(),
        joint_bounds: Vec::new(),
    };
    Robot::compose(&[(&two_finger_hand(), placement)]).unwrap()
}

fn one_segment(knots: Vec<Vec<f64>>, times: Vec<f64>, velocities: Vec<Vec<f64>>) -> ManipulationPath {
    let segment = Segment {
        transition: foliate::components::graph::TransitionId(0),
        state: foliate::components::graph::StateId(0),
        attachments: Vec::new(),
        constraints: Vec::new(),
        knots,
        timing: Some(SegmentTiming { times, velocities }),
    };
    ManipulationPath { segments: vec![segment], ..ManipulationPath::default() }
}

#[test]
fn followers_follow_with_their_factor_and_offset() {
    let robot = hand();
    let path = one_segment(vec![vec![0.0], vec![0.04]], vec![0.0, 1.0], vec![vec![0.0], vec![0.1]]);
    let trajectory = Trajectory::new(&robot, &path, vec!["free"], Interpolation::Hermite).unwrap();
    let joints = trajectory.joints(&["hand/left_finger", "right_finger"]).unwrap();
    assert_eq!(trajectory.joint_names("hand").unwrap().len(), 2);
    let sample = joints.at(0.3);
    // 3u² − 2u³ of the way, and the velocity at the end.
    let wanted = 0.04 * (0.27 - 0.054) - 0.1 * 0.09 * 0.7;
    assert!((sample.positions[0] - wanted).abs() < 1e-15, "{sample:?}");
    assert_eq!(sample.positions[1], -sample.positions[0]);
    assert_eq!(sample.velocities[1], -sample.velocities[0]);
    assert_eq!(sample.accelerations[1], -sample.accelerations[0]);
    let last = joints.at(1.0);
    assert_eq!(last.positions, [0.04, -0.04]);
    assert!((last.velocities[0] - 0.1).abs() < 1e-15);
}

#[test]
fn straight_motions_have_constant_velocity() {
    let robot = hand();
    let path = one_segment(vec![vec![0.0], vec![0.04], vec![0.02]], vec![1.0, 2.0, 4.0], Vec::new());
    let trajectory = Trajectory::new(&robot, &path, vec!["free"], Interpolation::Linear).unwrap();
    let joints = trajectory.joints(&["left_finger"]).unwrap();
    assert_eq!((trajectory.start(), trajectory.duration()), (1.0, 3.0));
    let sample = joints.at(1.5);
    assert_eq!((sample.positions[0], sample.velocities[0], sample.accelerations[0]), (0.02, 0.04, 0.0));
    assert!((joints.at(3.0).velocities[0] + 0.01).abs() < 1e-15);
}

#[test]
fn numbers_that_make_no_motion_are_refused() {
    let robot = hand();
    let new = |path: &ManipulationPath| {
        Trajectory::new(&robot, path, vec!["free"], Interpolation::Hermite).map(|_| ()).unwrap_err()
    };
    let (two, still) = (|| vec![vec![0.0], vec![0.01]], || vec![vec![0.0], vec![0.0]]);
    let cases = [
        one_segment(two(), vec![1.0, 0.0], still()),
        one_segment(two(), vec![0.0, f64::NAN], still()),
        one_segment(two(), vec![0.0], still()),
        one_segment(two(), vec![0.0, 1.0], vec![vec![0.0]]),
        one_segment(two(), vec![0.0, 1.0], vec![vec![0.0], vec![f64::INFINITY]]),
        one_segment(vec![vec![0.0], vec![0.0, 1.0]], vec![0.0, 1.0], still()),
        one_segment(vec![vec![0.0]], vec![0.0], vec![vec![0.0]]),
    ];
    for path in &cases {
        assert!(matches!(new(path), TrajectoryError::Malformed { segment: 0, .. }), "{path:?}");
    }
    assert!(matches!(new(&ManipulationPath::default()), TrajectoryError::Empty));
}

#[test]
fn placing_everything_does_not_allocate() {
    let (_, solution) = solved();
    let trajectory = solution.trajectory().unwrap();
    let joints = trajectory.joints_of(trajectory.robots().next().unwrap()).unwrap();
    let (mut poses, mut sample) = (trajectory.poses(), joints.at(0.0));
    let link = trajectory.link(trajectory.objects().next().unwrap()).unwrap();
    let mut sum = 0.0;
    let asked = allocation_counter::measure(|| {
        for step in 0..200 {
            let time = trajectory.duration() * f64::from(step) / 200.0;
            poses.place(time);
            sum += poses.link(link).translation.x + poses.body(JointIndex(0)).translation.x;
            joints.sample_into(time, &mut sample);
        }
    });
    assert_eq!(asked.count_total, 0, "{sum}");
}
