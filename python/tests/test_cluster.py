"""Batches over processes: every problem has one row, whatever happens to its process."""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

import foliate
from foliate.cluster import Problem, rows, run
from foliate.cluster.parts import chunks, in_shard


def problems(count: int) -> list[Problem]:
    return [Problem("demo", settings={"seed": seed, "first": True}) for seed in range(1, count + 1)]


def sorted_rows(out: Path) -> list[dict[str, Any]]:
    return sorted(rows(out), key=lambda row: str(row["identity"]))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("batch")
    told: list[int] = []
    assert run(problems(12), out, chunk=5, threads=2, progress=told.append) == {"solved": 12}
    assert told[-1] == 12
    return out


def test_problems_are_plain_data_with_an_identity() -> None:
    builder = foliate.SceneBuilder("cell")
    builder.add_robot("package://foliate_scenes/demo/robot.urdf", srdf="package://foliate_scenes/demo/robot.srdf", grippers=None, start="ready")
    builder.add_box("box", [0.05, 0.05, 0.08], pose=[0.5, 0.2, 0.8], surfaces=None)
    builder.add_goal(objects={"box": [0.5, 0.3, 0.8]})
    one = Problem(builder.document, start={"box": [0.5, 0.1, 0.8, 0, 0, 0, 1]})
    again = pickle.loads(pickle.dumps(one))
    assert again.identity == one.identity and again.load().start("box")[1] == 0.1
    assert Problem("demo").identity != Problem("demo", settings={"seed": 2}).identity
    assert Problem("demo", goal={"box1": [0.5, 0, 0.741, 0, 0, 0, 1]}).identity != Problem("demo").identity


def test_what_takes_longest_is_begun_first() -> None:
    begun = [int(problem.settings["seed"]) for part in chunks(problems(7), 3, set(), (0, 1), lambda problem: float(problem.settings["seed"]) % 4) for problem in part]
    assert begun == [3, 7, 2, 6, 1, 5, 4]


def test_rows_say_how_each_ended(whole: Path, tmp_path: Path) -> None:
    for row in rows(whole):
        answer = foliate.solve(foliate.Scene("demo"), seed=row["seed"], first=True)
        assert row["fingerprint"] == f"{answer.report.fingerprint:016x}" and row["segments"] == len(answer.path)
    far = Problem("demo", goal={"box1": [9, 0, 0.741, 0, 0, 0, 1]})
    broken = Problem("no_such_scene.toml")
    assert run([far, broken], tmp_path, paths=True) == {"infeasible_goal": 1, "unreadable": 1}
    assert {row["outcome"]: row["detail"] is not None for row in rows(tmp_path)} == {"infeasible_goal": True, "unreadable": True}


def test_what_is_finished_is_not_done_again(whole: Path) -> None:
    before = {file.name: file.stat().st_mtime_ns for file in (whole / "parts").iterdir()}
    assert run(problems(12), whole, chunk=5) == {}
    assert {file.name: file.stat().st_mtime_ns for file in (whole / "parts").iterdir()} == before
    # A problem that comes twice has one row.
    assert run(problems(13) + problems(13), whole) == {"solved": 1}
    assert len(list(rows(whole))) == 13


def test_shards_make_the_rows_of_the_whole(whole: Path, tmp_path: Path) -> None:
    counts = [run(problems(12), tmp_path, shard=(number, 3), chunk=4).get("solved", 0) for number in range(3)]
    assert sum(counts) == 12 and sum(count > 0 for count in counts) > 1
    wanted = [row for row in sorted_rows(whole) if row["seed"] <= 12]
    assert sorted_rows(tmp_path) == wanted
    assert all(sum(in_shard(str(row["identity"]), (number, 3)) for number in range(3)) == 1 for row in wanted)
    with pytest.raises(ValueError, match="shard"):
        run([], tmp_path, shard=(3, 3))


KILLED = """
import sys
from foliate.cluster import Problem, run
problems = (Problem("demo", settings={"seed": seed, "first": True}) for seed in range(1, 13))
run(problems, sys.argv[1], chunk=2, threads=1, progress=lambda count: print(count, flush=True))
"""


def test_a_batch_that_was_killed_goes_on(whole: Path, tmp_path: Path) -> None:
    program = subprocess.Popen([sys.executable, "-c", KILLED, str(tmp_path)], stdout=subprocess.PIPE, text=True)
    assert program.stdout is not None and program.stdout.readline() == "2\n"
    program.kill()
    program.wait()
    left = run(problems(12), tmp_path, chunk=2)
    assert left.get("solved", 0) + 2 <= 12
    assert sorted_rows(tmp_path) == [row for row in sorted_rows(whole) if row["seed"] <= 12]


class Bad(Problem):
    """A problem that ends its process, or never ends."""

    def load(self) -> foliate.Scene:
        what: Mapping[str, Any] = self.start
        if "abort" in what:
            os.abort()
        time.sleep(3600)
        raise AssertionError


RAY = """
import sys
import ray
from foliate.cluster import Problem
from foliate.cluster.ray import run
ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
problems = [Problem("demo", settings={"seed": seed, "first": True}) for seed in range(1, 201)]
run(problems, sys.argv[1], chunk=10, progress=lambda count: print(count, flush=True))
"""


@pytest.mark.skipif(os.environ.get("FOLIATE_SLOW") is None, reason="slow: FOLIATE_SLOW=1 runs it")
def test_ray_loses_no_row(tmp_path: Path) -> None:
    ray = pytest.importorskip("ray")
    from foliate.cluster.ray import run as run_on_ray

    program = subprocess.Popen([sys.executable, "-c", RAY, str(tmp_path / "ray")], stdout=subprocess.PIPE, text=True)
    assert program.stdout is not None and program.stdout.readline()
    program.kill()
    program.wait()
    here = str(Path(__file__).resolve().parent)
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, runtime_env={"env_vars": {"PYTHONPATH": f"{here}:{os.environ.get('PYTHONPATH', '')}"}})
    try:
        bad = [Bad("demo", start={"abort": 1}), Bad("demo", start={"sleep": 1})]
        everything = [*problems(200)[:50], *bad, *problems(200)[50:]]
        outcomes = run_on_ray(everything, tmp_path / "ray", chunk=10, timeout_s=15.0)
    finally:
        ray.shutdown()
    assert outcomes["crashed"] == 1 and outcomes["timeout"] == 1 and outcomes["solved"] < 200
    run(problems(200), tmp_path / "local", threads=1)
    told = {row["identity"]: json.dumps(row, sort_keys=True) for row in rows(tmp_path / "ray")}
    wanted = {row["identity"]: json.dumps(row, sort_keys=True) for row in rows(tmp_path / "local")}
    assert len(told) == 202 and all(told[identity] == row for identity, row in wanted.items())
