"""Which answers are still to be proved, and what is kept of each proof."""

from __future__ import annotations

import datetime
import sys
import time
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np

import independent
from answer import AnswerCheck
from packages import search_directories  # noqa: F401
from recheck import recheck
from rows import FOLIATE, Row, append, read_records, read_rows
from scene_file import read_scene
from settings import SCENES
from solvers import scene_file

VALID, COLLIDES, BREAKS, UNREADABLE = "valid", "collides", "breaks", "unreadable"


@dataclass(frozen=True)
class Check:
    """One proof. `mode`: how Foliate's answers (the continuum, certified) and HPP's (samples) are tested; the other
    columns are those of `answer.Finding`, for Foliate only the verdict and what was found first."""

    scene: str
    solver: str
    seed: int
    series: str
    version: str
    verdict: str
    depth: float
    pair: str
    error: float
    what: str
    samples: int
    step: float
    goal_off: float
    centre_off: float
    mode: str
    seconds: float
    date: str

    @property
    def key(self) -> tuple[str, str, int, str, str]:
        return self.scene, self.solver, self.seed, self.series, self.version


COLUMNS = [column.name for column in fields(Check)]


def read_verdicts(file: Path) -> dict[tuple, str]:
    """The verdict of every answer that has one; the last counts."""
    if not file.exists():
        return {}
    return {
        (record["scene"], record["solver"], int(record["seed"]), record["series"], record["version"]): record["verdict"]
        for _, record in read_records(file, COLUMNS)
    }


def check_all(results: Path, work: Path, scenes: list[str]) -> None:
    """Proves every answer of `scenes` that has no verdict yet."""
    rows = [row for row in read_rows(results / "rows.csv") if row.solved and row.scene in scenes]
    known = read_verdicts(results / "checks.csv")
    for scene in scenes:
        waiting = [row for row in rows if row.scene == scene and row.key not in known]
        checker = None
        for row in waiting:
            if not (work / row.answer).exists():
                print(f"{row.scene} {row.solver} seed {row.seed}: {work / row.answer} is gone", file=sys.stderr)
                continue
            if row.solver != FOLIATE and checker is None:
                checker = _checker(scene, work)
                if checker is None:
                    print(f"{scene}: no path of Foliate yet, which names the models", file=sys.stderr)
                    break
            found = _check(row, work, checker)
            append(results / "checks.csv", COLUMNS, asdict(found))
            print(f"{row.scene} {row.solver} seed {row.seed}: {found.verdict} {found.what} {found.pair}", flush=True)


def _checker(scene: str, work: Path) -> AnswerCheck | None:
    templates = sorted((work / scene).glob(f"{FOLIATE}-*.json"))
    if not templates:
        return None
    return AnswerCheck(read_scene(scene_file(scene)), templates[0], SCENES[scene].threshold)


def _check(row: Row, work: Path, checker: AnswerCheck | None) -> Check:
    started = time.perf_counter()
    found = _foliate(work / row.answer) if row.solver == FOLIATE else _hpp(work / row.answer, checker)
    return Check(
        scene=row.scene, solver=row.solver, seed=row.seed, series=row.series, version=row.version,
        seconds=round(time.perf_counter() - started, 1),
        date=datetime.datetime.now().isoformat(timespec="seconds"), **found,
    )


def _hpp(file: Path, checker: AnswerCheck) -> dict:
    with np.load(file) as stored:
        finding = checker.check(stored["configurations"])
    found = {name: round(value, 7) if isinstance(value, float) else value for name, value in asdict(finding).items()}
    return {**found, "verdict": finding.verdict(checker.threshold), "mode": "sampled every 5 mm"}


def _foliate(file: Path) -> dict:
    """By the independent re-check of `tests/independent`, which certifies the continuum."""
    found = {"depth": 0.0, "pair": "", "error": 0.0, "what": "", "samples": 0, "step": 0.0, "goal_off": 0.0,
             "centre_off": 0.0, "mode": "certified", "verdict": VALID}
    try:
        report = recheck(file, [], None)
    except independent.InputError as error:
        return {**found, "verdict": UNREADABLE, "what": str(error)[:200]}
    if report.violations:
        collides = report.has("collision")
        return {**found, "verdict": COLLIDES if collides else BREAKS, "what": str(report.violations[0])[:200]}
    return found
