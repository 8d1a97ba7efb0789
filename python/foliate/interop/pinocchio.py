"""Configurations in the order of a pinocchio model (``pinocchio.Model``), whatever its joints are."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from foliate._foliate import Path

__all__ = ["from_pinocchio", "to_pinocchio"]

Array = NDArray[np.float64]


def _joints(model: Any) -> Iterator[tuple[str, str, slice]]:
    """Name, type and columns of each joint of a model, without the universe and without joints that follow others."""
    for joint, name in zip(model.joints[1:], list(model.names)[1:], strict=True):
        if joint.nq:
            yield str(name), joint.shortname(), slice(joint.idx_q, joint.idx_q + joint.nq)


def to_pinocchio(path: Path, robot: str, model: Any, times: ArrayLike) -> Array:
    """What a robot does at times (seconds): an array of shape (times, ``model.nq``).

    ``model`` is of the same URDF: joints are found by their names. A root of the model that floats or is planar is the robot's root, if that moves in the scene.
    Where the model has a joint that the scene fixes, it is what the path has there.

    Raises ``ValueError`` for a joint that the robot does not have, or that has another type there.
    """
    array = np.atleast_1d(np.asarray(times, dtype=float))
    known = set(path.joint_names(robot))
    configurations = np.zeros((array.size, model.nq))
    for name, kind, columns in _joints(model):
        full = f"{robot}/{name}"
        width = columns.stop - columns.start
        if full in known:
            values = path.joints([full], array)[0]
            if width == 1:
                configurations[:, columns] = values
            elif width == 2:  # Without bounds: cosine and sine.
                configurations[:, columns] = np.hstack([np.cos(values), np.sin(values)])
            else:
                raise ValueError(f"{name!r} has {width} numbers in the model ({kind}), and one in the path")
        elif width in (4, 7):
            pose = path.poses([robot], array)[:, 0, :]
            configurations[:, columns] = pose if width == 7 else _planar(pose)
        else:
            raise ValueError(f"the robot {robot!r} has no joint {name!r}; it has {', '.join(sorted(known))}")
    return configurations


def from_pinocchio(model: Any, configuration: ArrayLike, robot: str) -> dict[str, float | list[float]]:
    """A configuration of a model (shape (``model.nq``,)) as values that ``Scene.with_start`` and ``Scene.with_goal`` take.

    A joint that floats or is planar is the robot's root.
    """
    array = np.asarray(configuration, dtype=float)
    if array.shape != (model.nq,):
        raise ValueError(f"a configuration of this model has the shape ({model.nq},), not {array.shape}")
    values: dict[str, float | list[float]] = {}
    read: dict[int, Callable[[Array], float | list[float]]] = {
        1: lambda q: float(q[0]),
        2: lambda q: float(np.arctan2(q[1], q[0])),
        4: lambda q: [float(q[0]), float(q[1]), float(np.arctan2(q[3], q[2]))],
        7: lambda q: [float(x) for x in q],
    }
    for name, kind, columns in _joints(model):
        width = columns.stop - columns.start
        if width not in read:
            raise ValueError(f"{name!r} ({kind}) has {width} numbers; a joint of a scene has one, or is a root")
        values[robot if width in (4, 7) else f"{robot}/{name}"] = read[width](array[columns])
    return values


def _planar(poses: Array) -> Array:
    """x, y, cosine and sine of the angle about z, of poses of shape (times, 7)."""
    z, w = poses[:, 5], poses[:, 6]
    return np.stack([poses[:, 0], poses[:, 1], w * w - z * z, 2 * w * z], axis=1)
