//! Motions stay on their leaf between the knots: the bound on second derivatives is never exceeded.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

use foliate_components::Pose;
use foliate_components::constraint::{
    Constraint, Frame, Grasp, Placement as Contact, Polygon, Reference, RelativePose, Row, Side,
};
use foliate_components::pose::{exp_so3, log_so3};
use foliate_components::robot::{LinkIndex, PartKind, PartPlacement, Robot, RootJoint, Source};
use foliate_components::samples::models;
use foliate_kernels::constrained_motion::{
    ConstraintProgram, MotionEnd, MotionJob, MotionScratch, MotionSettings, Scratch, Settings, project, project_motion,
    project_motions,
};
use foliate_kernels::constraints::{placement_of, relative_pose};
use foliate_kernels::kinematics::{Kinematics, RigidAttachment};
use foliate_kernels::lanes::Level;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Two arms and a block; an arm on a planar root, one on a free-flyer, a hand with a mimic finger.
fn world() -> Robot {
    let (arm, two, hand) = (models::seven_axis_arm(), models::two_joint_arm(), models::two_finger_hand());
    let block = models::block(DVec3::new(0.06, 0.06, 0.12));
    let at = |x, y, z| Pose::from_parts(DVec3::new(x, y, z), exp_so3(DVec3::new(0.0, 0.2, 0.1)));
    let drone = PartPlacement {
        root_bounds: vec![(-1.0, 1.0); 3],
        ..models::part("drone", PartKind::Robot, RootJoint::FreeFlyer, at(0.0, 0.0, 1.0))
    };
    Robot::compose(&[
        (&arm, models::fixed_robot("left", at(0.0, 0.3, 0.0))),
        (&arm, models::fixed_robot("right", at(0.0, -0.3, 0.0))),
        (&two, models::part("rover", PartKind::Robot, RootJoint::Planar, at(1.0, 0.0, 0.0))),
        (&two, drone),
        (&hand, models::fixed_robot("hand", at(0.0, 0.0, 0.0))),
        (&block, models::movable_object("block")),
    ])
    .unwrap()
}

struct Bench {
    robot: Robot,
    kinematics: Kinematics,
    scratch: Scratch,
    rng: ChaCha8Rng,
}

impl Bench {
    fn new(seed: u64) -> Self {
        let robot = world();
        let kinematics = Kinematics::new(&robot);
        Self { robot, kinematics, scratch: Scratch::default(), rng: ChaCha8Rng::seed_from_u64(seed) }
    }

    fn compile(&self, constraints: &[Constraint]) -> ConstraintProgram {
        ConstraintProgram::compile(&self.robot, &self.kinematics, constraints, &[], &[]).unwrap()
    }

    fn random(&mut self) -> Vec<f64> {
        let mut q = self.robot.space.neutral();
        self.robot.space.random(&mut self.rng, &mut q);
        q
    }

    /// A configuration that satisfies the program.
    fn solution(&mut self, program: &ConstraintProgram, arguments: &[Pose]) -> Vec<f64> {
        loop {
            let mut q = self.random();
            if project(program, &mut q, arguments, &Settings::default(), &mut self.scratch).is_converged() {
                return q;
            }
        }
    }

    /// Another one near it.
    fn neighbour(&mut self, program: &ConstraintProgram, arguments: &[Pose], q: &[f64], reach: f64) -> Vec<f64> {
        let (mut v, mut moved) = (vec![0.0; self.robot.space.dimension()], q.to_vec());
        loop {
            v.iter_mut().for_each(|x| *x = self.rng.random_range(-reach..reach));
            self.robot.space.integrate(q, &v, &mut moved);
            if project(program, &mut moved, arguments, &Settings::default(), &mut self.scratch).is_converged() {
                return moved;
            }
        }
    }

    fn poses(&self, q: &[f64], rigid_attachments: &[RigidAttachment]) -> Vec<Pose> {
        let mut X_WJ = vec![Pose::identity(); self.kinematics.bodies()];
        self.kinematics.forward(q, &mut X_WJ);
        self.kinematics.carry(q, rigid_attachments, &mut X_WJ);
        X_WJ
    }
}

