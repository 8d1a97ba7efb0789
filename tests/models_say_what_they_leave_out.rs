//! Nothing that a model says is passed over in silence: what is not solid, not read, or read twice is told; and what only looks
//! damaged is read.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate::components::robot::shape::{Geometry, Mesh};
use foliate::components::robot::{PartKind, PartPlacement, Robot, RootJoint};
use foliate::scene::{PackagePath, ReadModel, Scene, SceneError, UpAxis, read_model};
use glam::{DQuat, DVec3};
use std::path::PathBuf;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("foliate-says-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, content).unwrap();
        path.to_str().unwrap().to_owned()
    }

    /// A URDF of these elements.
    fn read(&self, elements: &str) -> Result<ReadModel, SceneError> {
        let urdf = self.write("m.urdf", format!("<robot name=\"m\">{elements}</robot>"));
        read_model(&urdf, None, UpAxis::AsWritten, &PackagePath::only(&[]))
    }

    /// A URDF whose one link has a file for a shape.
    fn mesh(&self, name: &str, content: impl AsRef<[u8]>) -> ReadModel {
        self.write(name, content);
        let shape = format!("<collision><geometry><mesh filename=\"{name}\"/></geometry></collision>");
        self.read(&format!("<link name=\"a\">{shape}</link>")).unwrap()
    }

    /// Two joints on a base with an SRDF; the scene's start takes a configuration of that.
    fn scene(&self, srdf: &str, start: &str) -> Result<Scene, SceneError> {
        let ball = "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision>";
        let joint = |name: &str, child: &str, y: f64| {
            format!(
                "<joint name=\"{name}\" type=\"revolute\"><parent link=\"base\"/><child link=\"{child}\"/>\
                 <origin xyz=\"0 {y} 0\"/><limit lower=\"-2\" upper=\"2\"/></joint>"
            )
        };
        let joints = joint("left", "l", 1.0) + &joint("right", "r", -1.0);
        let links =
            format!("<link name=\"base\">{ball}</link><link name=\"l\">{ball}</link><link name=\"r\">{ball}</link>");
        self.write("two.urdf", format!("<robot name=\"two\">{links}{joints}</robot>"));
        self.write("two.srdf", format!("<robot name=\"two\">\n{srdf}</robot>"));
        let scene = self.write(
            "scene.toml",
            format!(
                "format = \"foliate.scene/1\"\nname = \"s\"\n[[part]]\nname = \"two\"\nkind = \"robot\"\nurdf = \"two.urdf\"\n\
                 srdf = \"two.srdf\"\n[start]\n{start}\n[[goal]]\nconfiguration = {{ \"two/left\" = 0.1, \"two/right\" = 0 }}\n[graph]\n"
            ),
        );
        Scene::load(&scene, &PackagePath::only(&[]))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

fn warnings(read: &ReadModel) -> Vec<String> {
    read.warnings.iter().map(ToString::to_string).collect()
}

fn mesh(read: &ReadModel) -> Arc<Mesh> {
    match &read.model.links[0].shapes[0].1 {
        Geometry::Mesh(mesh) => mesh.clone(),
        other => panic!("{other:?}"),
    }
}

/// A tetrahedron as text, with a name of one's own.
fn tetrahedron(name: &[u8], facets: &[[usize; 3]]) -> Vec<u8> {
    let corners = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"];
    let mut text = [b"solid ", name, b"\n"].concat();
    for facet in facets {
        let vertices: String = facet.iter().map(|&i| format!("vertex {}\n", corners[i])).collect();
        text.extend(format!("facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n").into_bytes());
    }
    text.extend([b"endsolid ", name, b"\n"].concat());
    text
}

const FACETS: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

#[test]
fn a_doubled_triangle_makes_no_shell() {
    let folder = Folder::new();
    for again in [[0, 2, 1], [2, 1, 0], [0, 1, 2]] {
        let facets = [FACETS.to_vec(), vec![again, [1, 1, 2]]].concat();
        let read = folder.mesh("m.stl", tetrahedron(b"m", &facets));
        let mesh = mesh(&read);
        assert!(mesh.closed && mesh.triangles.len() == 4, "{again:?}: {} triangles", mesh.triangles.len());
        assert_eq!(warnings(&read), Vec::<String>::new());
    }
    let open = folder.mesh("m.stl", tetrahedron(b"m", &FACETS[1..]));
    assert!(!mesh(&open).closed);
    assert!(warnings(&open)[0].contains("is not closed (only its surface is solid)"), "{:?}", warnings(&open));
}

#[test]
fn names_and_comments_in_meshes_may_be_in_any_encoding() {
    let folder = Folder::new();
    assert!(mesh(&folder.mesh("m.stl", tetrahedron(b"Geh\xe4use", &FACETS))).closed);
    let obj = b"# Geh\xe4use\r\no Geh\xe4use\r\nv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nv 0 0 1\r\nf 1 3 2\r\nf 1 2 4\r\nf 1 4 3\r\nf 2 3 4\r\n";
    assert!(mesh(&folder.mesh("m.obj", obj)).closed);
}

#[test]
fn a_part_without_collision_shapes_is_told() {
    let folder = Folder::new();
    let visual = "<visual><geometry><sphere radius=\"1\"/></geometry></visual>";
    let told = warnings(&folder.read(&format!("<link name=\"a\">{visual}</link>")).unwrap());
    assert!(told[0].contains("no collision shapes (1 link has a <visual> alone)"), "{told:?}");
    let told = warnings(&folder.read("<link name=\"a\"/>").unwrap());
    assert!(told[0].contains("has no collision shapes: it is never in the way"), "{told:?}");
    // A visual beside other links' shapes is fine.
    let solid = "<link name=\"b\"><collision><geometry><sphere radius=\"1\"/></geometry></collision></link>";
    let joint = "<joint name=\"j\" type=\"fixed\"><parent link=\"b\"/><child link=\"a\"/></joint>";
    assert!(warnings(&folder.read(&format!("<link name=\"a\">{visual}</link>{solid}{joint}")).unwrap()).is_empty());
}

#[test]
fn a_quaternion_turns_and_what_is_not_read_is_told() {
    let folder = Folder::new();
    let ball = "<collision><geometry><sphere radius=\"1\"/></geometry></collision>";
    let joint = |origin: &str, more: &str| {
        let links = format!("<link name=\"a\">{ball}</link>\n<link name=\"b\"/>\n");
        let ends = "<parent link=\"a\"/><child link=\"b\"/>";
        folder.read(&format!("{links}<joint name=\"j\" type=\"fixed\">{ends}\n<origin {origin}/>{more}</joint>"))
    };
    let read = joint("xyz=\"1 2 3\" quat_xyzw=\"0 0 0.7071 0.7071\"", "").unwrap();
    let pose = read.model.joints[0].parent_from_joint;
    assert!(pose.rotation.angle_between(DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2)) < 1e-6);
    assert_eq!((pose.translation, warnings(&read).len()), (DVec3::new(1.0, 2.0, 3.0), 0));
    let error = joint("rpy=\"0 0 1\" quat_xyzw=\"0 0 0 1\"", "").unwrap_err().to_string();
    assert!(error.contains("m.urdf:4") && error.contains("gives the rotation twice"), "{error}");
    let error = joint("quat_xyzw=\"0 0 1 1\"", "").unwrap_err().to_string();
    assert!(error.contains("length 1.4142"), "{error}");
    assert!(joint("quat_xyzw=\"0 0 1\"", "").unwrap_err().to_string().contains("wants 4 numbers"));
    // What is misspelt.
    let told = warnings(&joint("xyz=\"1 2 3\" ryp=\"0 0 1\"", "<mimc joint=\"j\"/><dynamics damping=\"1\"/>").unwrap());
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(
        told[0].contains("m.urdf:4: <origin> of <joint name=\"j\">: attribute `ryp` is not read (did you mean `rpy`?)"),
        "{told:?}"
    );
    assert!(
        told[1].contains("<mimc> is no element of <joint>") && told[1].contains("did you mean <mimic>?"),
        "{told:?}"
    );
    // Once for all places.
    let scaled = |name: &str| {
        format!(
            "<link name=\"{name}\"><collision><geometry><sphere radius=\"1\" scale=\"2\"/></geometry></collision></link>"
        )
    };
    let fixed = "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>";
    let told = warnings(&folder.read(&(scaled("a") + &scaled("b") + fixed)).unwrap());
    assert!(told.len() == 1 && told[0].contains("attribute `scale` is not read, 2 times"), "{told:?}");
}

