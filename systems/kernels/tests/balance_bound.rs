//! Between two knots rows of balance, distances and functions never leave zero by more than the bound says.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

mod heavy_world;

use foliate_components::Pose;
use foliate_components::constraint::{
    Constraint, Curvature, Custom, Frame, Function, Gradient, Reference, Region, RelativePose, Row, Tilt,
};
use foliate_components::robot::Robot;
use foliate_kernels::constrained_motion::{AttachmentTemplate, ConstraintProgram};
use foliate_kernels::constraints::{
    centre_of_mass, com_between, custom, distance, placement_of, relative_pose, residual,
};
use foliate_kernels::kinematics::{Kinematics, RigidAttachment};
use glam::DVec3;
use heavy_world::{Draw, held, poses, world};
use rand::RngExt;
use std::sync::Arc;

const ROUNDS: usize = 400;

struct Bench {
    robot: Robot,
    kinematics: Kinematics,
    rigid_attachments: Vec<RigidAttachment>,
    draw: Draw,
}

/// How near sampled rows came to the bound, over many motions.
#[derive(Debug, Default)]
struct Tightness {
    ratios: Vec<f64>,
}

impl Tightness {
    fn summary(&mut self) -> (f64, f64) {
        self.ratios.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| self.ratios[(share * (self.ratios.len() - 1) as f64) as usize];
        (at(0.5), at(1.0))
    }
}

impl Bench {
    fn new(seed: u64, rigid_attachments: impl FnOnce(&Robot) -> Vec<RigidAttachment>) -> Self {
        let robot = world();
        Self {
            kinematics: Kinematics::new(&robot),
            rigid_attachments: rigid_attachments(&robot),
            robot,
            draw: Draw::new(seed),
        }
    }

    /// Draws motions of which the bound on `constraint` is finite, samples its rows along them and compares. `values`
    /// gives all rows, of which `rows` says what is asked.
    fn follow(
        &mut self,
        constraint: &Constraint,
        rows: &[Row],
        values: &dyn Fn(&[Pose]) -> Vec<f64>,
        tightness: &mut Tightness,
    ) {
        let carried: Vec<_> =
            self.rigid_attachments.iter().map(|c| AttachmentTemplate::fixed(c.object, c.carrier, c.X_CO)).collect();
        let one = std::slice::from_ref(constraint);
        let program = ConstraintProgram::compile(&self.robot, &self.kinematics, one, &carried, &[]).unwrap();
        if program.rows() == 0 {
            return; // nothing moves it
        }
        let q = self.draw.configuration(&self.robot);
        let scale = self.draw.rng.random_range(0.001..0.05);
        let mut delta = vec![0.0; self.robot.space.dimension()];
        program.variables().iter().for_each(|&v| delta[v] = self.draw.rng.random_range(-scale..scale));
        let at = |t: f64| {
            let (mut moved, step) = (q.clone(), delta.iter().map(|d| d * t).collect::<Vec<_>>());
            self.robot.space.integrate(&q, &step, &mut moved);
            (poses(&self.kinematics, &self.rigid_attachments, &moved), moved)
        };
        let (start, _) = at(0.0);
        let bound = program.residual_bound().between(&delta, &start);
        if bound == f64::INFINITY {
            return;
        }
        let at_end = |t: f64| {
            let (X_WJ, moved) = at(t);
            (residual(&self.robot, constraint, &moved, &X_WJ), values(&X_WJ))
        };
        let ((from, first), (to, last)) = (at_end(0.0), at_end(1.0));
        let mut most = 0.0_f64;
        for sample in 1..20 {
            let t = f64::from(sample) / 20.0;
            let (now, values) = at_end(t);
            assert!(
                now <= from.max(to) + bound + 1e-12,
                "{now} above {from} {to} by more than {bound}: {constraint:?}"
            );
            for (row, (a, b)) in first.iter().zip(&last).enumerate() {
                let off = values[row] - (a + (b - a) * t);
                // An inequality may rise above its chord by anything, and the bound is zero where it stays satisfied.
                if rows[row] == Row::Zero {
                    assert!(off.abs() <= bound + 1e-12, "row {row}: {off} above the bound {bound}: {constraint:?}");
                    most = most.max(off.abs());
                }
            }
        }
        if bound > 1e-9 && rows.contains(&Row::Zero) {
            tightness.ratios.push(most / bound);
        }
    }

