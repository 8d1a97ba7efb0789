//! The parts of a glTF 2.0 document that say where triangles are, and the bytes behind it.

use crate::scene::reading::error::quoted;
use serde::Deserialize;
use std::borrow::Cow;

/// Most objects of a document: each takes a hundred times the memory that it takes in the file.
const OBJECTS: usize = 400_000;
/// What begins a file of one piece, and the kinds of its chunks.
const MAGIC: &[u8] = b"glTF";
const JSON: &[u8] = b"JSON";
const BINARY: &[u8] = b"BIN\0";

/// A number in one of the document's lists.
pub(super) type Place = usize;

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Document {
    pub scene: Option<Place>,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Material>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<View>,
    buffers: Vec<Buffer>,
    pub extensions_required: Vec<String>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Scene {
    pub nodes: Vec<Place>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Node {
    pub children: Vec<Place>,
    pub mesh: Option<Place>,
    /// By columns.
    pub matrix: Option<[f64; 16]>,
    pub translation: Option<[f64; 3]>,
    /// x y z w.
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
}

#[derive(Deserialize)]
pub(super) struct Mesh {
    pub primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    pub attributes: Attributes,
    pub indices: Option<Place>,
    pub material: Option<Place>,
    /// 4 for triangles, 5 for a strip, 6 for a fan.
    pub mode: Option<u32>,
}

#[derive(Deserialize)]
pub(super) struct Attributes {
    #[serde(rename = "POSITION")]
    pub position: Option<Place>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Material {
    pub pbr_metallic_roughness: Surface,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Surface {
    pub base_color_factor: Option<[f64; 4]>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub buffer_view: Option<Place>,
    #[serde(default)]
    pub byte_offset: usize,
    pub component_type: u32,
    pub count: usize,
    #[serde(rename = "type")]
    pub shape: String,
    pub sparse: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct View {
    pub buffer: Place,
    #[serde(default)]
    pub byte_offset: usize,
    pub byte_length: usize,
    pub byte_stride: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
struct Buffer {
    uri: Option<String>,
    byte_length: usize,
}

/// Why a file makes no document: the element, the line where there is one, and the message.
pub(super) struct Fault(pub String, pub Option<u32>, pub String);

fn fault<T>(element: impl Into<String>, message: impl Into<String>) -> Result<T, Fault> {
    Err(Fault(element.into(), None, message.into()))
}

/// The bytes of each buffer: in the file, decoded, or those of another file.
pub(super) type Buffers<'a> = Vec<Cow<'a, [u8]>>;

/// The bytes of a file that a document names, as written but for `%20` and the like; or why there are none.
pub(crate) type OuterFile<'o> = &'o mut dyn FnMut(&str) -> Result<Vec<u8>, String>;

/// The document and the bytes of its buffers, of a file of one piece (GLB) or of text.
pub(super) fn read<'c>(content: &'c [u8], outer: OuterFile<'_>) -> Result<(Document, Buffers<'c>), Fault> {
    let (document, binary) = parsed(content)?;
    let mut buffers = Vec::with_capacity(document.buffers.len());
    for (index, buffer) in document.buffers.iter().enumerate() {
        let failed = |message| Fault(format!("buffer {index}"), None, message);
        buffers.push(match (&buffer.uri, binary) {
            (None, Some(binary)) if index == 0 => Cow::Borrowed(binary),
            (None, _) => return Err(failed("has no bytes".into())),
            (Some(uri), _) if uri.starts_with("data:") => Cow::Owned(embedded(uri).map_err(failed)?),
            (Some(uri), _) => Cow::Owned(other_file(uri, buffer.byte_length, outer).map_err(failed)?),
        });
    }
    Ok((document, buffers))
}

/// The names of the files in which a document has buffers, in their order.
pub(crate) fn outer_files(content: &[u8]) -> Vec<String> {
    let Ok((document, _)) = parsed(content) else { return Vec::new() };
    let uris = document.buffers.iter().filter_map(|buffer| buffer.uri.as_deref());
    uris.filter(|uri| !uri.starts_with("data:")).filter_map(decoded).collect()
}

/// The document, and the buffer of a file of one piece.
fn parsed(content: &[u8]) -> Result<(Document, Option<&[u8]>), Fault> {
    let (json, binary) = if content.starts_with(MAGIC) { chunks(content)? } else { (content, None) };
    let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
    if json.iter().filter(|&&byte| byte == b'{').count() > OBJECTS {
        return fault("document", format!("has more than {OBJECTS} objects"));
    }
    let document: Document = serde_json::from_slice(json)
        .map_err(|error| Fault("document".into(), u32::try_from(error.line()).ok(), error.to_string()))?;
    Ok((document, binary))
}

/// The document and the buffer of a file of one piece.
fn chunks(content: &[u8]) -> Result<(&[u8], Option<&[u8]>), Fault> {
    let number = |at: usize| Some(u32::from_le_bytes(content.get(at..at + 4)?.try_into().ok()?) as usize);
    match number(4) {
        Some(2) => {}
        Some(version) => return fault("header", format!("is of version {version}, 2 is read")),
        None => return fault("header", "is cut off"),
    }
    let (mut json, mut binary, mut at) = (None, None, 12);
    while at < content.len() {
        let (Some(length), Some(kind)) = (number(at), content.get(at + 4..at + 8)) else {
            return fault("chunk", "is cut off");
        };
        let Some(chunk) = (at + 8).checked_add(length).and_then(|end| content.get(at + 8..end)) else {
            return fault("chunk", format!("has {length} bytes, more than the file"));
        };
        match kind {
            JSON if json.is_none() => json = Some(chunk),
            BINARY if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        at += 8 + length;
    }
    json.map_or_else(|| fault("header", "has no document"), |json| Ok((json, binary)))
}

/// The bytes that a URI holds itself.
fn embedded(uri: &str) -> Result<Vec<u8>, String> {
    let text = uri.split_once(";base64,").map(|(_, text)| text);
    text.and_then(|text| base64(text.as_bytes())).ok_or_else(|| "is no base64".into())
}

/// The bytes of a buffer in a file of its own.
fn other_file(uri: &str, length: usize, outer: OuterFile<'_>) -> Result<Vec<u8>, String> {
    let shown = quoted(uri);
    let name = decoded(uri).ok_or_else(|| format!("`{shown}` is no URI: `%` stands before two hexadecimal digits"))?;
    let bytes = outer(&name).map_err(|message| format!("`{shown}`: {message}"))?;
    if bytes.len() < length {
        return Err(format!("`{shown}` has {} bytes, and {length} are declared", bytes.len()));
    }
    Ok(bytes)
}

/// A URI without `%20` and the like (RFC 3986).
fn decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut pieces = uri.split('%');
    bytes.extend_from_slice(pieces.next()?.as_bytes());
    for piece in pieces {
        let digits = piece.get(..2).filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()))?;
        bytes.push(u8::from_str_radix(digits, 16).ok()?);
        bytes.extend_from_slice(&piece.as_bytes()[2..]);
    }
    String::from_utf8(bytes).ok()
}

/// The bytes of a base64 text (RFC 4648), with or without padding.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let text = text.strip_suffix(b"==").or_else(|| text.strip_suffix(b"=")).unwrap_or(text);
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for group in text.chunks(4) {
        let mut bits = 0_u32;
        for &letter in group {
            bits = bits << 6
                | u32::from(match letter {
                    b'A'..=b'Z' => letter - b'A',
                    b'a'..=b'z' => letter - b'a' + 26,
                    b'0'..=b'9' => letter - b'0' + 52,
                    b'+' => 62,
                    b'/' => 63,
                    _ => return None,
                });
        }
        let whole = match group.len() {
            4 => 3,
            3 => 2,
            2 => 1,
            _ => return None,
        };
        bits <<= 6 * (4 - group.len());
        bytes.extend_from_slice(&bits.to_be_bytes()[1..=whole]);
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_decoded() {
        for (uri, name) in [("a.bin", "a.bin"), ("b%20c%2ebin", "b c.bin"), ("%C3%A4.bin", "ä.bin")] {
            assert_eq!(decoded(uri).as_deref(), Some(name));
        }
        for uri in ["a%", "a%2", "a%2g.bin", "%ff", "%+1"] {
            assert_eq!(decoded(uri), None, "{uri}");
        }
    }

    #[test]
    fn texts_of_base64_are_those_of_the_standard() {
        for (text, bytes) in
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm8", "fo"), ("Zm9v", "foo"), ("Zm9vYg==", "foob")]
        {
            assert_eq!(base64(text.as_bytes()).as_deref(), Some(bytes.as_bytes()), "{text}");
        }
        assert_eq!(base64(b"/+8A"), Some(vec![0xff, 0xef, 0x00]));
        for text in ["Z", "Zm9vY", "Zm=v", "Zm 9"] {
            assert_eq!(base64(text.as_bytes()), None, "{text}");
        }
    }
}
