//! XML, which may be hostile: a scan for depth, counts and document types first, then a tree with line numbers.

use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::reading::limits::look;
use foliate_systems::events::StopSignal;
use roxmltree::{Document, Node};

/// Deepest nesting of elements.
const DEPTH: usize = 200;
/// Most elements in a file.
const ELEMENTS: usize = 400_000;
/// Most attributes in a file.
const ATTRIBUTES: usize = 800_000;
/// Most attributes of one element; the parser compares them pairwise.
const ATTRIBUTES_OF_ONE: usize = 128;
/// Most namespace declarations in a file; the parser searches them linearly.
const NAMESPACES: usize = 64;

/// Tags between two checks of the signal that stops the reading.
const TAGS_BETWEEN_LOOKS: usize = 1 << 12;
/// Numbers between two checks.
const NUMBERS_BETWEEN_LOOKS: usize = 1 << 16;

/// A parsed file that knows its name.
pub(crate) struct Xml<'a> {
    pub file: &'a str,
    pub document: Document<'a>,
    /// Byte offset at which each line begins, for line numbers in logarithmic time.
    line_starts: Vec<usize>,
    /// Ends the reading.
    stop: StopSignal,
}

impl<'a> Xml<'a> {
    /// Parses a text after the scan. Of files with thousands of elements or numbers the reading ends once the signal is raised.
    ///
    /// # Errors
    /// Malformed XML, a document type, or more of anything than the caps allow; with the line.
    pub fn parse(file: &'a str, text: &'a str, stop: &StopSignal) -> Result<Self, SceneError> {
        scan(file, text, stop)?;
        let options = roxmltree::ParsingOptions { allow_dtd: false, nodes_limit: 4_000_000 };
        let document = Document::parse_with_options(text, options).map_err(|error| {
            let row = error.pos().row;
            let told = SceneError::new(file, "XML", error.to_string()).at(row).because(error);
            told.hint("the file is not well-formed XML")
        })?;
        let line_starts = std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect();
        Ok(Self { file, document, line_starts, stop: stop.clone() })
    }

    /// Checks the signal now and then, by the number of elements that were read so far.
    pub fn look(&self, elements: usize) -> Result<(), SceneError> {
        match elements > 0 && elements.is_multiple_of(TAGS_BETWEEN_LOOKS) {
            true => look(&self.stop, self.file),
            false => Ok(()),
        }
    }

