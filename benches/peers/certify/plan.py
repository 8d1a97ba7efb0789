#!/usr/bin/env python3
"""Let a peer plan, and keep its answers as it writes them.

    plan.py PEER --out DIR [--count N] [--seed S] [--scenes NAME ...] [--time-limit S]

PEER is `ompl`, `roboplan` or `hpp`, each with its default resolution of collision tests. The queries of a scene are its own
start and goal, and pairs of random valid configurations; the same for every peer. Answers go to DIR/SCENE/NUMBER.txt, one
state a line (`foliate certify` reads them as path matrices); a query that has no answer in time is skipped. A call that was
interrupted goes on where it was.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

from world import SCENE_NAMES, World


class Ompl:
    """RRT-Connect, then the default simplification; states are tested by pinocchio and coal at OMPL's default resolution
    (a hundredth of the space's extent)."""

    def __init__(self, world: World, seed: int):
        from ompl import base, geometric, util

        util.setLogLevel(util.LogLevel.LOG_NONE)
        util.RNG.setSeed(seed)
        self.world, self.base, self.geometric = world, base, geometric
        self.space = base.RealVectorStateSpace(len(world.joints))
        bounds = base.RealVectorBounds(len(world.joints))
        for index, (low, high) in enumerate(zip(world.low, world.high)):
            bounds.setLow(index, float(low))
            bounds.setHigh(index, float(high))
        self.space.setBounds(bounds)

    def plan(self, start, goal, limit: float, number: int):
        world = self.world
        setup = self.geometric.SimpleSetup(self.space)
        size = len(world.joints)
        setup.setStateValidityChecker(lambda state: world.valid(np.array([state[i] for i in range(size)])))
        first, last = self.space.allocState(), self.space.allocState()
        for index in range(size):
            first[index], last[index] = float(start[index]), float(goal[index])
        setup.setStartAndGoalStates(first, last)
        setup.setPlanner(self.geometric.RRTConnect(setup.getSpaceInformation()))
        setup.solve(limit)
        if not setup.haveExactSolutionPath():
            return None
        setup.simplifySolution()
        states = setup.getSolutionPath().getStates()
        return np.array([[state[i] for i in range(size)] for state in states])


class Roboplan:
    """Its RRT as it comes (`RRTOptions`: collision tests every 0.05 of configuration space, by bisection), with
    `rrt_connect`; then its `PathShortcutter` as it comes."""

    def __init__(self, world: World, seed: int):
        from roboplan import core, rrt

        self.world, self.core, self.rrt = world, core, rrt
        description = core.loadUrdfSceneDescriptionFromXml(world.urdf, world.package_directories)
        self.scene = core.Scene(world.name, description)
        self.scene.importSrdf(world.srdf)
        self.scene.setRngSeed(seed)
        self.group = "arm"
        self.scene.addGroupFromChain(self.group, "panda_link0", "panda_link8")
        self.seed = seed

    def plan(self, start, goal, limit: float, number: int):
        options = self.rrt.RRTOptions(
            group_name=self.group, rrt_connect=True, max_planning_time=limit, max_nodes=20000)
        planner = self.rrt.RRT(self.scene, options)
        planner.setRngSeed(self.seed + number)
        whole = dict(zip(self.world.model.names[1:], self.world.whole(start)))
        self.scene.setJointPositions(np.array([whole[joint] for joint in self.scene.getJointNames()]))
        configuration = self.core.JointConfiguration
        try:
            path = planner.plan(configuration(self.world.joints, start), configuration(self.world.joints, goal))
        except RuntimeError:
            return None
        options = self.core.PathShortcuttingOptions(group_name=self.group)
        path = self.core.PathShortcutter(self.scene, options).shortcut(path)
        names = list(path.joint_names)
        columns = [names.index(joint) for joint in self.world.joints]
        return np.array([np.array(position)[columns] for position in path.positions])


class Hpp:
    """BiRRT with the default path validation (`Discretized`, every 0.05), then `RandomShortcut`."""

    def __init__(self, world: World, seed: int):
        import ctypes

        import pyhpp.core
        import pyhpp.pinocchio
        import pyhpp.pinocchio.urdf

        ctypes.CDLL(None).srand(seed)
        self.world, self.hpp = world, pyhpp
        self.device = pyhpp.pinocchio.Device(world.name)
        pyhpp.pinocchio.urdf.loadModelFromString(self.device, 0, "", "anchor", world.urdf, world.srdf, _identity())
        self.model = self.device.model()
        self.columns = [self.model.idx_qs[self.model.getJointId(joint)] for joint in world.joints]
        self.base = np.array(_neutral(self.model))
        for finger in ("panda_finger_joint1", "panda_finger_joint2"):
            joint = self.model.getJointId(finger)
            if joint < self.model.njoints:
                self.base[self.model.idx_qs[joint]] = 0.04
                self.device.setJointBounds(finger, [0.04, 0.04])

    def _whole(self, state):
        q = self.base.copy()
        q[self.columns] = state
        return q

    def plan(self, start, goal, limit: float, number: int):
        core = self.hpp.core
        problem = core.Problem(self.device)
        problem.clearConfigValidations()
        problem.addConfigValidation("CollisionValidation")
        problem.addConfigValidation("JointBoundValidation")
        problem.steeringMethod(core.Straight(problem))
        problem.initConfig(self._whole(start))
        problem.addGoalConfig(self._whole(goal))
        planner = core.BiRRTPlanner(problem)
        planner.timeOut(limit)
        try:
            path = planner.solve()
        except RuntimeError:
            return None
        path = core.RandomShortcut(problem).optimize(path)
        # Every part is a straight way: its ends are the knots.
        knots = [path.initial()]
        for rank in range(path.numberPaths()):
            knots.append(path.pathAtRank(rank).end())
        return np.array([np.array(knot)[self.columns] for knot in knots])


def _identity():
    import pinocchio

    return pinocchio.SE3.Identity()


def _neutral(model):
    import pinocchio

    return pinocchio.neutral(model)


PEERS = {"ompl": Ompl, "roboplan": Roboplan, "hpp": Hpp}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("peer", choices=PEERS)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--count", type=int, default=250, help="answers of each scene")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenes", nargs="+", default=list(SCENE_NAMES))
    parser.add_argument("--time-limit", type=float, default=5.0, help="seconds for a query")
    arguments = parser.parse_args()
    for name in arguments.scenes:
        world = World(name)
        folder = arguments.out / name
        folder.mkdir(parents=True, exist_ok=True)
        peer = PEERS[arguments.peer](world, arguments.seed)
        begin, answers, missed = time.monotonic(), len(list(folder.glob("*.txt"))), 0
        for number, (start, goal) in enumerate(world.queries(2 * arguments.count, arguments.seed)):
            file, none = folder / f"{number:04}.txt", folder / f"{number:04}.none"
            if answers >= arguments.count:
                break
            if file.exists() or none.exists():
                continue
            states = peer.plan(start, goal, arguments.time_limit, number)
            if states is None:
                none.touch()
                missed += 1
                continue
            answers += 1
            np.savetxt(file, states, fmt="%.17g")
        print(f"{arguments.peer} {name}: {answers} answers, {missed} queries without, "
              f"{time.monotonic() - begin:.0f} s", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
