//! Promise: meshes and manipulation frames mean what their formats say: units, node transforms and instances of COLLADA,
//! both forms of STL, OBJ's polygons, mirrored scales; SRDF positions by text and by attributes.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

use foliate::components::Pose;
use foliate::components::robot::model::Model;
use foliate::components::robot::shape::{Geometry, Mesh};
use foliate::scene::{PackagePath, ReadModel, Scene, UpAxis, read_model};
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;
use std::path::PathBuf;
use std::sync::Arc;

/// A directory with files, removed at the end.
struct Files(PathBuf);

impl Files {
    fn new(name: &str, files: &[(&str, &[u8])]) -> Self {
        let directory = std::env::temp_dir().join(format!("foliate-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&directory).expect("a directory");
        for (file, content) in files {
            std::fs::write(directory.join(file), content).expect("a file");
        }
        Self(directory)
    }

    fn read(&self, urdf: &str, srdf: Option<&str>) -> ReadModel {
        let path = |name: &str| self.0.join(name).to_string_lossy().into_owned();
        let srdf = srdf.map(path);
        read_model(&path(urdf), srdf.as_deref(), UpAxis::AsWritten, &PackagePath::default())
            .unwrap_or_else(|e| panic!("{e}"))
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn urdf_with(mesh: &str) -> String {
    format!("<robot name=\"m\"><link name=\"a\"><collision><geometry>{mesh}</geometry></collision></link></robot>")
}

/// The mesh that a file holds, by way of a URDF.
fn mesh(name: &str, content: &[u8], attributes: &str) -> Arc<Mesh> {
    let urdf = urdf_with(&format!("<mesh filename=\"{name}\" {attributes}/>"));
    let files =
        Files::new(&format!("mesh-{name}-{}", attributes.len()), &[(name, content), ("m.urdf", urdf.as_bytes())]);
    match &files.read("m.urdf", None).model.links[0].shapes[0].1 {
        Geometry::Mesh(mesh) => mesh.clone(),
        other => panic!("{other:?}"),
    }
}

fn bounds(mesh: &Mesh) -> (DVec3, DVec3) {
    let low = mesh.vertices.iter().copied().reduce(DVec3::min).expect("vertices");
    (low, mesh.vertices.iter().copied().reduce(DVec3::max).expect("vertices"))
}

fn assert_bounds(mesh: &Mesh, low: [f64; 3], high: [f64; 3]) {
    let (l, h) = bounds(mesh);
    let far = l.distance(low.into()).max(h.distance(high.into()));
    assert!(far < 1e-12, "{l} {h}");
}

/// Six times the volume that closed triangles bound; positive where they are counter-clockwise from outside.
fn volume(mesh: &Mesh) -> f64 {
    let at = |i: u32| mesh.vertices[i as usize];
    mesh.triangles.iter().map(|&[a, b, c]| at(a).dot(at(b).cross(at(c)))).sum()
}

/// A tetrahedron with corners at 0, x = 1, y = 2, z = 3.
const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn obj() -> Vec<u8> {
    let mut text = String::from("# a tetrahedron\no t\n");
    CORNERS.iter().for_each(|c| text += &format!("v {} {} {}\n", c[0], c[1], c[2]));
    text += "vn 0 0 1\nf 1//1 3//1 2//1\nf 1 2 4\nf -4 -1 -2\nf 2/1 3/1 4/1\n";
    text.into_bytes()
}

#[test]
fn both_forms_of_stl_and_obj_read_alike() {
    let mut binary = b"solid in name only, this is binary".to_vec();
    binary.resize(80, b' ');
    binary.extend(4_u32.to_le_bytes());
    let mut text = String::from("solid t\n");
    for face in FACES {
        binary.extend([0; 12]);
        text += "facet normal 0 0 0\nouter loop\n";
        for corner in face.map(|i| CORNERS[i]) {
            corner.iter().for_each(|x| binary.extend(x.to_le_bytes()));
            text += &format!("vertex {:e} {} {}\n", corner[0], corner[1], corner[2]);
        }
        binary.extend([0; 2]);
        text += "endloop\nendfacet\n";
    }
    text += "endsolid t\n";
    for (name, content) in [("b.STL", binary), ("t.stl", text.into_bytes()), ("o.obj", obj())] {
        let mesh = mesh(name, &content, "");
        assert!(mesh.closed && mesh.triangles.len() == 4 && mesh.vertices.len() == 4, "{name}");
        assert_bounds(&mesh, [0.0; 3], [1.0, 2.0, 3.0]);
        assert!((volume(&mesh) - 6.0).abs() < 1e-12, "{name}: {}", volume(&mesh));
    }
}

#[test]
fn a_scale_that_mirrors_keeps_the_outside_out() {
    let mesh = mesh("o.obj", &obj(), "scale=\"2 -1 1\"");
    assert_bounds(&mesh, [0.0, -2.0, 0.0], [2.0, 0.0, 3.0]);
    assert!((volume(&mesh) - 12.0).abs() < 1e-12);
}

fn dae(up_axis: &str) -> String {
    format!(
        "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\"><asset><unit meter=\"0.01\"/>\
         <up_axis>{up_axis}</up_axis></asset><library_geometries><geometry id=\"g\"><mesh>\
         <source id=\"p\"><float_array id=\"pa\" count=\"15\">0 0 0  1 0 0  0 2 0  0 0 3  99 99 99</float_array>\
         <technique_common><accessor source=\"#pa\" count=\"5\" stride=\"3\"/></technique_common></source>\
         <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\
         <triangles count=\"3\"><input semantic=\"NORMAL\" source=\"#p\" offset=\"1\"/>\
         <input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 0 2 0 1 0  0 0 1 0 3 0  0 0 3 0 2 0</p></triangles>\
         <polylist count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><vcount>3</vcount><p>1 2 3</p></polylist>\
         </mesh></geometry></library_geometries>\
         <library_nodes><node id=\"shared\"><scale>1 1 2</scale><instance_geometry url=\"#g\"/></node></library_nodes>\
         <library_visual_scenes><visual_scene id=\"s\">\
         <node><translate>10 0 0</translate><rotate>0 0 1 90</rotate><instance_node url=\"#shared\"/></node>\
         <node><matrix>1 0 0 -5  0 1 0 0  0 0 1 0  0 0 0 1</matrix><node><instance_geometry url=\"#g\"/></node></node>\
         </visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>"
    )
}

#[test]
fn collada_units_transforms_and_instances_are_honoured() {
    let mesh = mesh("d.dae", dae("Z_UP").as_bytes(), "");
    assert_eq!((mesh.triangles.len(), mesh.vertices.len(), mesh.closed), (8, 8, true));
    // The first is scaled by 2 along z, turned by 90° about z (x to y, y to −x), moved by 10; all in centimetres.
    assert_bounds(&mesh, [-0.05, 0.0, 0.0], [0.10, 0.02, 0.06]);
    assert!((volume(&mesh) - (6.0 + 12.0) * 1e-6).abs() < 1e-15);
}

#[test]
fn the_declared_up_axis_turns_a_mesh_only_where_the_scene_asks_for_it() {
    let urdf = urdf_with("<mesh filename=\"d.dae\"/>");
    let dae = dae("Y_UP");
    let files = Files::new("up", &[("d.dae", dae.as_bytes()), ("m.urdf", urdf.as_bytes())]);
    let scene = |axis: &str| {
        let text = format!(
            "format = \"foliate.scene/1\"\nname = \"s\"\n[[part]]\nname = \"m\"\nkind = \"environment\"\nurdf = \"m.urdf\"\n\
             mesh_up_axis = \"{axis}\"\n[start]\n[[goal]]\nconfiguration = {{}}\n"
        );
        let scene = Scene::from_text("s", &text, &files.0, &PackagePath::default()).unwrap_or_else(|e| panic!("{e}"));
        match &scene.problem.robot.shapes[0].geometry {
            Geometry::Mesh(mesh) => mesh.clone(),
            other => panic!("{other:?}"),
        }
    };
    assert_bounds(&scene("as-written"), [-0.05, 0.0, 0.0], [0.10, 0.02, 0.06]);
    assert_bounds(&scene("declared"), [-0.05, -0.06, 0.0], [0.10, 0.0, 0.02]);
}

#[test]
fn the_program_turns_meshes_of_a_urdf_where_it_is_asked_to() {
    let urdf = urdf_with("<mesh filename=\"d.dae\"/>");
    let dae = dae("Y_UP");
    let files = Files::new("up-program", &[("d.dae", dae.as_bytes()), ("m.urdf", urdf.as_bytes())]);
    let run = |arguments: &[&str]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_foliate"));
        let done = command.args(arguments).current_dir(&files.0).output().unwrap();
        (done.status.code(), String::from_utf8_lossy(&done.stderr).into_owned())
    };
    let page = |name: &str, options: &[&str]| {
        let arguments = [&["view", "m.urdf", "-o", name], options].concat();
        assert_eq!(run(&arguments).0, Some(0), "{arguments:?}");
        std::fs::read(files.0.join(name)).unwrap()
    };
    let usual = page("usual.html", &[]);
    assert!(usual == page("written.html", &["--mesh-up-axis", "as-written"]));
    assert!(usual != page("declared.html", &["--mesh-up-axis", "declared"]));
    assert_eq!(run(&["inspect", "m.urdf", "--mesh-up-axis", "declared"]).0, Some(0));
    let (code, told) = run(&["inspect", "m.urdf", "--mesh-up-axis", "sideways"]);
    assert!(code == Some(2) && told.contains("it is `as-written` or `declared`"), "{told}");
    let (code, told) = run(&["view", "demo", "--mesh-up-axis", "declared", "-o", "none.html"]);
    assert!(code == Some(2) && told.contains("with `mesh_up_axis`"), "{told}");
}

fn model_with(srdf: &str) -> Model {
    let urdf = "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"continuous\">\
                <parent link=\"a\"/><child link=\"b\"/></joint></robot>";
    let name = format!("srdf-{}", srdf.len());
    let files = Files::new(&name, &[("r.urdf", urdf.as_bytes()), ("r.srdf", srdf.as_bytes())]);
    files.read("r.urdf", Some("r.srdf")).model
}

#[test]
fn positions_by_text_and_by_attributes_name_the_same_frame() {
    let half = 0.5_f64.sqrt();
    let forms = [
        format!("<position> 1 2 3  {half} 0 {half} 0 </position>"),
        format!("<position>1 2 <!-- w first --> 3 {half} 0 {half} 0</position>"),
        format!("<position xyz=\"1 2 3\" wxyz=\"{half} 0 {half} 0\"/>"),
        format!("<position xyz=\"1 2 3\" xyzw=\"0 {half} 0 {half}\"/>"),
        format!("<position xyz=\"1 2 3\" rpy=\"0 {FRAC_PI_2} 0\"/>"),
        format!("<local_position>1 2 3 {half} 0 {half} 0</local_position>"),
    ];
    let wanted = Pose::from_parts(DVec3::new(1.0, 2.0, 3.0), DQuat::from_rotation_y(FRAC_PI_2));
    for form in forms {
        let tail = "<link name=\"b\"/>";
        let model = model_with(&format!(
            "<robot name=\"r\"><gripper name=\"g\" clearance=\"0.1\">{form}{tail}</gripper>\
             <handle name=\"h\" clearance=\"0.2\">{form}{tail}<mask>1 1 true 1 false 1</mask></handle></robot>"
        ));
        for pose in [model.grippers[0].link_from_gripper, model.handles[0].link_from_handle] {
            assert!(pose.translation.distance(wanted.translation) < 1e-12, "{form}");
            assert!(pose.rotation.dot(wanted.rotation).abs() > 1.0 - 1e-12, "{form}");
        }
        assert_eq!(model.handles[0].mask, [true, true, true, true, false, true]);
        assert_eq!(model.handles[0].mask_complement, [false, false, false, false, true, false]);
        assert_eq!(model.handles[0].approaching_direction, DVec3::X);
    }
}

#[test]
fn shapes_old_triangles_and_prefixed_configurations_are_read() {
    let model = model_with(
        "<robot name=\"r\"><contact name=\"c\"><link name=\"b\"/><point>0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1</point>\
         <shape>4 0 1 2 3 3 4 5 6</shape></contact>\
         <contact name=\"t\"><link name=\"b\"/><point>0 0 0 1 0 0 1 1 0</point><triangle>0 1 2</triangle></contact>\
         <group_state name=\"s\" group=\"g\"><joint name=\"r/j\" value=\"0.5\"/><joint name=\"root_joint\" value=\"0 0 0 0 0 0 1\"/>\
         </group_state><disable_collisions link1=\"a\" link2=\"b\" reason=\"Never\"/></robot>",
    );
    assert_eq!(model.surfaces[0].polygons, [vec![0, 1, 2, 3], vec![4, 5, 6]]);
    assert_eq!(model.surfaces[1].polygons, [vec![0, 1, 2]]);
    assert_eq!(model.group_states[0].values, [("j".to_owned(), 0.5)]);
    assert_eq!(model.disabled_pairs, [("a".to_owned(), "b".to_owned(), "Never".to_owned())]);
}

#[test]
fn open_meshes_of_a_file_are_remarked_upon_once() {
    let flat = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for (count, expected) in [(1, "is not closed (only"), (2, "nor is 1 other"), (7, "nor are 6 others of this file")] {
        let collision = "<collision><geometry><mesh filename=\"flat.obj\"/></geometry></collision>";
        let urdf = format!("<robot name=\"m\">\n<link name=\"a\">{}</link></robot>", collision.repeat(count));
        let files = Files::new(&format!("open-{count}"), &[("flat.obj", flat), ("m.urdf", urdf.as_bytes())]);
        let warnings = files.read("m.urdf", None).warnings;
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        let text = warnings[0].to_string();
        assert!(text.contains("m.urdf:2") && text.contains("flat.obj") && text.contains(expected), "{text}");
    }
}