/// Samples a motion finely and returns the largest residual between and at its knots.
fn largest_residual(
    bench: &Bench,
    program: &ConstraintProgram,
    arguments: &[Pose],
    knots: &[f64],
    value: impl Fn(&[Pose]) -> f64,
) -> f64 {
    let size = bench.robot.space.size();
    let mut rigid_attachments = Vec::new();
    assert!(program.resolve_attachments(arguments, &mut rigid_attachments));
    let (mut q, mut worst) = (bench.robot.space.neutral(), 0.0_f64);
    for pair in knots.chunks(size).collect::<Vec<_>>().windows(2) {
        for sample in 0..=20 {
            bench.robot.space.interpolate(pair[0], pair[1], f64::from(sample) / 20.0, &mut q);
            worst = worst.max(value(&bench.poses(&q, &rigid_attachments)));
        }
    }
    worst
}

#[test]
fn a_box_held_by_two_hands_moves_with_both() {
    let mut bench = Bench::new(31);
    let robot = &bench.robot;
    let [left, right] = ["left/hand", "right/hand"].map(|g| robot.gripper(g).unwrap());
    let top = robot.handle("block/top").unwrap();
    let left = Grasp::new(robot, left, top).unwrap().constraint();
    let right = Grasp::new(robot, right, top).unwrap().constraint();
    let opposite = Pose::from_rotation(exp_so3(DVec3::Y * std::f64::consts::PI));
    let right = RelativePose { b: right.b.then(&opposite), ..right };
    let program = bench.compile(&[Constraint::RelativePose(left), Constraint::RelativePose(right)]);
    let (settings, mut scratch) = (MotionSettings::default(), MotionScratch::default());
    let residual = |X_WJ: &[Pose]| {
        let of =
            |c: &RelativePose| relative_pose::value(&placement_of(&c.a), &placement_of(&c.b), &Pose::identity(), X_WJ);
        [of(&left), of(&right)].concat().iter().fold(0.0, |m: f64, e| m.max(e.abs()))
    };
    let (mut reached, mut knots_used, mut length) = (0, 0, 0.0);
    for _ in 0..40 {
        let from = bench.solution(&program, &[]);
        let to = bench.neighbour(&program, &[], &from, 0.5);
        let mut knots = Vec::new();
        let space = &bench.robot.space;
        let end = project_motion(&program, space, (&from, &to), &[], &settings, &mut scratch, &mut knots);
        let worst = largest_residual(&bench, &program, &[], &knots, residual);
        assert!(worst <= settings.path_tolerance, "{worst} between knots");
        assert_eq!(&knots[..from.len()], &from[..], "the first knot is the start");
        if end == MotionEnd::Reached {
            reached += 1;
            let last = &knots[knots.len() - to.len()..];
            assert_eq!(&last[..14], &to[..14], "the last knot is the goal");
            knots_used += knots.len() / to.len();
            let mut v = vec![0.0; space.dimension()];
            space.difference(&from, &to, &mut v);
            length += v[..14].iter().map(|x| x * x).sum::<f64>().sqrt();
        }
    }
    println!("reached {reached} of 40, {:.1} knots per radian", f64::from(knots_used as u32) / length);
    assert!(reached >= 20, "{reached}");
}

#[test]
fn without_rows_a_motion_is_its_two_ends() {
    let mut bench = Bench::new(32);
    let robot = &bench.robot;
    let grasp = Grasp::new(robot, robot.gripper("left/hand").unwrap(), robot.handle("block/top").unwrap()).unwrap();
    let program = bench.compile(&[Constraint::RelativePose(grasp.constraint())]);
    let (from, to) = (bench.solution(&program, &[]), bench.solution(&program, &[]));
    let (mut knots, mut scratch) = (Vec::new(), MotionScratch::default());
    let ends = (&from[..], &to[..]);
    let settings = MotionSettings::default();
    let end = project_motion(&program, &bench.robot.space, ends, &[], &settings, &mut scratch, &mut knots);
    assert_eq!((end, knots.len()), (MotionEnd::Reached, 2 * from.len()));
    assert_eq!(&knots[..from.len()], &from[..]);
    assert_eq!(&knots[from.len()..from.len() + 14], &to[..14]);
}