#[test]
fn pairs_that_an_srdf_disables_by_default_are_left_out() {
    let folder = Folder::new();
    let disabled = |srdf: &str| {
        folder.scene(srdf, "two = \"home\"").unwrap_err(); // no such configuration
        let (urdf, srdf) = (folder.0.join("two.urdf"), folder.0.join("two.srdf"));
        let read =
            read_model(urdf.to_str().unwrap(), srdf.to_str(), UpAxis::AsWritten, &PackagePath::only(&[])).unwrap();
        let mut pairs: Vec<_> = read.model.disabled_pairs.iter().map(|(a, b, _)| format!("{a}-{b}")).collect();
        pairs.sort();
        (pairs, warnings(&read))
    };
    let (pairs, told) = disabled("<disable_default_collisions link=\"base\"/>");
    assert_eq!((pairs, told.len()), (vec!["base-l".to_owned(), "base-r".to_owned()], 0));
    let (pairs, _) = disabled(
        "<disable_default_collisions link=\"base\"/><enable_collisions link1=\"r\" link2=\"base\"/>\
         <disable_default_collisions link=\"l\"/>",
    );
    assert_eq!(pairs, ["base-l", "l-r"]);
    // A pair that is disabled by name stays so.
    let (pairs, _) =
        disabled("<disable_collisions link1=\"l\" link2=\"r\"/><enable_collisions link1=\"l\" link2=\"r\"/>");
    assert_eq!(pairs, ["l-r"]);
    let (pairs, told) =
        disabled("<disable_default_collisions link=\"bass\"/><enable_collisions link1=\"l\" link2=\"bass\"/>");
    assert_eq!((pairs.len(), told.len()), (0, 2), "{told:?}");
}

