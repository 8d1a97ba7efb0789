#!/usr/bin/env python3
"""Solves converted scenes with `foliate bench` and keeps one line per solve.

    python run.py --foliate BIN --scenes DIR --seeds 1..3 --time-limit 60 --out RESULTS [--only TEXT]

Times are those of first paths. A scene whose folder is in RESULTS already is not solved again.
"""

from __future__ import annotations

import argparse
import csv
import json
import subprocess
import sys
from pathlib import Path

from rows import SOLVED, Row, append


def rows_of(bench: list[dict[str, str]], name: str, about: dict, limit_s: float, folder: Path) -> list[Row]:
    """The rows of one scene from what `foliate bench` wrote below `folder`."""
    found = []
    for line in bench:
        path = f"{name}/paths/{name}-{line['seed']}.json"
        solved = line["outcome"] == SOLVED
        found.append(Row(
            instance=name, group=about["group"], fingers=about["fingers"], seed=int(line["seed"]), outcome=line["outcome"],
            solve_ms=float(line["solve_ms"] or 0.0), limit_s=limit_s,
            grasps=grasps(json.loads((folder / path).read_text())) if solved else 0,
            shown=about["grasps"], path=path if solved else "", message=line["message"],
        ))
    return found


def grasps(document: dict) -> int:
    """How many grasps a path file has."""
    return sum(event["kind"] == "grasp" for event in document.get("events", []))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--foliate", type=Path, required=True)
    parser.add_argument("--scenes", type=Path, required=True)
    parser.add_argument("--seeds", default="1..3")
    parser.add_argument("--time-limit", type=float, default=60.0)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", default="", help="instances whose name contains this")
    parser.add_argument("rest", nargs="*", help="after --: further options of foliate bench")
    options = parser.parse_args()
    index = json.loads((options.scenes / "instances.json").read_text())
    options.out.mkdir(parents=True, exist_ok=True)
    for name, about in index.items():
        file = options.out / name / "results.csv"
        if options.only not in name or file.is_file():
            continue
        command = [str(options.foliate), "bench", str(options.scenes / f"{name}.toml"), "--seeds", options.seeds,
                   "--time-limit", str(options.time_limit), "--out", str(file.parent), *options.rest]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if not file.is_file():
            print(f"{name}: {done.stderr.strip()}", file=sys.stderr)
            return 1
        with file.open(newline="", encoding="utf-8") as lines:
            rows = rows_of(list(csv.DictReader(lines)), name, about, options.time_limit, options.out)
        for row in rows:
            append(options.out / "rows.csv", row)
        print(name, *(f"{row.outcome} {row.solve_ms:.0f} ms;" for row in rows), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
