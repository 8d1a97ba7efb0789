"""The installed package: which instances it has, and one of them as a task of its own and as a scene's contents."""

from __future__ import annotations

import contextlib
import io
import pickle
import shutil
import warnings
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pinocchio as pin
from guided_tamp_benchmark.core import Configuration
from guided_tamp_benchmark.models.robots import KukaMobileIIWARobot, PandaRobot, UR5Robot
from guided_tamp_benchmark.models.utils import get_models_data_directory
from guided_tamp_benchmark.tasks import BaseTask, ShelfTask, TunnelTask, WaiterTask
from guided_tamp_benchmark.tasks.demonstration import Demonstration

from instance_name import InstanceName
from resting import put_down
from scene_text import Instance, Part
from surfaces import flatten_srdf, flattened, polygons

TASKS = {"shelf": ShelfTask, "tunnel": TunnelTask, "waiter": WaiterTask}
ROBOTS = {robot.name: robot for robot in (PandaRobot, UR5Robot, KukaMobileIIWARobot)}
FINGER, FOLLOWER, OPEN_M = "panda_finger_joint1", "panda_finger_joint2", 0.04
"""All three robots carry the Panda's hand. Both fingers are coordinates of the package; the second one mimics."""
ROOM_M, MOBILE_ROOM_M = 1.0, 4.0
"""Roots of objects may be this far beside and above what supports them (metres). The package bounds them nowhere, and
no robot reaches farther; the mobile one drives up to 3 m from the origin."""


def instances() -> list[InstanceName]:
    """All that the package has data for, in its order of tasks, demonstrations, robots and poses."""
    found = []
    for task in TASKS:
        for demo in sorted(Demonstration.get_demonstration_ids(task)):
            for robot in ROBOTS:
                file = Demonstration._get_robot_poses_filepath(task, demo, robot)
                if Path(file).is_file():
                    found += [InstanceName(task, demo, robot, pose) for pose in sorted(_unpickled(file))]
    return found


def load(name: InstanceName) -> BaseTask:
    """The package's own task. It prints while it loads, and removes what it calls a tray from the objects."""
    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return TASKS[name.task](name.demo, ROBOTS[name.robot](), name.pose)


def ends(task: BaseTask) -> tuple[Configuration, Configuration]:
    """Start and goal: the first and the last subgoal, the robot in its initial configuration."""
    poses = task.demo.subgoal_objects_poses[: len(task.objects)]
    q = np.asarray(task.robot.initial_configuration(), dtype=float)
    return Configuration(q, poses[:, 0]), Configuration(q, poses[:, -1])


def colliding(task: BaseTask, configuration: Configuration) -> list[tuple[str, str]]:
    """The pairs of shapes that the package's own model finds in collision."""
    geometry = pin.GeometryData(task.collision.col_mod)
    model = task.collision
    pin.computeCollisions(model.pin_mod, model.data, model.col_mod, geometry, configuration.to_numpy(), False)
    shapes = model.col_mod.geometryObjects
    return [(shapes[pair.first].name, shapes[pair.second].name)
            for pair, result in zip(model.col_mod.collisionPairs, geometry.collisionResults) if result.isCollision()]


def grasps_shown(task: BaseTask) -> int:
    """How many grasps the demonstration has: two subgoals each, one where something is taken and one where it is put."""
    return task.demo.subgoal_objects_poses.shape[1] // 2


@dataclass
class Converted:
    """An instance and what of its models had to be changed."""

    instance: Instance
    changes: list[str]
    moved: float
    """By how much the objects' poses were moved to rest exactly (metres, radians)."""


class Models:
    """The folder of models below the scenes: URDF and SRDF of each part, and copies of the meshes that they name."""

    def __init__(self, folder: Path):
        self.folder = folder
        (folder / "meshes").mkdir(parents=True, exist_ok=True)

    def add(self, name: str, urdf: Path, srdf: Path) -> tuple[str, str, list[str]]:
        """Names of both files relative to the scenes, and what was changed."""
        root = ET.fromstring(urdf.read_text())
        for link in root.findall("link"):
            for visual in link.findall("visual"):
                link.remove(visual)
            for stray in [*link.findall("origin"), *link.findall("geometry")]:
                link.remove(stray)
        for mesh in root.iter("mesh"):
            mesh.set("filename", self._mesh(mesh.get("filename")))
        links = {link.get("name") for link in root.iter("link")}
        text, changes = flatten_srdf(srdf.read_text(), links)
        self._write(f"{name}.urdf", ET.tostring(root, encoding="unicode"))
        self._write(f"{name}.srdf", text)
        return f"{self.folder.name}/{name}.urdf", f"{self.folder.name}/{name}.srdf", changes

    def _write(self, name: str, text: str) -> None:
        (self.folder / name).write_text(text)

    def _mesh(self, name: str) -> str:
        data = get_models_data_directory()
        source = data / name.removeprefix("package://") if name.startswith("package://") else Path(name)
        local = f"meshes/{source.relative_to(data).as_posix().replace('/meshes', '').replace('/', '-')}"
        target = self.folder / local
        if not target.is_file():
            shutil.copyfile(source, target)
        return local


