//! xacro files: whether a description has to be expanded, and the program that does it.

use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::reading::input::MODEL_CAP;
use crate::scene::reading::limits::look;
use crate::scene::reading::xml::Xml;
use foliate_systems::events::StopSignal;
use roxmltree::Node;
use std::io::{ErrorKind, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The program.
const PROGRAM: &str = "xacro";
/// Longest time that it may take.
const LONGEST: Duration = Duration::from_secs(30);
/// Between two looks at it.
const PAUSE: Duration = Duration::from_millis(2);
/// Most bytes of what it says that are kept.
const SAID: u64 = 4096;

/// Whose xacro files the program `xacro` may expand. It evaluates expressions that are written in them, and reads what they include.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum XacroUse {
    /// None: xacro files are refused.
    #[default]
    Never,
    /// Those that are named by the host or by a scene, but not those that a path file names.
    Models,
    /// All.
    Always,
}

/// The first place of a description that has to be expanded; none where it does not speak of xacro, or xacro's elements define what
/// nothing uses.
pub(crate) fn first_use<'a, 'i>(root: Node<'a, 'i>) -> Option<Node<'a, 'i>> {
    if !root.namespaces().any(|namespace| namespace.uri().contains(PROGRAM)) {
        return None;
    }
    let is_xacro = |node: &Node<'_, '_>| node.tag_name().namespace().is_some_and(|uri| uri.contains(PROGRAM));
    let mut stack: Vec<(Node<'a, 'i>, bool)> = vec![(root, false)];
    while let Some((node, in_model)) = stack.pop() {
        if is_xacro(&node) {
            match node.tag_name().name() {
                "property" | "macro" | "arg" => continue,
                _ => return Some(node),
            }
        }
        let in_model = in_model || matches!(node.tag_name().name(), "link" | "joint");
        let is_expression = |text: &str| text.contains("${") || text.contains("$(");
        if in_model && node.attributes().any(|attribute| is_expression(attribute.value())) {
            return Some(node);
        }
        let above = stack.len();
        stack.extend(node.children().filter(Node::is_element).map(|child| (child, in_model)));
        stack[above..].reverse();
    }
    None
}

/// Whether the file has to be expanded before it is read: by its name, or by what is in it.
pub(crate) fn has_to_be_expanded(path: &Path, text: &str) -> bool {
    let by_name = path.extension().is_some_and(|extension| extension == PROGRAM);
    let uses = || {
        Xml::parse("", text, &StopSignal::default()).is_ok_and(|xml| first_use(xml.document.root_element()).is_some())
    };
    by_name || (text.contains(PROGRAM) && uses())
}

/// That the file is not expanded, and how it can be; at the place that needs it.
pub(crate) fn refusal(label: &str, text: &str, hint: &str) -> SceneError {
    let place = Xml::parse(label, text, &StopSignal::default()).ok().and_then(|xml| {
        let node = first_use(xml.document.root_element())?;
        Some((crate::scene::reading::xml::label(node), xml.line(node)))
    });
    let (element, line) = place.map_or(("<robot>".to_owned(), None), |(element, line)| (element, Some(line)));
    SceneError::new(label, element, "has to be expanded by xacro").at(line).hint(hint)
}

/// What to do about a file that is not expanded.
pub(crate) const HINT: &str = "expand it: `xacro FILE > FILE.urdf`; `pip install xacro` has the program";

/// The description that the program makes of a file.
///
/// # Errors
/// It is not installed, refuses the file, takes longer than 30 s or than the signal lets it, or writes more than is read.
pub(crate) fn expand(path: &Path, text: &str, stop: &StopSignal) -> Result<String, SceneError> {
    let label = path.display().to_string();
    let fail = |message: String| SceneError::new(&label, "file", message);
    // A name that begins with a dash is no option.
    let absolute = std::path::absolute(path).map_err(|e| fail(format!("has no place: {e}")).because(e))?;
    let mut command = Command::new(PROGRAM);
    command.arg(absolute).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().map_err(|error| match error.kind() {
        ErrorKind::NotFound => refusal(
            &label,
            text,
            "the program `xacro` is not installed: `pip install xacro`, or expand the file elsewhere",
        ),
        _ => fail(format!("`xacro` cannot be started: {error}")).because(error),
    })?;
    let (written, said, ended) = watch(child, &label, stop)?;
    if written.len() as u64 > MODEL_CAP {
        return Err(fail(format!("expands to more than the {MODEL_CAP} bytes that are read")));
    }
    if !ended {
        let said = String::from_utf8_lossy(&said);
        let words: Vec<&str> = said.split_whitespace().collect();
        return Err(fail(format!("`xacro` refuses it: {}", long(&words.join(" ")))));
    }
    String::from_utf8(written)
        .map(without_banner)
        .map_err(|e| fail("expands to what is not UTF-8 text".into()).because(e))
}

