//! A path file names every file that its problem was read from, with its SHA-256, and all that decides how they are read, so that
//! a checker of the path reads the same files.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]

#[path = "common/written.rs"]
mod written;

use foliate::Planner;
use foliate::check::{CheckOptions, CheckReport, SceneChoice, check};
use foliate::path_file::{PathFile, save};
use foliate::scene::{ModelFile, Origin, PackagePath, Scene, UpAxis, read_model, sha256};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use written::written;

/// A ball that moves in x, y and a little in z.
const GANTRY: &str = r#"<robot name="g"><link name="base"/><link name="lx"/><link name="ly"/>
<link name="ball"><collision><geometry><sphere radius="0.02"/></geometry></collision></link>
<joint name="jx" type="prismatic"><parent link="base"/><child link="lx"/><axis xyz="1 0 0"/><limit lower="-1" upper="1"/></joint>
<joint name="jy" type="prismatic"><parent link="lx"/><child link="ly"/><axis xyz="0 1 0"/><limit lower="-1" upper="1"/></joint>
<joint name="jz" type="prismatic"><parent link="ly"/><child link="ball"/><axis xyz="0 0 1"/><limit lower="0" upper="0.1"/></joint></robot>"#;

/// A leaf in the plane x = 0 between y = -0.6 and 0.6, and a bolt that follows it.
const DOOR: &str = r#"<robot name="d"><link name="frame"/><link name="bolt"/>
<link name="leaf"><collision><origin xyz="0 0.6 0"/><geometry><box size="0.02 1.2 2"/></geometry></collision></link>
<joint name="hinge" type="revolute"><parent link="frame"/><child link="leaf"/><origin xyz="0 -0.6 0"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="2"/></joint>
<joint name="slide" type="prismatic"><parent link="frame"/><child link="bolt"/><limit lower="-0.1" upper="0.18"/>
  <mimic joint="hinge" multiplier="0.1"/></joint></robot>"#;

/// A wall in the plane x = 0 from y = 0 to 1.2 as it is written, from z = 0 to 1.2 once its declared axis is turned.
const WALL_DAE: &str = r##"<?xml version="1.0"?><COLLADA><asset><unit meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="24">-0.01 0 -0.3 -0.01 0 0.3 -0.01 1.2 -0.3
-0.01 1.2 0.3 0.01 0 -0.3 0.01 0 0.3 0.01 1.2 -0.3 0.01 1.2 0.3</float_array></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="12"><input semantic="VERTEX" source="#v"
offset="0"/><p>0 1 3 0 3 2 4 6 7 4 7 5 0 4 5 0 5 1 2 3 7 2 7 6 0 2 6 0 6 4 1 5 7 1 7 3</p></triangles></mesh></geometry>
</library_geometries></COLLADA>"##;

const WALL: &str = r#"<robot name="w"><link name="wall"><collision><geometry><mesh filename="wall.dae"/></geometry></collision>
</link></robot>"#;

struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("foliate-named-{}-{number}", std::process::id()));
        std::fs::create_dir_all(path.join("out")).unwrap();
        let folder = Self(path);
        for (name, text) in [("gantry.urdf", GANTRY), ("door.urdf", DOOR), ("wall.urdf", WALL), ("wall.dae", WALL_DAE)]
        {
            std::fs::write(folder.0.join(name), text).unwrap();
        }
        folder
    }

    /// A ball that goes from x = -0.5 to x = 0.5 at a height y, past what else there is.
    fn scene(&self, y: f64, part: &str) -> PathBuf {
        let text = format!(
            "format = \"foliate.scene/1\"\nname = \"s\"\n[[part]]\nname = \"g\"\nkind = \"robot\"\nurdf = \"gantry.urdf\"\n\
             [[part]]\nkind = \"environment\"\n{part}\n[start]\n\"g/jx\" = -0.5\n\"g/jy\" = {y}\n\
             [[goal]]\nconfiguration = {{ \"g/jx\" = 0.5, \"g/jy\" = {y} }}\n[graph]\n"
        );
        let path = self.0.join("scene.toml");
        std::fs::write(&path, text).unwrap();
        path
    }

    /// What a scene's error says.
    fn refused(&self, part: &str) -> String {
        load(&self.scene(0.0, part)).expect_err("a refusal").to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

fn load(path: &Path) -> Result<Scene, foliate::scene::SceneError> {
    Scene::load(path.to_str().unwrap(), &PackagePath::only(&[]))
}

/// Plans, writes the path file into `out/`, and reads it back.
fn planned(scene: &Scene, out: &Path) -> PathFile {
    // Knots are changed below: a path without times takes that.
    let planner = Planner::new(scene.problem.clone()).unwrap().first_path();
    let solution = planner.solve().unwrap();
    let path = &solution.path;
    save::save(&written(scene, &solution.model.graph, path, out), out).unwrap();
    save::read(out).unwrap()
}

fn proved(file: &PathFile, base: &Path) -> CheckReport {
    check(file, base, &PackagePath::only(&[]), &CheckOptions::default()).unwrap()
}

/// The ball in a straight line, through whatever stands there.
fn straight(file: &PathFile) -> PathFile {
    let mut file = file.clone();
    let (first, last) =
        (file.segments[0].knots[0].clone(), file.segments.last().unwrap().knots.last().unwrap().clone());
    file.segments.truncate(1);
    file.segments[0].knots = vec![first, last];
    file
}

#[test]
fn an_environments_joints_stand_in_the_file_where_the_scene_has_them() {
    let folder = Folder::new();
    let out = folder.0.join("out/path.json");
    // Shut, the leaf is in the way of everything at y = 0; open, nothing is.
    let open = load(&folder.scene(0.0, "name = \"door\"\nurdf = \"door.urdf\"\nvalues = { hinge = 1.5 }")).unwrap();
    let file = planned(&open, &out);
    assert_eq!(file.coordinates, ["g/jx", "g/jy", "g/jz", "door/hinge"]);
    assert!(file.segments.iter().flat_map(|s| &s.knots).all(|knot| knot[3] == 1.5));
    assert!(proved(&straight(&file), &folder.0.join("out")).passed());
    // The other way round: the open leaf stands where nothing stands when it is shut.
    let along = load(&folder.scene(-0.8, "name = \"door\"\nurdf = \"door.urdf\"\nvalues = { hinge = -1.0 }")).unwrap();
    let mut file = planned(&along, &out);
    assert!(proved(&file, &folder.0.join("out")).passed());
    for knot in file.segments.iter_mut().flat_map(|s| &mut s.knots) {
        knot[1] = -0.62;
    }
    assert!(!proved(&straight(&file), &folder.0.join("out")).passed(), "the ball runs through the open leaf");
}

#[test]
fn values_that_no_environment_can_have_are_refused() {
    let folder = Folder::new();
    let door =
        |values: &str| folder.refused(&format!("name = \"door\"\nurdf = \"door.urdf\"\nvalues = {{ {values} }}"));
    let follower = door("slide = 0.1");
    assert!(follower.contains("follows `hinge`") && follower.contains("give the value of `hinge`"), "{follower}");
    assert!(door("hinge = 2.5").contains("`hinge` is then at 2.5, outside its limits [-1, 2]"));
    assert!(door("hinge = 1.9").contains("`slide` is then at 0.19"));
    let free = "name = \"door\"\nurdf = \"door.urdf\"\nmimic = \"free\"\nvalues = { hinge = 1.0, slide = 0.05 }";
    let scene = load(&folder.scene(-0.8, free)).unwrap();
    assert_eq!(scene.parts[1].joint_values, [("hinge".into(), 1.0), ("slide".into(), 0.05)]);
    let file = planned(&scene, &folder.0.join("out/path.json"));
    assert_eq!(file.coordinates[3..], ["door/hinge", "door/slide"]);
    assert!(proved(&file, &folder.0.join("out")).passed());
}

#[test]
fn the_up_axis_of_meshes_stands_in_the_file() {
    let folder = Folder::new();
    let out = folder.0.join("out/path.json");
    let declared =
        load(&folder.scene(0.7, "name = \"wall\"\nurdf = \"wall.urdf\"\nmesh_up_axis = \"declared\"")).unwrap();
    let mut file = planned(&declared, &out);
    assert_eq!(file.parts[1].mesh_up_axis.as_deref(), Some("declared"));
    let straight_on = straight(&file);
    assert!(proved(&straight_on, &folder.0.join("out")).passed(), "the turned wall ends at y = 0.3");
    file = straight_on;
    file.parts[1].mesh_up_axis = Some("as-written".into());
    assert!(!proved(&file, &folder.0.join("out")).passed(), "the wall as it is written reaches to y = 1.2");
    file.parts[1].mesh_up_axis = Some("sideways".into());
    let error = check(&file, &folder.0.join("out"), &PackagePath::only(&[]), &CheckOptions::default()).unwrap_err();
    assert!(error.to_string().contains("parts[1].mesh_up_axis: `sideways` is none of as-written, declared"), "{error}");
}

#[test]
fn every_file_that_a_part_is_read_from_has_its_sum_in_the_path_file() {
    let folder = Folder::new();
    std::fs::write(folder.0.join("wall.srdf"), "<robot name=\"w\"/>").unwrap();
    let path = folder.scene(-0.5, "name = \"wall\"\nurdf = \"wall.urdf\"\nsrdf = \"wall.srdf\"");
    let file = planned(&load(&path).unwrap(), &folder.0.join("out/path.json"));
    let sum = |name: &str| sha256(&std::fs::read(folder.0.join(name)).unwrap());
    let sums = |named: &[(&str, &str)]| -> BTreeMap<String, String> {
        named.iter().map(|(key, name)| ((*key).to_owned(), sum(name))).collect()
    };
    assert_eq!(file.parts[0].sha256, sums(&[("urdf", "gantry.urdf")]));
    let wall = sums(&[("urdf", "wall.urdf"), ("srdf", "wall.srdf"), ("wall.dae", "wall.dae")]);
    assert_eq!(file.parts[1].sha256, wall);
    // Reading the model again gives the same sums under the same names.
    let name = |name: &str| folder.0.join(name).to_str().unwrap().to_owned();
    let read =
        read_model(&name("wall.urdf"), Some(&name("wall.srdf")), UpAxis::AsWritten, &PackagePath::only(&[])).unwrap();
    assert_eq!(read.sha256, wall);
    std::fs::write(folder.0.join("wall.dae"), WALL_DAE.replace("1.2", "1.3")).unwrap();
    let read = read_model(&name("wall.urdf"), None, UpAxis::AsWritten, &PackagePath::only(&[])).unwrap();
    assert_ne!(read.sha256["wall.dae"], wall["wall.dae"]);
}

#[test]
fn the_path_file_says_where_its_scene_is() {
    let folder = Folder::new();
    let path = folder.scene(-0.5, "name = \"wall\"\nurdf = \"wall.urdf\"");
    let file = planned(&load(&path).unwrap(), &folder.0.join("out/path.json"));
    let scene = file.scene_file.clone().unwrap();
    assert_eq!(scene.file, "../scene.toml");
    assert_eq!(scene.sha256, sha256(&std::fs::read(&path).unwrap()));
    // Behind a link, `..` is not where it seems to be.
    #[cfg(unix)]
    {
        std::fs::create_dir_all(folder.0.join("far/away")).unwrap();
        std::os::unix::fs::symlink(folder.0.join("far/away"), folder.0.join("link")).unwrap();
        let file = planned(&load(&path).unwrap(), &folder.0.join("link/path.json"));
        assert_eq!(file.scene_file.unwrap().file, "../../scene.toml");
        assert!(folder.0.join("link").join(&file.parts[1].urdf).is_file());
    }
    // A shipped scene has no place on disk; a file of its name is another one.
    let demo = Scene::load("demo", &PackagePath::only(&[])).unwrap();
    let names = save::model_names(&demo, &folder.0.join("out/demo.json")).unwrap();
    assert_eq!(names.scene_file.unwrap().file, "demo");
    let urdf = &demo.parts[0].urdf;
    assert_eq!(names.parts[0].sha256["urdf"], urdf.sha256);
    assert_eq!(sha256(&std::fs::read(folder.0.join("out").join(&names.parts[0].urdf)).unwrap()), urdf.sha256);
    std::fs::copy(&path, folder.0.join("demo")).unwrap();
    let scene = load(&folder.0.join("demo")).unwrap();
    let names = save::model_names(&scene, &folder.0.join("path.json")).unwrap();
    assert_eq!(names.scene_file.unwrap().file, "./demo");
}

/// Models that live in the program are written beside the path file: two of one name and different content both.
#[test]
fn models_of_one_name_are_written_beside_under_two() {
    let folder = Folder::new();
    let mut scene = Scene::load("demo", &PackagePath::only(&[])).unwrap();
    // The second box has another file of the first one's name; the spaces in it change nothing but its bytes.
    let boxes: Vec<usize> = (0..scene.parts.len()).filter(|&i| scene.parts[i].urdf.url.contains("box")).collect();
    let Origin::Program(content) = scene.parts[boxes[1]].urdf.origin else { panic!("it is in the program") };
    let other: &'static str = Box::leak(format!("{content}  \n").into_boxed_str());
    let sum = sha256(other.as_bytes());
    scene.parts[boxes[1]].urdf =
        ModelFile { url: "other/BOX.urdf".into(), origin: Origin::Program(other), sha256: sum.clone() };
    scene.parts[boxes[1]].sha256.insert("urdf".into(), sum);
    let out = folder.0.join("out/path.json");
    let file = planned(&scene, &out);
    let names: Vec<&str> = boxes.iter().map(|&i| file.parts[i].urdf.as_str()).collect();
    assert_eq!(names, ["path.models/box.urdf", "path.models/BOX-2.urdf"]);
    for (name, content) in names.iter().zip([content, other]) {
        assert_eq!(std::fs::read_to_string(out.with_file_name(name)).unwrap(), content);
    }
    // The SRDF of both is one file.
    assert_eq!(file.parts[boxes[0]].srdf, file.parts[boxes[1]].srdf);
    assert_eq!(save::model_names(&scene, &out).unwrap().parts[boxes[1]].urdf, names[1]);
    let alone = CheckOptions { scene: SceneChoice::Nothing, ..CheckOptions::default() };
    let report = check(&file, out.parent().unwrap(), &PackagePath::only(&[]), &alone).unwrap();
    assert!(report.violations.is_empty(), "{:?}", report.violations);
}
