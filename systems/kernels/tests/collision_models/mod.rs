//! Robots built in code for the collision tests.
#![allow(dead_code, reason = "each test file uses some of it")]
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a model that cannot be built fails its test"
)]

use foliate_components::Pose;
use foliate_components::robot::model::{JointKind, JointModel, LinkModel, Model};
use foliate_components::robot::shape::{Geometry, Mesh};
use foliate_components::robot::{DisabledPair, PartKind, PartPlacement, Robot, RootJoint, ShapeIndex};
use foliate_kernels::collision::{CollisionScene, DistanceQuery, PairId, PairRule, pair_clearance};
use foliate_kernels::kinematics::Kinematics;
use glam::{DQuat, DVec3};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

pub fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_translation(DVec3::new(x, y, z))
}

pub fn link(name: &str, shapes: Vec<(Pose, Geometry)>) -> LinkModel {
    LinkModel { name: name.into(), shapes, inertial: None }
}

pub fn joint(name: &str, kind: JointKind, parent: usize, child: usize, pose: Pose, axis: DVec3) -> JointModel {
    JointModel {
        name: name.into(),
        kind,
        parent,
        child,
        parent_from_joint: pose,
        axis,
        limits: (-3.0, 3.0),
        velocity_limit: None,
        mimic: None,
    }
}

pub fn placed(name: &str, kind: PartKind, root: RootJoint, pose: Pose) -> PartPlacement {
    PartPlacement {
        name: name.into(),
        kind,
        root,
        world_from_root: pose,
        mimic_follows: true,
        root_bounds: vec![(-2.0, 2.0); 3],
        joint_bounds: Vec::new(),
    }
}

/// A model of one link.
pub fn single(shapes: Vec<(Pose, Geometry)>) -> Model {
    Model { name: "single".into(), links: vec![link("body", shapes)], ..Model::default() }
}

pub fn cuboid(x: f64, y: f64, z: f64) -> Geometry {
    Geometry::Box { half_extents: DVec3::new(x, y, z) * 0.5 }
}

pub fn compose(parts: &[(&Model, PartPlacement)]) -> Robot {
    Robot::compose(parts).expect("the models make a robot")
}

pub fn random_vector(rng: &mut ChaCha8Rng, reach: f64) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| rng.random_range(-reach..=reach)))
}

pub fn random_rotation(rng: &mut ChaCha8Rng) -> DQuat {
    // Uniform enough: a normalised point of the ball.
    loop {
        let v: [f64; 4] = std::array::from_fn(|_| rng.random_range(-1.0..=1.0));
        let q = DQuat::from_array(v);
        if q.length() > 0.1 && q.length() < 1.0 {
            return q.normalize();
        }
    }
}

pub fn random_pose(rng: &mut ChaCha8Rng, reach: f64) -> Pose {
    Pose::from_parts(random_vector(rng, reach), random_rotation(rng))
}

/// Box, cylinder, capsule, sphere or a star-shaped mesh, some decimetres large.
pub fn random_geometry(rng: &mut ChaCha8Rng, kind: usize) -> Geometry {
    let mut size = || 10.0_f64.powf(rng.random_range(-2.0..-0.3));
    match kind {
        0 => Geometry::Sphere { radius: size() },
        1 => Geometry::Box { half_extents: DVec3::new(size(), size(), size()) },
        2 => Geometry::Cylinder { radius: size(), half_length: size() },
        3 => Geometry::Capsule { radius: size(), half_length: size() },
        _ => {
            let radius = size();
            Geometry::Mesh(Arc::new(star(rng, radius)))
        }
    }
}

/// A closed mesh around the origin, like a crumpled ball: `12 · 14 · 2` triangles.
pub fn star(rng: &mut ChaCha8Rng, radius: f64) -> Mesh {
    let (rows, columns) = (12_u32, 14_u32);
    let mut vertices = vec![DVec3::Z * radius, -DVec3::Z * radius];
    for row in 0..rows {
        let polar = std::f64::consts::PI * f64::from(row + 1) / f64::from(rows + 1);
        for column in 0..columns {
            let azimuth = std::f64::consts::TAU * f64::from(column) / f64::from(columns);
            let out = DVec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos());
            vertices.push(out * radius * rng.random_range(0.6..1.0));
        }
    }
    let id = |row: u32, column: u32| 2 + row * columns + column % columns;
    let mut triangles = Vec::new();
    for c in 0..columns {
        triangles.push([0, id(0, c), id(0, c + 1)]);
        triangles.push([1, id(rows - 1, c + 1), id(rows - 1, c)]);
        for r in 0..rows - 1 {
            triangles.push([id(r, c), id(r + 1, c), id(r + 1, c + 1)]);
            triangles.push([id(r, c), id(r + 1, c + 1), id(r, c + 1)]);
        }
    }
    Mesh::new("star".into(), vertices, triangles)
}

