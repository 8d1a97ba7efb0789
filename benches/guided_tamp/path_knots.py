"""A Foliate path file as pieces of motion between two knots. Knows nothing of the package.

Only paths without times are read: `foliate bench` and `foliate solve --first` write them.
"""

from __future__ import annotations

import json
from bisect import bisect_right
from dataclasses import dataclass
from pathlib import Path

import numpy as np

WORLD = None
"""The carrier of what lies on furniture: it stays where it is."""


class PathError(Exception):
    """A file that is no path of this kind."""


@dataclass(frozen=True)
class Piece:
    """A motion on a straight line: the robot's coordinates at both ends (radians, metres), the objects' poses
    (`[x, y, z, qx, qy, qz, qw]`) at its beginning, and the link that carries each object, local name or `WORLD`."""

    before: np.ndarray
    after: np.ndarray
    poses: dict[str, np.ndarray]
    carriers: dict[str, str | None]

    @property
    def length(self) -> float:
        return float(np.linalg.norm(self.after - self.before))


@dataclass(frozen=True)
class KnotPath:
    """Pieces in the direction of travel; `joints` names the robot's coordinates, `grasps` counts what hands take."""

    joints: list[str]
    pieces: list[Piece]
    last_poses: dict[str, np.ndarray]
    grasps: int
    rests: list[tuple[str, str, np.ndarray]]
    """What rested on what: object, support, and the object's pose at the first knot of the segment."""

    def at(self, t: float) -> tuple[Piece, float]:
        """The piece at `t` in [0, 1] and how far along it: equal steps of `t` are equal steps of the robot's joints."""
        ends = np.cumsum([piece.length for piece in self.pieces])
        if ends[-1] == 0.0:
            return self.pieces[0], 0.0
        along = min(max(t, 0.0), 1.0) * ends[-1]
        number = min(bisect_right(ends, along), len(self.pieces) - 1)
        # The last piece may have no length.
        while self.pieces[number].length == 0.0:
            number -= 1
        piece = self.pieces[number]
        return piece, min(1.0, (along - (ends[number] - piece.length)) / piece.length)


def read_path(file: Path) -> KnotPath:
    return path_of(json.loads(file.read_text()))


def path_of(document: dict) -> KnotPath:
    """The pieces of a path file's content."""
    parts = {part["name"]: part["kind"] for part in document["parts"]}
    robots = [name for name, kind in parts.items() if kind == "robot"]
    if len(robots) != 1:
        raise PathError(f"{len(robots)} robots instead of one")
    columns = {name: column for column, name in enumerate(document["coordinates"])}
    joints = [name for name in columns if name.startswith(f"{robots[0]}/")]
    objects = [name for name, kind in parts.items() if kind == "object"]
    chosen = [columns[name] for name in joints]
    pieces, rests = [], []
    for segment in document["segments"]:
        if "times" in segment:
            raise PathError("the path has times; write it with --first, or with bench")
        carriers = _carriers(segment, robots[0], document["documents"])
        knots = np.array(segment["knots"], dtype=float)
        for attachment in segment["attachments"]:
            if attachment.get("support"):
                rests.append((attachment["object"], attachment["support"], _pose(knots[0], columns, attachment["object"])))
        for before, after in zip(knots[:-1], knots[1:]):
            poses = {name: _pose(before, columns, name) for name in objects}
            pieces.append(Piece(before[chosen], after[chosen], poses, {name: carriers.get(name) for name in objects}))
    if not pieces:
        raise PathError("no motion")
    last = np.array(document["segments"][-1]["knots"][-1], dtype=float)
    grasps = sum(event["kind"] == "grasp" for event in document.get("events", []))
    local = [name.split("/", 1)[1] for name in joints]
    return KnotPath(local, pieces, {name: _pose(last, columns, name) for name in objects}, grasps, rests)


def between(path: KnotPath, joint: str, value: float) -> KnotPath:
    """`path` with a motion before and after it in which only `joint` moves, from `value` and back to it.

    A path whose joint begins and ends there is returned as it is."""
    column = path.joints.index(joint)
    first, last = path.pieces[0], path.pieces[-1]
    pieces = list(path.pieces)
    if first.before[column] != value:
        start = first.before.copy()
        start[column] = value
        pieces.insert(0, Piece(start, first.before, first.poses, dict.fromkeys(first.poses, WORLD)))
    if last.after[column] != value:
        end = last.after.copy()
        end[column] = value
        pieces.append(Piece(last.after, end, path.last_poses, dict.fromkeys(path.last_poses, WORLD)))
    return KnotPath(path.joints, pieces, path.last_poses, path.grasps, path.rests)


def _carriers(segment: dict, robot: str, documents: dict) -> dict[str, str | None]:
    """Of each object the link of the robot that carries it; objects on furniture stay."""
    found = {}
    for attachment in segment["attachments"]:
        if not attachment.get("carrier"):
            continue
        if attachment.get("gripper"):
            link = documents["grippers"][attachment["gripper"]]["link"]
        else:
            link = documents["surfaces"][attachment["support"]]["link"]
        part, local = link.split("/", 1)
        found[attachment["object"]] = local if part == robot else WORLD
    return found


def _pose(knot: np.ndarray, columns: dict[str, int], object: str) -> np.ndarray:
    return np.array([knot[columns[f"{object}/{axis}"]] for axis in ("x", "y", "z", "qx", "qy", "qz", "qw")])
