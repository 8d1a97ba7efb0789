//! What is proved of the residual along a curve over time is never exceeded by samples, and is close to them; a curve that
//! bulges off its leaf between two knots on it is refused.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::panic, clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

mod heavy_world;

use foliate_components::Pose;
use foliate_components::constraint::{
    CentreOfMass, Constraint, Locked, LockedValue, Reference, RelativePose, Row, Rows,
};
use foliate_components::robot::{Robot, Source};
use foliate_kernels::constrained_motion::{
    AttachmentTemplate, ConstraintProgram, CurveScratch, Scratch, curve_residual, curve_speed,
};
use foliate_kernels::constraints::{centre_of_mass, placement_of, relative_pose};
use foliate_kernels::curve::HermiteCurve;
use foliate_kernels::kinematics::{Kinematics, RigidAttachment};
use heavy_world::{Draw, held, poses, world};
use rand::RngExt;

struct Bench {
    robot: Robot,
    kinematics: Kinematics,
    rigid_attachments: Vec<RigidAttachment>,
    draw: Draw,
}

/// Knots, velocities and times.
struct Rows3 {
    knots: Vec<f64>,
    velocities: Vec<f64>,
    times: Vec<f64>,
}

impl Rows3 {
    fn curve(&self) -> HermiteCurve<'_> {
        HermiteCurve { knots: &self.knots, velocities: &self.velocities, times: &self.times }
    }
}

impl Bench {
    fn new(seed: u64, is_holding: bool) -> Self {
        let robot = world();
        let kinematics = Kinematics::new(&robot);
        let rigid_attachments = if is_holding { held(&robot) } else { Vec::new() };
        Self { robot, kinematics, rigid_attachments, draw: Draw::new(seed) }
    }

    fn compile(&self, constraint: Constraint) -> ConstraintProgram {
        let template = |c: &RigidAttachment| AttachmentTemplate::fixed(c.object, c.carrier, c.X_CO);
        let carried: Vec<_> = self.rigid_attachments.iter().map(template).collect();
        ConstraintProgram::compile(&self.robot, &self.kinematics, &[constraint], &carried, &[]).unwrap()
    }

    /// A curve through three configurations near to each other, carried objects at rest.
    fn curve(&mut self, from: &[f64], scale: f64) -> Rows3 {
        let space = &self.robot.space;
        let (mut knots, mut q) = (from.to_vec(), from.to_vec());
        for _ in 0..2 {
            let step: Vec<f64> = (0..space.dimension()).map(|_| self.draw.rng.random_range(-scale..scale)).collect();
            let start = q.clone();
            space.integrate(&start, &step, &mut q);
            knots.extend_from_slice(&q);
        }
        let velocities = knots.iter().map(|_| self.draw.rng.random_range(-scale..scale)).collect();
        Rows3 { knots, velocities, times: vec![0.5, 1.1, 2.9] }
    }

    fn sampled(&self, program: &ConstraintProgram, curve: &HermiteCurve<'_>) -> f64 {
        let (mut q, mut worst, mut scratch) = (self.robot.space.neutral(), 0.0_f64, Scratch::default());
        for piece in 0..curve.pieces() {
            for sample in 0..=100 {
                curve.at(&self.robot.space, piece, f64::from(sample) / 100.0, &mut q);
                worst = worst.max(program.residual(&q, &[], &mut scratch).unwrap());
            }
        }
        worst
    }

