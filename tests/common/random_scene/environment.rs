//! What never moves: walls, posts, doors that stand open, meshes with an axis of their own.

use super::draw::Draw;
use super::model::{Model, Motion, Place};
use super::shapes::{cuboid, within};
use foliate::components::Pose;
use foliate::components::pose::pose_to_array;
use glam::DVec3;

/// An environment and what the scene says of it.
#[derive(Clone, Debug)]
pub struct Obstacle {
    pub model: Model,
    pub pose: [f64; 7],
    /// Where its joints stand.
    pub values: Vec<(String, f64)>,
    pub declared: bool,
}

impl Obstacle {
    /// One of any kind near a point.
    pub fn near(draw: &mut Draw, name: &str, centre: DVec3, spread: f64) -> Self {
        let mut model = Model { capsules: draw.chance(0.1), ..Model::new(name) };
        let root = model.link("stand");
        let mut values = Vec::new();
        match draw.index(4) {
            0 => door(draw, &mut model, root, &mut values),
            1 => {
                for number in 0..1 + draw.index(3) {
                    let sides = [draw.range(0.02, 0.15), draw.range(0.02, 0.15), draw.range(0.02, 0.2)];
                    let geometry = within(draw, &mut model, sides);
                    let place = Place { xyz: [0.2 * number as f64, 0.0, 0.0], rpy: [0.0, draw.range(-0.5, 0.5), 0.0] };
                    model.shape(root, place, &geometry);
                }
            }
            2 => model.shape(root, Place::default(), &cuboid([0.002, 0.002, draw.range(0.1, 0.5)])),
            _ => {
                let sides = [draw.range(0.05, 0.2), draw.range(0.02, 0.1), draw.range(0.05, 0.4)];
                let geometry = within(draw, &mut model, sides);
                model.shape(root, Place::default(), &geometry);
            }
        }
        let mut offset = || spread * (2.0 * draw.unit() - 1.0);
        let place = centre + DVec3::new(offset(), offset(), offset());
        let rpy = [draw.range(-0.4, 0.4), draw.range(-0.4, 0.4), draw.range(-3.0, 3.0)];
        let pose = Pose::from_translation(place) * Place { xyz: [0.0; 3], rpy }.pose();
        Self { model, pose: pose_to_array(&pose), values, declared: draw.chance(0.4) }
    }

    /// The scene's table of this part.
    pub fn toml(&self) -> String {
        let name = &self.model.name;
        let mut text = format!("[[part]]\nname = \"{name}\"\nkind = \"environment\"\nurdf = \"{name}.urdf\"\n");
        text += &format!("pose = {:?}\n", self.pose);
        if self.model.srdf.is_some() {
            text += &format!("srdf = \"{name}.srdf\"\n");
        }
        if !self.values.is_empty() {
            let values: Vec<String> = self.values.iter().map(|(joint, value)| format!("{joint} = {value:?}")).collect();
            text += &format!("values = {{ {} }}\n", values.join(", "));
        }
        if self.declared {
            text += "mesh_up_axis = \"declared\"\n";
        }
        text
    }
}

/// A leaf on a hinge, and perhaps a latch that slides in it or follows it.
fn door(draw: &mut Draw, model: &mut Model, root: usize, values: &mut Vec<(String, f64)>) {
    model.shape(root, Place::default(), &cuboid([0.03, 0.03, 0.4]));
    let leaf = model.joint("hinge", Motion::Revolute, root, Place::at(0.02, 0.0, 0.0), [0.0, 0.0, 1.0]);
    model.last_joint().limits = (-2.0, 2.0);
    let width = draw.range(0.1, 0.3);
    let geometry = within(draw, model, [width, 0.02, 0.3]);
    model.shape(leaf, Place::at(width / 2.0 + 0.02, 0.0, 0.0), &geometry);
    values.push(("hinge".into(), draw.range(-1.8, 1.8)));
    if draw.chance(0.5) {
        let latch = model.joint("latch", Motion::Prismatic, leaf, Place::at(width, 0.0, 0.0), [1.0, 0.0, 0.0]);
        model.last_joint().limits = (0.0, 0.3);
        model.shape(latch, Place::at(0.04, 0.0, 0.1), &cuboid([0.1, 0.03, 0.03]));
        if draw.chance(0.5) {
            model.last_joint().mimic = Some(("hinge".into(), 0.05, 0.1));
        } else {
            values.push(("latch".into(), draw.range(0.0, 0.3)));
        }
    }
}