    /// By which share of the bound a motion from `q` that is drawn leaves what a constraint allows between its ends; never by more than all.
    fn leaves_between(&mut self, constraint: &Constraint, q: &[f64]) -> f64 {
        let carried: Vec<_> =
            self.rigid_attachments.iter().map(|c| AttachmentTemplate::fixed(c.object, c.carrier, c.X_CO)).collect();
        let one = std::slice::from_ref(constraint);
        let program = ConstraintProgram::compile(&self.robot, &self.kinematics, one, &carried, &[]).unwrap();
        let scale = self.draw.rng.random_range(0.01..0.1);
        let mut delta = vec![0.0; self.robot.space.dimension()];
        program.variables().iter().for_each(|&v| delta[v] = self.draw.rng.random_range(-scale..scale));
        let depth = |t: f64| {
            let (mut moved, step) = (q.to_vec(), delta.iter().map(|d| d * t).collect::<Vec<_>>());
            self.robot.space.integrate(q, &step, &mut moved);
            let X_WJ = poses(&self.kinematics, &self.rigid_attachments, &moved);
            residual(&self.robot, constraint, &moved, &X_WJ)
        };
        let bound = program.residual_bound().between(&delta, &poses(&self.kinematics, &self.rigid_attachments, q));
        let ends = depth(0.0).max(depth(1.0));
        let most = (1..20).map(|sample| depth(f64::from(sample) / 20.0)).fold(0.0, f64::max);
        assert!(most <= ends + bound + 1e-12, "{most} above {ends} by more than {bound}: {constraint:?}");
        if bound > 0.0 { (most - ends) / bound } else { 0.0 }
    }
}

fn both(seed: u64, name: &str, least: f64, mut one: impl FnMut(&mut Bench, &mut Tightness, usize)) {
    let mut tightness = Tightness::default();
    for mut bench in [Bench::new(seed, |_| Vec::new()), Bench::new(seed + 1, held)] {
        for round in 0..ROUNDS {
            one(&mut bench, &mut tightness, round);
        }
    }
    assert!(tightness.ratios.len() > ROUNDS / 2, "{name}: only {} motions have a bound", tightness.ratios.len());
    let (median, closest) = tightness.summary();
    println!("{name}: sampled over bound: median {median:.3}, closest {closest:.2}");
    assert!(closest > least, "{name}: the bound is never nearer than {closest}");
}

#[test]
fn the_centre_of_mass_in_any_frame() {
    both(11, "centre of mass", 0.2, |bench, tightness, round| {
        let third = if round % 2 == 0 { Row::Inequality } else { Row::Zero };
        let balance = bench.draw.balance(&bench.robot, [Row::Zero, Row::Zero, third]);
        let balance = foliate_components::constraint::CentreOfMass { reference: Reference::Identity, ..balance };
        let rows: Vec<_> = balance.rows.iter().map(|plane| plane.row).collect();
        let values = |X_WJ: &[Pose]| {
            let mut values = vec![0.0; 3];
            centre_of_mass::value(&balance, &[], X_WJ, &mut values);
            values
        };
        bench.follow(&Constraint::CentreOfMass(balance.clone()), &rows, &values, tightness);
    });
}

