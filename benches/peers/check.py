"""Which answers are still to be proved, and what is kept of each proof."""

from __future__ import annotations

import datetime
import sys
import time
from dataclasses import asdict
from pathlib import Path

import numpy as np

import independent
from answer import AnswerCheck
from check_file import BREAKS, COLLIDES, COLUMNS, UNREADABLE, VALID, Check, Verdicts
from recheck import recheck
from rows import FOLIATE, Row, append, read_rows
from scene_file import read_scene
from settings import SCENES
from solvers import scene_file


def check_all(results: Path, work: Path, scenes: list[str], only: str | None = None) -> None:
    """Proves every answer of `scenes`, of one planner if `only` says so, that has no verdict yet."""
    rows = [row for row in read_rows(results / "rows.csv") if row.solved and row.scene in scenes]
    if only is not None:
        rows = [row for row in rows if (row.solver == FOLIATE) == (only == FOLIATE)]
    verdicts = Verdicts(results / "checks.csv")
    for scene in scenes:
        waiting = [row for row in rows if row.scene == scene and verdicts.of(row) is None]
        checker = None
        for row in waiting:
            if not (work / row.answer).is_file():
                print(f"{row.scene} {row.solver} seed {row.seed}: no {work / row.answer}", file=sys.stderr)
                continue
            if row.solver != FOLIATE and checker is None:
                checker = _checker(scene, work)
                if checker is None:
                    print(f"{scene}: no path of Foliate yet, which names the models", file=sys.stderr)
                    break
            found = _check(row, work, checker)
            append(results / "checks.csv", COLUMNS, asdict(found))
            why = "" if found.verdict == VALID else f": {found.pair} {found.depth:g} m; {found.what} {found.error:g}"
            print(f"{row.scene} {row.solver} seed {row.seed}: {found.verdict}{why}", flush=True)


def _checker(scene: str, work: Path) -> AnswerCheck | None:
    templates = sorted((work / scene).glob(f"{FOLIATE}-*.json"))
    if not templates:
        return None
    return AnswerCheck(read_scene(scene_file(scene)), templates[0], SCENES[scene])


def _check(row: Row, work: Path, checker: AnswerCheck | None) -> Check:
    started = time.process_time()
    found = _foliate(work / row.answer) if row.solver == FOLIATE else _hpp(work / row.answer, checker)
    return Check(
        scene=row.scene, solver=row.solver, seed=row.seed, series=row.series, version=row.version,
        seconds=round(time.process_time() - started, 1),
        date=datetime.datetime.now().isoformat(timespec="seconds"), **found,
    )


def _hpp(file: Path, checker: AnswerCheck) -> dict:
    with np.load(file) as stored:
        finding = checker.check(stored["configurations"], stored["segments"])
    found = {name: round(value, 7) if isinstance(value, float) else value for name, value in asdict(finding).items()}
    return {**found, "verdict": finding.verdict(checker.settings), "mode": "sampled every 5 mm"}


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
