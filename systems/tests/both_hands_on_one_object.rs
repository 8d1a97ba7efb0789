//! Two arms carry a long box together: a closed chain, in which every motion is projected knot by knot.

#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]

mod common;

use common::{model, search, seeded};
use foliate_components::Pose;
use foliate_components::constraint::Rests;
use foliate_components::constraint::{Constraint, Frame, Grasp, Reference, RelativePose};
use foliate_components::outcome::{Rejection, SearchOutcome, TransitionStatistics};
use foliate_components::path::{Attachment, ManipulationPath};
use foliate_components::pose::log_so3;
use foliate_components::problem::{Goal, GraphOptions, Moved, ObjectOptions, Problem, Rule};
use foliate_components::roadmap::NodeId;
use foliate_components::robot::{DisabledPair, GripperIndex, HandleIndex, PartIndex, Robot};
use foliate_components::samples::models::{block, environment, fixed_robot, movable_object, seven_axis_arm, table};
use foliate_kernels::collision::{
    CollisionScene, CollisionScratch, PairRule, PairSet, adjacent_links, first_collision,
};
use foliate_kernels::constrained_motion::{ConstraintProgram, Scratch, Settings, project};
use foliate_kernels::kinematics::Kinematics;
use foliate_schedulers::mrrt::Mrrt;
use foliate_schedulers::shipped;
use foliate_systems::search::Search;
use glam::{DQuat, DVec3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Where along the box its handles are, metres from the middle.
const HANDLE: f64 = 0.2;
const HALF_HEIGHT: f64 = 0.03;

/// Two arms side by side at a table, a bar that hangs over it, and a long box with a handle at either end.
struct Cell {
    robot: Robot,
    ignored: Vec<DisabledPair>,
    hands: [(GripperIndex, HandleIndex); 2],
}

impl Cell {
    fn new() -> Self {
        let arm = seven_axis_arm();
        let (board, bar) = (table(DVec3::new(1.0, 1.6, 0.05)), block(DVec3::new(0.04, 0.16, 0.04)));
        let mut plank = block(DVec3::new(0.05, 0.5, 2.0 * HALF_HEIGHT));
        let top = plank.handles[0].clone();
        plank.handles = [("left", HANDLE), ("right", -HANDLE)]
            .map(|(name, y)| {
                let mut handle = top.clone();
                handle.name = name.into();
                handle.link_from_handle.translation = DVec3::Y * y;
                handle
            })
            .to_vec();
        let at = |x, y, z| Pose::from_translation(DVec3::new(x, y, z));
        let robot = Robot::compose(&[
            (&arm, fixed_robot("left", at(0.0, 0.3, 0.3))),
            (&arm, fixed_robot("right", at(0.0, -0.3, 0.3))),
            (&board, environment("table", at(0.9, 0.0, -0.1))),
            (&bar, environment("bar", at(0.65, 0.0, 0.35))),
            (&plank, movable_object("plank")),
        ])
        .unwrap();
        let ignored = (0..robot.parts.len() as u32).flat_map(|part| adjacent_links(&robot, PartIndex(part))).collect();
        let hands = ["left", "right"].map(|side| {
            let gripper = robot.gripper(&format!("{side}/hand")).unwrap();
            (gripper, robot.handle(&format!("plank/{side}")).unwrap())
        });
        Self { robot, ignored, hands }
    }

    /// A collision-free configuration with the box at a pose and, where `held`, both hands on it: the arms bent as in
    /// `like`, or anyhow.
    fn configuration(&self, (x, z): (f64, f64), held: bool, like: Option<&[f64]>) -> Vec<f64> {
        let kinematics = Kinematics::new(&self.robot);
        let X_WB = Pose::from_parts(DVec3::new(x, 0.0, z), DQuat::IDENTITY);
        let root = self.robot.parts[self.robot.part("plank").unwrap().at()].root_joint;
        let lies =
            RelativePose::rigid(Frame::world(Pose::identity()), Frame::of_joint(root.unwrap()), Reference::Fixed(X_WB));
        let mut constraints = vec![Constraint::RelativePose(lies)];
        if held {
            let grasp = |(g, h)| Constraint::RelativePose(Grasp::new(&self.robot, g, h).unwrap().constraint());
            constraints.extend(self.hands.map(grasp));
        }
        let program = ConstraintProgram::compile(&self.robot, &kinematics, &constraints, &[], &[]).unwrap();
        let scene = CollisionScene::new(&self.robot, &PairRule { ignored: &self.ignored, ..PairRule::default() });
        let pairs = PairSet::new(&scene, &[], &[]);
        let (mut rng, mut scratch) = (ChaCha8Rng::seed_from_u64(1), Scratch::default());
        let mut q = self.robot.space.neutral();
        let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
        for _ in 0..20_000 {
            match like {
                Some(like) => q.copy_from_slice(like),
                None => self.robot.space.random(&mut rng, &mut q),
            }
            if project(&program, &mut q, &[], &Settings::default(), &mut scratch).is_converged() {
                kinematics.forward(&q, &mut X_WJ);
                if first_collision(&scene, &X_WJ, &pairs, 5e-4, &mut CollisionScratch::new()).is_none() {
                    return q;
                }
            }
        }
        panic!("no configuration with the box at x {x}, z {z}")
    }

    fn problem(&self, start: Vec<f64>, goal: Vec<f64>, rules: Vec<Rule>) -> Problem {
        let object = ObjectOptions {
            part: self.robot.part("plank").unwrap(),
            handles: self.hands.map(|(_, handle)| handle).to_vec(),
            surfaces: self.robot.surface("plank/bottom").into_iter().collect(),
            plane: None,
        };
        let graph = GraphOptions {
            grippers: self.hands.map(|(gripper, _)| gripper).to_vec(),
            objects: vec![object],
            supports: self.robot.surface("table/top").into_iter().collect(),
            grasps: Some(self.hands.to_vec()),
            rules,
            placement_margin: 1e-3,
            preplacement_distance: 0.05,
            rests: Rests::Centre,
            ..GraphOptions::default()
        };
        Problem {
            graph,
            ignored_pairs: self.ignored.clone(),
            ..Problem::new("a long box", self.robot.clone(), start, vec![Goal::Configuration(goal)])
        }
    }

    /// The box is never moved but with both hands: no other state exists.
    fn around_the_bar(&self) -> Problem {
        let both = self.hands.map(|(gripper, handle)| (gripper, Some(handle))).to_vec();
        let rules = vec![Rule { grasps: both, allowed: true }];
        let start = self.configuration((0.65, 0.2), true, None);
        let goal = self.configuration((0.65, 0.5), true, Some(&start));
        self.problem(start, goal, rules)
    }

    /// Largest row by which either hand is off its handle, at dense samples of the segments where both hold: from the
    /// joints' values alone, the box where the configuration says.
    fn closure(&self, path: &ManipulationPath) -> f64 {
        let kinematics = Kinematics::new(&self.robot);
        let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
        let mut q = self.robot.space.neutral();
        let mut worst = 0.0_f64;
        for segment in path.segments.iter().filter(|s| is_held_by_both(s.attachments.as_slice())) {
            for pair in segment.knots.windows(2) {
                for sample in 0..=10 {
                    self.robot.space.interpolate(&pair[0], &pair[1], f64::from(sample) / 10.0, &mut q);
                    kinematics.forward(&q, &mut X_WJ);
                    let hand = |(gripper, handle): (GripperIndex, HandleIndex)| {
                        let gripper = &self.robot.grippers[gripper.at()];
                        let link = &self.robot.links[gripper.link.at()];
                        let X_WG = X_WJ[link.joint.unwrap().at()] * link.joint_from_link * gripper.link_from_gripper;
                        X_WG * self.robot.handles[handle.at()].link_from_handle.inverse()
                    };
                    // Where either hand says that the box is.
                    let apart = hand(self.hands[0]).inverse() * hand(self.hands[1]);
                    worst = worst.max(apart.translation.abs().max_element());
                    worst = worst.max(log_so3(apart.rotation).abs().max_element());
                }
            }
        }
        worst
    }
}

fn is_held_by_both(attachments: &[Attachment]) -> bool {
    attachments.iter().filter(|a| matches!(a, Attachment::Grasp { .. })).count() == 2
}

fn assert_shares_knots(path: &ManipulationPath, problem: &Problem) {
    assert_eq!(path.segments[0].knots[0], problem.start);
    for pair in path.segments.windows(2) {
        assert_eq!(pair[0].knots.last(), pair[1].knots.first(), "a joint knot is not shared bit for bit");
    }
}

#[test]
fn a_box_is_carried_around_a_bar_with_both_hands() {
    let cell = Cell::new();
    let problem = cell.around_the_bar();
    let model = model(problem.clone());
    for scheduler in shipped() {
        for seed in 1..=3 {
            let (outcome, search) = search(&model, scheduler.as_ref(), seeded(seed), 2);
            assert_eq!(outcome, SearchOutcome::Solved, "{} seed {seed}", scheduler.name());
            let path = search.path().unwrap();
            assert_shares_knots(&path, &problem);
            assert!(path.segments.iter().all(|s| is_held_by_both(&s.attachments)));
            let knots: usize = path.segments.iter().map(|s| s.knots.len()).sum();
            let closure = cell.closure(&path);
            println!("seed {seed}: {} segments, {knots} knots, the hands {closure:.1e} apart", path.segments.len());
            let start = path.segments[0].knots[0].clone();
            let end = path.segments.last().and_then(|segment| segment.knots.last()).unwrap();
            let straight = model.length(&[start, end.clone()].concat());
            let travelled: f64 = path.segments.iter().map(|segment| model.length(&segment.knots.concat())).sum();
            assert!(travelled > 1.1 * straight, "the straight way is barred: {travelled} of {straight}");
            assert!(closure <= path.certificate.path_tolerance, "the hands are {closure} apart");
        }
    }
}

#[test]
fn the_answer_does_not_depend_on_the_number_of_threads() {
    let model = model(Cell::new().around_the_bar());
    let scheduler = &shipped()[0];
    let paths = [1, 3].map(|threads| search(&model, scheduler.as_ref(), seeded(7), threads).1.path().unwrap());
    assert_eq!(paths[0], paths[1]);
}

#[test]
fn what_a_leg_has_before_it_leaves_its_leaf_is_kept() {
    let cell = Cell::new();
    let model = model(cell.around_the_bar());
    let (mut lost, mut partial) = (0, 0);
    for seed in 1..=4 {
        let (_, mut search) = search(&model, &Mrrt, seeded(seed), 2);
        let world = search.world_mut();
        for statistics in world.query::<&TransitionStatistics>().iter(world) {
            partial += statistics.partial;
            let failed = statistics.rejections.iter().filter(|(r, _)| matches!(r, Rejection::SteeringFailed(_)));
            lost += failed.map(|(_, count)| count).sum::<u64>();
        }
        assert_nodes_are_on_the_leaf(&model.0, &search);
    }
    println!("{lost} legs left their leaf, {partial} candidates were kept in part");
    assert!(lost > 0 && partial > 0, "the test sees what it is about: {lost} lost, {partial} partial");
}

/// Every node, those where partial motions end too, satisfies the state's constraints to the projection tolerance.
fn assert_nodes_are_on_the_leaf(model: &foliate_systems::planning_model::Model, search: &Search) {
    let roadmap = search.roadmap();
    let mut scratch = Scratch::default();
    for (id, node) in (0..).map(NodeId).zip(roadmap.nodes()) {
        let program = &model.interior_program(node.state).unwrap().program;
        let q = roadmap.configuration(id);
        let residual = program.residual(q, &[], &mut scratch).unwrap();
        assert!(residual <= 1e-5, "node off its leaf by {residual}");
    }
}

#[test]
fn a_box_is_picked_up_by_one_hand_and_taken_by_both() {
    let cell = Cell::new();
    let at_rest = cell.configuration((0.55, -0.1 + HALF_HEIGHT + 1e-3), false, None);
    let rules = [vec![None, None], vec![Some(0), None], vec![Some(0), Some(1)]].map(|held: Vec<Option<usize>>| Rule {
        grasps: cell.hands.iter().zip(held).map(|(&(g, _), h)| (g, h.map(|i| cell.hands[i].1))).collect(),
        allowed: true,
    });
    let problem = cell.problem(at_rest, cell.configuration((0.65, 0.5), true, None), rules.to_vec());
    let model = model(problem.clone());
    for seed in 1..=2 {
        let (outcome, search) = search(&model, shipped()[0].as_ref(), seeded(seed), 2);
        assert_eq!(outcome, SearchOutcome::Solved, "seed {seed}");
        let path = search.path().unwrap();
        assert_shares_knots(&path, &problem);
        let Goal::Configuration(goal) = &problem.goals[0] else { panic!("the goal is a configuration") };
        let end = path.segments.last().unwrap().knots.last().unwrap();
        let off = cell.robot.space.distance(end, goal, &vec![1.0; cell.robot.space.dimension()]);
        assert!(off < 1e-9, "ends {off} from the goal, where both hold");
        let closure = cell.closure(&path);
        assert!(closure <= path.certificate.path_tolerance, "the hands are {closure} apart");
    }
}

#[test]
fn joints_are_moved_where_the_box_alone_cannot_be_in_both_hands() {
    let cell = Cell::new();
    let mut problem = cell.around_the_bar();
    // One hand is a few millimetres off its handle.
    problem.start[1] += 0.2_f64.to_radians();
    let model = model(problem.clone());
    let is_joint = |moved: &Moved| matches!(moved, Moved::Joint(..));
    assert!(model.snapped.iter().any(|correction| is_joint(&correction.moved)), "{:?}", model.snapped);
    for correction in &model.snapped {
        let share = problem.start_tolerance.share(correction.distance, correction.angle);
        assert!(correction.goal.is_none() && share <= 1.0 + 1e-6, "{correction:?}");
        assert_eq!(correction.onto, "left/hand holds plank/left and right/hand holds plank/right");
    }
    let (outcome, search) = search(&model, shipped()[0].as_ref(), seeded(1), 2);
    assert_eq!(outcome, SearchOutcome::Solved);
    let path = search.path().unwrap();
    assert_eq!(path.corrections, model.snapped);
    assert!(cell.closure(&path) <= path.certificate.path_tolerance);
}
