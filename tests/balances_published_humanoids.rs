//! Promise: where the mass of published humanoids is, is where pinocchio and the benchmark's records say; and they can be
//! put on both feet in balance, with what they hold.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]
#![allow(non_snake_case, reason = "pose names carry their frames")]

mod common;

use foliate::components::Pose;
use foliate::components::constraint::{
    CentreOfMass, Constraint, Frame, Masses, PlaneRow, Reference, RelativePose, Row,
};
use foliate::components::robot::{PartIndex, PartKind, PartPlacement, Robot, RootJoint};
use foliate::kernels::constrained_motion::{
    ConstraintProgram, MotionEnd, MotionScratch, MotionSettings, Scratch, Settings, project, project_motion,
};
use foliate::kernels::constraints::{centre_of_mass, residual};
use foliate::kernels::kinematics::Kinematics;
use foliate::scene::{PackagePath, UpAxis, coordinate_names, read_model};
use glam::DVec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;

/// A humanoid with a configuration in which its records give the centre of mass.
struct Humanoid {
    urdf: &'static str,
    /// Height of the root, then joint values that are not zero.
    root: [f64; 3],
    joints: &'static [(&'static str, f64)],
    ankles: [&'static str; 2],
    /// Centre of mass in the left ankle's frame.
    recorded: [f64; 3],
}

/// Half sitting in `hpp_benchmark`'s romeo-placard, as pinocchio 4.1.0 reads the model with mimic joints free.
const ROMEO: Humanoid = Humanoid {
    urdf: "romeo_description/urdf/romeo.urdf",
    root: [0.0, 0.0, 0.840_252],
    joints: &[
        ("LHipPitch", -0.349_065_8),
        ("LKneePitch", 0.698_131_7),
        ("LAnklePitch", -0.349_065_8),
        ("RHipPitch", -0.349_065_8),
        ("RKneePitch", 0.698_131_7),
        ("RAnklePitch", -0.349_065_8),
        ("LShoulderPitch", 1.5),
        ("LShoulderYaw", 0.6),
        ("LElbowRoll", -0.5),
        ("LElbowYaw", -1.05),
        ("LWristRoll", -0.4),
        ("LWristYaw", -0.3),
        ("LWristPitch", -0.2),
        ("RShoulderPitch", 1.5),
        ("RShoulderYaw", -0.6),
        ("RElbowRoll", 0.5),
        ("RElbowYaw", 1.05),
        ("RWristRoll", -0.4),
        ("RWristYaw", -0.3),
        ("RWristPitch", -0.2),
    ],
    ankles: ["LAnkleRoll", "RAnkleRoll"],
    recorded: [0.021_014_985_348_277_258, -0.096_101_564_415_079_61, 0.594_226_294_672_365_1],
};

/// Half sitting in `hpp_benchmark`'s pyrene-on-the-ground, likewise.
const TALOS: Humanoid = Humanoid {
    urdf: "talos_data/robots/talos_full_v2.urdf",
    root: [0.0, 0.0, 1.019_272_022_956_702_7],
    joints: &[
        ("leg_left_3_joint", -0.411_354),
        ("leg_left_4_joint", 0.859_395),
        ("leg_left_5_joint", -0.448_041),
        ("leg_left_6_joint", -0.001_708),
        ("leg_right_3_joint", -0.411_354),
        ("leg_right_4_joint", 0.859_395),
        ("leg_right_5_joint", -0.448_041),
        ("leg_right_6_joint", -0.001_708),
        ("torso_2_joint", 0.006_761),
        ("arm_left_1_joint", 0.258_47),
        ("arm_left_2_joint", 0.173_046),
        ("arm_left_3_joint", -0.000_2),
        ("arm_left_4_joint", -0.525_366),
        ("arm_left_7_joint", 0.1),
        ("arm_right_1_joint", -0.258_47),
        ("arm_right_2_joint", -0.173_046),
        ("arm_right_3_joint", 0.000_2),
        ("arm_right_4_joint", -0.525_366),
        ("arm_right_7_joint", 0.1),
    ],
    ankles: ["leg_left_6_joint", "leg_right_6_joint"],
    recorded: [0.006_863_110_310_102_515, -0.086_271_650_676_487_88, 0.786_588_589_894_405_4],
};

