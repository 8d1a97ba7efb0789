"""Plans a second from Python, on one thread and on two, beside ``foliate bench`` on the same problems.

Run with ``python python/benches/throughput.py [--foliate PROGRAM] [--scene NAME] [--plans N] [--rounds N]``. Rounds are interleaved; medians count. A plan is a first
path, without improvement and times; reading the scene does not count.
"""

from __future__ import annotations

import argparse
import csv
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import foliate


def from_python(scene: foliate.Scene, plans: int, threads: int) -> float:
    problems = ((scene, {"seed": seed}) for seed in range(1, plans + 1))
    begun = time.perf_counter()
    solved = sum(answer.outcome == "solved" for answer in foliate.plan_batch(problems, threads=threads, first=True))
    taken = time.perf_counter() - begun
    assert solved == plans, f"{solved} of {plans}"
    return plans / taken


def from_rust(program: str, scene: str, plans: int) -> float:
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        command = [program, "bench", scene, "--seeds", f"1..{plans}", "--threads", "1", "--out", str(out)]
        subprocess.run(command, check=True, capture_output=True)
        with (out / "results.csv").open() as file:
            rows = list(csv.DictReader(file))
    # Times of solves alone: the program also writes path files.
    return plans / sum(float(row["solve_ms"]) / 1e3 for row in rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--foliate", help="the program, to compare with")
    parser.add_argument("--scene", default="demo")
    parser.add_argument("--plans", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    scene = foliate.Scene(options.scene)
    from_python(scene, min(options.plans, 50), 1)
    rates: dict[str, list[float]] = {}
    for _ in range(options.rounds):
        for threads in (1, 2):
            rates.setdefault(f"Python, {threads} threads", []).append(from_python(scene, options.plans, threads))
        if options.foliate:
            rates.setdefault("Rust, 1 thread", []).append(from_rust(options.foliate, options.scene, options.plans))
    for name, values in rates.items():
        print(f"{name:18s} {statistics.median(values):8.1f} plans/s ({min(values):.1f} to {max(values):.1f})")


if __name__ == "__main__":
    main()
