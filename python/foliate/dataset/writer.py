"""What all writers of datasets have in common."""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable
from os import PathLike
from pathlib import Path as FilePath
from types import TracebackType
from typing import TYPE_CHECKING, Any

from foliate.dataset.frames import Frames, Layout, frames

if TYPE_CHECKING:
    from foliate._foliate import Path
    from foliate.batch import Answer

__all__ = ["Writer", "problem_table", "task_of"]

Task = str | Callable[["Path"], str]


class Writer(ABC):
    """Writes answers into a folder, one after the other: an episode for a solution, and a row of ``problems`` for every answer.

    A writer is closed by ``close`` or by the end of ``with``, also where something raises: what was written by then is a whole dataset. Memory does not grow with
    the number of answers.
    """

    def __init__(self, out: str | PathLike[str], *, rate: float = 30.0, task: Task | None = None, clearance: bool = False) -> None:
        """``out``: a folder that is new or empty. ``rate``: frames a second. ``task``: what is done, in words, or a function of the path that says it. ``clearance``: whether the clearance
        of each frame is measured.

        Raises ``FileExistsError`` where the folder has something in it.
        """
        if not rate > 0:
            raise ValueError(f"`rate` is a number above 0, not {rate}")
        self.out = FilePath(out)
        if self.out.exists() and any(self.out.iterdir()):
            raise FileExistsError(f"{self.out}: there is something in it already")
        self.out.mkdir(parents=True, exist_ok=True)
        self.rate = rate
        self.task = task
        self.clearance = clearance
        self.layout: Layout | None = None
        self.problems = 0
        self.episodes = 0
        self.frames = 0
        self._closed = False

    def add(self, answer: Answer, seed: int | None = None) -> None:
        """Writes an answer. ``seed`` is told of an answer without a path, which does not know its own."""
        row: dict[str, Any] = {"problem": self.problems, "seed": seed, "outcome": answer.outcome, "detail": None, "episode_index": None}
        if answer.outcome == "solved":
            path: Path = answer.path  # type: ignore[union-attr]
            row["seed"] = answer.seed  # type: ignore[union-attr]
            self.layout = self.layout if self.layout is not None else Layout.of(path)
            made = frames(path, self.rate, self.layout, clearance=self.clearance)
            row["episode_index"] = self.episodes
            extra = {"problem": self.problems, "seed": row["seed"], "duration": path.duration, "min_clearance": path.min_clearance}
            self._episode(made, task_of(self.task, path), extra)
            self.episodes += 1
            self.frames += len(made)
        else:
            row["detail"] = answer.detail  # type: ignore[union-attr]
        self._problem(row)
        self.problems += 1

    def close(self) -> None:
        """Writes what is left."""
        if not self._closed:
            self._closed = True
            self._finish()

    def __enter__(self) -> Writer:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    @abstractmethod
    def _episode(self, made: Frames, task: str, extra: dict[str, Any]) -> None: ...

    @abstractmethod
    def _problem(self, row: dict[str, Any]) -> None: ...

    @abstractmethod
    def _finish(self) -> None: ...

    def _write_json(self, name: str, document: Any) -> None:
        file = self.out / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(document, indent=4) + "\n", encoding="utf-8")


def problem_table(rows: list[dict[str, Any]]) -> Any:
    """Rows of problems as a table of Arrow. Needs pyarrow."""
    import pyarrow as pa

    kinds = [("problem", pa.int64()), ("seed", pa.uint64()), ("outcome", pa.string()), ("detail", pa.string()), ("episode_index", pa.int64())]
    return pa.Table.from_pylist(rows, pa.schema(kinds))


def task_of(task: Task | None, path: Path) -> str:
    """What is done, in words: by default which objects are grasped."""
    if callable(task):
        return task(path)
    if task is not None:
        return task
    moved = sorted({handle.partition("/")[0] for segment in path.segments for _, handle in segment.holding})
    return f"move {', '.join(moved)}" if moved else "move the robot"
