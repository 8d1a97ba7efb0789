//! Reads a page's document as a viewer does, with arithmetic of its own: no code is shared with what writes it.
#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a test that cannot go on says so")]
#![allow(dead_code, reason = "each test uses its part")]

use foliate::view::Page;
use serde_json::Value;

/// A rotation by rows, and a translation.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    pub rows: [[f64; 3]; 3],
    pub at: [f64; 3],
}

impl Placement {
    pub const WORLD: Self = Self { rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], at: [0.0; 3] };

    fn then(&self, other: &Self) -> Self {
        let at = self.point(other.at);
        let rows =
            std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| self.rows[i][k] * other.rows[k][j]).sum()));
        Self { rows, at }
    }

    fn point(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| self.at[i] + (0..3).map(|k| self.rows[i][k] * p[k]).sum::<f64>())
    }

    /// Of x y z qx qy qz qw.
    fn of_numbers(p: &[f64]) -> Self {
        let (x, y, z, w) = (p[3], p[4], p[5], p[6]);
        let rows = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
        Self { rows, at: [p[0], p[1], p[2]] }
    }

    /// A turn about a unit axis, by Rodrigues' formula.
    fn turn(axis: [f64; 3], angle: f64) -> Self {
        let [x, y, z] = axis;
        let (s, c) = angle.sin_cos();
        let k = 1.0 - c;
        let rows = [
            [c + x * x * k, x * y * k - z * s, x * z * k + y * s],
            [y * x * k + z * s, c + y * y * k, y * z * k - x * s],
            [z * x * k - y * s, z * y * k + x * s, c + z * z * k],
        ];
        Self { rows, at: [0.0; 3] }
    }
}

/// The numbers of an array of JSON.
pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("an array").iter().map(|x| x.as_f64().expect("a number")).collect()
}

fn placement(value: &Value) -> Placement {
    Placement::of_numbers(&numbers(value))
}

/// Where the links of a document are at a configuration.
pub fn links(document: &Value, q: &[f64]) -> Vec<Placement> {
    let joints = document["joints"].as_array().unwrap();
    let mut bodies: Vec<Placement> = Vec::with_capacity(joints.len());
    for joint in joints {
        let parent = joint["parent"].as_u64().map_or(Placement::WORLD, |parent| bodies[parent as usize]);
        let zero = parent.then(&placement(&joint["parent_from_joint"]));
        let axis = || {
            let axis = numbers(&joint["axis"]);
            [axis[0], axis[1], axis[2]]
        };
        let value = || match joint["q"].as_u64() {
            Some(q_index) => q[q_index as usize],
            None => {
                let leader = &joints[joint["leader"].as_u64().unwrap() as usize];
                let number = q[leader["q"].as_u64().unwrap() as usize];
                joint["multiplier"].as_f64().unwrap() * number + joint["offset"].as_f64().unwrap()
            }
        };
        let motion = match joint["type"].as_str().unwrap() {
            "revolute" => Placement::turn(axis(), value()),
            "prismatic" => Placement { at: axis().map(|x| x * value()), ..Placement::WORLD },
            "planar" => {
                let first = joint["q"].as_u64().unwrap() as usize;
                let turn = Placement::turn([0.0, 0.0, 1.0], q[first + 2]);
                Placement { at: [q[first], q[first + 1], 0.0], ..turn }
            }
            "freeflyer" => {
                let first = joint["q"].as_u64().unwrap() as usize;
                Placement::of_numbers(&q[first..first + 7])
            }
            other => panic!("{other} is no joint"),
        };
        bodies.push(zero.then(&motion));
    }
    let links = document["links"].as_array().unwrap().iter();
    links
        .map(|link| {
            let body = link["joint"].as_u64().map_or(Placement::WORLD, |joint| bodies[joint as usize]);
            body.then(&placement(&link["joint_from_link"]))
        })
        .collect()
}

/// 32-bit floating-point numbers of a page's blob.
pub fn floats(page: &Page, offset: &Value, count: usize) -> Vec<f64> {
    let start = offset.as_u64().expect("an offset") as usize;
    assert!(start.is_multiple_of(4));
    let bytes = &page.blob.bytes()[start..start + 4 * count];
    bytes.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))).collect()
}

/// 16-bit numbers of a page's blob.
pub fn shorts(page: &Page, offset: &Value, count: usize) -> Vec<u16> {
    let start = offset.as_u64().expect("an offset") as usize;
    let bytes = &page.blob.bytes()[start..start + 2 * count];
    bytes.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect()
}

/// A page's document as JSON.
pub fn document(page: &Page) -> Value {
    serde_json::to_value(&page.document).expect("it is JSON")
}
