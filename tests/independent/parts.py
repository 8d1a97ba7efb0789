"""One part of a scene (robot, object, environment) as pinocchio and coal see it.

The model is built without a root joint: body poses are given in the frame of the part's root link, and the caller
places that frame. A *body* is a pinocchio joint with everything rigidly fixed to it; body 0 is the root link.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import coal
import numpy as np
import pinocchio

from packages import InputError, resolve
from rigid import Poses

MOVING_JOINT_TYPES = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class Joint:
    """A joint with one degree of freedom; `index` is pinocchio's (1-based), `low`/`high` the URDF's limits."""

    name: str
    index: int
    q_index: int
    prismatic: bool
    continuous: bool
    low: float
    high: float


@dataclass(frozen=True)
class Follower:
    """A mimic joint: value = multiplier * leader + offset (URDF `<mimic>`)."""

    joint: int
    leader: int
    multiplier: float
    offset: float


@dataclass(frozen=True)
class Shape:
    """A collision geometry: coal's object, posed in its body's frame."""

    name: str
    link: str
    body: int
    body_from_shape: Poses
    geometry: coal.CollisionGeometry
    center: np.ndarray
    """Centre of the shape's local box, in the shape's own frame."""
    half_extents: np.ndarray
    """Half sides of the shape's local box."""
    radius: float
    """The shape lies within this distance of `center`."""

    @property
    def is_mesh(self) -> bool:
        return isinstance(self.geometry, coal.BVHModelBase)

    @property
    def reach(self) -> float:
        """No point of the shape is farther than this from the origin of its body."""
        return float(np.linalg.norm(self.body_from_shape.apply(self.center))) + self.radius


