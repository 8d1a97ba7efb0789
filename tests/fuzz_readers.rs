//! Promise: whatever a file holds, a reader refuses it or reads it: no panic, less than a second for 64 kB, bounded memory.
//!
//! A short run of each target is part of the tests. A long one of all, twenty minutes each, with another seed:
//! `FOLIATE_FUZZ_SECONDS=1200 FOLIATE_FUZZ_SEED=2 cargo test --release --test fuzz_readers -- --nocapture --test-threads 1`
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]

#[path = "common/mutate.rs"]
mod mutate;
#[allow(dead_code, reason = "this test uses its part")]
#[path = "common/timed.rs"]
mod timed;

#[path = "common/recorded.rs"]
mod recorded;

#[path = "common/written.rs"]
mod written;

use foliate::Planner;
use foliate::certify::formats::{ReadOptions, read_bytes};
use foliate::certify::{Certifier, CertifyOptions};
use foliate::check::{CheckOptions, SceneChoice, check};
use foliate::export::{ExportOptions, Format, export};
use foliate::kernels::collision::CollisionScratch;
use foliate::path_file::{LoadedPath, save};
use foliate::recording::Recording;
use foliate::scene::{MeshCache, PackagePath, Scene, UpAxis, read_model};
use mutate::fuzz;
use std::path::{Path, PathBuf};
use std::time::Duration;
use written::written;

/// A fresh folder that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("foliate-readers-{name}-{}", std::process::id()));
        let _fresh = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, content: &[u8]) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, content).unwrap();
        path.to_str().unwrap().to_owned()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The files of ours with an ending, of at most so many bytes.
fn files(folder: &str, ending: &str, most: u64) -> Vec<Vec<u8>> {
    let mut paths: Vec<_> =
        std::fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == ending) && path.metadata().unwrap().len() <= most);
    paths.sort();
    assert!(!paths.is_empty(), "{folder} has no {ending}");
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// A URDF with one mesh.
fn meshed(name: &str) -> Vec<u8> {
    format!("<robot name=\"m\"><link name=\"a\"><collision><geometry><mesh filename=\"{name}\"/></geometry></collision></link></robot>")
        .into_bytes()
}

#[test]
fn urdf() {
    let folder = Folder::new("urdf");
    let mut good = files("scenes/demo", "urdf", 64 << 10);
    good.extend(files("tests/bad_input", "urdf", 8 << 10));
    fuzz("urdf", &good, |bad| {
        drop(read_model(&folder.write("bad.urdf", bad), None, UpAxis::AsWritten, &PackagePath::default()))
    });
}

#[test]
fn srdf() {
    let folder = Folder::new("srdf");
    let urdf = folder.write("good.urdf", &std::fs::read(root().join("scenes/demo/robot.urdf")).unwrap());
    let mut good = files("scenes/demo", "srdf", 64 << 10);
    good.extend(files("tests/bad_input", "srdf", 8 << 10));
    fuzz("srdf", &good, |bad| {
        drop(read_model(&urdf, Some(&folder.write("bad.srdf", bad)), UpAxis::AsWritten, &PackagePath::default()));
    });
}

fn mesh(kind: &str, good: &[Vec<u8>]) {
    let folder = Folder::new(kind);
    let name = format!("bad.{kind}");
    let urdf = folder.write("mesh.urdf", &meshed(&name));
    fuzz(kind, good, |bad| {
        folder.write(&name, bad);
        drop(read_model(&urdf, None, UpAxis::AsWritten, &PackagePath::default()));
    });
}

