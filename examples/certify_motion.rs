//! Is a given motion free? Certifies a spline through timed points in the embedded scene, without a file.

use foliate::certify::{
    Certifier, CertifyOptions, Interpolation, Motion, Point, Rates, Turns, Verdict, find_coordinate,
};
use foliate::kernels::collision::CollisionScratch;
use foliate::scene::{PackagePath, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::load("demo", &PackagePath::from_environment(&[]))?;
    // Built once; any number of threads may use it, each with its own scratch.
    let certifier = Certifier::new(&scene.problem, &[])?;
    let mut scratch = CollisionScratch::new();

    // The first joints of both arms: how far they turn, in radians, and how fast at the points.
    let robot = certifier.robot();
    let names = ["robot/left_shoulder_yaw", "robot/right_shoulder_yaw"];
    let joints = names.map(|name| find_coordinate(robot, name)).into_iter().collect::<Result<Vec<_>, _>>()?;
    let start: Vec<f64> = joints.iter().map(|&joint| scene.problem.start[joint]).collect();
    let point = |time: f64, turn: f64| Point {
        time: Some(time),
        positions: start.iter().map(|value| value + turn).collect(),
        velocities: Some(vec![0.0; joints.len()]),
        accelerations: None,
    };
    for turn in [0.1, 1.5] {
        let points = [point(0.0, 0.0), point(2.0, turn)];
        let motion = Motion::through(robot, joints.clone(), &points, Interpolation::Auto, Turns::Format)
            .map_err(|error| format!("point {}: {}", error.point, error.message))?;
        let rates = Rates { acceleration: Some(5.0), ..Rates::default() };
        let options = CertifyOptions { clearance: true, rates, ..CertifyOptions::default() };
        let report = certifier.certify(&motion, &options, &mut scratch)?;
        match (report.verdict, &report.contact, &report.clearance) {
            (Verdict::Free, _, Some(clearance)) => {
                println!("{turn}: free, at least {:.1} mm", clearance.at_least * 1e3)
            }
            (Verdict::Contact, Some(contact), _) => {
                println!("{turn}: {} meet at {:.6} s", contact.pair.links.join(" and "), contact.at);
            }
            (verdict, ..) => println!("{turn}: {verdict:?}"),
        }
        for violation in &report.limits.violations {
            println!("  {} breaks its {:?} limit at {:.3} s", violation.joint, violation.kind, violation.first_at);
        }
    }
    Ok(())
}
