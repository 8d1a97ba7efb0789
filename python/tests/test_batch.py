"""Batches: order, bounded memory, failures as values."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

import foliate
from foliate._foliate import Batch
from foliate.batch import Problem


@pytest.fixture(scope="module")
def demo() -> foliate.Scene:
    return foliate.Scene("demo")


def test_answers_come_in_order_and_do_not_depend_on_threads(demo: foliate.Scene) -> None:
    def prints(threads: int) -> list[int]:
        problems = [(demo, {"seed": seed}) for seed in range(1, 13)]
        return [answer.report.fingerprint for answer in foliate.plan_batch(problems, threads=threads, first=True)]

    alone = prints(1)
    assert alone == prints(3)
    assert len(set(alone)) == len(alone)


def test_problems_are_taken_as_they_are_needed(demo: foliate.Scene) -> None:
    taken = 0

    def endless() -> Iterator[Problem]:
        nonlocal taken
        while True:
            taken += 1
            yield demo, {"seed": taken}

    answers = foliate.plan_batch(endless(), threads=2, first=True)
    for _ in range(20):
        next(answers)
    answers.close()
    assert taken <= 20 + 64


def test_failures_are_answers(demo: foliate.Scene) -> None:
    inside = demo.with_start({demo.objects[0]: demo.start(demo.objects[1])})
    outcomes = [answer.outcome for answer in foliate.plan_batch([demo, inside, demo], threads=2, first=True)]
    assert outcomes == ["solved", "infeasible_start", "solved"]


def test_wrong_settings_are_told(demo: foliate.Scene) -> None:
    with pytest.raises(ValueError, match="threads"):
        next(foliate.plan_batch([demo], threads=0))
    with pytest.raises(TypeError):
        next(foliate.plan_batch([demo], no_such_setting=1))
    with pytest.raises(ValueError, match="known: sequence"):
        next(foliate.plan_batch([demo], scheduler="no_such"))
    with pytest.raises(ValueError, match="time_limit"):
        next(foliate.plan_batch([(demo, {"time_limit": -1.0})]))
    batch = Batch(1)
    with pytest.raises(IndexError):
        batch.take()
    batch.add(demo, first=True)
    batch.close()
    with pytest.raises(ValueError, match="closed"):
        batch.take()


# Anywhere on the table some places are out of reach.
VARY = {"seed": 3, "starts": True, "goals": ["box1"], "within": {"x": [0.42, 0.6], "y": [-0.4, 0.4]}}


def test_scenes_vary_by_number() -> None:
    varied = foliate.Variations("demo", VARY)
    answers = list(foliate.plan_batch(foliate.instances(varied, 6), threads=2, first=True, time_limit=10.0))
    assert [answer.outcome for answer in answers].count("solved") >= 5
    starts = {tuple(scene.start("box1")) for scene in (varied.instance(number) for number in range(6))}
    assert len(starts) == 6
    again = foliate.Variations("demo", VARY).instance(4)
    assert again.start("box2") == varied.instance(4).start("box2")
    # An instance is solved as the scene that has its start and goal is, read anew.
    shared = foliate.Scene("demo").with_goal({"box1": [0.5, -0.3, 0.741, 0, 0, 0, 1]})
    first = foliate.solve(shared, seed=5, first=True).report.fingerprint
    base = foliate.Scene("demo")
    foliate.solve(base, first=True)
    assert foliate.solve(base.with_goal({"box1": [0.5, -0.3, 0.741, 0, 0, 0, 1]}), seed=5, first=True).report.fingerprint == first
    moved = {"box1": [0.55, 0.1, 0.741, 0, 0, 0, 1]}
    fresh = foliate.solve(foliate.Scene("demo").with_start(moved), seed=5, first=True).report.fingerprint
    assert foliate.solve(base.with_start(moved), seed=5, first=True).report.fingerprint == fresh


def test_what_cannot_vary_is_told() -> None:
    with pytest.raises(foliate.SceneError, match="box9"):
        foliate.Variations("demo", {"starts": ["box9"]})
    with pytest.raises(foliate.SceneError, match="sead"):
        foliate.Variations("demo", {"sead": 1})
    high = foliate.Variations("demo", {"starts": True, "within": {"z": [5.0, 6.0]}, "tries": 3})
    with pytest.raises(foliate.NoInstance) as raised:
        high.instance(7)
    assert raised.value.number == 7 and "3 draws" in str(raised.value)
    answers = list(foliate.plan_batch(foliate.instances(high, 2), threads=1))
    assert [answer.outcome for answer in answers] == ["no_instance", "no_instance"]