/// Rows that may not be negative are deeper between two knots than at them by no more than the bound, also where they are
/// satisfied at both; some motions leave by much of it.
#[test]
fn half_spaces() {
    let mut left = 0;
    for mut bench in [Bench::new(13, |_| Vec::new()), Bench::new(14, held)] {
        for _ in 0..4 * ROUNDS {
            let mut balance = bench.draw.balance(&bench.robot, [Row::Inequality; 3]);
            balance.reference = Reference::Identity;
            // Planes near the centre of mass, or nothing happens.
            let q = bench.draw.configuration(&bench.robot);
            let center = centre_of_mass::in_frame(&balance, &poses(&bench.kinematics, &bench.rigid_attachments, &q));
            for plane in &mut balance.rows {
                plane.offset = plane.normal.dot(center) + bench.draw.rng.random_range(-1e-3..1e-3);
            }
            let constraint = Constraint::CentreOfMass(balance.clone());
            left += usize::from(bench.leaves_between(&constraint, &q) > 0.05);
        }
    }
    assert!(left > 5, "only {left} motions left their half-spaces between the knots");
}

/// The same of an axis whose angle is bounded, and of a point in a box.
#[test]
fn tilts_and_regions() {
    let mut left = [0; 2];
    for mut bench in [Bench::new(23, |_| Vec::new()), Bench::new(24, held)] {
        for _ in 0..16 * ROUNDS {
            let q = bench.draw.configuration(&bench.robot);
            let X_WJ = poses(&bench.kinematics, &bench.rigid_attachments, &q);
            let (a, b) = (bench.draw.frame(&bench.robot), bench.draw.frame(&bench.robot));
            let in_world = |frame: &Frame| placement_of(frame).in_world(&X_WJ);
            let X_AB = in_world(&a).inverse() * in_world(&b);
            let near = |bench: &mut Bench, value: f64| value + bench.draw.rng.random_range(-1e-3..1e-3);
            let angle = near(&mut bench, (X_AB.rotation * DVec3::Z).z.clamp(-1.0, 1.0).acos());
            if (Tilt::LEAST..=Tilt::MOST).contains(&angle) {
                let tilt = Constraint::Tilt(Tilt { a, b, within: angle });
                left[0] += usize::from(bench.leaves_between(&tilt, &q) > 1e-3);
            }
            let [x, y, z] = X_AB.translation.to_array().map(|value| near(&mut bench, value));
            let bounds = [(x, f64::INFINITY), (y - 1.0, y), (z, z + 1.0)];
            left[1] += usize::from(bench.leaves_between(&Constraint::Region(Region { a, b, bounds }), &q) > 1e-3);
        }
    }
    assert!(left.iter().all(|&left| left > 5), "only {left:?} motions left what is allowed between the knots");
}

/// A tilt is worth the angle between two axes, whatever moves them.
#[test]
fn a_tilt_is_the_angle_between_two_axes() {
    let mut bench = Bench::new(26, held);
    for _ in 0..ROUNDS {
        let q = bench.draw.configuration(&bench.robot);
        let X_WJ = poses(&bench.kinematics, &bench.rigid_attachments, &q);
        let (a, b) = (bench.draw.frame(&bench.robot), bench.draw.frame(&bench.robot));
        let axis = |frame: &Frame| placement_of(frame).in_world(&X_WJ).rotation * DVec3::Z;
        let angle = axis(&a).angle_between(axis(&b));
        let within = bench.draw.rng.random_range(Tilt::LEAST..Tilt::MOST);
        let found = residual(&bench.robot, &Constraint::Tilt(Tilt { a, b, within }), &q, &X_WJ);
        let wanted = ((within.cos() - angle.cos()) / within.sin()).max(0.0);
        assert!((found - wanted).abs() < 1e-9 * (1.0 + wanted), "{angle} within {within}: {found} {wanted}");
    }
}

#[test]
fn the_centre_of_mass_between_two_feet() {
    both(15, "between feet", 0.05, |bench, tightness, round| {
        let balance = bench.draw.between(&bench.robot, (round % 2 == 0).then_some(0.4));
        let count = com_between::dimension(&balance);
        let rows: Vec<_> = (0..count).map(|row| com_between::kind(&balance, row)).collect();
        let values = |X_WJ: &[Pose]| {
            let mut values = vec![0.0; count];
            com_between::value(&balance, X_WJ, &mut values);
            values
        };
        bench.follow(&Constraint::CentreOfMassBetween(balance.clone()), &rows, &values, tightness);
    });
}