impl Humanoid {
    fn load(&self, packages: &PackagePath, mimic_follows: bool) -> Robot {
        let url = format!("package://example-robot-data/robots/{}", self.urdf);
        let read = read_model(&url, None, UpAxis::AsWritten, packages).unwrap();
        let placement = PartPlacement {
            name: "robot".into(),
            kind: PartKind::Robot,
            root: RootJoint::FreeFlyer,
            world_from_root: Pose::identity(),
            mimic_follows,
            root_bounds: vec![(-1.0, 1.0), (-1.0, 1.0), (0.3, 1.5)],
            joint_bounds: Vec::new(),
        };
        Robot::compose(&[(&read.model, placement)]).unwrap()
    }

    fn standing(&self, robot: &Robot) -> Vec<f64> {
        let names = coordinate_names(robot);
        let at = |name: &str| names.iter().position(|n| n == &format!("robot/{name}"));
        let mut q = robot.space.neutral();
        for (axis, value) in ["x", "y", "z"].iter().zip(self.root) {
            q[at(axis).unwrap()] = value;
        }
        for (joint, value) in self.joints {
            q[at(joint).unwrap_or_else(|| unreachable!("{joint}"))] = *value;
        }
        q
    }

    /// The centre of mass, fixed in the left ankle's frame where the record has it, and both feet where they stand.
    fn balance(&self, robot: &Robot, standing: &[f64]) -> [Constraint; 3] {
        let bodies = poses(robot, standing);
        let ankle = |name: &str| Frame::of_joint(robot.joint(&format!("robot/{name}")).unwrap());
        let foot = |name: &str| {
            let frame = ankle(name);
            let there = Reference::Fixed(bodies[frame.joint.unwrap().at()]);
            Constraint::RelativePose(RelativePose::rigid(Frame::world(Pose::identity()), frame, there))
        };
        let masses = Masses::of_parts(robot, &[PartIndex(0)]).unwrap();
        let recorded = DVec3::from_array(self.recorded);
        let row = |normal: DVec3| PlaneRow { normal, offset: normal.dot(recorded), row: Row::Zero };
        let (frame, rows) = (ankle(self.ankles[0]), DVec3::AXES.map(row).to_vec());
        let balance = CentreOfMass { masses, frame, rows, reference: Reference::Identity };
        let [left, right] = self.ankles.map(foot);
        [left, right, Constraint::CentreOfMass(balance)]
    }
}

fn poses(robot: &Robot, q: &[f64]) -> Vec<Pose> {
    let kinematics = Kinematics::new(robot);
    let mut bodies = vec![Pose::identity(); kinematics.bodies()];
    kinematics.forward(q, &mut bodies);
    bodies
}

#[test]
fn the_centre_of_mass_is_that_of_the_records() {
    let Some(packages) = common::published_models("the_centre_of_mass_is_that_of_the_records") else { return };
    for humanoid in [ROMEO, TALOS] {
        let robot = humanoid.load(&packages, false);
        let standing = humanoid.standing(&robot);
        let [_, _, balance] = humanoid.balance(&robot, &standing);
        let off = residual(&robot, &balance, &standing, &poses(&robot, &standing));
        println!("{}: {off:.1e} m from the record", humanoid.urdf);
        assert!(off < 1e-9, "{}: {off}", humanoid.urdf);
    }
}

#[test]
fn the_centre_of_mass_is_pinocchios() {
    let test = "the_centre_of_mass_is_pinocchios";
    let Some(packages) = common::published_models(test) else { return };
    let Some(python) = common::skip::python_with("pinocchio", test) else { return };
    for humanoid in [ROMEO, TALOS] {
        let robot = humanoid.load(&packages, false);
        let masses = Masses::of_parts(&robot, &[PartIndex(0)]).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let mut q = robot.space.neutral();
        let mut configurations = Vec::new();
        let mut ours = Vec::new();
        for _ in 0..20 {
            robot.space.random(&mut rng, &mut q);
            configurations.push(named(&robot, &q));
            ours.push(centre_of_mass::centre(&masses, &poses(&robot, &q)));
        }
        let directory = packages.find("example-robot-data").unwrap();
        let file = directory.join("robots").join(humanoid.urdf);
        let theirs = pinocchio(&python, &file, &configurations);
        let total = theirs["mass"].as_f64().unwrap();
        assert!((masses.total() - total).abs() < 1e-9 * total, "{}: {} {total} kg", humanoid.urdf, masses.total());
        for (ours, theirs) in ours.iter().zip(theirs["centers"].as_array().unwrap()) {
            let theirs: Vec<f64> = theirs.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
            let off = ours.distance(DVec3::new(theirs[0], theirs[1], theirs[2]));
            assert!(off < 1e-9, "{}: {off}", humanoid.urdf);
        }
    }
}

