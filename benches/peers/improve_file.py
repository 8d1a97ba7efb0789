"""The rows of `results/improvement.csv`: a path of a planner, before or after an improvement."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from pathlib import Path

from rows import ResultsError, append, read_records

HPP, FOLIATE = "hpp", "foliate"
FIRST = "first"
SOLVED = "solved"


@dataclass(frozen=True)
class Improved:
    """`method`: `first` for the path as the search answers it, or the improvement; HPP's are its optimisers by name.
    `solver`: which of HPP's planners. `outcome`: `solved`, `failed` (HPP threw an exception), `timeout` or `crashed`.
    `seconds`: of the improvement (of the search for `first`): HPP's processor time, of Foliate the smaller one of wall time and
    the whole process's processor time. `length` of the robots' motion and `stopping_s`, its time with rest at every
    corner (`motion_measure.py`); `own_s`: by the planner's own timing, without standing still at grasps. `verdict` of
    pinocchio and coal (`check_file.py`)."""

    scene: str
    planner: str
    solver: str
    seed: int
    method: str
    outcome: str
    seconds: float
    length: float | None
    stopping_s: float | None
    own_s: float | None
    pieces: int | None
    grasp_changes: int | None
    verdict: str
    reason: str
    version: str
    machine: str
    date: str


COLUMNS = [column.name for column in fields(Improved)]


def add(file: Path, row: Improved) -> None:
    append(file, COLUMNS, asdict(row))


def read(file: Path) -> list[Improved]:
    """Complete rows; none without a file."""
    if not file.exists():
        return []
    rows = []
    for number, record in read_records(file, COLUMNS):
        try:
            rows.append(Improved(**{column.name: _value(record[column.name], str(column.type)) for column in fields(Improved)}))
        except (ValueError, TypeError) as error:
            raise ResultsError(f"{file}:{number}: {error}") from error
    return rows


def _value(text: str, kind: str):
    if "None" in kind and text == "":
        return None
    return int(text) if "int" in kind else float(text) if "float" in kind else text
