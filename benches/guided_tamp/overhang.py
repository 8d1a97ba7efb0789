"""How far a polygon hangs over the edges of a convex one, both level."""

from __future__ import annotations

import numpy as np


def overhang(corners: np.ndarray, support: np.ndarray) -> float:
    """The largest distance (metres) of a corner outside a side's line of `support`; 0 where none is outside.

    Both are n x 2, in one plane; `support` is convex and counter-clockwise."""
    worst = 0.0
    for here, there in zip(support, np.roll(support, -1, axis=0)):
        side = there - here
        out = np.array([side[1], -side[0]]) / np.linalg.norm(side)
        worst = max(worst, float(((corners - here) @ out).max()))
    return worst


def counter_clockwise(polygon: np.ndarray) -> np.ndarray:
    x, y = polygon[:, 0], polygon[:, 1]
    area = float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    return polygon if area > 0.0 else polygon[::-1]
