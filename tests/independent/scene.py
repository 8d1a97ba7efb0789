"""The parts of a path file put together: whose coordinate is whose, which body is which, and where links are.

Bodies of all parts are numbered through: `first_body + body` of each part. A configuration is one row of a segment's
knots.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from packages import InputError, resolve
from parts import Part, Shape
from path_file import FREEFLYER_COORDINATES, PLANAR_COORDINATES, PartEntry, PathFile
from rigid import Poses


@dataclass(frozen=True)
class Member:
    """A part with its place in the scene's numbering."""

    index: int
    entry: PartEntry
    part: Part
    srdf: Path | None
    first_body: int
    joint_columns: dict[int, int]
    """Column of the configuration for each of the part's free joints (by pinocchio index); a joint of an environment
    without a coordinate stays at zero."""
    root_columns: list[int]
    """Columns of the root's coordinates: seven, three, or none."""

    @property
    def name(self) -> str:
        return self.entry.name

    @property
    def floats(self) -> bool:
        """An object whose root pose is not a motion of its own: it rests, or follows what carries it."""
        return self.entry.kind == "object" and self.entry.root == "freeflyer"

    def is_world_fixed(self, body: int) -> bool:
        """Whether a body of this part (its own numbering) can never move."""
        return self.entry.kind == "environment" or (self.entry.root == "fixed" and body == 0)

    def joint_values(self, rows: np.ndarray) -> np.ndarray:
        """Joint values (N, body_count) for configurations (N, coordinates), followers included."""
        values = np.zeros((len(rows), self.part.body_count))
        for joint, column in self.joint_columns.items():
            values[:, joint] = rows[:, column]
        return self.part.complete(values)


@dataclass(frozen=True)
class SceneShape:
    """A collision shape with the scene's names; `body` is in the scene's numbering."""

    shape: Shape
    member: Member
    body: int
    link: str

    @property
    def world_fixed(self) -> bool:
        return self.member.is_world_fixed(self.shape.body)


class Scene:
    """All parts of a path file, loaded."""

    def __init__(self, path: PathFile, folders: list[Path]):
        self.path = path
        self.columns = {name: column for column, name in enumerate(path.coordinates)}
        self.members: list[Member] = []
        first_body = 0
        for entry in path.parts:
            member = self._load(entry, first_body, folders)
            self.members.append(member)
            first_body += member.part.body_count
        self.body_count = first_body
        self.by_name = {member.name: member for member in self.members}
        self._refuse_unknown_coordinates()
        self.shapes = [
            SceneShape(shape, member, member.first_body + shape.body, f"{member.name}/{shape.link}")
            for member in self.members
            for shape in member.part.shapes
        ]

    def link(self, name: str) -> tuple[int, Poses]:
        """Body (the scene's numbering) of a link `part/link` and the link's pose in that body."""
        part_name, _, link = name.partition("/")
        member = self.by_name.get(part_name)
        if member is None:
            raise InputError(f"{self.path.file}: link {name!r}: there is no part {part_name!r}")
        if link not in member.part.links:
            raise InputError(f"{self.path.file}: link {name!r}: {member.part.urdf} has no link {link!r}")
        body, body_from_link = member.part.links[link]
        return member.first_body + body, body_from_link

    def frame(self, name: str) -> tuple[int | None, Poses]:
        """Body and pose of a frame: `world` (no body), a part's root, `part/link`, `part/joint`, a gripper or a
        handle."""
        if name == "world":
            return None, Poses.identity()
        if name in self.by_name:
            member = self.by_name[name]
            return self.link(f"{name}/{member.part.root_link}")
        if name in self.path.grippers:
            gripper = self.path.grippers[name]
            return self._on_link(gripper.link, gripper.link_from_gripper)
        if name in self.path.handles:
            handle = self.path.handles[name]
            return self._on_link(handle.link, handle.link_from_handle)
        part_name, _, joint = name.partition("/")
        member = self.by_name.get(part_name)
        if member and joint not in member.part.links and joint in member.part.joint_by_name:
            return member.first_body + member.part.joint_by_name[joint].index, Poses.identity()
        return self.link(name)

    def root_link(self, part: str) -> str:
        """The root link (`part/link`) of a part."""
        if part not in self.by_name:
            raise InputError(f"{self.path.file}: there is no part {part!r}")
        return f"{part}/{self.by_name[part].part.root_link}"

    def member_of_body(self, body: int) -> Member:
        return next(member for member in reversed(self.members) if member.first_body <= body)

    def _on_link(self, link: str, link_from_frame) -> tuple[int, Poses]:
        body, body_from_link = self.link(link)
        return body, body_from_link @ Poses.from_array(link_from_frame)

    def _load(self, entry: PartEntry, first_body: int, folders: list[Path]) -> Member:
        beside = self.path.file.parent
        part = Part(resolve(entry.urdf, folders, beside), folders, entry.mimic, entry.up_axis)
        return Member(
            index=len(self.members),
            entry=entry,
            part=part,
            srdf=resolve(entry.srdf, folders, beside) if entry.srdf else None,
            first_body=first_body,
            joint_columns=self._joint_columns(entry, part),
            root_columns=self._root_columns(entry),
        )

    def _joint_columns(self, entry: PartEntry, part: Part) -> dict[int, int]:
        columns = {}
        for joint in part.free_joints():
            column = self.columns.get(f"{entry.name}/{joint.name}")
            if column is not None:
                columns[joint.index] = column
            elif entry.kind != "environment":
                raise InputError(f"{self.path.file}: no coordinate for joint {entry.name}/{joint.name} of {part.urdf}")
        return columns

    def _root_columns(self, entry: PartEntry) -> list[int]:
        names = {"fixed": (), "freeflyer": FREEFLYER_COORDINATES, "planar": PLANAR_COORDINATES}[entry.root]
        for name in names:
            if f"{entry.name}/{name}" not in self.columns:
                raise InputError(f"{self.path.file}: coordinate {entry.name}/{name} of a {entry.root} root is missing")
        return [self.columns[f"{entry.name}/{name}"] for name in names]

    def _refuse_unknown_coordinates(self) -> None:
        known = {column for member in self.members for column in member.joint_columns.values()}
        known |= {column for member in self.members for column in member.root_columns}
        for name, column in self.columns.items():
            if column not in known:
                raise InputError(
                    f"{self.path.file}: coordinate {name!r} is neither a free joint nor a root coordinate of a part"
                )