/// The surface of a box as a closed mesh, each side cut into `n · n · 2` triangles.
pub fn box_mesh(h: DVec3, n: u32) -> Mesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
        let first = vertices.len() as u32;
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for i in 0..=n {
            for j in 0..=n {
                let mut p = DVec3::ZERO;
                // Computed from integers in one way, so that sides share vertices bit for bit.
                let along = |k: u32, half: f64| half * (2.0 * f64::from(k) - f64::from(n)) / f64::from(n);
                (p[axis], p[u], p[v]) = (sign * h[axis], along(i, h[u]), along(j, h[v]));
                vertices.push(p);
            }
        }
        let id = |i: u32, j: u32| first + i * (n + 1) + j;
        for i in 0..n {
            for j in 0..n {
                let quad = [[id(i, j), id(i + 1, j), id(i + 1, j + 1)], [id(i, j), id(i + 1, j + 1), id(i, j + 1)]];
                let turned = quad.map(|[a, b, c]| if sign > 0.0 { [a, b, c] } else { [a, c, b] });
                triangles.extend(turned);
            }
        }
    }
    Mesh::new("box".into(), vertices, triangles)
}

/// Pose of a joint in its parent link, its axis, and the shapes of its link.
type LinkPlan = (Pose, DVec3, Vec<(Pose, Geometry)>);

/// Two arms of seven joints on a pedestal, of Baxter's proportions: cylinders and boxes on every link, grippers with two
/// prismatic fingers, and a head. No shape overlaps a neighbour's by design; neighbours are left alone all the same.
pub fn two_arms() -> Model {
    let cylinder = |radius: f64, length: f64| Geometry::Cylinder { radius, half_length: 0.5 * length };
    let mut model = Model { name: "two_arms".into(), ..Model::default() };
    model.links.push(link(
        "torso",
        vec![(at(0.0, 0.0, -0.3), cylinder(0.28, 0.6)), (at(0.0, 0.0, 0.35), cuboid(0.25, 0.4, 0.6))],
    ));
    model.links.push(link("head", vec![(at(0.05, 0.0, 0.1), Geometry::Sphere { radius: 0.12 })]));
    model.joints.push(joint("head_pan", JointKind::Revolute, 0, 1, at(0.05, 0.0, 0.72), DVec3::Z));
    for (side, sign) in [("left", 1.0), ("right", -1.0)] {
        let mut parent = 0;
        let turn = DQuat::from_rotation_z(sign * 0.78);
        // Joint offset from the parent, axis, and the link's shapes.
        let links: [LinkPlan; 7] = [
            (
                Pose::from_parts(DVec3::new(0.08, sign * 0.28, 0.12), turn),
                DVec3::Z,
                vec![(at(0.0, 0.0, 0.14), cylinder(0.06, 0.27)), (at(0.03, 0.0, 0.27), cuboid(0.13, 0.1, 0.1))],
            ),
            (
                at(0.069, 0.0, 0.27),
                DVec3::Y,
                vec![
                    (Pose::from_rotation(DQuat::from_rotation_x(FRAC_PI_2)), cylinder(0.06, 0.12)),
                    (at(0.1, 0.0, 0.0), cuboid(0.1, 0.1, 0.1)),
                ],
            ),
            (
                at(0.102, 0.0, 0.0),
                DVec3::X,
                vec![(
                    Pose::from_parts(DVec3::new(0.14, 0.0, 0.0), DQuat::from_rotation_y(FRAC_PI_2)),
                    cylinder(0.06, 0.27),
                )],
            ),
            (
                at(0.262, 0.0, 0.0),
                DVec3::Y,
                vec![
                    (Pose::from_rotation(DQuat::from_rotation_x(FRAC_PI_2)), cylinder(0.06, 0.1)),
                    (at(0.06, 0.0, 0.0), cuboid(0.12, 0.09, 0.09)),
                ],
            ),
            (
                at(0.104, 0.0, 0.0),
                DVec3::X,
                vec![(
                    Pose::from_parts(DVec3::new(0.13, 0.0, 0.0), DQuat::from_rotation_y(FRAC_PI_2)),
                    cylinder(0.05, 0.25),
                )],
            ),
            (
                at(0.27, 0.0, 0.0),
                DVec3::Y,
                vec![(Pose::from_rotation(DQuat::from_rotation_x(FRAC_PI_2)), cylinder(0.045, 0.1))],
            ),
            (
                at(0.116, 0.0, 0.0),
                DVec3::X,
                vec![
                    (
                        Pose::from_parts(DVec3::new(0.06, 0.0, 0.0), DQuat::from_rotation_y(FRAC_PI_2)),
                        cylinder(0.045, 0.12),
                    ),
                    (at(0.14, 0.0, 0.0), cuboid(0.05, 0.12, 0.06)),
                ],
            ),
        ];
        for (number, (pose, axis, shapes)) in links.into_iter().enumerate() {
            model.links.push(link(&format!("{side}_{number}"), shapes));
            let child = model.links.len() - 1;
            model.joints.push(joint(&format!("{side}_j{number}"), JointKind::Revolute, parent, child, pose, axis));
            parent = child;
        }
        for (finger, sign) in [("a", 1.0), ("b", -1.0)] {
            model
                .links
                .push(link(&format!("{side}_finger_{finger}"), vec![(at(0.05, 0.0, 0.0), cuboid(0.1, 0.01, 0.02))]));
            let child = model.links.len() - 1;
            let axis = DVec3::Y * sign;
            let mut finger = joint(
                &format!("{side}_finger_{finger}"),
                JointKind::Prismatic,
                parent,
                child,
                at(0.165, sign * 0.02, 0.0),
                axis,
            );
            finger.limits = (0.0, 0.02);
            model.joints.push(finger);
        }
    }
    model
}