/// What the program has written and said, and whether it was content.
fn watch(mut child: Child, label: &str, stop: &StopSignal) -> Result<(Vec<u8>, Vec<u8>, bool), SceneError> {
    let (out, err) = (child.stdout.take(), child.stderr.take());
    let out = std::thread::spawn(move || first(out, MODEL_CAP + 1));
    let err = std::thread::spawn(move || first(err, SAID));
    let started = Instant::now();
    let cut = loop {
        match child.try_wait() {
            Ok(Some(_)) => break None,
            Ok(None) if stop.is_raised() => break Some(None),
            Ok(None) if started.elapsed() > LONGEST => {
                break Some(Some(format!("takes longer than {} s", LONGEST.as_secs())));
            }
            Ok(None) => std::thread::sleep(PAUSE),
            Err(error) => break Some(Some(format!("cannot be waited for: {error}"))),
        }
    };
    if let Some(why) = cut {
        // It may have ended just now.
        let _ended = child.kill();
        let _gone = child.wait();
        look(stop, label)?;
        return Err(SceneError::new(label, "file", format!("`xacro` {}", why.unwrap_or_default())));
    }
    let ended = child.wait().is_ok_and(|status| status.success());
    let taken = |thread: std::thread::JoinHandle<Vec<u8>>| thread.join().unwrap_or_default();
    Ok((taken(out), taken(err), ended))
}

/// The first bytes of a stream. The rest is thrown away, up to as much again, so that who writes it is not held up; then it is shut.
fn first(stream: Option<impl Read>, most: u64) -> Vec<u8> {
    let mut kept = Vec::new();
    if let Some(mut stream) = stream {
        // What ends early has been cut, and that shows elsewhere.
        let _read = stream.by_ref().take(most).read_to_end(&mut kept);
        let _rest = std::io::copy(&mut stream.take(MODEL_CAP), &mut std::io::sink());
    }
    kept
}

/// The text from its root on: what stands before says where the file was, and would give it another sum elsewhere.
fn without_banner(text: String) -> String {
    let mut rest = text.as_str();
    loop {
        rest = rest.trim_start();
        let end = if rest.starts_with("<!--") {
            rest.find("-->").map(|end| end + 3)
        } else if rest.starts_with("<?") {
            rest.find("?>").map(|end| end + 2)
        } else {
            None
        };
        match end {
            Some(end) => rest = &rest[end..],
            None => return rest.to_owned(),
        }
    }
}

/// Words of the program, in one line of at most 400 characters.
fn long(text: &str) -> String {
    let mut shown: String = text.chars().take(400).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if shown.is_empty() {
        shown.push_str(&quoted("it says nothing"));
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    fn needs(robot: &str) -> bool {
        let text = format!("<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">{robot}</robot>");
        has_to_be_expanded(Path::new("r.urdf"), &text)
    }

    #[test]
    fn definitions_that_nothing_uses_change_nothing() {
        let macros =
            "<xacro:property name=\"p\" value=\"${1+1}\"/><xacro:macro name=\"m\"><link name=\"${p}\"/></xacro:macro>";
        assert!(!needs("<link name=\"a\"/>"));
        assert!(!needs(&format!("{macros}<link name=\"a\"/><gazebo><plugin name=\"$(arg p)\"/></gazebo>")));
        assert!(needs(&format!("{macros}<link name=\"${{p}}\"/>")));
        assert!(needs(&format!("{macros}<link name=\"a\"/><xacro:m/>")));
        assert!(needs("<xacro:include filename=\"b.xacro\"/>"));
        assert!(needs(
            "<link name=\"a\"><visual><geometry><mesh filename=\"$(find p)/m.stl\"/></geometry></visual></link>"
        ));
        assert!(has_to_be_expanded(Path::new("r.urdf.xacro"), "<robot name=\"r\"/>"));
    }

    #[test]
    fn what_stands_before_the_root_is_left_out() {
        let text =
            "<?xml version=\"1.0\" ?>\n<!-- === -->\n<!-- made from /a/b -->\n<robot name=\"r\"><!-- c --></robot>";
        assert_eq!(without_banner(text.to_owned()), "<robot name=\"r\"><!-- c --></robot>");
        assert_eq!(without_banner("<!-- open".to_owned()), "<!-- open");
    }
}
