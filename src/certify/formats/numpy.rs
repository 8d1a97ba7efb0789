//! NumPy arrays: `.npy` (format versions 1 to 3), and `.npz` archives of them.
//!
//! An `.npy` holds one row a state. An `.npz` holds `positions` (states × joints) and, where there are any, `times` (states, seconds),
//! `velocities` and `accelerations` (as positions), `names` (joints, text). Numbers are floats of 4 or 8 bytes in either byte order, rows
//! or columns first.

use crate::certify::formats::table::{COLUMNS, Table};
use crate::certify::motion::piecewise::{POINTS, Point};
use crate::scene::reading::error::{SceneError, quoted};

/// Longest header, bytes.
const HEADER: usize = 1 << 16;

/// An array: its shape and its bytes.
struct Array<'a> {
    kind: Kind,
    fortran: bool,
    shape: Vec<usize>,
    data: &'a [u8],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A float of so many bytes, big end first or not.
    Float { size: usize, big: bool },
    /// Text of so many characters of four bytes, big end first or not.
    Text { length: usize, big: bool },
    /// Text of so many bytes.
    Bytes { length: usize },
}

pub(super) fn npy(file: &str, content: &[u8]) -> Result<Table, SceneError> {
    let fail = |(message, hint): (String, &str)| SceneError::new(file, "array", message).hint(hint);
    let array = parse(content).map_err(fail)?;
    let rows = array.matrix().map_err(fail)?;
    let points = rows.into_iter().map(|positions| Point { positions, ..Point::default() }).collect();
    Ok(Table { points, element: "row", ..Table::default() })
}

type Failure = (String, &'static str);

fn parse(content: &[u8]) -> Result<Array<'_>, Failure> {
    let short = || (String::from("ends before its header does"), "the file was cut off");
    let rest =
        content.strip_prefix(b"\x93NUMPY").ok_or((String::from("is no NumPy array"), "it begins with \\x93NUMPY"))?;
    let (version, rest) = rest.split_at_checked(2).ok_or_else(short)?;
    let width = match version[0] {
        1 => 2,
        2 | 3 => 4,
        other => return Err((format!("has format version {other}"), "versions 1 to 3 are read")),
    };
    let (length, rest) = rest.split_at_checked(width).ok_or_else(short)?;
    let length = length.iter().rev().fold(0_usize, |sum, &byte| sum << 8 | usize::from(byte));
    if length > HEADER {
        return Err((format!("has a header of {length} bytes"), "no array has one that long"));
    }
    let (header, data) = rest.split_at_checked(length).ok_or_else(short)?;
    let header = std::str::from_utf8(header).map_err(|_| (String::from("has a header that is no text"), ""))?;
    let array = Array {
        kind: kind(value(header, "descr")?)?,
        fortran: value(header, "fortran_order")?.starts_with("True"),
        shape: shape(value(header, "shape")?)?,
        data,
    };
    let count = array.shape.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
    let bytes = count.and_then(|count| count.checked_mul(array.kind.size()));
    if bytes != Some(data.len()) {
        let message = format!("has {} bytes of data, and its shape {:?} asks for others", data.len(), array.shape);
        return Err((message, "the file was cut off, or has more than one array"));
    }
    Ok(array)
}

/// What stands behind a key of the header.
fn value<'a>(header: &'a str, key: &str) -> Result<&'a str, Failure> {
    let missing = || (format!("has a header without `{key}`"), "");
    let behind =
        ['\'', '"'].into_iter().find_map(|q| header.split_once(&format!("{q}{key}{q}"))).ok_or_else(missing)?.1;
    Ok(behind.trim_start().strip_prefix(':').ok_or_else(missing)?.trim_start())
}

fn kind(text: &str) -> Result<Kind, Failure> {
    let quote = text.chars().next().filter(|c| *c == '\'' || *c == '"');
    let inner = quote.and_then(|q| text[1..].split(q).next()).unwrap_or(text);
    let refuse = || {
        let hint =
            "floats of 4 or 8 bytes are read, and text for names: array.astype(float), or names without dtype=object";
        (format!("has elements of type `{}`", quoted(inner)), hint)
    };
    let mut letters = inner.chars();
    let (order, letter) = (letters.next().ok_or_else(refuse)?, letters.next().ok_or_else(refuse)?);
    let size: usize = letters.as_str().parse().map_err(|_| refuse())?;
    let big = match order {
        '<' | '|' | '=' => false,
        '>' => true,
        _ => return Err(refuse()),
    };
    match (letter, size) {
        ('f', 4 | 8) => Ok(Kind::Float { size, big }),
        ('U', 1..=1024) => Ok(Kind::Text { length: size, big }),
        ('S', 1..=1024) => Ok(Kind::Bytes { length: size }),
        _ => Err(refuse()),
    }
}

