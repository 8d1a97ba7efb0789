"""How paths are measured beside one another, what is kept of them and which of them count, without HPP, OMPL and VAMP."""

from __future__ import annotations

import dataclasses
import json
import math
import os
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import improve  # noqa: E402
import improve_file  # noqa: E402
import plain  # noqa: E402
from improve_file import FIRST, Improved  # noqa: E402
from motion_measure import corners, hermite, length, limits_of, read_motion, stopping_time, unwrapped  # noqa: E402
from rows import ResultsError  # noqa: E402
from solvers import SolverError  # noqa: E402

ROW = Improved("ur3-spheres", "hpp", "spf", 1, FIRST, "solved", 0.5, 10.0, 8.0, 20.0, 7, 4, "valid", "", "hpp-python 9.0.2",
               "a machine", "2026-01-01T00:00:00")
NAMES = ["arm/shoulder", "arm/elbow"]
RATES = {"arm/shoulder": {"velocity": 1.0, "acceleration": 2.0}, "arm/elbow": {"velocity": 2.0, "acceleration": 4.0}}
LIMITS = limits_of(NAMES, RATES)


def row(**values) -> Improved:
    return dataclasses.replace(ROW, **values)


class Lengths(unittest.TestCase):
    def test_steps_add_up(self):
        self.assertAlmostEqual(length(np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 5.0]]), LIMITS), 6.0)

    def test_quaternions_do_not_count(self):
        limits = limits_of(["robot/x", "robot/qw", "robot/qwerty"], {})
        self.assertAlmostEqual(length(np.array([[0.0, 0.0, 0.0], [3.0, 1.0, 4.0]]), limits), 5.0)

    def test_angles_without_limits_do_not_jump(self):
        rows = np.array([[3.1, 3.1], [-3.1, -3.1]])
        self.assertTrue(np.allclose(unwrapped(rows, NAMES, {"arm/elbow"}), [[3.1, 3.1], [-3.1, 2 * math.pi - 3.1]]))

    def test_cubics_are_sampled_as_the_format_says(self):
        # The worked example of docs/path-file.md: 0.09375 rad at 0.36 s.
        rows = hermite(np.array([0.0, 0.72]), np.array([[0.0], [0.3]]), np.array([[0.0], [0.625]]))
        self.assertAlmostEqual(rows[4, 0], 0.09375)
        self.assertAlmostEqual(rows[-1, 0], 0.3)


class TimesWithStops(unittest.TestCase):
    def test_a_short_way_is_a_triangle(self):
        self.assertAlmostEqual(stopping_time([np.array([[0.0, 0.0], [0.5, 0.0]])], LIMITS), 1.0)

    def test_a_long_way_has_a_plateau(self):
        self.assertAlmostEqual(stopping_time([np.array([[0.0, 0.0], [2.0, 0.0]])], LIMITS), 2.5)

    def test_the_slower_joint_counts(self):
        both = stopping_time([np.array([[0.0, 0.0], [2.0, 3.0]])], LIMITS)
        self.assertAlmostEqual(both, 2.5)

    def test_samples_of_a_line_are_one_line(self):
        line = np.linspace([0.0, 0.0], [2.0, 1.0], 50)
        self.assertEqual(len(corners(line)), 1)
        self.assertAlmostEqual(stopping_time(corners(line), LIMITS), 2.5)

    def test_a_corner_is_a_stop(self):
        way = np.array([[0.0, 0.0], [0.25, 0.0], [0.5, 0.0], [0.5, 0.0], [0.5, 1.0]])
        pieces = corners(way)
        self.assertEqual([len(piece) for piece in pieces], [3, 2])
        self.assertAlmostEqual(stopping_time(pieces, LIMITS), 1.0 + 1.0)

    def test_back_and_forth_is_a_stop_too(self):
        self.assertEqual(len(corners(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]))), 2)

    def test_rest_is_no_piece(self):
        self.assertEqual(corners(np.zeros((5, 2))), [])


class PathFiles(unittest.TestCase):
    def path(self, **segment) -> Path:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        file = Path(folder.name) / "path.json"
        still = {"knots": [[0.6, 9.0], [0.6, 9.0]]}
        if "times" in segment:
            still |= {"times": [1.44, 1.64], "velocities": [[0.0, 0.0]] * 2}
        file.write_text(json.dumps({
            "parts": [{"name": "arm", "kind": "robot"}, {"name": "box", "kind": "object"}],
            "coordinates": ["arm/elbow", "box/x"], "segments": [segment, still],
            "events": [{"time": 1.44, "dwell": 0.2}],
        }))
        return file

    def test_dwells_are_left_out_and_objects_too(self):
        motion = read_motion(self.path(knots=[[0.0, 0.0], [0.3, 5.0], [0.6, 9.0]], times=[0.0, 0.72, 1.44],
                                       velocities=[[0.0, 0.0], [0.625, 0.0], [0.0, 0.0]]))
        self.assertEqual((motion.names, motion.grasp_changes), (["arm/elbow"], 1))
        self.assertAlmostEqual(motion.moving_s, 1.44)
        self.assertAlmostEqual(length(motion.rows, limits_of(motion.names, RATES)), 0.6)

    def test_a_path_without_times_has_corners(self):
        motion = read_motion(self.path(knots=[[0.0, 0.0], [0.9, 0.0], [0.6, 9.0]]))
        self.assertIsNone(motion.moving_s)
        self.assertEqual(len(motion.pieces), 2)


