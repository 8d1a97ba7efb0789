//! Promise: a glTF document may have its buffers in other files. They are read where a mesh could lie that the document's folder names, count
//! as one file with the document, and what is wrong with them is told with the file and the buffer.
#![allow(clippy::expect_used, clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]
#![cfg(unix)]

use foliate::components::robot::shape::Geometry;
use foliate::scene::{PackagePath, ReadModel, SceneError, UpAxis, read_model, sha256};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3]];
const FACES: [[u16; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let name = format!("foliate-buffers-{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path.canonicalize().unwrap())
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, content).unwrap();
        path
    }

    /// A model with a mesh `m.gltf` beside it, whose buffers are these files.
    fn read(&self, folder: &str, buffers: [&str; 2], given: &[&Path]) -> Result<ReadModel, SceneError> {
        self.write(&format!("{folder}/m.gltf"), document(buffers).to_string());
        let urdf = self.write(&format!("{folder}/m.urdf"), urdf("m.gltf"));
        let packages = PackagePath::only(&given.iter().map(|path| path.to_path_buf()).collect::<Vec<_>>());
        read_model(urdf.to_str().unwrap(), None, UpAxis::AsWritten, &packages)
    }

    fn refusal(&self, folder: &str, buffers: [&str; 2]) -> String {
        self.read(folder, buffers, &[]).map(|_| ()).expect_err("a refusal").to_string()
    }

    fn foliate(&self, arguments: &[&str]) -> (Option<i32>, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_foliate"));
        let output = command.args(arguments).arg("--no-mesh-cache").current_dir(&self.0).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code(), text(&output.stdout) + &text(&output.stderr))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

fn urdf(mesh: &str) -> String {
    let shape = format!("<collision><geometry><mesh filename=\"{mesh}\"/></geometry></collision>");
    format!("<robot name=\"m\"><link name=\"a\">{shape}</link></robot>")
}

fn points() -> Vec<u8> {
    CORNERS.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()
}

fn corners() -> Vec<u8> {
    FACES.iter().flatten().flat_map(|i| i.to_le_bytes()).collect()
}

/// A tetrahedron whose points are in one buffer and whose triangles are in the other.
fn document([points, triangles]: [&str; 2]) -> Value {
    json!({
        "asset": { "version": "2.0" }, "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" },
        ],
        "bufferViews": [{ "buffer": 0, "byteLength": 48 }, { "buffer": 1, "byteLength": 24 }],
        "buffers": [{ "byteLength": 48, "uri": points }, { "byteLength": 24, "uri": triangles }],
    })
}

fn is_the_tetrahedron(read: &ReadModel) -> bool {
    let Geometry::Mesh(mesh) = &read.model.links[0].shapes[0].1 else { panic!("a mesh") };
    let largest = mesh.vertices.iter().fold([0.0_f64; 3], |m, v| [m[0].max(v.x), m[1].max(v.y), m[2].max(v.z)]);
    let is_as_long = largest.iter().zip([0.1, 0.2, 0.3]).all(|(found, wanted)| (found - wanted).abs() < 1e-6);
    mesh.closed && mesh.triangles.len() == 4 && is_as_long
}

#[test]
fn buffers_lie_beside_the_document_below_it_or_in_it() {
    let folder = Folder::new();
    folder.write("p.bin", points());
    folder.write("data/two words.bin", corners());
    let inside = "data:application/gltf-buffer;base64,AAACAAEAAAABAAMAAAADAAIAAQACAAMA";
    for triangles in ["data/two%20words.bin", "./data/two words.bin", inside] {
        assert!(is_the_tetrahedron(&folder.read(".", ["p.bin", triangles], &[]).unwrap()), "{triangles}");
    }
    // Those of several formats may be larger than what is declared.
    folder.write("long.bin", [corners(), vec![0; 40]].concat());
    assert!(is_the_tetrahedron(&folder.read(".", ["p.bin", "long.bin"], &[]).unwrap()));
}

#[test]
fn they_lie_where_meshes_may_lie() {
    let folder = Folder::new();
    folder.write("p.bin", points());
    folder.write("model/t.bin", corners());
    let outside = folder.refusal("model", ["../p.bin", "t.bin"]);
    let told = format!("m.gltf: buffer 0: `../p.bin`: leads to {}, outside of", folder.0.join("p.bin").display());
    assert!(outside.contains(&told) && outside.contains("--package-path"), "{outside}");
    assert!(is_the_tetrahedron(&folder.read("model", ["../p.bin", "t.bin"], &[&folder.0]).unwrap()));
    let named = format!("file://{}", folder.0.join("p.bin").display());
    assert!(folder.refusal("model", [&named, "t.bin"]).contains("outside of the directories"));
    assert!(is_the_tetrahedron(&folder.read("model", [&named, "t.bin"], &[&folder.0]).unwrap()));
    std::os::unix::fs::symlink(folder.0.join("p.bin"), folder.0.join("model/link.bin")).unwrap();
    assert!(folder.refusal("model", ["link.bin", "t.bin"]).contains("`link.bin`: leads to"));
    // A package is one place.
    folder.write("package.xml", "<package format=\"3\"><name>some</name></package>");
    assert!(is_the_tetrahedron(&folder.read("model", ["../p.bin", "t.bin"], &[]).unwrap()));
}

