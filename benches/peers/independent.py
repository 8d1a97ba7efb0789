"""The modules of `tests/independent` that this comparison shares: where models lie, and other people's kinematics and
geometry. They are not a package, so their folder goes on the path here, and only here."""

import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[2] / "tests" / "independent"
sys.path.insert(0, str(FOLDER))

from packages import InputError, resolve, search_directories  # noqa: E402

__all__ = ["FOLDER", "InputError", "resolve", "search_directories"]