#[test]
fn a_motion_that_would_jump_to_another_branch_stops_before_it() {
    let mut bench = Bench::new(33);
    // The drone's tip stays at a point of its own body: elbow left and elbow right are apart.
    let robot = &bench.robot;
    let gripper = &robot.grippers[robot.gripper("drone/tip").unwrap().at()];
    let tip = Frame::on_link(robot, gripper.link, &gripper.link_from_gripper);
    let root = Frame::of_joint(robot.joint("drone/root_joint").unwrap());
    let rows = [Some(Row::Zero), Some(Row::Zero), None, None, None, None];
    let reference = Reference::Fixed(Pose::from_translation(DVec3::new(1.2, 0.3, 0.0)));
    let program = bench.compile(&[Constraint::RelativePose(RelativePose { a: root, b: tip, rows, reference })]);
    let coordinate = |name: &str| match bench.robot.joints[bench.robot.joint(name).unwrap().at()].source {
        Source::Coordinates { q, .. } => q,
        Source::Follows { .. } => unreachable!(),
    };
    let (shoulder, elbow) = (coordinate("drone/shoulder"), coordinate("drone/elbow"));
    let from = bench.solution(&program, &[]);
    let mut to = from.clone();
    to[elbow] = -from[elbow];
    to[shoulder] = from[shoulder] + from[elbow];
    assert!(program.residual(&to, &[], &mut bench.scratch).unwrap() < 1e-5);
    assert!(project(&program, &mut to, &[], &Settings::default(), &mut bench.scratch).is_converged());
    let (mut knots, mut scratch) = (Vec::new(), MotionScratch::default());
    let (ends, settings) = ((&from[..], &to[..]), MotionSettings::default());
    let end = project_motion(&program, &bench.robot.space, ends, &[], &settings, &mut scratch, &mut knots);
    assert_eq!(end, MotionEnd::Stopped);
    assert_eq!(knots.len() % from.len(), 0);
    assert!(knots.chunks(from.len()).all(|k| (k[elbow] > 0.0) == (from[elbow] > 0.0)), "never on the other branch");
}

/// Prints what a knot costs; run with `--release --nocapture` to read it.
#[test]
fn costs() {
    let mut bench = Bench::new(38);
    let robot = &bench.robot;
    let top = robot.handle("block/top").unwrap();
    let grasp = |hand: &str| Grasp::new(robot, robot.gripper(hand).unwrap(), top).unwrap().constraint();
    let opposite = Pose::from_rotation(exp_so3(DVec3::Y * std::f64::consts::PI));
    let (left, right) = (grasp("left/hand"), grasp("right/hand"));
    let right = RelativePose { b: right.b.then(&opposite), ..right };
    let program = bench.compile(&[Constraint::RelativePose(left), Constraint::RelativePose(right)]);
    let (settings, mut scratch) = (MotionSettings::default(), MotionScratch::default());
    let ends: Vec<_> = (0..60)
        .map(|_| {
            let from = bench.solution(&program, &[]);
            let to = bench.neighbour(&program, &[], &from, 0.5);
            (from, to)
        })
        .collect();
    let mut best = f64::INFINITY;
    let (mut knots, mut reached) = (Vec::new(), 0);
    for _ in 0..5 {
        knots.clear();
        let begin = std::time::Instant::now();
        let walk = |(from, to): &(Vec<f64>, Vec<f64>)| {
            let ends = (&from[..], &to[..]);
            project_motion(&program, &bench.robot.space, ends, &[], &settings, &mut scratch, &mut knots)
        };
        reached = ends.iter().map(walk).filter(|end| *end == MotionEnd::Reached).count();
        best = best.min(begin.elapsed().as_secs_f64());
    }
    let count = knots.len() / bench.robot.space.size();
    println!("{reached} of {} reached, {count} knots, {:.2} µs a knot", ends.len(), 1e6 * best / count as f64);
    assert!(reached > 0);
}

