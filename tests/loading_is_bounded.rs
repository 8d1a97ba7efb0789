//! Loading ends where its host says: at a deadline, a token, or an amount of memory; and takes regular files only.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate::batch::Entry;
use foliate::components::robot::shape::{Geometry, Mesh};
use foliate::kernels::collision::solids::mesh_tree::MeshTree;
use foliate::scene::{LoadLimits, LoadStop, PackagePath, Scene, UpAxis, read_model};
use foliate::systems::events::{CancelToken, MemoryGuard, StopSignal};
use foliate::systems::planning_model::ProblemTables;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("foliate-bounded-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// A URDF with an OBJ of some hundred thousand triangles, and one with a box.
    fn models(&self) -> [String; 2] {
        let mut obj = String::new();
        for i in 0..100_000 {
            writeln!(obj, "v {i} 0 0\nv {i} 1 0\nv {i} 0 1\nf -1 -2 -3").unwrap();
        }
        std::fs::write(self.0.join("m.obj"), obj).unwrap();
        ["<mesh filename=\"m.obj\"/>", "<box size=\"1 1 1\"/>"].map(|shape| {
            let path = self.0.join(format!("{}.urdf", &shape[1..4]));
            let shape = format!("<collision><geometry>{shape}</geometry></collision>");
            std::fs::write(&path, format!("<robot name=\"m\"><link name=\"a\">{shape}</link></robot>")).unwrap();
            path.to_str().unwrap().to_owned()
        })
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

fn stop(urdf: &str, limits: LoadLimits) -> Option<LoadStop> {
    let packages = PackagePath::only(&[]).with_limits(limits);
    match read_model(urdf, None, UpAxis::AsWritten, &packages) {
        Ok(_) => None,
        Err(error) => Some(error.stopped.unwrap_or_else(|| panic!("{error}"))),
    }
}

fn signal(stop: StopSignal) -> LoadLimits {
    LoadLimits { stop, mesh_bytes: None }
}

#[test]
fn a_raised_signal_stops_the_reading_of_meshes_and_says_which() {
    let folder = Folder::new("signal");
    let [mesh, plain] = folder.models();
    let late = || StopSignal { deadline: Some(Instant::now()), ..StopSignal::default() };
    assert_eq!(stop(&mesh, signal(late())), Some(LoadStop::Deadline));
    let token = CancelToken::default();
    token.cancel();
    assert_eq!(stop(&mesh, signal(StopSignal { token, ..StopSignal::default() })), Some(LoadStop::Cancelled));
    let memory = Some(MemoryGuard::new(|| true));
    assert_eq!(stop(&mesh, signal(StopSignal { memory, ..StopSignal::default() })), Some(LoadStop::Memory));
    // Nothing that takes long is in the other model.
    assert_eq!(stop(&plain, signal(late())), None);
    let soon = StopSignal { deadline: Some(Instant::now() + Duration::from_secs(600)), ..StopSignal::default() };
    assert_eq!(stop(&mesh, signal(soon)), None);
}

/// A signal that is raised after so many checks ends a mesh in its middle.
#[test]
fn a_signal_is_looked_at_within_a_mesh() {
    let folder = Folder::new("within");
    let [mesh, _] = folder.models();
    let looks = std::sync::Arc::new(std::sync::atomic::AtomicU32::new(0));
    let counted = looks.clone();
    let guard = MemoryGuard::new(move || counted.fetch_add(1, std::sync::atomic::Ordering::Relaxed) > 5);
    let memory = StopSignal { memory: Some(guard), ..StopSignal::default() };
    assert_eq!(stop(&mesh, signal(memory)), Some(LoadStop::Memory));
    assert!(looks.load(std::sync::atomic::Ordering::Relaxed) < 12, "looked on after it was raised");
}

/// How often reading checks a signal that is never raised; and that it ends at each of these checks if it is raised there.
fn stops_at_every_look(urdf: &str, srdf: Option<&str>) -> u32 {
    let read = |most: u32| {
        let looks = Arc::new(AtomicU32::new(0));
        let counted = looks.clone();
        let memory = Some(MemoryGuard::new(move || counted.fetch_add(1, Ordering::Relaxed) >= most));
        let packages = PackagePath::only(&[]).with_limits(signal(StopSignal { memory, ..StopSignal::default() }));
        let read = read_model(urdf, srdf, UpAxis::AsWritten, &packages);
        (read.err().map(|error| error.stopped), looks.load(Ordering::Relaxed))
    };
    let (whole, looks) = read(u32::MAX);
    assert_eq!(whole, None);
    for most in 0..looks {
        assert_eq!(read(most).0, Some(Some(LoadStop::Memory)), "look {most} of {looks}");
    }
    looks
}

#[test]
fn files_of_many_elements_and_numbers_are_not_read_to_their_end() {
    let folder = Folder::new("elements");
    let write = |name: &str, text: String| {
        let path = folder.0.join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let links: String = (0..9000).map(|i| format!("<link name=\"l{i}\"/>")).collect();
    let joint = |i: u32| {
        let ends = format!("<parent link=\"l{}\"/><child link=\"l{i}\"/>", i - 1);
        format!("<joint name=\"j{i}\" type=\"fixed\">{ends}</joint>")
    };
    let joints: String = (1..9000).map(joint).collect();
    let urdf = write("many.urdf", format!("<robot name=\"m\">{links}{joints}</robot>"));
    // Tags (45,000), links and joints.
    let looks = stops_at_every_look(&urdf, None);
    assert!(looks >= 14, "{looks}");
    let pairs: String = (1..9000).map(|i| format!("<disable_collisions link1=\"l0\" link2=\"l{i}\"/>")).collect();
    let srdf = write("many.srdf", format!("<robot name=\"m\">{pairs}</robot>"));
    let both = stops_at_every_look(&urdf, Some(&srdf));
    assert!(both >= looks + 4, "{both}");

    let numbers = "0 0 0 1 0 0 0 1 0 ".repeat(30_000);
    let dae = format!(
        "<COLLADA><library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array>{numbers}</float_array></source>\
         <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles><input semantic=\"VERTEX\" \
         source=\"#v\" offset=\"0\"/><p>{}</p></triangles></mesh></geometry></library_geometries></COLLADA>",
        "0 1 2 ".repeat(30_000)
    );
    write("many.dae", dae);
    let shape = "<collision><geometry><mesh filename=\"many.dae\"/></geometry></collision>";
    let urdf = write("dae.urdf", format!("<robot name=\"m\"><link name=\"a\">{shape}</link></robot>"));
    assert!(stops_at_every_look(&urdf, None) > 8);
}

/// Each step of what follows the reading of a mesh asks too: whether it is closed, and the tree over it.
#[test]
fn closedness_and_trees_are_given_up_at_every_step() {
    let folder = Folder::new("steps");
    let [urdf, _] = folder.models();
    let mut read = read_model(&urdf, None, UpAxis::AsWritten, &PackagePath::only(&[])).unwrap();
    let Geometry::Mesh(mesh) = &read.model.links[0].shapes[0].1 else { panic!("it is a mesh") };
    let asked = |most: u32, work: &dyn Fn(&dyn Fn() -> bool) -> bool| {
        let count = AtomicU32::new(0);
        let done = work(&|| count.fetch_add(1, Ordering::Relaxed) < most);
        (done, count.load(Ordering::Relaxed))
    };
    let closed = |go_on: &dyn Fn() -> bool| {
        Mesh::new_while(String::new(), mesh.vertices.clone(), mesh.triangles.clone(), go_on).is_some()
    };
    let tree = |go_on: &dyn Fn() -> bool| MeshTree::new_while(mesh, go_on).is_some();
    for (work, least) in [(&closed as &dyn Fn(&dyn Fn() -> bool) -> bool, 7), (&tree, 7)] {
        let (done, looks) = asked(u32::MAX, work);
        assert!(done && looks >= least, "{looks}");
        for most in 0..looks {
            assert_eq!(asked(most, work), (false, most + 1), "of {looks}");
        }
    }
    let whole = MeshTree::new_while(mesh, &|| true).unwrap();
    assert_eq!(format!("{:?}", whole), format!("{:?}", MeshTree::new(mesh)));
    // Tables are not built when it is too late.
    let mut problem = Scene::load("demo", &PackagePath::only(&[])).unwrap().problem;
    problem.robot = read.compose_alone().unwrap();
    let token = CancelToken::default();
    token.cancel();
    assert!(ProblemTables::new_until(problem, &StopSignal { token, ..StopSignal::default() }).is_none());
}

/// All pairs of a link with all others, for many links, over and over: what is said twice takes no time again.
#[test]
fn what_an_srdf_says_again_and_again_takes_no_time() {
    let folder = Folder::new("again");
    let shape = "<collision><geometry><sphere radius=\"1\"/></geometry></collision>";
    let links: String = (0..1200).map(|i| format!("<link name=\"l{i}\">{shape}</link>")).collect();
    let joint = |i: u32| {
        let ends = "<parent link=\"l0\"/>".to_owned() + &format!("<child link=\"l{i}\"/>");
        format!("<joint name=\"j{i}\" type=\"continuous\">{ends}</joint>")
    };
    let joints: String = (1..1200).map(joint).collect();
    let urdf = folder.0.join("again.urdf");
    std::fs::write(&urdf, format!("<robot name=\"m\">{links}{joints}</robot>")).unwrap();
    let default: String =
        (0..100_000).map(|i| format!("<disable_default_collisions link=\"l{}\"/>", i % 1200)).collect();
    let values: String = (0..100_000).map(|i| format!("<joint name=\"j{}\" value=\"0\"/>", 1 + i % 1199)).collect();
    let srdf = folder.0.join("again.srdf");
    let text = format!("<robot name=\"m\">{default}<group_state name=\"s\">{values}</group_state></robot>");
    std::fs::write(&srdf, text).unwrap();
    let started = Instant::now();
    let read = read_model(urdf.to_str().unwrap(), srdf.to_str(), UpAxis::AsWritten, &PackagePath::only(&[])).unwrap();
    assert!(started.elapsed() < Duration::from_secs(20), "{:?}", started.elapsed());
    assert_eq!(read.model.disabled_pairs.len(), 1200 * 1199 / 2);
    assert_eq!(read.model.group_states[0].values.len(), 1199);
}

#[test]
fn meshes_that_would_take_too_much_memory_are_refused_before_they_are_read() {
    let folder = Folder::new("memory");
    let [mesh, plain] = folder.models();
    let bytes = std::fs::metadata(folder.0.join("m.obj")).unwrap().len();
    let most = |mesh_bytes| LoadLimits { mesh_bytes: Some(mesh_bytes), ..LoadLimits::default() };
    assert_eq!(stop(&mesh, most(2 * bytes)), Some(LoadStop::Memory));
    assert_eq!(stop(&mesh, most(20 * bytes)), None);
    assert_eq!(stop(&plain, most(0)), None);
    let packages = PackagePath::only(&[]).with_limits(most(1 << 20));
    let error = read_model(&mesh, None, UpAxis::AsWritten, &packages).unwrap_err().to_string();
    assert!(error.contains("m.obj") && error.contains("more than the 1 MiB left"), "{error}");
}

#[cfg(unix)]
#[test]
fn pipes_devices_and_folders_are_no_models() {
    let folder = Folder::new("pipes");
    let pipe = folder.0.join("pipe.toml");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    let packages = PackagePath::only(&[]);
    for place in [pipe.to_str().unwrap(), "/dev/zero", folder.0.to_str().unwrap()] {
        let told = [
            Scene::load(place, &packages).unwrap_err().to_string(),
            Entry::load(place, &packages).unwrap_err().to_string(),
            read_model(place, None, UpAxis::AsWritten, &packages).unwrap_err().to_string(),
        ];
        assert!(told.iter().all(|t| t.contains("is not a regular file")), "{told:?}");
    }
    std::fs::rename(&pipe, folder.0.join("pipe.stl")).unwrap();
    let shape = "<collision><geometry><mesh filename=\"pipe.stl\"/></geometry></collision>";
    let urdf = folder.0.join("m.urdf");
    std::fs::write(&urdf, format!("<robot name=\"m\"><link name=\"a\">{shape}</link></robot>")).unwrap();
    let error = read_model(urdf.to_str().unwrap(), None, UpAxis::AsWritten, &packages).unwrap_err().to_string();
    assert!(error.contains("is not a regular file"), "{error}");
}
