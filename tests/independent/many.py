"""Many path files in one call, and which of them a results file knows already.

The results file is CSV, a row per file as soon as it is known. A row counts for a later call when the file's bytes and
the mode are the same, so an interrupted call goes on where it was.
"""

from __future__ import annotations

import csv
import hashlib
from dataclasses import astuple, dataclass, fields
from pathlib import Path

from packages import InputError


@dataclass(frozen=True)
class Row:
    """One file's verdict: `proved`, `violations` or `unreadable`."""

    file: str
    sha256: str
    mode: str
    verdict: str
    violations: int
    seconds: float


COLUMNS = [column.name for column in fields(Row)]


def expand(given: list[Path]) -> list[Path]:
    """Files as they are given; for a folder the `.json` files in it, by name."""
    files: list[Path] = []
    for path in given:
        if not path.is_dir():
            files.append(path)
            continue
        inside = sorted(file for file in path.glob("*.json") if file.is_file())
        if not inside:
            raise InputError(f"{path}: no .json file in this folder")
        files += inside
    return files


def digest(file: Path) -> str:
    """What tells a file from another one of the same name."""
    try:
        return hashlib.sha256(file.read_bytes()).hexdigest()
    except OSError as error:
        raise InputError(f"{file}: {error.strerror}") from error


class Results:
    """The rows of a results file; without one, only those of this call."""

    def __init__(self, path: Path | None):
        self.path = path
        self.known: dict[tuple[str, str], str] = {}
        if path is not None and path.exists():
            self._read(path)

    def _read(self, path: Path) -> None:
        with path.open(newline="", encoding="utf-8") as text:
            rows = csv.DictReader(text)
            if rows.fieldnames != COLUMNS:
                raise InputError(f"{path}: is no results file of recheck.py (columns {', '.join(COLUMNS)})")
            # A row that a killed call left half written has no verdict.
            self.known = {(row["sha256"], row["mode"]): row["verdict"] for row in rows if row["seconds"]}

    def verdict(self, sha256: str, mode: str) -> str | None:
        """What an earlier call found; a file that could not be read is read again."""
        known = self.known.get((sha256, mode))
        return None if known == "unreadable" else known

    def add(self, row: Row) -> None:
        self.known[row.sha256, row.mode] = row.verdict
        if self.path is None:
            return
        fresh = not self.path.exists() or self.path.stat().st_size == 0
        with self.path.open("a", newline="", encoding="utf-8") as text:
            lines = csv.writer(text)
            if fresh:
                lines.writerow(COLUMNS)
            lines.writerow(astuple(row))