    /// The words of a text that holds numbers; the signal is checked now and then.
    pub fn words<'t>(&self, text: &'t str) -> impl Iterator<Item = Result<&'t str, SceneError>> {
        text.split_ascii_whitespace().enumerate().map(|(index, word)| {
            if index > 0 && index.is_multiple_of(NUMBERS_BETWEEN_LOOKS) {
                look(&self.stop, self.file)?;
            }
            Ok(word)
        })
    }

    /// The line of a node, counted from 1.
    pub fn line(&self, node: Node<'_, '_>) -> u32 {
        self.line_starts.partition_point(|&start| start <= node.range().start) as u32
    }

    /// An error about a node.
    pub fn error(&self, node: Node<'_, '_>, message: impl Into<String>) -> SceneError {
        SceneError::new(self.file, label(node), message).at(self.line(node))
    }

    /// An attribute that must be there and say something.
    pub fn attribute<'n>(&self, node: Node<'n, '_>, name: &str) -> Result<&'n str, SceneError> {
        match node.attribute(name) {
            Some(value) if !value.trim().is_empty() => Ok(value),
            Some(_) => Err(self.error(node, format!("attribute `{name}` is empty"))),
            None => Err(self.error(node, format!("attribute `{name}` is missing"))),
        }
    }

    /// The one child element of that name, or none.
    ///
    /// # Errors
    /// Where there are several.
    pub fn optional_child<'n, 'i>(&self, node: Node<'n, 'i>, name: &str) -> Result<Option<Node<'n, 'i>>, SceneError> {
        let mut found = elements(node, name);
        let first = found.next();
        match found.next() {
            Some(second) => Err(self.error(second, format!("a second <{name}> in {}", label(node)))),
            None => Ok(first),
        }
    }

    /// The one child element of that name.
    ///
    /// # Errors
    /// Where there is none, or several.
    pub fn child<'n, 'i>(&self, node: Node<'n, 'i>, name: &str) -> Result<Node<'n, 'i>, SceneError> {
        self.optional_child(node, name)?.ok_or_else(|| self.error(node, format!("<{name}> is missing")))
    }

    /// A number in an attribute, if the attribute is there.
    pub fn number(&self, node: Node<'_, '_>, name: &str) -> Result<Option<f64>, SceneError> {
        let Some(text) = node.attribute(name) else { return Ok(None) };
        match self.numbers(node, &format!("attribute `{name}`"), text)?.as_slice() {
            [x] => Ok(Some(*x)),
            other => Err(self.error(node, format!("attribute `{name}` wants one number, got {}", other.len()))),
        }
    }

    /// Exactly three numbers in an attribute, if the attribute is there.
    pub fn vector(&self, node: Node<'_, '_>, name: &str) -> Result<Option<[f64; 3]>, SceneError> {
        self.array(node, name)
    }

    /// Exactly so many numbers in an attribute, if the attribute is there.
    pub fn array<const N: usize>(&self, node: Node<'_, '_>, name: &str) -> Result<Option<[f64; N]>, SceneError> {
        let Some(text) = node.attribute(name) else { return Ok(None) };
        let numbers = self.numbers(node, &format!("attribute `{name}`"), text)?;
        <[f64; N]>::try_from(numbers.as_slice())
            .map(Some)
            .map_err(|_| self.error(node, format!("attribute `{name}` wants {N} numbers, got {}", numbers.len())))
    }

    /// All numbers of a text, each of them finite.
    pub fn numbers(&self, node: Node<'_, '_>, what: &str, text: &str) -> Result<Vec<f64>, SceneError> {
        self.words(text)
            .map(|word| {
                word.and_then(|word| match word.parse::<f64>() {
                    Ok(x) if x.is_finite() => Ok(x),
                    Ok(_) => Err(self.error(node, format!("{what} holds `{}`, which is not finite", quoted(word)))),
                    Err(_) => Err(self
                        .error(node, format!("{what} holds `{}`, which is not a number", quoted(word)))
                        .hint("numbers are separated by blanks and use a decimal point")),
                })
            })
            .collect()
    }
}

/// Child elements of that local name.
pub(crate) fn elements<'n, 'i>(node: Node<'n, 'i>, name: &str) -> impl Iterator<Item = Node<'n, 'i>> {
    node.children().filter(move |n| n.is_element() && n.tag_name().name() == name)
}

/// `<tag name="…">`, for messages.
pub(crate) fn label(node: Node<'_, '_>) -> String {
    let tag = quoted(node.tag_name().name());
    let named = |n: Node<'_, '_>| n.attribute("name").or(n.attribute("id")).map(quoted);
    match (named(node), node.parent_element().filter(|p| p.parent_element().is_some())) {
        (Some(name), _) => format!("<{tag} name=\"{name}\">"),
        (None, Some(parent)) => match named(parent) {
            Some(name) => format!("<{tag}> of <{} name=\"{name}\">", quoted(parent.tag_name().name())),
            None => format!("<{tag}> in <{}>", quoted(parent.tag_name().name())),
        },
        (None, None) => format!("<{tag}>"),
    }
}

/// What the scan has counted.
#[derive(Default)]
struct Counts {
    elements: usize,
    attributes: usize,
    namespaces: usize,
    depth: usize,
}