fn shape(text: &str) -> Result<Vec<usize>, Failure> {
    let refuse = || (String::from("has a header without a shape"), "");
    let inner = text.strip_prefix('(').and_then(|t| t.split_once(')')).ok_or_else(refuse)?.0;
    let numbers = inner.split(',').map(str::trim).filter(|n| !n.is_empty());
    numbers.map(|n| n.parse().map_err(|_| refuse())).collect()
}

impl Kind {
    fn size(self) -> usize {
        match self {
            Self::Float { size, .. } => size,
            Self::Text { length, .. } => 4 * length,
            Self::Bytes { length } => length,
        }
    }
}

impl Array<'_> {
    /// Element by number, as it stands in the file.
    fn number(&self, index: usize) -> f64 {
        let Kind::Float { size, big } = self.kind else { return f64::NAN };
        let bytes = &self.data[index * size..][..size];
        let flip = |i: usize| bytes[if big { size - 1 - i } else { i }];
        match size {
            4 => f32::from_le_bytes(std::array::from_fn(flip)).into(),
            _ => f64::from_le_bytes(std::array::from_fn(flip)),
        }
    }

    fn refuse_text(&self) -> Result<(), Failure> {
        match self.kind {
            Kind::Float { .. } => Ok(()),
            Kind::Text { .. } | Kind::Bytes { .. } => Err((String::from("holds text"), "floats are wanted here")),
        }
    }

    /// Rows of a matrix; a row alone is a matrix of one.
    fn matrix(&self) -> Result<Vec<Vec<f64>>, Failure> {
        self.refuse_text()?;
        let (rows, columns) = match *self.shape.as_slice() {
            [rows, columns] => (rows, columns),
            ref other => return Err((format!("has shape {other:?}"), "one row a state is wanted: (states, joints)")),
        };
        if rows > POINTS || columns > COLUMNS {
            return Err((format!("has shape {:?}", self.shape), "at most 1048576 states of 10000 joints are read"));
        }
        let place = |r: usize, c: usize| if self.fortran { c * rows + r } else { r * columns + c };
        Ok((0..rows).map(|r| (0..columns).map(|c| self.number(place(r, c))).collect()).collect())
    }

    /// Numbers of a row or a column.
    #[cfg(feature = "cli")]
    fn row(&self) -> Result<Vec<f64>, Failure> {
        self.refuse_text()?;
        let count: usize = self.shape.iter().product();
        match self.shape.iter().filter(|n| **n != 1).count() {
            0 | 1 => Ok((0..count).map(|i| self.number(i)).collect()),
            _ => Err((format!("has shape {:?}", self.shape), "one number a state is wanted")),
        }
    }

    /// Names, without what fills them up.
    #[cfg(feature = "cli")]
    fn names(&self) -> Result<Vec<String>, Failure> {
        let count: usize = self.shape.iter().product();
        if count > COLUMNS {
            return Err((format!("has {count} names"), "at most 10000 are read"));
        }
        let size = self.kind.size();
        let name = |i: usize| {
            let bytes = &self.data[i * size..][..size];
            let text: String = match self.kind {
                Kind::Text { big, .. } => bytes.chunks_exact(4).map(|c| character(c, big)).collect(),
                _ => String::from_utf8_lossy(bytes).into_owned(),
            };
            text.trim_end_matches('\0').to_owned()
        };
        match self.kind {
            Kind::Float { .. } => Err((String::from("holds numbers"), "names are text")),
            Kind::Text { .. } | Kind::Bytes { .. } => Ok((0..count).map(name).collect()),
        }
    }
}

#[cfg(feature = "cli")]
fn character(bytes: &[u8], big: bool) -> char {
    let number = bytes.iter().enumerate().fold(0_u32, |sum, (i, &byte)| {
        let place = if big { 3 - i } else { i };
        sum | u32::from(byte) << (8 * place)
    });
    char::from_u32(number).unwrap_or(char::REPLACEMENT_CHARACTER)
}

/// Without the command line nothing unpacks archives.
#[cfg(not(feature = "cli"))]
pub(super) fn npz(file: &str, _content: Vec<u8>) -> Result<Table, SceneError> {
    let message = "archives are read only where Foliate is built with its feature `cli`";
    Err(SceneError::new(file, "archive", message).hint("write positions as .npy"))
}

