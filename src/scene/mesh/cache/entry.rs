//! What was found about one mesh as bytes. Little endian: `MAGIC`, the key, four counts (`u64` each), the hull's slack, the
//! record's lists, and the SHA-256 of all that. Neither vertices nor triangles are in it: these come from the mesh's own
//! file.

use crate::scene::mesh::cache::key::Key;
use crate::scene::mesh::formats::triangles::TRIANGLES;
use foliate_components::robot::shape::mesh_record::MeshRecord;
use sha2::{Digest, Sha256};
const MAGIC: [u8; 8] = *b"foliate\x02";
const CHECKSUM: usize = 32;
/// Magic, key, counts, slack.
const HEADER: usize = 8 + 32 + 4 * 8 + 8;

/// The bytes of a record; none where it is larger than any that is read.
pub(crate) fn write(key: &Key, record: &MeshRecord) -> Option<Vec<u8>> {
    let counts = Counts::of(record);
    let mut bytes = Vec::with_capacity(counts.bytes()? as usize);
    bytes.extend(MAGIC);
    bytes.extend(key.0);
    bytes.extend(counts.0.iter().flat_map(|n| n.to_le_bytes()));
    bytes.extend(record.slack.to_bits().to_le_bytes());
    for list in [&record.same, &record.order, &record.hull] {
        list.iter().for_each(|i| bytes.extend(i.to_le_bytes()));
    }
    bytes.extend(record.near.as_flattened());
    let sum = Sha256::digest(&bytes);
    bytes.extend(sum);
    Some(bytes)
}

/// The record that bytes hold. Nothing is known of it but that it was written as a whole.
///
/// # Errors
/// What is wrong with them.
pub(crate) fn read(bytes: &[u8], key: &Key) -> Result<MeshRecord, &'static str> {
    let (counts, slack) = header(bytes, key)?;
    let (content, sum) = bytes.split_at(bytes.len() - CHECKSUM);
    if Sha256::digest(content).as_slice() != sum {
        return Err("its checksum is another");
    }
    let [same, order, hull, near] = counts.0.map(|count| count as usize);
    let mut rest = &content[HEADER..];
    let mut numbers = |count: usize| lists(&mut rest, count, |b: &[u8; 4]| u32::from_le_bytes(*b));
    let (same, order, hull) = (numbers(same), numbers(order), numbers(hull));
    let near = lists(&mut rest, near, |b: &[u8; 4]| *b);
    Ok(MeshRecord { same, order, hull, near, slack })
}

/// Counts, and the slack; the counts are those of a file that long.
fn header(bytes: &[u8], key: &Key) -> Result<(Counts, f64), &'static str> {
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
    Ok((counts, f64::from_bits(word(4))))
}

/// First vertices at a position, triangles in order, points of the hull, places near vertices.
#[derive(Clone, Copy)]
struct Counts([u64; 4]);

impl Counts {
    fn of(record: &MeshRecord) -> Self {
        Self([record.same.len(), record.order.len(), record.hull.len(), record.near.len()].map(|count| count as u64))
    }

    /// How long a file with so many is; none where a reader of meshes would refuse that many.
    fn bytes(&self) -> Option<u64> {
        let most = 3 * TRIANGLES as u64;
        if self.0.iter().any(|&count| count > most) {
            return None;
        }
        Some((HEADER + CHECKSUM) as u64 + 4 * self.0.iter().sum::<u64>())
    }
}

/// So many items of `N` bytes each; as many as there are.
fn lists<const N: usize, T>(rest: &mut &[u8], count: usize, item: impl Fn(&[u8; N]) -> T) -> Vec<T> {
    let (mine, others) = rest.split_at((count * N).min(rest.len()));
    *rest = others;
    mine.as_chunks::<N>().0.iter().map(item).collect()
}
