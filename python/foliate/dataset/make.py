"""Plans many problems and writes a dataset of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from os import PathLike
from typing import Any, Literal

from foliate.batch import Instance, Problem, plan_batch
from foliate.dataset.answers import NpzWriter, ParquetWriter
from foliate.dataset.lerobot import LeRobotWriter
from foliate.dataset.writer import Task, Writer

__all__ = ["FORMATS", "Made", "make"]

FORMATS: dict[str, type[Writer]] = {"lerobot": LeRobotWriter, "parquet": ParquetWriter, "npz": NpzWriter}


@dataclass(frozen=True)
class Made:
    """A dataset that was made."""

    problems: int
    """Problems that were planned for."""
    episodes: int
    """Paths that were found."""
    frames: int
    """Frames of all paths."""
    outcomes: dict[str, int]
    """How many problems ended how."""


def make(
    problems: Iterable[Problem],
    out: str | PathLike[str],
    *,
    format: Literal["lerobot", "parquet", "npz"] = "lerobot",
    rate: float = 30.0,
    task: Task | None = None,
    clearance: bool = False,
    threads: int | None = None,
    progress: Callable[[Made], None] | None = None,
    **settings: Any,
) -> Made:
    """Plans for each problem and writes frames of the paths, ``rate`` a second, into the folder ``out``; problems without a path become rows with their reason.

    ``problems``, ``threads`` and ``settings`` are those of ``plan_batch``: a scene, or a scene with settings such as ``seed``; ``instances`` gives those of a scene that varies. ``task`` says what is done, in words, or is a function of a
    path. ``clearance`` measures in each frame how close things are. ``progress`` is told after each answer what has been made so far. The files depend on problems and settings alone where these count work (``improve_work``), not time.

    Where something raises, Ctrl-C included, what was written is a whole dataset.

    Raises ``FileExistsError`` where the folder has something in it, ``ValueError`` where a path is of another robot or other objects than the first.
    """
    if format not in FORMATS:
        raise ValueError(f"there is no format {format!r}; known: {', '.join(FORMATS)}")
    seeds: list[int | None] = []

    def noted() -> Iterator[Problem]:
        for problem in problems:
            own: Mapping[str, Any] = problem[1] if isinstance(problem, tuple) else {}
            seed = problem.number if isinstance(problem, Instance) else own.get("seed", settings.get("seed", 1))
            seeds.append(seed)
            yield problem

    outcomes: Counter[str] = Counter()
    with FORMATS[format](out, rate=rate, task=task, clearance=clearance) as writer:
        for answer in plan_batch(noted(), threads=threads, **settings):
            writer.add(answer, seeds[0])
            del seeds[0]
            outcomes[answer.outcome] += 1
            if progress is not None:
                progress(_made(writer, outcomes))
    return _made(writer, outcomes)


def _made(writer: Writer, outcomes: Counter[str]) -> Made:
    return Made(writer.problems, writer.episodes, writer.frames, dict(outcomes))
