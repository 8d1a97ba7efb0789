"""The loop of `path_is_successful` without its faults. It calls the package's tests of single configurations.

What is wrong in the package's loop:

* `is_placed` lists the objects that a contact is *not* of: what is carried counts as placed while anything else rests.
* `separate_configs` gives the objects' poses the names of the reversed list, so that with two or three objects the pose
  that is compared is another object's. With one object no name is ever listed, with two both faults cancel out, with
  three an object that is carried is found to have "moved".
* What rests on a mobile robot moves with it. That is no fault of a path.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

VALID = "valid"


@dataclass(frozen=True)
class Sample:
    """What the package's tests say of one configuration: of which objects there is a contact with furniture, a contact
    with the robot, and a grasp; and the pose of each object as it is compared."""

    t: float
    collides: bool
    on_furniture: frozenset[str]
    on_robot: frozenset[str]
    grasped: frozenset[str]
    poses: dict[str, object]


class Same(Protocol):
    """Whether two poses are the same within the package's tolerance."""

    def __call__(self, one: object, other: object) -> bool: ...


def verdict(samples: list[Sample], objects: list[str], same: Same) -> str:
    """`VALID`, or the first thing that is wrong."""
    for before, now in zip([None, *samples[:-1]], samples):
        if now.collides:
            return f"collision at {now.t:.4f}"
        for name in objects:
            if name not in now.on_furniture | now.on_robot | now.grasped:
                return f"unconstrained object {name} at {now.t:.4f}"
            rests = before is not None and name in before.on_furniture & now.on_furniture
            if rests and name not in before.grasped | now.grasped and not same(before.poses[name], now.poses[name]):
                return f"object {name} moved while it rests at {now.t:.4f}"
    return VALID
