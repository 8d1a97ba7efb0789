"""A shard of a batch on this machine."""

from __future__ import annotations

import os
from collections import Counter, deque
from collections.abc import Callable, Iterable
from pathlib import Path as FilePath

from foliate._foliate import Batch
from foliate.batch import AHEAD
from foliate.cluster.parts import Row, answered, chunks, done, row_of, write
from foliate.cluster.problem import Problem
from foliate.errors import FoliateError

__all__ = ["run"]


def run(
    problems: Iterable[Problem],
    out: str | os.PathLike[str],
    *,
    shard: tuple[int, int] = (0, 1),
    threads: int | None = None,
    chunk: int = 100,
    paths: bool = False,
    expected: Callable[[Problem], float] | None = None,
    progress: Callable[[int], None] | None = None,
) -> dict[str, int]:
    """Plans for the problems of shard ``(i, n)``, i counted from 0, and writes rows into ``out``, ``chunk`` of them in a part; says how many ended how.

    Problems that have a row in ``out`` are skipped, and so is one that comes twice: after an interruption the same call goes on. ``threads`` problems are planned at once. ``paths`` writes path
    files too. ``expected`` says how long a problem takes, in any unit: the longest are begun first, which keeps all threads at work until the end; all problems are in memory then. ``progress`` is told
    how many rows have been written. All shards may write into one folder at the same time. A problem that takes its process down takes its part with it: such batches
    go to ``foliate.cluster.ray``, or each shard is made small.
    """
    number, count = shard
    if not 0 <= number < count:
        raise ValueError(f"`shard` is (i, n) with i from 0 to n - 1, not {shard}")
    folder = FilePath(out)
    saved = folder / "paths" if paths else None
    many = threads if threads is not None else os.cpu_count() or 1
    outcomes: Counter[str] = Counter()
    under_way: deque[tuple[list[Problem], list[Row | None]]] = deque()
    batch = Batch(many)

    def finish() -> None:
        mine, known = under_way.popleft()
        made = [row if row is not None else answered(problem, batch.take, saved) for problem, row in zip(mine, known, strict=True)]
        write(folder, made)
        outcomes.update(row["outcome"] for row in made)
        if progress is not None:
            progress(outcomes.total())

    try:
        for mine in chunks(problems, chunk, done(folder), shard, expected):
            under_way.append((mine, [_begun(batch, problem) for problem in mine]))
            # One is taken while the next is planned.
            while len(under_way) > 1 and len(batch) > AHEAD * many + chunk:
                finish()
        while under_way:
            finish()
    finally:
        batch.close()
    return dict(outcomes)


def _begun(batch: Batch, problem: Problem) -> Row | None:
    """Adds a problem to a batch; the row of one that cannot be planned for."""
    # The answer is the same on any number of threads, and here each problem has one.
    settings = {key: value for key, value in problem.settings.items() if key != "threads"}
    try:
        batch.add(problem.load(), **settings)
    except (FoliateError, ValueError, TypeError) as why:
        return row_of(problem, "unreadable", str(why))
    return None
