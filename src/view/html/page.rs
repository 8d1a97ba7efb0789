//! The HTML file of a document.

use crate::view::document::page::Document;
use crate::view::geometry::blob::Blob;
use crate::view::graph::svg::escaped;
use crate::view::html::packed::packed;

/// The page around them, and the viewer's program and its style, built from `viewer/src`.
const TEMPLATE: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/viewer/page.html"));
const PROGRAM: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/viewer/dist/viewer.js"));
const STYLE: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/viewer/dist/viewer.css"));

/// A page: what it says, and large arrays.
#[derive(Clone, Debug)]
pub struct Page {
    /// What it says.
    pub document: Document,
    /// The arrays that it refers to.
    pub blob: Blob,
}

impl Page {
    /// One HTML file that needs no other and asks no server. The same page gives the same bytes.
    ///
    /// # Errors
    /// The document cannot be written as JSON. A number that is not finite is no error here: JSON has `null` for it. The functions that
    /// make pages of paths refuse such numbers.
    pub fn html(&self) -> Result<String, serde_json::Error> {
        let json = serde_json::to_vec(&self.document)?;
        let title = escaped(&self.document.title);
        let (json, binary) = (packed(&json), packed(self.blob.bytes()));
        // What ends an element inside of it would end it early.
        let program = PROGRAM.replace("</script", "<\\/script");
        let style = STYLE.replace("</style", "<\\/style");
        let pieces = [
            ("@@TITLE@@", title.as_str()),
            ("@@STYLE@@", style.as_str()),
            ("@@JSON@@", json.as_str()),
            ("@@BINARY@@", binary.as_str()),
            ("@@SCRIPT@@", program.as_str()),
        ];
        Ok(filled(TEMPLATE, &pieces))
    }
}

/// A template with pieces at the places that are named so. What a piece holds is never taken for a place.
fn filled(mut template: &str, pieces: &[(&str, &str)]) -> String {
    let mut out = String::with_capacity(template.len() + pieces.iter().map(|(_, piece)| piece.len()).sum::<usize>());
    let next = |template: &str| {
        let found = pieces.iter().filter_map(|&(name, piece)| Some((template.find(name)?, name, piece)));
        found.min_by_key(|(at, ..)| *at)
    };
    while let Some((at, name, piece)) = next(template) {
        out.push_str(&template[..at]);
        out.push_str(piece);
        template = &template[at + name.len()..];
    }
    out.push_str(template);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_may_hold_the_name_of_a_place() {
        let pieces = [("@@A@@", "<@@B@@>"), ("@@B@@", "b")];
        assert_eq!(filled("1 @@B@@ 2 @@A@@ 3", &pieces), "1 b 2 <@@B@@> 3");
    }

    #[test]
    fn the_template_has_every_place_once() {
        for name in ["@@TITLE@@", "@@STYLE@@", "@@JSON@@", "@@BINARY@@", "@@SCRIPT@@"] {
            assert_eq!(TEMPLATE.matches(name).count(), 1, "{name}");
        }
    }
}
