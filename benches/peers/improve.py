#!/usr/bin/env python3
"""Paths after improvement: HPP's path optimisers and Foliate's, from the first path of either planner.

    improve.py run --foliate PROGRAM --commit ID [--scenes NAME ...] [--seeds 3] [--splines 1]
    improve.py table

`run` appends to `results/improvement.csv`, a seed of all scenes before the next one, both planners in turns, and goes on where an
earlier call ended. Every path is measured in the same way (`motion_measure.py`) and proved with pinocchio and coal.
"""

from __future__ import annotations

import argparse
import datetime
import json
import subprocess
import sys
from pathlib import Path
from statistics import median

import improve_file
from improve_file import FIRST, FOLIATE, HPP, SOLVED, Improved
from peers import RESULTS, WORK, machine
from rows import ResultsError, read_rows
from settings import SCENES
from solvers import (HERE, SolverError, foliate_version, hpp_environment, hpp_version, scene_file, solve_with_foliate)

LIMIT_S = 60.0
OPTIMISE_S = 20.0
"""Processor time that HPP is given for a solve, and for each optimiser."""
OURS = {FIRST: ["--first"], "0.1 s": ["--improve-time", 0.1], "default": []}
"""Foliate's paths: method and options."""


class Run:
    def __init__(self, options: argparse.Namespace):
        self.options, self.file = options, options.results / "improvement.csv"
        self.hpp, self.foliate = hpp_version(), foliate_version(options.foliate, options.commit)
        self.solver = quickest(options.results)

    def all(self) -> None:
        for seed in range(1, self.options.seeds + 1):
            for scene in self.options.scenes:
                known = {(row.planner, row.seed) for row in improve_file.read(self.file) if row.scene == scene}
                if not {(HPP, seed), (FOLIATE, seed)} <= known:
                    self.one(scene, seed)

    def one(self, scene: str, seed: int) -> None:
        folder = self.options.work / scene / f"improved-{seed}"
        folder.mkdir(parents=True, exist_ok=True)
        ours = [self._ours(scene, seed, method, folder) for method in OURS]
        template = folder / "foliate-default.json"
        if not template.exists():
            print(f"{scene} seed {seed}: Foliate has no path", file=sys.stderr, flush=True)
            return
        for row in [*ours, *self._theirs(scene, seed, folder, template)]:
            improve_file.add(self.file, row)
            print(f"{scene} {row.planner} {row.method} seed {seed}: {row.outcome} {row.seconds:.3f} s, length {row.length}, "
                  f"{row.stopping_s} / {row.own_s} s, {row.grasp_changes} changes, {row.verdict}", flush=True)

    def _ours(self, scene: str, seed: int, method: str, folder: Path) -> Improved:
        from check import _foliate as proof
        from motion_measure import length, limits_of, read_motion, stopping_time

        file = folder / f"foliate-{method.replace(' ', '')}.json"
        told = solve_with_foliate(self.options.foliate, scene, seed, file, OURS[method])
        row = {"scene": scene, "planner": FOLIATE, "solver": "", "seed": seed, "method": method, "version": self.foliate}
        if told["outcome"] != "solved":
            return self._row(row, outcome=str(told["outcome"]), seconds=told["cpu_s"])
        motion = read_motion(file)
        # The first path has no limits of rates: those of the scene's timed path are the scene's.
        rates = _rates(file) or self._scene_rates(scene, seed, folder)
        limits = limits_of(motion.names, rates)
        wall = told["solve_ms"] if method == FIRST else told["improvement"]["ms"] + told["timing_ms"]
        return self._row(
            row, outcome=SOLVED, seconds=min(wall / 1000.0, told["cpu_s"]), length=length(motion.rows, limits),
            stopping_s=stopping_time(motion.pieces, limits) if method == FIRST else None,
            own_s=motion.moving_s, pieces=len(motion.pieces) if method == FIRST else None,
            grasp_changes=motion.grasp_changes, verdict=proof(file)["verdict"],
        )

    def _scene_rates(self, scene: str, seed: int, folder: Path) -> dict:
        file = folder / "foliate-rates.json"
        solve_with_foliate(self.options.foliate, scene, seed, file, ["--improve-work", 0])
        return _rates(file)

    def _theirs(self, scene: str, seed: int, folder: Path, template: Path) -> list[Improved]:
        rates, solver = folder / "rates.json", self.solver[scene]
        rates.write_text(json.dumps(_rates(template)))
        command = ["setarch", "-R", sys.executable, HERE / "hpp_improve.py", scene_file(scene), solver, seed, LIMIT_S, OPTIMISE_S,
                   rates, folder]
        command += ["--splines"] * (seed <= self.options.splines)
        done = subprocess.run([str(word) for word in command], env=hpp_environment(), stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, text=True, check=False)
        told = [json.loads(line) for line in done.stdout.splitlines()]
        if not told:
            told = [{"method": FIRST, "outcome": "timeout" if done.returncode < 0 else "crashed", "cpu_s": LIMIT_S}]
        if "error" in told[0]:
            raise SolverError(f"{scene}: {told[0]['error']}")
        judge = _Judge(scene, template)
        rows, first, before = [], told[0], {}
        for known in told:
            row = {"scene": scene, "planner": HPP, "solver": solver, "seed": seed, "method": known["method"],
                   "version": self.hpp, "outcome": known["outcome"], "seconds": known["cpu_s"],
                   "own_s": known.get("own_s"), "reason": known.get("reason", known.get("own_reason", ""))}
            file = folder / f"{known['method']}.npz"
            solved = known["outcome"] == SOLVED and "samples" in known
            if solved and known is not first and all(known[key] == first[key] for key in ("length", "segments", "samples")):
                measured = before  # nothing was changed
            else:
                measured = judge.measure(file) if solved else {}
            if known is first:
                before = measured
            rows.append(self._row(row, **measured))
        return rows

    @staticmethod
    def _row(row: dict, **values) -> Improved:
        empty = dict.fromkeys(("length", "stopping_s", "own_s", "pieces", "grasp_changes"))
        date = datetime.datetime.now().isoformat(timespec="seconds")
        return Improved(**{**empty, "verdict": "", "reason": "", "machine": machine(), "date": date, **row, **values})


