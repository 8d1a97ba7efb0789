"""The program ``foliate``: ``python -m foliate``, or ``foliate`` once the package is installed. ``foliate dataset`` is Python's own."""

from __future__ import annotations

import sys

from foliate._foliate import run_program

__all__ = ["main"]


def main() -> int:
    """Runs the program with the arguments of this process; returns its exit code."""
    if sys.argv[1:2] == ["dataset"]:
        from foliate.dataset.command import run

        return run(sys.argv[2:])
    return run_program(["foliate", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
