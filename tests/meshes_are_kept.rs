//! The mesh cache changes nothing but the time of loading: entries are used, wrong entries are ignored, no writer into the cache
//! changes a shape, and no disk makes a load fail.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::skip::{Needs, skipped};
use foliate::Planner;
use foliate::components::robot::shape::{Geometry, Mesh};
use foliate::scene::{MeshCache, PackagePath, ReadModel, Scene, UpAxis, read_model};
use sha2::{Digest, Sha256};
use std::collections::HashSet;
use std::fmt::Write;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

/// A directory of its own, removed at the end: models in it, and a place for a cache.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        // Thousands of entries are written whole, and a disk makes each wait; memory does not.
        let memory = Path::new("/dev/shm");
        let place = if memory.is_dir() { memory.to_owned() } else { std::env::temp_dir() };
        let path = place.join(format!("foliate-kept-{name}-{}", std::process::id()));
        let _none = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// Writes a file and a URDF whose one link has it for a shape.
    fn model(&self, mesh: &str, content: &[u8], attributes: &str) -> PathBuf {
        std::fs::write(self.0.join(mesh), content).unwrap();
        self.urdf(
            mesh,
            &format!("<collision><geometry><mesh filename=\"{mesh}\" {attributes}/></geometry></collision>"),
        )
    }

    fn urdf(&self, name: &str, collisions: &str) -> PathBuf {
        let path = self.0.join(format!("{name}.urdf"));
        std::fs::write(&path, format!("<robot name=\"m\"><link name=\"a\">{collisions}</link></robot>")).unwrap();
        path
    }

    fn cache(&self) -> PathBuf {
        self.0.join("cache")
    }

    fn kept(&self, urdf: &Path) -> ReadModel {
        read(urdf, MeshCache::in_directory(self.cache()))
    }

    fn entries(&self) -> Vec<PathBuf> {
        common::files_below(&self.cache(), "")
    }

    /// The one entry.
    fn entry(&self) -> PathBuf {
        let entries = self.entries();
        assert_eq!(entries.len(), 1, "{entries:?}");
        entries[0].clone()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

fn read(urdf: &Path, cache: impl Into<Option<MeshCache>>) -> ReadModel {
    let packages = PackagePath::default().with_mesh_cache(cache);
    read_model(urdf.to_str().unwrap(), None, UpAxis::AsWritten, &packages).unwrap_or_else(|e| panic!("{e}"))
}

fn mesh(read: &ReadModel) -> &Arc<Mesh> {
    match &read.model.links[0].shapes[0].1 {
        Geometry::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

/// Remarks that are about the cache.
fn remarks(read: &ReadModel) -> Vec<String> {
    let about = |text: &String| text.contains("kept mesh");
    read.warnings.iter().map(ToString::to_string).filter(about).collect()
}

/// All of a mesh but its record, bit for bit.
fn assert_same(one: &Mesh, other: &Mesh) {
    let bits = |mesh: &Mesh| -> Vec<_> { mesh.vertices.iter().map(|v| v.to_array().map(f64::to_bits)).collect() };
    assert_eq!(bits(one), bits(other));
    assert_eq!((&one.triangles, one.closed, &one.source), (&other.triangles, other.closed, &other.source));
}

/// A ball of rows and columns, dented at random, as binary STL: 50 bytes a triangle.
fn stl(rows: u32, columns: u32, size: f64) -> Vec<u8> {
    let point = |row: u32, column: u32| {
        let (polar, azimuth) = (f64::from(row) / f64::from(rows), f64::from(column % columns) / f64::from(columns));
        let (polar, azimuth) = (polar * std::f64::consts::PI, azimuth * std::f64::consts::TAU);
        let dent = 1.0 - 0.2 * f64::from((row * 7 + (column % columns) * 13) % 5) / 5.0;
        let radius = if row == 0 || row == rows { size } else { size * dent };
        let out = [polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos()];
        // The poles are one point each.
        let out = if row == 0 || row == rows { [0.0, 0.0, polar.cos()] } else { out };
        out.map(|x| (x * radius) as f32)
    };
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let (a, b) = (point(row, column), point(row, column + 1));
            let (c, d) = (point(row + 1, column), point(row + 1, column + 1));
            if row > 0 {
                triangles.push([a, c, b]);
            }
            if row + 1 < rows {
                triangles.push([b, c, d]);
            }
        }
    }
    let mut bytes = vec![0; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        triangle.as_flattened().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// The smallest mesh that is kept, nearly: 8.5 kB.
fn small() -> Vec<u8> {
    stl(8, 12, 0.3)
}

/// The same content with a checksum that fits it.
fn sealed(mut entry: Vec<u8>) -> Vec<u8> {
    let content = entry.len() - 32;
    let sum = Sha256::digest(&entry[..content]);
    entry[content..].copy_from_slice(&sum);
    entry
}

/// Where things are in an entry: magic, key, counts, slack, lists.
const COUNTS: usize = 40;
const SLACK: usize = COUNTS + 32;
const LISTS: usize = SLACK + 8;

fn count(entry: &[u8], place: usize) -> usize {
    let at = COUNTS + 8 * place;
    u64::from_le_bytes(entry[at..at + 8].try_into().unwrap()) as usize
}

/// Where the order of the tree begins.
fn order_of(entry: &[u8]) -> usize {
    LISTS + 4 * count(entry, 0)
}

#[test]
fn what_is_kept_is_what_the_file_says() {
    let folder = Folder::new("same");
    let mut obj = String::new();
    for i in 0..400 {
        writeln!(obj, "v {} {} {}\nv {} 0.5 1e-3\nv 0 {}e-2 1", i, i % 7, i % 11, i % 5, i).unwrap();
        writeln!(obj, "f {} {} {}", 3 * i + 1, 3 * i + 2, 3 * i + 3).unwrap();
    }
    let numbers: String = (0..2000).map(|i| format!("{}.{:03} ", i % 17, (i * 37) % 1000)).collect();
    let indices: String = (0..660).map(|i| format!("{i} ")).collect();
    let dae = format!(
        "<COLLADA><asset><unit meter=\"0.01\"/><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id=\"g\"><mesh>\
         <source id=\"p\"><float_array id=\"a\" count=\"2000\">{numbers}</float_array></source>\
         <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\
         <triangles count=\"220\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>{indices}</p></triangles>\
         </mesh></geometry></library_geometries></COLLADA>"
    );
    let files: [(&str, &[u8], &str); 5] = [
        ("ball.stl", &stl(16, 20, 0.4), ""),
        ("turned.stl", &stl(16, 20, 0.4), "scale=\"0.1 -0.2 0.3\""),
        ("large.stl", &stl(16, 20, 0.4), "scale=\"100 100 100\""),
        ("soup.obj", obj.as_bytes(), ""),
        ("parts.dae", dae.as_bytes(), ""),
    ];
    for (kept, (name, content, attributes)) in files.into_iter().enumerate() {
        let urdf = folder.model(name, content, attributes);
        let plain = read(&urdf, None);
        for _ in 0..3 {
            let read = folder.kept(&urdf);
            assert_same(mesh(&read), mesh(&plain));
            assert_eq!(read.warnings, plain.warnings, "{name}");
            assert!(mesh(&read).record.is_some());
        }
        assert_eq!(folder.entries().len(), kept + 1, "{name}");
    }
}

#[test]
fn what_is_kept_is_used() {
    let folder = Folder::new("used");
    let urdf = folder.model("m.stl", &small(), "");
    folder.kept(&urdf);
    // A record that differs and holds, with a correct seal.
    let mut entry = std::fs::read(folder.entry()).unwrap();
    let order = order_of(&entry);
    entry[order..order + 8].rotate_left(4);
    std::fs::write(folder.entry(), sealed(entry)).unwrap();
    let (plain, used) = (read(&urdf, MeshCache::in_directory(folder.0.join("other"))), folder.kept(&urdf));
    assert_eq!(remarks(&used), Vec::<String>::new());
    assert_same(mesh(&used), mesh(&plain));
    let order = |read: &ReadModel| mesh(read).record.as_ref().unwrap().order.clone();
    assert_ne!(order(&used), order(&plain));
    assert_eq!(order(&used)[0], order(&plain)[1]);
}

#[test]
fn small_meshes_are_not_kept() {
    let folder = Folder::new("small");
    let urdf = folder.model("m.stl", &stl(4, 6, 0.3), "");
    assert!(mesh(&folder.kept(&urdf)).record.is_none());
    assert!(folder.entries().is_empty());
}

/// Loads where an entry is damaged: as if there were none, but for a remark, and there is a whole one afterwards.
fn assert_mended(folder: &Folder, urdf: &Path, plain: &Mesh, whole: &[u8], what: &str) {
    let found = folder.kept(urdf);
    assert_same(mesh(&found), plain);
    assert_eq!(remarks(&found).len(), 1, "{what}: {:?}", found.warnings);
    assert!(std::fs::read(folder.entry()).unwrap() == whole, "{what}: the entry is not mended");
    let again = folder.kept(urdf);
    assert_eq!(remarks(&again), Vec::<String>::new(), "{what}");
}

#[test]
fn an_entry_with_any_byte_changed_counts_for_nothing() {
    let folder = Folder::new("flipped");
    let urdf = folder.model("m.stl", &small(), "");
    let plain = read(&urdf, None);
    folder.kept(&urdf);
    let (path, whole) = (folder.entry(), std::fs::read(folder.entry()).unwrap());
    assert!(whole.len() < 10_000, "{} bytes", whole.len());
    for at in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[at] ^= 1 << (at % 8);
        std::fs::write(&path, damaged).unwrap();
        let found = folder.kept(&urdf);
        assert_same(mesh(&found), mesh(&plain));
        assert_eq!(remarks(&found).len(), 1, "byte {at}");
        assert!(std::fs::read(&path).unwrap() == whole, "byte {at}");
    }
}

#[test]
fn an_entry_that_is_cut_off_or_goes_on_counts_for_nothing() {
    let folder = Folder::new("cut");
    let urdf = folder.model("m.stl", &small(), "");
    let plain = read(&urdf, None);
    folder.kept(&urdf);
    let (path, whole) = (folder.entry(), std::fs::read(folder.entry()).unwrap());
    let lengths = (0..200).chain((200..whole.len()).step_by(97));
    for length in lengths {
        std::fs::write(&path, &whole[..length]).unwrap();
        assert_mended(&folder, &urdf, mesh(&plain), &whole, &format!("{length} bytes"));
    }
    for more in [1, 7, 32, 4096] {
        let mut longer = whole.clone();
        longer.resize(whole.len() + more, 0);
        std::fs::write(&path, longer).unwrap();
        assert_mended(&folder, &urdf, mesh(&plain), &whole, &format!("{more} bytes more"));
    }
}

#[test]
fn a_forged_entry_is_never_believed() {
    let folder = Folder::new("forged");
    let urdf = folder.model("m.stl", &small(), "");
    let plain = read(&urdf, None);
    folder.kept(&urdf);
    let (path, whole) = (folder.entry(), std::fs::read(folder.entry()).unwrap());
    let order = order_of(&whole);
    let hull = order + 4 * count(&whole, 1);
    let near = hull + 4 * count(&whole, 2);
    let put = |at: usize, bytes: &[u8]| {
        let mut forged = whole.clone();
        forged[at..at + bytes.len()].copy_from_slice(bytes);
        sealed(forged)
    };
    let mut forgeries = vec![
        ("no slack".to_owned(), put(SLACK, &0.0_f64.to_le_bytes())),
        ("slack that is no number".into(), put(SLACK, &f64::NAN.to_le_bytes())),
        ("slack below zero".into(), put(SLACK, &(-1.0_f64).to_le_bytes())),
        ("a triangle twice".into(), put(order, &whole[order + 4..order + 8])),
        ("a triangle that does not exist".into(), put(order, &u32::MAX.to_le_bytes())),
        ("a point that does not exist".into(), put(hull, &u32::MAX.to_le_bytes())),
        ("a vertex near what does not exist".into(), put(near, &[255; 4])),
        ("something else".into(), put(0, b"something")),
    ];
    for place in 0..4 {
        for length in [1_u64 << 60, u64::MAX, 1 << 32, 0, count(&whole, place) as u64 + 1] {
            forgeries.push((format!("{length} of list {place}"), put(COUNTS + 8 * place, &length.to_le_bytes())));
        }
    }
    for (what, forged) in forgeries.into_iter().filter(|(_, forged)| *forged != whole) {
        std::fs::write(&path, forged).unwrap();
        assert_mended(&folder, &urdf, mesh(&plain), &whole, &what);
    }
}

/// The whole of an entry but its key and checksum is of another mesh, with a correct seal: the mesh is that of the file.
#[test]
fn nothing_in_an_entry_moves_a_vertex() {
    let folder = Folder::new("moved");
    let (urdf, other) = (folder.model("m.stl", &small(), ""), folder.model("o.stl", &stl(8, 12, 0.5), ""));
    let plain = read(&urdf, None);
    folder.kept(&urdf);
    let (path, whole) = (folder.entry(), std::fs::read(folder.entry()).unwrap());
    folder.kept(&other);
    let second = folder.entries().into_iter().find(|p| *p != path).unwrap();
    let mut forged = std::fs::read(&second).unwrap();
    std::fs::remove_file(&second).unwrap();
    forged[8..40].copy_from_slice(&whole[8..40]);
    std::fs::write(&path, sealed(forged)).unwrap();
    let found = folder.kept(&urdf);
    assert_same(mesh(&found), mesh(&plain));
    // An entry as the first form had it, vertices and all, is none.
    let mut first = whole.clone();
    first[7] = 1;
    std::fs::write(&path, sealed(first)).unwrap();
    assert_mended(&folder, &urdf, mesh(&plain), &whole, "the first form");
}

#[test]
fn an_entry_of_another_mesh_counts_for_nothing() {
    let folder = Folder::new("other");
    let one = folder.model("one.stl", &small(), "");
    folder.kept(&one);
    let first = folder.entry();
    let whole = std::fs::read(&first).unwrap();
    let other = folder.model("other.stl", &stl(8, 12, 0.4), "");
    folder.kept(&other);
    let second = folder.entries().into_iter().find(|path| *path != first).unwrap();
    std::fs::copy(&second, &first).unwrap();
    let found = folder.kept(&one);
    assert_same(mesh(&found), mesh(&read(&one, None)));
    assert_eq!(remarks(&found).len(), 1);
    assert!(std::fs::read(&first).unwrap() == whole);
}

#[test]
fn a_file_that_changes_is_another_mesh() {
    let folder = Folder::new("changes");
    let urdf = folder.model("m.stl", &small(), "");
    folder.kept(&urdf);
    folder.model("m.stl", &stl(8, 12, 0.31), "");
    let found = folder.kept(&urdf);
    assert_same(mesh(&found), mesh(&read(&urdf, None)));
    assert_eq!(remarks(&found), Vec::<String>::new());
    assert_eq!(folder.entries().len(), 2);
    // A file that is damaged is refused, whatever is kept of it as it was.
    std::fs::write(folder.0.join("m.stl"), &small()[..9000 - 700]).unwrap();
    let packages = PackagePath::default().with_mesh_cache(MeshCache::in_directory(folder.cache()));
    assert!(read_model(urdf.to_str().unwrap(), None, UpAxis::AsWritten, &packages).is_err());
}

#[test]
fn a_disk_that_refuses_fails_no_load() {
    let folder = Folder::new("refuses");
    let urdf = folder.model("m.stl", &small(), "");
    let plain = read(&urdf, None);
    // No directory, for there is a file in its place.
    std::fs::write(folder.0.join("file"), b"").unwrap();
    for place in [folder.0.join("file"), folder.0.join("file/below"), PathBuf::from("/proc/foliate-cache")] {
        let found = read(&urdf, MeshCache::in_directory(&place));
        assert_same(mesh(&found), mesh(&plain));
        assert_eq!(remarks(&found), Vec::<String>::new(), "{}", place.display());
    }
    // A directory in the place of the entry.
    folder.kept(&urdf);
    let entry = folder.entry();
    std::fs::remove_file(&entry).unwrap();
    std::fs::create_dir(&entry).unwrap();
    let found = folder.kept(&urdf);
    assert_same(mesh(&found), mesh(&plain));
    assert_eq!(remarks(&found).len(), 1);
    let left: Vec<_> = std::fs::read_dir(folder.cache()).unwrap().map(|e| e.unwrap().path()).collect();
    assert_eq!(left, [entry], "what was begun is left");
}

#[test]
fn several_writers_do_not_disturb_each_other() {
    let folder = Folder::new("writers");
    let models: Vec<_> =
        (0..6_u8).map(|i| folder.model(&format!("{i}.stl"), &stl(8, 12, 0.3 + 0.01 * f64::from(i)), "")).collect();
    let plain: Vec<_> = models.iter().map(|urdf| read(urdf, None)).collect();
    // Less than all of them take: entries go while others are read and written.
    let cache = MeshCache::in_directory(folder.cache()).at_most(5_000);
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let (models, plain, cache) = (&models, &plain, &cache);
            scope.spawn(move || {
                for round in 0..60 {
                    let model = (thread + round) % models.len();
                    let found = read(&models[model], cache.clone());
                    assert_same(mesh(&found), mesh(&plain[model]));
                    assert_eq!(remarks(&found), Vec::<String>::new());
                }
            });
        }
    });
    assert!(
        folder.entries().iter().all(|path| path.extension().is_some_and(|e| e == "mesh")),
        "{:?}",
        folder.entries()
    );
}

