"""Many problems, planned side by side."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Generator, Iterable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, overload

from foliate._foliate import Cancel, Scene, Solution, Variations, solve
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

# Problems that are planned ahead of the answers, per thread. One that takes long holds the others up only once they are so far ahead.
_AHEAD = 32


def instances(variations: Variations, count: int, *, first: int = 0) -> Iterator[Instance]:
    """The instances ``first``, ``first + 1`` and so on of a scene that varies, as problems of ``plan_batch``; the seed of each is its number."""
    return (Instance(variations, number) for number in range(first, first + count))


@overload
def plan_batch(problems: Iterable[Planned], *, threads: int | None = None, **settings: Any) -> Generator[Solution | NoSolution, None, None]: ...


@overload
def plan_batch(problems: Iterable[Problem], *, threads: int | None = None, **settings: Any) -> Generator[Answer, None, None]: ...


def plan_batch(problems: Iterable[Problem], *, threads: int | None = None, **settings: Any) -> Generator[Answer, None, None]:
    """Plans for each problem; yields a ``Solution`` or a ``NoSolution`` for each, in the order of the problems. An ``Instance`` is drawn first, which may end as a ``NoInstance``.

    A problem is a scene, or a scene with settings of its own (``seed`` above all), which go before ``settings``; both are what ``solve`` takes. So many
    problems as there are ``threads`` (as the processor has, if not given) are planned at once, each on one thread. Problems are taken as they are needed, at
    most 32 for each thread ahead of what has been yielded: any number of them takes the same memory. The answers do not depend on ``threads``.

    When the iteration is given up, or Ctrl-C is pressed, searches that are under way end.

    Raises what ``solve`` raises but for ``NoSolution``.
    """
    count = threads if threads is not None else os.cpu_count() or 1
    if count < 1:
        raise ValueError("`threads` is at least 1")
    if "cancel" in settings:
        raise ValueError("`cancel` is for one solve; give up the iteration to end a batch")
    cancel = Cancel()

    def plan(problem: Problem) -> Answer:
        try:
            scene, own = _resolved(problem)
            return solve(scene, **{**settings, **own}, cancel=cancel)
        except (NoInstance, NoSolution) as none:
            return none

    under_way: deque[Future[Answer]] = deque()
    with ThreadPoolExecutor(count, thread_name_prefix="foliate") as pool:
        try:
            for problem in problems:
                under_way.append(pool.submit(plan, problem))
                if len(under_way) >= _AHEAD * count:
                    yield under_way.popleft().result()
            while under_way:
                yield under_way.popleft().result()
        finally:
            cancel.cancel()
            for waiting in under_way:
                waiting.cancel()


def _resolved(problem: Problem) -> tuple[Scene, Mapping[str, Any]]:
    if isinstance(problem, Instance):
        return problem.variations.instance(problem.number), {"seed": problem.number}
    return problem if isinstance(problem, tuple) else (problem, {})
