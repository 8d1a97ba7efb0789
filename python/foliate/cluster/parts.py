"""Parts of a batch: files of rows that are there as a whole or not at all."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path as FilePath
from typing import Any

from foliate._foliate import Solution, solve
from foliate.cluster.problem import Problem
from foliate.errors import FoliateError, NoSolution

__all__ = ["Row", "answered", "chunks", "done", "in_shard", "planned", "row_of", "rows", "write"]

Row = dict[str, Any]


def planned(problem: Problem, paths: FilePath | None = None) -> Row:
    """Plans for a problem; its row. With ``paths`` a path goes into that folder, named by the identity of the problem.

    Rows hold nothing that depends on the machine: a row is the same wherever it was made.
    """
    return answered(problem, lambda: solve(problem.load(), **problem.settings), paths)


def answered(problem: Problem, answer: Callable[[], Solution], paths: FilePath | None) -> Row:
    """The row of a problem by what ``answer`` returns or raises."""
    row = row_of(problem, "solved", None)
    try:
        solution = answer()
    except NoSolution as none:
        known = {"outcome": none.outcome, "detail": none.detail}
        # What a limit of time cuts off depends on the machine.
        counted = {} if none.outcome == "timeout" else {"steps": none.report.steps, "fingerprint": f"{none.report.fingerprint:016x}"}
        return row | known | counted
    except (FoliateError, ValueError, TypeError) as why:
        return row | {"outcome": "unreadable", "detail": str(why)}
    path = solution.path
    if paths is not None:
        paths.mkdir(parents=True, exist_ok=True)
        path.save(paths / f"{row['identity']}.json")
    numbers = {"duration": path.duration, "min_clearance": path.min_clearance, "segments": len(path)}
    return row | numbers | {"steps": solution.report.steps, "fingerprint": f"{solution.report.fingerprint:016x}"}


def row_of(problem: Problem, outcome: str, detail: str | None) -> Row:
    """The row of a problem of which no more is known."""
    row: Row = {"identity": problem.identity, "seed": problem.settings.get("seed", 1), "outcome": outcome, "detail": detail}
    return row | {"duration": None, "min_clearance": None, "segments": None, "steps": None, "fingerprint": None}


def write(out: FilePath, part: Sequence[Row]) -> None:
    """Writes a part: under a temporary name, which it loses when it is whole."""
    folder = out / "parts"
    folder.mkdir(parents=True, exist_ok=True)
    text = "".join(json.dumps(row, sort_keys=True) + "\n" for row in part)
    name = hashlib.sha256("".join(str(row["identity"]) for row in part).encode()).hexdigest()[:32]
    draft = folder / f".{name}.{os.getpid()}"
    draft.write_text(text, encoding="utf-8")
    draft.replace(folder / f"{name}.jsonl")


def rows(out: str | os.PathLike[str]) -> Iterator[Row]:
    """The rows of a batch, each problem once, in the order of their identities' parts."""
    seen: set[str] = set()
    for file in sorted((FilePath(out) / "parts").glob("*.jsonl")):
        with file.open(encoding="utf-8") as lines:
            for line in lines:
                row: Row = json.loads(line)
                if row["identity"] not in seen:
                    seen.add(row["identity"])
                    yield row


def done(out: FilePath) -> set[str]:
    """Which problems have a row."""
    return {str(row["identity"]) for row in rows(out)}


def in_shard(identity: str, shard: tuple[int, int]) -> bool:
    """Whether a problem belongs to shard i of n, i counted from 0."""
    number, count = shard
    return int(identity[:16], 16) % count == number


def chunks(problems: Iterable[Problem], size: int, finished: set[str], shard: tuple[int, int], expected: Callable[[Problem], float] | None) -> Iterator[list[Problem]]:
    """Problems that are left to do, in chunks; each once. Those that are ``expected`` to take the longest come first."""
    chunk: list[Problem] = []
    for problem in problems if expected is None else sorted(problems, key=expected, reverse=True):
        identity = problem.identity
        if identity in finished or not in_shard(identity, shard):
            continue
        finished.add(identity)
        chunk.append(problem)
        if len(chunk) == size:
            yield chunk
            chunk = []
    if chunk:
        yield chunk
