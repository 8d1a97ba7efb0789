"""Datasets: what is written is what was planned, and others read it."""

from __future__ import annotations

import hashlib
import json
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import foliate
from foliate import dataset

pa = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")
SEEDS = range(1, 6)


def problems() -> Iterator[tuple[foliate.Scene, dict[str, Any]]]:
    scene = foliate.Scene("demo")
    far = scene.with_goal({"box1": [9.0, 0.0, 0.05, 0.0, 0.0, 0.0, 1.0]})
    for seed in SEEDS:
        yield scene, {"seed": seed}
    yield far, {"seed": 99}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("set") / "boxes"
    told: list[int] = []
    result = dataset.make(problems(), out, improve_work=0, threads=2, clearance=True, progress=lambda made: told.append(made.problems))
    assert (result.problems, result.episodes, result.outcomes) == (6, 5, {"solved": 5, "infeasible_goal": 1})
    assert told == [1, 2, 3, 4, 5, 6]
    return out


def read(folder: Path, name: str) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = []
    for file in sorted(folder.glob(name)):
        rows += parquet.read_table(file).to_pylist()
    return rows


def test_frames_are_those_of_the_paths(made: Path) -> None:
    info = json.loads((made / "meta" / "info.json").read_text())
    named = json.loads((made / "meta" / "annotations.json").read_text())
    frames = read(made, "data/*/*.parquet")
    assert info["codebase_version"] == "v3.0" and info["total_frames"] == len(frames) and info["total_episodes"] == 5
    assert set(frames[0]) == set(info["features"])
    for episode, seed in enumerate(SEEDS):
        path = foliate.solve(foliate.Scene("demo"), seed=seed, improve_work=0).path
        rows = [row for row in frames if row["episode_index"] == episode]
        assert np.allclose([row["observation.clearance"] for row in rows], path.clearances(path.times(30)[0] + np.arange(len(rows)) / 30), atol=1e-6)
        times = np.array([row["timestamp"] for row in rows])
        assert np.allclose(times, np.arange(len(rows)) / 30, atol=1e-5) and path.duration is not None
        assert path.duration <= times[-1] + 1e-5 < path.duration + 1 / 30 + 1e-4
        wanted = path.configurations(times)
        names = info["features"]["observation.state"]["names"]
        columns = [path.coordinates.index(name) for name in names if not name.endswith("/closed")]
        state = np.array([row["observation.state"] for row in rows])
        assert np.allclose(state[:, : len(columns)], wanted[:, columns], atol=1e-5)
        action = np.array([row["action"] for row in rows])
        assert np.array_equal(action[:-1], state[1:]) and np.array_equal(action[-1], state[-1])
        boxes = [path.coordinates.index(name) for name in info["features"]["observation.environment_state"]["names"]]
        assert np.allclose([row["observation.environment_state"] for row in rows], wanted[:, boxes], atol=1e-5)
        assert [row["next.done"] for row in rows] == [False] * (len(rows) - 1) + [True]
        # Hands close and open when the events of the path say so.
        closed = state[:, len(columns) :].sum(axis=1)
        assert closed[0] == 0 and closed[-1] == 0 and closed.max() >= 1
        contacts = [named["annotation.contact_index"][row["annotation.contact_index"]] for row in rows]
        states = [named["annotation.state_index"][row["annotation.state_index"]] for row in rows]
        assert states[0] == path.segments[0].state and states[-1] == path.segments[-1].state
        held = [contact != "" for contact in contacts]
        assert np.array_equal(held, closed > 0)
        for event in path.events:
            at = int(np.ceil((event.time + event.dwell) * 30)) + 1
            if event.kind == "grasp":
                assert f"{event.gripper} {event.handle}" in contacts[at]


def test_meta_data_are_complete(made: Path) -> None:
    info = json.loads((made / "meta" / "info.json").read_text())
    episodes = read(made, "meta/episodes/*/*.parquet")
    frames = read(made, "data/*/*.parquet")
    assert [row["episode_index"] for row in episodes] == list(range(5))
    assert [row["seed"] for row in episodes] == list(SEEDS)
    assert episodes[0]["tasks"] == ["move box1, box2"] and all(row["min_clearance"] >= 0 for row in episodes)
    state = np.array([row["observation.state"] for row in frames])
    for row in episodes:
        own = state[row["dataset_from_index"] : row["dataset_to_index"]]
        assert len(own) == row["length"] == row["stats/observation.state/count"][0]
        assert np.allclose(row["stats/observation.state/mean"], own.mean(axis=0), atol=1e-6)
        assert np.allclose(row["stats/observation.state/std"], own.std(axis=0), atol=1e-6)
        assert np.allclose(row["stats/observation.state/max"], own.max(axis=0))
        file = made / info["data_path"].format(chunk_index=row["data/chunk_index"], file_index=row["data/file_index"])
        assert file.exists()
    stats = json.loads((made / "meta" / "stats.json").read_text())["observation.state"]
    assert np.allclose(stats["mean"], state.mean(axis=0), atol=1e-6) and np.allclose(stats["std"], state.std(axis=0), atol=1e-6)
    assert np.allclose(stats["q50"], np.quantile(state, 0.5, axis=0), atol=1e-6) and stats["count"] == [len(frames)]
    assert read(made, "meta/tasks.parquet") == [{"task_index": 0, "task": "move box1, box2"}]
    last = read(made, "meta/problems.parquet")[-1]
    assert (last["seed"], last["outcome"], last["episode_index"]) == (99, "infeasible_goal", None) and "box1" in last["detail"]


