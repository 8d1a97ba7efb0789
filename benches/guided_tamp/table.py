#!/usr/bin/env python3
"""Prints the results as a table, a line per task.

    python table.py RESULTS
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from statistics import median

from rows import INFEASIBLE, SOLVED, Row, Verdict, read

VALID = "valid"
ORDER = ("shelf-1", "shelf-2", "shelf-3", "waiter", "tunnel")


def table(rows: list[Row], verdicts: list[Verdict]) -> str:
    """Times are of solves that were not refused; one without an answer counts as its limit. Grasps are of answers."""
    judged = {(verdict.instance, verdict.seed): verdict for verdict in verdicts}
    lines = ["| task | instances | infeasible | solved | median (ms) | worst (ms) | grasps / shown | valid by the package | valid, corrected |",
             "| :-- | --: | --: | --: | --: | --: | --: | --: | --: |"]
    known = {row.group for row in rows}
    for group in [*(name for name in ORDER if name in known), *sorted(known - set(ORDER))]:
        lines.append(_line(group, [row for row in rows if row.group == group], judged))
    return "\n".join(lines)


def _line(group: str, rows: list[Row], judged: dict[tuple[str, int], Verdict]) -> str:
    refused = {row.instance for row in rows if row.outcome in INFEASIBLE}
    tried = [row for row in rows if row.instance not in refused]
    solved = [row for row in tried if row.outcome == SOLVED]
    times = [row.solve_ms if row.outcome == SOLVED else 1e3 * row.limit_s for row in tried]
    taken, shown = sum(row.grasps for row in solved), sum(row.shown for row in solved)
    found = [judged[row.instance, row.seed] for row in solved if (row.instance, row.seed) in judged]
    unsolved = 2 * len(solved) <= len(tried)
    cells = [
        group, str(len({row.instance for row in rows})), str(len(refused)), f"{len(solved)}/{len(tried)}",
        f"{'> ' if unsolved else ''}{median(times):.0f}" if times else "–", f"{max(times):.0f}" if times else "–",
        f"{taken}/{shown}" if solved else "–",
        f"{sum(one.package == VALID for one in found)}/{len(found)}" if found else "–",
        f"{sum(one.corrected == VALID for one in found)}/{len(found)}" if found else "–",
    ]
    return f"| {' | '.join(cells)} |"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path)
    options = parser.parse_args()
    rows = read(options.results / "rows.csv", Row)
    if not rows:
        print(f"no rows in {options.results}", file=sys.stderr)
        return 2
    print(table(rows, read(options.results / "verdicts.csv", Verdict)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
