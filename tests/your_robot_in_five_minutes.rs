//! Promise: the guide `docs/your-robot.md` works when its commands are typed as they stand.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/recorded.rs"]
mod recorded;

use recorded::Folder;
use std::process::Command;

const GUIDE: &str = include_str!("../docs/your-robot.md");

/// The texts of the guide's blocks of a language.
fn blocks(language: &str) -> Vec<&'static str> {
    let open = format!("```{language}\n");
    GUIDE.split(&open).skip(1).map(|rest| rest.split("```").next().unwrap_or_default()).collect()
}

/// The words of a line as a shell reads them: quotation marks keep blanks.
fn words(line: &str) -> Vec<String> {
    let quoted = line.split('"').enumerate();
    let words = quoted.flat_map(|(at, piece)| match at % 2 {
        0 => piece.split_whitespace().map(str::to_owned).collect(),
        _ => vec![piece.to_owned()],
    });
    words.collect()
}

#[test]
fn the_guide_is_followed_literally() {
    let folder = Folder::new("five-minutes");
    let mut ran = Vec::new();
    for line in blocks("sh").into_iter().flat_map(str::lines) {
        let words = words(line);
        let (program, arguments) = words.split_first().expect("a command");
        assert_eq!(program, "foliate", "{line}");
        let mut command = Command::new(env!("CARGO_BIN_EXE_foliate"));
        let output = command.args(arguments).current_dir(&folder.0).arg("--no-mesh-cache").output().expect("it runs");
        let said = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{line}\n{said}");
        ran.push(arguments[0].clone());
    }
    assert_eq!(ran, ["inspect", "new", "solve", "check", "view"]);

    // What the guide adds to the scene fits into it, and the scene still solves.
    let file = folder.0.join("first.toml");
    let text = std::fs::read_to_string(&file).expect("the scene");
    let [post] = blocks("toml")[..] else { panic!("the guide adds one part") };
    let (parts, rest) = text.split_once("\n[graph]").expect("a graph");
    std::fs::write(&file, format!("{parts}\n{post}\n[graph]{rest}")).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_foliate"));
    let output = command.args(["solve", "first.toml", "--first"]).current_dir(&folder.0).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}