#[test]
fn the_oldest_go_first_and_what_is_not_ours_stays() {
    let folder = Folder::new("oldest");
    std::fs::create_dir(folder.cache()).unwrap();
    let others = ["notes.txt", "a.mesh", &format!("{}.mesh.bak", "0".repeat(64))].map(|name| folder.cache().join(name));
    others.iter().for_each(|path| std::fs::write(path, vec![0; 50_000]).unwrap());
    // Left behind by a process that was stopped while writing.
    let begun = [".", ""].map(|dot| folder.cache().join(format!("{dot}{}.mesh.1-0.unfinished", "0".repeat(64))));
    for begun in &begun {
        std::fs::write(begun, vec![0; 1000]).unwrap();
        let old = std::time::SystemTime::now() - std::time::Duration::from_secs(1_000_000);
        std::fs::File::options().write(true).open(begun).unwrap().set_modified(old).unwrap();
    }
    let mut sizes = Vec::new();
    for i in 0..5_u8 {
        let urdf = folder.model(&format!("{i}.stl"), &stl(8, 12, 0.3 + 0.01 * f64::from(i)), "");
        let most = 3 * sizes.first().copied().unwrap_or(100_000) + 500;
        read(&urdf, MeshCache::in_directory(folder.cache()).at_most(most));
        sizes = folder.entries().iter().filter(|p| !others.contains(p)).map(|p| p.metadata().unwrap().len()).collect();
        sizes.retain(|&size| size != 1000);
        assert_eq!(sizes.len(), usize::from(i + 1).min(3), "{sizes:?}");
    }
    assert!(others.iter().all(|path| path.exists()) && !begun.iter().any(|path| path.exists()));
}

