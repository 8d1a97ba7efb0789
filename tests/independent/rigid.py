"""Stacks of rigid poses as plain numpy arrays.

A pose `X_AB` maps points of frame B to frame A: `p_A = rotation @ p_B + translation`. Lengths are metres, angles
radians, quaternions are ordered x y z w. Every operation broadcasts over leading axes, so one `Poses` holds a single
pose or a whole motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio


@dataclass(frozen=True)
class Poses:
    """A stack of poses: `rotation` has shape (..., 3, 3), `translation` (..., 3)."""

    rotation: np.ndarray
    translation: np.ndarray

    @staticmethod
    def identity() -> "Poses":
        return Poses(np.eye(3), np.zeros(3))

    @staticmethod
    def from_array(values) -> "Poses":
        """From (..., 7) numbers x y z qx qy qz qw; the quaternion is normalised."""
        values = np.asarray(values, dtype=float)
        return Poses(rotation_from_quaternion(values[..., 3:7]), values[..., 0:3].copy())

    @staticmethod
    def from_se3(placement: pinocchio.SE3) -> "Poses":
        return Poses(np.array(placement.rotation), np.array(placement.translation))

    @staticmethod
    def planar(x, y, theta) -> "Poses":
        """Pose of a planar root: translation (x, y, 0), rotation theta about z."""
        x, y, theta = (np.asarray(value, dtype=float) for value in (x, y, theta))
        zero, one = np.zeros_like(theta), np.ones_like(theta)
        cos, sin = np.cos(theta), np.sin(theta)
        rows = [np.stack([cos, -sin, zero], -1), np.stack([sin, cos, zero], -1), np.stack([zero, zero, one], -1)]
        return Poses(np.stack(rows, -2), np.stack([x, y, zero], -1))

    def __matmul__(self, other: "Poses") -> "Poses":
        return Poses(self.rotation @ other.rotation, self.apply(other.translation))

    def __getitem__(self, key) -> "Poses":
        """Index the leading axes."""
        return Poses(self.rotation[key], self.translation[key])

    def apply(self, points: np.ndarray) -> np.ndarray:
        """Points of the inner frame, told in the outer one."""
        return np.einsum("...ij,...j->...i", self.rotation, points) + self.translation

    def inverse(self) -> "Poses":
        transposed = np.swapaxes(self.rotation, -1, -2)
        return Poses(transposed, -np.einsum("...ij,...j->...i", transposed, self.translation))

    def to_array(self) -> list[float]:
        """x y z qx qy qz qw of a single pose, with qw >= 0."""
        quaternion = pinocchio.Quaternion(np.ascontiguousarray(self.rotation)).coeffs()
        sign = -1.0 if quaternion[3] < 0.0 else 1.0
        return [float(value) for value in self.translation] + [float(sign * value) for value in quaternion]


def rotation_from_quaternion(quaternion) -> np.ndarray:
    """Rotation matrices of quaternions x y z w; they are normalised first."""
    quaternion = np.asarray(quaternion, dtype=float)
    x, y, z, w = np.moveaxis(quaternion / np.linalg.norm(quaternion, axis=-1, keepdims=True), -1, 0)
    rows = [
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], -1),
        np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], -1),
        np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], -1),
    ]
    return np.stack(rows, -2)


def half_angle_between(first, second) -> np.ndarray:
    """Angle between unit quaternions as 4-vectors, in [0, pi]; half the rotation from one to the other."""
    return 2.0 * np.arctan2(np.linalg.norm(first - second, axis=-1), np.linalg.norm(first + second, axis=-1))


def slerp(first, second, fraction) -> np.ndarray:
    """Geodesic from unit quaternion `first` (fraction 0) to `second` (fraction 1), at constant speed, without
    flipping signs."""
    angle = half_angle_between(first, second)[..., None]
    fraction = np.asarray(fraction, dtype=float)[..., None]
    small = np.sin(angle) < 1e-9
    sine = np.where(small, 1.0, np.sin(angle))
    start = np.where(small, 1.0 - fraction, np.sin((1.0 - fraction) * angle) / sine)
    end = np.where(small, fraction, np.sin(fraction * angle) / sine)
    return start * first + end * second


def log_rotation(rotation: np.ndarray) -> np.ndarray:
    """Rotation vectors of a stack of rotations (pinocchio's log3)."""
    flat = rotation.reshape(-1, 3, 3)
    vectors = np.array([pinocchio.log3(np.ascontiguousarray(matrix)) for matrix in flat]).reshape(-1, 3)
    return vectors.reshape(rotation.shape[:-2] + (3,))


def rotation_angle(rotation: np.ndarray) -> np.ndarray:
    """Angles of a stack of rotations, in [0, pi], exact for small ones."""
    skew = np.stack(
        [
            rotation[..., 2, 1] - rotation[..., 1, 2],
            rotation[..., 0, 2] - rotation[..., 2, 0],
            rotation[..., 1, 0] - rotation[..., 0, 1],
        ],
        -1,
    )
    trace = np.trace(rotation, axis1=-2, axis2=-1)
    return np.arctan2(np.linalg.norm(skew, axis=-1), trace - 1.0)


def angle_between(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Angles between stacks of unit vectors, exact for small ones."""
    return 2.0 * np.arctan2(np.linalg.norm(first - second, axis=-1), np.linalg.norm(first + second, axis=-1))