    /// Compares what is proved with samples: by how much more, or `None` where nothing moves.
    fn compare(&mut self, constraint: Constraint, from: &[f64], scale: f64) -> Option<f64> {
        let program = self.compile(constraint.clone());
        if program.rows() == 0 {
            return None;
        }
        let rows = self.curve(from, scale);
        let (curve, space) = (rows.curve(), &self.robot.space);
        let sampled = self.sampled(&program, &curve);
        if sampled < 1e-9 {
            return None;
        }
        // Rows are one by one; up to four of them make one vector.
        let tolerance = 2.2 * sampled;
        let mut scratch = CurveScratch::default();
        let proved = curve_residual(&program, space, &curve, &[], tolerance, &mut scratch);
        let again = curve_residual(&program, space, &curve, &[], tolerance, &mut scratch);
        assert_eq!(proved, again, "buffers change nothing");
        let proved = proved.unwrap_or_else(|off| panic!("{sampled} is not proved, {off:?}: {constraint:?}"));
        assert!(proved >= sampled - 1e-12 && proved <= tolerance, "{proved} proved, {sampled} sampled: {constraint:?}");
        let refused = curve_residual(&program, space, &curve, &[], 0.99 * sampled, &mut scratch);
        assert!(refused.is_err(), "{sampled} is sampled: {constraint:?}");
        Some(proved / sampled)
    }
}

#[test]
fn the_speed_of_a_point_is_bounded_closely() {
    for is_holding in [false, true] {
        let mut bench = Bench::new(89, is_holding);
        for round in 0..80 {
            let (from, frame) = (bench.draw.configuration(&bench.robot), bench.draw.frame(&bench.robot));
            let rows = bench.curve(&from, 0.3);
            let curve = rows.curve();
            let at = |piece: usize, u: f64| {
                let mut q = bench.robot.space.neutral();
                curve.at(&bench.robot.space, piece, u, &mut q);
                let X_WJ = poses(&bench.kinematics, &bench.rigid_attachments, &q);
                placement_of(&frame).in_world(&X_WJ).translation
            };
            let mut sampled = 0.0_f64;
            for piece in 0..curve.pieces() {
                let duration = curve.times[piece + 1] - curve.times[piece];
                let places: Vec<_> = (0..=1000).map(|k| at(piece, f64::from(k) / 1000.0)).collect();
                let way = places.windows(2).map(|pair| pair[0].distance(pair[1])).fold(0.0, f64::max);
                sampled = sampled.max(way * 1000.0 / duration);
            }
            let bound = |enough| {
                let Bench { robot, kinematics, rigid_attachments, .. } = &bench;
                curve_speed(robot, kinematics, rigid_attachments, &frame, &curve, enough)
            };
            for enough in [0.0, 0.5 * sampled] {
                let found = bound(enough);
                assert!(found >= sampled * (1.0 - 1e-9), "round {round}: {found} proved, {sampled} sampled");
                assert!(found <= sampled * 1.01 + 1e-9, "round {round}: {found} proved, {sampled} sampled");
            }
            assert_eq!(bound(10.0 * sampled + 1.0), 10.0 * sampled + 1.0);
        }
    }
}

#[test]
fn samples_never_exceed_what_is_proved() {
    let zero = Some(Row::Zero);
    let kinds: [Rows; 4] = [
        [zero, zero, zero, None, None, None],
        [None, None, None, zero, zero, zero],
        [None, None, None, zero, zero, None],
        [zero; 6],
    ];
    let mut compared = [0; 8];
    for is_holding in [false, true] {
        let mut bench = Bench::new(71, is_holding);
        for round in 0..320 {
            let from = bench.draw.configuration(&bench.robot);
            let bodies = poses(&bench.kinematics, &bench.rigid_attachments, &from);
            let kind = round % 8;
            let constraint = match kind {
                0..4 => {
                    let (a, b) = (bench.draw.frame(&bench.robot), bench.draw.frame(&bench.robot));
                    let reference = relative_pose::pose(&placement_of(&a), &placement_of(&b), &bodies);
                    let reference = Reference::Fixed(reference);
                    Constraint::RelativePose(RelativePose { a, b, rows: kinds[kind], reference })
                }
                4 => {
                    let mut balance = bench.draw.balance(&bench.robot, [Row::Zero, Row::Inequality, Row::Zero]);
                    balance.reference = Reference::Identity;
                    let center = centre_of_mass::in_frame(&balance, &bodies);
                    balance.rows.iter_mut().for_each(|plane| plane.offset = plane.normal.dot(center));
                    Constraint::CentreOfMass(CentreOfMass { ..balance })
                }
                5 => Constraint::CentreOfMassBetween(bench.draw.between(&bench.robot, Some(0.4))),
                6 => Constraint::Distance(bench.draw.distance(&bench.robot, Row::Zero, round % 16 == 6)),
                _ => Constraint::Custom(bench.draw.gaze(&bench.robot)),
            };
            // Rotations are bounded while they are small; feet that stand on one point are not.
            let scale = bench.draw.rng.random_range(1e-3..0.02);
            compared[kind] += usize::from(bench.compare(constraint, &from, scale).is_some());
        }
    }
    println!("compared: {compared:?}");
    assert!(compared.iter().all(|&n| n > 50), "{compared:?}");
}

