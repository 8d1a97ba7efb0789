#!/usr/bin/env python3
"""Plain motion planning: paths of OMPL, VAMP and Foliate on the Panda scenes, before and after each one's simplification.

    plain.py run --foliate PROGRAM --commit ID [--planners ompl ompl-fine vamp foliate] [--scenes NAME ...] [--seeds 10]
    plain.py table

`run` appends to `results/plain.csv`, the planners in turns, and goes on where an earlier call ended. Every path is measured in the
same way: Euclidean length in radians of the seven joints; time with rest at every corner under the scene's limits, and the planner's
own time where it gives one; samples every 2 mm tested by pinocchio and coal on the published meshes.
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
import resource
import signal
import sys
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median

import numpy as np

import improve_file
from improve_file import FIRST, FOLIATE, SOLVED, Improved
from motion_measure import corners, length, limits_of, read_motion, stopping_time
from peers import RESULTS, WORK, machine
from rows import ResultsError
from solvers import SCENES_FOLDER, SolverError, foliate_version, solve_with_foliate

sys.path.insert(0, str(Path(__file__).resolve().parent / "certify"))
OMPL, OMPL_FINE, VAMP = "ompl", "ompl-fine", "vamp"
PLANNERS = (OMPL, OMPL_FINE, VAMP, FOLIATE)
FINE = 1e-3
"""Resolution of OMPL's motion tests in `ompl-fine`, a share of the space's extent; its default is 0.01."""
SCENE_NAMES = ("panda-table", "panda-shelf", "panda-box", "panda-cage")
LIMIT_S = 60.0
CHILD_S = 30
"""Seconds for a search, and processor time for search and simplifications together."""
SAMPLE = 2e-3
"""No point of any body moves farther (m) between samples that are tested."""
ITERATIONS = 20000
"""Of VAMP's search, and samples; its scripts have a million."""
SKIPPED = 1000
"""Samples of VAMP's Halton sequence that lie between two seeds: its random numbers have no seed."""
BELOW = 0.021
"""VAMP's spheres of the fixed base reach 3 cm below the ground, so for VAMP the floors of the scenes (1 cm below) lie lower (m)."""
OURS = {FIRST: ["--first"], "0.02 s": ["--improve-time", 0.02], "0.1 s": ["--improve-time", 0.1], "default": []}


def ompl_paths(world, seed: int, resolution: float | None = None) -> Iterator[dict]:
    """RRT-Connect as it comes, states tested by pinocchio and coal; `simplifyMax`, once and ten times. `resolution` of motion
    tests, None for OMPL's default."""
    from ompl import base, geometric, util

    util.setLogLevel(util.LogLevel.LOG_NONE)
    util.RNG.setSeed(seed)
    size = len(world.joints)
    space = base.RealVectorStateSpace(size)
    bounds = base.RealVectorBounds(size)
    for index, (low, high) in enumerate(zip(world.low, world.high)):
        bounds.setLow(index, float(low))
        bounds.setHigh(index, float(high))
    space.setBounds(bounds)
    if resolution is not None:
        space.setLongestValidSegmentFraction(resolution)
    setup = geometric.SimpleSetup(space)
    setup.setStateValidityChecker(lambda state: world.valid(np.array([state[i] for i in range(size)])))
    first, last = space.allocState(), space.allocState()
    for index in range(size):
        first[index], last[index] = float(world.start[index]), float(world.goal[index])
    setup.setStartAndGoalStates(first, last)
    setup.setPlanner(geometric.RRTConnect(setup.getSpaceInformation()))
    used = time.process_time()
    setup.solve(LIMIT_S)
    seconds = time.process_time() - used
    if not setup.haveExactSolutionPath():
        yield {"method": FIRST, "outcome": "timeout", "seconds": seconds}
        return
    states = lambda path: [[state[i] for i in range(size)] for state in path.getStates()]  # noqa: E731
    path = setup.getSolutionPath()
    yield {"method": FIRST, "outcome": SOLVED, "seconds": seconds, "states": states(path)}
    simplifier = geometric.PathSimplifier(setup.getSpaceInformation())
    for method, times in (("simplifyMax", 1), ("simplifyMax, 10 times", 10)):
        copy = geometric.PathGeometric(path)
        used = time.process_time()
        for _ in range(times):
            simplifier.simplifyMax(copy)
        yield {"method": method, "outcome": SOLVED, "seconds": time.process_time() - used, "states": states(copy)}


