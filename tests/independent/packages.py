"""Where models lie on disk: `package://` URLs without ROS."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from xml.etree import ElementTree


class InputError(Exception):
    """A file that cannot be read as what it claims to be; the message names the file and the place in it."""


def search_directories(given: list[str] | None = None) -> list[Path]:
    """Folders that hold packages, first match wins: those given, then the environment, then the cache that
    `foliate models --install` fills, then installed wheels."""
    folders = [Path(folder) for folder in given or []]
    for variable, below in (("FOLIATE_PACKAGE_PATH", ""), ("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share")):
        entries = os.environ.get(variable, "").split(os.pathsep)
        folders += [Path(entry) / below for entry in entries if entry]
    folders += _model_cache()
    folders += [Path(entry) / "cmeel.prefix" / "share" for entry in sys.path if entry]
    return [folder for folder in folders if folder.is_dir()]


def _model_cache() -> list[Path]:
    """`FOLIATE_MODEL_CACHE`, or `foliate/models` in the user's cache directory; none where there is no home."""
    if given := os.environ.get("FOLIATE_MODEL_CACHE"):
        return [Path(given)]
    cache = Path(os.environ.get("XDG_CACHE_HOME", ""))
    if not cache.is_absolute():
        if not (home := os.environ.get("HOME")):
            return []
        cache = Path(home) / ("Library/Caches" if sys.platform == "darwin" else ".cache")
    return [cache / "foliate" / "models"]


def resolve(url: str, folders: list[Path], beside: Path) -> Path:
    """The file behind `url`: `package://name/rest` (any number of slashes), `file://`, absolute, or relative to the
    folder `beside`. A package URL may not leave its package, which may be a folder above `beside`."""
    if url.startswith("package://"):
        return _resolve_package(url, folders, beside)
    path = Path(url.removeprefix("file://"))
    path = path if path.is_absolute() else beside / path
    if not path.is_file():
        raise InputError(f"{path}: no such file (named as {url!r})")
    return path


def _resolve_package(url: str, folders: list[Path], beside: Path) -> Path:
    package, _, rest = url.removeprefix("package://").lstrip("/").partition("/")
    beside = beside.resolve()
    above = [folder for folder in (beside, *beside.parents) if package in (folder.name, _name_of(folder))]
    for root in [folder / package for folder in folders] + above:
        root = root.resolve()
        path = (root / rest).resolve()
        if not path.is_file():
            continue
        if root not in path.parents:
            raise InputError(f"{url}: leaves its package folder {root}")
        return path
    searched = ", ".join(str(folder) for folder in folders) or "no folder"
    raise InputError(f"{url}: not found; searched {searched} (give --package-path DIR)")


def _name_of(folder: Path) -> str | None:
    """The name in the `package.xml` of a folder, where it has one."""
    try:
        name = ElementTree.parse(folder / "package.xml").findtext("name")
    except (OSError, ElementTree.ParseError):
        return None
    return name and name.strip()