fn named(robot: &Robot, q: &[f64]) -> Value {
    let names = coordinate_names(robot);
    names.iter().map(|name| name.trim_start_matches("robot/").to_owned()).zip(q.iter().map(|x| json!(x))).collect()
}

/// Asks pinocchio, which takes every mimic joint as free here.
fn pinocchio(python: &Path, urdf: &Path, configurations: &[Value]) -> Value {
    let script = r"
import json, sys
import pinocchio as pin
request = json.loads(sys.argv[1])
model = pin.buildModelFromUrdf(request['urdf'], pin.JointModelFreeFlyer())
data = model.createData()
centers = []
for values in request['configurations']:
    q = pin.neutral(model)
    q[:7] = [values[k] for k in ('x', 'y', 'z', 'qx', 'qy', 'qz', 'qw')]
    for joint, name in zip(model.joints[2:], model.names[2:]):
        assert joint.nq == 1, name
        q[joint.idx_q] = values[name]
    centers.append(list(pin.centerOfMass(model, data, q)))
print(json.dumps({'mass': pin.computeTotalMass(model), 'centers': centers}))
";
    let request = json!({ "urdf": urdf, "configurations": configurations }).to_string();
    let output = Command::new(python).args(["-c", script, &request]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// From configurations around the recorded one both feet come to the ground and the centre of mass over them; the motion
/// from one to another keeps it there between its knots, by the bound and by sampling.
#[test]
fn published_humanoids_stand_and_move_in_balance() {
    let Some(packages) = common::published_models("published_humanoids_stand_and_move_in_balance") else { return };
    for humanoid in [ROMEO, TALOS] {
        let robot = humanoid.load(&packages, true);
        let kinematics = Kinematics::new(&robot);
        let names = coordinate_names(&robot);
        let mut standing = robot.space.neutral();
        let free = humanoid.load(&packages, false);
        for (name, value) in coordinate_names(&free).iter().zip(humanoid.standing(&free)) {
            names.iter().position(|n| n == name).into_iter().for_each(|i| standing[i] = value);
        }
        let constraints = humanoid.balance(&robot, &standing);
        let program = ConstraintProgram::compile(&robot, &kinematics, &constraints, &[], &[]).unwrap();
        assert_eq!(program.rows(), 15);
        let (mut scratch, mut rng) = (Scratch::default(), ChaCha8Rng::seed_from_u64(7));
        let (mut random, mut solutions) = (standing.clone(), Vec::new());
        for _ in 0..40 {
            robot.space.random(&mut rng, &mut random);
            // A tenth of the way to anywhere.
            let mut q = standing.clone();
            robot.space.interpolate(&standing, &random, 0.1, &mut q);
            if !project(&program, &mut q, &[], &Settings::default(), &mut scratch).is_converged() {
                continue;
            }
            let bodies = poses(&robot, &q);
            for constraint in &constraints {
                assert!(residual(&robot, constraint, &q, &bodies) < 2e-6);
            }
            solutions.push(q);
        }
        assert!(solutions.len() >= 35, "{}: {} of 40", humanoid.urdf, solutions.len());
        let (mut memory, settings) = (MotionScratch::default(), MotionSettings::default());
        let (mut reached, mut count, mut worst) = (0, 0, 0.0_f64);
        for pair in solutions.windows(2).take(10) {
            let mut knots = Vec::new();
            let ends = (pair[0].as_slice(), pair[1].as_slice());
            let end = project_motion(&program, &robot.space, ends, &[], &settings, &mut memory, &mut knots);
            reached += usize::from(end == MotionEnd::Reached);
            let knots: Vec<_> = knots.chunks(robot.space.size()).collect();
            count += knots.len();
            let mut q = standing.clone();
            for step in knots.windows(2) {
                for sample in 0..=8 {
                    robot.space.interpolate(step[0], step[1], f64::from(sample) / 8.0, &mut q);
                    let mut bodies = vec![Pose::identity(); kinematics.bodies()];
                    kinematics.forward(&q, &mut bodies);
                    worst = constraints.iter().map(|c| residual(&robot, c, &q, &bodies)).fold(worst, f64::max);
                }
            }
        }
        println!("{}: {reached} of 10 motions, {count} knots, at most {worst:.1e} off", humanoid.urdf);
        assert!(reached >= 8, "{}: {reached}", humanoid.urdf);
        assert!(worst <= settings.path_tolerance, "{}: {worst}", humanoid.urdf);
    }
}
