//! One error for everything that is read: where, what, and the way out.

use std::fmt;
use std::sync::Arc;

/// Something in a file that cannot be read, or (as a warning) should be reviewed.
///
/// Displays as `file:line: element: message (hint)`; formats without lines leave the line out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneError {
    /// The file, as the user would find it.
    pub file: String,
    /// Line, counted from 1, where the format has lines.
    pub line: Option<u32>,
    /// The element: `<joint name="elbow">`, a key such as `part[0].urdf`, `triangle 12`.
    pub element: String,
    /// What is wrong.
    pub message: String,
    /// What to do about it; may be empty.
    pub hint: String,
    /// Set where nothing is wrong with the file, but reading was not to take longer, or more memory.
    pub stopped: Option<LoadStop>,
    /// The error of the system or of a parser that this one was made of; `message` says it in words.
    pub source: Option<ErrorSource>,
}

/// An error of another kind, shared, since errors of scenes can be cloned. Two are equal where they say the same. In a box, so
/// that it takes one pointer in each result.
#[derive(Clone, Debug)]
pub struct ErrorSource(Arc<Box<dyn std::error::Error + Send + Sync>>);

impl PartialEq for ErrorSource {
    fn eq(&self, other: &Self) -> bool {
        self.0.to_string() == other.0.to_string()
    }
}

impl Eq for ErrorSource {}

impl SceneError {
    /// An error about an element of a file.
    #[must_use]
    pub fn new(file: impl Into<String>, element: impl Into<String>, message: impl Into<String>) -> Self {
        Self { file: file.into(), element: element.into(), message: message.into(), ..Self::default() }
    }

    /// Adds the line.
    #[must_use]
    pub fn at(mut self, line: impl Into<Option<u32>>) -> Self {
        self.line = line.into();
        self
    }

    /// Adds the error that it was made of.
    #[must_use]
    pub fn because(mut self, source: impl std::error::Error + Send + Sync + 'static) -> Self {
        self.source = Some(ErrorSource(Arc::new(Box::new(source))));
        self
    }

    /// Adds the way out.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = hint.into();
        self
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": {}: {}", self.element, self.message)?;
        if !self.hint.is_empty() {
            write!(f, " ({})", self.hint)?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.source.as_ref().map(|source| &**source.0 as &(dyn std::error::Error + 'static))
    }
}

/// Text from a file, made fit for one line of a terminal: control characters escaped, long runs shortened.
#[must_use]
pub(crate) fn quoted(text: &str) -> String {
    const LONGEST: usize = 80;
    let mut shown: String = text.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    if text.chars().nth(LONGEST).is_some() {
        shown.push('…');
    }
    shown
}

/// The candidate nearest to `name`, where it is near enough to be what was meant.
#[must_use]
pub(crate) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let allowed = (name.chars().count() / 3).clamp(1, 3);
    candidates
        .into_iter()
        .filter(|c| c.len().abs_diff(name.len()) <= 2 * allowed)
        .map(|c| (edit_distance(name, c, allowed), c))
        .filter(|(d, _)| *d <= allowed)
        .min_by_key(|(d, _)| *d)
        .map(|(_, c)| c)
}

/// A hint of the form "did you mean `x`?", or the whole list where it is short, or nothing.
#[must_use]
pub(crate) fn did_you_mean<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    let candidates: Vec<&str> = candidates.into_iter().collect();
    // Names are compared without their part, too: `r_gripper` means `baxter/r_gripper`.
    let unprefixed = || candidates.iter().copied().find(|c| c.rsplit('/').next() == Some(name) && *c != name);
    match nearest(name, candidates.iter().copied()).or_else(unprefixed) {
        Some(near) => format!("did you mean `{near}`?"),
        None if candidates.is_empty() => String::new(),
        None if candidates.len() <= 16 => format!("known: {}", candidates.join(", ")),
        None => format!("{} are known, such as {}", candidates.len(), candidates[..4].join(", ")),
    }
}

/// Edits (of one letter, or two neighbours swapped) that make one word of the other, given up beyond `limit`.
fn edit_distance(a: &str, b: &str, limit: usize) -> usize {
    const LONGEST: usize = 256;
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().take(LONGEST).collect(), b.chars().take(LONGEST).collect());
    let mut before = vec![0; b.len() + 1];
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut next = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let substituted = row[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            next[j] = substituted.min(row[j] + 1).min(next[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                next[j] = next[j].min(before[j - 2] + 1);
            }
        }
        if next.iter().all(|d| *d > limit) {
            return limit + 1;
        }
        before = std::mem::replace(&mut row, next);
    }
    row[b.len()]
}

/// Why reading was stopped although nothing was wrong with what was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadStop {
    /// The deadline has passed.
    Deadline,
    /// The host's token is cancelled.
    Cancelled,
    /// There is not enough memory left.
    Memory,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_says_where_what_and_the_way_out() {
        let error = SceneError::new("a.urdf", "<joint name=\"x\">", "no parent").at(3).hint("add <parent link=…/>");
        assert_eq!(error.to_string(), "a.urdf:3: <joint name=\"x\">: no parent (add <parent link=…/>)");
    }

    #[test]
    fn near_names_are_found_and_far_ones_are_not() {
        assert_eq!(nearest("griper", ["handle", "gripper"]), Some("gripper"));
        assert_eq!(nearest("robto", ["object", "robot"]), Some("robot"));
        assert_eq!(nearest("zebra", ["handle", "gripper"]), None);
        assert_eq!(did_you_mean("r_gripper", ["baxter/r_gripper"]), "did you mean `baxter/r_gripper`?");
    }

    #[test]
    fn hostile_text_is_shown_on_one_short_line() {
        let shown = quoted(&"\u{1b}[31m\n".repeat(100));
        assert!(!shown.contains('\n') && !shown.contains('\u{1b}') && shown.len() < 1000);
    }
}
