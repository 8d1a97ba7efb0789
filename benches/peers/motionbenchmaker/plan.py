#!/usr/bin/env python3
"""Let a peer solve the problems, one thread, first paths, and print the columns of Foliate's program.

    plan.py FILE.json[.gz] --peer ompl|vamp [--urdf NAME --srdf NAME --packages DIR] [--sets A,B] [--every N] [--seed N] [--time-limit S] [--csv FILE]

`ompl`: RRT-Connect with its default settings; states are tested by pinocchio and coal on the robot's meshes, motions at OMPL's default resolution (a
hundredth of the space's extent). Wall time of the solve. `vamp`: RRT-Connect as its scripts set it; the robot is VAMP's spheres, cylinders are
capsules (boxes in the set `box`, as in its scripts), motions are tested at its own resolution. Its own clock, without the environment. Neither
certifies its answers.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

from options import options
from problems import GOAL, SOLVED, START, Obstacle, Problem, ProblemsError, Row, csv, read, table

ITERATIONS = 1_000_000
"""Of VAMP's search, and samples: as in its scripts."""


class Ompl:
    def __init__(self, name: str, given):
        from ompl import base, geometric, util
        from robot_world import Robot

        util.setLogLevel(util.LogLevel.LOG_NONE)
        util.RNG.setSeed(given.seed)
        self.base, self.geometric, self.limit = base, geometric, given.time_limit
        self.robot = Robot(name, given.urdf, given.srdf, given.packages)

    def solve(self, problem: Problem) -> tuple[str, float]:
        from robot_world import World

        world = World(self.robot, problem)
        if not world.valid(world.start):
            return START, 0.0
        if not world.valid(world.goal):
            return GOAL, 0.0
        size = len(world.joints)
        space = self.base.RealVectorStateSpace(size)
        bounds = self.base.RealVectorBounds(size)
        for index, (low, high) in enumerate(zip(world.low, world.high)):
            bounds.setLow(index, float(low))
            bounds.setHigh(index, float(high))
        space.setBounds(bounds)
        setup = self.geometric.SimpleSetup(space)
        setup.setStateValidityChecker(lambda state: world.valid(np.array([state[i] for i in range(size)])))
        first, last = space.allocState(), space.allocState()
        for index in range(size):
            first[index], last[index] = float(world.start[index]), float(world.goal[index])
        setup.setStartAndGoalStates(first, last)
        setup.setPlanner(self.geometric.RRTConnect(setup.getSpaceInformation()))
        setup.setup()
        begun = time.perf_counter()
        setup.solve(self.limit)
        seconds = time.perf_counter() - begun
        return (SOLVED if setup.haveExactSolutionPath() else "timeout"), seconds


class Vamp:
    def __init__(self, name: str, given):
        import vamp

        if name not in vamp.robots:
            raise ProblemsError(f"VAMP has no robot {name}; it has {', '.join(vamp.robots)}")
        self.vamp = vamp
        self.robot, self.plan, self.settings, _ = vamp.configure_robot_and_planner_with_kwargs(name, "rrtc")
        self.settings.max_iterations = self.settings.max_samples = ITERATIONS
        self.joints = self.robot.joint_names()
        self.skipped = 1000 * (given.seed - 1)

    def solve(self, problem: Problem) -> tuple[str, float]:
        environment = self.vamp.Environment()
        for obstacle in problem.obstacles:
            self._add(environment, obstacle, problem.set == "box")
        start, goal = (np.array([end[joint] for joint in self.joints], dtype=np.float32) for end in (problem.start, problem.goal))
        if not self.robot.validate(start, environment):
            return START, 0.0
        if not self.robot.validate(goal, environment):
            return GOAL, 0.0
        # Its random numbers have no seed but a place in their sequence.
        random = self.robot.halton()
        random.skip(self.skipped)
        result = self.plan(start, goal, environment, self.settings, random)
        return (SOLVED if result.solved else "gave up"), result.nanoseconds / 1e9

    def _add(self, environment, obstacle: Obstacle, as_box: bool) -> None:
        vamp, turn = self.vamp, _roll_pitch_yaw(obstacle.quaternion)
        if obstacle.kind == "box":
            environment.add_cuboid(vamp.Cuboid(obstacle.xyz, turn, [size / 2.0 for size in obstacle.sizes]))
        elif obstacle.kind == "sphere":
            environment.add_sphere(vamp.Sphere(obstacle.xyz, obstacle.sizes[0]))
        elif as_box:
            length, radius = obstacle.sizes
            environment.add_cuboid(vamp.Cuboid(obstacle.xyz, turn, [radius, radius, length / 2.0]))
        else:
            length, radius = obstacle.sizes
            environment.add_capsule(vamp.Cylinder(obstacle.xyz, turn, radius, length))


def _roll_pitch_yaw(quaternion) -> list[float]:
    x, y, z, w = quaternion
    return [float(np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))),
            float(np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))),
            float(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))]


PEERS = {"ompl": Ompl, "vamp": Vamp}


def main() -> int:
    parser = options(__doc__)
    parser.add_argument("--peer", choices=PEERS, default="ompl")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--time-limit", type=float, default=10.0, metavar="S", help="of OMPL's search; VAMP counts iterations")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="a line per problem")
    given = parser.parse_args()
    try:
        name, problems = read(given.file, given.sets, given.every)
        peer = PEERS[given.peer](name, given)
        rows = [Row(problem.set, problem.index, *peer.solve(problem)) for problem in problems]
        if given.csv:
            given.csv.write_text(csv(rows))
    except (ProblemsError, ImportError, OSError, KeyError) as error:
        print(f"error: {error!r}" if isinstance(error, KeyError) else f"error: {error}", file=sys.stderr)
        return 2
    print(table(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