def vamp_paths(world, seed: int) -> Iterator[dict]:
    """RRT-Connect and `simplify` with the settings of its own scripts (5 rounds of shortcuts and B-splines), and with 100 rounds. The
    robot is its spheres, a cylinder a capsule, and the floor lies lower."""
    import vamp

    robot, plan, settings, simplification = vamp.configure_robot_and_planner_with_kwargs("panda", "rrtc")
    settings.max_iterations = settings.max_samples = ITERATIONS
    environment = vamp.Environment()
    for kind, centre, turn, sizes in obstacles(world.name):
        if kind == "box":
            centre = lowered(centre, sizes)
            environment.add_cuboid(vamp.Cuboid(centre, turn, [size / 2.0 for size in sizes]))
        elif kind == "cylinder":
            environment.add_capsule(vamp.Cylinder(centre, turn, sizes[0], sizes[1]))
        else:
            environment.add_sphere(vamp.Sphere(centre, sizes[0]))
    start, goal = (state.astype(np.float32) for state in (world.start, world.goal))
    for name, state in (("start", start), ("goal", goal)):
        if not robot.validate(state, environment):
            yield {"method": FIRST, "outcome": "failed", "seconds": 0.0, "reason": f"its spheres collide in the {name}"}
            return
    random = robot.halton()
    random.skip(SKIPPED * (seed - 1))
    result = plan(start, goal, environment, settings, random)
    if not result.solved:
        yield {"method": FIRST, "outcome": "failed", "seconds": result.nanoseconds / 1e9, "reason": "gave up"}
        return
    yield {"method": FIRST, "outcome": SOLVED, "seconds": result.nanoseconds / 1e9, "states": _states(result.path)}
    long = vamp.SimplifySettings()
    long.max_iterations = 100
    for method, chosen in (("simplify", simplification), ("simplify, 100 rounds", long)):
        simple = robot.simplify(result.path, environment, chosen, random)
        yield {"method": method, "outcome": SOLVED, "seconds": simple.nanoseconds / 1e9, "states": _states(simple.path)}


def _states(path) -> list[list[float]]:
    return [[float(number) for number in path[index]] for index in range(len(path))]


def obstacles(scene: str, folder: Path = SCENES_FOLDER) -> list[tuple[str, list[float], list[float], list[float]]]:
    """Kind, centre (m), roll, pitch and yaw (rad), sizes (m) of every obstacle of a scene: sides of a box, radius and length of a
    cylinder, radius of a sphere. Anything else is refused."""
    found = []
    for file in sorted((folder / scene).glob("*.urdf")):
        for shape in ElementTree.parse(file).getroot().iter("collision"):
            origin, geometry = shape.find("origin"), shape.find("geometry")[0]
            place = [_numbers(origin, key) for key in ("xyz", "rpy")]
            keys = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",)}.get(geometry.tag)
            if keys is None:
                raise SolverError(f"{file}: VAMP cannot be told a {geometry.tag}")
            sizes = [float(number) for key in keys for number in geometry.get(key).split()]
            found.append((geometry.tag, *place, sizes))
    return found


def lowered(centre: list[float], sizes: list[float]) -> list[float]:
    """A box below the ground moves down by `BELOW`."""
    under = centre[2] + sizes[2] / 2.0 < 0.0
    return [*centre[:2], centre[2] - BELOW] if under else centre


