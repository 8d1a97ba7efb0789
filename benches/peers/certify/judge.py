#!/usr/bin/env python3
"""Certify a peer's answers, and confirm every verdict with pinocchio and coal.

    judge.py DIR --foliate PROGRAM [--step MM] [--results FILE.csv] [--scenes NAME ...]

DIR is what `plan.py` wrote for one peer. Every answer is sampled so that no point of any body moves farther than the step
(default 0.5 mm) from one sample to the next, and coal is asked at each. A verdict "free" is confirmed where no sample collides;
a verdict "contact" where no sample collides before the proved prefix ends and coal finds the pair that is named overlapping
while it is said to be in contact. To coal meshes are hollow: a shape that lies all inside of a closed mesh is confirmed by the
mesh's winding number around it ("enclosed"). Exit code 1: a verdict is not confirmed. A call that was interrupted
goes on where it was. Times are processor time of one certification, reading and loading aside (wall time where the system does not
tell).
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import statistics
import subprocess
from pathlib import Path

import numpy as np

from world import ROBOT, SCENE_NAMES, World

COLUMNS = ("scene", "file", "verdict", "free_until", "at", "depth_mm", "pair", "ms", "points", "samples",
           "colliding_samples", "first_colliding", "confirmed_by")

PLACES = 33
"""Places of a contact at which its pair is tested."""


def certify(program: Path, world: World, files: list[Path]) -> dict[str, dict]:
    """The program's answers by file, all from one process, so that the scene is loaded once."""
    joints = ",".join(f"{ROBOT}/{joint}" for joint in world.joints)
    command = [str(program), "certify", *map(str, files), "--scene", world.name, "--joints", joints, "--format", "ompl",
               "--time-limit", "3600", "--json"]
    # The peers' libraries are not the program's.
    environment = {name: value for name, value in os.environ.items() if name != "LD_LIBRARY_PATH"}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if len(lines) != len(files):
        raise SystemExit(f"{len(files)} files, {len(lines)} answers: {done.stderr[-2000:]}")
    return {answer["file"]: answer for answer in map(json.loads, lines)}


def judge(world: World, file: Path, answer: dict, step: float) -> dict:
    report = answer["report"]
    states = np.atleast_2d(np.loadtxt(file))
    samples = colliding = 0
    first = None
    for place, state in world.samples(states, step):
        samples += 1
        if world.collides(state):
            colliding += 1
            first = place if first is None else first
    contact = report["contact"]
    confirmed = ""
    if report["verdict"] == "free":
        confirmed = "" if colliding else "samples"
    elif report["verdict"] == "contact" and (first is None or first >= report["free_until"] - 1e-9):
        places = [contact["deepest_at"], *np.linspace(contact["at"], contact["until"], PLACES)]
        pair = contact["pair"]["shapes"]
        if any(world.overlaps(pair, _state(states, place)) for place in places):
            confirmed = "coal"
        elif any(world.encloses(pair, _state(states, place)) for place in places):
            confirmed = "enclosed"
    return {
        "scene": world.name,
        "file": file.name,
        "verdict": report["verdict"],
        "free_until": report["free_until"],
        "at": contact["at"] if contact else "",
        "depth_mm": 1e3 * (contact["depth"] or 0.0) if contact else "",
        "pair": " ".join(contact["pair"]["shapes"]) if contact else "",
        "ms": answer.get("certify_processor_ms") or answer["certify_ms"],
        "points": len(states),
        "samples": samples,
        "colliding_samples": colliding,
        "first_colliding": "" if first is None else first,
        "confirmed_by": confirmed,
    }


def _state(states: np.ndarray, place: float) -> np.ndarray:
    index = min(int(place), max(len(states) - 2, 0))
    return states[index] + (place - index) * (states[min(index + 1, len(states) - 1)] - states[index])


def summary(rows: list[dict]) -> str:
    lines = ["| scene | answers | in contact | of these enclosed | seen by no sample | not confirmed | deepest (mm) "
             "| median / p95 / max (ms) |", "|---|---|---|---|---|---|---|---|"]
    for name in [*dict.fromkeys(row["scene"] for row in rows), "all"]:
        of = [row for row in rows if name in (row["scene"], "all")]
        contacts = [row for row in of if row["verdict"] == "contact"]
        times = sorted(float(row["ms"]) for row in of)
        deepest = max((float(row["depth_mm"] or 0.0) for row in contacts), default=0.0)
        lines.append(
            f"| {name} | {len(of)} | {len(contacts)} | {sum(row['confirmed_by'] == 'enclosed' for row in of)} "
            f"| {sum(int(row['colliding_samples']) == 0 for row in contacts)} "
            f"| {sum(not row['confirmed_by'] for row in of)} | {deepest:.2f} "
            f"| {statistics.median(times):.2f} / {times[int(0.95 * (len(times) - 1))]:.2f} / {times[-1]:.2f} |")
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--foliate", type=Path, required=True)
    parser.add_argument("--step", type=float, default=0.5, help="millimetres")
    parser.add_argument("--results", type=Path)
    parser.add_argument("--scenes", nargs="+", default=list(SCENE_NAMES))
    arguments = parser.parse_args()
    results = arguments.results or arguments.folder / "results.csv"
    rows: list[dict] = []
    if results.exists():
        with results.open() as known:
            rows = list(csv.DictReader(known))
    done = {(row["scene"], row["file"]) for row in rows}
    with results.open("a", newline="") as out:
        writer = csv.DictWriter(out, COLUMNS)
        if not rows:
            writer.writeheader()
        for name in arguments.scenes:
            files = sorted(f for f in (arguments.folder / name).glob("*.txt") if (name, f.name) not in done)
            if not files:
                continue
            world = World(name)
            answers = certify(arguments.foliate, world, files)
            for file in files:
                row = judge(world, file, answers[str(file)], arguments.step / 1000.0)
                rows.append(row)
                writer.writerow(row)
                out.flush()
    print(summary(rows))
    wrong = [row for row in rows if not row["confirmed_by"]]
    for row in wrong:
        print("NOT CONFIRMED", json.dumps(row))
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
