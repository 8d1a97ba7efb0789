"""A batch on Ray: tasks, not actors, so that a worker that dies takes nothing with it but its chunk."""

from __future__ import annotations

import os
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable
from pathlib import Path as FilePath
from typing import Any

from foliate.cluster.parts import Row, chunks, done, planned, row_of, write
from foliate.cluster.problem import Problem

__all__ = ["run"]


def run(
    problems: Iterable[Problem],
    out: str | os.PathLike[str],
    *,
    cpus_per_task: float = 1,
    retries: int = 1,
    timeout_s: float = 600.0,
    chunk: int = 20,
    paths: bool = False,
    expected: Callable[[Problem], float] | None = None,
    progress: Callable[[int], None] | None = None,
) -> dict[str, int]:
    """Plans for problems on the cluster that ``ray.init`` has joined, and writes rows into ``out``, a folder that the driver and, for ``paths``, all workers reach.

    As ``foliate.cluster.run``: a part for each chunk, finished rows are skipped. So many chunks as the cluster has processors for are under way. A chunk that ends without an answer is cut
    into single problems; one of these that ends its worker ``retries`` + 1 times is a row with the outcome ``crashed``, and one that takes more than ``timeout_s`` seconds is a row with the outcome
    ``timeout``. A chunk may take ``timeout_s`` for each of its problems; the time that a worker takes to start counts. ``expected`` as ``foliate.cluster.run``. Returns how many ended how.
    """
    import ray as imported

    ray: Any = imported
    folder = FilePath(out)
    saved = folder / "paths" if paths else None
    task: Any = ray.remote(num_cpus=cpus_per_task, max_retries=0)(_part)
    # No more: a task that waits for a processor would be late without having begun.
    room = max(1, int(ray.cluster_resources().get("CPU", 1) / cpus_per_task))
    outcomes: Counter[str] = Counter()
    waiting = chunks(problems, chunk, done(folder), (0, 1), expected)
    again: deque[tuple[list[Problem], int]] = deque()
    running: dict[Any, tuple[list[Problem], int, float]] = {}  # The problems, how often they were tried before, since when.

    def finish(made: list[Row]) -> None:
        write(folder, made)
        outcomes.update(row["outcome"] for row in made)
        if progress is not None:
            progress(outcomes.total())

    def failed(mine: list[Problem], tries: int, outcome: str, detail: str) -> None:
        if len(mine) > 1:
            again.extend(([problem], 0) for problem in mine)
        elif outcome == "crashed" and tries < retries:
            again.append((mine, tries + 1))
        else:
            finish([row_of(mine[0], outcome, detail)])

    def begin() -> None:
        while len(running) < room:
            following = again.popleft() if again else next(((mine, 0) for mine in waiting), None)
            if following is None:
                return
            mine, tries = following
            running[task.remote(mine, saved)] = (mine, tries, time.monotonic())

    try:
        while True:
            begin()
            if not running:
                return dict(outcomes)
            ready, others = ray.wait(list(running), num_returns=1, timeout=0.2)
            ended = [(reference, *running.pop(reference)) for reference in ready]
            # Before rows are written: a processor does not wait for that.
            begin()
            for reference, mine, tries, _ in ended:
                try:
                    finish(ray.get(reference))
                except ray.exceptions.RayError as why:
                    failed(mine, tries, "crashed", str(why).strip().partition("\n")[0])
            now = time.monotonic()
            for reference in others:
                mine, tries, since = running[reference]
                if now - since <= timeout_s * len(mine):
                    continue
                del running[reference]
                ray.cancel(reference, force=True)
                failed(mine, tries, "timeout", f"not ended after {timeout_s:g} s")
    finally:
        for reference in running:
            ray.cancel(reference, force=True)


def _part(mine: list[Problem], saved: FilePath | None) -> list[Row]:
    return [planned(problem, saved) for problem in mine]