class _Judge:
    """Measures and proves HPP's paths of a scene; a path file of Foliate names models, pairs and limits."""

    def __init__(self, scene: str, template: Path):
        from answer import AnswerCheck
        from scene_file import read_scene

        self.scene = read_scene(scene_file(scene))
        self.settings = SCENES[scene]
        self.check = AnswerCheck(self.scene, template, self.settings)
        self.path = json.loads(template.read_text())

    def measure(self, file: Path) -> dict:
        import numpy as np

        from motion_measure import corners, length, limits_of, stopping_time, unwrapped

        with np.load(file) as stored:
            rows, parts = stored["configurations"], stored["segments"]
        robots = {part.name for part in self.scene.parts if part.kind == "robot"}
        names = [name for name in self.scene.coordinates if name.partition("/")[0] in robots]
        columns = [self.scene.coordinates.index(name) for name in names]
        limits = limits_of(names, self.path["rate_limits"])
        motion = unwrapped(rows[:, columns], names, set(names) - set(self.path["limits"]))
        pieces = [piece for part in range(parts.max() + 1) for piece in corners(motion[parts == part])]
        finding = self.check.check(rows, parts)
        return {
            "length": length(motion, limits), "stopping_s": stopping_time(pieces, limits), "pieces": len(pieces),
            "grasp_changes": self.check.grasp_changes(rows, parts), "verdict": finding.verdict(self.settings),
        }


def _rates(file: Path) -> dict:
    return json.loads(file.read_text()).get("rate_limits", {})


def quickest(results: Path) -> dict[str, str]:
    """Of HPP's solvers the one with the smaller median, by the rows of the comparison of searches."""
    rows = [row for row in read_rows(results / "rows.csv") if row.series == "main"]
    chosen = {}
    for scene, settings in SCENES.items():
        times = {solver: [row.solve_s if row.solved else row.limit_s for row in rows if (row.scene, row.solver) == (scene, solver)]
                 for solver in settings.solvers}
        chosen[scene] = min(settings.solvers, key=lambda solver: median(times[solver] or [float("inf")]))
    return chosen


# The table

def better(rows: list[Improved]) -> Improved | None:
    """The optimiser's path that takes least time among those that are right."""
    right = [row for row in rows if row.outcome == SOLVED and row.method != FIRST and row.verdict == "valid"]
    return min(right, key=lambda row: (row.stopping_s, row.seconds), default=None)