/// A step may be short beside its chord and still end on another branch: what forbids it is the residual's bound along the
/// straight line between two knots, with the test of lengths or without.
#[test]
fn an_arm_reaches_another_branch_only_along_the_leaf() {
    let mut bench = Bench::new(37);
    let tip = Frame::of_joint(bench.robot.joint("left/w2").unwrap());
    let rigid = RelativePose::rigid(Frame::world(Pose::identity()), tip, Reference::Argument(0));
    let program = bench.compile(&[Constraint::RelativePose(rigid)]);
    let (mut scratch, size) = (MotionScratch::default(), bench.robot.space.size());
    let (mut reached, mut stopped) = (0, 0);
    for round in 0..12 {
        let seen = bench.random();
        let X_WT = bench.poses(&seen, &[])[tip.joint.unwrap().at()];
        let (from, to) = (bench.solution(&program, &[X_WT]), bench.solution(&program, &[X_WT]));
        for jump in [MotionSettings::default().jump, f64::INFINITY] {
            let settings = MotionSettings { jump, ..MotionSettings::default() };
            let mut knots = Vec::new();
            let ends = (&from[..], &to[..]);
            let space = &bench.robot.space;
            match project_motion(&program, space, ends, &[X_WT], &settings, &mut scratch, &mut knots) {
                MotionEnd::Reached => reached += 1,
                MotionEnd::Stopped | MotionEnd::TooManyKnots => stopped += 1,
                MotionEnd::NotOnLeaf => unreachable!("both are solutions"),
            }
            let residual = |X_WJ: &[Pose]| {
                let (a, b) = (placement_of(&rigid.a), placement_of(&rigid.b));
                relative_pose::value(&a, &b, &X_WT, X_WJ).iter().fold(0.0, |m: f64, e| m.max(e.abs()))
            };
            let worst = largest_residual(&bench, &program, &[X_WT], &knots, residual);
            assert!(worst <= settings.path_tolerance, "round {round}, jump {jump}: {worst} between knots");
            assert_eq!(&knots[..size], &from[..], "the first knot is the start");
        }
    }
    println!("{reached} reached, {stopped} stopped");
    assert!(reached > 2 && stopped > 5, "the test sees both kinds: {reached} reached, {stopped} stopped");
}

#[test]
fn ends_off_the_leaf_are_refused() {
    let mut bench = Bench::new(34);
    let tip = Frame::of_joint(bench.robot.joint("left/w2").unwrap());
    let rigid = RelativePose::rigid(Frame::world(Pose::identity()), tip, Reference::Argument(0));
    let program = bench.compile(&[Constraint::RelativePose(rigid)]);
    let target = bench.random();
    let X_WT = bench.poses(&target, &[])[tip.joint.unwrap().at()];
    let (mut knots, mut scratch) = (Vec::new(), MotionScratch::default());
    let (from, settings) = (bench.random(), MotionSettings::default());
    let mut motion = |from: &[f64], to: &[f64], arguments: &[Pose]| {
        project_motion(&program, &bench.robot.space, (from, to), arguments, &settings, &mut scratch, &mut knots)
    };
    assert_eq!(motion(&from, &target, &[X_WT]), MotionEnd::NotOnLeaf);
    assert_eq!(motion(&target, &from, &[X_WT]), MotionEnd::NotOnLeaf);
    assert_eq!(motion(&target, &target, &[]), MotionEnd::NotOnLeaf);
    assert_eq!(motion(&target[1..], &target, &[X_WT]), MotionEnd::NotOnLeaf);
    assert!(knots.is_empty());
}

