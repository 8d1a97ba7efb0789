//! Wavefront OBJ: vertices and faces; everything else only concerns looks.

use crate::scene::mesh::formats::triangles::{Triangles, lines};
use crate::scene::reading::error::{SceneError, quoted};
use glam::DVec3;

/// Most corners of one face.
const CORNERS: usize = 4096;

pub(crate) fn read(file: &str, content: &[u8], mut mesh: Triangles) -> Result<Triangles, SceneError> {
    let mut corners = Vec::new();
    for (index, line) in lines(content).enumerate() {
        let mut words = line.split_ascii_whitespace();
        let result = match words.next() {
            Some("v") => vertex(&mut mesh, words),
            Some("f") => face(&mut mesh, words, &mut corners),
            _ => Ok(()),
        };
        if let Err((element, message)) = result {
            return Err(SceneError::new(file, element, message).at(index as u32 + 1));
        }
    }
    Ok(mesh)
}

type Fault = (&'static str, String);

fn vertex<'a>(mesh: &mut Triangles, words: impl Iterator<Item = &'a str>) -> Result<(), Fault> {
    let mut p = [0.0_f64; 3];
    let mut count = 0;
    // A weight and a colour may follow the three coordinates.
    for (x, word) in p.iter_mut().zip(words) {
        *x = word.parse().map_err(|_| ("v", format!("`{}` is not a number", quoted(word))))?;
        if !x.is_finite() {
            return Err(("v", format!("`{}` is not finite", quoted(word))));
        }
        count += 1;
    }
    if count < 3 {
        return Err(("v", format!("wants 3 numbers, got {count}")));
    }
    mesh.check_room().map_err(|m| ("v", m))?;
    mesh.vertices.push(DVec3::from_array(p));
    Ok(())
}

fn face<'a>(mesh: &mut Triangles, words: impl Iterator<Item = &'a str>, corners: &mut Vec<u32>) -> Result<(), Fault> {
    corners.clear();
    let known = mesh.vertices.len() as i64;
    for word in words {
        if word.starts_with('#') {
            break;
        }
        let number = word.split('/').next().unwrap_or_default();
        let index: i64 = number.parse().map_err(|_| ("f", format!("`{}` is no vertex number", quoted(word))))?;
        // Vertices count from 1; negative numbers count back from the last one.
        let index = if index < 0 { known.saturating_add(index) } else { index - 1 };
        if !(0..known).contains(&index) {
            return Err(("f", format!("names vertex {}, {known} are known so far", quoted(number))));
        }
        if corners.len() == CORNERS {
            return Err(("f", format!("has more than {CORNERS} corners")));
        }
        corners.push(index as u32);
    }
    if corners.len() < 3 {
        return Err(("f", format!("has {} corners, a face has at least 3", corners.len())));
    }
    mesh.push_polygon(corners).map_err(|m| ("f", m))
}
