"""One solve of HPP, then every one of its path optimisers on that same path, each in a child of its own.

    hpp_improve.py SCENE.toml SOLVER SEED LIMIT_S OPTIMISE_S RATES.json FOLDER [--splines]

LIMIT_S is processor time for the solve, OPTIMISE_S for each optimiser; `--splines` has the gradient-based ones too. `RATES.json` has the limits of velocity and acceleration of the scene's coordinates (`rate_limits` of a path file of
Foliate). Tells JSON lines on standard output: the solve (`method` is `first`), then one for each optimiser. Paths lie in
FOLDER as `METHOD.npz`. A child that crashes or runs out of time costs its own line only.
"""

from __future__ import annotations

import ctypes
import json
import os
import resource
import sys
import time
import traceback
from pathlib import Path

import numpy as np

from watch import watch

MEMORY_BYTES = 8 << 30
SAMPLING_S = 300.0
"""Processor time for writing a path down and timing it, which is not part of the optimisation."""
LOOPS = "PathOptimization/RandomShortcut/NumberOfLoops"
NOTHING = 1e-9
"""Sub-paths that are shorter are left out before HPP's own timing, which they end with an exception."""


def optimisers(manipulates: bool, splines: bool) -> dict[str, list[tuple[str, str, int]]]:
    """Method: what is applied one after the other (module, class, loops; 0: HPP's default, which is 5)."""
    module = "manipulation" if manipulates else "core"
    simple = ("core", "SimpleShortcut", 0)
    methods = {
        "RandomShortcut": [(module, "RandomShortcut", 0)],
        "RandomShortcut, 25 loops": [(module, "RandomShortcut", 25)],
        "SimpleShortcut": [simple],
        "SimpleShortcut, RandomShortcut": [simple, (module, "RandomShortcut", 0)],
        "PartialShortcut": [("core", "PartialShortcut", 0)],
    }
    if manipulates:
        methods["Graph-RandomShortcut"] = [("manipulation", "GraphRandomShortcut", 0)]
        methods["Graph-PartialShortcut"] = [("manipulation", "GraphPartialShortcut", 0)]
    if splines:
        for name in ("SplineGradientBased_bezier1", "SplineGradientBased_bezier3"):
            methods[name] = [(module, name, 0)]
    return methods


def main() -> int:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    from hpp_graph import HppProblem
    from hpp_problem import HppModel
    from scene_file import SceneError, read_scene
    from settings import SCENES

    file, solver, seed, limit_s, optimise_s, rates, folder = sys.argv[1:8]
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what HPP prints is not an answer

    def tell(message: dict) -> None:
        _tell(answers, message)

    try:
        scene = read_scene(Path(file))
        problem = HppProblem(HppModel(scene), SCENES[scene.name])
    except SceneError as error:
        tell({"error": str(error)})
        return 2
    limits = json.loads(Path(rates).read_text(encoding="utf-8"))
    _limit_velocities(problem.model, limits)
    planner = problem.planner(solver)
    ctypes.CDLL(None).srand(int(seed))
    used = time.process_time()
    resource.setrlimit(resource.RLIMIT_CPU, (int(used + float(limit_s)) + 1, resource.RLIM_INFINITY))
    try:
        path = planner.solve()
    except Exception as error:  # HPP tells by an exception that it gave up
        tell({"method": "first", "outcome": "failed", "cpu_s": time.process_time() - used, "reason": str(error)[-300:]})
        return 0
    first = {"method": "first", "outcome": "solved", "cpu_s": time.process_time() - used}
    resource.setrlimit(resource.RLIMIT_CPU, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    tell(first | _written(problem, path, limits, Path(folder) / "first.npz"))
    for method, steps in optimisers(scene.manipulates, "--splines" in sys.argv).items():
        tell({"method": method} | _in_child(problem, path, steps, limits, float(optimise_s), Path(folder) / f"{method}.npz"))
    return 0


def _tell(pipe, message: dict) -> None:
    pipe.write(json.dumps(message) + "\n")
    pipe.flush()


def _in_child(problem, path, steps, limits: dict, limit_s: float, file: Path) -> dict:
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        try:
            with os.fdopen(writing, "w") as pipe:
                _optimise(problem, path, steps, limits, file, lambda told: _tell(pipe, told))
        except BaseException:
            traceback.print_exc()
        finally:  # the child must never go on as its parent
            os._exit(0)
    os.close(writing)
    return watch(child, reading, limit_s, SAMPLING_S)


def _optimise(problem, path, steps, limits: dict, file: Path, tell) -> None:
    import pyhpp.core
    import pyhpp.manipulation

    modules = {"core": pyhpp.core, "manipulation": pyhpp.manipulation}
    used = time.process_time()
    try:
        for module, name, loops in steps:
            if loops:
                problem.problem.setParameter(LOOPS, loops)
            path = getattr(modules[module], name)(problem.problem).optimize(path)
    except Exception as error:
        tell({"outcome": "failed", "cpu_s": time.process_time() - used, "reason": f"{type(error).__name__}: {error}"[:200]})
        return
    tell({"outcome": "solved", "cpu_s": time.process_time() - used})
    tell(_written(problem, path, limits, file))


def _written(problem, path, limits: dict, file: Path) -> dict:
    from hpp_answer import write_answer

    told = write_answer(problem.model, path, file)
    return told | _own_timing(problem, path, file, limits)


def _own_timing(problem, path, file: Path, limits: dict) -> dict:
    """HPP's `SimpleTimeParameterization` of order 2: rests at both ends of every sub-path. It has one limit of acceleration
    for all joints: the smallest of those that move keeps them all."""
    import pyhpp.core

    with np.load(file) as stored:
        moved = np.ptp(stored["configurations"], axis=0) > 1e-6
    names = [name for name, moves in zip(problem.model.scene.coordinates, moved) if moves]
    robots = {part.name for part in problem.model.scene.parts if part.kind == "robot"}
    of_robots = [limits[name]["acceleration"] for name in names if name.split("/")[0] in robots and name in limits]
    try:
        timing = pyhpp.core.SimpleTimeParameterization(problem.problem)
        timing.order, timing.safety, timing.maxAcceleration = 2, 1.0, min(of_robots)
        used = time.process_time()
        timed = timing.optimize(_without_rests(path))
    except Exception as error:
        return {"own_reason": f"{type(error).__name__}: {error}"[:200]}
    return {"own_s": float(timed.length()), "own_cpu_s": time.process_time() - used}


def _without_rests(path):
    import pyhpp.core

    flat = type(path)(path.outputSize(), path.outputDerivativeSize())
    for rank in range(path.numberPaths()):
        piece = path.pathAtRank(rank)
        if piece.length() > NOTHING:
            flat.appendPath(piece)
    return flat


def _limit_velocities(model, limits: dict) -> None:
    """The scene's limits of velocity instead of the URDFs', and where HPP has none (roots)."""
    for (first, count), name in zip(model.columns, model.scene.coordinates):
        if name not in limits or count != 1:
            continue
        joint = next(j for j in range(model.model.njoints)
                     if model.model.idx_qs[j] <= first < model.model.idx_qs[j] + model.model.nqs[j])
        offset = first - model.model.idx_qs[joint]
        turns = model.model.nqs[joint] == 7 and offset >= 3
        for row in ([3, 4, 5] if turns else [offset]):
            model.model.velocityLimit[model.model.idx_vs[joint] + row] = limits[name]["velocity"] * (2.0 if turns else 1.0)


if __name__ == "__main__":
    sys.exit(main())