#[test]
fn a_flying_root_keeps_its_foot_on_the_ground() {
    let mut bench = Bench::new(35);
    let robot = &bench.robot;
    let foot = Frame::of_joint(robot.joint("drone/elbow").unwrap());
    let square = |z: f64, size: f64| {
        [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x * size, y * size, z))
    };
    let mut sole = square(-0.02, 0.1);
    sole.reverse();
    let object = Polygon::new(foot, &sole, Side::Object).unwrap();
    let ground = Polygon::new(Frame::world(Pose::identity()), &square(0.5, 2.0), Side::Support).unwrap();
    let contact = Contact::from_polygons(vec![object], vec![ground], 0.0).unwrap();
    let anywhere = bench.compile(&[Constraint::PlacementHold(contact.clone(), 0)]);
    assert_eq!((anywhere.rows(), anywhere.active().len()), (6, 8));
    let (settings, mut scratch) = (MotionSettings::default(), MotionScratch::default());
    let root = match bench.robot.joints[bench.robot.joint("drone/root_joint").unwrap().at()].source {
        Source::Coordinates { q, .. } => q,
        Source::Follows { .. } => unreachable!(),
    };
    let (mut reached, mut at_bound) = (0, 0);
    for _ in 0..20 {
        let parameter =
            Pose::from_parts(DVec3::new(0.0, bench.rng.random_range(-0.5..0.5), 0.2), exp_so3(DVec3::X * 2.5));
        let from = bench.solution(&anywhere, &[parameter]);
        // Room for less than the step that is asked for: the root is stopped by its bounds on the way.
        for (i, at) in from.iter().enumerate().skip(root).take(3) {
            (bench.robot.space.lower[i], bench.robot.space.upper[i]) = (at - 0.05, at + 0.05);
        }
        let program = bench.compile(&[Constraint::PlacementHold(contact.clone(), 0)]);
        let to = bench.neighbour(&program, &[parameter], &from, 0.4);
        let mut knots = Vec::new();
        let ends = (&from[..], &to[..]);
        let end = project_motion(&program, &bench.robot.space, ends, &[parameter], &settings, &mut scratch, &mut knots);
        reached += usize::from(end == MotionEnd::Reached);
        let residual = |X_WJ: &[Pose]| {
            let target = foliate_kernels::constraints::placement::decode(&contact, &parameter).unwrap();
            let (a, b) = (placement_of(&contact.supports[0].frame), placement_of(&contact.object[0].frame));
            relative_pose::value(&a, &b, &target.1, X_WJ).iter().fold(0.0, |m: f64, e| m.max(e.abs()))
        };
        let worst = largest_residual(&bench, &program, &[parameter], &knots, residual);
        assert!(worst <= settings.path_tolerance, "{worst} between knots");
        // Between knots positions are linear, so what holds at the knots holds all along.
        for knot in knots.chunks(from.len()) {
            for (i, at) in knot.iter().enumerate().skip(root).take(3) {
                let (low, high) = (bench.robot.space.lower[i], bench.robot.space.upper[i]);
                assert!((low..=high).contains(at), "the root leaves its bounds: {at} at {i}");
                at_bound += usize::from(*at == low || *at == high);
            }
            let norm: f64 = knot[root + 3..root + 7].iter().map(|x| x * x).sum();
            assert!((norm - 1.0).abs() < 1e-12, "not a unit quaternion: {norm}");
        }
    }
    println!("{reached} reached, the root at a bound {at_bound} times");
    assert!(reached >= 10 && at_bound > 0, "{reached} reached, at a bound {at_bound} times");
}

