//! Promise: what a model says and no machine can mean is told with file and line, and read in the way that is meant: limits that mean
//! none, joints without range, links hundreds of metres wide, solids without volume, names that no reader knows.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate::Planner;
use foliate::components::robot::Source;
use foliate::components::robot::model::JointKind;
use foliate::scene::{PackagePath, ReadModel, Scene, SceneError, UpAxis, coordinate_names, read_model};
use std::path::PathBuf;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("foliate-cannot-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, content: &str) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, content).unwrap();
        path.to_str().unwrap().to_owned()
    }

    fn read(&self, elements: &str) -> ReadModel {
        let urdf = self.write("m.urdf", &format!("<robot name=\"m\">\n{elements}</robot>"));
        read_model(&urdf, None, UpAxis::AsWritten, &PackagePath::only(&[])).unwrap()
    }

    fn told(&self, elements: &str) -> Vec<String> {
        self.read(elements).warnings.iter().map(ToString::to_string).collect()
    }

    /// What is told of a joint with these limits, the limits that it has, and its kind.
    fn joint(&self, kind: &str, limit: &str) -> (Vec<String>, (f64, f64), JointKind) {
        let read = self.read(&arm(kind, limit));
        let joint = &read.model.joints[0];
        (read.warnings.iter().map(ToString::to_string).collect(), joint.limits, joint.kind)
    }

    fn scene(&self, part: &str, rest: &str) -> Result<Scene, SceneError> {
        let text = format!(
            "format = \"foliate.scene/1\"\nname = \"s\"\n[[part]]\nname = \"m\"\nkind = \"robot\"\nurdf = \"m.urdf\"\n{part}\n{rest}\n[graph]\n"
        );
        Scene::load(&self.write("scene.toml", &text), &PackagePath::only(&[]))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

const BALL: &str = "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision>";
const NONE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

fn arm(kind: &str, limit: &str) -> String {
    format!(
        "<link name=\"a\"/><link name=\"b\">{BALL}</link>\n<joint name=\"j\" type=\"{kind}\">\n<parent link=\"a\"/><child link=\"b\"/>\
         <axis xyz=\"0 0 1\"/>\n{limit}</joint>"
    )
}

#[test]
fn limits_that_mean_none_are_none() {
    let folder = Folder::new();
    for number in ["1e9", "1e16", "3.4028234663852886e38", "100"] {
        let limit = format!("<limit lower=\"-{number}\" upper=\"{number}\" velocity=\"1\"/>");
        let (told, limits, kind) = folder.joint("revolute", &limit);
        assert_eq!((limits, kind), (NONE, JointKind::Continuous), "{number}");
        assert!(
            told.len() == 1 && told[0].contains("m.urdf:5: <limit> of <joint name=\"j\">: its limits are"),
            "{told:?}"
        );
        assert!(told[0].contains("it is read as continuous"), "{told:?}");
    }
    let (told, limits, kind) = folder.joint("prismatic", "<limit lower=\"-1e9\" upper=\"1e9\"/>");
    assert_eq!((limits, kind), (NONE, JointKind::Prismatic));
    assert!(
        told[0].contains("draw values within 1 m of 0") && told[0].contains("`joint_bounds` in a scene"),
        "{told:?}"
    );
    // One of two: the other one holds.
    let (told, limits, _) = folder.joint("revolute", "<limit lower=\"-1e9\" upper=\"1\"/>");
    assert_eq!(limits, (1.0 - 4.0 * std::f64::consts::PI, 1.0));
    assert!(told[0].contains("the lower one is read as -11.5"), "{told:?}");
    assert_eq!(folder.joint("prismatic", "<limit lower=\"0\" upper=\"1e16\"/>").1, (0.0, 20.0));
    // A few turns and long rails are meant.
    for (kind, limit) in [("revolute", "lower=\"-20\" upper=\"20\""), ("prismatic", "lower=\"0\" upper=\"150\"")] {
        assert!(folder.joint(kind, &format!("<limit {limit}/>")).0.is_empty());
    }
    // A velocity that no joint has is no limit.
    let read = folder.read(&arm("revolute", "<limit lower=\"-1\" upper=\"1\" velocity=\"3.4e38\"/>"));
    assert_eq!(read.model.joints[0].velocity_limit, None);
}

/// Where limits of 1e9 were taken for limits, searches found nothing in 10 s.
#[test]
fn robots_whose_limits_mean_none_are_planned_for() {
    let folder = Folder::new();
    folder.read(
        "<link name=\"a\"/><link name=\"rail\"/><link name=\"b\"><collision><origin xyz=\"0.3 0 0\"/><geometry>\
         <box size=\"0.4 0.05 0.05\"/></geometry></collision></link>\
         <joint name=\"x\" type=\"prismatic\"><parent link=\"a\"/><child link=\"rail\"/><limit lower=\"-1e9\" upper=\"1e9\" velocity=\"1\"/></joint>\
         <joint name=\"yaw\" type=\"revolute\"><parent link=\"rail\"/><child link=\"b\"/><axis xyz=\"0 0 1\"/>\
         <limit lower=\"-1e16\" upper=\"1e16\" velocity=\"1\"/></joint>",
    );
    let post = "<robot name=\"p\"><link name=\"p\"><collision><origin xyz=\"0.5 0.1 0\"/><geometry><box size=\"0.05 0.05 1\"/>\
                </geometry></collision></link></robot>";
    folder.write("post.urdf", post);
    let rest = "[[part]]\nname = \"post\"\nkind = \"environment\"\nurdf = \"post.urdf\"\n[start]\n\"m/x\" = 0.0\n\"m/yaw\" = -0.5\n\
                [[goal]]\nconfiguration = { \"m/x\" = 0.0, \"m/yaw\" = 1.5 }";
    let scene = folder.scene("", rest).unwrap();
    assert_eq!(scene.warnings.len(), 2, "{:?}", scene.warnings);
    let solved = Planner::new(scene.problem).unwrap().seed(1).time_limit(std::time::Duration::from_secs(5)).solve();
    assert!(solved.is_ok(), "{}", solved.err().map(|none| none.to_string()).unwrap_or_default());
}

#[test]
fn joints_without_range_are_told() {
    let folder = Folder::new();
    let (told, limits, _) = folder.joint("revolute", "<limit effort=\"1\" velocity=\"1\"/>");
    assert_eq!(limits, (0.0, 0.0));
    assert!(told[0].contains("m.urdf:5: <limit> of <joint name=\"j\">: has neither `lower` nor `upper`"), "{told:?}");
    let (told, ..) = folder.joint("prismatic", "<limit lower=\"0.2\" upper=\"0.2\"/>");
    assert!(told[0].contains("its limits are equal: it stays at 0.2"), "{told:?}");
    assert!(folder.joint("fixed", "<limit effort=\"1\"/>").0.is_empty());
    // The joints of what stands around stand still anyway.
    let text = "format = \"foliate.scene/1\"\nname = \"s\"\n[[part]]\nname = \"r\"\nkind = \"robot\"\nurdf = \"m.urdf\"\n[[part]]\n\
                name = \"e\"\nkind = \"environment\"\nurdf = \"e.urdf\"\n[start]\n[[goal]]\nconfiguration = { \"r/j\" = 0.5 }\n[graph]\n";
    folder.write("e.urdf", &format!("<robot name=\"e\">{}</robot>", arm("revolute", "<limit effort=\"1\"/>")));
    folder.read(&arm("revolute", "<limit lower=\"-1\" upper=\"1\"/>"));
    assert!(Scene::load(&folder.write("s.toml", text), &PackagePath::only(&[])).unwrap().warnings.is_empty());
}

#[test]
fn links_of_hundreds_of_metres_and_solids_without_volume_are_told() {
    let folder = Folder::new();
    let link = |shape: &str| format!("<link name=\"a\">\n<collision><geometry>{shape}</geometry></collision></link>");
    let corner = |x: u32, y: u32, z: u32| format!("v {x} {y} {z}\n");
    folder.write(
        "t.obj",
        &(corner(0, 0, 0)
            + &corner(800, 0, 0)
            + &corner(0, 1, 0)
            + &corner(0, 0, 1)
            + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"),
    );
    let told = folder.told(&link("<mesh filename=\"t.obj\"/>"));
    assert!(
        told.len() == 1 && told[0].contains("m.urdf:3: <collision> of <link name=\"a\">: the mesh is 800 m wide"),
        "{told:?}"
    );
    assert!(told[0].contains("scale=\"0.001 0.001 0.001\""), "{told:?}");
    assert!(folder.told(&link("<mesh filename=\"t.obj\" scale=\"0.001 0.001 0.001\"/>")).is_empty());
    assert!(folder.told(&link("<box size=\"1 1 60\"/>"))[0].contains("the box is 60 m wide"));
    for shape in ["<sphere radius=\"0\"/>", "<box size=\"1 0 1\"/>", "<cylinder radius=\"0\" length=\"1\"/>"] {
        let told = folder.told(&link(shape));
        assert!(told.len() == 1 && told[0].contains("has no volume: one of its lengths is 0"), "{shape}: {told:?}");
    }
    // Halls may be wide.
    folder.read(&arm("revolute", "<limit lower=\"-1\" upper=\"1\"/>"));
    folder.write(
        "hall.urdf",
        &format!(
            "<robot name=\"h\">{}</robot>",
            link("<box size=\"200 200 0.1\"/>").replace("<geo", "<origin xyz=\"0 0 -9\"/><geo")
        ),
    );
    let rest = "[[part]]\nname = \"hall\"\nkind = \"environment\"\nurdf = \"hall.urdf\"\n[start]\n[[goal]]\nconfiguration = { \"m/j\" = 0.5 }";
    assert!(folder.scene("", rest).unwrap().warnings.is_empty());
}

#[test]
fn elements_and_attributes_that_no_reader_knows_are_told() {
    let folder = Folder::new();
    let one = |elements: &str, says: &str| {
        let told = folder.told(elements);
        assert!(told.len() == 1 && told[0].contains(says), "{elements}: {told:?}");
    };
    let limit = "<limit lower=\"-1\" upper=\"1\"";
    one(&arm("revolute", &format!("{limit} lowre=\"-2\"/>")), "attribute `lowre` is not read (did you mean `lower`?)");
    one(&arm("revolute", &format!("{limit}/><mimic_joint joint=\"k\"/>")), "<mimic_joint> is no element of <joint>");
    one(&arm("revolute", &format!("{limit}><soft lower=\"0\"/></limit>")), "<soft> is no element of <limit>");
    let link = |inside: &str| format!("<link name=\"a\">{inside}</link>");
    let mesh = "<collision><geometry><sphere radius=\"1\"/></geometry><scale>2</scale></collision>";
    one(&link(mesh), "<scale> is no element of <collision>");
    one(&link(&format!("<origin xyz=\"0 0 1\"/>{BALL}")), "<origin> is no element of <link>");
    one(
        &format!("{}<jiont name=\"j\"/><jiont name=\"k\"/>", link(BALL)),
        "<jiont> is no element of <robot> and is not read, 2 times",
    );
    // What simulators and controllers say is known, and of other namespaces nothing is.
    let others = "<dynamics damping=\"1\"/><safety_controller k_velocity=\"1\"/><calibration rising=\"0\"/>";
    assert!(folder.told(&arm("revolute", &format!("{limit}/>{others}"))).is_empty());
    let soft = |low: f64, high: f64| {
        format!("{limit}/><safety_controller soft_lower_limit=\"{low}\" soft_upper_limit=\"{high}\" k_velocity=\"1\"/>")
    };
    one(
        &arm("revolute", &soft(-0.9, 1.0)),
        "<safety_controller> of <joint name=\"j\">: its soft limits [-0.9, 1] are narrower than its limits [-1, 1]",
    );
    assert!(folder.told(&arm("revolute", &soft(-1.0, 1.2))).is_empty());
    let drake = format!(
        "{}<gazebo/><transmission/><d:thing xmlns:d=\"http://d\"/>",
        link(&format!("<d:x xmlns:d=\"http://d\"/>{BALL}"))
    );
    assert!(folder.told(&drake).is_empty());
    // The same without the declaration, which published models forget.
    let told = folder.told(&drake.replace(" xmlns:d=\"http://d\"", ""));
    assert!(
        told.len() == 1 && told[0].contains("the prefix `d:` is not declared; it is read as if `xmlns:d` were there"),
        "{told:?}"
    );
}

#[test]
fn what_an_srdf_says_and_no_reader_knows_is_told() {
    let folder = Folder::new();
    let told = |srdf: &str| -> Vec<String> {
        folder.read(&arm("revolute", "<limit lower=\"-1\" upper=\"1\"/>"));
        let srdf = folder.write("m.srdf", &format!("<robot name=\"m\">\n{srdf}</robot>"));
        let urdf = folder.0.join("m.urdf");
        let read = read_model(urdf.to_str().unwrap(), Some(&srdf), UpAxis::AsWritten, &PackagePath::only(&[])).unwrap();
        read.warnings.iter().map(ToString::to_string).collect()
    };
    let gripper = |position: &str| {
        format!("<gripper name=\"g\" clearance=\"0\"><link name=\"b\"/><position {position}/></gripper>")
    };
    assert!(told(&gripper("xyz=\"0 0 0\" rpy=\"0 0 1\"")).is_empty());
    let said = told(&gripper("xyz=\"0 0 0\" ryp=\"0 0 1\""));
    assert!(
        said.len() == 1
            && said[0].contains(
                "m.srdf:2: <position> of <gripper name=\"g\">: attribute `ryp` is not read (did you mean `rpy`?)"
            ),
        "{said:?}"
    );
    let said = told("<disable_collision link1=\"a\" link2=\"b\"/>");
    assert!(said.len() == 1 && said[0].contains("did you mean <disable_collisions>?"), "{said:?}");
    assert!(
        told("<group name=\"g\"/><end_effector name=\"e\" parent_link=\"a\"/><virtual_joint name=\"v\"/>").is_empty()
    );
}

#[test]
fn floating_and_planar_joints_of_models_are_bounded_and_locked() {
    let folder = Folder::new();
    let start = "[start]\n\"m/j\" = [0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 1.0]\n[[goal]]\ncoordinates = { \"m/j/x\" = 0.15 }";
    folder.read(&arm("floating", ""));
    let open = folder.scene("", start).unwrap();
    let told = open.warnings.iter().map(ToString::to_string).find(|told| told.contains("without bounds"));
    let told = told.expect("a warning with the line of the joint");
    assert!(told.contains("m.urdf:3: <joint name=\"j\">: moves along x without bounds"), "{told}");
    assert!(told.contains("joint_bounds = { \"j/x\" = [-1, 1] }") && told.contains("`\"m/j\"` in [locked]"), "{told}");
    let error = Planner::new(open.problem).err().unwrap().to_string();
    assert!(error.contains("`m/j` moves along x without bounds") && error.contains("`joint_bounds`"), "{error}");
    let bounds = "joint_bounds = { \"j/x\" = [-0.5, 0.5], \"j/y\" = [0, 1], \"j/z\" = [0, 1] }";
    let scene = folder.scene(bounds, start).unwrap();
    assert_eq!(coordinate_names(&scene.problem.robot)[..3], ["m/j/x", "m/j/y", "m/j/z"]);
    assert_eq!(
        (&scene.problem.robot.joints[0].lower[..3], &scene.problem.robot.joints[0].upper[..3]),
        (&[-0.5, 0.0, 0.0][..], &[0.5, 1.0, 1.0][..])
    );
    assert_eq!(scene.problem.start[..3], [0.1, 0.2, 0.3]);
    assert!(Planner::new(scene.problem).unwrap().seed(1).solve().is_ok());
    // Locked, it never moves.
    let locked = "[locked]\n\"m/j\" = [0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 1.0]\n[start]\n[[goal]]\nconfiguration = {}";
    let scene = folder.scene("", locked).unwrap();
    let joint = &scene.problem.robot.joints[0];
    assert!(joint.is_immovable() && matches!(joint.source, Source::Coordinates { .. }));
    assert_eq!(scene.problem.start, [0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 1.0]);
    assert!(Planner::new(scene.problem).is_ok());
    folder.read(&arm("planar", ""));
    let scene = folder.scene("", "[locked]\n\"m/j\" = [1, 2, 0.5]\n[start]\n[[goal]]\nconfiguration = {}").unwrap();
    assert_eq!(scene.problem.start, [1.0, 2.0, 0.5]);
    // Refusals.
    let refused = |part: &str, rest: &str| folder.scene(part, rest).unwrap_err().to_string();
    let rest = "[start]\n\"m/j\" = [0, 0, 0]\n[[goal]]\nconfiguration = {}";
    assert!(refused("joint_bounds = { \"j/w\" = [0, 1] }", rest).contains("no joint of one coordinate has this name"));
    assert!(refused("joint_bounds = { \"j/theta\" = [-3, 3] }", rest).contains("more than half a turn"));
    let beyond = "[locked]\n\"m/j\" = [1, 2, 0.5]\n[start]\n[[goal]]\nconfiguration = {}";
    assert!(
        refused("joint_bounds = { \"j/x\" = [0, 0.5] }", beyond).contains("is outside the `joint_bounds` of `j/x`")
    );
}

#[test]
fn other_descriptions_and_meshes_are_refused_with_a_converter() {
    let folder = Folder::new();
    let urdf = folder.write("m.xml", "<mujoco model=\"m\"><worldbody/></mujoco>");
    let error = read_model(&urdf, None, UpAxis::AsWritten, &PackagePath::only(&[])).unwrap_err().to_string();
    assert!(error.contains("MJCF") && error.contains("mjcf-urdf-simple-converter"), "{error}");
    folder.write("t.vtk", "# vtk DataFile Version 3.0\n");
    let urdf = folder.write("v.urdf", "<robot name=\"m\"><link name=\"a\"><collision><geometry><mesh filename=\"t.vtk\"/></geometry></collision></link></robot>");
    let error = read_model(&urdf, None, UpAxis::AsWritten, &PackagePath::only(&[])).unwrap_err().to_string();
    assert!(error.contains("`.vtk` are not read") && error.contains("meshio convert"), "{error}");
}

/// As the program prints them.
#[test]
fn inspect_lists_what_cannot_be_meant() {
    let folder = Folder::new();
    folder.read(&arm("revolute", "<limit lower=\"-1e16\" upper=\"1e16\"/>"));
    let output = Command::new(env!("CARGO_BIN_EXE_foliate"))
        .current_dir(&folder.0)
        .args(["inspect", "m.urdf"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(
        said.contains("Warnings: 1\n  ./m.urdf:5: <limit> of <joint name=\"j\">: its limits are [-1e16, 1e16] rad"),
        "{said}"
    );
}
