"""MotionBenchMaker's problems for peers: the file, what becomes of archives, the table, and coal's verdicts. Parts whose packages are
missing are skipped."""

from __future__ import annotations

import gzip
import importlib.util
import io
import json
import sys
import tarfile
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "motionbenchmaker"))

import problems  # noqa: E402
from problems import GOAL, SOLVED, START, ProblemsError, Row  # noqa: E402


def has(*packages: str) -> bool:
    return all(importlib.util.find_spec(package) for package in packages)


DOCUMENT = {"robot": "planar", "sets": {"few": [
    {"index": 1, "start": {"a": 0.0, "b": 0.0, "finger": 0.065, "wheel": 1.0}, "goal": {"a": 1.5, "b": 0.501}, "obstacles": [
        {"name": "ball", "type": "sphere", "radius": 0.1, "xyz": [-0.9, 0.0, 0.0], "quaternion": [0, 0, 0, 1]},
        {"name": "post", "type": "cylinder", "length": 0.5, "radius": 0.05, "xyz": [0.6, 0.6, 0.0], "quaternion": [0, 0, 0, 1]}]},
    {"index": 2, "start": {"a": 0.0, "b": 0.0, "finger": 0.01}, "goal": {"a": 1.5, "b": 0.0}, "obstacles": [
        {"name": "wall", "type": "box", "size": [0.2, 0.2, 0.2], "xyz": [0.0, 0.5, 0.0], "quaternion": [0, 0, 0, 1]}]}]}}

URDF = """<robot name="planar"><link name="base"/>
<link name="upper"><collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.02 0.02"/></geometry></collision></link>
<link name="lower"><collision><origin xyz="0.21 0 0"/><geometry><box size="0.38 0.02 0.02"/></geometry></collision></link>
<link name="tip"/>
<joint name="a" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
 <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
<joint name="b" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.42 0 0"/><axis xyz="0 0 1"/>
 <limit lower="-0.5" upper="0.5" effort="1" velocity="1"/></joint>
<joint name="finger" type="prismatic"><parent link="lower"/><child link="tip"/><axis xyz="0 1 0"/>
 <limit lower="0" upper="0.04" effort="1" velocity="1"/></joint></robot>"""

SCENE = """
world:
  collision_objects:
    - id: can
      primitives: [{type: cylinder, dimensions: [0.12, 0.03]}]
      primitive_poses: [{position: [1, 0, 0], orientation: [0, 0, 0, 1]}]
      pose: {position: [0, 0, 2], orientation: [0, 0, 0.7071067811865476, 0.7071067811865476]}
"""
REQUEST = """
start_state: {joint_state: {name: [a, finger], position: [0, 0.065]}}
goal_constraints: [{joint_constraints: [{joint_name: a, position: 1}]}]
"""


