//! Where in a JSON text an error is, as a path such as `segments[3].knots[0]`.

use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::marker::PhantomData;

/// The path of the value that ends or is cut off at a line and column (counted from 1, in bytes).
pub(crate) fn json_path(text: &str, line: usize, column: usize) -> String {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let end = (start + column).saturating_sub(1).min(text.len());
    let mut walk = Walk { steps: Vec::new() };
    let mut bytes = text.as_bytes()[..end].iter().copied();
    while let Some(byte) = bytes.next() {
        match byte {
            b'"' => walk.string(&string(&mut bytes)),
            b'{' => walk.steps.push(Step::Key { name: String::new(), awaited: true }),
            b'[' => walk.steps.push(Step::Index(0)),
            b'}' | b']' => drop(walk.steps.pop()),
            b',' => walk.comma(),
            _ => {}
        }
    }
    walk.told()
}

enum Step {
    Key { name: String, awaited: bool },
    Index(usize),
}

struct Walk {
    steps: Vec<Step>,
}

impl Walk {
    fn string(&mut self, content: &str) {
        if let Some(Step::Key { name, awaited: awaited @ true }) = self.steps.last_mut() {
            (*name, *awaited) = (content.to_owned(), false);
        }
    }

    fn comma(&mut self) {
        match self.steps.last_mut() {
            Some(Step::Key { awaited, .. }) => *awaited = true,
            Some(Step::Index(index)) => *index += 1,
            None => {}
        }
    }

    fn told(&self) -> String {
        let mut out = String::new();
        for step in &self.steps {
            match step {
                Step::Key { name, .. } if name.is_empty() => {}
                Step::Key { name, .. } if name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') => {
                    let dot = if out.is_empty() { "" } else { "." };
                    let _ = write!(out, "{dot}{name}");
                }
                Step::Key { name, .. } => {
                    let short: String = name.chars().take(80).flat_map(char::escape_debug).collect();
                    let _ = write!(out, "[\"{short}\"]");
                }
                Step::Index(index) => {
                    let _ = write!(out, "[{index}]");
                }
            }
        }
        if out.is_empty() { "the file".into() } else { out }
    }
}

/// The content of a string whose opening quote has been read; escapes stay as written.
fn string(bytes: &mut impl Iterator<Item = u8>) -> String {
    let mut content = Vec::new();
    while let Some(byte) = bytes.next() {
        match byte {
            b'"' => break,
            b'\\' => content.extend(bytes.next()),
            other => content.push(other),
        }
    }
    String::from_utf8_lossy(&content).into_owned()
}

/// A table in which no key is given twice: other readers of the file may take the other value.
pub(super) fn unique<'de, D, T>(deserializer: D) -> Result<BTreeMap<String, T>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    struct Table<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for Table<T> {
        type Value = BTreeMap<String, T>;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str("an object")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut table = BTreeMap::new();
            while let Some((key, value)) = map.next_entry::<String, T>()? {
                if table.contains_key(&key) {
                    let short: String = key.chars().take(80).flat_map(char::escape_debug).collect();
                    return Err(A::Error::custom(format_args!("key `{short}` is given twice")));
                }
                table.insert(key, value);
            }
            Ok(table)
        }
    }
    deserializer.deserialize_map(Table(PhantomData))
}

/// As [`unique`], for a key that may be left out.
pub(super) fn unique_if_any<'de, D, T>(deserializer: D) -> Result<Option<BTreeMap<String, T>>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    unique(deserializer).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_told_by_keys_and_indices() {
        let text = "{\"a\": [1, {\"b c\": \"x,{[\\\"\", \"d\":\n [0, 1, oops]}]}";
        assert_eq!(json_path(text, 2, 11), "a[1].d[2]");
        assert_eq!(json_path(text, 1, 10), "a[1]");
        assert_eq!(json_path(text, 1, 27), "a[1][\"b c\"]");
        assert_eq!(json_path("", 1, 0), "the file");
        assert_eq!(json_path("{\"ä", 9, 9), "[\"ä\"]");
    }
}
