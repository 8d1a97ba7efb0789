"""A scene file's text from what an instance holds. Knows nothing of the package."""

from __future__ import annotations

import json
from dataclasses import dataclass, field

FREE, OPEN = "free", "open"
"""Fingers that move between their limits as the URDF has them, or that stay wide open."""


@dataclass(frozen=True)
class Part:
    """A model: `kind` as in scene files; `pose` (`[x, y, z, qx, qy, qz, qw]`) of a fixed root, None for the identity."""

    name: str
    kind: str
    urdf: str
    srdf: str | None
    pose: list[float] | None = None


@dataclass(frozen=True)
class Instance:
    """What one scene says: lengths in metres, angles in radians, poses `[x, y, z, qx, qy, qz, qw]` in the world.

    `joints`: the robot's coordinates at the start and at the goal. `start`, `goal`: poses of the objects.
    `handles`: of each object, local names. `bounds`: of the objects' roots, three pairs. `finger`: the joint that
    opens the hand, and its value when open. `untested`: pairs of links, or of a part and a link."""

    name: str
    description: str
    parts: list[Part]
    joints: dict[str, float]
    start: dict[str, list[float]]
    goal: dict[str, list[float]]
    gripper: str
    handles: dict[str, list[str]]
    supports: list[str]
    bounds: list[list[float]]
    finger: tuple[str, float]
    untested: list[tuple[str, str]] = field(default_factory=list)


def scene_text(instance: Instance, fingers: str) -> str:
    """The TOML of `instance`."""
    if fingers not in (FREE, OPEN):
        raise ValueError(f"fingers: {fingers!r} is neither {FREE!r} nor {OPEN!r}")
    joints = dict(instance.joints)
    lines = ['format = "foliate.scene/1"', f"name = {_text(instance.name)}", f"description = {_text(instance.description)}"]
    if instance.untested:
        pairs = ", ".join(f"[{_text(a)}, {_text(b)}]" for a, b in instance.untested)
        lines.append(f"ignore = [{pairs}]")
    for part in instance.parts:
        lines += ["", *_part(part, instance.bounds)]
    grasps = [f"{object}/{handle}" for object, handles in instance.handles.items() for handle in handles]
    lines += ["", "[graph]", 'rests = "whole-face"', f"grippers = [{_text(instance.gripper)}]", f"supports = {_texts(instance.supports)}",
              f"grasps = {{ {_text(instance.gripper)} = {_texts(grasps)} }}"]
    if fingers == OPEN:
        joint, value = instance.finger
        joints[joint] = value
        lines += ["", "[locked]", f"{_text(joint)} = {value!r}"]
    lines += ["", "[start]", *(f"{_text(name)} = {value!r}" for name, value in joints.items()),
              *(f"{_text(name)} = {_numbers(pose)}" for name, pose in instance.start.items())]
    lines += ["", "[[goal]]", "[goal.configuration]",
              *(f"{_text(name)} = {_numbers(pose)}" for name, pose in instance.goal.items())]
    return "\n".join(lines) + "\n"


def _part(part: Part, bounds: list[list[float]]) -> list[str]:
    lines = ["[[part]]", f"name = {_text(part.name)}", f"kind = {_text(part.kind)}", f"urdf = {_text(part.urdf)}"]
    if part.srdf is not None:
        lines.append(f"srdf = {_text(part.srdf)}")
    if part.pose is not None:
        lines.append(f"pose = {_numbers(part.pose)}")
    if part.kind == "object":
        lines.append(f"root_bounds = [{', '.join(_numbers(pair) for pair in bounds)}]")
    return lines


def _text(value: str) -> str:
    return json.dumps(value)


def _texts(values: list[str]) -> str:
    return f"[{', '.join(map(_text, values))}]"


def _numbers(values: list[float]) -> str:
    return f"[{', '.join(repr(float(value)) for value in values)}]"
