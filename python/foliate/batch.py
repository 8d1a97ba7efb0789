"""Many problems, planned side by side."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Generator, Iterable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, overload

from foliate._foliate import Cancel, Scene, Solution, Variations, solve
from foliate.errors import NoInstance, NoSolution

__all__ = ["Answer", "Problem", "instances", "plan_batch"]

Planned = Scene | tuple[Scene, Mapping[str, Any]]
Problem = Planned | NoInstance
Answer = Solution | NoSolution | NoInstance


def instances(variations: Variations, count: int, *, first: int = 0) -> Iterator[tuple[Scene, dict[str, Any]] | NoInstance]:
    """The instances ``first``, ``first + 1`` and so on of a scene that varies, as problems of ``plan_batch``; the seed of each is its number. Of a number without an instance it is the reason."""
    for number in range(first, first + count):
        try:
            yield variations.instance(number), {"seed": number}
        except NoInstance as none:
            yield none


@overload
def plan_batch(problems: Iterable[Planned], *, threads: int | None = None, **settings: Any) -> Generator[Solution | NoSolution, None, None]: ...


@overload
def plan_batch(problems: Iterable[Problem], *, threads: int | None = None, **settings: Any) -> Generator[Answer, None, None]: ...


def plan_batch(problems: Iterable[Problem], *, threads: int | None = None, **settings: Any) -> Generator[Answer, None, None]:
    """Plans for each problem; yields a ``Solution`` or a ``NoSolution`` for each, in the order of the problems. A ``NoInstance`` among the problems comes out as it is.

    A problem is a scene, or a scene with settings of its own (``seed`` above all), which go before ``settings``; both are what ``solve`` takes. So many
    problems as there are ``threads`` (as the processor has, if not given) are planned at once, each on one thread. Problems are taken as they are needed, at
    most four for each thread ahead of what has been yielded: any number of them takes the same memory. The answers do not depend on ``threads``.

    When the iteration is given up, or Ctrl-C is pressed, searches that are under way end.

    Raises what ``solve`` raises but for ``NoSolution``.
    """
    count = threads if threads is not None else os.cpu_count() or 1
    if count < 1:
        raise ValueError("`threads` is at least 1")
    if "cancel" in settings:
        raise ValueError("`cancel` is for one solve; give up the iteration to end a batch")
    cancel = Cancel()

    def plan(scene: Scene, own: Mapping[str, Any]) -> Answer:
        try:
            return solve(scene, **{**settings, **own}, cancel=cancel)
        except NoSolution as none:
            return none

    under_way: deque[Future[Answer]] = deque()
    with ThreadPoolExecutor(count, thread_name_prefix="foliate") as pool:
        try:
            for problem in problems:
                if isinstance(problem, NoInstance):
                    none: Future[Answer] = Future()
                    none.set_result(problem)
                    under_way.append(none)
                else:
                    scene, own = problem if isinstance(problem, tuple) else (problem, {})
                    under_way.append(pool.submit(plan, scene, own))
                if len(under_way) >= 4 * count:
                    yield under_way.popleft().result()
            while under_way:
                yield under_way.popleft().result()
        finally:
            cancel.cancel()
            for waiting in under_way:
                waiting.cancel()
