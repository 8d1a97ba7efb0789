//! Changes of a scene's text: which objects are in it, where parts stand, how large they are, and further obstacles.

use crate::batch::vary::options::{MovedPart, Obstacles, SizedPart, Span, Vary};
use crate::batch::vary::removal::remove;
use foliate_components::Pose;
use foliate_components::pose::pose_to_array;
use foliate_components::robot::{PartKind, Robot, RootJoint};
use glam::{DQuat, DVec3};
use rand::RngExt;
use toml::{Table, Value};

/// Names of the obstacles that are added begin with this.
const OBSTACLE: &str = "vary_obstacle_";

/// The movable objects of a scene, by name.
pub(crate) fn movable(robot: &Robot) -> Vec<&str> {
    let is_movable =
        |part: &&foliate_components::robot::Part| part.kind == PartKind::Object && part.root == RootJoint::FreeFlyer;
    robot.parts.iter().filter(is_movable).map(|part| part.name.as_str()).collect()
}

/// A scene with what is drawn of it. `robot` is that of the scene as it is.
pub(crate) fn changed(scene: &Table, robot: &Robot, vary: &Vary, rng: &mut impl RngExt) -> Table {
    let mut scene = scene.clone();
    if let Some((fewest, most)) = vary.objects {
        let mut objects = movable(robot);
        let stay = rng.random_range(fewest..=most);
        while objects.len() > stay {
            let gone = objects.swap_remove(rng.random_range(0..objects.len()));
            remove(&mut scene, gone);
        }
    }
    for moved in &vary.moves {
        shift(&mut scene, robot, moved, rng);
    }
    for size in &vary.sizes {
        scale(&mut scene, size, rng);
    }
    if let Some(obstacles) = &vary.obstacles {
        add(&mut scene, obstacles, rng);
    }
    scene
}

/// The table of a part.
pub(crate) fn part_of<'s>(scene: &'s mut Table, name: &str) -> Option<&'s mut Table> {
    let parts = scene.get_mut("part")?.as_array_mut()?;
    let mut tables = parts.iter_mut().filter_map(Value::as_table_mut);
    tables.find(|part| part.get("name").and_then(Value::as_str) == Some(name))
}

fn draw((low, high): Span, rng: &mut impl RngExt) -> f64 {
    // One number is drawn in any case, so that what comes after does not depend on it.
    low + rng.random::<f64>() * (high - low)
}

fn draw_all(spans: &[Span; 3], rng: &mut impl RngExt) -> DVec3 {
    DVec3::from_array(spans.map(|span| draw(span, rng)))
}

fn shift(scene: &mut Table, robot: &Robot, moved: &MovedPart, rng: &mut impl RngExt) {
    let (by, turn) = (draw_all(&moved.shift, rng), draw(moved.turn, rng));
    let now = robot.parts.iter().find(|part| part.name == moved.part).map(|part| part.world_from_root);
    // A part that is no longer there does not move.
    if let Some((part, now)) = part_of(scene, &moved.part).zip(now) {
        let rotation = (DQuat::from_rotation_z(turn) * now.rotation).normalize();
        part.insert("pose".into(), pose_value(&Pose::from_parts(now.translation + by, rotation)));
    }
}

fn pose_value(pose: &Pose) -> Value {
    Value::Array(pose_to_array(pose).into_iter().map(Value::Float).collect())
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|number| number as f64))
}

/// The key of a shape that says its size; of a mesh that which scales it.
pub(crate) fn size_key(shape: &Table) -> Option<&'static str> {
    ["box", "cylinder", "sphere", "mesh"].into_iter().find(|key| shape.contains_key(*key))
}

fn scale(scene: &mut Table, size: &SizedPart, rng: &mut impl RngExt) {
    let factors = [(); 3].map(|()| draw(size.factor, rng));
    let shape = part_of(scene, &size.part).and_then(|part| part.get_mut("shape")?.as_table_mut());
    let Some((shape, key)) = shape.and_then(|shape| Some((size_key(shape)?, shape))).map(|(key, shape)| (shape, key))
    else {
        return;
    };
    if key == "mesh" {
        let scale = shape.entry("scale").or_insert(Value::Float(1.0));
        multiply(scale, &[factors[0]; 3]);
    } else if let Some(sizes) = shape.get_mut(key) {
        multiply(sizes, &factors);
    }
}

fn multiply(sizes: &mut Value, factors: &[f64; 3]) {
    match sizes {
        Value::Array(items) => items.iter_mut().zip(factors).for_each(|(item, factor)| multiply(item, &[*factor; 3])),
        single => {
            if let Some(size) = number(single) {
                *single = Value::Float(size * factors[0]);
            }
        }
    }
}