#[test]
fn distances() {
    both(17, "distance", 0.2, |bench, tightness, round| {
        let row = if round % 3 == 0 { Row::Inequality } else { Row::Zero };
        let apart = bench.draw.distance(&bench.robot, row, round % 2 == 0);
        let values = |X_WJ: &[Pose]| vec![distance::value(&apart, X_WJ)];
        bench.follow(&Constraint::Distance(apart), &[row], &values, tightness);
    });
}

#[test]
fn functions_of_a_hosts_own() {
    both(19, "function", 0.01, |bench, tightness, _| {
        let own = bench.draw.gaze(&bench.robot);
        let values = |X_WJ: &[Pose]| custom::value(&own, X_WJ);
        bench.follow(&Constraint::Custom(own.clone()), own.0.rows(), &values, tightness);
    });
}

/// Translation rows of a relative pose that may not be negative.
#[test]
fn half_spaces_of_relative_poses() {
    both(21, "half-spaces of a relative pose", 0.2, |bench, tightness, _| {
        let (a, b) = (bench.draw.frame(&bench.robot), bench.draw.frame(&bench.robot));
        let rows = [Some(Row::Zero), Some(Row::Inequality), Some(Row::Inequality), None, None, None];
        let pose = RelativePose { a, b, rows, reference: Reference::Identity };
        let values = |X_WJ: &[Pose]| {
            let all = relative_pose::value(&placement_of(&a), &placement_of(&b), &Pose::identity(), X_WJ);
            all[..3].to_vec()
        };
        let kinds = [Row::Zero, Row::Inequality, Row::Inequality];
        bench.follow(&Constraint::RelativePose(pose), &kinds, &values, tightness);
    });
}

/// A function whose host gives no bound, or none that means anything.
#[derive(Debug)]
struct Unbounded(Frame, Option<Curvature>);

impl Function for Unbounded {
    fn name(&self) -> &str {
        "unbounded"
    }

    fn frames(&self) -> &[Frame] {
        std::slice::from_ref(&self.0)
    }

    fn rows(&self) -> &[Row] {
        &[Row::Zero]
    }

    fn value(&self, X_WF: &[Pose], values: &mut [f64]) {
        values[0] = X_WF[0].translation.x;
    }

    fn gradient(&self, _: &[Pose], gradients: &mut [Gradient]) {
        gradients[0].linear.x = 1.0;
    }

    fn curvature(&self) -> Option<Curvature> {
        self.1
    }
}

#[test]
fn a_function_without_a_bound_is_never_certified() {
    let bench = Bench::new(23, |_| Vec::new());
    let hand = Frame::of_joint(bench.robot.joint("arm/w2").unwrap());
    let q = bench.robot.space.neutral();
    let bodies = poses(&bench.kinematics, &[], &q);
    let delta = vec![0.01; bench.robot.space.dimension()];
    let bound = |curvature| {
        let own = Constraint::Custom(Custom(Arc::new(Unbounded(hand, curvature))));
        let program = ConstraintProgram::compile(&bench.robot, &bench.kinematics, &[own], &[], &[]).unwrap();
        let bound = program.residual_bound();
        assert_eq!(bound.between(&vec![0.0; delta.len()], &bodies), 0.0, "what does not move needs no bound");
        bound.between(&delta, &bodies)
    };
    let of = |lipschitz, bend| Some(Curvature { lipschitz, bend });
    for useless in [None, of(f64::NAN, 1.0), of(1.0, -1.0), of(f64::INFINITY, 0.0), of(0.0, f64::NAN)] {
        assert_eq!(bound(useless), f64::INFINITY, "{useless:?}");
    }
    assert!(bound(of(1.0, 0.0)) < 0.1);
}
