//! The triangles of a mesh file as every reader collects them, with the caps that hold for all formats.

use foliate_systems::events::StopSignal;
use glam::DVec3;
use std::borrow::Cow;

/// Most triangles of one mesh.
pub(crate) const TRIANGLES: usize = 4_000_000;

/// The lines of a text of which only keywords and numbers matter: names and comments may be in any encoding.
pub(crate) fn lines(content: &[u8]) -> impl Iterator<Item = Cow<'_, str>> {
    let content = content.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(content);
    let content = content.strip_suffix(b"\n").unwrap_or(content);
    content.split(|&byte| byte == b'\n').map(String::from_utf8_lossy)
}

/// Red, green, blue and opacity, from 0 to 1.
pub(crate) type Paint = [f64; 4];

/// Triangles as a file holds them, in metres, unscaled.
#[derive(Debug, Default)]
pub(crate) struct Triangles {
    pub vertices: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// From which triangle on they have which colour; what is before the first has none.
    pub paint: Vec<(usize, Option<Paint>)>,
    /// Ends the reading.
    pub(crate) stop: StopSignal,
}

impl Triangles {
    /// None yet; to read more ends when the signal is raised.
    pub(crate) fn watched(stop: &StopSignal) -> Self {
        Self { stop: stop.clone(), ..Self::default() }
    }

    /// Refuses the next triangle where the cap is reached, and vertex numbers beyond 32 bits; now and then checks the signal.
    pub(crate) fn check_room(&self) -> Result<(), String> {
        if (self.triangles.len() + self.vertices.len()).is_multiple_of(1 << 14) && self.stop.is_raised() {
            return Err("was not read to its end".into());
        }
        match self.triangles.len() >= TRIANGLES || self.vertices.len() >= 3 * TRIANGLES {
            true => Err(format!("has more than {TRIANGLES} triangles")),
            false => Ok(()),
        }
    }

    /// Adds a polygon as a fan about its first vertex.
    pub(crate) fn push_polygon(&mut self, corners: &[u32]) -> Result<(), String> {
        for pair in corners.windows(2).skip(1) {
            self.check_room()?;
            self.triangles.push([corners[0], pair[0], pair[1]]);
        }
        Ok(())
    }

    /// Drops triangles with two corners at one position, which bound nothing, and vertices that no triangle names: files
    /// share their arrays among meshes, and a stray vertex would only widen every bound on the solid.
    pub(crate) fn drop_unused(&mut self) {
        let at = |i: u32| self.vertices[i as usize];
        let bounds = |[a, b, c]: [u32; 3]| at(a) != at(b) && at(b) != at(c) && at(c) != at(a);
        if !self.paint.is_empty() {
            let mut kept = vec![0_usize; self.triangles.len() + 1];
            for (index, &triangle) in self.triangles.iter().enumerate() {
                kept[index + 1] = kept[index] + usize::from(bounds(triangle));
            }
            self.paint.iter_mut().for_each(|(start, _)| *start = kept[*start]);
        }
        self.triangles.retain(|&triangle| bounds(triangle));
        let mut number = vec![u32::MAX; self.vertices.len()];
        let mut kept = Vec::new();
        for corner in self.triangles.iter_mut().flatten() {
            let known = &mut number[*corner as usize];
            if *known == u32::MAX {
                *known = kept.len() as u32;
                kept.push(self.vertices[*corner as usize]);
            }
            *corner = *known;
        }
        self.vertices = kept;
    }

    /// Its triangles by colour, those without first, then in the order in which colours come.
    #[cfg(feature = "visuals")]
    pub(crate) fn by_paint(self) -> Vec<(Option<Paint>, Self)> {
        let mut parts: Vec<(Option<Paint>, Self)> = Vec::new();
        let ends = self.paint.iter().map(|(start, _)| *start).chain([self.triangles.len()]);
        let starts = [(0, None)].into_iter().chain(self.paint.iter().copied());
        for ((start, paint), end) in starts.zip(ends).filter(|((start, _), end)| start < end) {
            let number = parts.iter().position(|(known, _)| *known == paint).unwrap_or_else(|| {
                parts.push((paint, Self { vertices: self.vertices.clone(), ..Self::watched(&self.stop) }));
                parts.len() - 1
            });
            parts[number].1.triangles.extend_from_slice(&self.triangles[start..end]);
        }
        parts.iter_mut().for_each(|(_, part)| part.drop_unused());
        parts
    }
}

/// What to do with a COLLADA file's `<up_axis>`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum UpAxis {
    /// Take coordinates as the link's, as ROS and pinocchio do.
    #[default]
    AsWritten,
    /// Turn the declared axis to z.
    Declared,
}

impl UpAxis {
    /// Both, as scenes and path files write them.
    pub(crate) const WORDS: [(&'static str, Self); 2] = [("as-written", Self::AsWritten), ("declared", Self::Declared)];

    /// As scenes and path files write it: `as-written` or `declared`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::AsWritten => "as-written",
            Self::Declared => "declared",
        }
    }

    /// What a word stands for.
    #[must_use]
    pub fn of_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(w, _)| *w == word).map(|(_, axis)| *axis)
    }
}
