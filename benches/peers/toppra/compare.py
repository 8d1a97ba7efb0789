#!/usr/bin/env python3
"""Compare our time-optimal parameterisation with toppra's on random geometric paths.

    compare.py --foliate PROGRAM [--paths N] [--grid N] [--seed S] [--rows FILE]

PROGRAM is `trajectories` of the crate foliate_benches. The paths are natural cubic splines through 5 to 40 waypoints with 7 to 15
coordinates; both get the same piecewise cubic polynomial and the same limits. toppra (`pip install toppra scipy`) times each path three times:
on a dense grid, which says how short the duration may be, on as many grid points as ours has intervals, which says what a point
costs, and on the grid that it chooses itself, which is how it is called. The first two grids contain the waypoints. Limits are looked at 1000 times a second and at the knots.
"""

from __future__ import annotations

import argparse
import json
import logging
import subprocess
import time
from importlib import metadata
from pathlib import Path

import numpy as np
import toppra
from scipy.interpolate import CubicHermiteSpline, CubicSpline
from toppra import algorithm, constraint

RATE = 1000.0


def draw(random: np.random.Generator) -> dict:
    count, size = int(random.integers(5, 41)), int(random.integers(7, 16))
    kind = int(random.integers(2))
    steps = random.uniform(-1.0, 1.0, (count, size))
    points = np.cumsum(steps, axis=0) if kind else 2.0 * steps
    velocity = random.uniform(1.0, 3.0, size)
    acceleration = velocity / random.uniform(0.1, 0.5, size)
    if random.integers(2):
        parameters = np.arange(count, dtype=float)
    else:
        lengths = np.max(np.abs(np.diff(points, axis=0)) / velocity, axis=1)
        parameters = np.concatenate([[0.0], np.cumsum(lengths)])
    return {"parameters": parameters, "points": points, "velocity": velocity, "acceleration": acceleration}


def excess(path: dict, position, end: float) -> float:
    """By how much the velocity or acceleration exceeds its limit, relative; `position(t, order)`."""
    times = np.append(np.arange(0.0, end, 1.0 / RATE), end)
    shares = [np.abs(position(times, 1)) / path["velocity"], np.abs(position(times, 2)) / path["acceleration"]]
    return float(max(share.max() for share in shares) - 1.0)


def by_toppra(path: dict, grid: int | None, repeats: int):
    curve = toppra.SplineInterpolator(path["parameters"], path["points"], bc_type="natural")
    limits = [
        constraint.JointVelocityConstraint(np.stack([-path["velocity"], path["velocity"]], 1)),
        constraint.JointAccelerationConstraint(np.stack([-path["acceleration"], path["acceleration"]], 1)),
    ]
    points = None if grid is None else np.unique(np.concatenate([np.linspace(0.0, path["parameters"][-1], grid), path["parameters"]]))
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        solver = algorithm.TOPPRA(limits, curve, gridpoints=points, solver_wrapper="seidel",
                                  parametrizer="ParametrizeConstAccel")
        timed = solver.compute_trajectory(0.0, 0.0)
        seconds.append(time.perf_counter() - start)
    return timed, float(np.median(seconds)), len(solver.gridpoints)


def ours(program: Path, paths: list[dict]) -> list[dict]:
    lines = []
    for path in paths:
        curve = CubicSpline(path["parameters"], path["points"], bc_type="natural")
        lines.append(json.dumps({
            "parameters": path["parameters"].tolist(), "knots": path["points"].ravel().tolist(),
            "derivatives": curve(path["parameters"], 1).ravel().tolist(),
            "velocity": path["velocity"].tolist(), "acceleration": path["acceleration"].tolist(),
        }))
    done = subprocess.run([str(program)], input="\n".join(lines), capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--foliate", type=Path, required=True)
    parser.add_argument("--paths", type=int, default=200)
    parser.add_argument("--grid", type=int, default=2001)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rows", type=Path)
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    random = np.random.default_rng(arguments.seed)
    paths = [draw(random) for _ in range(arguments.paths)]
    rows = []
    for path, answer in zip(paths, ours(arguments.foliate, paths), strict=True):
        curve = CubicHermiteSpline(answer["times"], answer["knots"], answer["velocities"])
        duration = answer["times"][-1]
        # At a knot the polynomial behind it is looked at; the one before it just before the end of its piece.
        ends = np.array(answer["times"][1:]) * (1.0 - 1e-15)
        at_knots = float((np.abs(curve(ends, 2)) / path["acceleration"]).max() - 1.0)
        dense, seconds_dense, _ = by_toppra(path, arguments.grid, 1)
        equal, seconds, points = by_toppra(path, answer["intervals"] + 1, 3)
        own, seconds_own, own_points = by_toppra(path, None, 3)
        rows.append({
            "waypoints": len(path["points"]), "coordinates": len(path["velocity"]), "duration": duration,
            "ratio_dense": duration / dense.duration, "ratio_equal": duration / equal.duration,
            "excess": max(excess(path, lambda t, n: curve(t, n), duration), at_knots),
            "excess_dense": excess(path, lambda t, n: dense(t, n), dense.duration),
            "excess_equal": excess(path, lambda t, n: equal(t, n), equal.duration),
            "intervals": answer["intervals"], "knots": len(answer["times"]), "points": points,
            "seconds": answer["seconds"], "seconds_equal": seconds,
            "seconds_dense": seconds_dense, "speedup_dense": seconds_dense / answer["seconds"],
            "speedup_equal": seconds / answer["seconds"],
            "ratio_own": duration / own.duration, "excess_own": excess(path, lambda t, n: own(t, n), own.duration),
            "points_own": own_points, "seconds_own": seconds_own, "speedup_own": seconds_own / answer["seconds"],
            "speedup": (seconds / points) / (answer["seconds"] / (answer["intervals"] + 1)),
        })
    if arguments.rows:
        arguments.rows.write_text("\n".join(json.dumps(row) for row in rows) + "\n")
    print(f"toppra {metadata.version('toppra')}, {len(rows)} paths, seed {arguments.seed}")
    print("| what | least | median | 95 % | largest |\n|---|--:|--:|--:|--:|")
    names = {
        "ratio_dense": f"duration ÷ toppra's on {arguments.grid} points", "ratio_equal": "duration ÷ toppra's on as many points",
        "excess": "most that ours exceeds a limit, relative", "excess_dense": f"the same, toppra on {arguments.grid} points",
        "excess_equal": "the same, toppra on as many points", "intervals": "intervals of our grid",
        "seconds": "our time, s", "seconds_equal": "toppra's time on as many points, s",
        "seconds_dense": f"toppra's time on {arguments.grid} points, s",
        "speedup": "toppra's time a point ÷ ours", "speedup_dense": f"toppra's time on {arguments.grid} points ÷ ours",
        "speedup_equal": "toppra's time on as many points ÷ ours",
        "points_own": "points of toppra's own grid", "ratio_own": "duration ÷ toppra's on its own grid",
        "excess_own": "most that toppra exceeds a limit on its own grid", "seconds_own": "toppra's time on its own grid, s",
        "speedup_own": "toppra's time on its own grid ÷ ours",
    }
    for key, name in names.items():
        values = np.array([row[key] for row in rows])
        quantiles = [values.min(), np.median(values), np.quantile(values, 0.95), values.max()]
        print(f"| {name} | " + " | ".join(f"{value:.5g}" for value in quantiles) + " |")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