class Part:
    """A URDF loaded by pinocchio, its collision geometry held by coal."""

    def __init__(self, urdf: Path, folders: list[Path], mimic: str = "follow", up_axis: str = "as-written"):
        self.urdf = urdf
        self.tree = _parse_xml(urdf)
        self._point_meshes_at_files(folders)
        text = ElementTree.tostring(self.tree, encoding="unicode")
        try:
            self.model = pinocchio.buildModelFromXML(text)
            self._geometry = pinocchio.buildGeomFromUrdfString(self.model, text, pinocchio.GeometryType.COLLISION)
        except Exception as error:
            raise InputError(f"{urdf}: pinocchio cannot load it: {error}") from error
        if up_axis == "declared":
            self._turn_collada_meshes()
        self.data = self.model.createData()
        self.joints = self._read_joints()
        self.links = {
            frame.name: (frame.parentJoint, Poses.from_se3(frame.placement))
            for frame in self.model.frames
            if frame.type == pinocchio.FrameType.BODY
        }
        self.followers = self._read_followers() if mimic == "follow" else []

    def _turn_collada_meshes(self) -> None:
        """Coal reads COLLADA meshes as they are written: turns those whose file declares another axis than z as up."""
        for geometry in self._geometry.geometryObjects:
            file = Path(geometry.meshPath)
            if file.suffix.lower() != ".dae":
                continue
            turn = _up_axis_turn(file)
            if np.allclose(turn, np.eye(3)):
                continue
            scale = np.array(geometry.meshScale).ravel()
            if np.ptp(scale) > 0:
                raise InputError(f"{self.urdf}: {file.name} is turned and scaled unevenly, which is not read here")
            geometry.placement = geometry.placement * pinocchio.SE3(turn, np.zeros(3))

    @property
    def body_count(self) -> int:
        return self.model.njoints

    @cached_property
    def parents(self) -> list[int]:
        """Parent body of each body; body 0 is its own parent."""
        return [int(parent) for parent in self.model.parents]

    @cached_property
    def placements(self) -> list[Poses]:
        """Pose of each joint in its parent body at joint value zero."""
        return [Poses.from_se3(placement) for placement in self.model.jointPlacements]

    @cached_property
    def shapes(self) -> list[Shape]:
        return [self._shape(geometry) for geometry in self._geometry.geometryObjects]

    @cached_property
    def joint_by_name(self) -> dict[str, Joint]:
        return {joint.name: joint for joint in self.joints}

    @cached_property
    def root_link(self) -> str:
        children = {joint.find("child").get("link") for joint in self.tree.findall("joint")}
        roots = [link.get("name") for link in self.tree.findall("link") if link.get("name") not in children]
        if len(roots) != 1:
            raise InputError(f"{self.urdf}: {len(roots)} root links")
        return roots[0]

    def free_joints(self) -> list[Joint]:
        """The joints that carry a coordinate: all but followers."""
        following = {follower.joint for follower in self.followers}
        return [joint for joint in self.joints if joint.index not in following]

    def complete(self, values: np.ndarray) -> np.ndarray:
        """Joint values (..., body_count) with the followers' entries computed from their leaders'."""
        values = np.array(values, dtype=float)
        for follower in self.followers:
            values[..., follower.joint] = follower.multiplier * values[..., follower.leader] + follower.offset
        return values

    def body_poses(self, values: np.ndarray) -> Poses:
        """Forward kinematics: poses (N, body_count) of all bodies in the root link's frame for joint values
        (N, body_count), indexed by pinocchio joint (entry 0 unused), followers already complete."""
        if len(values) > 1 and (values == values[0]).all():
            once = self.body_poses(values[:1])
            rotation = np.broadcast_to(once.rotation, (len(values),) + once.rotation.shape[1:])
            return Poses(rotation, np.broadcast_to(once.translation, (len(values),) + once.translation.shape[1:]))
        rotation = np.empty((len(values), self.body_count, 3, 3))
        translation = np.empty((len(values), self.body_count, 3))
        for row, configuration in enumerate(self._configurations(values)):
            pinocchio.forwardKinematics(self.model, self.data, configuration)
            for body, pose in enumerate(self.data.oMi):
                rotation[row, body] = pose.rotation
                translation[row, body] = pose.translation
        return Poses(rotation, translation)

    @cached_property
    def mass(self) -> float:
        """Kilograms, of all links."""
        return float(sum(inertia.mass for inertia in self.model.inertias))

    def centre_of_mass(self, values: np.ndarray) -> np.ndarray:
        """Centre of mass (N, 3) of the whole part, root link included, in the root link's frame."""
        root, others = self.model.inertias[0], self.model.inertias[1:]
        others_mass = sum(inertia.mass for inertia in others)
        total = root.mass + others_mass
        if total <= 0.0:
            raise InputError(f"{self.urdf}: no mass, so no centre of mass")
        centres = []
        for configuration in self._configurations(values):
            # pinocchio leaves out what is fixed to the universe, which here is the root link
            beyond = pinocchio.centerOfMass(self.model, self.data, configuration) if others_mass > 0 else np.zeros(3)
            centres.append((root.mass * root.lever + others_mass * np.array(beyond)) / total)
        return np.array(centres)

    def _configurations(self, values: np.ndarray) -> np.ndarray:
        """pinocchio's configuration vectors: a continuous joint is (cos, sin) of its unwrapped angle."""
        configurations = np.zeros((len(values), self.model.nq))
        for joint in self.joints:
            column = values[:, joint.index]
            if joint.continuous:
                configurations[:, joint.q_index] = np.cos(column)
                configurations[:, joint.q_index + 1] = np.sin(column)
            else:
                configurations[:, joint.q_index] = column
        return configurations

    def _read_joints(self) -> list[Joint]:
        types = {joint.get("name"): joint.get("type") for joint in self.tree.findall("joint")}
        joints = []
        for index in range(1, self.model.njoints):
            name, q_index = self.model.names[index], self.model.idx_qs[index]
            if types.get(name) not in MOVING_JOINT_TYPES:
                raise InputError(f"{self.urdf}: joint {name!r} is {types.get(name)!r}; one degree of freedom expected")
            continuous = types[name] == "continuous"
            low = -np.inf if continuous else float(self.model.lowerPositionLimit[q_index])
            high = np.inf if continuous else float(self.model.upperPositionLimit[q_index])
            joints.append(Joint(name, index, q_index, types[name] == "prismatic", continuous, low, high))
        return joints

    def _read_followers(self) -> list[Follower]:
        """Mimic joints, leaders before those who follow them."""
        by_name = {joint.name: joint for joint in self.joints}
        waiting = {}
        for element in self.tree.findall("joint"):
            mimic = element.find("mimic")
            if mimic is not None and element.get("name") in by_name:
                waiting[element.get("name")] = mimic
        followers = []
        while waiting:
            ready = [name for name, mimic in waiting.items() if mimic.get("joint") not in waiting]
            if not ready:
                raise InputError(f"{self.urdf}: mimic joints {sorted(waiting)} follow each other in a circle")
            for name in ready:
                mimic = waiting.pop(name)
                leader = by_name.get(mimic.get("joint"))
                if leader is None:
                    raise InputError(f"{self.urdf}: joint {name!r} mimics {mimic.get('joint')!r}, which does not move")
                multiplier, offset = float(mimic.get("multiplier", 1.0)), float(mimic.get("offset", 0.0))
                followers.append(Follower(by_name[name].index, leader.index, multiplier, offset))
        return followers

    def _point_meshes_at_files(self, folders: list[Path]) -> None:
        for mesh in self.tree.findall("link/collision/geometry/mesh"):
            try:
                mesh.set("filename", str(resolve(mesh.get("filename", ""), folders, self.urdf.parent)))
            except InputError as error:
                raise InputError(f"{self.urdf}: collision mesh {error}") from error

    def _shape(self, geometry: pinocchio.GeometryObject) -> Shape:
        shape = geometry.geometry
        shape.computeLocalAABB()
        low, high = np.array(shape.aabb_local.min_).ravel(), np.array(shape.aabb_local.max_).ravel()
        center, half_extents = (low + high) / 2.0, (high - low) / 2.0
        return Shape(
            name=geometry.name,
            link=self.model.frames[geometry.parentFrame].name,
            body=geometry.parentJoint,
            body_from_shape=Poses.from_se3(geometry.placement),
            geometry=shape,
            center=center,
            half_extents=half_extents,
            radius=float(np.linalg.norm(half_extents)),
        )