#[cfg(feature = "cli")]
pub(super) fn npz(file: &str, content: Vec<u8>) -> Result<Table, SceneError> {
    archive::read(file, content)
}

#[cfg(feature = "cli")]
mod archive {
    use super::{Failure, parse};
    use crate::certify::formats::table::{CAP, Table};
    use crate::certify::motion::piecewise::Point;
    use crate::scene::reading::error::SceneError;
    use std::io::{Cursor, Read};

    /// Names of arrays; the first is the one that is documented.
    const POSITIONS: &[&str] = &["positions", "q", "position"];
    const TIMES: &[&str] = &["times", "time", "t"];
    const VELOCITIES: &[&str] = &["velocities", "qd", "velocity"];
    const ACCELERATIONS: &[&str] = &["accelerations", "qdd", "acceleration"];
    const NAMES: &[&str] = &["names", "joint_names"];

    struct Archive<'a> {
        file: &'a str,
        zip: zip::ZipArchive<Cursor<Vec<u8>>>,
        /// Bytes that may still be unpacked.
        left: u64,
    }

    pub(super) fn read(file: &str, content: Vec<u8>) -> Result<Table, SceneError> {
        let zip = zip::ZipArchive::new(Cursor::new(content));
        let zip = zip.map_err(|e| SceneError::new(file, "archive", format!("cannot be read: {e}")))?;
        let mut archive = Archive { file, zip, left: CAP };
        let Some((_, positions)) = archive.array(POSITIONS, |bytes| parse(bytes)?.matrix())? else {
            let names = archive.zip.file_names().take(16).filter_map(Result::ok);
            let have: Vec<_> = names.map(|name| crate::scene::reading::error::quoted(&name)).collect();
            let message = "has no array `positions`";
            return Err(SceneError::new(file, "archive", message).hint(format!("it holds {}", have.join(", "))));
        };
        let times = archive.array(TIMES, |bytes| parse(bytes)?.row())?;
        let velocities = archive.array(VELOCITIES, |bytes| parse(bytes)?.matrix())?;
        let accelerations = archive.array(ACCELERATIONS, |bytes| parse(bytes)?.matrix())?;
        let names = archive.array(NAMES, |bytes| parse(bytes)?.names())?;
        let rows = positions.len();
        let counts = [
            times.as_ref().map(|(name, rows)| (name, rows.len())),
            velocities.as_ref().map(|(name, rows)| (name, rows.len())),
            accelerations.as_ref().map(|(name, rows)| (name, rows.len())),
        ];
        if let Some((name, count)) = counts.into_iter().flatten().find(|(_, count)| *count != rows) {
            return Err(SceneError::new(file, *name, format!("has {count} rows, and positions have {rows}")));
        }
        let mut velocities = velocities.map(|(_, rows)| rows.into_iter());
        let mut accelerations = accelerations.map(|(_, rows)| rows.into_iter());
        let mut points = Vec::with_capacity(rows);
        for (index, positions) in positions.into_iter().enumerate() {
            points.push(Point {
                time: times.as_ref().map(|(_, times)| times[index]),
                positions,
                velocities: velocities.as_mut().and_then(Iterator::next),
                accelerations: accelerations.as_mut().and_then(Iterator::next),
            });
        }
        Ok(Table { points, joints: names.map(|(_, names)| names), element: "positions", ..Table::default() })
    }

    impl Archive<'_> {
        /// The first array that has one of these names.
        fn array<T>(
            &mut self,
            names: &[&'static str],
            make: impl Fn(&[u8]) -> Result<T, Failure>,
        ) -> Result<Option<(&'static str, T)>, SceneError> {
            for &name in names {
                let Ok(entry) = self.zip.by_name(&format!("{name}.npy")) else { continue };
                let fail = |message: String| SceneError::new(self.file, name, message);
                let mut bytes = Vec::new();
                let read = entry.take(self.left + 1).read_to_end(&mut bytes);
                read.map_err(|e| fail(format!("cannot be unpacked: {e}")))?;
                self.left = self
                    .left
                    .checked_sub(bytes.len() as u64)
                    .ok_or_else(|| fail(format!("unpacks to more than {CAP} bytes")).hint("cut the motion up"))?;
                let made = make(&bytes).map_err(|(message, hint)| fail(message).hint(hint))?;
                return Ok(Some((name, made)));
            }
            Ok(None)
        }
    }
}
