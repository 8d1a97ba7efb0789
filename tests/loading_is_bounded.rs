//! Loading ends where its host says: at a deadline, a token, or an amount of memory; and takes regular files only.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate::batch::Entry;
use foliate::scene::{LoadLimits, LoadStop, PackagePath, UpAxis, load_scene, read_model};
use foliate::systems::events::{CancelToken, MemoryGuard, StopSignal};
use std::fmt::Write;
use std::path::PathBuf;
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

/// A signal that is raised after so many looks at it ends a mesh in its middle.
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
            load_scene(place, &packages).unwrap_err().to_string(),
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
