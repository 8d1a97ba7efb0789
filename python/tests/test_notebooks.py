"""The notebooks run from the first cell to the last, and have no outputs of somebody else in them."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).resolve().parents[1] / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: str(file.stem))
def test_notebooks_run(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nbclient = pytest.importorskip("nbclient")
    nbformat = pytest.importorskip("nbformat")
    for needed in ("ipykernel", "matplotlib", "pyarrow"):
        pytest.importorskip(needed)
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    # The same code on fewer problems: the thousand plans take a minute on a busy machine.
    notebook = nbformat.reads(file.read_text(encoding="utf-8").replace("PLANS = 1000", "PLANS = 60"), as_version=4)
    done = nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = os.linesep.join(str(output) for cell in done.cells for output in cell.get("outputs", []))
    if file.stem.startswith("1_"):
        assert "<iframe srcdoc=" in shown and "image/png" in shown


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: str(file.stem))
def test_notebooks_are_kept_without_outputs(file: Path) -> None:
    cells = json.loads(file.read_text(encoding="utf-8"))["cells"]
    assert cells and all(not cell.get("outputs") and cell.get("execution_count") is None for cell in cells)