#[test]
fn what_is_wrong_with_them_is_told_with_file_and_buffer() {
    let folder = Folder::new();
    folder.write("p.bin", points());
    folder.write("t.bin", corners());
    folder.write("short.bin", &corners()[..20]);
    std::fs::create_dir(folder.0.join("folder.bin")).unwrap();
    for (points, triangles, told) in [
        ("p.bin", "none.bin", "m.gltf: buffer 1: `none.bin`: no such file (looked in"),
        ("p.bin", "short.bin", "m.gltf: buffer 1: `short.bin` has 20 bytes, and 24 are declared"),
        ("t.bin", "t.bin", "m.gltf: buffer 0: `t.bin` has 24 bytes, and 48 are declared"),
        ("folder.bin", "t.bin", "m.gltf: buffer 0: `folder.bin`: is not a regular file"),
        ("https://example.org/p.bin", "t.bin", "buffer 0: `https://example.org/p.bin`: `https://` URLs are not read"),
        ("p%2.bin", "t.bin", "buffer 0: `p%2.bin` is no URI"),
        ("p.bin", "data:application/octet-stream;base64,!", "buffer 1: is no base64"),
        ("p.bin", "data:text/plain,abc", "buffer 1: is no base64"),
    ] {
        let refused = folder.refusal(".", [points, triangles]);
        assert!(refused.contains(told), "{told}: {refused}");
    }
    let large = std::fs::File::create(folder.0.join("large.bin")).unwrap();
    large.set_len(300 << 20).unwrap();
    let refused = folder.refusal(".", ["large.bin", "t.bin"]);
    assert!(
        refused.contains("buffer 0: `large.bin`: with this file the mesh has more than the 268435456 bytes"),
        "{refused}"
    );
}

const SLIDER: &str = "<robot name=\"r\"><link name=\"base\"/><link name=\"s\"><collision><geometry><sphere radius=\"0.05\"/></geometry></collision></link>\
    <joint name=\"j\" type=\"prismatic\"><parent link=\"base\"/><child link=\"s\"/><axis xyz=\"0 0 1\"/><limit lower=\"1\" upper=\"2\"/></joint></robot>";

#[test]
fn a_path_is_about_the_document_and_its_buffers() {
    let folder = Folder::new();
    let (points, corners) = (points(), corners());
    folder.write("m/p.bin", &points);
    folder.write("m/t.bin", &corners);
    let text = document(["p.bin", "./t.bin"]).to_string();
    folder.write("m/m.gltf", &text);
    folder.write("r.urdf", SLIDER);
    let sum = sha256(&[text.as_bytes(), &points, &corners].concat());
    let scene = format!(
        "format = \"foliate.scene/1\"\nname = \"s\"\n[[part]]\nname = \"r\"\nkind = \"robot\"\nurdf = \"r.urdf\"\n\
         [[part]]\nname = \"m\"\nkind = \"environment\"\nshape = {{ mesh = \"m/m.gltf\" }}\n[start]\n\"r/j\" = 1\n\
         [[goal]]\nconfiguration = {{ \"r/j\" = 2 }}\n[sha256]\n\"m/m.gltf\" = \"{sum}\"\n"
    );
    folder.write("scene.toml", scene);
    std::fs::create_dir(folder.0.join("out")).unwrap();
    let (code, said) = folder.foliate(&["solve", "scene.toml", "--out", "out/path.json"]);
    assert!(code == Some(0) && !said.contains("differs"), "{said}");
    // The path has the document and its buffers beside it: it is proved where the scene's are gone.
    let (code, said) = folder.foliate(&["check", "out/path.json"]);
    assert_eq!(code, Some(0), "{said}");
    let copies = ["out/path.models/m/p.bin", "out/path.models/m/t.bin"];
    assert!(copies.iter().all(|copy| folder.0.join(copy).is_file()));
    // A buffer that differs is another mesh.
    let mut other = points;
    other[12..16].copy_from_slice(&0.12_f32.to_le_bytes());
    folder.write(copies[0], other);
    let (code, said) = folder.foliate(&["check", "out/path.json"]);
    assert!(
        code == Some(1) && said.contains("`m.gltf` of m is not the file that the path was planned with"),
        "{code:?} {said}"
    );
}
