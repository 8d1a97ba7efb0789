"""How objects rest: the rule stable, and faces that an SRDF cuts into pieces."""

from __future__ import annotations

import unittest

import numpy as np

from faces import are_joined
from leaves import placement_errors
from path_file import Surface
from rigid import Poses


def square(half: float, z: float = 0.0) -> np.ndarray:
    return np.array([[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]])


class Stable(unittest.TestCase):
    def worst(self, at: float, mass: float, margin: float) -> float:
        """Of a box of 100 mm that lies at x on a support of 400 mm, with its mass beside its middle."""
        support = Surface("table/top", square(0.2), [np.arange(4)])
        lying = Surface("box/box", square(0.05)[::-1].copy(), [np.arange(4)])
        pose = Poses.from_array(np.array([[at, 0.0, 0.001, 0.0, 0.0, 0.0, 1.0]]))
        errors = placement_errors(pose, lying, support, 0.001, ("stable", margin), np.array([mass, 0.0, 0.05]))
        return max(float(rows.max()) for rows in errors.values())

    def test_the_mass_is_over_the_support(self):
        self.assertLess(self.worst(0.19, 0.0, 0.005), 1e-9)
        self.assertAlmostEqual(self.worst(0.197, 0.0, 0.005), 0.002)
        self.assertAlmostEqual(self.worst(0.19, 0.02, 0.005), 0.015)
        self.assertLess(self.worst(0.21, -0.02, 0.005), 1e-9)

    def test_the_mass_is_over_the_objects_own_face(self):
        self.assertLess(self.worst(0.0, 0.045, 0.005), 1e-9)
        self.assertAlmostEqual(self.worst(0.0, 0.048, 0.005), 0.003)


class Faces(unittest.TestCase):
    def test_only_the_whole_of_its_pieces_is_accepted(self):
        whole = square(1.0)
        lower, upper = whole[[0, 1, 2]], whole[[0, 2, 3]]
        self.assertTrue(are_joined([whole], [lower, upper]))
        self.assertTrue(are_joined([lower, upper], [lower, upper]))
        self.assertFalse(are_joined([square(1.001)], [lower, upper]))
        self.assertFalse(are_joined([lower], [lower, upper]))
        self.assertFalse(are_joined([whole], [lower, lower]))
        self.assertFalse(are_joined([whole], [lower]))
        self.assertFalse(are_joined([whole[::-1]], [lower, upper]))
        self.assertFalse(are_joined([square(1.0, 0.001)], [lower, upper]))


if __name__ == "__main__":
    unittest.main()
