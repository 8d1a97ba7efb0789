"""A scene stated in pyhpp (HPP 9): parts, configurations, validation. Nothing here searches.

Imports HPP, so it only works where `environment.py` has prepared the process.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pinocchio
import pyhpp.core
import pyhpp.manipulation
import pyhpp.manipulation.urdf
import pyhpp.pinocchio

from independent import resolve, search_directories
from scene_file import ROOT_COORDINATES, Part, Scene, SceneError
from settings import Settings

ROOT_JOINTS = {"fixed": "anchor", "freeflyer": "freeflyer", "planar": "planar"}
ROOT_UNBOUNDED = {"freeflyer": 4, "planar": 0, "fixed": 0}
"""Numbers of a root's configuration that the scene does not bound, but HPP wants bounds for: a quaternion."""


class HppModel:
    """All parts of a scene in one HPP device, and configurations told in either numbering."""

    def __init__(self, scene: Scene):
        self.scene = scene
        self.device = pyhpp.manipulation.Device(scene.name)
        folders = search_directories()
        for part in scene.parts:
            self._load(part, folders)
        for part in scene.parts:
            self._bound(part)
        self.model = self.device.model()
        self.columns = [self._column(name) for name in scene.coordinates]

    def _load(self, part: Part, folders: list[Path]) -> None:
        beside = self.scene.file.parent
        urdf = resolve(part.urdf, folders, beside)
        text = _fixed_joints(urdf) if part.kind == "environment" else urdf.read_text()
        srdf = resolve(part.srdf, folders, beside).read_text() if part.srdf else ""
        pyhpp.manipulation.urdf.loadModelFromString(
            self.device, 0, part.name, ROOT_JOINTS[part.root], text, srdf, se3(part.pose)
        )

    def _bound(self, part: Part) -> None:
        if part.root_bounds:
            bounds = [limit for pair in part.root_bounds for limit in pair]
            bounds += [-1.0001, 1.0001] * ROOT_UNBOUNDED[part.root]
            self.device.setJointBounds(f"{part.name}/root_joint", bounds)
        for joint, (low, high) in part.joint_bounds.items():
            self.device.setJointBounds(f"{part.name}/{joint}", [low, high])
        for handle, mask in part.masks.items():
            self.device.handles()[f"{part.name}/{handle}"].mask = mask

    def _column(self, name: str) -> tuple[int, int]:
        """First entry of a coordinate in HPP's configuration and how many there are: an unbounded angle is a cosine and
        a sine."""
        part_name, _, coordinate = name.partition("/")
        part = self.scene.part(part_name)
        roots = ROOT_COORDINATES[part.root]
        if coordinate in roots:
            first = self._rank(f"{part_name}/root_joint") + roots.index(coordinate)
            return first, 2 if coordinate == "theta" else 1
        joint = self.model.getJointId(name)
        if joint >= self.model.njoints:
            raise SceneError(f"{name}: HPP knows no such joint")
        return self.model.idx_qs[joint], self.model.nqs[joint]

    def _rank(self, joint: str) -> int:
        return self.model.idx_qs[self.model.getJointId(joint)]

    def to_hpp(self, values: list[float]) -> np.ndarray:
        """HPP's configuration for one in the scene's numbering."""
        configuration = np.array(pinocchio.neutral(self.model))
        for (first, count), value in zip(self.columns, values):
            configuration[first:first + count] = [value] if count == 1 else [np.cos(value), np.sin(value)]
        return configuration

    def from_hpp(self, configurations: np.ndarray) -> np.ndarray:
        """Rows in the scene's numbering for rows of HPP's; unbounded angles in [-pi, pi]."""
        rows = np.empty((len(configurations), len(self.columns)))
        for column, (first, count) in enumerate(self.columns):
            entries = configurations[:, first:first + count]
            rows[:, column] = entries[:, 0] if count == 1 else np.arctan2(entries[:, 1], entries[:, 0])
        return rows

    def joint_of(self, frame: str) -> tuple[int, pinocchio.SE3]:
        """Joint that carries a link, and the link's pose in it."""
        known = self.model.frames[self.model.getFrameId(frame, pinocchio.FrameType.BODY)]
        return known.parentJoint, known.placement

    def pose_of(self, frame: str, configuration: np.ndarray) -> pinocchio.SE3:
        """World pose of a link."""
        data = self.model.createData()
        pinocchio.forwardKinematics(self.model, data, configuration)
        joint, placement = self.joint_of(frame)
        return data.oMi[joint] * placement

    @property
    def pairs(self) -> int:
        """Pairs of shapes that HPP tests."""
        return len(self.device.geomModel().collisionPairs)


def _fixed_joints(urdf: Path) -> str:
    """An environment's URDF with its joints fixed at zero: else HPP adds doors and drawers to the configuration."""
    root = ElementTree.parse(urdf).getroot()
    for joint in root.findall("joint"):
        joint.set("type", "fixed")
        for tag in ("mimic", "limit", "axis", "dynamics", "safety_controller", "calibration"):
            for element in joint.findall(tag):
                joint.remove(element)
    return ElementTree.tostring(root, encoding="unicode")


def se3(pose: list[float]) -> pinocchio.SE3:
    """From x y z qx qy qz qw."""
    x, y, z, qx, qy, qz, qw = pose
    return pinocchio.SE3(pinocchio.Quaternion(qw, qx, qy, qz), np.array([x, y, z]))


def validate_paths(problem, device, settings: Settings) -> None:
    """Collision tests of configurations and paths. These are setter *methods* in HPP 9: an assignment does nothing, and
    without `addConfigValidation` no configuration is tested at all."""
    problem.clearConfigValidations()
    problem.addConfigValidation("CollisionValidation")
    problem.steeringMethod(pyhpp.core.Straight(problem))
    if settings.validation is not None:
        kind, parameter = settings.validation
        problem.pathValidation(getattr(pyhpp.core, kind)(device, parameter))


def project_paths(problem, settings: Settings, module) -> None:
    """`module` is where the projector is made: `pyhpp.core` or `pyhpp.manipulation`."""
    if settings.projector is not None:
        kind, step = settings.projector
        projector = getattr(module, f"{kind}Projector")
        problem.pathProjector(projector(problem.distance(), problem.steeringMethod(), step))