/// Scans the markup without building anything, and refuses what could exhaust the parser.
fn scan(file: &str, text: &str, stop: &StopSignal) -> Result<(), SceneError> {
    let bytes = text.as_bytes();
    let mut counts = Counts::default();
    let (mut at, mut tags) = (0_usize, 0_usize);
    while let Some(open) = text[at..].find('<').map(|i| at + i) {
        tags += 1;
        if tags.is_multiple_of(TAGS_BETWEEN_LOOKS) {
            look(stop, file)?;
        }
        let rest = &bytes[open..];
        let refuse = |element: &str, message: String| {
            let line = 1 + bytes[..open].iter().filter(|&&b| b == b'\n').count() as u32;
            SceneError::new(file, element, message).at(line)
        };
        let skip = |end: &str, what: &str| match text[open..].find(end) {
            Some(i) => Ok(open + i + end.len()),
            None => Err(refuse(what, format!("is never closed: `{end}` is missing")).hint("the file is cut off")),
        };
        at = if rest.starts_with(b"<!--") {
            skip("-->", "comment")?
        } else if rest.starts_with(b"<![CDATA[") {
            skip("]]>", "CDATA")?
        } else if rest.starts_with(b"<?") {
            skip("?>", "processing instruction")?
        } else if rest.starts_with(b"<!") {
            return Err(refuse("<!DOCTYPE>", "document types and entities are not read".into())
                .hint("remove the <!DOCTYPE …> and write its entities out"));
        } else {
            let (end, attributes, namespaces) = tag(bytes, open).ok_or_else(|| {
                refuse(&opened(text, open), "is never closed: `>` is missing".into()).hint("the file is cut off")
            })?;
            counts.attributes += attributes;
            counts.namespaces += namespaces;
            match (rest.get(1), bytes[end - 1]) {
                (Some(b'/'), _) => counts.depth = counts.depth.saturating_sub(1),
                (_, b'/') => counts.elements += 1,
                _ => {
                    counts.elements += 1;
                    counts.depth += 1;
                }
            }
            if let Some(excess) = counts.excess(attributes) {
                return Err(refuse(&opened(text, open), excess).hint("no model needs that many"));
            }
            end + 1
        };
    }
    Ok(())
}

impl Counts {
    fn excess(&self, attributes_of_one: usize) -> Option<String> {
        [
            (self.depth, DEPTH, "elements are nested deeper than"),
            (self.elements, ELEMENTS, "there are more elements than"),
            (self.attributes, ATTRIBUTES, "there are more attributes than"),
            (attributes_of_one, ATTRIBUTES_OF_ONE, "one element has more attributes than"),
            (self.namespaces, NAMESPACES, "there are more namespaces than"),
        ]
        .into_iter()
        .find(|(count, cap, _)| count > cap)
        .map(|(_, cap, what)| format!("{what} {cap}"))
    }
}

/// End of the tag that opens at `open` (index of its `>`), its number of attributes, and of those that declare namespaces.
fn tag(bytes: &[u8], open: usize) -> Option<(usize, usize, usize)> {
    let (mut quote, mut attributes, mut namespaces) = (None, 0, 0);
    let mut word = open;
    for (i, &b) in bytes.iter().enumerate().skip(open + 1) {
        match quote {
            Some(q) if b == q => quote = None,
            Some(_) => {}
            None => match b {
                b'"' | b'\'' => quote = Some(b),
                b'>' => return Some((i, attributes, namespaces)),
                b'=' => {
                    attributes += 1;
                    namespaces += usize::from(bytes[word..i].starts_with(b"xmlns"));
                }
                b if b.is_ascii_whitespace() => word = i + 1,
                _ => {}
            },
        }
    }
    None
}

/// `<tag>` as it opens at a byte, for messages of the scan.
fn opened(text: &str, open: usize) -> String {
    let name: String = text[open + 1..]
        .trim_start_matches('/')
        .chars()
        .take_while(|c| !c.is_whitespace() && !matches!(c, '>' | '/'))
        .take(40)
        .collect();
    format!("<{}>", quoted(&name))
}
