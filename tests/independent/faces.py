"""Faces that an SRDF cuts into pieces: whether the file's polygons are these pieces, joined."""

from __future__ import annotations

import numpy as np

SLACK = 2e-5
"""How far corners may be off a plane, beyond an edge or over one another (m)."""


def are_joined(wholes: list[np.ndarray], pieces: list[np.ndarray]) -> bool:
    """Each of the file's polygons `wholes` is convex and filled by pieces that do not overlap; no piece is left over."""
    inside = [[piece for piece in pieces if _is_in(whole, piece)] for whole in wholes]
    filled = all(_is_in(whole, whole) and _fill(whole, parts) for whole, parts in zip(wholes, inside))
    return filled and sum(len(parts) for parts in inside) == len(pieces)


def _fill(whole: np.ndarray, parts: list[np.ndarray]) -> bool:
    around = np.linalg.norm(np.roll(whole, -1, axis=0) - whole, axis=1).sum()
    apart = all(_apart(a, b) for index, a in enumerate(parts) for b in parts[:index])
    return apart and abs(np.linalg.norm(_area(whole)) - sum(np.linalg.norm(_area(part)) for part in parts)) <= SLACK * around


def _is_in(whole: np.ndarray, piece: np.ndarray) -> bool:
    up, of_piece = _unit(_area(whole)), _unit(_area(piece))
    if up is None or of_piece is None or up @ of_piece <= 0.999:
        return False
    return bool(np.abs((piece - whole[0]) @ up).max() <= SLACK and _beyond(whole, piece).max() <= SLACK)


def _apart(one: np.ndarray, other: np.ndarray) -> bool:
    """An edge of one has all of the other beyond it."""
    return any((_beyond(a, b).min(axis=0) >= -SLACK).any() for a, b in ((one, other), (other, one)))


def _beyond(polygon: np.ndarray, points: np.ndarray) -> np.ndarray:
    """How far each point is beyond each edge of length; points by edges."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    out = np.cross(edges, _unit(_area(polygon)))
    length = np.linalg.norm(out, axis=1)
    real = length > 0.0
    return (points @ out[real].T - (polygon[real] * out[real]).sum(axis=1)) / length[real]


def _area(polygon: np.ndarray) -> np.ndarray:
    corners = polygon - polygon[0]
    return np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0) / 2.0


def _unit(vector: np.ndarray) -> np.ndarray | None:
    length = np.linalg.norm(vector)
    return None if length == 0.0 else vector / length
