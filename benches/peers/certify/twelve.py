#!/usr/bin/env python3
"""Measure what certifying a plan of twelve joints takes: both arms of Baxter without their last wrist joints.

    twelve.py --foliate PROGRAM --out DIR [--plans N] [--waypoints N] [--runs N] [--repeat N] [--seed S]

Each plan is a polyline from the start of `baxter-case3`: from a waypoint straight to a random one (every joint up to 0.5 rad
away), where `foliate certify` says that the way is free; the last way of every second plan is the first one found that is
not. Plans go to DIR/NUMBER.csv. A run certifies one plan so many times more than once in one process, and the processor time (user and
system) of a process that does it once is taken off: loading the scene drops out, reading the plan and printing the answer do not.
"""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import subprocess
from pathlib import Path

import numpy as np

SCENE = "baxter-case3"
JOINTS = [f"baxter/{arm}_{joint}" for arm in ("left", "right") for joint in ("s0", "s1", "e0", "e1", "w0", "w1")]
REACH = 0.5
TRIES = 24


def certify(program: Path, files: list[Path], *more: str) -> list[dict]:
    command = [str(program), "certify", *map(str, files), "--scene", SCENE, "--time-limit", "600", "--json", *more]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    answers = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    if len(answers) != len(files) or any(answer["error"] for answer in answers):
        raise SystemExit(f"{len(files)} files, {len(answers)} answers: {done.stderr[-2000:]}")
    return answers


def write(file: Path, states) -> Path:
    rows = [",".join(f"{value:.17g}" for value in state) for state in states]
    file.write_text("\n".join([",".join(JOINTS), *rows]) + "\n")
    return file


def plan(arguments, random: np.random.Generator, number: int) -> Path:
    states = [np.zeros(len(JOINTS))]
    ways = [arguments.out / f"way-{index}.csv" for index in range(TRIES)]
    while len(states) < arguments.waypoints:
        tries = [states[-1] + random.uniform(-REACH, REACH, len(JOINTS)) for _ in ways]
        answers = certify(arguments.foliate, [write(way, [states[-1], new]) for way, new in zip(ways, tries)])
        last = number % 2 == 1 and len(states) == arguments.waypoints - 1
        wanted = "contact" if last else "free"
        fits = [new for new, answer in zip(tries, answers)
                if answer["report"]["verdict"] == wanted and not answer["report"]["limits"]["violations"]]
        states.extend(fits[:1])
    for way in ways:
        way.unlink()
    return write(arguments.out / f"{number:02}.csv", states)


def spent(program: Path, files: list[Path], *more: str) -> float:
    """Processor time of a process that certifies, ms."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    certify(program, files, *more)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return 1e3 * (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--foliate", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--plans", type=int, default=4)
    parser.add_argument("--waypoints", type=int, default=25)
    parser.add_argument("--runs", type=int, default=9)
    parser.add_argument("--repeat", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(arguments.seed)
    print("| plan | verdict | pairs | processor time of a certification, median of the runs (ms) | least to most |")
    for number in range(arguments.plans):
        known = arguments.out / f"{number:02}.csv"
        file = known if known.exists() else plan(arguments, random, number)
        report = certify(arguments.foliate, [file])[0]["report"]
        once = min(spent(arguments.foliate, [file]) for _ in range(3))
        more = [file] * (arguments.repeat + 1)
        each = sorted((spent(arguments.foliate, more) - once) / arguments.repeat for _ in range(arguments.runs))
        print(f"| {number} | {report['verdict']} | {report['pairs']['tested']} | {statistics.median(each):.2f} "
              f"| {each[0]:.2f} to {each[-1]:.2f} |", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
