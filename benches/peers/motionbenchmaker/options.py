"""Options that the programs share."""

from __future__ import annotations

import argparse
from pathlib import Path


def options(doc: str | None) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=(doc or "").split("\n\n")[0])
    parser.add_argument("file", type=Path, metavar="FILE.json[.gz]")
    parser.add_argument("--urdf", help="the robot's, a path or package:// (default: by the file's robot; known: panda)")
    parser.add_argument("--srdf", help="pairs of links that are not tested")
    parser.add_argument("--packages", action="append", default=[], metavar="DIR", help="where packages are; may be repeated")
    parser.add_argument("--sets", type=lambda text: text.split(","), metavar="A,B", help="only these sets")
    parser.add_argument("--every", type=_above_zero, default=1, metavar="N", help="every Nth problem of a set")
    return parser


def _above_zero(text: str) -> int:
    if (number := int(text)) < 1:
        raise argparse.ArgumentTypeError("is no number above 0")
    return number