#[test]
fn a_curve_that_bulges_off_its_leaf_is_refused() {
    let mut bench = Bench::new(72, false);
    let zero = Some(Row::Zero);
    let mut refused = 0;
    for _ in 0..40 {
        let from = bench.draw.configuration(&bench.robot);
        let hand = foliate_components::constraint::Frame::of_joint(bench.robot.joint("arm/w2").unwrap());
        let world = foliate_components::constraint::Frame::world(Pose::identity());
        let bodies = poses(&bench.kinematics, &[], &from);
        let reference = relative_pose::pose(&placement_of(&world), &placement_of(&hand), &bodies);
        let rows = [zero, zero, zero, None, None, None];
        let constraint = RelativePose { a: world, b: hand, rows, reference: Reference::Fixed(reference) };
        let program = bench.compile(Constraint::RelativePose(constraint));
        // Both knots are one and the same; only the velocities differ.
        let moving = bench.curve(&from, 0.1);
        let size = bench.robot.space.size();
        let rows = Rows3 {
            knots: [from.clone(), from.clone()].concat(),
            velocities: moving.velocities[..2 * size].to_vec(),
            times: vec![0.0, 1.0],
        };
        let still = Rows3 { velocities: vec![0.0; 2 * size], ..rows_of(&rows) };
        let mut scratch = CurveScratch::default();
        let mut proved =
            |rows: &Rows3| curve_residual(&program, &bench.robot.space, &rows.curve(), &[], 2e-4, &mut scratch);
        assert!(proved(&still).unwrap() < 1e-9);
        let sampled = bench.sampled(&program, &rows.curve());
        if sampled > 2e-4 {
            refused += 1;
            let off = proved(&rows).unwrap_err();
            assert!(off.piece == 0 && off.u < 1.0, "{off:?}");
        }
    }
    assert!(refused > 20, "{refused}");
}

fn rows_of(rows: &Rows3) -> Rows3 {
    Rows3 { knots: rows.knots.clone(), velocities: rows.velocities.clone(), times: rows.times.clone() }
}

#[test]
fn a_locked_joint_stands_still_where_it_is_locked() {
    let bench = Bench::new(73, false);
    let joint = bench.robot.joint("arm/w2").unwrap();
    let Source::Coordinates { q: at, .. } = bench.robot.joints[joint.at()].source else { unreachable!() };
    let mut q = bench.robot.space.neutral();
    q[at] = 0.3;
    let size = q.len();
    let program = bench.compile(Constraint::Locked(Locked { joint, value: LockedValue::Fixed(0.3) }));
    let mut scratch = CurveScratch::default();
    let mut proved = |end: f64, velocity: f64| {
        let mut knots = [q.clone(), q.clone()].concat();
        knots[at] += end;
        knots[size + at] += end;
        let mut velocities = vec![0.0; 2 * size];
        velocities[at] = velocity;
        let curve = HermiteCurve { knots: &knots, velocities: &velocities, times: &[0.0, 1.0] };
        curve_residual(&program, &bench.robot.space, &curve, &[], 2e-4, &mut scratch)
    };
    assert_eq!(proved(0.0, 0.0), Ok(0.0));
    assert!(proved(1e-4, 0.0).is_ok_and(|worst| (worst - 1e-4).abs() < 1e-12));
    assert!(proved(1e-3, 0.0).is_err(), "off its value");
    assert!(proved(0.0, 0.1).is_err(), "on the move");
}