/// Between any two frames, along any short motion: how far values leave the straight line between their ends.
#[test]
fn the_bound_on_second_derivatives_is_sound_and_not_wasteful() {
    let mut bench = Bench::new(36);
    let (mut tightest, mut rounds) = ([0.0_f64; 3], 0);
    while rounds < 600 {
        let links = bench.robot.links.len() as u32;
        let mut frame = || {
            let link = LinkIndex(bench.rng.random_range(0..links));
            let mut number = || bench.rng.random_range(-0.5..0.5);
            let t = DVec3::new(number(), number(), number());
            let turn = DVec3::new(number(), number(), number());
            Frame::on_link(&bench.robot, link, &Pose::from_parts(t, exp_so3(turn)))
        };
        let (a, b) = (frame(), frame());
        let kind = rounds % 3;
        let zero = Some(Row::Zero);
        let rows = [
            [zero, zero, zero, None, None, None],
            [None, None, None, zero, zero, zero],
            [None, None, None, zero, zero, None],
        ][kind];
        let q = bench.random();
        let (a_on, b_on) = (placement_of(&a), placement_of(&b));
        let reference = relative_pose::pose(&a_on, &b_on, &bench.poses(&q, &[]));
        let pose = RelativePose { a, b, rows, reference: Reference::Fixed(reference) };
        let program = bench.compile(&[Constraint::RelativePose(pose)]);
        if program.rows() == 0 {
            continue; // the frames are on one body
        }
        rounds += 1;
        let scale = bench.rng.random_range(0.001..0.06);
        let delta: Vec<f64> =
            (0..bench.robot.space.dimension()).map(|_| bench.rng.random_range(-scale..scale)).collect();
        let bound = program.residual_bound().between(&delta, &bench.poses(&q, &[]));
        if bound == f64::INFINITY {
            assert!(kind == 1, "only whole rotations have a limit");
            continue;
        }
        let value = |t: f64| {
            let (mut moved, step) = (q.clone(), delta.iter().map(|d| d * t).collect::<Vec<_>>());
            bench.robot.space.integrate(&q, &step, &mut moved);
            let X_AB = relative_pose::pose(&a_on, &b_on, &bench.poses(&moved, &[]));
            match kind {
                0 => X_AB.translation,
                1 => log_so3(reference.rotation.conjugate() * X_AB.rotation),
                _ => reference.rotation.conjugate() * (X_AB.rotation * DVec3::Z),
            }
        };
        let (start, end) = (value(0.0), value(1.0));
        let mut most = 0.0_f64;
        for sample in 1..20 {
            let t = f64::from(sample) / 20.0;
            most = most.max((value(t) - start.lerp(end, t)).length());
        }
        assert!(most <= bound + 1e-12, "kind {kind}: {most} above the bound {bound}");
        if bound > 1e-9 {
            tightest[kind] = tightest[kind].max(most / bound);
        }
    }
    println!(
        "closest to the bound: positions {:.2}, rotations {:.2}, axes {:.2}",
        tightest[0], tightest[1], tightest[2]
    );
    assert!(tightest.iter().all(|&t| t > 0.2), "{tightest:?}");
}

/// What is asked of a motion: its ends and arguments.
type Wanted = (Vec<f64>, Vec<f64>, Vec<Pose>);

/// Follows motions side by side.
fn side_by_side(
    bench: &Bench,
    program: &ConstraintProgram,
    wanted: &[Wanted],
    settings: &MotionSettings,
    scratch: &mut MotionScratch,
) -> Vec<(MotionEnd, Vec<f64>)> {
    let mut knots = vec![Vec::new(); wanted.len()];
    let mut jobs: Vec<_> = wanted
        .iter()
        .zip(&mut knots)
        .map(|((from, to, arguments), knots)| MotionJob::new((from, to), arguments, knots))
        .collect();
    project_motions(program, &bench.robot.space, &mut jobs, settings, scratch);
    let ends: Vec<_> = jobs.iter().map(|job| job.end).collect();
    ends.into_iter().zip(knots).collect()
}

fn bits(q: &[f64]) -> Vec<u64> {
    q.iter().map(|x| x.to_bits()).collect()
}

