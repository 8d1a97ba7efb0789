"""Rows of ``foliate bench`` as tables of Arrow, and as Parquet. Needs pyarrow (``pip install pyarrow``)."""

from __future__ import annotations

import importlib
from os import PathLike
from pathlib import Path
from typing import Any

__all__ = ["read_results", "write_parquet"]

_WHOLE = ("seed", "steps", "candidates", "nodes", "edges", "segments", "instance", "threads", "grasp_changes", "improve_work")
_REAL = (
    "solve_ms",
    "load_ms",
    "improve_ms",
    "timing_ms",
    "path_length",
    "min_clearance",
    "max_residual",
    "first_cost",
    "final_cost",
    "duration",
)
_WORDS = ("scene", "scheduler", "outcome", "roadmap", "message", "settings", "refused", "id", "untimed")


def read_results(folder: str | PathLike[str]) -> Any:
    """The rows of a batch as a ``pyarrow.Table``: those of ``results.csv`` in the folder that ``foliate bench --out`` wrote.

    Counts and seeds are ``uint64``, measures ``double`` (milliseconds, metres, seconds), all else ``string``. What a row does not have is null.

    Raises ``ModuleNotFoundError`` without pyarrow, ``OSError`` where there are no results.
    """
    arrow, csv = importlib.import_module("pyarrow"), importlib.import_module("pyarrow.csv")
    types = {name: arrow.uint64() for name in _WHOLE} | {name: arrow.float64() for name in _REAL} | {name: arrow.string() for name in _WORDS}
    # Of identities and hashes one that has digits alone would be taken for a number.
    convert = csv.ConvertOptions(column_types=types, strings_can_be_null=True, null_values=[""], quoted_strings_can_be_null=False)
    parse = csv.ParseOptions(newlines_in_values=True)
    return csv.read_csv(str(Path(folder) / "results.csv"), convert_options=convert, parse_options=parse)


def write_parquet(folder: str | PathLike[str], file: str | PathLike[str]) -> None:
    """Writes the rows of a batch, as ``read_results`` gives them, to a Parquet file.

    Raises what ``read_results`` raises, and ``OSError`` where the file cannot be written.
    """
    importlib.import_module("pyarrow.parquet").write_table(read_results(folder), str(file))
