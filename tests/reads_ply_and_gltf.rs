//! Promise: PLY and glTF meshes mean what their formats say: text and both orders of bytes, strips and fans, node transforms, colours;
//! and what they cannot mean is refused with a place.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate::components::robot::shape::{Geometry, Mesh};
use foliate::scene::{PackagePath, Scene, SceneError, UpAxis, Visuals, read_model};
use glam::DVec3;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("foliate-plygltf-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

fn read(name: &str, content: &[u8], up_axis: UpAxis) -> Result<Arc<Mesh>, SceneError> {
    let folder = Folder::new();
    std::fs::write(folder.0.join(name), content).unwrap();
    let urdf = folder.0.join("m.urdf");
    let shape = format!("<collision><geometry><mesh filename=\"{name}\"/></geometry></collision>");
    std::fs::write(&urdf, format!("<robot name=\"m\"><link name=\"a\">{shape}</link></robot>")).unwrap();
    let read = read_model(urdf.to_str().unwrap(), None, up_axis, &PackagePath::only(&[]))?;
    match &read.model.links[0].shapes[0].1 {
        Geometry::Mesh(mesh) => Ok(mesh.clone()),
        other => panic!("{other:?}"),
    }
}

fn mesh(name: &str, content: &[u8]) -> Arc<Mesh> {
    read(name, content, UpAxis::AsWritten).unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(name: &str, content: &[u8]) -> String {
    read(name, content, UpAxis::AsWritten).expect_err("a refusal").to_string()
}

fn assert_bounds(mesh: &Mesh, low: [f64; 3], high: [f64; 3]) {
    let corner = |fold: fn(DVec3, DVec3) -> DVec3| mesh.vertices.iter().copied().reduce(fold).unwrap();
    let (l, h) = (corner(DVec3::min), corner(DVec3::max));
    assert!(l.distance(low.into()).max(h.distance(high.into())) < 1e-6, "{l} {h}");
}

/// Six times the volume that closed triangles bound; positive where they are counter-clockwise from outside.
fn volume(mesh: &Mesh) -> f64 {
    let at = |i: u32| mesh.vertices[i as usize];
    mesh.triangles.iter().map(|&[a, b, c]| at(a).dot(at(b).cross(at(c)))).sum()
}

/// A tetrahedron with corners at 0, x = 1, y = 2, z = 3.
const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn header(format: &str, list: &str) -> String {
    format!(
        "ply\r\nformat {format} 1.0\ncomment made here\nelement camera 1\nproperty list uchar float view\nelement nothing 4000000000\n\
         element vertex 4\nproperty uchar red\nproperty double x\nproperty float y\nproperty short z\n\
         element face 4\nproperty list uchar int {list}\nproperty uchar flags\nend_header\n"
    )
}

#[test]
fn the_three_forms_of_ply_read_alike() {
    let mut text = header("ascii", "vertex_indices") + "2 0.5 0.5\n";
    CORNERS.iter().for_each(|c| text += &format!("255 {} {:e} {}\n", c[0], c[1], c[2]));
    FACES.iter().for_each(|f| text += &format!("3 {} {} {} 7\n", f[0], f[1], f[2]));
    let mut files = vec![("t.ply", text.into_bytes())];
    for (name, format, turn) in [("l.PLY", "binary_little_endian", false), ("b.ply", "binary_big_endian", true)] {
        let mut bytes = header(format, "vertex_index").into_bytes();
        let mut push = |number: &[u8]| match turn {
            true => bytes.extend(number.iter().rev()),
            false => bytes.extend(number),
        };
        push(&[1]);
        push(&0.5_f32.to_le_bytes());
        for [x, y, z] in CORNERS {
            push(&[255]);
            push(&f64::from(x).to_le_bytes());
            push(&y.to_le_bytes());
            push(&(z as i16).to_le_bytes());
        }
        for face in FACES {
            push(&[3]);
            face.iter().for_each(|corner| push(&(*corner as i32).to_le_bytes()));
            push(&[7]);
        }
        files.push((name, bytes));
    }
    for (name, content) in files {
        let mesh = mesh(name, &content);
        assert!(mesh.closed && mesh.triangles.len() == 4, "{name}");
        assert_bounds(&mesh, [0.0; 3], [1.0, 2.0, 3.0]);
        assert!((volume(&mesh) - 6.0).abs() < 1e-12, "{name}");
        // What is cut off is told, not read.
        let cut = refusal(name, &content[..content.len() - 3]);
        assert!(cut.contains("face 3: is missing: the file is cut off"), "{name}: {cut}");
    }
    // Faces with four corners, and numbers below zero.
    let square = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                  property list int int vertex_indices\nend_header\n-1 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
    assert_eq!(mesh("q.ply", square.as_bytes()).triangles.len(), 2);
}

#[test]
fn plys_that_lie_are_refused_with_a_place() {
    let good = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    assert_eq!(mesh("g.ply", good.as_bytes()).triangles.len(), 1);
    for (from, to, says) in [
        ("ply\n", "play\n", "b.ply:1: header: a PLY begins with the line `ply`"),
        ("ascii", "octal", "b.ply:2: header: `octal` is no format"),
        ("vertex 3", "vertex 4000000000", "vertex 0: declares 4000000000 of them, which do not fit into the file"),
        ("vertex 3", "vertex -3", "b.ply:3: header: `-3` is no count"),
        ("float x", "float u", "has no coordinates x, y and z"),
        ("float x", "word x", "b.ply:4: header: `word` is no kind of number"),
        ("uchar int", "float int", "the length of a list is a whole number"),
        ("vertex_indices", "corners", "has no list `vertex_indices`"),
        ("end_header\n", "", "is no word of a header"),
        ("1 0 0", "nan 0 0", "b.ply:11: vertex 1: is not finite"),
        ("1 0 0", "one 0 0", "vertex 1: `one` is not a number"),
        ("3 0 1 2", "3 0 1 3", "b.ply:13: face 0: names vertex 3, 3 are known so far"),
        ("3 0 1 2", "3 0 1 -1", "face 0: names vertex -1"),
        ("3 0 1 2", "90000 0 1", "face 0: a list of 90000 numbers; at most 4096 are read"),
        ("3 0 1 2", "2 0 1", "has no triangles"),
    ] {
        let said = refusal("b.ply", good.replacen(from, to, 1).as_bytes());
        assert!(said.contains(says), "{to}: {said}");
    }
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let bits = group.iter().fold(0_u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - group.len()));
        (0..4).for_each(|k| {
            text.push(if k <= group.len() { LETTERS[(bits >> (18 - 6 * k) & 63) as usize] as char } else { '=' })
        });
    }
    text
}