/// An arm whose hand stays where it is: some motions arrive, some would have to jump to another branch and stop.
fn arms_with_a_hand_in_its_place(bench: &mut Bench, count: usize) -> (ConstraintProgram, RelativePose, Vec<Wanted>) {
    let tip = Frame::of_joint(bench.robot.joint("left/w2").unwrap());
    let rigid = RelativePose::rigid(Frame::world(Pose::identity()), tip, Reference::Argument(0));
    let program = bench.compile(&[Constraint::RelativePose(rigid)]);
    let wanted = (0..count)
        .map(|k| {
            let seen = bench.random();
            let X_WT = bench.poses(&seen, &[])[tip.joint.unwrap().at()];
            let from = bench.solution(&program, &[X_WT]);
            let near = k % 2 == 0;
            let to =
                if near { bench.neighbour(&program, &[X_WT], &from, 0.4) } else { bench.solution(&program, &[X_WT]) };
            (from, to, vec![X_WT])
        })
        .collect();
    (program, rigid, wanted)
}

#[test]
fn a_motion_among_others_is_the_motion_alone() {
    let mut bench = Bench::new(41);
    let (program, _, mut wanted) = arms_with_a_hand_in_its_place(&mut bench, 21);
    assert!(program.is_for_lanes());
    // Some that end at once, in between.
    wanted[3].1 = bench.random();
    wanted[10].2[0].translation.x += 0.1;
    wanted[11].2.clear();
    wanted[12].0.pop();
    let at_rest = wanted[4].0.clone();
    wanted[4].1 = at_rest;
    for level in Level::available() {
        let solve = Settings { level, ..Settings::default() };
        let settings = MotionSettings { solve, ..MotionSettings::default() };
        let mut scratch = MotionScratch::default();
        let all = side_by_side(&bench, &program, &wanted, &settings, &mut scratch);
        for k in [3, 10, 11, 12] {
            assert_eq!((all[k].0, all[k].1.len()), (MotionEnd::NotOnLeaf, 0), "{level}: {k}");
        }
        assert_eq!((all[4].0, all[4].1.len()), (MotionEnd::Reached, 2 * wanted[4].0.len()), "{level}");
        let backwards: Vec<_> = wanted.iter().rev().cloned().collect();
        let backwards = side_by_side(&bench, &program, &backwards, &settings, &mut scratch);
        for (k, (end, knots)) in all.iter().enumerate() {
            let (other, reversed) = &backwards[wanted.len() - 1 - k];
            assert_eq!((end, bits(knots)), (other, bits(reversed)), "{level}: order matters to {k}");
            let alone = side_by_side(&bench, &program, &wanted[k..=k], &settings, &mut MotionScratch::default());
            assert_eq!((*end, bits(knots)), (alone[0].0, bits(&alone[0].1)), "{level}: a crowd matters to {k}");
        }
        assert!(side_by_side(&bench, &program, &[], &settings, &mut scratch).is_empty());
    }
}

#[test]
fn motions_in_lanes_stay_on_their_leaves_and_on_their_branches() {
    let mut bench = Bench::new(42);
    let (program, rigid, wanted) = arms_with_a_hand_in_its_place(&mut bench, 24);
    let size = bench.robot.space.size();
    let arrived = |found: &[(MotionEnd, Vec<f64>)]| found.iter().filter(|(end, _)| *end == MotionEnd::Reached).count();
    let scalar = Settings { level: Level::scalar(), ..Settings::default() };
    let settings = MotionSettings { solve: scalar, ..MotionSettings::default() };
    let expected = arrived(&side_by_side(&bench, &program, &wanted, &settings, &mut MotionScratch::default()));
    for level in Level::available() {
        for jump in [MotionSettings::default().jump, f64::INFINITY] {
            let solve = Settings { level, ..Settings::default() };
            let settings = MotionSettings { jump, solve, ..MotionSettings::default() };
            let found = side_by_side(&bench, &program, &wanted, &settings, &mut MotionScratch::default());
            let count = arrived(&found);
            assert!(count > 8 && count < 24, "{level}: the test sees both kinds, {count} arrive");
            assert!(count.abs_diff(expected) <= 2, "{level}: {count} arrive, {expected} in scalar code");
            for ((end, knots), (from, to, arguments)) in found.iter().zip(&wanted) {
                let residual = |X_WJ: &[Pose]| {
                    let (a, b) = (placement_of(&rigid.a), placement_of(&rigid.b));
                    let rows = relative_pose::value(&a, &b, &arguments[0], X_WJ);
                    rows.iter().fold(0.0, |m: f64, e| m.max(e.abs()))
                };
                let worst = largest_residual(&bench, &program, arguments, knots, residual);
                assert!(worst <= settings.path_tolerance, "{level}: {worst} between knots");
                assert_eq!(&knots[..size], &from[..], "{level}: the first knot is the start");
                if *end == MotionEnd::Reached {
                    assert_eq!(&knots[knots.len() - size..][..7], &to[..7], "{level}: the last knot is the goal");
                }
            }
        }
    }
}

