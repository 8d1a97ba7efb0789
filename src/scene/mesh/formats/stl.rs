//! STL, binary and text. Corners at the same position become one vertex.

use crate::scene::mesh::formats::triangles::{TRIANGLES, Triangles, lines};
use crate::scene::reading::error::{SceneError, quoted};
use foliate_components::robot::shape::positions::Positions;
use glam::DVec3;

/// Bytes before the first triangle: a comment, and their number.
const HEADER: usize = 84;
/// Bytes of a triangle: normal, three corners, two bytes of attributes.
const RECORD: usize = 50;

/// Reads either form. A file is binary exactly where its length fits the number of triangles that it declares.
pub(crate) fn read(file: &str, content: &[u8], mesh: Triangles) -> Result<Triangles, SceneError> {
    let declared = content.get(80..HEADER).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let is_text = content.trim_ascii_start().starts_with(b"solid");
    match declared {
        Some(count) if content.len() as u64 == HEADER as u64 + u64::from(count) * RECORD as u64 => {
            binary(file, &content[HEADER..], mesh)
        }
        _ if is_text => text(file, content, mesh),
        Some(count) => {
            let wanted = HEADER as u64 + u64::from(count) * RECORD as u64;
            // Exporters pad; a file that is too short is cut off.
            let records = &content[HEADER..];
            match (records.len() as u64) >= wanted - HEADER as u64 && count > 0 {
                true => binary(file, &records[..count as usize * RECORD], mesh),
                false => Err(SceneError::new(
                    file,
                    "header",
                    format!("declares {count} triangles, which take {wanted} bytes; the file has {}", content.len()),
                )
                .hint("the file is cut off, or no STL")),
            }
        }
        None => Err(SceneError::new(file, "header", format!("is {} bytes long, a header is {HEADER}", content.len()))
            .hint("the file is cut off, or no STL")),
    }
}

/// Vertices by position.
struct Corners {
    mesh: Triangles,
    known: Positions,
}

impl Corners {
    /// With room for as many triangles as there are in most files of that many.
    fn of(triangles: usize, mesh: Triangles) -> Self {
        Self { mesh, known: Positions::with_capacity(triangles / 2) }
    }

    fn vertex(&mut self, p: DVec3) -> u32 {
        let next = self.mesh.vertices.len() as u32;
        let number = self.known.number(p, next);
        if number == next {
            self.mesh.vertices.push(p);
        }
        number
    }
}

fn binary(file: &str, records: &[u8], mesh: Triangles) -> Result<Triangles, SceneError> {
    let count = records.len() / RECORD;
    if count > TRIANGLES {
        return Err(SceneError::new(
            file,
            "header",
            format!("declares {count} triangles, at most {TRIANGLES} are read"),
        ));
    }
    let mut corners = Corners::of(count, mesh);
    corners.mesh.triangles.reserve(count);
    for (number, record) in records.chunks_exact(RECORD).enumerate() {
        corners.mesh.check_room().map_err(|message| SceneError::new(file, "mesh", message))?;
        let mut triangle = [0; 3];
        for (corner, bytes) in triangle.iter_mut().zip(record[12..48].chunks_exact(12)) {
            let mut p = [0.0; 3];
            for (x, b) in p.iter_mut().zip(bytes.chunks_exact(4)) {
                *x = f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
            }
            let p = DVec3::from_array(p);
            if !p.is_finite() {
                return Err(SceneError::new(file, format!("triangle {number}"), "has a corner that is not finite"));
            }
            *corner = corners.vertex(p);
        }
        corners.mesh.triangles.push(triangle);
    }
    Ok(corners.mesh)
}

fn text(file: &str, content: &[u8], mesh: Triangles) -> Result<Triangles, SceneError> {
    if content.contains(&0) {
        let message = "begins with `solid` but is neither text nor of its declared length";
        return Err(SceneError::new(file, "header", message).hint("the file is cut off, or no STL"));
    }
    let mut corners = Corners::of(0, mesh);
    let mut loop_corners: Option<Vec<u32>> = None;
    let mut ended = false;
    for (index, line) in lines(content).enumerate() {
        let fail = |element: &str, message: String| Err(SceneError::new(file, element, message).at(index as u32 + 1));
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("outer") => loop_corners = Some(Vec::new()),
            Some("vertex") => {
                let Some(triangle) = &mut loop_corners else { return fail("vertex", "is outside of a loop".into()) };
                let p = match point(words) {
                    Ok(p) => p,
                    Err(message) => return fail("vertex", message),
                };
                if triangle.len() == 3 {
                    return fail("loop", "has more than 3 vertices".into());
                }
                triangle.push(corners.vertex(p));
            }
            Some("endloop") => match loop_corners.take().as_deref() {
                Some(&[a, b, c]) => {
                    if let Err(message) = corners.mesh.check_room() {
                        return fail("mesh", message);
                    }
                    corners.mesh.triangles.push([a, b, c]);
                }
                other => {
                    return fail("loop", format!("has {} vertices, a triangle has 3", other.map_or(0, <[u32]>::len)));
                }
            },
            Some("endsolid") => ended = true,
            Some("solid" | "facet" | "endfacet") | None => {}
            Some(other) => return fail("solid", format!("`{}` is no word of STL", quoted(other))),
        }
    }
    if !ended || loop_corners.is_some() {
        let last = lines(content).count() as u32;
        return Err(SceneError::new(file, "solid", "`endsolid` is missing").at(last).hint("the file is cut off"));
    }
    Ok(corners.mesh)
}

fn point<'a>(words: impl Iterator<Item = &'a str>) -> Result<DVec3, String> {
    let mut p = [0.0; 3];
    let mut count = 0;
    for word in words {
        let x: f64 = word.parse().map_err(|_| format!("`{}` is not a number", quoted(word)))?;
        if !x.is_finite() {
            return Err(format!("`{}` is not finite", quoted(word)));
        }
        *p.get_mut(count).ok_or("has more than 3 numbers")? = x;
        count += 1;
    }
    match count {
        3 => Ok(DVec3::from_array(p)),
        n => Err(format!("wants 3 numbers, got {n}")),
    }
}
