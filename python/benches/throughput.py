"""Plans a second from Python, on one thread and on two, beside Rust on the same problems.

Run with ``python python/benches/throughput.py [--rust PROGRAM] [--scene NAME] [--plans N] [--rounds N]``; ``PROGRAM`` is ``target/release/throughput``
(``cargo build --release -p foliate_benches --bin throughput``). Rounds are interleaved; medians count. A plan is a first path, without improvement and times; reading the scene and building its
constraint graph do not count, on either side.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import time

import foliate


def from_python(scene: foliate.Scene, plans: int, threads: int) -> float:
    problems = ((scene, {"seed": seed}) for seed in range(1, plans + 1))
    begun = time.perf_counter()
    solved = sum(answer.outcome == "solved" for answer in foliate.plan_batch(problems, threads=threads, first=True))
    taken = time.perf_counter() - begun
    assert solved == plans, f"{solved} of {plans}"
    return plans / taken


def from_rust(program: str, scene: str, plans: int, threads: int) -> float:
    done = subprocess.run([program, scene, str(plans), str(threads)], check=True, capture_output=True, text=True)
    return float(done.stdout)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--rust", help="the program, to compare with")
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
            if options.rust:
                rates.setdefault(f"Rust, {threads} threads", []).append(from_rust(options.rust, options.scene, options.plans, threads))
    for name, values in rates.items():
        print(f"{name:18s} {statistics.median(values):8.1f} plans/s ({min(values):.1f} to {max(values):.1f})")


if __name__ == "__main__":
    main()