def convert(name: InstanceName, task: BaseTask, models: Models) -> Converted:
    """The contents of the scene of `name`."""
    robot = task.robot
    urdf, srdf, changes = models.add(robot.name, Path(robot.urdfFilename), Path(robot.srdfFilename))
    parts = [Part(robot.name, "robot", urdf, srdf, _pose(task.get_robot_pose()))]
    for object in task.objects:
        urdf, srdf, more = models.add(object.name, Path(object.urdfFilename), Path(object.srdfFilename))
        parts.append(Part(object.name, "object", urdf, srdf))
        changes += more
    for piece in task.furniture:
        if flat := _without_volume(Path(piece.urdfFilename)):
            changes.append(f"{piece.name}: left out, its box of {flat} has no volume")
            continue
        own = name.text if piece.name == "box" else f"{name.task}-{name.demo}"
        urdf, srdf, more = models.add(f"{own}-{piece.name}", Path(piece.urdfFilename), Path(piece.srdfFilename))
        parts.append(Part(piece.name, "environment", urdf, srdf))
        changes += more
    heights = [float(corner[2]) for _, polygon in supports(task) for corner in polygon[:1]]
    at, moved = [], 0.0
    for configuration in ends(task):
        resting = [put_down(pose, object_surfaces(object), heights) for object, pose in zip(task.objects, configuration.poses)]
        at.append([pose for pose, _ in resting])
        moved = max(moved, *(by for _, by in resting))
    names = [object.name for object in task.objects]
    instance = Instance(
        name=name.text, description=f"{name.robot} at pose {name.pose}, demonstration {name.demo} of the {name.task} task",
        parts=parts, joints=_joints(task), start=dict(zip(names, map(_pose, at[0]))),
        goal=dict(zip(names, map(_pose, at[1]))), gripper=robot.get_gripper_name(),
        handles={object.name: list(object.handles()) for object in task.objects},
        supports=[f"{piece.name}/{surface}" for piece in task.furniture for surface in piece.contact_surfaces()]
        + list(robot.get_contact_surfaces()),
        bounds=_bounds(task), finger=(f"{robot.name}/{FINGER}", OPEN_M), untested=_untested(task),
    )
    return Converted(instance, changes, moved)


def joint_names(task: BaseTask) -> list[str]:
    """The robot's joints in the package's order, both fingers among them."""
    return task.robot.get_actuated_joint_names()


def _joints(task: BaseTask) -> dict[str, float]:
    values = zip(joint_names(task), task.robot.initial_configuration())
    return {f"{task.robot.name}/{joint}": float(value) for joint, value in values if joint != FOLLOWER}


def _untested(task: BaseTask) -> list[tuple[str, str]]:
    """The package leaves the walls beside and above a tunnel out for the robot: only objects must go through it."""
    return [(task.robot.name, f"{piece.name}/{link}") for piece in task.furniture
            for link in getattr(piece, "disabled_collision_links_for_robot", [])]


def _bounds(task: BaseTask) -> list[list[float]]:
    """Of the objects' roots: around the furniture that supports them, and around all poses that are given."""
    corners = [task.demo.subgoal_objects_poses[: len(task.objects), :, :3, 3].reshape(-1, 3)]
    corners += [polygon for _, polygon in supports(task)]
    if task.robot.robot_type == "mobile":
        corners.append(np.array([[-MOBILE_ROOM_M, -MOBILE_ROOM_M, 0.0], [MOBILE_ROOM_M, MOBILE_ROOM_M, 0.0]]))
    low, high = np.vstack(corners).min(axis=0) - ROOM_M, np.vstack(corners).max(axis=0) + ROOM_M
    return [[round(float(a), 3), round(float(b), 3)] for a, b in zip(low, high)]


def supports(task: BaseTask) -> list[tuple[str, np.ndarray]]:
    """The surfaces of furniture, in the world."""
    return [(f"{piece.name}/{contact.get('name')}", polygon @ pose[:3, :3].T + pose[:3, 3])
            for piece, pose in zip(task.furniture, task.demo.furniture_poses)
            for contact in ET.parse(piece.srdfFilename).getroot().iter("contact") for polygon in polygons(contact)]


def _without_volume(urdf: Path) -> str:
    """The size of the first box that is not positive in all directions; empty where there is none.

    The package puts a box under the base of a fixed robot. Where its base has no pose (the first of each list is the
    identity) that box has a height of zero or less."""
    sizes = [box.get("size") for box in ET.parse(urdf).getroot().iter("box")]
    return next((size for size in sizes if min(map(float, size.split())) <= 0.0), "")


def object_surfaces(object) -> list[np.ndarray]:
    """The surfaces of an object on which it may rest, flat."""
    contacts = ET.parse(object.srdfFilename).getroot().iter("contact")
    return [flattened(polygon) for contact in contacts for polygon in polygons(contact)]


def _pose(matrix: np.ndarray) -> list[float]:
    placed = pin.SE3ToXYZQUAT(pin.SE3(np.asarray(matrix, dtype=float)))
    placed[3:] /= np.linalg.norm(placed[3:])
    return [float(value) for value in placed]


def _unpickled(file: Path):
    with warnings.catch_warnings(), open(file, "rb") as stored:
        warnings.simplefilter("ignore")
        return pickle.load(stored)
