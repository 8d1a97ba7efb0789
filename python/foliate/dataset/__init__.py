"""Datasets of plans: LeRobot v3, plain Parquet, NPZ.

>>> from foliate import Scene, dataset
>>> made = dataset.make(((Scene("demo"), {"seed": seed}) for seed in range(1, 4)), folder / "boxes", improve_work=0)
>>> made.episodes
3

``make`` plans and writes. ``LeRobotWriter``, ``ParquetWriter`` and ``NpzWriter`` write answers that come from elsewhere, ``frames`` makes the frames of one path. Parquet needs pyarrow
(``pip install foliate-planner[dataset]``).
"""

from foliate.dataset.answers import NpzWriter, ParquetWriter
from foliate.dataset.frames import Frames, frames
from foliate.dataset.lerobot import LeRobotWriter
from foliate.dataset.make import Made, make
from foliate.dataset.writer import Writer

__all__ = ["Frames", "LeRobotWriter", "Made", "NpzWriter", "ParquetWriter", "Writer", "frames", "make"]
