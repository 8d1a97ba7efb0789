//! The C example is compiled and run.

use std::path::Path;
use std::process::Command;

#[test]
fn the_example_plans_and_is_proved() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    // Where cargo has put the library that this test belongs to.
    let test = std::env::current_exe().expect("the test's own file");
    let library = test.parent().expect("a folder");
    let program = folder.join("plan");
    let mut compiler = Command::new("cc");
    compiler.args(["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]).arg(here.join("examples/plan.c"));
    compiler.arg("-I").arg(here.join("include")).arg("-L").arg(library).arg("-lfoliate_c");
    compiler.arg(format!("-Wl,-rpath,{}", library.display())).arg("-o").arg(&program);
    let compiled = compiler.output().expect("a C compiler, which Rust needs as well");
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let file = folder.join("path.json");
    let ran = Command::new(&program).arg(&file).output().expect("the example runs");
    let said = String::from_utf8_lossy(&ran.stdout);
    assert!(ran.status.success(), "{said}\n{}", String::from_utf8_lossy(&ran.stderr));
    assert!(said.contains("grasps box1/") && said.contains("box1 ends at 0.500 -0.300 0.741"), "{said}");
    assert!(said.contains("as it should be: ") && said.contains("bax"), "{said}");
    assert!(file.exists());
}