/// An entry that is a link is replaced; nothing is written through it.
#[cfg(unix)]
#[test]
fn what_an_entry_links_to_is_left_alone() {
    let folder = Folder::new("linked");
    let urdf = folder.model("a.stl", &stl(8, 12, 0.3), "");
    folder.kept(&urdf);
    let (entry, other) = (folder.entry(), folder.0.join("other.txt"));
    let whole = std::fs::read(&entry).unwrap();
    std::fs::write(&other, "theirs").unwrap();
    std::fs::remove_file(&entry).unwrap();
    std::os::unix::fs::symlink(&other, &entry).unwrap();
    folder.kept(&urdf);
    assert_eq!(std::fs::read_to_string(&other).unwrap(), "theirs");
    assert!(!std::fs::symlink_metadata(&entry).unwrap().is_symlink() && std::fs::read(&entry).unwrap() == whole);
}

/// On a full disk nothing is kept, and nothing is said or left behind.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_a_miss() {
    let folder = Folder::new("full");
    std::fs::create_dir(folder.cache()).unwrap();
    let at = folder.cache();
    let system = |command: &str, arguments: &[&str]| {
        let status = Command::new(command).args(arguments).arg(&at).stderr(std::process::Stdio::null()).status();
        status.is_ok_and(|status| status.success())
    };
    if !system("mount", &["-t", "tmpfs", "-o", "size=16k", "none"]) {
        skipped(Needs::System, "a_full_disk_is_a_miss", "mount is not allowed");
        return;
    }
    let urdf = folder.model("a.stl", &stl(40, 80, 0.3), "");
    let (found, plain) = (folder.kept(&urdf), read(&urdf, None));
    let entries = folder.entries();
    assert!(system("umount", &[]));
    assert_same(mesh(&found), mesh(&plain));
    assert_eq!(remarks(&found), Vec::<String>::new());
    assert_eq!(entries, Vec::<PathBuf>::new());
}