#[test]
fn no_lane_bridges_two_branches() {
    let mut bench = Bench::new(43);
    // As in `a_motion_that_would_jump_to_another_branch_stops_before_it`, many of them side by side.
    let robot = &bench.robot;
    let gripper = &robot.grippers[robot.gripper("drone/tip").unwrap().at()];
    let tip = Frame::on_link(robot, gripper.link, &gripper.link_from_gripper);
    let root = Frame::of_joint(robot.joint("drone/root_joint").unwrap());
    let rows = [Some(Row::Zero), Some(Row::Zero), None, None, None, None];
    let reference = Reference::Argument(0);
    let program = bench.compile(&[Constraint::RelativePose(RelativePose { a: root, b: tip, rows, reference })]);
    assert!(program.is_for_lanes());
    let coordinate = |bench: &Bench, name: &str| match bench.robot.joints[bench.robot.joint(name).unwrap().at()].source
    {
        Source::Coordinates { q, .. } => q,
        Source::Follows { .. } => unreachable!(),
    };
    let (shoulder, elbow) = (coordinate(&bench, "drone/shoulder"), coordinate(&bench, "drone/elbow"));
    let wanted: Vec<Wanted> = (0..13)
        .map(|k| {
            let point = Pose::from_translation(DVec3::new(1.0 + 0.03 * f64::from(k), 0.3, 0.0));
            let from = bench.solution(&program, &[point]);
            let mut to = from.clone();
            to[elbow] = -from[elbow];
            to[shoulder] = from[shoulder] + from[elbow];
            assert!(project(&program, &mut to, &[point], &Settings::default(), &mut bench.scratch).is_converged());
            (from, to, vec![point])
        })
        .collect();
    for level in Level::available() {
        let solve = Settings { level, ..Settings::default() };
        let settings = MotionSettings { solve, ..MotionSettings::default() };
        let found = side_by_side(&bench, &program, &wanted, &settings, &mut MotionScratch::default());
        for ((end, knots), (from, _, _)) in found.iter().zip(&wanted) {
            assert_eq!(*end, MotionEnd::Stopped, "{level}");
            let stays = knots.chunks(from.len()).all(|k| (k[elbow] > 0.0) == (from[elbow] > 0.0));
            assert!(stays, "{level}: never on the other branch");
        }
    }
}

#[test]
fn motions_without_rows_or_with_few_knots_end_among_others_too() {
    let mut bench = Bench::new(44);
    let (program, _, wanted) = arms_with_a_hand_in_its_place(&mut bench, 10);
    let size = bench.robot.space.size();
    let few = MotionSettings { knots: 4, ..MotionSettings::default() };
    let found = side_by_side(&bench, &program, &wanted, &few, &mut MotionScratch::default());
    assert!(found.iter().any(|(end, _)| *end == MotionEnd::TooManyKnots));
    for (end, knots) in &found {
        assert!(knots.len() <= 4 * size);
        assert_eq!(*end == MotionEnd::TooManyKnots, knots.len() == 4 * size && *end != MotionEnd::Reached);
    }
    let free = bench.compile(&[]);
    let settings = MotionSettings::default();
    for (end, knots) in side_by_side(&bench, &free, &wanted, &settings, &mut MotionScratch::default()) {
        assert_eq!((end, knots.len()), (MotionEnd::Reached, 2 * size));
    }
}
