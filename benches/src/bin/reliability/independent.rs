//! What pinocchio and coal, which are other people's code, say of paths.

use crate::Result;
use crate::page::Figure;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Paths of one call of the script.
const CHUNK: usize = 20;

/// Adds to a figure what they find in these paths. They prove each path over its continuum, as `check` does.
pub(crate) fn recheck(figure: &mut Figure, paths: &[PathBuf]) -> Result<()> {
    let python = std::env::var("FOLIATE_PYTHON").unwrap_or_else(|_| "python3".into());
    let imports = Command::new(&python).args(["-c", "import pinocchio, coal"]).output();
    if !imports.is_ok_and(|output| output.status.success()) {
        figure.row("shown to pinocchio and coal", "none: python3 has them not; FOLIATE_PYTHON names another");
        return Ok(());
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/independent/recheck.py");
    let mut refused = 0;
    for chunk in paths.chunks(CHUNK) {
        let output = Command::new(&python).arg(&script).args(chunk).arg("--adaptive").output()?;
        if output.status.success() {
            continue;
        }
        let said = String::from_utf8_lossy(&output.stdout);
        let broken = said.lines().filter(|line| line.contains(": ") && line.contains(" violation"));
        // An error of the script counts as one.
        refused += (broken.filter(|line| !line.contains("no violation")).count() as u64).max(1);
        eprintln!("{said}{}", String::from_utf8_lossy(&output.stderr));
    }
    figure.row("shown to pinocchio and coal", paths.len());
    figure.zero("refused by pinocchio and coal", refused);
    Ok(())
}

/// Whether their reader of URDF files knows all that a path's models hold: not capsules, nor meshes that are turned and
/// scaled unevenly.
pub(crate) fn knows(folder: &Path) -> Result<bool> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            if !knows(&path)? {
                return Ok(false);
            }
        } else if path.extension().is_some_and(|ending| ending == "urdf") {
            let text = std::fs::read_to_string(&path)?;
            if text.contains("<capsule") || text.contains(".dae\" scale") {
                return Ok(false);
            }
        }
    }
    Ok(true)
}
