#!/usr/bin/env python3
"""HPP and Foliate on the same problems, one solve after the other on one core.

    peers.py run --foliate PROGRAM --commit ID [--scenes NAME ...] [--seeds 10] [--only foliate] [--again] [--control 3]
    peers.py check [--scenes NAME ...] [--only hpp]
    peers.py table

`run` appends a row per solve to `results/rows.csv` and goes on where an earlier call ended; `check` proves answers with
other people's code and appends to `results/checks.csv`; `table` prints both as Markdown. Paths are kept below `--work`.
"""

from __future__ import annotations

import argparse
import datetime
import platform
import sys
from pathlib import Path

import schedule
from rows import CRASHED, FAILED, FOLIATE, SOLVED, TIMEOUT, Results, ResultsError, Row
from schedule import Solve
from settings import SCENES
from solvers import (FOLIATE_LIMIT_S, HppServer, SolverError, foliate_version, hpp_version, solve_with_foliate)

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "results"
WORK = HERE.parents[1] / "target" / "peers"
LIMIT_S = 60.0
"""Processor time that HPP is given for a solve."""
FOLIATE_OUTCOMES = {"solved": SOLVED, "timeout": TIMEOUT, "crashed": CRASHED}


class Runner:
    """Makes solves and writes their rows; keeps the server of the scene at hand."""

    def __init__(self, options: argparse.Namespace):
        self.options = options
        self.results = Results(options.results / "rows.csv")
        self.hpp = hpp_version() if options.only != FOLIATE or options.control else ""
        self.foliate = foliate_version(options.foliate, options.commit)
        self.server: HppServer | None = None
        self.served = ""

    def run(self, solves: list[Solve]) -> None:
        waiting = [solve for solve in solves if self.options.again or not self.results.has(self._key(solve))]
        for number, solve in enumerate(waiting, 1):
            try:
                row = self._foliate(solve) if solve.solver == FOLIATE else self._hpp(solve)
            except SolverError as error:
                print(f"{solve}: {error}", file=sys.stderr, flush=True)
                self._leave()
                continue
            self.results.add(row)
            print(f"{number}/{len(waiting)} {solve}: {row.outcome} {row.solve_s:.3f} s {row.reason[:80]}", flush=True)
        self._leave()

    def _key(self, solve: Solve) -> tuple:
        version = self.foliate if solve.solver == FOLIATE else self.hpp
        return solve.scene, solve.solver, solve.seed, solve.series, version

    def _hpp(self, solve: Solve) -> Row:
        if self.served != solve.scene:
            self._leave()
            self.server, self.served = HppServer(solve.scene), solve.scene
        answer = self._answer(solve, "npz")
        (self.options.work / answer).unlink(missing_ok=True)
        told = self.server.solve(solve.solver, solve.seed, LIMIT_S, self.options.work / answer)
        time = LIMIT_S if told["outcome"] == TIMEOUT else told["cpu_s"]
        return self._row(solve, told, self.hpp, answer, solve_s=time, limit_s=LIMIT_S, reason=told.get("reason", ""),
                         setup_s=self.server.ready["setup_s"], wall_s=told["wall_s"], length=told.get("length"))

    def _foliate(self, solve: Solve) -> Row:
        commit = self.foliate.split()[-1]
        answer = self._answer(solve, "json", f"-{commit}")
        told = solve_with_foliate(self.options.foliate, solve.scene, solve.seed, self.options.work / answer)
        told = {**told, "outcome": FOLIATE_OUTCOMES.get(told["outcome"], FAILED)}
        wall = told.get("solve_ms", 1000.0 * FOLIATE_LIMIT_S) / 1000.0
        return self._row(solve, told, self.foliate, answer, solve_s=wall, limit_s=FOLIATE_LIMIT_S,
                         setup_s=told.get("load_ms", 0.0) / 1000.0, wall_s=wall, length=told.get("path_length"),
                         reason=str(told.get("reason") or ""))

    def _row(self, solve: Solve, told: dict, version: str, answer: Path, **values) -> Row:
        solved = told["outcome"] == SOLVED
        return Row(
            scene=solve.scene, solver=solve.solver, seed=solve.seed, series=solve.series, outcome=told["outcome"],
            cpu_s=told["cpu_s"], nodes=told.get("nodes"), segments=told.get("segments") if solved else None,
            version=version, machine=machine(), date=datetime.datetime.now().isoformat(timespec="seconds"),
            answer=str(answer) if solved else "", **values,
        )

    @staticmethod
    def _answer(solve: Solve, suffix: str, version: str = "") -> Path:
        return Path(solve.scene) / f"{solve.solver}-{solve.seed}-{solve.series}{version}.{suffix}"

    def _leave(self) -> None:
        if self.server is not None:
            self.server.close()
        self.server, self.served = None, ""


def machine() -> str:
    """Processor and kernel, without the host's name."""
    names = [line.partition(":")[2].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
             if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()}, {len(names)} logical cores"


def _arguments(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("command", choices=("run", "check", "table"))
    parser.add_argument("--foliate", type=Path, default=Path("foliate"), metavar="PROGRAM", help="the program to time")
    parser.add_argument("--commit", default="", metavar="ID", help="what the program was built from")
    parser.add_argument("--scenes", nargs="+", default=list(SCENES), choices=list(SCENES), metavar="NAME")
    parser.add_argument("--seeds", type=int, default=10, help="seeds 1 to this (default 10)")
    parser.add_argument("--only", choices=(FOLIATE, "hpp"), help="rows of one planner")
    parser.add_argument("--again", action="store_true", help="also what has a row of the same version; the last row counts")
    parser.add_argument("--control", type=int, default=0, metavar="N",
                        help="with --only foliate: repeat so many HPP solves per scene, to compare the machine's speed")
    parser.add_argument("--results", type=Path, default=RESULTS, metavar="DIR")
    parser.add_argument("--work", type=Path, default=WORK, metavar="DIR", help="where paths are kept")
    return parser.parse_args(arguments)


def main(arguments: list[str] | None = None) -> int:
    options = _arguments(arguments)
    try:
        if options.command == "run":
            runner = Runner(options)
            known = runner.results.rows
            controls = schedule.controls(options.scenes, options.control, options.commit, known)
            runner.run(controls + schedule.solves(options.scenes, options.seeds, options.only))
        elif options.command == "check":
            import check

            check.check_all(options.results, options.work, options.scenes, options.only)
        else:
            import table

            print(table.markdown(options.results))
    except (ResultsError, SolverError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
