//! Prefixes of XML names that a file does not declare, as in `<drake:proximity_properties>` without `xmlns:drake`: lenient readers take
//! them, and published models have them.
//!
//! The text gets the declaration, in the tag of its root: no line moves. The reader of the format says so.

use roxmltree::Node;

/// What undeclared prefixes are declared as, and the prefix.
const UNDECLARED: &str = "urn:undeclared:";
/// Most prefixes that are declared.
const MOST: usize = 16;

/// A text whose root declares all prefixes of its elements and attributes.
pub(crate) fn declared(text: String) -> String {
    let Some((end_of_name, used)) = prefixes(&text) else { return text };
    let is_open = |prefix: &&str| !text.contains(&format!("xmlns:{prefix}"));
    let missing: Vec<&str> = used.into_iter().filter(is_open).collect();
    if missing.is_empty() {
        return text;
    }
    let words = missing.iter().map(|prefix| format!(" xmlns:{prefix}=\"{UNDECLARED}{prefix}\"")).collect::<String>();
    format!("{}{words}{}", &text[..end_of_name], &text[end_of_name..])
}

/// The prefixes that were not declared in a file, in the order of their declarations.
pub(crate) fn undeclared<'a>(root: Node<'a, '_>) -> impl Iterator<Item = &'a str> {
    root.namespaces().filter_map(|namespace| namespace.uri().strip_prefix(UNDECLARED))
}

/// The end of the root's name in its tag, and the prefixes of all elements and attributes, each once; none of a text with a document type, which
/// is refused later.
fn prefixes(text: &str) -> Option<(usize, Vec<&str>)> {
    let (mut root, mut found) = (None, Vec::new());
    let mut at = 0;
    while let Some(open) = text[at..].find('<').map(|i| at + i) {
        let rest = &text[open..];
        let past = |end: &str| rest.find(end).map(|i| open + i + end.len());
        at = match () {
            () if rest.starts_with("<!--") => past("-->")?,
            () if rest.starts_with("<![CDATA[") => past("]]>")?,
            () if rest.starts_with("<?") => past("?>")?,
            () if rest.starts_with("<!") => return None,
            () => {
                let length = rest[1..].find(|c: char| c.is_whitespace() || matches!(c, '>' | '/' | '<'));
                let end = open + 1 + length.unwrap_or(rest.len() - 1);
                root.get_or_insert(end);
                let past = end_of_tag(text, end)?;
                for name in std::iter::once(&text[open + 1..end]).chain(attributes(&text[end..past])) {
                    let prefix = name.split_once(':').map(|(prefix, _)| prefix).filter(|prefix| is_plain(prefix));
                    if let Some(prefix) = prefix.filter(|prefix| !found.contains(prefix) && found.len() < MOST) {
                        found.push(prefix);
                    }
                }
                past
            }
        };
    }
    Some((root?, found))
}

/// Where the tag ends whose name ends at a place.
fn end_of_tag(text: &str, from: usize) -> Option<usize> {
    let mut quote = None;
    for (at, &byte) in text.as_bytes()[from..].iter().enumerate() {
        match (quote, byte) {
            (None, b'>') => return Some(from + at),
            (None, b'"' | b'\'') => quote = Some(byte),
            (Some(open), _) if open == byte => quote = None,
            _ => {}
        }
    }
    None
}

/// The names of attributes in what stands behind the name of a tag, as far as their values are in double quotation marks.
fn attributes(text: &str) -> impl Iterator<Item = &str> {
    let outside = text.split('"').step_by(2);
    outside.filter_map(|piece| piece.trim_end().strip_suffix('=')?.split_whitespace().next_back())
}

/// Whether it may be a prefix.
fn is_plain(prefix: &str) -> bool {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.');
    prefix.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && prefix.chars().all(is_letter)
        && !prefix.starts_with("xml")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_used_and_not_declared_is_declared_in_the_root() {
        let text = "<?xml version=\"1.0\"?>\n<!-- <old:a/> -->\n<robot name=\"r\" xmlns:b=\"u\">\n<a:x/><b:y/><a:z>1</a:z><l d:m=\"x > 1\" e = \"2\" f:g = \"3\"/>\n</robot>";
        let now = declared(text.to_owned());
        let names = ["a", "d", "f"].map(|prefix| format!(" xmlns:{prefix}=\"urn:undeclared:{prefix}\"")).concat();
        assert_eq!(now, text.replace("<robot", &format!("<robot{names}")));
        let document = roxmltree::Document::parse(&now).unwrap();
        assert_eq!(undeclared(document.root_element()).collect::<Vec<_>>(), ["a", "d", "f"]);
    }

    #[test]
    fn other_texts_stay_as_they_are() {
        for text in [
            "",
            "<",
            "<robot/>",
            "<!DOCTYPE a><a:b/>",
            "<a:b c=\"",
            "<r><!-- <a:b/>",
            "<r xmlns:a='u'><a:b/></r>",
            "<r><1:b/></r>",
        ] {
            assert_eq!(declared(text.to_owned()), text);
        }
    }
}
