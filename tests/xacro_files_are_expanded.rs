//! Promise: a xacro file is expanded by the program `xacro` where that is installed and the user lets it; else the message says how to
//! expand it. The program has 30 s, and as many bytes as a URDF may have. What it leaves in a URDF and changes nothing is read.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test that cannot go on says so")]
#![cfg(unix)]

use foliate::scene::{PackagePath, UpAxis, XacroUse, read_model};
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("foliate-xacro-{}-{number}", std::process::id()));
        std::fs::create_dir_all(path.join("bin")).unwrap();
        std::fs::create_dir_all(path.join("out")).unwrap();
        std::fs::create_dir_all(path.join("none")).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, content: &str) {
        std::fs::write(self.0.join(name), content).unwrap();
    }

    /// A program `xacro` of these lines of shell.
    fn program(&self, lines: &str) {
        self.write("bin/xacro", &format!("#!/bin/sh\n{lines}\n"));
        std::fs::set_permissions(self.0.join("bin/xacro"), PermissionsExt::from_mode(0o755)).unwrap();
    }

    /// Exit code, and what is printed, of the program with `xacro` in its search path or without.
    fn foliate(&self, has_xacro: bool, arguments: &[&str]) -> (Option<i32>, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_foliate"));
        let path = if has_xacro {
            format!("{}:/usr/bin:/bin", self.0.join("bin").display())
        } else {
            self.0.join("none").display().to_string()
        };
        let output =
            command.current_dir(&self.0).env("PATH", path).arg("--no-mesh-cache").args(arguments).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
        (output.status.code(), said)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

/// A gantry whose joint has a range that only xacro knows.
const MACROS: &str = "<robot name=\"g\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n<xacro:property name=\"reach\" value=\"5\"/>\n\
    <link name=\"base\"/>\n<link name=\"b\"><collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>\n\
    <joint name=\"j\" type=\"prismatic\"><parent link=\"base\"/><child link=\"b\"/><limit lower=\"3\" upper=\"${reach}\"/></joint>\n</robot>\n";

/// Does to these macros what xacro does, with a banner that names the file, whose name is absolute.
const EXPAND: &str = "case $1 in /*) ;; *) exit 9;; esac; echo '<?xml version=\"1.0\" ?>'; echo \"<!-- made from $1 -->\"\n\
    sed -e '/<xacro:/d' -e 's/ xmlns:xacro=\"[^\"]*\"//' -e 's/${reach}/5/' \"$1\"; echo '<!-- end -->'";

const SCENE: &str = "format = \"foliate.scene/1\"\nname = \"s\"\n[[part]]\nname = \"g\"\nkind = \"robot\"\nurdf = \"g.urdf.xacro\"\n\
    [start]\n\"g/j\" = 3\n[[goal]]\nconfiguration = { \"g/j\" = 4 }\n[graph]\n";

#[test]
fn files_are_expanded_where_the_program_is_installed() {
    let folder = Folder::new();
    folder.program(EXPAND);
    folder.write("g.urdf.xacro", MACROS);
    folder.write("g.urdf", MACROS);
    folder.write("-g.xacro", MACROS);
    for name in ["g.urdf.xacro", "g.urdf", "./-g.xacro"] {
        let (code, said) = folder.foliate(true, &["inspect", name]);
        assert!(code == Some(0) && said.contains("j prismatic -> b [3, 5]"), "{name}: {said}");
    }
    // Lines are those of what was made of the file.
    folder.write("broken.xacro", &MACROS.replace("<child link=\"b\"/>", "<child link=\"c\"/>"));
    let (code, said) = folder.foliate(true, &["inspect", "broken.xacro"]);
    assert!(code == Some(2) && said.contains("broken.xacro (expanded):4: <child> of <joint name=\"j\">"), "{said}");
}

#[test]
fn without_the_program_or_the_users_will_the_message_says_how() {
    let folder = Folder::new();
    folder.program(EXPAND);
    folder.write("g.urdf", MACROS);
    folder.write("g.xacro", "<robot name=\"g\"><link name=\"a\"/></robot>");
    let (code, said) = folder.foliate(false, &["inspect", "g.urdf"]);
    assert!(
        code == Some(2) && said.contains("g.urdf:5: <limit> of <joint name=\"j\">: has to be expanded by xacro"),
        "{said}"
    );
    assert!(said.contains("`xacro` is not installed: `pip install xacro`"), "{said}");
    assert!(folder.foliate(false, &["inspect", "g.xacro"]).1.contains("g.xacro: <robot>: has to be expanded by xacro"));
    let (code, said) = folder.foliate(true, &["inspect", "g.urdf", "--xacro", "never"]);
    assert!(
        code == Some(2) && said.contains("has to be expanded by xacro (expand it: `xacro FILE > FILE.urdf`"),
        "{said}"
    );
    // A host has to ask for it.
    let urdf = folder.0.join("g.urdf").display().to_string();
    let error = read_model(&urdf, None, UpAxis::AsWritten, &PackagePath::only(&[])).unwrap_err();
    assert!(error.line == Some(5) && error.message.contains("has to be expanded"), "{error}");
    assert_eq!(XacroUse::default(), XacroUse::Never);
}

#[test]
fn the_program_may_fail_write_much_and_hang() {
    let folder = Folder::new();
    folder.write("g.xacro", MACROS);
    let inspect = |lines: &str| {
        folder.program(lines);
        folder.foliate(true, &["inspect", "g.xacro"])
    };
    let (code, said) = inspect("echo 'error: unknown macro name: xacro:boll' >&2; echo 'when processing' >&2; exit 2");
    assert!(
        code == Some(2) && said.contains("`xacro` refuses it: error: unknown macro name: xacro:boll when processing"),
        "{said}"
    );
    let (code, said) = inspect("head -c 40000000 /dev/zero | tr '\\0' ' '");
    assert!(code == Some(2) && said.contains("expands to more than the 33554432 bytes"), "{said}");
    let (code, said) = inspect("printf '\\377'");
    assert!(code == Some(2) && said.contains("not UTF-8"), "{said}");
    assert!(inspect("cat \"$1\"").1.contains("has to be expanded"));
    // The time limit of a command holds for it.
    folder.program("exec sleep 60");
    folder.write("scene.toml", &SCENE.replace("g.urdf.xacro", "g.xacro"));
    let started = Instant::now();
    let (code, said) = folder.foliate(true, &["solve", "scene.toml", "--time-limit", "0.5"]);
    assert!(
        code == Some(1) && said.contains("timeout") && started.elapsed() < Duration::from_secs(20),
        "{code:?} {said}"
    );
}

/// Who writes a path file may be another than who wrote the models: its xacro files are expanded only if the user says so.
#[test]
fn path_files_have_nothing_expanded_unless_that_is_asked_for() {
    let folder = Folder::new();
    folder.program(&format!("echo run >> \"{}/runs\"\n{EXPAND}", folder.0.display()));
    folder.write("g.urdf.xacro", MACROS);
    folder.write("scene.toml", SCENE);
    let (code, said) = folder.foliate(true, &["solve", "scene.toml", "--out", "out/path.json"]);
    assert_eq!(code, Some(0), "{said}");
    let runs = || std::fs::read_to_string(folder.0.join("runs")).unwrap_or_default().lines().count();
    let before = runs();
    for arguments in
        [&["check", "out/path.json"][..], &["export", "out/path.json", "--to", "glb", "-o", "out/path.glb"]]
    {
        let (code, said) = folder.foliate(true, arguments);
        assert!(code == Some(2) && said.contains("has to be expanded by xacro"), "{arguments:?}: {said}");
    }
    assert_eq!(runs(), before, "nothing was run");
    let (code, said) = folder.foliate(true, &["check", "out/path.json", "--xacro", "always"]);
    assert!(code == Some(0) && runs() > before, "{said}");
    // The sum of a part is that of what was made of the file, so that another macro is another model.
    folder.write("g.urdf.xacro", &MACROS.replace("radius=\"0.1\"", "radius=\"0.2\""));
    let (code, said) = folder.foliate(true, &["check", "out/path.json", "--xacro", "always"]);
    assert!(code == Some(1) && said.contains("is not the file that the path was planned with"), "{said}");
}

#[test]
fn what_is_left_and_changes_nothing_is_read() {
    let folder = Folder::new();
    let left = "<robot name=\"g\" xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:arg name=\"a\" default=\"1\"/>\
                <xacro:property name=\"p\" value=\"${1 + 1}\"/><xacro:macro name=\"m\" params=\"n\"><link name=\"${n}\"/></xacro:macro>\
                <link name=\"a\"><collision><geometry><sphere radius=\"1\"/></geometry></collision></link>\
                <gazebo><plugin><namespace>$(arg a)</namespace></plugin></gazebo></robot>";
    folder.write("g.urdf", left);
    let (code, said) = folder.foliate(false, &["inspect", "g.urdf"]);
    assert!(code == Some(0) && said.contains("1 links") && said.contains("Warnings: 0"), "{said}");
}
