"""Poses in the forms in which people have them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["matrices", "pose"]


def pose(value: ArrayLike) -> list[float]:
    """A pose as x, y, z (metres) and the quaternion x, y, z, w.

    ``value`` is that already, or x, y, z alone (not turned), or a homogeneous matrix of shape (4, 4).

    Raises ``ValueError`` for anything else, and for a matrix that is no rigid motion.
    """
    array = np.asarray(value, dtype=float)
    if array.shape == (3,):
        return [*array.tolist(), 0.0, 0.0, 0.0, 1.0]
    if array.shape == (7,):
        return [float(x) for x in array]
    if array.shape != (4, 4):
        raise ValueError(f"a pose has 3 or 7 numbers, or is a matrix of shape (4, 4), not {array.shape}")
    rotation = array[:3, :3]
    rigid = np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-6) and np.linalg.det(rotation) > 0
    if not rigid or not np.allclose(array[3], [0, 0, 0, 1], atol=1e-9):
        raise ValueError("the matrix is no rigid motion: its upper left part is no rotation, or its last row is not 0, 0, 0, 1")
    return [*array[:3, 3].tolist(), *_quaternion(rotation)]


def _quaternion(rotation: NDArray[np.float64]) -> list[float]:
    """x, y, z, w of a rotation matrix: the eigenvector of the largest eigenvalue of Bar-Itzhack's symmetric matrix (2000)."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation
    symmetric = np.array(
        [
            [xx - yy - zz, yx + xy, zx + xz, zy - yz],
            [yx + xy, yy - xx - zz, zy + yz, xz - zx],
            [zx + xz, zy + yz, zz - xx - yy, yx - xy],
            [zy - yz, xz - zx, yx - xy, xx + yy + zz],
        ]
    )
    vector = np.linalg.eigh(symmetric)[1][:, -1]
    vector = vector / np.linalg.norm(vector)
    return [float(x) for x in (vector if vector[3] >= 0 else -vector)]


def matrices(poses: ArrayLike) -> NDArray[np.float64]:
    """Homogeneous matrices of shape (..., 4, 4) of poses of shape (..., 7): x, y, z and the quaternion x, y, z, w."""
    array = np.asarray(poses, dtype=float)
    x, y, z, w = np.moveaxis(array[..., 3:], -1, 0)
    made = np.zeros((*array.shape[:-1], 4, 4))
    made[..., :3, 3] = array[..., :3]
    made[..., 3, 3] = 1.0
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    for i, row in enumerate(rows):
        for j, numbers in enumerate(row):
            made[..., i, j] = numbers
    return made
