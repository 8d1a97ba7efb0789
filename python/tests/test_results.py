"""Rows of a batch as tables of Arrow."""

from __future__ import annotations

import csv
import importlib
from pathlib import Path

import pytest
from foliate.results import read_results, write_parquet
from test_program import run


def test_rows_become_parquet(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    parquet = importlib.import_module("pyarrow.parquet")
    out = tmp_path / "out"
    suite = tmp_path / "suite.toml"
    suite.write_text(
        'format = "foliate.suite/1"\nname = "x"\nscenes = ["demo"]\nseeds = "1..2"\n'
        '[[settings]]\nname = "usual"\n[[settings]]\nname = "short"\nmax_steps = 1\n'
    )
    done = run("bench", "--suite", str(suite), "--out", str(out))
    assert done.returncode == 1, done.stderr
    table = read_results(out)
    write_parquet(out, tmp_path / "rows.parquet")
    assert parquet.read_table(tmp_path / "rows.parquet").equals(table)
    with open(out / "results.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert table.column_names == list(rows[0])
    assert str(table.schema.field("seed").type) == "uint64" and str(table.schema.field("id").type) == "string"
    for row, typed in zip(rows, table.to_pylist(), strict=True):
        for name, cell in row.items():
            value = typed[name]
            if cell == "":
                assert value is None, name
            elif isinstance(value, str):
                assert value == cell
            else:
                assert float(value) == float(cell)
    assert [row["outcome"] for row in rows] == ["solved", "solved", "step_limit", "step_limit"]


def test_no_results_are_an_error(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    with pytest.raises(OSError):
        read_results(tmp_path)
