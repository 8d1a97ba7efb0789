"""``foliate dataset``: a dataset of scenes and seeds."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from foliate._foliate import Scene, Variations
from foliate.batch import Problem, instances
from foliate.dataset.make import FORMATS, Made, make
from foliate.errors import FoliateError

__all__ = ["run"]


def run(arguments: list[str]) -> int:
    """Runs the command; returns its exit code: 0 where there is a dataset, 2 where a scene cannot be read or the folder is not empty, 130 after Ctrl-C."""
    options = _parser().parse_args(arguments)
    begun = time.monotonic()
    shown = _Progress(begun)
    settings: dict[str, Any] = {"time_limit": options.time_limit, "scheduler": options.scheduler}
    if options.first:
        settings["first"] = True
    elif options.improve_time is not None:
        settings["improve_time"] = options.improve_time
    elif options.improve_work is not None:
        settings["improve_work"] = options.improve_work
    try:
        made = make(_problems(options), options.out, format=options.format, rate=options.rate, task=options.task, clearance=options.clearance, threads=options.threads, progress=shown.tell, **settings)
    except (FoliateError, OSError, ValueError, ImportError) as why:
        print(f"error: {why}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"\ninterrupted; {options.out} has what was planned until then", file=sys.stderr)
        return 130
    shown.end()
    taken = time.monotonic() - begun
    others = ", ".join(f"{count} {outcome}" for outcome, count in sorted(made.outcomes.items()) if outcome != "solved")
    print(f"{made.episodes} of {made.problems} solved{f' ({others})' if others else ''}: {made.frames} frames in {options.out}, {made.problems / taken:.1f} plans/s")
    return 0


def _problems(options: argparse.Namespace) -> Iterator[Problem]:
    """The problems that are asked for. Raises at once where a scene or a suite cannot be read."""
    if options.suite is not None:
        if options.scene:
            raise ValueError("either scenes or --suite")
        varied = Variations.from_suite(options.suite, packages=options.package_path)
        if not varied:
            raise ValueError(f"{options.suite}: nothing varies; a suite of a dataset has [vary]")
        return (problem for variations, count in varied for problem in instances(variations, count))
    if not options.scene:
        raise ValueError("name a scene, or a suite that varies one with --suite")
    first, last = _range(options.seeds)
    scenes = [Scene(name, packages=options.package_path) for name in options.scene]
    return ((scene, {"seed": seed}) for seed in range(first, last + 1) for scene in scenes)


class _Progress:
    """A line on a terminal that is written anew."""

    def __init__(self, begun: float) -> None:
        self.begun = begun
        self.last = begun
        self.shown = False

    def tell(self, made: Made) -> None:
        now = time.monotonic()
        if sys.stderr.isatty() and now - self.last > 0.2:
            self.last, self.shown = now, True
            print(f"\r{made.problems} planned, {made.episodes} solved, {made.problems / (now - self.begun):.1f}/s ", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        if self.shown:
            print(file=sys.stderr)


def _range(text: str) -> tuple[int, int]:
    first, dots, last = text.partition("..")
    try:
        numbers = int(first), int(last if dots else first)
    except ValueError:
        raise ValueError(f"--seeds: `{text}` is no range such as 1..1000") from None
    if not 0 <= numbers[0] <= numbers[1]:
        raise ValueError(f"--seeds: `{text}` is no range such as 1..1000")
    return numbers


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="foliate dataset", description="Plans scenes for many seeds and writes a dataset of the paths.")
    parser.add_argument("scene", nargs="*", help="shipped scenes' names, or scene files; all of the same robot and objects")
    parser.add_argument("--suite", type=Path, metavar="FILE", help="a suite file with [vary], as `foliate bench --suite` has it: its instances, each with its number as seed")
    parser.add_argument("--out", type=Path, required=True, help="the folder, new or empty")
    parser.add_argument("--seeds", default="1..20", metavar="A..B", help="from A to B, both included (default: %(default)s)")
    parser.add_argument("--format", choices=list(FORMATS), default="lerobot", help="LeRobot v3, one Parquet table, or an NPZ file for each path (default: %(default)s)")
    parser.add_argument("--rate", type=float, default=30.0, help="frames a second (default: %(default)s)")
    parser.add_argument("--task", help="what is done, in words (default: which objects are moved)")
    parser.add_argument("--clearance", action="store_true", help="measure in each frame how close things are")
    parser.add_argument("--threads", type=int, help="problems that are planned at once (default: as many as the processor has threads)")
    parser.add_argument("--time-limit", type=float, default=60.0, metavar="S", help="of one problem (default: %(default)s)")
    parser.add_argument("--scheduler", default="sequence")
    budget = parser.add_mutually_exclusive_group()
    budget.add_argument("--first", action="store_true", help="first paths, without times: frames are their knots")
    budget.add_argument("--improve-work", type=int, metavar="N", help="counted work spent on a better path; the files depend on it, not on the machine")
    budget.add_argument("--improve-time", type=float, metavar="S", help="seconds spent on a better path")
    parser.add_argument("--package-path", action="append", default=[], metavar="DIR", help="folder in which package:// names are looked up; may be given several times")
    return parser
