"""Scenes in code."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal

from numpy.typing import ArrayLike

from foliate import poses
from foliate._foliate import Scene
from foliate.document import plain

__all__ = ["SceneBuilder"]

Kind = Literal["object", "environment"]
File = str | PathLike[str]


class SceneBuilder:
    """Builds a scene part by part.

    ``document`` is what has been built: a dictionary with the keys of a scene file, which may be read and changed. Keywords that a method does not name are
    keys of a part of a scene file (``velocity_limits=...``). Names of links, grippers and so on are ``part/name`` outside of their part.

    Poses are x, y, z in metres and the quaternion x, y, z, w; or x, y, z; or a matrix of shape (4, 4). They are in the world, but for those of grippers and
    handles, which are in their link.
    """

    def __init__(self, name: str = "scene", *, folder: File = ".", packages: Sequence[File] = ()) -> None:
        """``folder`` is where names of files start, ``packages`` are folders in which ``package://`` names are looked up."""
        self.folder = folder
        self.packages = packages
        self.document: dict[str, Any] = {"format": "foliate.scene/1", "name": name, "part": [], "start": {}, "goal": []}

    def add_robot(
        self,
        urdf: File,
        *,
        name: str = "robot",
        srdf: File | None = None,
        pose: ArrayLike | None = None,
        root: Literal["fixed", "planar", "freeflyer"] = "fixed",
        grippers: Literal["auto"] | None = "auto",
        start: str | Mapping[str, ArrayLike] | None = None,
        **keys: Any,
    ) -> SceneBuilder:
        """Adds a robot.

        ``grippers="auto"`` finds hands in the model (end effectors of the SRDF, or jaws). ``start`` is a configuration's name in the SRDF, or values of joints by
        name (rad or m); joints that it does not name start at 0. ``pose`` is that of the root link.
        """
        part = {"kind": "robot", "urdf": os.fspath(urdf), "srdf": srdf, "root": root, "grippers": grippers}
        self._add(name, part, keys, pose=None if pose is None else poses.pose(pose))
        if isinstance(start, str):
            self.document["start"][name] = start
        elif start is not None:
            self.document["start"].update({f"{name}/{joint}": value for joint, value in start.items()})
        return self

    def add_urdf(
        self, name: str, urdf: File, *, pose: ArrayLike, kind: Kind = "object", srdf: File | None = None, **keys: Any
    ) -> SceneBuilder:
        """Adds an object or an environment that has a URDF, with the handles and surfaces that its SRDF lists."""
        return self._add_solid(name, kind, {"urdf": os.fspath(urdf), "srdf": srdf}, pose, keys)

    def add_box(self, name: str, sides: ArrayLike, *, pose: ArrayLike, kind: Kind = "object", **keys: Any) -> SceneBuilder:
        """Adds a box; ``sides`` along x, y, z in metres. ``pose`` is that of its middle.

        An object has ``handles="auto"`` and ``surfaces="auto"`` unless ``keys`` say otherwise: grasps and resting faces are found. ``kind="environment"`` makes
        a thing that never moves; with ``surfaces="auto"`` objects may lie on its upper face.
        """
        return self._shape(name, kind, {"box": sides}, pose, keys)

    def add_cylinder(
        self, name: str, radius: float, length: float, *, pose: ArrayLike, kind: Kind = "object", **keys: Any
    ) -> SceneBuilder:
        """Adds a cylinder about z, metres; otherwise as ``add_box``."""
        return self._shape(name, kind, {"cylinder": [radius, length]}, pose, keys)

    def add_sphere(self, name: str, radius: float, *, pose: ArrayLike, kind: Kind = "object", **keys: Any) -> SceneBuilder:
        """Adds a sphere, metres; otherwise as ``add_box``. A sphere rests on no face."""
        return self._shape(name, kind, {"sphere": radius}, pose, keys, surfaces=None)

    def add_mesh(
        self, name: str, file: File, *, pose: ArrayLike, scale: ArrayLike = 1.0, kind: Kind = "object", **keys: Any
    ) -> SceneBuilder:
        """Adds a mesh; ``scale`` is one factor of its lengths or three, 0.001 where these are millimetres. Otherwise as ``add_box``."""
        return self._shape(name, kind, {"mesh": os.fspath(file), "scale": scale}, pose, keys)

    def add_gripper(self, part: str, name: str, link: str, *, pose: ArrayLike = (0, 0, 0), clearance: float = 0.0) -> SceneBuilder:
        """Adds a gripper to a part. Its x axis approaches, its y axis closes; ``clearance`` is how far before a grasp it stops, metres."""
        entry = {"name": name, "link": link, "pose": poses.pose(pose), "clearance": clearance}
        self._part(part).setdefault("gripper", []).append(entry)
        return self

    def add_handle(
        self,
        part: str,
        name: str,
        *,
        pose: ArrayLike = (0, 0, 0),
        link: str | None = None,
        clearance: float = 0.0,
        mask: Sequence[int] | None = None,
    ) -> SceneBuilder:
        """Adds a handle to a part. In a grasp its frame is that of the gripper, in the rows of ``mask`` (x, y, z and the rotations about them)."""
        entry = {"name": name, "link": link, "pose": poses.pose(pose), "clearance": clearance, "mask": mask}
        self._part(part).setdefault("handle", []).append(entry)
        return self

    def ignore(self, first: str, second: str) -> SceneBuilder:
        """Two links, or all links of two parts, are not tested against each other."""
        self.document.setdefault("ignore", []).append([first, second])
        return self

    def add_goal(self, *, objects: Mapping[str, ArrayLike] | None = None, **keys: Any) -> SceneBuilder:
        """Adds a goal; reaching one of all goals solves the problem.

        ``objects`` has poses of objects. ``keys`` are those of a goal of a scene file: ``on={"box": "table/top"}``, ``hands="empty"``, ``held=["box"]``,
        ``within=[...]``, ``coordinates={...}`` and so on. All of one goal have to hold, everything else is free.
        """
        placed = None if objects is None else {name: poses.pose(value) for name, value in objects.items()}
        self.document["goal"].append({"objects": placed, **keys})
        return self

    def scene(self) -> Scene:
        """The scene.

        Raises ``SceneError`` where it is none, with the element; ``ValueError`` where a value has no form in a scene file.
        """
        return Scene.from_dict(plain(self.document), folder=self.folder, packages=list(self.packages))

    def __repr__(self) -> str:
        names = ", ".join(part["name"] for part in self.document["part"])
        return f"SceneBuilder({self.document['name']!r}: {names})"

    def _part(self, name: str) -> dict[str, Any]:
        for part in self.document["part"]:
            if part["name"] == name:
                found: dict[str, Any] = part
                return found
        raise ValueError(f"no part {name!r} has been added")

    def _add(self, name: str, part: dict[str, Any], keys: dict[str, Any], pose: list[float] | None) -> None:
        if any(there["name"] == name for there in self.document["part"]):
            raise ValueError(f"there is a part {name!r} already")
        self.document["part"].append({"name": name, **part, "pose": pose, **keys})

    def _shape(
        self, name: str, kind: Kind, shape: dict[str, Any], pose: ArrayLike, keys: dict[str, Any], *, surfaces: str | None = "auto"
    ) -> SceneBuilder:
        found = {"handles": "auto" if kind == "object" else None, "surfaces": surfaces}
        mass = keys.pop("mass", None)
        return self._add_solid(name, kind, {"shape": {**shape, "mass": mass}, **found}, pose, keys)

    def _add_solid(self, name: str, kind: Kind, part: dict[str, Any], pose: ArrayLike, keys: dict[str, Any]) -> SceneBuilder:
        if kind not in ("object", "environment"):
            raise ValueError(f'`kind` is "object" or "environment", not {kind!r}')
        placed = poses.pose(pose)
        moves = kind == "object" and keys.get("root", "freeflyer") == "freeflyer"
        self._add(name, {"kind": kind, **part}, keys, pose=None if moves else placed)
        if moves:
            self.document["start"][name] = placed
        return self
