//! Knots of path files: columns, new ones in between, and what is met on the way through them.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::every_answer::dense::{Places, in_world, pairs_of};
use crate::every_answer::solve::Answer;
use crate::random_scene::draw::Draw;
use foliate::components::Pose;
use foliate::components::path::Segment;
use foliate::kernels::collision::{DistanceQuery, Solid, clearance};
use foliate::kernels::kinematics::Kinematics;
use foliate::path_file::PathFile;
use foliate::scene::coordinate_names;
use glam::DVec3;

/// The column of a coordinate.
pub fn columns(file: &PathFile, name: &str) -> Option<usize> {
    file.coordinates.iter().position(|n| n == name)
}

/// Columns of the robot's joints with limits that leave them room, and these.
pub fn joints(answer: &Answer) -> Vec<(usize, [f64; 2])> {
    let root = ["x", "y", "z", "qx", "qy", "qz", "qw", "theta"];
    let file = &answer.file;
    let of = |(column, name): (usize, &String)| {
        let joint = name.strip_prefix("robot/").filter(|joint| !root.contains(joint))?;
        let limits = *file.limits.get(name)?;
        (!joint.is_empty() && limits[1] - limits[0] > 1e-3).then_some((column, limits))
    };
    let locked = &answer.model.problem.graph.locked;
    let names: Vec<&str> =
        locked.iter().map(|(joint, _)| answer.model.problem.robot.joints[joint.at()].name.as_str()).collect();
    let free = |(_, name): &(usize, &String)| !names.contains(&name.as_str());
    file.coordinates.iter().enumerate().filter(free).filter_map(of).collect()
}

/// The numbers of a knot in the order of the planner's configurations.
pub fn configuration(answer: &Answer, knot: &[f64]) -> Vec<f64> {
    let names = coordinate_names(&answer.model.problem.robot);
    names.iter().map(|name| knot[columns(&answer.file, name).expect("a coordinate of the planner")]).collect()
}

/// A place of a segment, as a knot of the file: interpolated, objects as the first knot has them.
pub fn middle(answer: &Answer, segment: usize, draw: &mut Draw) -> Vec<f64> {
    let knots = &answer.file.segments[segment].knots;
    let (a, b, t) = (&knots[0], &knots[1], 0.2 + 0.6 * draw.unit());
    let robot = &answer.model.problem.robot;
    let mut q = vec![0.0; robot.space.size()];
    robot.space.interpolate(&configuration(answer, a), &configuration(answer, b), t, &mut q);
    let mut knot = a.clone();
    for (name, value) in coordinate_names(robot).iter().zip(q) {
        knot[columns(&answer.file, name).expect("a coordinate of the planner")] = value;
    }
    knot
}

/// Leaves the knots of a path, straight from one to the next: what is done to them is then known in between.
pub fn without_times(file: &mut PathFile) {
    for segment in &mut file.segments {
        (segment.times, segment.velocities) = (None, None);
    }
    for event in file.events.iter_mut().flatten() {
        (event.time, event.dwell) = (None, 0.0);
    }
    file.rate_limits = None;
    let claims = &mut file.certificate;
    (claims.max_velocity, claims.max_acceleration, claims.continuity) = (None, None, None);
}

/// Puts a knot behind the first one of a segment.
pub fn inserted(file: &mut PathFile, segment: usize, knot: Vec<f64>) {
    file.segments[segment].knots.insert(1, knot);
}

/// Adds to a coordinate from a knot of a segment on, to the end of the path.
pub fn shift(file: &mut PathFile, segment: usize, knot: usize, column: usize, by: f64) {
    for (index, entry) in file.segments.iter_mut().enumerate().skip(segment) {
        let first = if index == segment { knot } else { 0 };
        for knot in entry.knots.iter_mut().skip(first) {
            knot[column] += by;
        }
    }
}

/// Calls for every sample of the ways between knots, with the pair and its distance, up to `most`.
fn look(answer: &Answer, segment: &Segment, knots: &[Vec<f64>], most: f64, mut see: impl FnMut(&str, f64)) {
    let robot = &answer.model.problem.robot;
    let kinematics = Kinematics::new(robot);
    let Ok(pairs) = pairs_of(answer) else { return };
    let solids: Vec<Solid> = robot.shapes.iter().map(|shape| Solid::of(&shape.geometry)).collect();
    let places = Places::new(robot, &kinematics, segment);
    let ask = DistanceQuery { needed: most, floor: most, ground: most, absolute: 1e-9, relative: 0.0 };
    for ends in knots.windows(2) {
        for step in 0..=60 {
            let X_WJ: Vec<Pose> = places.at(&ends[0], &ends[1], f64::from(step) / 60.0);
            for &(a, b) in &pairs {
                let (X_WA, X_WB) = (in_world(robot, a, &X_WJ), in_world(robot, b, &X_WJ));
                let found = clearance(&solids[a], &X_WA, &solids[b], &X_WB, ask, &mut DVec3::ZERO.clone());
                see(&format!("{} and {}", robot.shapes[a].name, robot.shapes[b].name), found);
            }
        }
    }
}

/// A pair that meets on the way from the first knot of a segment to another one and on to the second, if there is one.
pub fn collides(answer: &Answer, segment: usize, knot: &[f64]) -> Option<String> {
    let segment = &answer.path.segments[segment];
    let way = [segment.knots[0].clone(), configuration(answer, knot), segment.knots[1].clone()];
    let mut met = None;
    look(answer, segment, &way, 1e-4, |pair, distance| {
        if distance <= 0.0 && met.is_none() {
            met = Some(pair.to_owned());
        }
    });
    met
}

/// The smallest distance that is seen along a path.
pub fn through(answer: &Answer) -> Option<f64> {
    let mut least = f64::INFINITY;
    for segment in &answer.path.segments {
        look(answer, segment, &segment.knots, 10.0, |_, distance| least = least.min(distance));
    }
    least.is_finite().then_some(least)
}
