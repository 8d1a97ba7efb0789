"""One scene stated in HPP, and a child process per solve.

    hpp_server.py SCENE.toml

Stating a problem takes HPP up to a minute and a half, a solve must not share a process with another one (a second
planner on one graph crashes), so the problem is stated once and every solve is a fork. Requests are JSON lines on
standard input: `solver`, `seed`, `limit_s` (processor time), `answer` (file for the path); answers are JSON lines on
standard output. A child that is killed answers nothing; its parent tells how it ended.
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

from watch import watch

MEMORY_BYTES = 8 << 30
SAMPLING_S = 300.0
"""Processor time for writing the answer down, which is not part of the solve."""


def main() -> int:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    start = time.process_time()
    from hpp_graph import HppProblem
    from hpp_problem import HppModel
    from scene_file import SceneError, read_scene
    from settings import SCENES

    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what HPP prints is not an answer
    try:
        scene = read_scene(Path(sys.argv[1]))
        problem = HppProblem(HppModel(scene), SCENES[scene.name])
    except SceneError as error:
        _tell(answers, {"error": str(error)})
        return 2
    setup = time.process_time() - start
    _tell(answers, {"ready": True, "setup_s": setup, "pairs": problem.model.pairs, "moved": problem.moved})
    for line in sys.stdin:
        _tell(answers, _solve_in_child(problem, json.loads(line)))
    return 0


def _tell(answers, message: dict) -> None:
    answers.write(json.dumps(message) + "\n")
    answers.flush()


def _solve_in_child(problem, request: dict) -> dict:
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        try:
            with os.fdopen(writing, "w") as pipe:
                _solve(problem, request, lambda told: _tell(pipe, told))
        except BaseException:
            traceback.print_exc()
        finally:  # the child must never return into the loop of its parent
            os._exit(0)
    os.close(writing)
    return watch(child, reading, request["limit_s"], SAMPLING_S)


def _solve(problem, request: dict, tell) -> None:
    """Tells how the solve ended, then writes the answer down and tells about it."""
    planner = problem.planner(request["solver"])
    ctypes.CDLL(None).srand(request["seed"])
    wall, cpu = time.monotonic(), time.process_time()
    path, reason = None, ""
    try:
        path = planner.solve()
    except Exception as error:  # HPP tells by an exception that it gave up
        reason = f"{type(error).__name__}: {error}"[-300:]
    tell({
        "cpu_s": time.process_time() - cpu,
        "wall_s": time.monotonic() - wall,
        "outcome": "failed" if path is None else "solved",
        "reason": reason,
        "nodes": len(planner.roadmap().nodes()),
    })
    if path is not None:
        from hpp_answer import write_answer

        tell(write_answer(problem.model, path, Path(request["answer"])))


if __name__ == "__main__":
    sys.exit(main())
