"""Poses that lie on a support almost, put onto it exactly."""

from __future__ import annotations

import numpy as np

GAP_M = 0.001
"""Between what rests and its support: Foliate's default, and HPP's of this package's poses."""
NEAR = 2e-3
"""A pose that would have to be moved by more (metres, radians) is not one that rests."""


class RestError(Exception):
    """A pose that lies on no support."""


def outward(polygon: np.ndarray) -> np.ndarray:
    """The normal of a polygon that is written counter-clockwise as seen from outside."""
    normal = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[1])
    return normal / np.linalg.norm(normal)


def put_down(pose: np.ndarray, surfaces: list[np.ndarray], heights: list[float]) -> tuple[np.ndarray, float]:
    """`pose` (4 x 4, in the world) with one of the object's `surfaces` (polygons) flat and `GAP_M` above one of
    `heights` (of supports, which are all level). The second value is how far that is from `pose` (metres, radians)."""
    found = min((_onto(pose, polygon, height) for polygon in surfaces for height in heights), key=lambda one: one[1])
    if found[1] > NEAR:
        raise RestError(f"it would have to be moved by {found[1]:.3g} to rest")
    return found


def _onto(pose: np.ndarray, polygon: np.ndarray, height: float) -> tuple[np.ndarray, float]:
    turn, centre = pose[:3, :3], polygon.mean(axis=0)
    down = np.array([0.0, 0.0, -1.0])
    normal = turn @ outward(polygon)
    axis = np.cross(normal, down)
    angle = float(np.arctan2(np.linalg.norm(axis), normal @ down))
    if angle > NEAR:
        return pose, angle
    put = pose.copy()
    put[:3, :3] = _rotation(axis, angle) @ turn
    # The middle of the surface stays where it is in x and y.
    at = turn @ centre + pose[:3, 3]
    put[:3, 3] = np.array([at[0], at[1], height + GAP_M]) - put[:3, :3] @ centre
    return put, max(angle, float(np.linalg.norm(put[:3, 3] - pose[:3, 3])))


def _rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' formula."""
    length = np.linalg.norm(axis)
    if length < 1e-12:
        return np.eye(3)
    x, y, z = axis / length
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