def markdown(rows: list[Improved]) -> str:
    lines = ["| scene | seeds | HPP first | RandomShortcut | best of its optimisers | Foliate first | 0.1 s | default |",
             "| :-- | --: | :-- | :-- | :-- | :-- | :-- | :-- |"]
    for scene in SCENES:
        mine = [row for row in rows if row.scene == scene]
        theirs = [row for row in mine if row.planner == HPP]
        seeds = sorted({row.seed for row in theirs if row.outcome == SOLVED})
        if not seeds:
            continue
        best = [better([row for row in theirs if row.seed == seed]) for seed in seeds]
        cells = [_cell(_of(theirs, FIRST)), _cell(_of(theirs, "RandomShortcut")), _cell([row for row in best if row])]
        cells += [_cell(_of([row for row in mine if row.planner == FOLIATE and row.seed in seeds], method)) for method in OURS]
        lines.append(f"| {scene} | {len(seeds)} | {' | '.join(cells)} |")
    return "\n".join(lines)


def by_method(rows: list[Improved]) -> str:
    """What each of HPP's optimisers did to its first paths."""
    lines = ["| optimiser | paths | failed or out of time | wrong answers | length ÷ first | time ÷ first | seconds |",
             "| :-- | --: | --: | --: | --: | --: | --: |"]
    first = {(row.scene, row.seed): row for row in rows if row.planner == HPP and row.method == FIRST and row.outcome == SOLVED}
    theirs = [row for row in rows if row.planner == HPP and row.method != FIRST]
    for method in dict.fromkeys(row.method for row in theirs):
        mine = [row for row in theirs if row.method == method]
        done = [row for row in mine if row.outcome == SOLVED and row.length is not None]
        pairs = [(row, first[row.scene, row.seed]) for row in done]
        wrong = sum(row.verdict not in ("", "valid") for row in done)
        shares = [_median([of(row) / of(before) for row, before in pairs if of(before)], 2)
                  for of in (lambda row: row.length, lambda row: row.stopping_s)]
        lines.append(f"| {method} | {len(mine)} | {len(mine) - len(done)} | {wrong} | {shares[0]} | {shares[1]} | "
                     f"{_median([row.seconds for row in done], 3)} |")
    return "\n".join(lines)


def _of(rows: list[Improved], method: str) -> list[Improved]:
    return [row for row in rows if row.method == method and row.outcome == SOLVED and row.length is not None]


def _cell(rows: list[Improved]) -> str:
    """Medians: length, time of the motion, grasps and releases, processor time of the step."""
    if not rows:
        return "–"
    own = [row.own_s if row.planner == FOLIATE and row.method != FIRST else row.stopping_s for row in rows]
    wrong = sum(row.verdict not in ("", "valid") for row in rows)
    return (f"{median(row.length for row in rows):.1f}, {median(own):.1f} s, {median(row.grasp_changes for row in rows):g}"
            f" ({_median([row.seconds for row in rows], 2)} s)" + (f", {wrong} wrong" if wrong else ""))


def _median(values: list[float], digits: int) -> str:
    return f"{median(values):.{digits}g}" if values else "–"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("command", choices=("run", "table"))
    parser.add_argument("--foliate", type=Path, default=Path("foliate"), metavar="PROGRAM")
    parser.add_argument("--commit", default="", metavar="ID", help="what the program was built from")
    parser.add_argument("--scenes", nargs="+", default=list(SCENES), choices=list(SCENES), metavar="NAME")
    parser.add_argument("--seeds", type=int, default=3, help="seeds 1 to this")
    parser.add_argument("--splines", type=int, default=1, help="seeds with HPP's gradient-based optimisers, which are slow")
    parser.add_argument("--results", type=Path, default=RESULTS, metavar="DIR")
    parser.add_argument("--work", type=Path, default=WORK, metavar="DIR", help="where paths are kept")
    options = parser.parse_args()
    try:
        if options.command == "run":
            Run(options).all()
        else:
            rows = improve_file.read(options.results / "improvement.csv")
            print(markdown(rows), by_method(rows), sep="\n\n")
    except (ResultsError, SolverError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
