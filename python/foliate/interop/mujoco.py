"""Replays paths in MuJoCo with position control. The model is the user's own; its joints and actuators are found by their names."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from foliate._foliate import Path

__all__ = ["Replay", "controls", "replay"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Replay:
    """What a simulation did beside what was planned."""

    joints: list[str]
    """Names of the joints, those of the model."""
    times: Array
    """Seconds: shape (steps,)."""
    planned: Array
    """Positions that the path has, rad or m: shape (steps, joints)."""
    reached: Array
    """Positions that the simulation has: shape (steps, joints)."""

    @property
    def worst(self) -> Array:
        """By joint, the largest distance between the two, rad or m."""
        worst: Array = np.abs(self.reached - self.planned).max(axis=0)
        return worst


def controls(path: Path, robot: str, model: Any, times: ArrayLike) -> Array:
    """Targets of position actuators at times (seconds): an array of shape (times, ``model.nu``).

    An actuator is given the position of its joint. One whose joint the robot does not have keeps 0, and so does one that has no joint.

    Raises ``ValueError`` where no actuator has a joint of the robot.
    """
    array = np.atleast_1d(np.asarray(times, dtype=float))
    targets = np.zeros((array.size, model.nu))
    columns = _actuated(path, robot, model)
    if not columns:
        raise ValueError(f"no actuator of the model moves a joint of {robot!r}")
    names = [f"{robot}/{name}" for name in columns]
    targets[:, list(columns.values())] = path.joints(names, array)[0]
    return targets


def replay(path: Path, robot: str, model: Any, data: Any = None, *, settle: float = 0.5) -> Replay:
    """Simulates ``model`` (``mujoco.MjModel``) with its position actuators driven along the path, from the path's first configuration.

    ``data`` (``mujoco.MjData``) is changed; a new one is made where there is none. ``settle``: so many seconds the last target is held.
    """
    import mujoco

    data = data if data is not None else mujoco.MjData(model)
    columns = _actuated(path, robot, model)
    names = list(columns)
    addresses = [int(model.joint(name).qposadr[0]) for name in names]
    duration = path.duration
    if duration is None:
        raise ValueError("the path has no times")
    start = float(path.times(1.0)[0])
    steps = int(np.ceil((duration + settle) / model.opt.timestep))
    times = start + model.opt.timestep * np.arange(steps + 1)
    targets = controls(path, robot, model, times)
    planned = path.joints([f"{robot}/{name}" for name in names], times)[0]
    known = set(path.joint_names(robot))
    for joint in range(model.njnt):
        full = f"{robot}/{model.joint(joint).name}"
        if full in known:
            data.qpos[model.joint(joint).qposadr[0]] = path.joints([full], [start])[0][0, 0]
    mujoco.mj_forward(model, data)
    reached = np.empty_like(planned)
    reached[0] = data.qpos[addresses]
    for step in range(1, steps + 1):
        data.ctrl[:] = targets[step]
        mujoco.mj_step(model, data)
        reached[step] = data.qpos[addresses]
    return Replay(names, times, planned, reached)


def _actuated(path: Path, robot: str, model: Any) -> dict[str, int]:
    """Joints of the robot that an actuator moves, and the actuator's number."""
    import mujoco

    known = set(path.joint_names(robot))
    found: dict[str, int] = {}
    for actuator in range(model.nu):
        if model.actuator_trntype[actuator] != mujoco.mjtTrn.mjTRN_JOINT:
            continue
        name = model.joint(int(model.actuator_trnid[actuator, 0])).name
        if f"{robot}/{name}" in known:
            found[name] = actuator
    return found
