#!/usr/bin/env python3
"""Judges the answers of a results folder by the package's own checks.

    python judge.py RESULTS [--delta 0.002] [--only TEXT] [--seed N]

`RESULTS/verdicts.csv` gets one line per answer. An answer that has one is not judged again.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import sys
from pathlib import Path

import numpy as np
import pinocchio as pin
from guided_tamp_benchmark.tasks import BaseTask
from guided_tamp_benchmark.tasks.collisions import check_if_identity

from checks import VALID, Sample, verdict
from instance_name import InstanceName
from overhang import counter_clockwise, overhang
from package import load, object_surfaces, supports
from package_path import FoliatePath
from path_knots import KnotPath, read_path
from resting import outward
from rows import SOLVED, Row, Verdict, append, read

DOWN = 0.99
"""A surface is underneath if its normal points down at least this much."""


def judge(task: BaseTask, path: KnotPath, delta: float) -> tuple[str, str]:
    """What the package says, and what its checks say without the faults of its loop (`checks.py`)."""
    way = FoliatePath(task, path)
    with contextlib.redirect_stdout(io.StringIO()):
        good, message = task.path_is_successful(way, delta)
        samples = [_sample(task, way.interpolate(t), t) for t in np.arange(0.0, 1.0 + delta, delta)]
    found = verdict(samples, way.names, lambda one, other: check_if_identity(one, other, error=0.001))
    if found == VALID and ("pose of object" in message or "configuration of robot" in message):
        found = message
    return VALID if good else message, found


def _sample(task: BaseTask, configuration, t: float) -> Sample:
    contacts = task._check_place_constraint(configuration)[1]
    grasps = task._check_grasp_constraint(configuration)[1]
    names = [object.name for object in task.objects]
    return Sample(
        t=float(t), collides=task._check_config_for_collision(configuration),
        on_furniture=frozenset(one for piece, one in _of(contacts) if not piece.startswith(f"{task.robot.name}/")),
        on_robot=frozenset(one for piece, one in _of(contacts) if piece.startswith(f"{task.robot.name}/")),
        grasped=frozenset(held.split("/")[0].rsplit("_", 1)[0] for _, held in grasps),
        poses=dict(zip(names, (pin.SE3ToXYZQUAT(pin.SE3(pose)) for pose in configuration.poses))),
    )


def _of(contacts: list[tuple[str, str]]) -> list[tuple[str, str]]:
    """The support with its part, and the object alone, of each contact."""
    return [(support, touching.split("/")[0]) for support, touching in contacts]


def worst_overhang(task: BaseTask, path: KnotPath) -> float:
    """Of all that the path puts onto furniture (metres)."""
    level = {}
    for name, polygon in supports(task):
        level.setdefault(name, []).append(counter_clockwise(polygon[:, :2]))
    surfaces = {object.name: object_surfaces(object) for object in task.objects}
    worst = 0.0
    for name, support, pose in path.rests:
        if support not in level:
            continue
        placed = pin.XYZQUATToSE3(pose)
        for polygon in surfaces[name]:
            if (placed.rotation @ outward(polygon))[2] < -DOWN:
                corners = (polygon @ placed.rotation.T + placed.translation)[:, :2]
                worst = max(worst, min(overhang(corners, one) for one in level[support]))
    return worst


def _remember(task: BaseTask) -> None:
    """The package reads SRDF files anew for every configuration; their content is kept instead. So is what it says of the
    configurations of one path, which both verdicts ask for."""
    for thing in [*task.objects, *task.furniture, task.robot]:
        for name in ("get_contacts_info", "get_handles_info", "get_grippers_info"):
            if hasattr(thing, name):
                setattr(thing, name, lambda known=getattr(thing, name)(): known)
    for name in ("is_config_valid", "is_config_grasp", "is_config_placement"):
        setattr(task.collision, name, _once(getattr(task.collision, name)))


def _once(check):
    """`check` of a configuration, asked once for each with the same further arguments."""
    known = {}

    def answer(configuration, *rest, **named):
        key = (configuration.to_numpy().tobytes(), rest, tuple(sorted(named.items())))
        if key not in known:
            if len(known) > 20_000:
                known.clear()
            known[key] = check(configuration, *rest, **named)
        return known[key]

    return answer


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path)
    parser.add_argument("--delta", type=float, default=0.002, help="step of t in [0, 1]")
    parser.add_argument("--only", default="", help="instances whose name contains this")
    parser.add_argument("--seed", type=int, help="answers of this seed only")
    options = parser.parse_args()
    file = options.results / "verdicts.csv"
    known = {(one.instance, one.seed) for one in read(file, Verdict)}
    name, task = "", None
    for row in read(options.results / "rows.csv", Row):
        if row.outcome != SOLVED or options.only not in row.instance or (row.instance, row.seed) in known:
            continue
        if options.seed not in (None, row.seed):
            continue
        if row.instance != name:
            name, task = row.instance, load(InstanceName.of(row.instance))
            _remember(task)
        path = read_path(options.results / row.path)
        package, corrected = judge(task, path, options.delta)
        append(file, Verdict(row.instance, row.seed, package, corrected, round(worst_overhang(task, path), 6), path.grasps))
        print(row.instance, row.seed, package, "|", corrected, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
