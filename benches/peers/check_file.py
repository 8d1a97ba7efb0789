"""The verdicts on answers: a CSV file with a line per proof."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path

from rows import read_records

VALID, COLLIDES, BREAKS, MISSES, UNREADABLE = "valid", "collides", "breaks", "misses", "unreadable"


@dataclass(frozen=True)
class Check:
    """One proof. `depth` (m) and `pair`: the deepest overlap; `error` (m or rad) and `what`: the largest error of what is
    held, put down or fixed; `samples` tested and the longest `step` (m) between them; `goal_off`: how far the last
    configuration is from the goal; `centre_off` (m): the centre of mass from where the scene wants it. Foliate's answers
    are certified: only `verdict`, and in `what` the first violation. `seconds` of processor time."""

    scene: str
    solver: str
    seed: int
    series: str
    version: str
    verdict: str
    depth: float
    pair: str
    error: float
    what: str
    samples: int
    step: float
    goal_off: float
    centre_off: float
    mode: str
    seconds: float
    date: str


COLUMNS = [column.name for column in fields(Check)]


def read_verdicts(file: Path) -> dict[tuple, str]:
    """The verdict of every answer that has one, by the key of its row; the last counts."""
    if not file.exists():
        return {}
    return {
        (record["scene"], record["solver"], int(record["seed"]), record["series"], record["version"]): record["verdict"]
        for _, record in read_records(file, COLUMNS)
    }
