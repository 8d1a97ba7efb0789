"""The file of problems that `motionbenchmaker` of `benches/` reads (benches/README.md describes it), and a table by set."""

from __future__ import annotations

import gzip
import json
import math
from dataclasses import dataclass
from pathlib import Path

SOLVED, START, GOAL = "solved", "infeasible_start", "infeasible_goal"
ROUNDED = 5e-3
"""How far a planned joint may be beyond a bound so that it is moved onto it (rad, m): as in Foliate's program."""


class ProblemsError(Exception):
    """A file that is not of this form; the message names it and the place."""


@dataclass(frozen=True)
class Obstacle:
    """`kind` is `box` (sizes: sides), `cylinder` (length along z, radius) or `sphere` (radius); metres, the centre's pose in the world,
    quaternion x y z w."""

    name: str
    kind: str
    sizes: tuple[float, ...]
    xyz: tuple[float, ...]
    quaternion: tuple[float, ...]


@dataclass(frozen=True)
class Problem:
    """Joints of `goal` are planned; the others stay as in `start`."""

    set: str
    index: int
    start: dict[str, float]
    goal: dict[str, float]
    obstacles: tuple[Obstacle, ...]


KEYS = {"box": ("size",), "cylinder": ("length", "radius"), "sphere": ("radius",)}


def read(file: Path, sets: list[str] | None = None, every: int = 1) -> tuple[str, list[Problem]]:
    """The robot's name and the problems, sets in the order of their names."""
    try:
        text = gzip.decompress(file.read_bytes()) if file.suffix == ".gz" else file.read_bytes()
        document = json.loads(text)
    except (OSError, EOFError, ValueError) as error:
        raise ProblemsError(f"{file}: {error}") from error
    try:
        found = {name: document["sets"][name] for name in sorted(document["sets"])}
        if unknown := [name for name in sets or [] if name not in found]:
            raise ProblemsError(f"{file}: there is no set {unknown[0]}; it has {', '.join(found)}")
        chosen = [(name, entry) for name, entries in found.items() if not sets or name in sets for entry in entries[::every]]
        return document["robot"], [_problem(name, entry) for name, entry in chosen]
    except (KeyError, TypeError, ValueError) as error:
        raise ProblemsError(f"{file}: not of the form of benches/README.md: {error!r}") from error


def _problem(name: str, entry: dict) -> Problem:
    obstacles = tuple(_obstacle(obstacle) for obstacle in entry["obstacles"])
    return Problem(name, int(entry["index"]), dict(entry["start"]), dict(entry["goal"]), obstacles)


def _obstacle(entry: dict) -> Obstacle:
    values = [entry[key] for key in KEYS[entry["type"]]]
    sizes = values[0] if entry["type"] == "box" else values
    length = math.hypot(*entry["quaternion"])
    if not 0.999 <= length <= 1.001 or len(entry["xyz"]) != 3 or not all(size > 0 for size in sizes):
        raise ValueError(f"obstacle {entry['name']}: sizes are above 0, xyz has three numbers, the quaternion length 1")
    return Obstacle(entry["name"], entry["type"], tuple(sizes), tuple(entry["xyz"]), tuple(x / length for x in entry["quaternion"]))


@dataclass(frozen=True)
class Row:
    """`seconds` of a search; `outcome` is `solved`, `infeasible_start`, `infeasible_goal`, or why it ended."""

    set: str
    index: int
    outcome: str
    seconds: float


def quantile(values: list[float], part: float) -> float | None:
    """The smallest value that at least this part of them does not exceed."""
    return sorted(values)[max(math.ceil(part * len(values)), 1) - 1] if values else None


def table(rows: list[Row]) -> str:
    """Markdown: the columns of Foliate's program that a peer has too. Milliseconds are of problems that were solved."""
    lines = ["| set | problems | infeasible start | infeasible goal | solved | not solved | median (ms) | 95 % (ms) | worst (ms) |",
             "| :-- | --: | --: | --: | --: | --: | --: | --: | --: |"]
    for name in [*dict.fromkeys(row.set for row in rows), None]:
        chosen = [row for row in rows if name in (None, row.set)]
        counts = [sum(row.outcome == outcome for row in chosen) for outcome in (START, GOAL, SOLVED)]
        times = [row.seconds * 1e3 for row in chosen if row.outcome == SOLVED]
        told = [len(chosen), *counts, len(chosen) - sum(counts)]
        told += ["-" if (value := quantile(times, part)) is None else f"{value:.3g}" for part in (0.5, 0.95, 1.0)]
        lines.append(f"| {name or 'all'} | " + " | ".join(map(str, told)) + " |")
    return "\n".join(lines)


def csv(rows: list[Row]) -> str:
    return "set,index,outcome,solve_s\n" + "".join(f"{r.set},{r.index},{r.outcome},{r.seconds:.9f}\n" for r in rows)
