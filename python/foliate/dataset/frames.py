"""The frames of one path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from foliate._foliate import Path

__all__ = ["Frames", "Layout", "frames"]


@dataclass(frozen=True)
class Layout:
    """What the columns of frames mean. All paths of a dataset have the same."""

    robot: tuple[str, ...]
    """Coordinates of the robots: ``part/joint`` (rad or m), ``part/x``, ``part/y``, ``part/theta`` of a planar base."""
    objects: tuple[str, ...]
    """Coordinates of the objects: ``part/x``, ``part/y``, ``part/z`` (m, in the world) and the quaternion ``part/qx`` to ``part/qw``; joints of furniture."""
    grippers: tuple[str, ...]
    """Grippers that may hold something, ``part/gripper``."""
    coordinates: tuple[str, ...]
    """All coordinates, in the order of a configuration."""

    @classmethod
    def of(cls, path: Path) -> Layout:
        """The layout of a path's frames."""
        names, robots = tuple(path.coordinates), set(path.robots)
        of_robots = tuple(name for name in names if name.partition("/")[0] in robots)
        others = tuple(name for name in names if name.partition("/")[0] not in robots)
        return cls(of_robots, others, tuple(path.grippers), names)


@dataclass(frozen=True)
class Frames:
    """Rows in the order of time."""

    times: NDArray[np.float64]
    """Seconds from the start of the path: shape (frames,). In a path without times the number of the frame divided by the rate."""
    state: NDArray[np.float64]
    """Coordinates of the robots: shape (frames, coordinates)."""
    action: NDArray[np.float64]
    """Where the robots are to be in the next frame; in the last frame where they are: shape (frames, coordinates)."""
    objects: NDArray[np.float64]
    """Coordinates of the objects: shape (frames, coordinates)."""
    closed: NDArray[np.bool_]
    """Whether each gripper holds something: shape (frames, grippers)."""
    segment: NDArray[np.int64]
    """Number of the segment: shape (frames,)."""
    states: list[str]
    """By segment, the name of its state."""
    transitions: list[str]
    """By segment, the name of its transition."""
    contacts: list[str]
    """By segment, who holds what: ``robot/left_hand box1/top``, several with ``; `` between."""
    clearance: NDArray[np.float64] | None = None
    """How close any two shapes that move against each other are, m, 0 where they meet: shape (frames,). ``None`` where it is not measured."""

    def __len__(self) -> int:
        return int(self.times.size)


def frames(path: Path, rate: float, layout: Layout | None = None, *, clearance: bool = False) -> Frames:
    """The frames of a path, ``rate`` a second; the last one is at its end or less than a step after it. Of a path without times they are its knots. ``clearance`` measures how close
    things come.

    Raises ``ValueError`` where the path has other coordinates or grippers than ``layout``.
    """
    if layout is None:
        layout = Layout.of(path)
    elif tuple(path.coordinates) != layout.coordinates or tuple(path.grippers) != layout.grippers:
        raise ValueError("the path is of another robot or of other objects than the dataset")
    segments = path.segments
    if path.duration is None:
        rows = path.knots
        owner = np.repeat(np.arange(len(segments)), [len(segment.knots) - 1 for segment in segments])
        owner = np.append(owner, len(segments) - 1)
        times = np.arange(len(rows)) / rate
        near = path.clearances() if clearance else None
    else:
        start = float(path.times(1.0)[0])
        times = start + np.arange(int(np.ceil(path.duration * rate - 1e-9)) + 1) / rate
        rows = path.configurations(times)
        near = path.clearances(times) if clearance else None
        ends = [segment.times[-1] for segment in segments if segment.times is not None]
        owner = np.minimum(np.searchsorted(ends, times, side="right"), len(segments) - 1)
        times = times - times[0]
    columns = {name: number for number, name in enumerate(layout.coordinates)}
    state = rows[:, [columns[name] for name in layout.robot]]
    holding = [dict(segment.holding) for segment in segments]
    closed = np.array([[gripper in held for gripper in layout.grippers] for held in holding], dtype=bool)
    return Frames(
        times=times,
        state=state,
        action=np.concatenate([state[1:], state[-1:]]),
        objects=rows[:, [columns[name] for name in layout.objects]],
        closed=closed.reshape(len(segments), len(layout.grippers))[owner],
        segment=owner,
        states=[segment.state for segment in segments],
        transitions=[segment.transition for segment in segments],
        contacts=["; ".join(f"{gripper} {handle}" for gripper, handle in sorted(held.items())) for held in holding],
        clearance=near,
    )
