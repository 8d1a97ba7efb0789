//! A tree of values, written as JSON or as YAML in the order in which it was made.

use std::fmt::Write;

/// A value of a message.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    Map(Vec<(String, Node)>),
    List(Vec<Node>),
    Real(f64),
    Whole(u64),
    Text(String),
}

impl Node {
    pub fn map<const N: usize>(entries: [(&str, Node); N]) -> Self {
        Self::Map(entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
    }

    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    pub fn reals(numbers: impl IntoIterator<Item = f64>) -> Self {
        Self::List(numbers.into_iter().map(Self::Real).collect())
    }

    pub fn texts<T: Into<String>>(texts: impl IntoIterator<Item = T>) -> Self {
        Self::List(texts.into_iter().map(|text| Self::Text(text.into())).collect())
    }

    /// The value as JSON, with a line break at the end.
    pub fn json(&self) -> String {
        let mut out = String::new();
        self.write_json(&mut out, 0);
        out.push('\n');
        out
    }

    /// The value as YAML 1.1 and 1.2 read it.
    pub fn yaml(&self) -> String {
        let mut out = String::new();
        match self {
            node if node.is_flat() => {
                node.write_flat(&mut out);
                out.push('\n');
            }
            node => node.write_block(&mut out, 0, false),
        }
        out
    }

    /// Whether it is written on one line.
    fn is_flat(&self) -> bool {
        let is_leaf = |node: &Self| matches!(node, Self::Real(_) | Self::Whole(_) | Self::Text(_));
        match self {
            Self::Map(entries) => entries.iter().all(|(_, value)| is_leaf(value)),
            Self::List(items) => items.iter().all(is_leaf),
            leaf => is_leaf(leaf),
        }
    }

    /// On one line, which is JSON and YAML.
    fn write_flat(&self, out: &mut String) {
        match self {
            Self::Real(x) => out.push_str(&real(*x)),
            Self::Whole(n) => drop(write!(out, "{n}")),
            Self::Text(text) => out.push_str(&quoted(text)),
            Self::List(items) => {
                out.push('[');
                for (index, item) in items.iter().enumerate() {
                    out.push_str(if index > 0 { ", " } else { "" });
                    item.write_flat(out);
                }
                out.push(']');
            }
            Self::Map(entries) => {
                out.push('{');
                for (index, (key, value)) in entries.iter().enumerate() {
                    let comma = if index > 0 { ", " } else { "" };
                    let _ = write!(out, "{comma}{}: ", quoted(key));
                    value.write_flat(out);
                }
                out.push('}');
            }
        }
    }

    fn write_json(&self, out: &mut String, depth: usize) {
        let pad = |out: &mut String, depth: usize| out.extend(std::iter::repeat_n("  ", depth));
        let separate = |out: &mut String, index: usize| {
            out.push_str(if index > 0 { ",\n" } else { "\n" });
            pad(out, depth + 1);
        };
        match self {
            node if node.is_flat() => node.write_flat(out),
            Self::Map(entries) => {
                out.push('{');
                for (index, (key, value)) in entries.iter().enumerate() {
                    separate(out, index);
                    let _ = write!(out, "{}: ", quoted(key));
                    value.write_json(out, depth + 1);
                }
                out.push('\n');
                pad(out, depth);
                out.push('}');
            }
            Self::List(items) => {
                out.push('[');
                for (index, item) in items.iter().enumerate() {
                    separate(out, index);
                    item.write_json(out, depth + 1);
                }
                out.push('\n');
                pad(out, depth);
                out.push(']');
            }
            leaf => leaf.write_flat(out),
        }
    }

    /// A list or map on several lines. `begun`: the first line is indented already.
    fn write_block(&self, out: &mut String, depth: usize, begun: bool) {
        let pad = |out: &mut String, index: usize| {
            let begun = begun && index == 0;
            out.extend(std::iter::repeat_n("  ", if begun { 0 } else { depth }));
        };
        match self {
            Self::Map(entries) => {
                for (index, (key, value)) in entries.iter().enumerate() {
                    pad(out, index);
                    let plain = !key.is_empty() && key.bytes().all(|b| b.is_ascii_lowercase() || b == b'_');
                    let _ = if plain { write!(out, "{key}:") } else { write!(out, "{}:", quoted(key)) };
                    if value.is_flat() {
                        out.push(' ');
                        value.write_flat(out);
                        out.push('\n');
                    } else {
                        out.push('\n');
                        value.write_block(out, depth + 1, false);
                    }
                }
            }
            Self::List(items) => {
                for (index, item) in items.iter().enumerate() {
                    pad(out, index);
                    out.push_str("- ");
                    if item.is_flat() {
                        item.write_flat(out);
                        out.push('\n');
                    } else {
                        item.write_block(out, depth + 1, true);
                    }
                }
            }
            leaf => leaf.write_flat(out),
        }
    }
}

/// A string as JSON writes it, which YAML reads too.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// The shortest number that reads back bit for bit. YAML 1.1 takes `1e-7` for text: a point and a sign are needed.
fn real(x: f64) -> String {
    let text = format!("{x:?}");
    let Some((mantissa, exponent)) = text.split_once('e') else { return text };
    let point = if mantissa.contains('.') { "" } else { ".0" };
    let sign = if exponent.starts_with('-') { "" } else { "+" };
    format!("{mantissa}{point}e{sign}{exponent}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_numbers_in_json_and_in_yaml() {
        assert_eq!(real(1e-7), "1.0e-7");
        assert_eq!(real(-2.5e300), "-2.5e+300");
        assert_eq!(real(0.1), "0.1");
        assert_eq!(real(3.0), "3.0");
    }

    #[test]
    fn json_says_what_was_put_in() {
        let node = Node::map([
            ("names", Node::texts(["a\"b", "c"])),
            (
                "points",
                Node::List(vec![Node::map([("t", Node::map([("sec", Node::Whole(3))])), ("x", Node::reals([1e-9]))])]),
            ),
            ("none", Node::List(Vec::new())),
        ]);
        let read: serde_json::Value = serde_json::from_str(&node.json()).expect("JSON");
        let wanted =
            serde_json::json!({"names": ["a\"b", "c"], "points": [{"t": {"sec": 3}, "x": [1e-9]}], "none": []});
        assert_eq!(read, wanted);
        let yaml = "names: [\"a\\\"b\", \"c\"]\npoints:\n  - t: {\"sec\": 3}\n    x: [1.0e-9]\nnone: []\n";
        assert_eq!(node.yaml(), yaml);
    }
}