#[test]
fn one_load_of_hundreds_of_meshes_finds_them_all() {
    let folder = Folder::new("hundreds");
    let mut collisions = String::new();
    for i in 0..300_u32 {
        std::fs::write(folder.0.join(format!("{i}.stl")), stl(8, 12, 0.3 + 0.001 * f64::from(i))).unwrap();
        write!(collisions, "<collision><geometry><mesh filename=\"{i}.stl\"/></geometry></collision>").unwrap();
    }
    let urdf = folder.urdf("all", &collisions);
    folder.kept(&urdf);
    let entries = folder.entries();
    assert_eq!(entries.len(), 300);
    let written = || -> Vec<_> { entries.iter().map(|path| path.metadata().unwrap().modified().unwrap()).collect() };
    let before = written();
    let found = folder.kept(&urdf);
    assert_eq!(remarks(&found), Vec::<String>::new());
    assert!(before == written(), "entries are written again");
    let plain = read(&urdf, None);
    for (one, other) in found.model.links[0].shapes.iter().zip(&plain.model.links[0].shapes) {
        let (Geometry::Mesh(one), Geometry::Mesh(other)) = (&one.1, &other.1) else { panic!("no meshes") };
        assert_same(one, other);
    }
}

/// Nothing is written for a host that did not ask; the command line keeps meshes unless told not to.
#[test]
fn who_does_not_want_it_has_none() {
    let folder = Folder::new("wanted");
    let urdf = folder.model("m.stl", &small(), "");
    let inspect = |options: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_foliate"))
            .args(options)
            .arg("inspect")
            .arg(&urdf)
            .env("FOLIATE_MESH_CACHE", folder.cache())
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    let plain = inspect(&["--no-mesh-cache"]);
    assert!(!folder.cache().exists());
    let first = inspect(&[]);
    assert_eq!(folder.entries().len(), 1);
    let packages = PackagePath::from_environment(&[]);
    assert!(packages.mesh_cache().is_none());
    assert_eq!((&first, &inspect(&[])), (&plain, &plain));
}

