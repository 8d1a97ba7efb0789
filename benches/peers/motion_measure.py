"""How long a motion is and how long it takes, in one measure for every planner.

A motion is samples of the robots' coordinates, cut into pieces. Its length is the sum of Euclidean distances from one sample
to the next (rad and m as they are; quaternions do not count). Its time, where the planner gives none, is the
shortest with rest at both ends of every piece under the scene's limits of velocity and acceleration: what a robot needs
that stops at corners.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

CORNER = 0.05
"""Motions that meet at a smaller angle (rad) are one piece,"""
STRAIGHT = 1e-4
"""and one that leaves its chord by less (rad or m) is a straight line."""
STILL = 1e-7
"""Shorter pieces (rad or m) take no time."""
GRID = 200
PER_INTERVAL = 8
QUATERNION = ("qx", "qy", "qz", "qw")


@dataclass(frozen=True)
class Limits:
    """Limits of the coordinates of a motion, in their order (rad/s, m/s, rad/s², m/s²); `counts` says which are part of its
    length."""

    velocity: np.ndarray
    acceleration: np.ndarray
    counts: np.ndarray


def limits_of(names: list[str], rates: dict) -> Limits:
    """`rates`: `rate_limits` of a path file."""
    return Limits(
        np.array([rates.get(name, {}).get("velocity", np.inf) for name in names]),
        np.array([rates.get(name, {}).get("acceleration", np.inf) for name in names]),
        np.array([name.rpartition("/")[2] not in QUATERNION for name in names]),
    )


def length(rows: np.ndarray, limits: Limits) -> float:
    return float(np.linalg.norm(np.diff(rows[:, limits.counts], axis=0), axis=1).sum())


def unwrapped(rows: np.ndarray, names: list[str], unbounded: set[str]) -> np.ndarray:
    """Angles without limits go on where they were told to jump by a turn."""
    rows = rows.copy()
    for column, name in enumerate(names):
        if name in unbounded:
            rows[:, column] = np.unwrap(rows[:, column])
    return rows


def corners(rows: np.ndarray) -> list[np.ndarray]:
    """A motion cut where its direction turns, without samples that repeat the one before."""
    moved = np.linalg.norm(np.diff(rows, axis=0), axis=1) > STILL
    rows = rows[np.concatenate([[True], moved])]
    if len(rows) < 2:
        return []
    ways = np.diff(rows, axis=0)
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    turns = np.linalg.norm(np.diff(ways, axis=0), axis=1) > CORNER
    cuts = [0, *(np.nonzero(turns)[0] + 1), len(rows) - 1]
    return [rows[first:last + 1] for first, last in zip(cuts[:-1], cuts[1:])]


def stopping_time(pieces: list[np.ndarray], limits: Limits) -> float:
    """Seconds of a motion that rests between its pieces; a piece is samples of a smooth curve."""
    return sum(_straight_time(piece, limits) if _is_straight(piece) else _curve_time(piece, limits) for piece in pieces)


def _is_straight(piece: np.ndarray) -> bool:
    way = piece[-1] - piece[0]
    size = np.linalg.norm(way)
    if size < STILL:
        return False
    off = piece - piece[0]
    return bool(np.linalg.norm(off - np.outer(off @ way / size**2, way), axis=1).max() < STRAIGHT)


def _straight_time(piece: np.ndarray, limits: Limits) -> float:
    """Trapezoid or triangle of the coordinate that needs longest, for the way as a whole."""
    way = np.abs(piece[-1] - piece[0])
    fast = np.min(np.divide(limits.velocity, way, where=way > 0.0, out=np.full_like(way, np.inf)))
    steep = np.min(np.divide(limits.acceleration, way, where=way > 0.0, out=np.full_like(way, np.inf)))
    if not np.isfinite(steep):
        return 0.0 if not np.isfinite(fast) else 1.0 / fast
    if fast * fast / steep >= 1.0:
        return 2.0 / np.sqrt(steep)
    return 1.0 / fast + fast / steep


def _curve_time(piece: np.ndarray, limits: Limits) -> float:
    """By toppra, on the cubic spline through the samples."""
    import toppra
    from toppra import algorithm, constraint

    toppra.setup_logging("ERROR")
    steps = np.linalg.norm(np.diff(piece, axis=0), axis=1)
    piece = piece[np.concatenate([[True], steps > STILL])]
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(piece, axis=0), axis=1))])
    if along[-1] < STILL or len(piece) < 3:
        return _straight_time(piece, limits)
    places = np.linspace(0.0, along[-1], min(len(piece), GRID // 4))
    moves = np.ptp(piece, axis=0) > 1e-9
    moves &= np.isfinite(limits.velocity) & np.isfinite(limits.acceleration)
    points = np.column_stack([np.interp(places, along, column) for column in piece[:, moves].T])
    velocity, acceleration = (np.column_stack([-row, row]) for row in (limits.velocity[moves], limits.acceleration[moves]))
    instance = algorithm.TOPPRA(
        [constraint.JointVelocityConstraint(velocity), constraint.JointAccelerationConstraint(acceleration)],
        toppra.SplineInterpolator(places, points), gridpoints=np.linspace(0.0, along[-1], GRID),
        solver_wrapper="seidel",
    )
    timed = instance.compute_trajectory(0.0, 0.0)
    return float("nan") if timed is None else float(timed.duration)


@dataclass(frozen=True)
class FoliateMotion:
    """A path file's motion of the robots: `rows`, samples of the coordinates `names`; `pieces` between its stops or, without
    times, between its corners. `moving_s` is its time without the dwells, None without times."""

    names: list[str]
    rows: np.ndarray
    pieces: list[np.ndarray]
    moving_s: float | None
    grasp_changes: int


def read_motion(file: Path, robots: set[str] | None = None) -> FoliateMotion:
    """`robots`: the parts that count; those of kind `robot` without it."""
    path = json.loads(file.read_text(encoding="utf-8"))
    if robots is None:
        robots = {part["name"] for part in path["parts"] if part["kind"] == "robot"}
    columns = [number for number, name in enumerate(path["coordinates"]) if name.partition("/")[0] in robots]
    names = [path["coordinates"][column] for column in columns]
    parts = [_segment(segment, columns) for segment in path["segments"]]
    rows = np.concatenate(parts)
    timed = "times" in path["segments"][0]
    events = path.get("events", [])
    moving = None
    if timed:
        dwells = {event["time"]: event["dwell"] for event in events}
        moving = path["segments"][-1]["times"][-1] - sum(dwells.values())
    pieces = [piece for part in parts for piece in corners(part)]
    return FoliateMotion(names, rows, pieces, moving, len(events))


def _segment(segment: dict, columns: list[int]) -> np.ndarray:
    knots = np.array(segment["knots"])[:, columns]
    if "velocities" not in segment:
        return knots
    return hermite(np.array(segment["times"]), knots, np.array(segment["velocities"])[:, columns])


def hermite(times: np.ndarray, knots: np.ndarray, velocities: np.ndarray) -> np.ndarray:
    """Samples of the cubics between knots, `PER_INTERVAL` an interval."""
    rows = [knots[:1]]
    s = (np.arange(1, PER_INTERVAL + 1) / PER_INTERVAL)[:, None]
    for k in range(len(knots) - 1):
        h = times[k + 1] - times[k]
        d, a, b = knots[k + 1] - knots[k], h * velocities[k], h * velocities[k + 1]
        rows.append(knots[k] + a * s + (3 * d - 2 * a - b) * s**2 + (a + b - 2 * d) * s**3)
    return np.concatenate(rows)
