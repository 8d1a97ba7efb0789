"""A Foliate path as the package's `Path`: a configuration for every t in [0, 1]."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from guided_tamp_benchmark.core import Configuration, Path
from guided_tamp_benchmark.tasks import BaseTask

from package import FINGER, FOLLOWER, joint_names
from path_knots import WORLD, KnotPath, between


class FoliatePath(Path):
    """Objects that a link carries follow it rigidly, by the kinematics of the package's own model."""

    def __init__(self, task: BaseTask, path: KnotPath):
        values = dict(zip(joint_names(task), task.robot.initial_configuration()))
        self.path = between(path, FINGER, float(values[FINGER]))
        self.names = [object.name for object in task.objects]
        self.columns = [self.path.joints.index(FINGER if joint == FOLLOWER else joint) for joint in joint_names(task)]
        self.robot = pin.buildModelFromUrdf(task.robot.urdfFilename)
        self.data = self.robot.createData()
        self.base = pin.SE3(np.asarray(task.get_robot_pose(), dtype=float))

    def interpolate(self, t: float) -> Configuration:
        piece, share = self.path.at(t)
        joints = piece.before + share * (piece.after - piece.before)
        return Configuration(joints[self.columns], [self._object(piece, name, joints) for name in self.names])

    def _object(self, piece, name: str, joints: np.ndarray) -> np.ndarray:
        placed = pin.XYZQUATToSE3(piece.poses[name])
        carrier = piece.carriers[name]
        if carrier is WORLD:
            return placed.homogeneous
        return (self._link(carrier, joints) * self._link(carrier, piece.before).inverse() * placed).homogeneous

    def _link(self, name: str, joints: np.ndarray) -> pin.SE3:
        pin.forwardKinematics(self.robot, self.data, joints[self.columns])
        return self.base * pin.updateFramePlacement(self.robot, self.data, self.robot.getFrameId(name))
