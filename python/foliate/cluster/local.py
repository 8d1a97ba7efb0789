"""A shard of a batch on this machine."""

from __future__ import annotations

import os
from collections import Counter, deque
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path as FilePath

from foliate.cluster.parts import Row, chunks, done, planned, write
from foliate.cluster.problem import Problem

__all__ = ["run"]


def run(
    problems: Iterable[Problem],
    out: str | os.PathLike[str],
    *,
    shard: tuple[int, int] = (0, 1),
    threads: int | None = None,
    chunk: int = 100,
    paths: bool = False,
    progress: Callable[[int], None] | None = None,
) -> dict[str, int]:
    """Plans for the problems of shard ``(i, n)``, i counted from 0, and writes rows into ``out``, ``chunk`` of them in a part; says how many ended how.

    Problems that have a row in ``out`` are skipped, and so is one that comes twice: after an interruption the same call goes on. ``threads`` problems are planned at once. ``paths`` writes path
    files too. ``progress`` is told how many rows have been written. All shards may write into one folder at the same time. A problem that takes its process down takes its part with it: such batches
    go to ``foliate.cluster.ray``, or each shard is made small.
    """
    number, count = shard
    if not 0 <= number < count:
        raise ValueError(f"`shard` is (i, n) with i from 0 to n - 1, not {shard}")
    folder = FilePath(out)
    saved = folder / "paths" if paths else None
    many = threads if threads is not None else os.cpu_count() or 1
    outcomes: Counter[str] = Counter()
    under_way: deque[Future[list[Row]]] = deque()

    def part(mine: list[Problem]) -> list[Row]:
        return [planned(problem, saved) for problem in mine]

    def finish(future: Future[list[Row]]) -> None:
        made = future.result()
        write(folder, made)
        outcomes.update(row["outcome"] for row in made)
        if progress is not None:
            progress(outcomes.total())

    with ThreadPoolExecutor(many, thread_name_prefix="foliate-shard") as pool:
        try:
            for mine in chunks(problems, chunk, done(folder), shard):
                under_way.append(pool.submit(part, mine))
                if len(under_way) > 2 * many:
                    finish(under_way.popleft())
            while under_way:
                finish(under_way.popleft())
        finally:
            for waiting in under_way:
                waiting.cancel()
    return dict(outcomes)
