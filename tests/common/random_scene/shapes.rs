//! Geometry of every kind: primitives, and meshes in every format, closed, open, or with a triangle twice.

use super::draw::{Draw, rounded};
use super::model::Model;
use std::fmt::Write;

/// A box with these sides.
pub fn cuboid([x, y, z]: [f64; 3]) -> String {
    format!("<box size=\"{x} {y} {z}\"/>")
}

/// A shape that fits into a box with these sides, of any kind that the model may have; meshes become files of it.
pub fn within(draw: &mut Draw, model: &mut Model, sides: [f64; 3]) -> String {
    let [x, y, z] = sides;
    let smallest = x.min(y).min(z);
    match draw.index(8) {
        0 | 1 => cuboid(sides),
        2 => format!("<sphere radius=\"{}\"/>", rounded(smallest / 2.0)),
        3 | 4 => format!("<cylinder radius=\"{}\" length=\"{z}\"/>", rounded(x.min(y) / 2.0)),
        5 if model.capsules => {
            let radius = rounded(x.min(y).min(z * 0.8) / 2.0);
            format!("<capsule radius=\"{radius}\" length=\"{}\"/>", rounded((z - 2.0 * radius).max(0.01)))
        }
        _ => mesh(draw, model, sides),
    }
}

/// Vertices and triangles.
type Mesh = (Vec<[f64; 3]>, Vec<[usize; 3]>);

/// A mesh within a box: a prism over a regular polygon, whose top may be smaller than its base.
fn prism(draw: &mut Draw, [x, y, z]: [f64; 3]) -> Mesh {
    let (corners, top) = (3 + draw.index(6), draw.range(0.4, 1.0));
    let mut vertices = Vec::new();
    for (height, share) in [(-0.5, 1.0), (0.5, top)] {
        for corner in 0..corners {
            let angle = std::f64::consts::TAU * corner as f64 / corners as f64;
            vertices.push([x / 2.0 * share * angle.cos(), y / 2.0 * share * angle.sin(), z * height].map(rounded));
        }
    }
    let mut triangles = Vec::new();
    for corner in 0..corners {
        let next = (corner + 1) % corners;
        triangles.push([corner, next, corners + next]);
        triangles.push([corner, corners + next, corners + corner]);
    }
    for corner in 1..corners - 1 {
        triangles.push([0, corner + 1, corner]);
        triangles.push([corners, corners + corner, corners + corner + 1]);
    }
    (vertices, triangles)
}

fn mesh(draw: &mut Draw, model: &mut Model, sides: [f64; 3]) -> String {
    let (vertices, mut triangles) = prism(draw, sides);
    match draw.index(6) {
        0 => {
            let lost = draw.index(triangles.len());
            triangles.remove(lost);
        }
        1 => {
            let twice = draw.index(triangles.len());
            triangles.push(triangles[twice]);
        }
        _ => {}
    }
    let (ending, bytes) = match draw.index(4) {
        0 => ("stl", stl_text(&vertices, &triangles).into_bytes()),
        1 => ("stl", stl_bytes(&vertices, &triangles)),
        2 => ("obj", obj(&vertices, &triangles).into_bytes()),
        _ => {
            let axis = draw.of(&["X_UP", "Y_UP", "Z_UP"]);
            ("dae", dae(&vertices, &triangles, axis).into_bytes())
        }
    };
    let name = format!("{}_{}.{ending}", model.name, model.meshes.len());
    model.meshes.push((name.clone(), bytes));
    let scale = draw.of(&["", "", "", " scale=\"0.9 1.1 0.8\"", " scale=\"1 -1 1\""]);
    format!("<mesh filename=\"{name}\"{scale}/>")
}

fn stl_text(vertices: &[[f64; 3]], triangles: &[[usize; 3]]) -> String {
    let mut text = String::from("solid part\n");
    for corners in triangles {
        text.push_str("facet normal 0 0 0\nouter loop\n");
        for [x, y, z] in corners.map(|c| vertices[c]) {
            let _infallible = writeln!(text, "vertex {x} {y} {z}");
        }
        text.push_str("endloop\nendfacet\n");
    }
    text + "endsolid part\n"
}

fn stl_bytes(vertices: &[[f64; 3]], triangles: &[[usize; 3]]) -> Vec<u8> {
    let mut bytes = vec![0_u8; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for corners in triangles {
        let numbers = [[0.0; 3]].into_iter().chain(corners.map(|c| vertices[c])).flatten();
        bytes.extend(numbers.flat_map(|x| (x as f32).to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

fn obj(vertices: &[[f64; 3]], triangles: &[[usize; 3]]) -> String {
    let vertices = vertices.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let triangles = triangles.iter().map(|t| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1));
    vertices.chain(triangles).collect()
}

fn dae(vertices: &[[f64; 3]], triangles: &[[usize; 3]], up_axis: &str) -> String {
    let numbers: Vec<String> = vertices.iter().flatten().map(f64::to_string).collect();
    let corners: Vec<String> = triangles.iter().flatten().map(usize::to_string).collect();
    format!(
        "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset>\
         <unit meter=\"1\"/><up_axis>{up_axis}</up_axis></asset><library_geometries><geometry id=\"g\"><mesh>\
         <source id=\"p\"><float_array id=\"pa\" count=\"{}\">{}</float_array><technique_common>\
         <accessor source=\"#pa\" count=\"{}\" stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/>\
         <param name=\"Z\" type=\"float\"/></accessor></technique_common></source><vertices id=\"v\">\
         <input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"{}\">\
         <input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>{}</p></triangles></mesh></geometry></library_geometries>\
         <library_visual_scenes><visual_scene id=\"s\"><node><instance_geometry url=\"#g\"/></node></visual_scene>\
         </library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>",
        numbers.len(),
        numbers.join(" "),
        vertices.len(),
        triangles.len(),
        corners.join(" ")
    )
}
