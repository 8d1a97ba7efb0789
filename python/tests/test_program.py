"""The program ``foliate`` that the wheel brings."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "foliate", *arguments], capture_output=True, text=True, timeout=120)


def test_it_plans_and_proves(tmp_path: Path) -> None:
    out = tmp_path / "path.json"
    solved = run("solve", "demo", "--out", str(out))
    assert solved.returncode == 0, solved.stderr
    checked = run("check", str(out))
    assert checked.returncode == 0 and "proved" in checked.stdout


def test_exit_codes_are_those_of_the_program(tmp_path: Path) -> None:
    assert run("--version").stdout.startswith("foliate ")
    assert run("no-such-command").returncode == 2
    assert run("check", str(tmp_path / "none.json")).returncode == 2
    assert run("solve", "demo", "--help-search").returncode == 0
