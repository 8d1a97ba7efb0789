"""The verdicts on answers: a CSV file with a line per proof."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path

from rows import Row, read_records

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


class Verdicts:
    """What was found about answers; the last proof of one counts, unless the solve was made again after it."""

    def __init__(self, file: Path | None = None):
        self.known: dict[tuple, tuple[str, str]] = {}
        if file is not None and file.exists():
            for _, record in read_records(file, COLUMNS):
                key = record["scene"], record["solver"], int(record["seed"]), record["series"], record["version"]
                self.known[key] = record["date"], record["verdict"]

    def of(self, row: Row) -> str | None:
        """None for an answer that is not proved."""
        date, verdict = self.known.get(row.key, ("", None))
        return verdict if date >= row.date else None