fn add(scene: &mut Table, obstacles: &Obstacles, rng: &mut impl RngExt) {
    let count = rng.random_range(obstacles.count.0..=obstacles.count.1);
    let Some(parts) = scene.get_mut("part").and_then(Value::as_array_mut) else { return };
    for index in 1..=count {
        let (sides, middle) = (draw_all(&obstacles.sides, rng), draw_all(&obstacles.middle, rng));
        let pose = Pose::from_parts(middle, DQuat::from_rotation_z(draw(obstacles.turn, rng)));
        let sides = sides.to_array().map(Value::Float).to_vec();
        let shape = Table::from_iter([("box".to_owned(), Value::Array(sides))]);
        let part = Table::from_iter([
            ("name".to_owned(), Value::String(format!("{OBSTACLE}{index}"))),
            ("kind".to_owned(), Value::String("environment".into())),
            ("shape".to_owned(), Value::Table(shape)),
            ("pose".to_owned(), pose_value(&pose)),
        ]);
        parts.push(Value::Table(part));
    }
}

#[cfg(test)]
mod tests {
    use super::changed;
    use crate::batch::vary::options::{MovedPart, Obstacles, SizedPart, Vary};
    use crate::scene::{PackagePath, Scene};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use std::path::Path;
    use toml::{Table, Value};

    const TEXT: &str = r#"
        format = "foliate.scene/1"
        name = "small"
        [[part]]
        name = "arm"
        kind = "robot"
        urdf = "demo/robot.urdf"
        [[part]]
        name = "block"
        kind = "environment"
        shape = { box = [0.1, 0.2, 1] }
        pose = { xyz = [1.0, 0.0, 0.5], rpy = [0.0, 0.0, 0.5] }
        [[part]]
        name = "a"
        kind = "object"
        shape = { sphere = 0.05 }
        root_bounds = [[0, 1], [0, 1], [0, 1]]
        [[part]]
        name = "b"
        kind = "object"
        shape = { cylinder = [0.05, 0.1] }
        root_bounds = [[0, 1], [0, 1], [0, 1]]
        [start]
        a = { xyz = [0.2, 0.2, 0.2] }
        b = { xyz = [0.8, 0.2, 0.2] }
        [[goal]]
        configuration = { a = { xyz = [0.2, 0.9, 0.2] }, b = { xyz = [0.8, 0.9, 0.2] } }
    "#;

    fn load(text: &str) -> Scene {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        Scene::from_text("small", text, &scenes, &PackagePath::default()).unwrap()
    }

    #[test]
    fn what_is_drawn_lies_within_its_spans_and_reads_back() {
        let (scene, base) = (TEXT.parse::<Table>().unwrap(), load(TEXT));
        let vary = Vary {
            objects: Some((1, 2)),
            moves: vec![MovedPart {
                part: "block".into(),
                shift: [(0.1, 0.2), (0.0, 0.0), (0.0, 0.0)],
                turn: (0.1, 0.2),
            }],
            sizes: vec![
                SizedPart { part: "block".into(), factor: (1.5, 2.0) },
                SizedPart { part: "b".into(), factor: (0.5, 0.6) },
            ],
            obstacles: Some(Obstacles {
                count: (0, 3),
                sides: [(0.1, 0.2); 3],
                middle: [(2.0, 3.0); 3],
                turn: (0.0, 1.0),
            }),
            ..Vary::new(1, 1)
        };
        let mut counts = [[0; 4]; 2];
        for seed in 0..40 {
            let drawn = changed(&scene, &base.problem.robot, &vary, &mut ChaCha8Rng::seed_from_u64(seed));
            let read = load(&drawn.to_string());
            let robot = &read.problem.robot;
            let objects = super::movable(robot).len();
            let added = robot.parts.iter().filter(|part| part.name.starts_with(super::OBSTACLE)).count();
            counts[objects - 1][added] += 1;
            let block = robot.parts.iter().find(|part| part.name == "block").unwrap().world_from_root;
            assert!((1.1..=1.2).contains(&block.translation.x) && block.translation.y == 0.0);
            let turn = block.rotation.to_euler(glam::EulerRot::ZYX).0;
            assert!((0.6..=0.7).contains(&turn), "{turn}");
            let sides = drawn["part"][1]["shape"]["box"].as_array().unwrap();
            let sides: Vec<f64> = sides.iter().map(|side| side.as_float().unwrap()).collect();
            let factors: Vec<f64> = sides.iter().zip([0.1, 0.2, 1.0]).map(|(side, was)| side / was).collect();
            assert!(factors.iter().all(|factor| (1.5..=2.0).contains(factor)) && factors[0] != factors[1]);
        }
        assert!(counts.iter().flatten().all(|count| *count > 0), "{counts:?}");
        let Value::Array(parts) = &scene["part"] else { panic!("the scene itself has not changed") };
        assert_eq!(parts.len(), 4);
    }
}
