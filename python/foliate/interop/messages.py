"""Trajectories as dictionaries with the fields of ROS messages; they need no ROS."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from foliate._foliate import Path

__all__ = ["gripper_commands", "joint_trajectory"]


def joint_trajectory(path: Path, robot: str, *, rate: float = 50.0, joints: list[str] | None = None) -> dict[str, Any]:
    """A robot's motion with the fields of ``trajectory_msgs/JointTrajectory``; rad, rad/s, rad/s² (or metres), ``rate`` points a second.

    Names are those of the URDF. ``joints`` picks some, in this order. The motion stands still where hands close and open, see ``gripper_commands``.
    """
    names = joints if joints is not None else [name.partition("/")[2] for name in path.joint_names(robot)]
    times = path.times(rate)
    rows = path.joints([f"{robot}/{name}" for name in names], times)
    points = [
        {
            "positions": position.tolist(),
            "velocities": velocity.tolist(),
            "accelerations": acceleration.tolist(),
            "effort": [],
            "time_from_start": _duration(float(time)),
        }
        for time, position, velocity, acceleration in zip(times, *rows, strict=True)
    ]
    return {"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}, "joint_names": names, "points": points}


def gripper_commands(path: Path) -> list[dict[str, Any]]:
    """When hands close and open, in the order of time: ``time_from_start``, ``dwell`` (how long the robot stands still then), ``gripper``, ``object``, ``command``
    (``"grasp"`` or ``"release"``), and ``position`` (joints of the gripper and where they are afterwards, rad or m)."""
    return [
        {
            "time_from_start": _duration(event.time),
            "dwell": event.dwell,
            "gripper": event.gripper,
            "object": event.object,
            "command": event.kind,
            "position": dict(event.fingers),
        }
        for event in path.events
    ]


def _duration(seconds: float) -> dict[str, int]:
    nanoseconds = round(seconds * 1e9)
    return {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}