#[test]
fn all_published_models_are_kept_as_they_are_read() {
    let Some(packages) = common::published_models("all_published_models_are_kept_as_they_are_read") else { return };
    let folder = Folder::new("published");
    let cached = packages.clone().with_mesh_cache(MeshCache::in_directory(folder.cache()));
    let meshes = |read: &ReadModel| -> Vec<Arc<Mesh>> {
        let shapes = read.model.links.iter().flat_map(|link| &link.shapes);
        shapes.filter_map(|(_, s)| if let Geometry::Mesh(mesh) = s { Some(mesh.clone()) } else { None }).collect()
    };
    let (mut compared, mut kept, mut seen) = (0, 0, HashSet::new());
    for package in common::PACKAGES {
        for urdf in common::files_below(&packages.find(package).unwrap(), ".urdf") {
            let name = urdf.to_string_lossy();
            let Ok(plain) = read_model(&name, None, UpAxis::AsWritten, &packages) else { continue };
            let (warnings, plain) = (&plain.warnings, meshes(&plain));
            // Variants of one robot share their meshes: those that have been compared are not compared again.
            if plain.iter().filter(|mesh| seen.insert(fingerprint(mesh))).count() == 0 {
                continue;
            }
            for _ in 0..2 {
                let read = read_model(&name, None, UpAxis::AsWritten, &cached).unwrap_or_else(|e| panic!("{e}"));
                assert_eq!(&read.warnings, warnings);
                let read = meshes(&read);
                assert_eq!(read.len(), plain.len());
                read.iter().zip(&plain).for_each(|(read, plain)| assert_same(read, plain));
                compared += read.len();
                kept += read.iter().filter(|mesh| mesh.record.is_some()).count();
            }
        }
    }
    assert!(seen.len() > 100 && kept > compared / 2, "{kept} of {compared} are kept, {} meshes in all", seen.len());
    assert!(folder.entries().len() > 100, "{}", folder.entries().len());
}

/// A hash of all coordinates and triangles.
fn fingerprint(mesh: &Mesh) -> u64 {
    let mut hasher = DefaultHasher::new();
    mesh.vertices.iter().for_each(|vertex| vertex.to_array().map(f64::to_bits).hash(&mut hasher));
    mesh.triangles.hash(&mut hasher);
    hasher.finish()
}

#[test]
fn searches_are_the_same_with_it_and_without() {
    let Some(packages) = common::published_models("searches_are_the_same_with_it_and_without") else { return };
    let folder = Folder::new("search");
    let kept = packages.clone().with_mesh_cache(MeshCache::in_directory(folder.cache()));
    let hash = |packages: &PackagePath| {
        let scene = Scene::load("ur3-spheres", packages).unwrap_or_else(|e| panic!("{e}"));
        let solution = Planner::new(scene.problem).unwrap().seed(3).solve().unwrap();
        (solution.report.fingerprint, solution.report.candidates)
    };
    let plain = hash(&packages);
    assert_eq!(hash(&kept), plain, "the first time");
    assert!(!folder.entries().is_empty());
    assert_eq!(hash(&kept), plain, "from what is kept");
}