class Folder(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def write(self, name: str, document: dict) -> Path:
        file = self.folder / name
        text = json.dumps(document).encode()
        file.write_bytes(gzip.compress(text) if name.endswith(".gz") else text)
        return file


class TheFile(Folder):
    def test_it_is_read_as_it_is_and_compressed(self):
        for name in ("few.json", "few.json.gz"):
            robot, found = problems.read(self.write(name, DOCUMENT))
            self.assertEqual((robot, [(p.set, p.index) for p in found]), ("planar", [("few", 1), ("few", 2)]))
            self.assertEqual([o.sizes for p in found for o in p.obstacles], [(0.1,), (0.5, 0.05), (0.2, 0.2, 0.2)])

    def test_every_second_and_sets_by_name(self):
        file = self.write("few.json", DOCUMENT)
        self.assertEqual([p.index for p in problems.read(file, every=2)[1]], [1])
        with self.assertRaisesRegex(ProblemsError, "no set many; it has few"):
            problems.read(file, ["many"])

    def test_what_is_wrong_names_the_file(self):
        file = self.folder / "few.json"
        for text, words in (("{", "few.json"), ('{"robot": "planar"}', "sets"), ("[]", "not of the form"),
                            (json.dumps(DOCUMENT).replace("sphere", "cone"), "cone"),
                            (json.dumps(DOCUMENT).replace("0.1,", "-0.1,"), "ball: sizes are above 0")):
            file.write_text(text)
            with self.assertRaisesRegex(ProblemsError, f"few.json.*{words}|{words}"):
                problems.read(file)


class TheTable(unittest.TestCase):
    def test_milliseconds_are_of_what_is_solved(self):
        rows = [Row("a", n, SOLVED, n / 1000) for n in range(1, 21)] + [Row("b", 1, GOAL, 0.0), Row("b", 2, START, 0.0), Row("b", 3, "timeout", 9.0)]
        lines = problems.table(rows).splitlines()
        self.assertEqual(lines[2], "| a | 20 | 0 | 0 | 20 | 0 | 10 | 19 | 20 |")
        self.assertEqual(lines[3], "| b | 3 | 1 | 1 | 0 | 1 | - | - | - |")
        self.assertEqual(lines[4], "| all | 23 | 1 | 1 | 20 | 1 | 10 | 19 | 20 |")


@unittest.skipUnless(has("numpy", "yaml"), "needs numpy and PyYAML")
class Archives(Folder):
    def archive(self, members: dict[str, str]) -> Path:
        file = self.folder / "problems.tar.bz2"
        with tarfile.open(file, "w:bz2") as tar:
            for name, text in members.items():
                info = tarfile.TarInfo(f"problems/few_planar/{name}")
                info.size = len(text)
                tar.addfile(info, io.BytesIO(text.encode()))
        return file

    def test_scenes_and_requests_become_problems(self):
        from convert import convert

        document = convert(self.archive({"scene0007.yaml": SCENE, "request0007.yaml": REQUEST}), "planar")
        self.assertEqual(list(document["sets"]), ["few"])
        _, (problem,) = problems.read(self.write("few.json", document))
        self.assertEqual((problem.index, problem.start, problem.goal), (7, {"a": 0.0, "finger": 0.065}, {"a": 1.0}))
        (can,) = problem.obstacles
        self.assertEqual((can.kind, can.sizes), ("cylinder", (0.12, 0.03)))
        # The pose of the primitive is given in that of the object, which is turned by a right angle.
        for told, right in zip((*can.xyz, *can.quaternion), (0, 1, 2, 0, 0, 0.5**0.5, 0.5**0.5)):
            self.assertAlmostEqual(told, right)

    def test_what_is_missing_is_named(self):
        from convert import ConvertError, convert

        with self.assertRaisesRegex(ConvertError, r"\('few', 7\) has one of them"):
            convert(self.archive({"scene0007.yaml": SCENE}), "planar")
        with self.assertRaisesRegex(ConvertError, "request0007.yaml.*start_state"):
            convert(self.archive({"scene0007.yaml": SCENE, "request0007.yaml": "a: 1"}), "planar")


@unittest.skipUnless(has("numpy", "pinocchio", "coal"), "needs pin and coal")
class ByCoal(Folder):
    def setUp(self):
        super().setUp()
        from robot_world import Robot, World

        urdf = self.folder / "planar.urdf"
        urdf.write_text(URDF)
        robot = Robot("planar", str(urdf), None, [])
        self.worlds = [World(robot, problem) for problem in problems.read(self.write("few.json", DOCUMENT))[1]]

    def test_goals_in_solids_are_found(self):
        from collisions import infeasible

        self.assertEqual([infeasible(world) for world in self.worlds], [None, GOAL])
        free, blocked = (world.nearest(world.goal) for world in self.worlds)
        self.assertGreater(free[0], 0.0)
        self.assertLessEqual(blocked[0], 0.0)
        self.assertIn("obstacle wall", blocked[1])

    def test_values_are_moved_onto_bounds(self):
        world = self.worlds[0]
        self.assertEqual(list(world.goal), [1.5, 0.5])
        self.assertEqual(list(world.base), [0.0, 0.0, 0.04])
        self.assertAlmostEqual(world.beyond([1.5, 0.75]), 0.25)


if __name__ == "__main__":
    unittest.main()