def read_disabled_pairs(srdf: Path) -> set[frozenset[str]]:
    """Link pairs of `<disable_collisions link1 link2>`."""
    return {
        frozenset((element.get("link1"), element.get("link2")))
        for element in _parse_xml(srdf).findall("disable_collisions")
    }


@dataclass(frozen=True)
class SrdfDocuments:
    """Grippers, handles and surfaces of an SRDF with HPP's extension; poses as x y z qx qy qz qw in their link."""

    grippers: dict[str, tuple[str, np.ndarray]]
    handles: dict[str, tuple[str, np.ndarray, list[bool], list[bool]]]
    surfaces: dict[str, tuple[str, np.ndarray, list[list[int]]]]


def read_srdf_documents(srdf: Path) -> SrdfDocuments:
    root = _parse_xml(srdf)
    try:
        grippers = {item.get("name"): (_srdf_link(item), _srdf_position(item)) for item in root.findall("gripper")}
        handles = {
            item.get("name"): (_srdf_link(item), _srdf_position(item), *_srdf_masks(item))
            for item in root.findall("handle")
        }
        surfaces = {item.get("name"): (_srdf_link(item), *_srdf_polygons(item)) for item in root.findall("contact")}
    except (ValueError, AttributeError, IndexError) as error:
        raise InputError(f"{srdf}: gripper, handle or contact cannot be read: {error}") from error
    return SrdfDocuments(grippers, handles, surfaces)


def _srdf_link(item) -> str:
    return item.find("link").get("name")


def _srdf_position(item) -> np.ndarray:
    """`<position>`: text is x y z then quaternion w x y z; attributes are xyz and wxyz, xyzw or rpy."""
    element = next(item.find(tag) for tag in ("position", "handle_position_in_joint", "local_position")
                   if item.find(tag) is not None)
    if element.get("xyz") is None:
        numbers = _numbers(element.text)
        if len(numbers) != 7:
            raise ValueError(f"position of {item.get('name')!r} has {len(numbers)} numbers, 7 expected")
        xyz, quaternion = numbers[:3], np.roll(numbers[3:], -1)
    else:
        xyz, quaternion = _numbers(element.get("xyz")), _attribute_quaternion(element)
    return np.concatenate([xyz, quaternion / np.linalg.norm(quaternion)])


def _attribute_quaternion(element) -> np.ndarray:
    if element.get("wxyz") is not None:
        return np.roll(_numbers(element.get("wxyz")), -1)
    if element.get("xyzw") is not None:
        return _numbers(element.get("xyzw"))
    roll, pitch, yaw = _numbers(element.get("rpy", "0 0 0"))
    return np.array(pinocchio.Quaternion(pinocchio.rpy.rpyToMatrix(roll, pitch, yaw)).coeffs())


def _srdf_masks(item) -> tuple[list[bool], list[bool]]:
    def read(tag: str, default: list[bool]) -> list[bool]:
        element = item.find(tag)
        return default if element is None else [word.lower() in ("1", "true") for word in element.text.split()]

    mask = read("mask", [True] * 6)
    return mask, read("mask_complement", [not row for row in mask])


def _srdf_polygons(item) -> tuple[np.ndarray, list[list[int]]]:
    points = _numbers(item.find("point").text).reshape(-1, 3)
    words, polygons = [int(word) for word in item.find("shape").text.split()], []
    while words:
        count = words[0]
        polygons.append(words[1:count + 1])
        words = words[count + 1:]
    return points, polygons


def _numbers(text: str) -> np.ndarray:
    return np.array([float(word) for word in text.split()])


def _parse_xml(path: Path):
    try:
        return ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise InputError(f"{path}: {error}") from error


def _up_axis_turn(file: Path) -> np.ndarray:
    """Rotation from a COLLADA file's axes to z up: right, up and inward are (-y, x, z) for X_UP and (x, y, z) for Y_UP."""
    for _, element in ElementTree.iterparse(file):
        if element.tag.rsplit("}", 1)[-1] == "up_axis":
            axis = (element.text or "Y_UP").strip()
            columns = {"X_UP": ([0, 0, 1], [-1, 0, 0], [0, -1, 0]), "Y_UP": ([1, 0, 0], [0, 0, 1], [0, -1, 0]),
                       "Z_UP": ([1, 0, 0], [0, 1, 0], [0, 0, 1])}.get(axis)
            if columns is None:
                raise InputError(f"{file}: `{axis}` is no axis: X_UP, Y_UP or Z_UP")
            return np.array(columns, dtype=float).T
    return np.eye(3)
