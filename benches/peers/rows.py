"""The results file: a row per solve, whatever became of it, and which solves are still to be made.

CSV, appended to as soon as a row is known, so that an interrupted run goes on where it was. `HPP` rows and Foliate rows
have the same columns; what a planner does not tell is empty.
"""

from __future__ import annotations

import csv
from dataclasses import asdict, dataclass, fields
from pathlib import Path

FOLIATE = "foliate"
SOLVED, FAILED, TIMEOUT, CRASHED = "solved", "failed", "timeout", "crashed"


@dataclass(frozen=True)
class Row:
    """One solve. `solver`: `mrrt`, `spf`, `diffusing`, `birrt` or `foliate`. `series`: `main`, or `control` and
    a commit for one that is repeated beside that build of Foliate, to see whether the machine is as fast as it was. `outcome`: `solved`, `failed` (the planner gave up, or
    its answer is none), `timeout` (of `limit_s` of processor time), `crashed`. `solve_s`: processor
    time of HPP, wall time of Foliate; `cpu_s`: processor time of HPP's solve, of Foliate's whole process. `version`: of the planner, for Foliate the commit. `answer`: the path's file
    below the run's folder."""

    scene: str
    solver: str
    seed: int
    series: str
    outcome: str
    solve_s: float
    cpu_s: float
    wall_s: float
    setup_s: float
    limit_s: float
    nodes: int | None
    segments: int | None
    length: float | None
    reason: str
    version: str
    machine: str
    date: str
    answer: str

    @property
    def key(self) -> tuple[str, str, int, str, str]:
        """What makes a row the same solve: HPP's version is part of it, Foliate's too."""
        return self.scene, self.solver, self.seed, self.series, self.version

    @property
    def compared_s(self) -> float:
        """What ratios are made of: at least the solve's processor time, and of Foliate's two bounds of it the smaller
        one. Its wall time grows on a busy core; that of the whole process has loading in it."""
        return min(self.solve_s, self.cpu_s) if self.solver == FOLIATE else self.solve_s

    @property
    def solved(self) -> bool:
        return self.outcome == SOLVED


COLUMNS = [column.name for column in fields(Row)]


class ResultsError(Exception):
    """A results file that is none; the message names file and line."""


class Results:
    """The rows of a results file, in the order in which they were made."""

    def __init__(self, file: Path):
        self.file = file
        self.rows: list[Row] = read_rows(file) if file.exists() else []

    def add(self, row: Row) -> None:
        append(self.file, COLUMNS, asdict(row))
        self.rows.append(row)

    def has(self, key: tuple) -> bool:
        return any(row.key == key for row in self.rows)


def read_rows(file: Path) -> list[Row]:
    """The complete rows of a file; a last one that a killed run left half written is left out."""
    rows = []
    for number, record in read_records(file, COLUMNS):
        try:
            rows.append(_row(record))
        except ValueError as error:
            raise ResultsError(f"{file}:{number}: {error}") from error
    return rows


def read_records(file: Path, columns: list[str]) -> list[tuple[int, dict[str, str]]]:
    """Line numbers and records of a CSV file with these columns; half-written last lines are left out."""
    text = file.read_text(encoding="utf-8")
    whole = text[:text.rfind("\n") + 1]
    reader = csv.DictReader(whole.splitlines())
    if whole and reader.fieldnames != columns:
        raise ResultsError(f"{file}:1: columns are not {', '.join(columns)}")
    return [(reader.line_num, record) for record in reader]


def append(file: Path, columns: list[str], record: dict) -> None:
    """Adds a line, after removing what a killed run left of one."""
    file.parent.mkdir(parents=True, exist_ok=True)
    if file.exists():
        text = file.read_bytes()
        if text and not text.endswith(b"\n"):
            file.write_bytes(text[:text.rfind(b"\n") + 1])
    fresh = not file.exists() or file.stat().st_size == 0
    with file.open("a", newline="", encoding="utf-8") as lines:
        writer = csv.DictWriter(lines, columns, lineterminator="\n")
        if fresh:
            writer.writeheader()
        writer.writerow({name: _cell(value) for name, value in record.items()})


def _cell(value) -> str:
    """A line of the file is a row, so that one which was not finished can be told."""
    return "" if value is None else " ".join(str(value).split())


def _row(record: dict[str, str]) -> Row:
    if None in record or None in record.values():
        raise ValueError("another number of columns than the first line has")
    values: dict = {}
    for column in fields(Row):
        text = record[column.name]
        if "None" in str(column.type) and text == "":
            values[column.name] = None
        elif "int" in str(column.type):
            values[column.name] = int(text)
        elif "float" in str(column.type):
            values[column.name] = float(text)
        else:
            values[column.name] = text
    return Row(**values)