def test_the_same_problems_make_the_same_bytes(made: Path, tmp_path: Path) -> None:
    def hashes(folder: Path) -> dict[str, str]:
        files = (file for file in folder.rglob("*") if file.is_file())
        return {str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest() for file in files}

    dataset.make(problems(), tmp_path / "again", improve_work=0, threads=1, clearance=True)
    assert hashes(tmp_path / "again") == hashes(made)


def test_statistics_in_pieces_are_those_of_the_whole() -> None:
    from foliate.dataset.statistics import KEPT, Statistics

    values = np.random.default_rng(3).normal(size=(2 * KEPT + 17, 2)) * [1.0, 1e-3] + [0.0, 1e3]
    pieces = Statistics()
    for piece in np.array_split(values, 23):
        pieces.add(piece)
    told = pieces.told()
    assert np.allclose(told["mean"], values.mean(axis=0), rtol=1e-12) and np.allclose(told["std"], values.std(axis=0), rtol=1e-6)
    assert np.allclose(told["q90"], np.quantile(values, 0.9, axis=0), atol=[0.02, 2e-5])


def test_statistics_keep_no_more_than_their_sample() -> None:
    import tracemalloc

    from foliate.dataset.statistics import KEPT, Statistics

    statistics = Statistics()
    block = np.random.default_rng(4).normal(size=(50_000, 4))
    tracemalloc.start()
    for _ in range(40):
        statistics.add(block)
    kept, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert kept < 2 * KEPT * 4 * 8, f"{kept} bytes"


def test_what_is_written_before_an_error_is_a_whole_dataset(tmp_path: Path) -> None:
    def broken() -> Iterator[foliate.Scene]:
        yield foliate.Scene("demo")
        raise RuntimeError("no more")

    with pytest.raises(RuntimeError, match="no more"):
        dataset.make(broken(), tmp_path / "part", first=True, threads=1)
    info = json.loads((tmp_path / "part" / "meta" / "info.json").read_text())
    assert info["total_episodes"] == len(read(tmp_path / "part", "meta/episodes/*/*.parquet")) <= 1
    with pytest.raises(FileExistsError):
        dataset.make(problems(), tmp_path / "part")
    with pytest.raises(ValueError, match="known: lerobot"):
        dataset.make(problems(), tmp_path / "other", format="csv")  # type: ignore[arg-type]


@pytest.mark.parametrize("first", [True, False])
def test_plain_forms_have_the_same_numbers(first: bool, tmp_path: Path) -> None:
    settings: dict[str, Any] = {"first": True} if first else {"improve_work": 0}
    scene = foliate.Scene("demo")
    for form in ("npz", "parquet"):
        dataset.make([(scene, {"seed": 2})], tmp_path / form, format=form, rate=20, clearance=True, **settings)
    path = foliate.solve(scene, seed=2, **settings).path
    wanted = dataset.frames(path, 20, clearance=True)
    npz = np.load(tmp_path / "npz" / "episodes" / "000000.npz")
    assert np.array_equal(npz["state"], wanted.state) and list(npz["transitions"]) == wanted.transitions
    if first:
        assert np.array_equal(wanted.state[-1], path.knots[-1][: wanted.state.shape[1]]) and len(wanted) == len(path.knots)
    rows = read(tmp_path / "parquet", "frames.parquet")
    assert wanted.clearance is not None
    assert np.array_equal(npz["clearance"], wanted.clearance) and [row["clearance"] for row in rows] == list(npz["clearance"])
    layout = json.loads((tmp_path / "parquet" / "layout.json").read_text())
    assert np.array_equal([[row[name] for name in layout["robot"]] for row in rows], wanted.state)
    assert [row["contact"] for row in rows] == [wanted.contacts[segment] for segment in wanted.segment]
    assert json.loads((tmp_path / "npz" / "problems.jsonl").read_text())["outcome"] == "solved"


@pytest.mark.parametrize("command", [["lerobot-doctor"], ["robovet", "doctor"]], ids=" ".join)
def test_linters_of_others_pass(command: list[str], made: Path) -> None:
    program = shutil.which(command[0], path=str(Path(sys.executable).parent))
    if program is None:
        pytest.skip(f"{command[0]} is not installed")
    done = subprocess.run([program, *command[1:], str(made)], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "FAIL" not in done.stdout.replace("0 FAIL", ""), done.stdout + done.stderr


def test_the_command_makes_a_dataset(tmp_path: Path) -> None:
    out = tmp_path / "set"
    command = [sys.executable, "-m", "foliate", "dataset", "demo", "--seeds", "1..3", "--out", str(out), "--improve-work", "0"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "3 of 3 solved" in done.stdout
    assert json.loads((out / "meta" / "info.json").read_text())["total_episodes"] == 3
    again = subprocess.run(command, capture_output=True, text=True, check=False)
    assert again.returncode == 2 and "something in it" in again.stderr
    suite = tmp_path / "suite.toml"
    suite.write_text('format = "foliate.suite/1"\nname = "x"\nscenes = ["demo"]\n[vary]\ninstances = 4\nseed = 3\nstarts = true\ngoals = true\nwithin = { x = [0.42, 0.6], y = [-0.4, 0.4] }\n')
    varied = [*command[:4], "--suite", str(suite), "--out", str(tmp_path / "varied"), "--first", "--time-limit", "5"]
    done = subprocess.run(varied, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert len(read(tmp_path / "varied", "meta/problems.parquet")) == 4
    wrong = subprocess.run([*command[:4], "no_such_scene", *command[5:]], capture_output=True, text=True, check=False)
    assert wrong.returncode == 2 and "no_such_scene" in wrong.stderr