def _numbers(element, key: str) -> list[float]:
    text = element.get(key) if element is not None else None
    return [float(number) for number in (text or "0 0 0").split()]


PATHS = {OMPL: ompl_paths, OMPL_FINE: lambda world, seed: ompl_paths(world, seed, FINE), VAMP: vamp_paths}


def in_child(work: Callable[[], Iterator[dict]], limit_s: int = CHILD_S) -> list[dict]:
    """What an iterator tells, made in a process of its own: OMPL's seed can be set once in a process, and what does not end within
    `limit_s` of processor time (VAMP's simplification, once in a while) is ended. Then the last entry says so."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.close(reading)
            resource.setrlimit(resource.RLIMIT_CPU, (limit_s, limit_s))
            with os.fdopen(writing, "w") as pipe:
                for told in work():
                    pipe.write(json.dumps(told) + "\n")
                    pipe.flush()
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        told = [json.loads(line) for line in pipe if line.endswith("\n")]
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        after = f"after {told[-1]['method']}" if told else FIRST
        late = os.WTERMSIG(status) in (signal.SIGKILL, signal.SIGXCPU)
        told.append({"method": after, "outcome": "timeout" if late else "crashed", "seconds": float(limit_s) if late else 0.0,
                     "reason": signal.Signals(os.WTERMSIG(status)).name})
    return told


class Run:
    def __init__(self, options: argparse.Namespace):
        from world import World

        self.options, self.file = options, options.results / "plain.csv"
        self.foliate = foliate_version(options.foliate, options.commit)
        self.worlds = {scene: World(scene) for scene in options.scenes}
        self.known = {(row.scene, row.planner, row.seed) for row in improve_file.read(self.file)}

    def all(self) -> None:
        for scene in self.options.scenes:
            for seed in range(1, self.options.seeds + 1):
                for planner in self.options.planners:
                    if (scene, planner, seed) in self.known:
                        continue
                    rows = self._ours(scene, seed) if planner == FOLIATE else self._theirs(scene, planner, seed)
                    for row in rows:
                        improve_file.add(self.file, row)
                        print(scene, seed, planner, row.method, row.outcome, row.seconds, row.length, row.stopping_s, row.own_s,
                              row.verdict, row.reason, flush=True)

    def _rates(self, scene: str) -> tuple[list[str], dict]:
        """Names and limits of the seven joints, as Foliate's path file has them."""
        file = self.options.work / scene / "rates.json"
        if not file.exists():
            solve_with_foliate(self.options.foliate, scene, 1, file, ["--improve-work", 0])
        rates = json.loads(file.read_text())["rate_limits"]
        return [f"panda/{joint}" for joint in self.worlds[scene].joints], rates

    def _theirs(self, scene: str, planner: str, seed: int) -> list[Improved]:
        world, version = self.worlds[scene], peer_version(planner)
        limits = limits_of(*self._rates(scene))
        rows = []
        for told in in_child(lambda: PATHS[planner](world, seed)):
            values = {}
            if told["outcome"] == SOLVED:
                states = np.array(told["states"])
                pieces = corners(states)
                values = {"length": length(states, limits), "stopping_s": stopping_time(pieces, limits), "pieces": len(pieces),
                          "verdict": verdict(world, states)}
            rows.append(self._row(scene, planner, seed, told["method"], version, outcome=told["outcome"],
                                  seconds=told["seconds"], reason=told.get("reason", ""), **values))
        return rows

    def _ours(self, scene: str, seed: int) -> list[Improved]:
        world, rows = self.worlds[scene], []
        names, rates = self._rates(scene)
        for method, words in OURS.items():
            file = self.options.work / scene / f"plain-{seed}-{method.replace(' ', '')}.json"
            told = solve_with_foliate(self.options.foliate, scene, seed, file, words)
            if told["outcome"] != "solved":
                rows.append(self._row(scene, FOLIATE, seed, method, self.foliate, outcome=told["outcome"], seconds=told["cpu_s"]))
                continue
            motion = read_motion(file)
            states = motion.rows[:, [motion.names.index(name) for name in names]]
            limits, first = limits_of(names, rates), method == FIRST
            pieces = corners(states)
            wall = told["solve_ms"] if first else told["improvement"]["ms"] + told["timing_ms"]
            rows.append(self._row(
                scene, FOLIATE, seed, method, self.foliate, outcome=SOLVED, seconds=min(wall / 1000.0, told["cpu_s"]),
                length=length(states, limits), stopping_s=stopping_time(pieces, limits) if first else None,
                own_s=motion.moving_s, pieces=len(pieces) if first else None, verdict=verdict(world, states)))
        return rows

    @staticmethod
    def _row(scene: str, planner: str, seed: int, method: str, version: str, **values) -> Improved:
        empty = dict.fromkeys(("length", "stopping_s", "own_s", "pieces", "grasp_changes"))
        date = datetime.datetime.now().isoformat(timespec="seconds")
        return Improved(**{**empty, "scene": scene, "planner": planner, "solver": "" if planner == FOLIATE else "RRTConnect",
                           "seed": seed, "method": method, "version": version, "verdict": "", "reason": "",
                           "machine": machine(), "date": date, **values})