/// A tetrahedron as binary STL.
fn binary_stl() -> Vec<u8> {
    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mut bytes = vec![b' '; 80];
    bytes.extend((faces.len() as u32).to_le_bytes());
    for face in faces {
        bytes.extend([0; 12]);
        bytes.extend(face.iter().flat_map(|&corner: &usize| corners[corner]).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn stl() {
    let mut good = files("tests/bad_input", "stl", 8 << 10);
    good.push(binary_stl());
    mesh("stl", &good);
}

#[test]
fn obj() {
    let mut good = files("tests/bad_input", "obj", 8 << 10);
    good.push(b"o t\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvt 0 0\ng g\nf 1 3 2\nf 1/1 2/1 4/1\nf 1//1 4//1 3//1\nf -3 -2 -1\n".to_vec());
    mesh("obj", &good);
}

#[test]
fn ply() {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
             property list uchar int vertex_indices\nend_header\n"
        )
    };
    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut little = header("binary_little_endian").into_bytes();
    little.extend(corners.iter().flatten().flat_map(|x| x.to_le_bytes()));
    little.push(3);
    little.extend([0_i32, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
    let text = header("ascii") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    mesh("ply", &[text.into_bytes(), little]);
}

/// A tetrahedron as glTF in one piece, and as text.
fn gltfs() -> [Vec<u8>; 2] {
    let bytes: Vec<u8> = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .chain([0_u8, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3])
        .collect();
    let document = |uri: &str| {
        format!(
            "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],\"nodes\":[{{\"mesh\":0,\"scale\":[1,2,3],\
             \"children\":[1]}},{{\"rotation\":[0,0,0,1],\"mesh\":0}}],\"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}},\
             \"indices\":1,\"material\":0}}]}}],\"materials\":[{{\"pbrMetallicRoughness\":{{\"baseColorFactor\":[1,0,0,1]}}}}],\
             \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}},{{\"bufferView\":1,\
             \"componentType\":5121,\"count\":12,\"type\":\"SCALAR\"}}],\"bufferViews\":[{{\"buffer\":0,\"byteLength\":48}},{{\"buffer\":0,\
             \"byteOffset\":48,\"byteLength\":12}}],\"buffers\":[{{\"byteLength\":60{uri}}}]}}"
        )
    };
    let mut json = document("").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut piece = b"glTF".to_vec();
    piece.extend(2_u32.to_le_bytes());
    piece.extend((28 + json.len() as u32 + bytes.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &bytes)] {
        piece.extend((chunk.len() as u32).to_le_bytes());
        piece.extend(kind);
        piece.extend(chunk);
    }
    let base64 = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAIBAAEDAAMCAQID";
    [piece, document(&format!(",\"uri\":\"data:application/octet-stream;base64,{base64}\"")).into_bytes()]
}

#[test]
fn gltf() {
    let [piece, text] = gltfs();
    mesh("glb", &[piece.clone(), text.clone()]);
    mesh("gltf", &[text, piece]);
}

#[test]
fn dae() {
    mesh("dae", &files("tests/bad_input", "dae", 8 << 10));
}

#[test]
fn scene() {
    let folder = root().join("scenes/demo");
    let mut good = files("scenes/demo", "toml", 64 << 10);
    good.extend(files("tests/bad_input", "toml", 8 << 10));
    good.extend(files("scenes/drawer", "toml", 64 << 10));
    fuzz("scene", &good, |bad| {
        if let Ok(text) = std::str::from_utf8(bad) {
            drop(Scene::from_text("bad", text, &folder, &PackagePath::default()));
        }
    });
}

#[test]
fn path() {
    let folder = Folder::new("path");
    let out = folder.0.join("good.json");
    let scene = Scene::load("demo", &PackagePath::default()).unwrap();
    let planner = Planner::new(scene.problem.clone()).unwrap();
    let solution = planner.solve().unwrap();
    let mut file = written(&scene, &solution.model.graph, &solution.path, &out);
    save::save(&file, &out).unwrap();
    let whole = std::fs::read(&out).unwrap();
    // A short one, of which more inputs are still JSON.
    file.segments.truncate(1);
    save::save(&file, &out).unwrap();
    let short = std::fs::read(&out).unwrap();
    let limits = |scene| CheckOptions {
        work_limit: 3000,
        time_limit: Some(Duration::from_millis(300)),
        scene,
        ..CheckOptions::default()
    };
    fuzz("path", &[short, whole], |bad| {
        let Ok(file) = save::read(Path::new(&folder.write("bad.json", bad))) else { return };
        for scene in [SceneChoice::Nothing, SceneChoice::Given("demo".into())] {
            drop(check(&file, &folder.0, &PackagePath::default(), &limits(scene)));
        }
    });
}

/// Recordings; what is read is shown.
#[test]
fn recording() {
    let solved = recorded::recorded(&recorded::planner("sequence").record().solve(), "sequence", 1);
    // Short ones, so that changes meet the head and the columns alike.
    let settings = foliate::systems::settings::SearchSettings::default().with(|s| s.max_steps = 2);
    let planner = recorded::planner("mrrt").settings(settings).record_within(24 << 10);
    let failed = recorded::recorded(&planner.solve(), "mrrt", 1);
    let good = [solved, failed].map(|recording| recording.to_bytes().unwrap());
    assert!(good[1].len() < 32 << 10);
    fuzz("recording", &good, |bad| {
        let Ok(recording) = Recording::of_bytes(Path::new("bad.search"), bad) else { return };
        drop((recording.shown(), recording.words(), recording.to_bytes()));
    });
}

/// Paths with times that `foliate export` reads, and what it writes of them.
#[test]
fn exported_path() {
    let folder = Folder::new("exported");
    let out = folder.0.join("good.json");
    let scene = Scene::load("demo", &PackagePath::default()).unwrap();
    let planner = Planner::new(scene.problem.clone()).unwrap().first_path();
    let mut solution = planner.solve().unwrap();
    timed::rest_to_rest(&scene.problem, &mut solution.path);
    let mut file = written(&scene, &solution.model.graph, &solution.path, &out);
    file.segments.truncate(3);
    save::save(&file, &out).unwrap();
    let short = std::fs::read(&out).unwrap();
    fuzz("exported path", &[short], |bad| {
        let packages = PackagePath::default();
        let Ok(file) = save::read(Path::new(&folder.write("bad.json", bad))) else { return };
        let Ok(loaded) = LoadedPath::of_file(&file, &folder.0, &packages) else { return };
        let Ok(trajectory) = loaded.trajectory() else { return };
        // Long motions take long.
        let options = ExportOptions { rate: 20.0 / trajectory.duration().max(1e-3), ..ExportOptions::default() };
        for format in [Format::RosJson, Format::RosYaml, Format::Csv, Format::Npz, Format::Mcap, Format::Glb] {
            drop(export(&loaded, format, &options, &packages));
        }
    });
}

/// The motions that `foliate certify` reads, as others write them; what is read is certified for a while.
#[test]
fn motion() {
    let scene = Scene::load("demo", &PackagePath::default()).unwrap();
    let names = "robot/left_shoulder_yaw,robot/left_elbow_pitch";
    let csv = format!("time,{names}\n0,0.1,0.2\n0.5,0.2,0.1\n1.0,0.3,-0.1\n");
    let joints = "\"joint_names\":[\"left_shoulder_yaw\",\"left_elbow_pitch\"]";
    let points = "[{\"positions\":[0.1,0.2],\"velocities\":[0,0],\"time_from_start\":{\"sec\":0,\"nanosec\":0}},\
                   {\"positions\":[0.3,0.1],\"velocities\":[0,0],\"time_from_start\":{\"sec\":1,\"nanosec\":5}}]";
    let trajectory = format!("{{{joints},\"points\":{points}}}");
    let robot = format!("{{\"joint_trajectory\":{trajectory}}}");
    let mut npy = b"\x93NUMPY\x01\x00\x76\x00{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }".to_vec();
    npy.resize(127, b' ');
    npy.push(b'\n');
    [0.1_f64, 0.2, 0.3, 0.4].iter().for_each(|number| npy.extend(number.to_le_bytes()));
    let good = [
        ("csv", csv.into_bytes()),
        ("json", trajectory.into_bytes()),
        ("json", robot.into_bytes()),
        ("path", b"0.1 0.2\n0.3 0.4\n".to_vec()),
        ("npy", npy),
    ];
    let robot = &scene.problem.robot;
    let certifier = Certifier::new(&scene.problem, &[]).unwrap();
    for (ending, good) in good {
        fuzz(&format!("motion.{ending}"), &[good], |bad| {
            let read = read_bytes(&format!("bad.{ending}"), bad.to_vec(), robot, &ReadOptions::default());
            let Ok(motion) = read else { return };
            let options = CertifyOptions { work_limit: 2000, ..CertifyOptions::default() };
            drop(certifier.certify(&motion, &options, &mut CollisionScratch::default()));
        });
    }
}

#[test]
fn cache() {
    let folder = Folder::new("cache");
    // Large enough to be kept: a grid of a thousand triangles.
    let mut obj = String::new();
    for i in 0..24 {
        (0..24).for_each(|j| obj.push_str(&format!("v {i} {j} {}\n", (i * i + j) % 5)));
    }
    for i in 0..23 {
        (1..24).for_each(|j| {
            let a = i * 24 + j;
            obj.push_str(&format!("f {a} {} {}\nf {} {} {}\n", a + 1, a + 24, a + 1, a + 25, a + 24));
        });
    }
    folder.write("grid.obj", obj.as_bytes());
    let urdf = folder.write("mesh.urdf", &meshed("grid.obj"));
    let directory = folder.0.join("kept");
    let packages = PackagePath::default().with_mesh_cache(MeshCache::in_directory(&directory));
    let read = || read_model(&urdf, None, UpAxis::AsWritten, &packages).expect("the grid is a mesh").model;
    let good = format!("{:?}", read());
    let entry = std::fs::read_dir(&directory).unwrap().map(|entry| entry.unwrap().path()).next().expect("it is kept");
    let bytes = std::fs::read(&entry).unwrap();
    fuzz("cache", &[bytes], |bad| {
        std::fs::write(&entry, bad).unwrap();
        // What is kept may be lost; it is never believed.
        assert!(format!("{:?}", read()) == good, "another mesh than that of the file");
    });
}
