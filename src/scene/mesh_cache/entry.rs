//! One mesh as bytes. Little endian: `MAGIC`, the key, five counts and a flag (`u64` each), the hull's slack, vertices (three `f64`),
//! triangles (three `u32`), the record's lists, and the SHA-256 of all that.

use super::Key;
use crate::scene::mesh::TRIANGLES;
use foliate_components::robot::mesh_record::MeshRecord;
use foliate_components::robot::shape::Mesh;
use foliate_kernels::collision::mesh_record::proves;
use glam::DVec3;
use sha2::{Digest, Sha256};

/// Counts changes of the form. It is part of the key.
pub(super) const VERSION: u32 = 1;
const MAGIC: [u8; 8] = *b"foliate\x01";
const CHECKSUM: usize = 32;
/// Magic, key, counts and flag, slack.
const HEADER: usize = 8 + 32 + 6 * 8 + 8;

/// The bytes of a mesh; none where it has no record.
pub(super) fn write(key: &Key, mesh: &Mesh) -> Option<Vec<u8>> {
    let record = mesh.record.as_ref()?;
    let counts = Counts::of(mesh, record);
    let mut bytes = Vec::with_capacity(counts.bytes()? as usize);
    bytes.extend(MAGIC);
    bytes.extend(key.0);
    bytes.extend(counts.0.iter().chain([&u64::from(mesh.closed)]).flat_map(|n| n.to_le_bytes()));
    bytes.extend(record.slack.to_bits().to_le_bytes());
    for vertex in &mesh.vertices {
        vertex.to_array().iter().for_each(|x| bytes.extend(x.to_bits().to_le_bytes()));
    }
    for list in [mesh.triangles.as_flattened(), &record.same, &record.order, &record.hull] {
        list.iter().for_each(|i| bytes.extend(i.to_le_bytes()));
    }
    bytes.extend(record.near.as_flattened());
    let sum = Sha256::digest(&bytes);
    bytes.extend(sum);
    Some(bytes)
}

/// The mesh that bytes hold.
///
/// # Errors
/// What is wrong with them.
pub(super) fn read(bytes: &[u8], key: &Key, source: &str) -> Result<Mesh, &'static str> {
    let (counts, closed, slack) = header(bytes, key)?;
    let (content, sum) = bytes.split_at(bytes.len() - CHECKSUM);
    if Sha256::digest(content).as_slice() != sum {
        return Err("its checksum is another");
    }
    let [vertices, triangles, same, hull, near] = counts.0.map(|count| count as usize);
    let mut rest = &content[HEADER..];
    let vertices = lists::<24, _>(&mut rest, vertices, |b| DVec3::from_array(std::array::from_fn(|i| float(b, i))));
    let triangles = lists::<12, _>(&mut rest, triangles, |b| std::array::from_fn(|i| integer(b, i)));
    let same = lists::<4, _>(&mut rest, same, |b| integer(b, 0));
    let order = lists::<4, _>(&mut rest, triangles.len(), |b| integer(b, 0));
    let hull = lists::<4, _>(&mut rest, hull, |b| integer(b, 0));
    let near = lists::<4, _>(&mut rest, near, |b| *b);
    let record = MeshRecord { same, order, hull, near, slack };
    let mesh = Mesh { source: source.to_owned(), vertices, triangles, closed, record: None };
    match proves(&mesh, &record) {
        true => Ok(Mesh { record: Some(record), ..mesh }),
        false => Err("what it says of the mesh does not hold"),
    }
}

/// Counts, whether the mesh is closed, and the slack; the counts are those of a file that long.
fn header(bytes: &[u8], key: &Key) -> Result<(Counts, bool, f64), &'static str> {
    if bytes.len() < HEADER + CHECKSUM {
        return Err("it is cut off");
    }
    if bytes[..8] != MAGIC {
        return Err("it is no mesh of this program");
    }
    if bytes[8..40] != key.0 {
        return Err("it is of another mesh");
    }
    let word = |i: usize| u64::from_le_bytes(std::array::from_fn(|b| bytes[40 + 8 * i + b]));
    let counts = Counts(std::array::from_fn(word));
    if counts.bytes() != Some(bytes.len() as u64) {
        return Err("it is not as long as it says");
    }
    let closed = match word(5) {
        0 => false,
        1 => true,
        _ => return Err("it is neither open nor closed"),
    };
    Ok((counts, closed, f64::from_bits(word(6))))
}

/// Vertices, triangles, first vertices at a position, points of the hull, places near vertices.
#[derive(Clone, Copy)]
struct Counts([u64; 5]);

impl Counts {
    fn of(mesh: &Mesh, record: &MeshRecord) -> Self {
        let counts =
            [mesh.vertices.len(), mesh.triangles.len(), record.same.len(), record.hull.len(), record.near.len()];
        Self(counts.map(|count| count as u64))
    }

    /// How long a file with so many is; none where a reader of meshes would refuse that many.
    fn bytes(&self) -> Option<u64> {
        let most = 3 * TRIANGLES as u64;
        let [vertices, triangles, same, hull, near] = self.0;
        if triangles > TRIANGLES as u64 || [vertices, same, hull, near].iter().any(|&count| count > most) {
            return None;
        }
        // A triangle's corners, and its place in the order.
        Some((HEADER + CHECKSUM) as u64 + 24 * vertices + (12 + 4) * triangles + 4 * (same + hull + near))
    }
}

/// So many items of `N` bytes each; as many as there are.
fn lists<const N: usize, T>(rest: &mut &[u8], count: usize, item: impl Fn(&[u8; N]) -> T) -> Vec<T> {
    let (mine, others) = rest.split_at((count * N).min(rest.len()));
    *rest = others;
    mine.as_chunks::<N>().0.iter().map(item).collect()
}

fn float<const N: usize>(bytes: &[u8; N], i: usize) -> f64 {
    f64::from_le_bytes(std::array::from_fn(|b| bytes[8 * i + b]))
}

fn integer<const N: usize>(bytes: &[u8; N], i: usize) -> u32 {
    u32::from_le_bytes(std::array::from_fn(|b| bytes[4 * i + b]))
}
