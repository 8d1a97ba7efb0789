"""Many problems, planned side by side."""

from __future__ import annotations

import os
from collections.abc import Generator, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, overload

from foliate._foliate import Batch, Scene, Solution, Variations
from foliate.errors import NoInstance, NoSolution

__all__ = ["Answer", "Instance", "Problem", "instances", "plan_batch"]


@dataclass(frozen=True)
class Instance:
    """An instance of a scene that varies, as a problem; it is drawn where it is planned for. Its seed is its number."""

    variations: Variations
    """What varies."""
    number: int
    """Which instance."""


Planned = Scene | tuple[Scene, Mapping[str, Any]]
Problem = Planned | Instance
Answer = Solution | NoSolution | NoInstance

AHEAD = 32
"""Problems that are planned ahead of the answers, per thread. One that takes long holds the others up only once they are so far ahead."""


def instances(variations: Variations, count: int, *, first: int = 0) -> Iterator[Instance]:
    """The instances ``first``, ``first + 1`` and so on of a scene that varies, as problems of ``plan_batch``; the seed of each is its number."""
    return (Instance(variations, number) for number in range(first, first + count))


@overload
def plan_batch(problems: Iterable[Planned], *, threads: int | None = None, **settings: Any) -> Generator[Solution | NoSolution, None, None]: ...


@overload
def plan_batch(problems: Iterable[Problem], *, threads: int | None = None, **settings: Any) -> Generator[Answer, None, None]: ...


def plan_batch(problems: Iterable[Problem], *, threads: int | None = None, **settings: Any) -> Generator[Answer, None, None]:
    """Plans for each problem; yields a ``Solution`` or a ``NoSolution`` for each, in the order of the problems. An ``Instance`` is drawn first, which may end as a ``NoInstance``.

    A problem is a scene, or a scene with settings of its own (``seed`` above all), which go before ``settings``; both are what ``solve`` takes but for ``threads``,
    ``progress`` and ``cancel``. So many
    problems as there are ``threads`` (as the processor has, if not given) are planned at once, each on one thread. Problems are taken as they are needed, at
    most 32 for each thread ahead of what has been yielded: any number of them takes the same memory. The answers do not depend on ``threads``.

    When the iteration is given up, or Ctrl-C is pressed, searches that are under way end.

    Raises what ``solve`` raises but for ``NoSolution``.
    """
    count = threads if threads is not None else os.cpu_count() or 1
    batch = Batch(count)
    try:
        for problem in problems:
            _add(batch, problem, settings)
            if len(batch) >= AHEAD * count:
                yield _next_answer(batch)
        while len(batch):
            yield _next_answer(batch)
    finally:
        batch.close()


def _add(batch: Batch, problem: Problem, settings: Mapping[str, Any]) -> None:
    if isinstance(problem, Instance):
        batch.add((problem.variations, problem.number), **{**settings, "seed": problem.number})
    elif isinstance(problem, tuple):
        scene, own = problem
        batch.add(scene, **{**settings, **own})
    else:
        batch.add(problem, **settings)


def _next_answer(batch: Batch) -> Answer:
    try:
        return batch.take()
    except (NoInstance, NoSolution) as none:
        return none