/// The positions, then the faces as 16-bit numbers.
fn bytes() -> Vec<u8> {
    let positions = CORNERS.iter().flatten().flat_map(|x| x.to_le_bytes());
    positions.chain(FACES.iter().flatten().flat_map(|&i| (i as u16).to_le_bytes())).collect()
}

/// A scene of the tetrahedron twice: once scaled by 2 along z, turned by 90° about z (x to y, y to −x) and moved by 10 along x, and once
/// mirrored and moved by −5. One of them is blue.
fn document() -> Value {
    json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0, 2] }],
        "nodes": [
            { "translation": [10.0, 0.0, 0.0], "rotation": [0.0, 0.0, 0.5f64.sqrt(), 0.5f64.sqrt()], "scale": [1.0, 1.0, 2.0], "children": [1] },
            { "mesh": 0, "name": "within" },
            { "matrix": [-1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -5.0, 0.0, 0.0, 1.0], "mesh": 1 },
        ],
        "meshes": [
            { "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 0 }, "indices": 1, "material": 0 }, { "attributes": { "POSITION": 0 }, "mode": 1 }] },
            { "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] },
        ],
        "materials": [{ "pbrMetallicRoughness": { "baseColorFactor": [0.0, 0.0, 1.0, 1.0] } }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 2, 3] },
            { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" },
        ],
        "bufferViews": [{ "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 24 }],
        "buffers": [{ "byteLength": 72 }],
    })
}

