"""The files of results: one line per solve, and one per judged answer."""

from __future__ import annotations

import csv
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TypeVar

SOLVED = "solved"
INFEASIBLE = ("infeasible_start", "infeasible_goal")


@dataclass(frozen=True)
class Row:
    """One solve. `outcome`: of `foliate bench`. `solve_ms`: wall time without loading. `grasps`: in the answer.
    `shown`: in the demonstration. `path`: the answer below the results' folder."""

    instance: str
    group: str
    fingers: str
    seed: int
    outcome: str
    solve_ms: float
    limit_s: float
    grasps: int
    shown: int
    path: str
    message: str


@dataclass(frozen=True)
class Verdict:
    """One judged answer. `package`: `valid`, or what `path_is_successful` says against it. `corrected`: the same checks
    of single configurations without the faults of the loop around them. `overhang_m`: of the worst rest (metres)."""

    instance: str
    seed: int
    package: str
    corrected: str
    overhang_m: float
    grasps: int


Record = TypeVar("Record", Row, Verdict)


def read(file: Path, kind: type[Record]) -> list[Record]:
    """The records of `file`, none where there is no file. A column that is missing is an error."""
    if not file.is_file():
        return []
    with file.open(newline="", encoding="utf-8") as lines:
        return [_record(kind, line) for line in csv.DictReader(lines)]


def append(file: Path, record: Row | Verdict) -> None:
    """Adds a line, and the names of the columns to a new file."""
    fresh = not file.exists()
    with file.open("a", newline="", encoding="utf-8") as lines:
        writer = csv.DictWriter(lines, [column.name for column in fields(record)], lineterminator="\n")
        if fresh:
            writer.writeheader()
        writer.writerow({name: " ".join(str(value).split()) for name, value in asdict(record).items()})


def _record(kind: type[Record], line: dict[str, str]) -> Record:
    convert = {"int": int, "float": float, "str": str}
    return kind(**{column.name: convert[column.type](line[column.name]) for column in fields(kind)})
