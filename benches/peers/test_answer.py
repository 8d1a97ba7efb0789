"""How answers are judged, without HPP; skipped where pinocchio and coal are not installed."""

from __future__ import annotations

import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

try:
    import numpy as np

    import answer
except ImportError:
    raise unittest.SkipTest("pinocchio, coal and numpy are needed") from None

from scene_file import read_scene  # noqa: E402
from settings import Settings  # noqa: E402

SCENE = HERE.parents[1] / "scenes" / "pr2-manipulation-two-hand" / "scene.toml"
SETTINGS = Settings("a test", threshold=1e-3, may_move=1e-2)


class Verdicts(unittest.TestCase):
    def verdict(self, **values) -> str:
        return answer.Finding(**values).verdict(SETTINGS)

    def test_each_kind_of_wrong_answer_has_its_name(self):
        self.assertEqual(self.verdict(depth=9e-5, error=9e-3, goal_off=9e-3), "valid")
        self.assertEqual(self.verdict(depth=1.1e-4), "collides")
        self.assertEqual(self.verdict(error=1.1e-2), "breaks")
        self.assertEqual(self.verdict(goal_off=1.1e-2), "misses")


class Samples(unittest.TestCase):
    def test_the_ends_of_sub_paths_are_always_tested(self):
        knots = np.linspace(0.0, 1.0, 1001)[:, None] * np.array([[0.05, 0.0]])
        pieces = np.repeat([0, 1, 2], [333, 334, 334])
        chosen = answer._coarse(knots, pieces)
        for end in (0, 332, 333, 666, 667, 1000):
            self.assertIn(end, chosen)
        self.assertLess(len(chosen), 12)

    def test_a_path_that_stands_still_has_two_ends(self):
        chosen = answer._coarse(np.zeros((5, 3)), np.zeros(5, dtype=int))
        self.assertEqual(list(chosen), [0, 4])

    def test_runs_of_true_values(self):
        flags = np.array([True, True, False, True, False, False, True])
        self.assertEqual(answer._runs(flags), [slice(0, 2), slice(3, 4), slice(6, 7)])
        self.assertEqual(answer._runs(np.zeros(3, dtype=bool)), [])


class Differences(unittest.TestCase):
    def test_angles_go_the_short_way_and_quaternions_have_two_signs(self):
        scene = read_scene(SCENE)
        one, other = np.array(scene.start), np.array(scene.start)
        theta = scene.coordinates.index("pr2/theta")
        one[theta], other[theta] = np.pi - 1e-3, -np.pi + 1e-3
        turn = scene.coordinates.index("box/qx")
        other[turn:turn + 4] *= -1.0
        difference = answer._difference(scene, one, other)
        self.assertAlmostEqual(abs(difference[theta]), 2e-3)
        self.assertLess(np.abs(np.delete(difference, theta)).max(), 1e-12)

    def test_a_box_elsewhere_is_seen(self):
        scene = read_scene(SCENE)
        one, other = np.array(scene.goal), np.array(scene.start)
        self.assertGreater(np.abs(answer._difference(scene, one, other)).max(), 0.5)


if __name__ == "__main__":
    unittest.main()
