"""A scene file (`foliate.scene/1`) as much as another planner must know of it.

This is the one place that reads `scene.toml`. Keys that no scene of the comparison uses are refused with a message, so
that no problem is silently stated differently for the other planner.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from pathlib import Path

IDENTITY = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
ROOT_COORDINATES = {
    "freeflyer": ("x", "y", "z", "qx", "qy", "qz", "qw"),
    "planar": ("x", "y", "theta"),
    "fixed": (),
}
PART_KEYS = {"name", "kind", "urdf", "srdf", "root", "pose", "mimic", "root_bounds", "joint_bounds", "masks"}
GRAPH_KEYS = {"grippers", "supports", "grasps", "rules", "everywhere", "objects", "placement_margin",
              "rests", "preplacement_distance"}
SCENE_KEYS = {"format", "name", "description", "coordinates", "part", "constraint", "locked", "graph", "start", "goal",
              "sha256", "default_margin", "margins"}


class SceneError(Exception):
    """A scene that this comparison cannot state to another planner; the message says which key."""


@dataclass(frozen=True)
class Part:
    """A robot, object or environment; `pose` is x y z qx qy qz qw (m), of the root link where it is fixed."""

    name: str
    kind: str
    root: str
    urdf: str
    srdf: str | None
    pose: list[float]
    root_bounds: list[list[float]]
    joint_bounds: dict[str, list[float]]
    masks: dict[str, list[bool]]


@dataclass(frozen=True)
class Manipulated:
    """What takes part of an object: handles and surfaces by full name, or the plane (x y z qx qy qz qw) it rests on."""

    handles: list[str]
    surfaces: list[str]
    plane: list[float] | None


@dataclass(frozen=True)
class Relation:
    """A constraint that holds everywhere; its value is the one of the start. `kind`: `pose` or `centre_of_mass`."""

    name: str
    kind: str
    frame: str
    to: str | None
    mask: list[bool]


@dataclass(frozen=True)
class Rule:
    """`when` maps grippers to handles (empty string: holds nothing); the first rule that applies to a state decides."""

    when: dict[str, str]
    allow: bool


@dataclass(frozen=True)
class Scene:
    file: Path
    name: str
    parts: list[Part]
    coordinates: list[str]
    start: list[float]
    goal: list[float]
    locked: dict[str, float | list[float]]
    grippers: list[str]
    supports: list[str]
    objects: dict[str, Manipulated]
    grasps: dict[str, list[str]]
    rules: list[Rule]
    everywhere: list[Relation]
    placement_margin: float
    preplacement_distance: float
    default_margin: float
    margins: list[dict] = field(default_factory=list)

    def part(self, name: str) -> Part:
        return next(part for part in self.parts if part.name == name)

    @property
    def manipulates(self) -> bool:
        """Whether anything can be held; without, the problem is one of motion planning alone."""
        return bool(self.grippers and self.objects)


def read_scene(file: Path) -> Scene:
    """The scene in `file`."""
    with file.open("rb") as text:
        tree = tomllib.load(text)
    _refuse_others(tree, SCENE_KEYS, "the scene")
    graph = tree.get("graph", {})
    _refuse_others(graph, GRAPH_KEYS, "graph")
    parts = [_part(entry) for entry in tree["part"]]
    if len(tree["goal"]) != 1 or set(tree["goal"][0]) != {"configuration"}:
        raise SceneError(f"{file}: not exactly one goal that is a whole configuration")
    goal = tree["goal"][0]["configuration"]
    if not isinstance(goal, list) or not isinstance(tree["start"], list):
        raise SceneError(f"{file}: start or goal is not a list of numbers")
    constraints = {entry["name"]: entry for entry in tree.get("constraint", [])}
    objects = {name: _manipulated(name, entry) for name, entry in graph.get("objects", {}).items()}
    if not objects and any(part.kind == "object" for part in parts):
        objects = {part.name: None for part in parts if part.kind == "object"}
    if graph.get("rests", "stable") != "centre" and any(entry and entry.surfaces for entry in objects.values()):
        raise SceneError(f"{file}: objects do not rest by their centres, the only rule of the other planner")
    return Scene(
        file=file,
        name=tree["name"],
        parts=parts,
        coordinates=tree["coordinates"],
        start=tree["start"],
        goal=goal,
        locked=tree.get("locked", {}),
        grippers=graph.get("grippers", []),
        supports=graph.get("supports", []),
        objects=_with_grasped_handles(objects, graph.get("grasps", {})),
        grasps=graph.get("grasps", {}),
        rules=[_rule(entry) for entry in graph.get("rules", [])],
        everywhere=[_relation(constraints[name]) for name in graph.get("everywhere", [])],
        placement_margin=graph.get("placement_margin", 0.001),
        preplacement_distance=graph.get("preplacement_distance", 0.05),
        default_margin=tree.get("default_margin", 0.0),
        margins=tree.get("margins", []),
    )


def _refuse_others(table: dict, known: set[str], where: str) -> None:
    if others := set(table) - known:
        raise SceneError(f"{where}: {', '.join(sorted(others))}: no counterpart is known for the other planner")


def _part(entry: dict) -> Part:
    _refuse_others(entry, PART_KEYS, f"part {entry['name']}")
    return Part(
        name=entry["name"],
        kind=entry["kind"],
        root=entry.get("root", "freeflyer" if entry["kind"] == "object" else "fixed"),
        urdf=entry["urdf"],
        srdf=entry.get("srdf"),
        pose=_pose(entry.get("pose", {})),
        root_bounds=entry.get("root_bounds", []),
        joint_bounds=entry.get("joint_bounds", {}),
        masks={handle: [bool(row) for row in mask] for handle, mask in entry.get("masks", {}).items()},
    )


def _pose(value) -> list[float]:
    if isinstance(value, list):
        return value
    _refuse_others(value, {"xyz", "quaternion"}, "pose")
    return [*value.get("xyz", IDENTITY[:3]), *value.get("quaternion", IDENTITY[3:])]


def _manipulated(name: str, entry: dict) -> Manipulated:
    _refuse_others(entry, {"handles", "surfaces", "plane"}, f"graph.objects.{name}")
    plane = entry.get("plane")
    if plane is not None:
        _refuse_others(plane, {"pose", "on"}, f"graph.objects.{name}.plane")
    return Manipulated(
        handles=[f"{name}/{handle}" for handle in entry["handles"]],
        surfaces=[f"{name}/{surface}" for surface in entry["surfaces"]],
        plane=None if plane is None else _pose(plane["pose"]),
    )


def _with_grasped_handles(objects: dict, grasps: dict[str, list[str]]) -> dict[str, Manipulated]:
    """Objects that `graph.objects` does not list take part with the handles that `graph.grasps` names."""
    handles = sorted({handle for held in grasps.values() for handle in held})
    return {
        name: entry or Manipulated([handle for handle in handles if handle.startswith(f"{name}/")], [], None)
        for name, entry in objects.items()
    }


def _rule(entry: dict) -> Rule:
    when = {gripper: "" if handle == "empty" else handle for gripper, handle in entry["when"].items()}
    return Rule(when, entry["allow"])


def _relation(entry: dict) -> Relation:
    _refuse_others(entry, {"name", "kind", "frame", "to", "value", "mask"}, f"constraint {entry['name']}")
    rows = {"pose": 6, "centre_of_mass": 3}.get(entry["kind"])
    if rows is None or entry.get("value") != "start":
        raise SceneError(f"constraint {entry['name']}: only poses and centres of mass as in the start are stated")
    mask = [bool(row) for row in entry.get("mask", [1] * rows)]
    return Relation(entry["name"], entry["kind"], entry["frame"], entry.get("to"), mask)