#[test]
fn configurations_of_one_name_all_apply() {
    let folder = Folder::new();
    let state = |group: &str, joint: &str, value: f64| {
        format!(
            "<group_state name=\"home\" group=\"{group}\"><joint name=\"{joint}\" value=\"{value}\"/></group_state>\n"
        )
    };
    let scene = folder.scene(&(state("a", "left", 1.0) + &state("b", "right", -1.0)), "two = \"home\"").unwrap();
    assert_eq!(scene.problem.start, [1.0, -1.0]);
    // Twice the same value is no contradiction; two values are, where a configuration uses them.
    let same = state("a", "left", 1.0) + &state("b", "right", -1.0) + &state("c", "left", 1.0);
    assert!(folder.scene(&same, "two = \"home\"").is_ok());
    let other = state("a", "left", 1.0) + &state("b", "right", -1.0) + &state("c", "left", 0.5);
    let error = folder.scene(&other, "two = \"home\"").unwrap_err().to_string();
    assert!(error.contains("joint `left` is at 1 in") && error.contains("two.srdf:2 and at 0.5 in"), "{error}");
    assert!(error.contains("two.srdf:4"), "{error}");
    assert!(folder.scene(&other, "\"two/left\" = 0\n\"two/right\" = 0").is_ok());
}

/// Of what lies in the current directory the folder has no name.
#[test]
fn bare_names_are_those_of_files_in_the_current_directory() {
    let folder = Folder::new();
    folder.mesh("m.stl", tetrahedron(b"m", &FACETS));
    let base = "<link name=\"base\"/><link name=\"b\"><collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>";
    let joint = "<joint name=\"j\" type=\"prismatic\"><parent link=\"base\"/><child link=\"b\"/><limit lower=\"3\" upper=\"5\"/></joint>";
    folder.write("b.urdf", format!("<robot name=\"b\">{base}{joint}</robot>"));
    folder.write(
        "scene.toml",
        "format = \"foliate.scene/1\"\nname = \"s\"\n[[part]]\nname = \"b\"\nkind = \"robot\"\nurdf = \"b.urdf\"\n[[part]]\nname = \"m\"\n\
         kind = \"environment\"\nurdf = \"m.urdf\"\n[start]\n\"b/j\" = 3\n[[goal]]\nconfiguration = { \"b/j\" = 4 }\n[graph]\n",
    );
    let foliate = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_foliate"));
        let output = command.current_dir(&folder.0).arg("--no-mesh-cache").args(arguments).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{arguments:?}: {said}{}", String::from_utf8_lossy(&output.stdout));
    };
    foliate(&["inspect", "m.urdf"]);
    foliate(&["solve", "scene.toml", "--out", "path.json"]);
    foliate(&["check", "path.json"]);
    // The package is where one stands, whatever that is called.
    let name = folder.0.file_name().unwrap().to_str().unwrap();
    let package = format!(
        "<link name=\"a\"><collision><geometry><mesh filename=\"package://{name}/m.stl\"/></geometry></collision></link>"
    );
    folder.write("p.urdf", format!("<robot name=\"p\">{package}</robot>"));
    foliate(&["inspect", "--package-path", ".", "p.urdf"]);
    foliate(&["inspect", "--package-path", "..", "p.urdf"]);
}

/// The tetrahedron's file is closed also where it is asked of a robot in the world.
#[test]
fn a_closed_mesh_of_two_pieces_is_one_solid() {
    let folder = Folder::new();
    let one = String::from_utf8(tetrahedron(b"m", &FACETS)).unwrap();
    let other = one.replace("1 0 0", "6 0 0").replace("vertex 0 0 0", "vertex 5 0 0");
    let read = folder.mesh("m.stl", one + &other.replace("0 1 0", "5 1 0").replace("0 0 1", "5 0 1"));
    assert!(mesh(&read).closed && mesh(&read).triangles.len() == 8);
    let placement = PartPlacement {
        name: "m".into(),
        kind: PartKind::Environment,
        root: RootJoint::Fixed,
        world_from_root: foliate::components::Pose::identity(),
        mimic_follows: true,
        root_bounds: Vec::new(),
        joint_bounds: Vec::new(),
    };
    assert_eq!(Robot::compose(&[(&read.model, placement)]).unwrap().shapes.len(), 1);
}
