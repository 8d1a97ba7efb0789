"""Plain datasets: a file of NumPy's for each path, or one Parquet table of frames."""

from __future__ import annotations

from os import PathLike
from typing import Any

import numpy as np

from foliate.dataset.frames import Frames, Layout
from foliate.dataset.writer import Task, Writer, problem_table

__all__ = ["NpzWriter", "ParquetWriter"]


class NpzWriter(Writer):
    """Writes ``episodes/000000.npz`` and so on, ``layout.json`` (what the columns mean) and ``problems.jsonl``.

    A file has ``times``, ``state``, ``action``, ``objects``, ``closed`` and ``segment`` as ``foliate.dataset.Frames``, the names ``states``, ``transitions`` and ``contacts`` by segment,
    ``task``, and ``clearance`` where it is measured.
    """

    def __init__(self, out: str | PathLike[str], *, rate: float = 30.0, task: Task | None = None, clearance: bool = False) -> None:
        super().__init__(out, rate=rate, task=task, clearance=clearance)
        (self.out / "episodes").mkdir()
        self._problems = (self.out / "problems.jsonl").open("w", encoding="utf-8")

    def _episode(self, made: Frames, task: str, extra: dict[str, Any]) -> None:
        arrays: dict[str, Any] = {name: getattr(made, name) for name in ("times", "state", "action", "objects", "closed", "segment")}
        arrays |= {name: np.array(getattr(made, name), dtype=str) for name in ("states", "transitions", "contacts")}
        arrays |= {key: value for key, value in {**extra, "clearance": made.clearance}.items() if value is not None}
        np.savez_compressed(self.out / "episodes" / f"{self.episodes:06d}.npz", task=task, **arrays)

    def _problem(self, row: dict[str, Any]) -> None:
        import json

        self._problems.write(json.dumps(row) + "\n")

    def _finish(self) -> None:
        self._problems.close()
        self._write_json("layout.json", _layout(self.layout, self.rate))


class ParquetWriter(Writer):
    """Writes ``frames.parquet``, a row for each frame with a column for each coordinate, ``problems.parquet`` and ``layout.json``. Needs pyarrow."""

    BLOCK = 50_000
    """Frames that are kept before they are written."""

    def __init__(self, out: str | PathLike[str], *, rate: float = 30.0, task: Task | None = None, clearance: bool = False) -> None:
        import pyarrow

        super().__init__(out, rate=rate, task=task, clearance=clearance)
        self._pa = pyarrow
        self._tables: list[Any] = []
        self._rows: list[dict[str, Any]] = []
        self._held = 0
        self._files: dict[str, Any] = {}

    def _episode(self, made: Frames, task: str, extra: dict[str, Any]) -> None:
        assert self.layout is not None
        pa = self._pa
        columns: dict[str, Any] = {"episode": np.full(len(made), self.episodes), "frame": np.arange(len(made)), "time": made.times}
        columns |= {name: made.state[:, number] for number, name in enumerate(self.layout.robot)}
        columns |= {name: made.objects[:, number] for number, name in enumerate(self.layout.objects)}
        columns |= {f"{name}/closed": made.closed[:, number] for number, name in enumerate(self.layout.grippers)}
        for key, of_segments in (("state", made.states), ("transition", made.transitions), ("contact", made.contacts)):
            columns[key] = pa.array(np.asarray(of_segments, dtype=object)[made.segment], pa.string())
        if made.clearance is not None:
            columns["clearance"] = made.clearance
        self._tables.append(pa.table(columns))
        self._held += len(made)
        if self._held >= self.BLOCK:
            self._flush()

    def _problem(self, row: dict[str, Any]) -> None:
        self._rows.append(row)
        if len(self._rows) >= self.BLOCK:
            self._flush()

    def _flush(self) -> None:
        pa = self._pa
        if self._tables:
            self._write("frames", pa.concat_tables(self._tables))
        self._write("problems", problem_table(self._rows))
        self._tables, self._rows, self._held = [], [], 0

    def _write(self, name: str, table: Any) -> None:
        import pyarrow.parquet as parquet

        if name not in self._files:
            self._files[name] = parquet.ParquetWriter(self.out / f"{name}.parquet", table.schema, compression="zstd")
        self._files[name].write_table(table)

    def _finish(self) -> None:
        self._flush()
        for file in self._files.values():
            file.close()
        self._write_json("layout.json", _layout(self.layout, self.rate))


def _layout(layout: Layout | None, rate: float) -> dict[str, Any]:
    names = {"robot": layout.robot, "objects": layout.objects, "grippers": layout.grippers} if layout is not None else {}
    return {"rate": rate, **names}