/// In one piece.
fn glb(document: &Value, bytes: &[u8]) -> Vec<u8> {
    let mut json = serde_json::to_vec(document).unwrap();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut file = b"glTF".to_vec();
    let chunks = [(json.as_slice(), b"JSON"), (bytes, b"BIN\0")];
    let length = 12 + chunks.iter().map(|(chunk, _)| 8 + chunk.len()).sum::<usize>();
    [2, length as u32].iter().for_each(|number| file.extend(number.to_le_bytes()));
    for (chunk, kind) in chunks {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

/// As text.
fn gltf(document: &Value) -> Vec<u8> {
    let mut document = document.clone();
    document["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{}", base64(&bytes())).into();
    serde_json::to_vec_pretty(&document).unwrap()
}

#[test]
fn scenes_of_gltf_are_placed_by_their_nodes() {
    for (name, content) in [("s.glb", glb(&document(), &bytes())), ("s.gltf", gltf(&document()))] {
        let read_as = |up_axis| read(name, &content, up_axis).unwrap_or_else(|error| panic!("{error}"));
        let mesh = read_as(UpAxis::AsWritten);
        assert_eq!((mesh.triangles.len(), mesh.closed), (8, true), "{name}");
        assert_bounds(&mesh, [-6.0, 0.0, 0.0], [10.0, 2.0, 6.0]);
        assert!((volume(&mesh) - (12.0 + 6.0)).abs() < 1e-5, "{name}: the mirrored one is turned inside out");
        // Its y points up.
        assert_bounds(&read_as(UpAxis::Declared), [-6.0, -6.0, 0.0], [10.0, 0.0, 2.0]);
    }
    // Without nodes the meshes stand where they are described; without a scene all nodes are shown that are children of none.
    let mut plain = document();
    plain.as_object_mut().unwrap().retain(|key, _| !matches!(key.as_str(), "scene" | "scenes"));
    assert_eq!(mesh("p.glb", &glb(&plain, &bytes())).triangles.len(), 8);
    plain.as_object_mut().unwrap().remove("nodes");
    plain["meshes"].as_array_mut().unwrap().truncate(1);
    let alone = mesh("p.glb", &glb(&plain, &bytes()));
    assert_bounds(&alone, [0.0; 3], [1.0, 2.0, 3.0]);
}

#[test]
fn strips_and_fans_are_triangles() {
    let mut square = document();
    square.as_object_mut().unwrap().remove("nodes");
    square["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0 } }] }]);
    let bytes: Vec<u8> = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
        .iter()
        .flat_map(|&[x, y]| [x, y, 0.0_f32])
        .flat_map(f32::to_le_bytes)
        .collect();
    for (mode, area) in [(5, 2.0), (6, 0.0)] {
        square["meshes"][0]["primitives"][0]["mode"] = mode.into();
        let mesh = mesh("m.glb", &glb(&square, &[bytes.clone(), vec![0; 24]].concat()));
        assert_eq!(mesh.triangles.len(), 2, "{mode}");
        let at = |i: u32| mesh.vertices[i as usize];
        let turned: f64 = mesh.triangles.iter().map(|&[a, b, c]| (at(b) - at(a)).cross(at(c) - at(a)).z).sum();
        assert_eq!(turned, area, "{mode}: in a strip both turn the same way, of this fan the second is folded back");
    }
}

#[test]
fn colours_of_gltf_are_seen() {
    let folder = Folder::new();
    std::fs::write(folder.0.join("s.glb"), glb(&document(), &bytes())).unwrap();
    let shape = |tag: &str| format!("<{tag}><geometry><mesh filename=\"s.glb\"/></geometry></{tag}>");
    let link = format!("<link name=\"base\"/><link name=\"a\">{}{}</link>", shape("visual"), shape("collision"));
    let joint = "<joint name=\"j\" type=\"prismatic\"><parent link=\"base\"/><child link=\"a\"/><limit lower=\"0\" upper=\"1\"/></joint>";
    std::fs::write(folder.0.join("m.urdf"), format!("<robot name=\"m\">{link}{joint}</robot>")).unwrap();
    let text = "format = \"foliate.scene/1\"\nname = \"s\"\n[[part]]\nname = \"m\"\nkind = \"robot\"\nurdf = \"m.urdf\"\n[start]\n[[goal]]\n\
                configuration = { \"m/j\" = 0.5 }\n[graph]\n";
    let scene = Scene::from_text("s", text, &folder.0, &PackagePath::only(&[])).unwrap();
    let visuals = Visuals::of_scene(&scene, &PackagePath::only(&[])).unwrap();
    let mut colors: Vec<_> = visuals.links.iter().flatten().map(|visual| visual.color).collect();
    colors.sort_by_key(|color| color.is_some());
    assert_eq!(colors, [None, Some([0.0, 0.0, 1.0, 1.0])]);
}

#[test]
fn gltfs_that_lie_are_refused_with_a_place() {
    let lie = |change: &dyn Fn(&mut Value)| {
        let mut document = document();
        change(&mut document);
        refusal("b.glb", &glb(&document, &bytes()))
    };
    let said = lie(&|d| d["accessors"][0]["count"] = 4_000_000_000_u64.into());
    assert!(said.contains("b.glb: mesh 0: accessor 0 reaches beyond its buffer"), "{said}");
    for (pointer, value, says) in [
        ("/accessors/0/byteOffset", json!(u64::MAX), "accessor 0 reaches beyond its buffer"),
        ("/bufferViews/0/byteStride", json!(0), "accessor 0 reaches beyond its buffer"),
        ("/bufferViews/0/byteStride", json!(u64::MAX), "accessor 0 reaches beyond its buffer"),
        ("/bufferViews/0/byteLength", json!(u64::MAX), "accessor 0 reaches beyond its buffer"),
        ("/bufferViews/0/buffer", json!(7), "names a view or a buffer that is not there"),
        ("/accessors/0/bufferView", json!(7), "names a view or a buffer that is not there"),
        ("/accessors/0/bufferView", json!(null), "accessor 0 has no data of its own"),
        ("/accessors/0/sparse", json!({ "count": 1 }), "or sparse data, which are not read"),
        ("/accessors/0/componentType", json!(5123), "has numbers of the kind 5123"),
        ("/accessors/0/type", json!("VEC2"), "accessor 0 holds VEC2, not VEC3"),
        ("/accessors/1/count", json!(13), "accessor 1 reaches beyond its buffer"),
        ("/meshes/0/primitives/0/indices", json!(9), "accessor 9 is named and not there"),
        ("/nodes/1/mesh", json!(9), "mesh 9: is named, there are 2"),
        ("/nodes/0/children", json!([0, 0]), "the scene unfolds into too many nodes"),
        ("/nodes/0/children", json!([5]), "node 5: is named, there are 3"),
        ("/nodes/0/rotation", json!([0, 0, 0, 0]), "node 0: its rotation has no length"),
        ("/nodes/0/scale", json!([1e308, 1e308, 1e308]), "is not finite where it is placed"),
        ("/scene", json!(4), "names scene 4, there are 1"),
        ("/buffers/0", json!({ "byteLength": 72, "uri": "b.bin" }), "buffer 0: `b.bin`: no such file"),
        ("/buffers/0", json!({ "byteLength": 72, "uri": "data:a;base64,***" }), "buffer 0: is no base64"),
        ("/buffers", json!([{}, {}]), "buffer 1: has no bytes"),
        ("/meshes/0/primitives", json!("all"), "b.glb:1: document: invalid type"),
    ] {
        let said = lie(&|document| match document.pointer_mut(pointer) {
            Some(place) => *place = value.clone(),
            None => {
                let (parent, key) = pointer.rsplit_once('/').unwrap();
                document.pointer_mut(parent).unwrap()[key] = value.clone();
            }
        });
        assert!(said.contains(says), "{pointer} {value}: {said}");
    }
    let said = lie(&|d| d["extensionsRequired"] = json!(["KHR_materials_unlit", "KHR_draco_mesh_compression"]));
    assert!(said.contains("needs the extension `KHR_draco_mesh_compression`"), "{said}");
    // Indices beyond the vertices, which the format cannot rule out.
    let mut beyond = bytes();
    beyond[48] = 4;
    assert!(refusal("b.glb", &glb(&document(), &beyond)).contains("mesh 0: names vertex 4, there are 4"));
    let whole = glb(&document(), &bytes());
    for (length, says) in [
        (6, "header: is cut off"),
        (12, "has no document"),
        (18, "chunk: is cut off"),
        (whole.len() - 1, "more than the file"),
    ] {
        let said = refusal("b.glb", &whole[..length]);
        assert!(said.contains(says), "{length}: {said}");
    }
    let mut old = whole;
    old[4] = 1;
    assert!(refusal("b.glb", &old).contains("is of version 1, 2 is read"));
    let many = format!("{{\"asset\":{{}},\"nodes\":[{}{{}}]}}", "{},".repeat(400_000));
    assert!(refusal("b.gltf", many.as_bytes()).contains("more than 400000 objects"));
}
