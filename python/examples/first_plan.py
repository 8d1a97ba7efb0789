"""A first plan: a scene in, a certified path out, its numbers as arrays.

Run with ``python examples/first_plan.py``; checked by ``mypy --strict``.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt

import foliate


def speeds(path: foliate.Path, rate: float) -> npt.NDArray[np.float64]:
    """The largest speed of each joint of the first robot, rad/s or m/s."""
    _, velocities, _ = path.joints(path.robots[0], path.times(rate))
    largest: npt.NDArray[np.float64] = np.abs(velocities).max(axis=0)
    return largest


def main(out: Path) -> None:
    scene = foliate.Scene("demo")
    try:
        solution = foliate.solve(scene, seed=1)
    except foliate.NoSolution as none:
        sys.exit(f"no path: {none} ({none.report.steps} steps)")
    path = solution.path
    print(solution)
    for event in path.events:
        print(f"{event.time:6.2f} s  {event.kind} {event.object} by {event.gripper}")
    for name, speed in zip(path.joint_names(path.robots[0]), speeds(path, 100.0), strict=True):
        print(f"{name}: at most {speed:.2f}")
    path.save(out)
    report = foliate.check(out)
    print(report)
    if not report.proved:
        sys.exit("\n".join(report.violations))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "first_plan.json"))
