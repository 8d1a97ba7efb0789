#!/usr/bin/env python3
"""Prove a path file (`foliate.path/2`, or `/1`) right or wrong from the file and its models alone, with pinocchio and coal.

    recheck.py PATH.json ... [--package-path DIR ...] [--step MM | --adaptive] [--json] [--results FILE.csv]

A folder stands for the path files in it. With `--results` a row per file is kept, and a file that has one is not
checked again. Exit code 0: no violation found; 1: violations, each printed with segment, parameter (in knots), kind,
subject and value; 2: a file, or a model that it names, cannot be read.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

import coal
import numpy
import pinocchio

from clearance import Clearance
from leaves import check_leaf
from many import Results, Row, digest, expand
from motion import SegmentMotion
from packages import InputError, search_directories
from path_file import read_path_file
from report import Report
from scene import Scene
from structure import check_structure
from timing import check_timing

DEFAULT_STEP_MM = 0.5
CERTIFICATE_SLACK = 1e-5
"""How much a claimed clearance may exceed a measured one (m): coal's accuracy and some."""


def recheck(file: Path, package_path: list[str], step: float | None) -> Report:
    """Check a path; `step` in metres, or None to certify the continuum."""
    report = Report()
    path = read_path_file(file)
    scene = Scene(path, search_directories(package_path))
    report.count("segments", len(path.segments))
    report.count("knots", sum(len(segment.knots) for segment in path.segments))
    check_structure(scene, report)
    motions = [SegmentMotion(scene, segment) for segment in path.segments]
    check_timing(scene, motions, report)
    clearance = Clearance(scene, report)
    clearance.check_enclosed(motions[0])
    for motion in motions:
        check_leaf(motion, report)
        clearance.check(motion, step)
    clearance.check_written_end(motions[-1])
    _compare_certificate(path.certificate, report)
    return report


def _compare_certificate(certificate: dict, report: Report) -> None:
    """What the file claims about itself against what was measured."""
    clearance, residual = certificate.get("min_clearance"), certificate.get("max_residual")
    measured = None if report.has("collision") else report.min_distance
    if isinstance(clearance, (int, float)) and measured and clearance > measured["value"] + CERTIFICATE_SLACK:
        subject = f"min_clearance claims {clearance:.6g}, measured at {measured['pair']}"
        report.violate(measured["segment"], measured["t"], "certificate", subject, measured["value"], clearance)
    measured = report.max_residual
    if isinstance(residual, (int, float)) and measured and measured["value"] > residual + 1e-9:
        report.note(f"max_residual claims {residual:.3g}, measured {measured['value']:.3g} at {measured['subject']}")


def _arguments(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("paths", type=Path, nargs="+", metavar="PATH.json", help="path files, or folders that hold them")
    parser.add_argument("--package-path", action="append", default=[], metavar="DIR",
                        help="folder that holds packages (repeatable)")
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--step", type=float, metavar="MM",
                     help=f"no point moves farther than this between samples (default {DEFAULT_STEP_MM})")
    how.add_argument("--adaptive", action="store_true", help="certify the continuum instead of sampling")
    parser.add_argument("--json", action="store_true", help="print one JSON object per file")
    parser.add_argument("--results", type=Path, metavar="FILE.csv",
                        help="keep a row per file here, and skip the files that have one")
    parsed = parser.parse_args(arguments)
    if parsed.step is not None and not parsed.step > 0.0:
        parser.error("--step must be positive")
    return parsed


def _summary(file: Path, mode: str, seconds: float, report: Report) -> str:
    lines = [str(violation) for violation in report.violations]
    lines += [f"note: {note}" for note in report.notes]
    if report.min_distance:
        lines.append("smallest distance seen: {value:.6g} m, segment {segment} t={t:.6g}, {pair}"
                     .format(**report.min_distance))
    if report.max_residual:
        lines.append("largest residual seen: {value:.3g}, segment {segment} t={t:.6g}, {subject}"
                     .format(**report.max_residual))
    lines.append(", ".join(f"{name} {count}" for name, count in report.counts.items()))
    verdict = f"{len(report.violations)} violations" if report.violations else "no violation"
    return "\n".join(lines + [f"{file}: {verdict} ({mode}, {seconds:.1f} s)"])


def _check_one(file: Path, options: argparse.Namespace, mode: str) -> Row:
    """Checks a file and prints what was found."""
    step = None if options.adaptive else (options.step or DEFAULT_STEP_MM) / 1000.0
    start = time.perf_counter()
    sha256 = ""
    try:
        sha256 = digest(file)
        report = recheck(file, options.package_path, step)
    except InputError as error:
        print(json.dumps({"ok": False, "error": str(error)}) if options.json else f"error: {error}",
              file=sys.stdout if options.json else sys.stderr, flush=True)
        return Row(str(file), sha256, mode, "unreadable", 0, time.perf_counter() - start)
    seconds = time.perf_counter() - start
    if options.json:
        versions = {"pinocchio": pinocchio.__version__, "coal": coal.__version__, "numpy": numpy.__version__}
        told = {"file": str(file), **report.to_json(), "mode": mode, "step_mm": step and 1000.0 * step,
                "seconds": seconds}
        print(json.dumps({**told, "versions": versions}, indent=1), flush=True)
    else:
        print(_summary(file, mode, seconds, report), flush=True)
    verdict = "violations" if report.violations else "proved"
    return Row(str(file), sha256, mode, verdict, len(report.violations), round(seconds, 3))


def _check_all(options: argparse.Namespace) -> list[str]:
    """The verdict of every file, from this call or an earlier one."""
    mode = "certified" if options.adaptive else f"sampled every {options.step or DEFAULT_STEP_MM:g} mm"
    results = Results(options.results)
    verdicts = []
    for file in expand(options.paths):
        known = results.verdict(digest(file), mode) if options.results and file.is_file() else None
        if known is None:
            row = _check_one(file, options, mode)
            results.add(row)
            known = row.verdict
        verdicts.append(known)
    return verdicts


def main(arguments: list[str] | None = None) -> int:
    options = _arguments(arguments)
    try:
        verdicts = _check_all(options)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    if len(verdicts) > 1 and not options.json:
        counts = (f"{verdicts.count(verdict)} {verdict}" for verdict in ("proved", "violations", "unreadable"))
        print(f"{len(verdicts)} files: {', '.join(counts)}")
    if "unreadable" in verdicts:
        return 2
    return 1 if "violations" in verdicts else 0


if __name__ == "__main__":
    sys.exit(main())
