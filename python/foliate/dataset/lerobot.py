"""Datasets in the form LeRobot v3.0: frames of many episodes in one Parquet file, with their meta data beside it."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foliate.dataset.frames import Frames, Layout
from foliate.dataset.statistics import NUMBERS, Statistics, of_episodes
from foliate.dataset.writer import Task, Writer, problem_table

__all__ = ["LeRobotWriter"]

VERSION = "v3.0"
CHUNK = 1000
"""Files in a folder."""
FILE_MEGABYTES = 100
BLOCK = 50_000
"""Frames that are kept before they are written."""
DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
EPISODES = "meta/episodes/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
STATE, ENVIRONMENT, CLEARANCE, ACTION = "observation.state", "observation.environment_state", "observation.clearance", "action"
NAMES = ("annotation.state_index", "annotation.transition_index", "annotation.contact_index")


@dataclass
class _Episode:
    frames: Frames
    task: int
    meta: dict[str, Any]


class LeRobotWriter(Writer):
    """Writes a LeRobot v3.0 dataset without videos. Needs pyarrow.

    ``observation.state`` has the coordinates of the robots and, for each gripper, 1 where it holds something; ``action`` is the state of the next frame;
    ``observation.environment_state`` has the coordinates of the objects, ``observation.clearance``, where it is measured, how close things are (m). ``annotation.state_index``, ``annotation.transition_index`` and ``annotation.contact_index`` are numbers of names in
    ``meta/annotations.json``: of the state and the transition of the constraint graph, and who holds what. ``meta/problems.parquet`` has a row for every problem, also those without a path. The same answers make the same bytes.
    """

    def __init__(self, out: str | PathLike[str], *, rate: float = 30.0, task: Task | None = None, clearance: bool = False, robot_type: str | None = None) -> None:
        import pyarrow

        super().__init__(out, rate=rate, task=task, clearance=clearance)
        if rate != int(rate):
            raise ValueError(f"LeRobot has whole numbers of frames a second, not {rate}")
        self.robot_type = robot_type
        self._pa = pyarrow
        self._tasks: dict[str, int] = {}
        self._names: dict[str, dict[str, int]] = {key: {} for key in NAMES}
        self._block: list[_Episode] = []
        self._rows: list[dict[str, Any]] = []
        self._held = 0
        self._data: _Files | None = None
        self._meta = _Files(self, EPISODES)
        self._problem_file: Any = None
        self._statistics: dict[str, Statistics] = {}

    def _episode(self, made: Frames, task: str, extra: dict[str, Any]) -> None:
        number = self._tasks.setdefault(task, len(self._tasks))
        meta = {"episode_index": self.episodes, "tasks": [task], "length": len(made), "dataset_from_index": self.frames}
        self._block.append(_Episode(made, number, {**meta, "dataset_to_index": self.frames + len(made), **extra}))
        self._held += len(made)
        if self._held >= BLOCK:
            self._flush()

    def _problem(self, row: dict[str, Any]) -> None:
        self._rows.append(row)
        if len(self._rows) >= BLOCK:
            self._flush_problems()

    def _flush(self) -> None:
        """Writes the episodes that are kept."""
        if not self._block:
            return
        assert self.layout is not None
        pa, block, layout = self._pa, self._block, self.layout
        lengths = np.array([len(episode.frames) for episode in block])
        columns = _numbers(block, lengths) | self._annotations(block)
        features = self._features(layout)
        table = {key: self._array(values, features[key]["shape"][0]) for key, values in columns.items()}
        if self._data is None:
            self._data = _Files(self, DATA)
        place = self._data.write(pa.table({key: table[key] for key in features}))
        of_each = {key: of_episodes(columns[key], lengths) for key in columns}
        for key, values in columns.items():
            self._statistics.setdefault(key, Statistics()).add(values)
        meta_place = self._meta.place()
        rows: dict[str, Any] = {key: [episode.meta[key] for episode in block] for key in block[0].meta}
        rows |= {f"data/{key}": [value] * len(block) for key, value in place.items()}
        rows |= {f"meta/episodes/{key}": [value] * len(block) for key, value in meta_place.items()}
        for key, stats in of_each.items():
            for name in NUMBERS:
                kind = pa.int64() if name == "count" else pa.float64()
                rows[f"stats/{key}/{name}"] = pa.array([*stats[name]], pa.list_(kind))
        kinds = {"duration": pa.float64(), "min_clearance": pa.float64(), "seed": pa.uint64()}
        made_rows = {key: pa.array(value, kinds.get(key)) if isinstance(value, list) else value for key, value in rows.items()}
        self._meta.write(pa.table(made_rows))
        self._block, self._held = [], 0

    def _annotations(self, block: list[_Episode]) -> dict[str, NDArray[np.int64]]:
        """The names of some episodes, as numbers."""
        columns: dict[str, list[NDArray[np.int64]]] = {key: [] for key in NAMES}
        for made in (episode.frames for episode in block):
            for key, of_segments in zip(NAMES, (made.states, made.transitions, made.contacts), strict=True):
                known = self._names[key]
                numbers = np.array([known.setdefault(name, len(known)) for name in of_segments])
                columns[key].append(numbers[made.segment])
        return {key: np.concatenate(pieces) for key, pieces in columns.items()}

    def _array(self, values: NDArray[Any], width: int) -> Any:
        if values.ndim == 1:
            return self._pa.array(values)
        return self._pa.FixedSizeListArray.from_arrays(self._pa.array(values.reshape(-1)), width)

    def _flush_problems(self) -> None:
        import pyarrow.parquet as parquet

        table = problem_table(self._rows)
        if self._problem_file is None:
            (self.out / "meta").mkdir(exist_ok=True)
            self._problem_file = parquet.ParquetWriter(self.out / "meta" / "problems.parquet", table.schema, compression="zstd")
        self._problem_file.write_table(table)
        self._rows = []

    def _finish(self) -> None:
        self._flush()
        self._flush_problems()
        self._problem_file.close()
        if self._data is not None:
            self._data.close()
        self._meta.close()
        features = self._features(self.layout) if self.layout is not None else {}
        self._write_tasks()
        self._write_json("meta/annotations.json", {key: list(names) for key, names in self._names.items()})
        self._write_json("meta/stats.json", {key: statistics.told() for key, statistics in self._statistics.items()})
        info = {
            "codebase_version": VERSION,
            "robot_type": self.robot_type,
            "total_episodes": self.episodes,
            "total_frames": self.frames,
            "total_tasks": len(self._tasks),
            "chunks_size": CHUNK,
            "data_files_size_in_mb": FILE_MEGABYTES,
            "video_files_size_in_mb": 200,
            "fps": int(self.rate),
            "splits": {"train": f"0:{self.episodes}"},
            "data_path": DATA,
            "video_path": None,
            "features": features,
        }
        self._write_json("meta/info.json", info)

    def _write_tasks(self) -> None:
        import json

        import pyarrow.parquet as parquet

        pa = self._pa
        tasks = pa.array(list(self._tasks), pa.string())
        table = pa.table({"task_index": pa.array(range(len(self._tasks)), pa.int64()), "task": tasks})
        # LeRobot reads this file by pandas, with the words as its index.
        column = {"name": "task_index", "field_name": "task_index", "pandas_type": "int64", "numpy_type": "int64", "metadata": None}
        index = {"name": "task", "field_name": "task", "pandas_type": "unicode", "numpy_type": "object", "metadata": None}
        metadata = {"index_columns": ["task"], "column_indexes": [], "columns": [column, index], "pandas_version": "2.0.0"}
        parquet.write_table(table.replace_schema_metadata({"pandas": json.dumps(metadata)}), self.out / "meta" / "tasks.parquet")

    def _features(self, layout: Layout) -> dict[str, dict[str, Any]]:
        state = [*layout.robot, *(f"{gripper}/closed" for gripper in layout.grippers)]

        def of(kind: str, names: list[str] | None = None) -> dict[str, Any]:
            return {"dtype": kind, "shape": [1 if names is None else len(names)], "names": names}

        features = {STATE: of("float32", state), ACTION: of("float32", state)}
        if layout.objects:
            features[ENVIRONMENT] = of("float32", list(layout.objects))
        if self.clearance:
            features[CLEARANCE] = of("float32")
        features |= {key: of("int64") for key in NAMES}
        features |= {"next.done": of("bool"), "timestamp": of("float32")}
        return features | {key: of("int64") for key in ("frame_index", "episode_index", "index", "task_index")}


def _numbers(block: list[_Episode], lengths: NDArray[np.int64]) -> dict[str, NDArray[Any]]:
    """The columns of numbers of some episodes."""
    every = [episode.frames for episode in block]
    closed = np.concatenate([made.closed for made in every]).astype(np.float32)
    state = np.hstack([np.concatenate([made.state for made in every]).astype(np.float32), closed])
    first = block[0].meta["dataset_from_index"]
    index = first + np.arange(lengths.sum())
    starts = np.repeat([episode.meta["dataset_from_index"] for episode in block], lengths)
    last = index == np.repeat([episode.meta["dataset_to_index"] - 1 for episode in block], lengths)
    following = np.minimum(np.arange(len(state)) + ~last, len(state) - 1)
    columns: dict[str, NDArray[Any]] = {STATE: state, ACTION: state[following]}
    objects = np.concatenate([made.objects for made in every]).astype(np.float32)
    if objects.shape[1]:
        columns[ENVIRONMENT] = objects
    near = [made.clearance for made in every if made.clearance is not None]
    if near:
        columns[CLEARANCE] = np.concatenate(near).astype(np.float32)
    return columns | {
        "next.done": last,
        "timestamp": np.concatenate([made.times for made in every]).astype(np.float32),
        "frame_index": index - starts,
        "episode_index": np.repeat([episode.meta["episode_index"] for episode in block], lengths),
        "index": index,
        "task_index": np.repeat([episode.task for episode in block], lengths),
    }


class _Files:
    """Parquet files of a bounded size, numbered by chunk and file."""

    def __init__(self, writer: LeRobotWriter, name: str) -> None:
        self.writer = writer
        self.name = name
        self.number = 0
        self.file: Any = None
        self.at: Any = None

    def place(self) -> dict[str, int]:
        """Where the next table goes."""
        return {"chunk_index": self.number // CHUNK, "file_index": self.number % CHUNK}

    def write(self, table: Any) -> dict[str, int]:
        """Appends a table; says where it is."""
        import pyarrow.parquet as parquet

        place = self.place()
        if self.file is None:
            self.at = self.writer.out / self.name.format(**place)
            self.at.parent.mkdir(parents=True, exist_ok=True)
            self.file = parquet.ParquetWriter(self.at, table.schema, compression="zstd")
        self.file.write_table(table)
        if self.at.stat().st_size >= FILE_MEGABYTES << 20:
            self.close()
            self.number += 1
        return place

    def close(self) -> None:
        if self.file is not None:
            self.file.close()
            self.file = None
