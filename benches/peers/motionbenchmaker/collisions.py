#!/usr/bin/env python3
"""Which starts and goals collide by coal on the robot's meshes, and whether Foliate says the same.

    collisions.py FILE.json[.gz] [--rows FOLIATE.csv] [--urdf NAME --srdf NAME --packages DIR] [--sets A,B] [--every N]

`--rows` is what `motionbenchmaker --csv` wrote: every problem in it is compared. Exit code 1: the two differ in one.
"""

from __future__ import annotations

import csv
import sys
from collections import Counter
from pathlib import Path

from options import options
from problems import GOAL, START, ProblemsError, read
from robot_world import InputError, Robot, World


def infeasible(world: World) -> str | None:
    """As the program says it: the start is asked first."""
    if not world.valid(world.start):
        return START
    return None if world.valid(world.goal) else GOAL


def foliate(rows: Path) -> dict[tuple[str, int], str | None]:
    with rows.open(newline="") as file:
        return {(row["set"], int(row["index"])): row["outcome"] if row["outcome"] in (START, GOAL) else None
                for row in csv.DictReader(file)}


def main() -> int:
    parser = options(__doc__)
    parser.add_argument("--rows", type=Path, metavar="CSV")
    given = parser.parse_args()
    try:
        name, problems = read(given.file, given.sets, given.every)
        robot = Robot(name, given.urdf, given.srdf, given.packages)
        theirs = foliate(given.rows) if given.rows else {}
        found: dict[tuple[str, int], str | None] = {}
        different = 0
        for problem in problems:
            world, key = World(robot, problem), (problem.set, problem.index)
            found[key] = infeasible(world)
            if key in theirs and theirs[key] != found[key]:
                different += 1
                told = [f"{end} {distance * 1e3:.4f} mm ({pair}), out of bounds by {world.beyond(state):.4f}" for end, state in (("start", world.start), ("goal", world.goal))
                        for distance, pair in [world.nearest(state)]]
                print(f"{problem.set} {problem.index}: coal {found[key] or 'free'}, Foliate {theirs[key] or 'free'}; {'; '.join(told)}")
    except (ProblemsError, InputError, OSError, KeyError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print("| set | problems | start collides | goal collides |\n| :-- | --: | --: | --: |")
    for name in [*dict.fromkeys(set_ for set_, _ in found), None]:
        counts = Counter(outcome for (set_, _), outcome in found.items() if name in (None, set_))
        print(f"| {name or 'all'} | {sum(counts.values())} | {counts[START]} | {counts[GOAL]} |")
    if theirs:
        compared = sum(key in theirs for key in found)
        print(f"compared with Foliate: {compared}; different: {different}; missing in the rows: {len(found) - compared}")
    return int(different > 0)


if __name__ == "__main__":
    sys.exit(main())