/// The two arms before a table with two boxes on it.
pub fn bench() -> Robot {
    let (arms, table) = (two_arms(), single(vec![(Pose::IDENTITY, cuboid(0.8, 1.4, 0.05))]));
    let small = single(vec![(Pose::IDENTITY, cuboid(0.05, 0.05, 0.12))]);
    compose(&[
        (&arms, placed("robot", PartKind::Robot, RootJoint::Fixed, Pose::IDENTITY)),
        (&table, placed("table", PartKind::Environment, RootJoint::Fixed, at(0.8, 0.0, -0.2))),
        (&small, placed("box1", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY)),
        (&small, placed("box2", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY)),
    ])
}

/// A lift with a planar root, followers, an endless joint and skew axes, before a block; and a block that flies freely.
pub fn mover() -> Robot {
    let mut lift = joint("lift", JointKind::Prismatic, 0, 1, at(0.1, 0.0, 0.4), DVec3::Z);
    lift.limits = (-0.2, 0.6);
    let mut tilt = joint("tilt", JointKind::Revolute, 1, 2, at(0.1, 0.1, 0.0), DVec3::new(0.6, 0.8, 0.0));
    tilt.limits = (-2.0, 2.0);
    let mut slide = joint("slide", JointKind::Prismatic, 2, 3, at(0.2, 0.0, 0.1), DVec3::X);
    slide.mimic = Some(("lift".into(), 1.5, 0.1));
    let spin = joint("spin", JointKind::Continuous, 3, 4, at(0.1, 0.0, 0.0), DVec3::Y);
    let mut curl = joint("curl", JointKind::Revolute, 4, 5, at(0.1, 0.05, 0.0), DVec3::Z);
    curl.mimic = Some(("tilt".into(), -2.0, 0.3));
    let shapes = || vec![(at(0.1, 0.02, 0.0), cuboid(0.2, 0.05, 0.04))];
    let names = ["base", "mast", "tilt", "slide", "spin", "curl"];
    let model = Model {
        name: "lift".into(),
        links: names.iter().map(|n| link(n, shapes())).collect(),
        joints: vec![lift, tilt, slide, spin, curl],
        ..Model::default()
    };
    let block = single(vec![(at(0.3, 0.0, 0.0), cuboid(0.1, 0.3, 0.2))]);
    compose(&[
        (&model, placed("mover", PartKind::Robot, RootJoint::Planar, at(0.0, 0.3, 0.0))),
        (&block, placed("block", PartKind::Environment, RootJoint::Fixed, at(0.5, 0.0, 0.5))),
        (&block, placed("flyer", PartKind::Robot, RootJoint::FreeFlyer, Pose::IDENTITY)),
    ])
}

/// Sets a free-flyer's coordinates.
pub fn place(robot: &Robot, q: &mut [f64], part: &str, pose: Pose) {
    let joint = robot.parts[robot.part(part).expect("known part").at()].root_joint.expect("free part");
    let foliate_components::robot::Source::Coordinates { q: i, .. } = robot.joints[joint.at()].source else {
        panic!("a root has coordinates");
    };
    q[i..i + 7].copy_from_slice(&foliate_components::pose::pose_to_array(&pose));
}

/// A configuration drawn within bounds.
pub fn random_configuration(robot: &Robot, rng: &mut impl Rng) -> Vec<f64> {
    let mut q = robot.space.neutral();
    robot.space.random(rng, &mut q);
    q
}

/// Link pairs that overlap at random configurations nearly always, as an SRDF would list them.
pub fn always_colliding(robot: &Robot) -> Vec<DisabledPair> {
    let (scene, kinematics) = (CollisionScene::new(robot, &PairRule::default()), Kinematics::new(robot));
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut hits = vec![0; scene.pairs().len()];
    let mut X_WJ = vec![Pose::IDENTITY; kinematics.bodies()];
    for _ in 0..100 {
        let q = random_configuration(robot, &mut rng);
        kinematics.forward(&q, &mut X_WJ);
        for (index, hit) in hits.iter_mut().enumerate() {
            let id = PairId(index as u32);
            let ask = DistanceQuery::exact(1e-3);
            let mut hint = DVec3::ZERO;
            *hit += i32::from(pair_clearance(&scene, id, &X_WJ, ask, &mut hint) < 1e-3);
        }
    }
    let link = |shape: ShapeIndex| scene.solids()[shape.at()].link;
    let often = scene.pairs().iter().zip(hits).filter(|&(_, hits)| hits > 50);
    let disabled = |first, second| DisabledPair { first, second, reason: "always".into() };
    often.map(|(pair, _)| disabled(link(pair.first), link(pair.second))).collect()
}
