//! Thin posts beside what a path sweeps: scenes in which a motion that is tested only at samples passes through something.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use super::dense::{Places, in_world};
use super::solve::Answer;
use crate::random_scene::RandomScene;
use crate::random_scene::draw::Draw;
use foliate::components::Pose;
use foliate::components::pose::pose_to_array;
use foliate::components::robot::Robot;
use foliate::components::robot::shape::Geometry;
use foliate::kernels::collision::{DistanceQuery, Solid, clearance};
use foliate::kernels::kinematics::Kinematics;
use glam::{DQuat, DVec3};

/// How thick a post is, metres.
pub const THICK: f64 = 1e-3;

/// A post: where its middle is, and how long it is.
#[derive(Clone, Copy, Debug)]
pub struct Post {
    pub pose: Pose,
    pub length: f64,
}

impl Post {
    /// Whether no shape is that near where the bodies are there.
    fn is_free(&self, robot: &Robot, X_WJ: &[Pose], least: f64) -> bool {
        let post = self.solid();
        let ask = DistanceQuery { needed: least, floor: least, ground: least, absolute: 1e-9, relative: 0.0 };
        (0..robot.shapes.len()).all(|shape| {
            let (solid, place) = (Solid::of(&robot.shapes[shape].geometry), in_world(robot, shape, X_WJ));
            clearance(&post, &self.pose, &solid, &place, ask, &mut DVec3::ZERO.clone()) >= least
        })
    }

    /// What it is made of.
    pub fn solid(&self) -> Solid {
        Solid::of(&Geometry::Box { half_extents: DVec3::new(THICK / 2.0, THICK / 2.0, self.length / 2.0) })
    }

    /// Its URDF.
    pub fn urdf(&self) -> String {
        let length = self.length;
        format!(
            "<robot name=\"post\"><link name=\"post\"><collision><geometry><box size=\"{THICK} {THICK} {length}\"/>\
             </geometry></collision></link></robot>\n"
        )
    }
}

/// The longest way of a shape's origin that counts as standing still, metres.
const STILL: f64 = 0.01;

/// Posts whose middles are that far from the surface of something that moves, at random places of the path, and that
/// leave start and end free. A negative distance puts them into what moves.
pub fn beside(draw: &mut Draw, answer: &Answer, count: usize, distance: f64) -> Vec<Post> {
    let robot = &answer.model.problem.robot;
    let kinematics = Kinematics::new(robot);
    let segments = &answer.path.segments;
    let ends = [(segments.first(), 0.0), (segments.last(), 1.0)].map(|(segment, t)| {
        let segment = segment.expect("a path has segments");
        let knots = &segment.knots[if t > 0.0 { segment.knots.len() - 2 } else { 0 }..];
        Places::new(robot, &kinematics, segment).at(&knots[0], &knots[1], t)
    });
    let least = answer.model.problem.margins.iter().map(|m| m.distance).fold(0.002, f64::max);
    let mut posts = Vec::new();
    for _ in 0..count * 20 {
        if posts.len() == count {
            break;
        }
        let segment = &segments[draw.index(segments.len())];
        let knot = draw.index(segment.knots.len() - 1);
        let places = Places::new(robot, &kinematics, segment);
        let (a, b) = (&segment.knots[knot], &segment.knots[knot + 1]);
        let (X_WJ, before) = (places.at(a, b, 0.1 + 0.8 * draw.unit()), places.at(&segment.knots[0], a, 0.0));
        let shape = draw.index(robot.shapes.len());
        let X_WS = in_world(robot, shape, &X_WJ);
        if (X_WS.translation - in_world(robot, shape, &before).translation).length() < STILL {
            continue;
        }
        let solid = Solid::of(&robot.shapes[shape].geometry);
        let Some(point) = at_distance(draw, &solid, &X_WS, distance) else { continue };
        let turn = DQuat::from_rotation_arc(DVec3::Z, direction(draw));
        let post = Post { pose: Pose::from_parts(point, turn), length: draw.range(0.02, 0.2) };
        if ends.iter().all(|X_WJ| post.is_free(robot, X_WJ, least)) {
            posts.push(post);
        }
    }
    posts
}

fn direction(draw: &mut Draw) -> DVec3 {
    loop {
        let v = DVec3::new(draw.unit() - 0.5, draw.unit() - 0.5, draw.unit() - 0.5);
        if v.length() > 0.1 {
            return v.normalize();
        }
    }
}

/// A point so far from a solid: moves in from outside as far as is free.
fn at_distance(draw: &mut Draw, solid: &Solid, X_WS: &Pose, distance: f64) -> Option<DVec3> {
    let probe = Solid::of(&Geometry::Sphere { radius: 1e-9 });
    let way = direction(draw);
    let mut point = X_WS.translation + way * 2.0;
    for _ in 0..200 {
        let ask = DistanceQuery { needed: 10.0, floor: 10.0, ground: 10.0, absolute: 1e-9, relative: 0.0 };
        let free = clearance(&probe, &Pose::from_translation(point), solid, X_WS, ask, &mut DVec3::ZERO.clone());
        if free - distance.max(0.0) < 1e-6 {
            return Some(point - way * (-distance).max(0.0));
        }
        point -= way * (free - distance.max(0.0)).max(1e-7);
        if (point - X_WS.translation).dot(way) < 0.0 {
            return None;
        }
    }
    None
}

/// The scene of an answer, with posts beside what that answer swept. The scene of a seed has always the same posts.
pub fn among_posts(scene: &RandomScene, answer: &Answer) -> RandomScene {
    let mut draw = Draw::new(scene.seed, 1_000_003);
    let mut scene = scene.clone();
    let (count, distance) = (1 + draw.index(4), draw.range(0.0006, 0.006));
    let mut parts = String::new();
    for (number, post) in beside(&mut draw, answer, count, distance).iter().enumerate() {
        let name = format!("thin{number}");
        scene.files.push((format!("{name}.urdf"), post.urdf().into_bytes()));
        let pose = pose_to_array(&post.pose);
        parts +=
            &format!("[[part]]\nname = \"{name}\"\nkind = \"environment\"\nurdf = \"{name}.urdf\"\npose = {pose:?}\n");
    }
    for (name, content) in &mut scene.files {
        if name == "scene.toml" {
            let text = String::from_utf8_lossy(content).replacen("[graph]\n", &format!("{parts}[graph]\n"), 1);
            *content = text.into_bytes();
        }
    }
    scene
}