class Rows(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = Path(folder.name) / "improvement.csv"

    def test_rows_come_back_as_they_were(self):
        rows = [ROW, row(method="SimpleShortcut", outcome="timeout", length=None, stopping_s=None, own_s=None, pieces=None,
                         grasp_changes=None, verdict="", reason='gave up, "tired"')]
        for one in rows:
            improve_file.add(self.file, one)
        self.assertEqual(improve_file.read(self.file), rows)

    def test_a_number_that_is_none_is_told_with_its_line(self):
        improve_file.add(self.file, ROW)
        self.file.write_text(self.file.read_text().replace(",0.5,", ",soon,"))
        with self.assertRaisesRegex(ResultsError, r"improvement\.csv:2"):
            improve_file.read(self.file)


class Tables(unittest.TestCase):
    def test_the_shortest_right_answer_is_the_best(self):
        rows = [ROW, row(method="a", stopping_s=3.0, verdict="collides"), row(method="b", stopping_s=5.0),
                row(method="c", stopping_s=4.0), row(method="d", stopping_s=None, outcome="timeout")]
        self.assertEqual(improve.better(rows).method, "c")
        self.assertIsNone(improve.better(rows[:2]))

    def test_both_planners_stand_in_a_line(self):
        rows = [ROW, row(method="RandomShortcut", length=6.0, stopping_s=6.0),
                row(planner="foliate", length=5.0, stopping_s=5.5, own_s=None),
                row(planner="foliate", method="default", length=3.0, stopping_s=None, own_s=2.0, seconds=0.25)]
        line = improve.markdown(rows).splitlines()[-1]
        self.assertEqual(line, "| ur3-spheres | 1 | 10.0, 8.0 s, 4 (0.5 s) | 6.0, 6.0 s, 4 (0.5 s) | 6.0, 6.0 s, 4 (0.5 s) | "
                               "5.0, 5.5 s, 4 (0.5 s) | – | 3.0, 2.0 s, 4 (0.25 s) |")

    def test_an_optimiser_is_held_against_its_own_first_path(self):
        rows = [ROW, row(seed=2, length=20.0), row(method="a", length=5.0, stopping_s=4.0),
                row(seed=2, method="a", length=5.0, verdict="collides"), row(seed=3, method="a", outcome="timeout", length=None)]
        self.assertIn("| a | 3 | 1 | 1 | 0.38 | 0.75 |", improve.by_method(rows))

    def test_plain_paths_that_collide_are_counted(self):
        rows = [row(scene="panda-box", planner="ompl", length=4.0, verdict="valid"),
                row(scene="panda-box", planner="ompl", seed=2, length=6.0, verdict="collides"),
                row(scene="panda-box", planner="ompl", seed=3, outcome="timeout", length=None)]
        rows = [dataclasses.replace(one, own_s=None) for one in rows]
        self.assertIn("| panda-box | ompl | first | 2/3 | 5.00 (4.00 to 6.00) | 8.00 | 500 | 1 |", plain.markdown(rows))


class Obstacles(unittest.TestCase):
    def test_all_obstacles_of_the_plain_scenes_can_be_told(self):
        for scene in plain.SCENE_NAMES:
            kinds = {kind for kind, *_ in plain.obstacles(scene)}
            self.assertTrue(kinds and kinds <= {"box", "cylinder", "sphere"}, scene)

    def test_a_shape_is_where_its_urdf_says(self):
        self.assertIn(("cylinder", [0.66, -0.33, 0.92], [0.0, 0.0, 0.0], [0.035, 0.22]), plain.obstacles("panda-shelf"))

    def test_only_what_lies_under_the_ground_is_lowered(self):
        self.assertAlmostEqual(plain.lowered([0.4, 0.0, -0.03], [1.6, 1.6, 0.04])[2], -0.03 - plain.BELOW)
        self.assertEqual(plain.lowered([0.4, 0.0, 0.01], [1.0, 1.0, 0.04]), [0.4, 0.0, 0.01])

    def test_a_mesh_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "odd").mkdir()
            (Path(folder) / "odd" / "odd.urdf").write_text(
                '<robot><link><collision><geometry><mesh filename="a"/></geometry></collision></link></robot>')
            with self.assertRaises(SolverError):
                plain.obstacles("odd", Path(folder))


class Children(unittest.TestCase):
    def test_what_was_told_before_a_crash_is_kept(self):
        def work():
            yield {"method": FIRST, "seconds": 1.0}
            os.kill(os.getpid(), 11)

        first, last = plain.in_child(work)
        self.assertEqual(first, {"method": FIRST, "seconds": 1.0})
        self.assertEqual((last["method"], last["outcome"], last["reason"]), ("after first", "crashed", "SIGSEGV"))

    def test_what_does_not_end_is_ended(self):
        def work():
            while True:
                pass
            yield {}

        self.assertEqual([told["outcome"] for told in plain.in_child(work, 1)], ["timeout"])

    def test_what_ends_tells_all(self):
        self.assertEqual(plain.in_child(lambda: iter([{"seconds": 1}, {"seconds": 2}])), [{"seconds": 1}, {"seconds": 2}])


if __name__ == "__main__":
    unittest.main()
