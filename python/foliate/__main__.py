"""The program ``foliate``: ``python -m foliate``, or ``foliate`` once the package is installed."""

from __future__ import annotations

import sys

from foliate._foliate import run_program

__all__ = ["main"]


def main() -> int:
    """Runs the program with the arguments of this process; returns its exit code."""
    return run_program(["foliate", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
