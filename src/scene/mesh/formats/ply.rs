//! PLY, text and binary: vertices and faces; colours and other elements are left out.

use crate::scene::mesh::formats::triangles::Triangles;
use crate::scene::reading::error::{SceneError, quoted};
use glam::DVec3;

/// Most bytes of a header.
const HEADER: usize = 1 << 16;
/// Most corners of one face.
const CORNERS: usize = 4096;
/// Elements between two checks of the signal that stops the reading.
const BETWEEN_LOOKS: u64 = 1 << 14;

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Text,
    Little,
    Big,
}

/// A kind of number: its bytes, and what they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Number {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

impl Number {
    fn of_word(word: &str) -> Option<Self> {
        Some(match word {
            "char" | "int8" => Self::Signed(1),
            "uchar" | "uint8" => Self::Unsigned(1),
            "short" | "int16" => Self::Signed(2),
            "ushort" | "uint16" => Self::Unsigned(2),
            "int" | "int32" => Self::Signed(4),
            "uint" | "uint32" => Self::Unsigned(4),
            "float" | "float32" => Self::Float(4),
            "double" | "float64" => Self::Float(8),
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        let (Self::Signed(bytes) | Self::Unsigned(bytes) | Self::Float(bytes)) = self;
        bytes
    }

    /// The number in bytes, the first of which counts most.
    fn value(self, bytes: &[u8]) -> f64 {
        let bits = bytes.iter().fold(0_u64, |bits, &byte| bits << 8 | u64::from(byte));
        match self {
            Self::Float(4) => f64::from(f32::from_bits(bits as u32)),
            Self::Float(_) => f64::from_bits(bits),
            Self::Unsigned(_) => bits as f64,
            Self::Signed(bytes) => {
                let unused = 64 - 8 * bytes as u32;
                ((bits << unused) as i64 >> unused) as f64
            }
        }
    }
}

/// A property of an element: one number, or a list whose length is written as a number of the first kind.
struct Property {
    name: String,
    length: Option<Number>,
    number: Number,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

pub(crate) fn read(file: &str, content: &[u8], mesh: Triangles) -> Result<Triangles, SceneError> {
    let (encoding, elements, body) = header(file, content)?;
    let mut reader = Reader { file, encoding, content, at: body, mesh };
    for element in &elements {
        match element.name.as_str() {
            "vertex" => reader.vertices(element)?,
            "face" => reader.faces(element)?,
            _ => reader.all(element, |_, _, _| Ok(()))?,
        }
    }
    Ok(reader.mesh)
}

/// How numbers are written, the elements in their order, and where they begin.
fn header(file: &str, content: &[u8]) -> Result<(Encoding, Vec<Element>, usize), SceneError> {
    let (mut encoding, mut elements): (_, Vec<Element>) = (None, Vec::new());
    let mut at = 0;
    for number in 1_u32.. {
        let fail = |message: String| Err(SceneError::new(file, "header", message).at(number));
        let rest = content.get(at..HEADER.min(content.len())).unwrap_or_default();
        let Some(end) = rest.iter().position(|&byte| byte == b'\n') else {
            return fail("`end_header` is missing".into())
                .map_err(|e: SceneError| e.hint("the file is cut off, or no PLY"));
        };
        at += end + 1;
        let line = String::from_utf8_lossy(&rest[..end]);
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words[..] {
            ["ply"] if number == 1 => {}
            _ if number == 1 => return fail("a PLY begins with the line `ply`".into()),
            ["format", word, _] => {
                encoding = match word {
                    "ascii" => Some(Encoding::Text),
                    "binary_little_endian" => Some(Encoding::Little),
                    "binary_big_endian" => Some(Encoding::Big),
                    other => return fail(format!("`{}` is no format", quoted(other))),
                }
            }
            ["element", name, count] => {
                let Ok(count) = count.parse() else { return fail(format!("`{}` is no count", quoted(count))) };
                elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
            }
            ["property", ref words @ ..] => match (property(words), elements.last_mut()) {
                (Ok(property), Some(element)) => element.properties.push(property),
                (Err(message), _) => return fail(message),
                (_, None) => return fail("a property stands before the elements".into()),
            },
            ["end_header"] => {
                let Some(encoding) = encoding else { return fail("says no format".into()) };
                return Ok((encoding, elements, at));
            }
            ["comment" | "obj_info", ..] | [] => {}
            [word, ..] => return fail(format!("`{}` is no word of a header", quoted(word))),
        }
    }
    Err(SceneError::new(file, "header", "has no end"))
}

fn property(words: &[&str]) -> Result<Property, String> {
    let kind = |word: &str| Number::of_word(word).ok_or_else(|| format!("`{}` is no kind of number", quoted(word)));
    match *words {
        ["list", length, number, name] => {
            let length = kind(length)?;
            if matches!(length, Number::Float(_)) {
                return Err("the length of a list is a whole number".into());
            }
            Ok(Property { name: name.to_owned(), length: Some(length), number: kind(number)? })
        }
        [number, name] => Ok(Property { name: name.to_owned(), length: None, number: kind(number)? }),
        _ => Err("a property has a kind and a name".into()),
    }
}

struct Reader<'a> {
    file: &'a str,
    encoding: Encoding,
    content: &'a [u8],
    at: usize,
    mesh: Triangles,
}

impl Reader<'_> {
    /// An error at an element; with the line, where there are lines.
    fn error(&self, element: &Element, index: u64, message: String) -> SceneError {
        let lines = || 1 + self.content[..self.at].iter().filter(|&&byte| byte == b'\n').count() as u32;
        let line = (self.encoding == Encoding::Text).then(lines);
        SceneError::new(self.file, format!("{} {index}", quoted(&element.name)), message).at(line)
    }

    /// The next number.
    fn number(&mut self, number: Number) -> Result<f64, String> {
        let rest = &self.content[self.at..];
        if self.encoding == Encoding::Text {
            let start =
                rest.iter().position(|byte| !byte.is_ascii_whitespace()).ok_or("is missing: the file is cut off")?;
            let length = rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
            let word = String::from_utf8_lossy(&rest[start..start + length]);
            let value = word.parse::<f64>().map_err(|_| format!("`{}` is not a number", quoted(&word)))?;
            self.at += start + length;
            return Ok(value);
        }
        let mut bytes = [0; 8];
        let bytes = &mut bytes[..number.bytes()];
        bytes.copy_from_slice(rest.get(..number.bytes()).ok_or("is missing: the file is cut off")?);
        if self.encoding == Encoding::Little {
            bytes.reverse();
        }
        self.at += number.bytes();
        Ok(number.value(bytes))
    }

    /// Reads every element of a kind; `take` gets the numbers of each, and the place of each property in them.
    fn all(
        &mut self,
        element: &Element,
        mut take: impl FnMut(&mut Triangles, &[f64], &[usize]) -> Result<(), String>,
    ) -> Result<(), SceneError> {
        // Every property takes a byte at least; an element without any takes none, however many there are.
        let room = (self.content.len() - self.at) as u64;
        if element.properties.is_empty() {
            return Ok(());
        }
        if element.count.checked_mul(element.properties.len() as u64).is_none_or(|bytes| bytes > room) {
            let message = format!("declares {} of them, which do not fit into the file", element.count);
            return Err(self.error(element, 0, message).hint("the file is cut off, or no PLY"));
        }
        let (mut numbers, mut places) = (Vec::new(), Vec::new());
        for index in 0..element.count {
            if index.is_multiple_of(BETWEEN_LOOKS) && self.mesh.stop.is_raised() {
                return Err(self.error(element, index, "was not read to its end".into()));
            }
            numbers.clear();
            places.clear();
            let read = self.row(element, &mut numbers, &mut places);
            let taken = read.and_then(|()| take(&mut self.mesh, &numbers, &places));
            taken.map_err(|message| self.error(element, index, message))?;
        }
        Ok(())
    }

    /// The numbers of one element.
    fn row(&mut self, element: &Element, numbers: &mut Vec<f64>, places: &mut Vec<usize>) -> Result<(), String> {
        for property in &element.properties {
            let count = match property.length {
                None => 1,
                Some(length) => match self.number(length)? {
                    x if x >= 0.0 && x.fract() == 0.0 && x <= CORNERS as f64 => x as usize,
                    x => return Err(format!("a list of {x} numbers; at most {CORNERS} are read")),
                },
            };
            places.push(numbers.len());
            for _ in 0..count {
                numbers.push(self.number(property.number)?);
            }
        }
        places.push(numbers.len());
        Ok(())
    }

    fn vertices(&mut self, element: &Element) -> Result<(), SceneError> {
        let place = |name: &str| element.properties.iter().position(|p| p.name == name && p.length.is_none());
        let (Some(x), Some(y), Some(z)) = (place("x"), place("y"), place("z")) else {
            return Err(self.error(element, 0, "has no coordinates x, y and z".into()));
        };
        self.all(element, |mesh, numbers, places| {
            let p = DVec3::new(numbers[places[x]], numbers[places[y]], numbers[places[z]]);
            if !p.is_finite() {
                return Err("is not finite".into());
            }
            mesh.check_room()?;
            mesh.vertices.push(p);
            Ok(())
        })
    }

    fn faces(&mut self, element: &Element) -> Result<(), SceneError> {
        let is_corners =
            |p: &Property| matches!(p.name.as_str(), "vertex_indices" | "vertex_index") && p.length.is_some();
        let Some(list) = element.properties.iter().position(is_corners) else {
            return Err(self.error(element, 0, "has no list `vertex_indices`".into()));
        };
        let mut corners = Vec::new();
        self.all(element, |mesh, numbers, places| {
            corners.clear();
            let known = mesh.vertices.len();
            for &number in &numbers[places[list]..places[list + 1]] {
                if !(number >= 0.0 && number.fract() == 0.0 && number < known as f64) {
                    return Err(format!("names vertex {number}, {known} are known so far"));
                }
                corners.push(number as u32);
            }
            mesh.push_polygon(&corners)
        })
    }
}
