"""The robot as pinocchio and coal see it, with the meshes of its description, and one problem's obstacles around it."""

from __future__ import annotations

import sys
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin

from problems import ROUNDED, Obstacle, Problem, ProblemsError

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from independent import InputError, resolve, search_directories  # noqa: E402

PANDA = "package://example-robot-data/robots/panda_description/"
KNOWN = {"panda": (PANDA + "urdf/panda.urdf", PANDA + "srdf/panda.srdf")}


class Robot:
    """Model and collision geometry, read once. Pairs: all shapes on different bodies, less those that the SRDF disables."""

    def __init__(self, name: str, urdf: str | None, srdf: str | None, packages: list[str]):
        if urdf is None and name not in KNOWN:
            raise ProblemsError(f"no description of the robot {name} is known; give it by --urdf and --srdf")
        known = KNOWN.get(name, (None, None)) if urdf is None else (urdf, None)
        folders = search_directories(packages)
        file = resolve(known[0], folders, Path("."))
        self.model = pin.buildModelFromUrdf(str(file))
        self.geometry = pin.buildGeomFromUrdf(
            self.model, str(file), pin.GeometryType.COLLISION, package_dirs=[str(folder) for folder in folders])
        self.geometry.addAllCollisionPairs()
        if srdf or known[1]:
            pin.removeCollisionPairs(self.model, self.geometry, str(resolve(srdf or known[1], folders, Path("."))))
        self.data = self.model.createData()
        self.moving = [i for i, shape in enumerate(self.geometry.geometryObjects) if shape.parentJoint != 0]

    def column(self, joint: str) -> int | None:
        """Where a joint's value stands in a configuration; none where it is fixed in the description."""
        if not self.model.existJointName(joint):
            return None
        number = self.model.getJointId(joint)
        if self.model.nqs[number] != 1:
            raise ProblemsError(f"joint {joint} has {self.model.nqs[number]} numbers")
        return self.model.idx_qs[number]


class World:
    """A problem. `joints` are planned, a state is their values; `low` and `high` are their bounds."""

    def __init__(self, robot: Robot, problem: Problem):
        self.robot = robot
        self.joints = list(problem.goal)
        self.columns = [robot.column(joint) for joint in self.joints]
        if None in self.columns:
            raise ProblemsError(f"{problem.set} {problem.index}: the robot has no joint {self.joints[self.columns.index(None)]}")
        model = robot.model
        self.low, self.high = model.lowerPositionLimit[self.columns], model.upperPositionLimit[self.columns]
        self.base = np.array(pin.neutral(model))
        for joint, value in problem.start.items():
            if (column := robot.column(joint)) is not None:
                self.base[column] = np.clip(value, model.lowerPositionLimit[column], model.upperPositionLimit[column])
        self.start = self._within([problem.start[joint] for joint in self.joints])
        self.goal = self._within([problem.goal[joint] for joint in self.joints])
        self.geometry = robot.geometry.copy()
        for obstacle in problem.obstacles:
            number = self.geometry.addGeometryObject(_shape(obstacle))
            for moving in robot.moving:
                self.geometry.addCollisionPair(pin.CollisionPair(moving, number))
        self.geometry_data = self.geometry.createData()

    def _within(self, values: list[float]) -> np.ndarray:
        given = np.array(values)
        nearest = np.clip(given, self.low, self.high)
        return np.where(np.abs(nearest - given) <= ROUNDED, nearest, given)

    def whole(self, state) -> np.ndarray:
        q = self.base.copy()
        q[self.columns] = state
        return q

    def collides(self, state) -> bool:
        """Whether any pair of shapes overlaps, by coal; a mesh is its surface."""
        robot = self.robot
        return pin.computeCollisions(robot.model, robot.data, self.geometry, self.geometry_data, self.whole(state), True)

    def valid(self, state) -> bool:
        return bool(np.all(state >= self.low) and np.all(state <= self.high)) and not self.collides(state)

    def beyond(self, state) -> float:
        """How far the state is out of its bounds (rad or m)."""
        return float(max(np.max(self.low - state), np.max(state - self.high), 0.0))

    def nearest(self, state) -> tuple[float, str]:
        """The least distance (m) of a pair, and its names; below zero by the depth where coal tells one."""
        robot = self.robot
        pin.computeDistances(robot.model, robot.data, self.geometry, self.geometry_data, self.whole(state))
        results = self.geometry_data.distanceResults
        distances = [result.min_distance for result in results]
        least = int(np.argmin(distances))
        pair = self.geometry.collisionPairs[least]
        names = [self.geometry.geometryObjects[i].name for i in (pair.first, pair.second)]
        return distances[least], " and ".join(names)


def _shape(obstacle: Obstacle) -> pin.GeometryObject:
    if obstacle.kind == "box":
        solid = coal.Box(*obstacle.sizes)
    elif obstacle.kind == "cylinder":
        length, radius = obstacle.sizes
        solid = coal.Cylinder(radius, length)
    else:
        solid = coal.Sphere(obstacle.sizes[0])
    turn = pin.Quaternion(np.array(obstacle.quaternion)).toRotationMatrix()
    return pin.GeometryObject(f"obstacle {obstacle.name}", 0, pin.SE3(turn, np.array(obstacle.xyz)), solid)


__all__ = ["InputError", "Robot", "World"]
