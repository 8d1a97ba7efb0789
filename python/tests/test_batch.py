"""Batches: order, bounded memory, failures as values."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

import foliate
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
    assert taken <= 20 + 8


def test_failures_are_answers(demo: foliate.Scene) -> None:
    inside = demo.with_start({demo.objects[0]: demo.start(demo.objects[1])})
    outcomes = [answer.outcome for answer in foliate.plan_batch([demo, inside, demo], threads=2, first=True)]
    assert outcomes == ["solved", "infeasible_start", "solved"]


def test_wrong_settings_are_told(demo: foliate.Scene) -> None:
    with pytest.raises(ValueError, match="threads"):
        next(foliate.plan_batch([demo], threads=0))
    with pytest.raises(TypeError):
        next(foliate.plan_batch([demo], no_such_setting=1))
