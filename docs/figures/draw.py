#!/usr/bin/env python3
"""Draws the figures of the documentation, with the standard library of Python alone.

    cargo build --release
    python3 docs/figures/draw.py target/release/foliate

`demo.svg` shows what the program says of its scene `demo`; the other figures are sketches.
"""

import sys
from pathlib import Path

import concepts
import demo

if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    here = Path(__file__).resolve().parent
    demo.draw(str(Path(sys.argv[1]).resolve()), here)
    concepts.draw(here)
