//! Promise: a mesh is read by whatever name a model gives it (`../`, absolute, `file://`, `package://`, a link), where it lies below a
//! directory that the user gave, in the package that holds the model, or below the scene; elsewhere it is refused in one sentence,
//! which says the option that allows it.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]
#![cfg(unix)]

use foliate::scene::{PackagePath, Scene, SceneError, UpAxis, Visuals, read_model};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let name = format!("foliate-lie-{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path.canonicalize().unwrap())
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn write(&self, name: &str, content: &str) -> PathBuf {
        let path = self.at(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, content).unwrap();
        path
    }

    /// A model that names a mesh.
    fn model(&self, name: &str, mesh: &str) -> PathBuf {
        self.write(name, &urdf(mesh))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

fn urdf(mesh: &str) -> String {
    format!(
        "<robot name=\"m\"><link name=\"a\"><visual><geometry><mesh filename=\"{mesh}\"/></geometry></visual>\
         <collision><geometry><mesh filename=\"{mesh}\"/></geometry></collision></link></robot>"
    )
}

fn xml(name: &str) -> String {
    format!("<?xml version=\"1.0\"?>\n<package format=\"3\"><name> {name} </name></package>\n")
}

fn read(urdf: impl AsRef<Path>, given: &[&Path]) -> Result<(), SceneError> {
    let packages = PackagePath::only(&given.iter().map(|path| path.to_path_buf()).collect::<Vec<_>>());
    read_model(urdf.as_ref().to_str().unwrap(), None, UpAxis::AsWritten, &packages).map(drop)
}

fn refusal(urdf: impl AsRef<Path>, given: &[&Path]) -> String {
    read(urdf, given).expect_err("a refusal").to_string()
}

/// That the refusal of a model names the directory that allows it, and that it does.
fn is_allowed_by(urdf: &Path, directory: &Path) {
    let said = refusal(urdf, &[]);
    let option = format!("(--package-path {} allows it)", directory.display());
    assert!(said.contains("outside of the directories that may be read") && said.ends_with(&option), "{said}");
    read(urdf, &[directory]).unwrap();
}

#[test]
fn what_lies_beside_the_model_is_read_below_a_given_directory() {
    let folder = Folder::new();
    let mesh = folder.write("b/t.obj", MESH).display().to_string();
    for name in ["../b/t.obj".to_owned(), mesh.clone(), format!("file://{mesh}"), format!("file:{mesh}")] {
        let model = folder.model("a/m.urdf", &name);
        is_allowed_by(&model, &folder.0);
        read(&model, &[&folder.at("b")]).unwrap();
        // The folder of the model is none of what was given.
        assert!(read(&model, &[&folder.at("a")]).is_err());
    }
    // Below the model's own folder nothing has to be given, however it is written.
    let own = folder.write("a/meshes/t.obj", MESH).display().to_string();
    for name in ["meshes/t.obj", "../a/meshes/t.obj", &own, &format!("file://{own}")] {
        read(folder.model("a/m.urdf", name), &[]).unwrap();
    }
    let said = refusal(folder.model("a/m.urdf", "http://host/t.obj"), &[]);
    assert!(said.contains("`http://` URLs are not read"), "{said}");
}

#[test]
fn whether_something_is_there_is_said_only_where_it_may_be_read() {
    let folder = Folder::new();
    folder.write("b/there.obj", MESH);
    let said = |name: &str| refusal(folder.model("a/m.urdf", name), &[]).replace("missing", "there");
    assert_eq!(said("../b/there.obj"), said("../b/missing.obj"));
    let said = refusal(folder.model("a/m.urdf", "../b/missing.obj"), &[&folder.0]);
    assert!(said.contains("no such file"), "{said}");
}

#[test]
fn the_package_that_holds_the_model_is_found_upwards() {
    let folder = Folder::new();
    // By its package.xml, whatever the folder is called.
    folder.write("checkout-main/package.xml", &xml("my_robot"));
    folder.write("checkout-main/meshes/t.obj", MESH);
    for name in ["package://my_robot/meshes/t.obj", "../../meshes/t.obj", "package:///my_robot/urdf/../meshes/t.obj"] {
        read(folder.model("checkout-main/urdf/arms/m.urdf", name), &[]).unwrap();
    }
    // By its folder.
    folder.write("arm_description/meshes/t.obj", MESH);
    read(folder.model("arm_description/urdf/m.urdf", "package://arm_description/meshes/t.obj"), &[]).unwrap();
    // A folder without package.xml is no package for relative names.
    is_allowed_by(&folder.model("arm_description/urdf/m.urdf", "../meshes/t.obj"), &folder.at("arm_description"));
    // Not out of it.
    folder.write("other/t.obj", MESH);
    let out = folder.model("checkout-main/urdf/m.urdf", "package://my_robot/../other/t.obj");
    is_allowed_by(&out, &folder.0);
    let said = refusal(folder.model("checkout-main/urdf/m.urdf", "package://your_robot/t.obj"), &[]);
    assert!(said.contains("package `your_robot` is not found"), "{said}");
}

#[test]
fn packages_below_a_given_directory_are_found_by_their_names() {
    let folder = Folder::new();
    folder.write("resources/panda_description/package.xml", &xml("moveit_panda_description"));
    folder.write("resources/panda_description/meshes/t.obj", MESH);
    folder.write(".hidden/package.xml", &xml("hidden"));
    folder.write(".hidden/t.obj", MESH);
    let model = folder.model("elsewhere/m.urdf", "package://moveit_panda_description/meshes/t.obj");
    assert!(refusal(&model, &[]).contains("is not found"));
    for given in ["", "resources", "resources/panda_description"] {
        read(&model, &[&folder.at(given)]).unwrap();
    }
    let said = refusal(folder.model("elsewhere/m.urdf", "package://hidden/t.obj"), &[&folder.0]);
    assert!(said.contains("is not found"), "{said}");
    // What is given first is read first, also before the package that the model lies in.
    folder.write("new/my_robot/t.obj", MESH);
    folder.write("my_robot/t.obj", "v 0 0 0\n");
    let model = folder.model("my_robot/m.urdf", "package://my_robot/t.obj");
    assert!(refusal(&model, &[]).contains("no triangles"));
    read(&model, &[&folder.at("new")]).unwrap();
}

/// `colcon build --symlink-install` makes a link for each file.
#[test]
fn links_lead_to_the_same_package_or_to_what_was_given() {
    let folder = Folder::new();
    let url = "package://my_robot/meshes/t.obj";
    folder.write("src/my_robot/package.xml", &xml("my_robot"));
    let (mesh, model) =
        (folder.write("src/my_robot/meshes/t.obj", MESH), folder.model("src/my_robot/urdf/m.urdf", url));
    for (from, to) in [(&mesh, "install/my_robot/meshes/t.obj"), (&model, "install/my_robot/urdf/m.urdf")] {
        std::fs::create_dir_all(folder.at(to).parent().unwrap()).unwrap();
        symlink(from, folder.at(to)).unwrap();
    }
    let install = folder.at("install");
    read("package://my_robot/urdf/m.urdf", &[&install]).unwrap();
    read(folder.at("install/my_robot/urdf/m.urdf"), &[]).unwrap();
    let other = folder.model("other/m.urdf", url);
    read(&other, &[&install]).unwrap();
    // A link to elsewhere is none to the same package, nor is one below the model.
    let secret = folder.write("secret/t.obj", MESH);
    std::fs::remove_file(folder.at("install/my_robot/meshes/t.obj")).unwrap();
    symlink(&secret, folder.at("install/my_robot/meshes/t.obj")).unwrap();
    assert!(refusal(&other, &[&install]).contains("secret/t.obj, outside of"));
    read(&other, &[&install, &folder.at("secret")]).unwrap();
    symlink(&secret, folder.at("other/t.obj")).unwrap();
    is_allowed_by(&folder.model("other/m.urdf", "t.obj"), &folder.0);
    // Nor does a path that climbs out of the package count as a link.
    folder.write("mine/package.xml", &xml("mine"));
    folder.write("mine/t.obj", MESH);
    std::fs::create_dir_all(folder.at("install/mine")).unwrap();
    let climbs = folder.model("other/m.urdf", "package://mine/../../mine/t.obj");
    assert!(refusal(&climbs, &[&install]).contains("outside of"));
}

fn foliate(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_foliate"));
    command.current_dir(folder).arg("--no-mesh-cache").args(arguments).env("HOME", folder).output().unwrap()
}

/// A file must not make a package of all that its user owns.
#[test]
fn the_home_of_the_user_is_no_package() {
    let folder = Folder::new();
    folder.write("t.obj", MESH);
    folder.write("package.xml", &xml("everything"));
    let name = folder.0.file_name().unwrap().to_str().unwrap().to_owned();
    for mesh in [format!("package://{name}/t.obj"), "package://everything/t.obj".into(), "../t.obj".into()] {
        folder.model("downloads/m.urdf", &mesh);
        let refused = foliate(&folder.0, &["inspect", "downloads/m.urdf"]);
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(refused.status.code() == Some(2) && said.contains("--package-path"), "{mesh}: {said}");
        let allowed =
            foliate(&folder.0, &["inspect", "downloads/m.urdf", "--package-path", ".", "--package-path", ".."]);
        assert!(allowed.status.success(), "{mesh}: {}", String::from_utf8_lossy(&allowed.stderr));
    }
}

/// What lies below a scene may be named by its models; the check of a path reads the same files, wherever the path lies.
#[test]
fn models_name_what_lies_below_their_scene_also_when_the_path_is_checked() {
    let folder = Folder::new();
    folder.write("scene/meshes/t.obj", MESH);
    folder.model("scene/models/wall.urdf", "../meshes/t.obj");
    folder.write(
        "scene/models/gantry.urdf",
        "<robot name=\"g\"><link name=\"base\"/><link name=\"b\"><collision><geometry><sphere radius=\"0.1\"/></geometry>\
         </collision></link><joint name=\"j\" type=\"prismatic\"><parent link=\"base\"/><child link=\"b\"/>\
         <limit lower=\"3\" upper=\"5\"/></joint></robot>",
    );
    let text = "format = \"foliate.scene/1\"\nname = \"s\"\n[[part]]\nname = \"g\"\nkind = \"robot\"\nurdf = \"models/gantry.urdf\"\n\
                [[part]]\nname = \"wall\"\nkind = \"environment\"\nurdf = \"models/wall.urdf\"\n[start]\n\"g/j\" = 3\n[[goal]]\n\
                configuration = { \"g/j\" = 4 }\n[graph]\n";
    folder.write("scene/s.toml", text);
    std::fs::create_dir_all(folder.at("out")).unwrap();
    let done = |arguments: &[&str]| {
        let output = foliate(&folder.0, arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{arguments:?}: {said}");
        said
    };
    done(&["solve", "scene/s.toml", "--out", "out/path.json"]);
    done(&["check", "out/path.json"]);
    done(&["check", "out/path.json", "--scene", "scene/s.toml"]);
    done(&["export", "out/path.json", "--to", "glb", "-o", "out/path.glb"]);
    done(&["view", "out/path.json", "-o", "out/path.html"]);
    // A path file cannot open a folder by calling something in it its scene.
    let path = std::fs::read_to_string(folder.at("out/path.json")).unwrap();
    assert!(path.contains("\"../scene/s.toml\""));
    folder.write("scene/none.toml", "name = \"no scene\"\n");
    for other in ["../scene/none.toml", "../scene/missing.toml", "../scene"] {
        folder.write("out/lie.json", &path.replace("../scene/s.toml", other));
        let refused = foliate(&folder.0, &["check", "out/lie.json"]);
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(refused.status.code() == Some(2) && said.contains("outside of"), "{other}: {said}");
    }
    // A scene that is a text has a directory, too.
    let scene = Scene::from_text("s", text, &folder.at("scene"), &PackagePath::only(&[])).unwrap();
    let visuals = Visuals::of_scene(&scene, &PackagePath::only(&[])).unwrap();
    assert!(visuals.warnings.is_empty() && visuals.links.iter().flatten().count() == 1, "{:?}", visuals.warnings);
    // Alone the model has no such directory.
    assert!(refusal(folder.at("scene/models/wall.urdf"), &[]).contains("outside of"));
    // Not above the scene.
    folder.model("scene/models/wall.urdf", "../../out/t.obj");
    folder.write("out/t.obj", MESH);
    let said = String::from_utf8_lossy(&foliate(&folder.0, &["graph", "scene/s.toml"]).stderr).into_owned();
    assert!(said.contains("out/t.obj, outside of"), "{said}");
}
