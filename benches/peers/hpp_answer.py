"""A path of HPP written down as configurations so close that a checker can choose among them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

STEP = 0.02
"""First samples are so far apart in HPP's path parameter,"""
CLOSE = 0.004
"""then halved until all coordinates together change by less (rad or m),"""
HALVINGS = 12
"""or so often: what is left then is a jump, which the check will see."""


def write_answer(model, path, file: Path) -> dict:
    """Writes `configurations` (N, coordinates of the scene), `segments` (index of each one's sub-path) and `failed`
    (how many could not be evaluated on their constraints)."""
    pieces = list(_pieces(path))
    rows, segments, failed = [], [], 0
    for index, piece in enumerate(pieces):
        sampled, missed = _sample(piece)
        rows += sampled
        segments += [index] * len(sampled)
        failed += missed
    configurations = model.from_hpp(np.array(rows))
    file.parent.mkdir(parents=True, exist_ok=True)
    np.savez_compressed(file, configurations=configurations, segments=np.array(segments), failed=failed)
    return {"segments": len(pieces), "length": float(path.length()), "samples": len(rows)}


def _pieces(path):
    """The sub-paths of a path vector, and of those within it."""
    if not hasattr(path, "numberPaths"):
        yield path
        return
    for rank in range(path.numberPaths()):
        yield from _pieces(path.pathAtRank(rank))


def _sample(piece) -> tuple[list[np.ndarray], int]:
    span = piece.timeRange()
    low, high = span.first, span.second
    count = max(1, int(np.ceil((high - low) / STEP)))
    times = np.linspace(low, high, count + 1)
    missed = 0

    def at(time: float) -> np.ndarray:
        nonlocal missed
        configuration, good = piece(time)
        missed += not good
        return np.array(configuration)

    rows = [at(times[0])]
    for before, after in zip(times[:-1], times[1:]):
        rows += _between(at, before, rows[-1], after, at(after), HALVINGS)
    return rows, missed


def _between(at, before: float, first: np.ndarray, after: float, last: np.ndarray, halvings: int) -> list[np.ndarray]:
    """Samples after `before` up to `after`, both known."""
    if halvings == 0 or np.abs(last - first).sum() < CLOSE:
        return [last]
    middle = (before + after) / 2.0
    known = at(middle)
    return (_between(at, before, first, middle, known, halvings - 1)
            + _between(at, middle, known, after, last, halvings - 1))