def verdict(world, states: np.ndarray) -> str:
    for _, state in world.samples(states, SAMPLE):
        if world.collides(state):
            return "collides"
    return "valid"


def peer_version(planner: str) -> str:
    from importlib import metadata

    name = "vamp-planner" if planner == VAMP else "ompl"
    return f"{name} {metadata.version(name)}"


def markdown(rows: list[Improved]) -> str:
    lines = ["| scene | planner | path | paths | length, rad | time, s | step, ms | collide |",
             "| :-- | :-- | :-- | --: | --: | --: | --: | --: |"]
    for scene in SCENE_NAMES:
        for planner in PLANNERS:
            mine = [row for row in rows if (row.scene, row.planner) == (scene, planner)]
            for method in dict.fromkeys(row.method for row in mine):
                some = [row for row in mine if row.method == method]
                lines.append(f"| {scene} | {planner} | {method} | {_line(some)} |")
    return "\n".join(lines)


def _line(rows: list[Improved]) -> str:
    done = [row for row in rows if row.outcome == SOLVED]
    if not done:
        return f"0/{len(rows)} | {rows[0].reason or rows[0].outcome} | – | – | –"
    own = all(row.own_s is not None for row in done)
    times = [row.own_s if own else row.stopping_s for row in done]
    return (f"{len(done)}/{len(rows)} | {median(row.length for row in done):.2f} ({min(row.length for row in done):.2f} to "
            f"{max(row.length for row in done):.2f}) | {median(times):.2f} | {1000.0 * median(row.seconds for row in done):.3g} | "
            f"{sum(row.verdict != 'valid' for row in done)}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("command", choices=("run", "table"))
    parser.add_argument("--foliate", type=Path, default=Path("foliate"), metavar="PROGRAM")
    parser.add_argument("--commit", default="", metavar="ID", help="what the program was built from")
    parser.add_argument("--planners", nargs="+", default=list(PLANNERS), choices=PLANNERS)
    parser.add_argument("--scenes", nargs="+", default=list(SCENE_NAMES), choices=SCENE_NAMES, metavar="NAME")
    parser.add_argument("--seeds", type=int, default=10, help="seeds 1 to this")
    parser.add_argument("--results", type=Path, default=RESULTS, metavar="DIR")
    parser.add_argument("--work", type=Path, default=WORK, metavar="DIR", help="where paths are kept")
    options = parser.parse_args()
    try:
        if options.command == "run":
            Run(options).all()
        else:
            print(markdown(improve_file.read(options.results / "plain.csv")))
    except (ResultsError, SolverError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
