"""The checker must be able to fail: good paths pass, and every kind of wrong path is reported by its name.

    python3 -m unittest tests/independent/test_recheck.py        (pin, coal and numpy from PyPI)

The models are small and built here: an arm of two links in the plane z = 0.5, a table whose top is one millimetre
below the arm, a cube, a thin plate. `Story` is a valid path (reach for the cube, carry it, let go) that each test
spoils in one way.
"""

from __future__ import annotations

import copy
import io
import json
import math
import sys
import tempfile
import unittest
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

try:
    import numpy as np

    import clearance
    import distances
    import kinematics
    import recheck
    from packages import InputError, resolve
    from rigid import Poses, rotation_angle, slerp
    from structure import _geodesic_extremes

    MISSING = None
except ModuleNotFoundError as error:
    MISSING = f"{error}: pip install pin coal numpy"


def setUpModule():
    if MISSING:
        raise unittest.SkipTest(MISSING)


IDENTITY = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
MASS = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def link(name: str, size=None, at=(0, 0, 0), geometry: str | None = None) -> str:
    """A link with one collision shape, by default a box."""
    if size is None and geometry is None:
        return f'<link name="{name}">{MASS}</link>'
    geometry = geometry or f'<box size="{size[0]} {size[1]} {size[2]}"/>'
    origin = f'<origin xyz="{at[0]} {at[1]} {at[2]}"/>'
    return f'<link name="{name}">{MASS}<collision>{origin}<geometry>{geometry}</geometry></collision></link>'


def joint(name: str, parent: str, child: str, at, kind="revolute", axis="0 0 1", extra="", limit=(-3, 3)) -> str:
    bounds = "" if kind == "continuous" else f'<limit lower="{limit[0]}" upper="{limit[1]}" effort="1" velocity="1"/>'
    return (
        f'<joint name="{name}" type="{kind}"><origin xyz="{at[0]} {at[1]} {at[2]}"/><axis xyz="{axis}"/>'
        f'<parent link="{parent}"/><child link="{child}"/>{bounds}{extra}</joint>'
    )


def robot(*elements: str) -> str:
    return '<robot name="model">' + "".join(elements) + "</robot>"


ARM = robot(
    link("base"),
    link("upper", (0.4, 0.04, 0.04), (0.25, 0, 0)),
    link("lower", (0.4, 0.04, 0.04), (0.25, 0, 0)),
    joint("shoulder", "base", "upper", (0, 0, 0.5)),
    joint("elbow", "upper", "lower", (0.5, 0, 0)),
)
ARM_SRDF = (
    '<robot name="model"><disable_collisions link1="upper" link2="lower"/>'
    '<gripper name="hand"><position>0.5 0 0  1 0 0 0</position><link name="lower"/></gripper></robot>'
)
CUBE = robot(link("cube", (0.04, 0.04, 0.04)))
TABLE = robot(link("top", (0.4, 0.6, 0.02)))
PLATE = robot(link("plate", (0.1, 0.001, 0.2)))
TABLE_POSE = [0.95, 0.0, 0.469, 0.0, 0.0, 0.0, 1.0]
CUBE_BOTTOM = [[-0.02, -0.02, -0.02], [-0.02, 0.02, -0.02], [0.02, 0.02, -0.02], [0.02, -0.02, -0.02]]
TABLE_TOP = [[0.2, 0.3, 0.01], [-0.2, 0.3, 0.01], [-0.2, -0.3, 0.01], [0.2, -0.3, 0.01]]
PLACED = {"object": "cube", "surface": "cube/bottom", "support": "table/top", "carrier": True}
HELD = {"object": "cube", "gripper": "arm/hand", "handle": "cube/handle", "carrier": True}


def part(name: str, kind: str, root="fixed", pose=IDENTITY, **more) -> dict:
    return {"name": name, "kind": kind, "urdf": f"{more.pop('urdf', name)}.urdf", "srdf": None, "mimic": "follow",
            "root": root, "world_from_root": list(pose), **more}


def pose_about_z(x: float, y: float, z: float, yaw: float) -> list[float]:
    return [x, y, z, 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)]


def cube_in_hand(shoulder: float, elbow: float) -> list[float]:
    """World pose of the cube whose centre is at the arm's tip."""
    turn = shoulder + elbow
    x = 0.5 * math.cos(shoulder) + 0.5 * math.cos(turn)
    return pose_about_z(x, 0.5 * math.sin(shoulder) + 0.5 * math.sin(turn), 0.5, turn)


def knot(shoulder: float, elbow: float, cube: list[float] | None = None) -> list[float]:
    return [shoulder, elbow] + (cube or cube_in_hand(shoulder, elbow))


def story() -> dict:
    """A valid path: the arm closes on the cube, carries it along the table, and leaves."""
    start, end = cube_in_hand(0, 0), cube_in_hand(0.1, 0)
    coordinates = ["arm/shoulder", "arm/elbow"] + [f"cube/{name}" for name in ("x", "y", "z", "qx", "qy", "qz", "qw")]
    return {
        "format": "foliate.path/1", "scene": "story", "seed": 1, "scheduler": "hand", "simd": "none",
        "parts": [part("arm", "robot", srdf="arm.srdf"), part("table", "environment", pose=TABLE_POSE),
                  part("cube", "object", root="freeflyer")],
        "coordinates": coordinates,
        "limits": {"arm/shoulder": [-3, 3], "arm/elbow": [-3, 3],
                   "cube/x": [0, 2], "cube/y": [-1, 1], "cube/z": [0, 1]},
        "documents": {
            "grippers": {"arm/hand": {"link": "arm/lower", "link_from_gripper": [0.5, 0, 0, 0, 0, 0, 1]}},
            "handles": {"cube/handle": {"link": "cube/cube", "link_from_handle": IDENTITY, "mask": [True] * 6,
                                        "mask_complement": [False] * 6}},
            "surfaces": {"cube/bottom": {"link": "cube/cube", "points": CUBE_BOTTOM, "polygons": [[0, 1, 2, 3]]},
                         "table/top": {"link": "table/top", "points": TABLE_TOP, "polygons": [[0, 1, 2, 3]]}},
        },
        "ignored_pairs": [], "margins": [], "placement_margin": 0.001,
        "segments": [
            {"transition": "reach", "state": "free", "attachments": [PLACED], "constraints": [],
             "knots": [knot(0, -0.6, start), knot(0, -0.3, start), knot(0, 0, start)]},
            {"transition": "carry", "state": "held", "attachments": [HELD], "constraints": [],
             "knots": [knot(0, 0), knot(0.05, 0), knot(0.1, 0, end)]},
            {"transition": "leave", "state": "free", "attachments": [PLACED], "constraints": [],
             "knots": [knot(0.1, 0, end), knot(0.1, -0.6, end)]},
        ],
        "certificate": {"path_tolerance": 2e-4, "max_residual": 1e-9, "min_clearance": 5e-4, "joint_limits": "within"},
    }


class Case(unittest.TestCase):
    """Writes models and paths to a temporary folder and checks them."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.write("arm.urdf", ARM)
        self.write("arm.srdf", ARM_SRDF)
        self.write("cube.urdf", CUBE)
        self.write("table.urdf", TABLE)
        self.write("plate.urdf", PLATE)

    def write(self, name: str, text: str) -> Path:
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def check(self, path: dict, step: float | None = None):
        return recheck.recheck(self.write("path.json", json.dumps(path)), [], step)

    def kinds(self, path: dict, step: float | None = None) -> set[str]:
        return {violation.kind for violation in self.check(path, step).violations}

    def assert_only(self, path: dict, *kinds: str):
        for step in (None, 0.0005):
            report = self.check(path, step)
            found = {violation.kind for violation in report.violations}
            self.assertEqual(found, set(kinds), "\n".join(map(str, report.violations)))


class GoodPaths(Case):
    def test_the_story_is_valid(self):
        self.assert_only(story())
        report = self.check(story())
        self.assertAlmostEqual(report.min_distance["value"], 0.001, places=6)

    def test_the_program_says_so(self):
        file = self.write("path.json", json.dumps(story()))
        with redirect_stdout(io.StringIO()) as output:
            self.assertEqual(recheck.main([str(file), "--json"]), 0)
        told = json.loads(output.getvalue())
        self.assertTrue(told["ok"])
        self.assertEqual(told["step_mm"], 0.5)

    def test_many_files_in_one_call_that_goes_on_where_it_was(self):
        spoiled = story()
        spoiled["segments"][0]["knots"][1][0] = 5.0
        results = self.folder / "results.csv"
        paths = self.folder / "paths"
        paths.mkdir()
        for name in ("arm.urdf", "arm.srdf", "cube.urdf", "table.urdf"):
            (paths / name).write_text((self.folder / name).read_text())
        (paths / "a.json").write_text(json.dumps(story()))
        (paths / "b.json").write_text(json.dumps(spoiled))

        def told() -> tuple[int, str]:
            with redirect_stdout(io.StringIO()) as output:
                code = recheck.main([str(paths), "--adaptive", "--results", str(results)])
            return code, output.getvalue()

        code, output = told()
        self.assertEqual((code, "a.json: no violation" in output), (1, True))
        self.assertIn("2 files: 1 proved, 1 violations, 0 unreadable", output)
        rows = results.read_text().splitlines()
        self.assertEqual((len(rows), rows[0]), (3, "file,sha256,mode,verdict,violations,seconds"))
        self.assertEqual(told(), (1, "2 files: 1 proved, 1 violations, 0 unreadable\n"))
        (paths / "b.json").write_text(json.dumps(story()) + "\n")
        code, output = told()
        self.assertEqual((code, "a.json" in output, "b.json" in output), (0, False, True))

    def test_a_joint_that_mimics_is_computed(self):
        follower = joint("tip", "lower", "finger", (0.5, 0.3, 0), extra='<mimic joint="elbow" multiplier="-1"/>')
        self.write("arm.urdf", ARM.replace("</robot>", link("finger", (0.01, 0.01, 0.01)) + follower + "</robot>"))
        self.assert_only(story())
        path = story()
        path["parts"][0]["mimic"] = "free"
        with self.assertRaisesRegex(InputError, "arm/tip"):
            self.check(path)

    def test_a_follower_obeys_its_limits(self):
        follower = joint("tip", "lower", "finger", (0.5, 0.3, 0), extra='<mimic joint="elbow" multiplier="-1"/>',
                         limit=(-1, 0.5))
        self.write("arm.urdf", ARM.replace("</robot>", link("finger") + follower + "</robot>"))
        self.assert_only(story(), "follower-limit")


class Collisions(Case):
    def with_plate(self, radius: float, angle: float) -> dict:
        """The story with a thin plate in the elbow's way, touched only between the knots."""
        path = story()
        x, y = 0.5 + radius * math.cos(angle), radius * math.sin(angle)
        path["parts"].append(part("plate", "environment", pose=pose_about_z(x, y, 0.5, angle)))
        return path

    def test_an_elbow_opens_past_a_thin_plate_between_two_knots(self):
        path = self.with_plate(0.3, -0.15)
        self.assert_only(path, "collision")
        found = self.check(path).violations[0]
        self.assertEqual((found.segment, found.subject), (0, "arm/lower - plate/plate"))
        self.assertTrue(1.0 < found.t < 2.0)

    def test_a_plate_out_of_reach_is_free(self):
        self.assert_only(self.with_plate(0.52, -0.15))

    def test_a_carried_cube_swings_past_a_thin_post(self):
        path = story()
        self.write("post.urdf", robot(link("post", (0.001, 0.001, 0.05))))
        pose = pose_about_z(1.015 * math.cos(0.075), 1.015 * math.sin(0.075), 0.5, 0.0)
        path["parts"].append(part("post", "environment", pose=pose))
        path["segments"][1]["knots"] = [knot(0, 0), knot(0.2, 0)]
        path["segments"][2]["knots"] = [knot(0.2, 0), knot(0.2, -0.6, cube_in_hand(0.2, 0))]
        self.assert_only(path, "collision")
        self.assertEqual(self.check(path).violations[0].subject, "cube/cube - post/post")

    def test_ignored_pairs_are_ignored_and_told(self):
        path = self.with_plate(0.3, -0.15)
        path["ignored_pairs"] = [["arm/lower", "plate/plate", "by hand"]]
        self.assert_only(path)
        self.assertIn("1 link pairs ignored by the file: by hand", self.check(path).notes)

    def test_pairs_disabled_by_srdf_come_from_the_srdf(self):
        self.write("arm.urdf", ARM.replace('<box size="0.4 0.04 0.04"/>', '<box size="0.6 0.04 0.04"/>', 1))
        self.assert_only(story())
        self.write("arm.srdf", ARM_SRDF.replace('link1="upper"', 'link1="base"'))
        self.assert_only(story(), "collision")

    def test_margins_are_kept_but_not_where_things_touch(self):
        path = story()
        path["margins"] = [["arm/upper", "table/top", 0.05]]
        path["certificate"] = {"path_tolerance": 2e-4}
        self.assert_only(path)
        path["margins"] = [["arm/lower", "table/top", 0.01]]
        self.assert_only(path, "margin")
        path["margins"] = [["cube/cube", "table/top", 0.01], ["arm/lower", "cube/cube", 0.05]]
        self.assert_only(path)

    def test_margins_are_lifted_along_the_whole_transition_that_ends_the_touch(self):
        path, cube = story(), cube_in_hand(0.1, 0)
        path["margins"], path["certificate"] = [["arm/lower", "cube/cube", 0.05]], {"path_tolerance": 2e-4}
        path["segments"][2]["knots"] = [knot(0.1, 0, cube), knot(0.1, -0.05, cube)]
        further = {**path["segments"][2], "knots": [knot(0.1, -0.05, cube), knot(0.1, -0.6, cube)]}
        path["segments"].append(further)
        self.assert_only(path)
        further["transition"] = "go on"
        self.assert_only(path, "margin")

    def test_a_robot_turns_on_the_geodesic_into_a_post(self):
        self.write("bar.urdf", robot(link("bar", (1.0, 0.02, 0.02))))
        self.write("post.urdf", robot(link("post", (0.002, 0.002, 0.5))))
        path = story()
        beside = pose_about_z(0.45 * math.cos(0.7), 0.45 * math.sin(0.7), 0, 0)
        path["parts"] = [part("bar", "robot", root="freeflyer"), part("post", "environment", pose=beside)]
        path["coordinates"] = [f"bar/{name}" for name in ("x", "y", "z", "qx", "qy", "qz", "qw")]
        path["limits"], path["documents"], path["certificate"] = {}, {}, {}
        path["segments"] = [{"knots": [pose_about_z(0, 0, 0, 0), pose_about_z(0, 0, 0, 1.5)]}]
        self.assert_only(path, "collision")
        path["segments"][0]["knots"] = [pose_about_z(0, 0, 1, 0), pose_about_z(0, 0, 1, 1.5)]
        self.assert_only(path)

    def test_a_planar_root_moves_in_its_plane(self):
        self.write("bar.urdf", robot(link("bar", (1.0, 0.02, 0.02))))
        path = story()
        path["parts"] = [part("bar", "robot", root="planar", pose=[0, 0, 0.5, 0, 0, 0, 1]),
                         part("plate", "environment", pose=[2.0, 0.0, 0.5, 0, 0, 0, 1])]
        path["coordinates"], path["limits"] = ["bar/x", "bar/y", "bar/theta"], {"bar/x": [-1, 5]}
        path["documents"], path["certificate"] = {}, {}
        path["segments"] = [{"knots": [[0, -1, 0], [4, 1, 6.5]]}]
        self.assert_only(path, "collision")
        path["segments"] = [{"knots": [[0, 1, 0], [6, 1, 6.5]]}]
        self.assert_only(path, "limit")

    def test_a_cube_inside_a_closed_mesh_is_not_free(self):
        self.write("shell.stl", cube_as_stl(0.2))
        self.write("shell.urdf", robot(link("shell", geometry='<mesh filename="shell.stl"/>')))
        path = story()
        path["parts"].append(part("shell", "environment", pose=[1.0, 0.0, 0.5, 0, 0, 0, 1]))
        path["parts"] = [path["parts"][2], path["parts"][3]]
        path["coordinates"] = path["coordinates"][2:]
        path["limits"], path["documents"], path["certificate"] = {}, {}, {}
        path["segments"] = [{"knots": [pose_about_z(1.0, 0, 0.5, 0)] * 2}]
        self.assert_only(path, "enclosed")
        path["segments"] = [{"knots": [pose_about_z(1.3, 0, 0.5, 0)] * 2}]
        self.assert_only(path)

    def test_certifying_and_sampling_agree_on_random_motions(self):
        random = np.random.default_rng(5)
        for _ in range(6):
            path = self.with_plate(random.uniform(0.1, 0.6), random.uniform(-1, 1))
            corners = random.uniform(-1.5, 1.5, (4, 2))
            cube = pose_about_z(3.0, 0.0, 0.5, 0.0)
            path["limits"], path["certificate"] = {}, {}
            path["segments"] = [{"knots": [list(corner) + cube for corner in corners]}]
            fine = {(item.kind, item.subject) for item in self.check(path, 0.0005).violations}
            certified = {(item.kind, item.subject) for item in self.check(path, None).violations}
            self.assertEqual(fine, certified)


class Structure(Case):
    def test_a_jumped_knot(self):
        path = story()
        path["segments"][1]["knots"][0][0] = 1e-13
        self.assert_only(path, "shared-knot")

    def test_a_zero_of_the_other_sign_is_another_number(self):
        path = story()
        path["segments"][1]["knots"][0][0] = -0.0
        self.assert_only(path, "shared-knot")

    def test_a_violated_limit(self):
        path = story()
        path["limits"]["arm/elbow"] = [-0.5, 3]
        self.assert_only(path, "limit")
        found = self.check(path).violations[0]
        self.assertEqual((found.subject, found.value, found.limit), ("arm/elbow below", -0.6, -0.5))
        self.assertTrue(any("the URDF says" in note for note in self.check(path).notes))

    def test_limits_that_the_file_leaves_out_are_the_urdfs(self):
        self.write("arm.urdf", ARM.replace('lower="-3"', 'lower="-0.5"'))
        path = story()
        path["limits"] = {}
        self.assert_only(path, "limit")

    def test_an_object_released_out_of_bounds(self):
        path = story()
        path["limits"]["cube/y"] = [-0.05, 0.05]
        report = self.check(path)
        self.assertEqual({item.kind for item in report.violations}, {"object-bounds"})
        self.assertEqual({item.segment for item in report.violations}, {2})

    def test_quaternions(self):
        path = story()
        path["segments"][2]["knots"][1][5:] = [-value for value in path["segments"][2]["knots"][1][5:]]
        self.assert_only(path, "quaternion-sign")
        path = story()
        path["segments"][2]["knots"][1][5:] = [1.001 * value for value in path["segments"][2]["knots"][1][5:]]
        self.assert_only(path, "quaternion-norm")

    def test_documents_are_the_srdfs(self):
        path = story()
        path["documents"]["grippers"]["arm/hand"]["link_from_gripper"][0] = 0.5001
        self.assert_only(path, "document")

    def test_times_run_forwards(self):
        path = story()
        path["segments"][0]["times"] = [0.0, 2.0, 1.0]
        self.assert_only(path, "times")

    def test_a_certificate_that_claims_too_much(self):
        path = story()
        path["certificate"]["min_clearance"] = 0.002
        self.assert_only(path, "certificate")
        path = story()
        path["certificate"]["path_tolerance"] = 0.1
        self.assert_only(path, "path-tolerance")

    def test_extremes_of_a_geodesic(self):
        random = np.random.default_rng(2)
        for _ in range(50):
            first, second = (values / np.linalg.norm(values) for values in random.normal(size=(2, 4)))
            second = second if first @ second >= 0 else -second
            low, high = _geodesic_extremes(first, second)
            sampled = slerp(first[None], second[None], np.linspace(0, 1, 2001))
            np.testing.assert_allclose(low, sampled.min(axis=0), atol=1e-6)
            np.testing.assert_allclose(high, sampled.max(axis=0), atol=1e-6)


class Leaves(Case):
    def test_an_object_drifts_from_its_carrier(self):
        path = story()
        path["segments"][1]["knots"][1][2] += 2e-5
        self.assert_only(path, "object-off-carrier")

    def test_a_placed_object_moves(self):
        path = story()
        path["segments"][0]["knots"][1][3] += 1e-3
        self.assert_only(path, "placed-object-moved")

    def test_an_object_without_carrier_stays(self):
        path = story()
        path["segments"][0]["attachments"] = []
        self.assert_only(path)
        self.assertIn("cube has no attachment in some segments: it must rest there", self.check(path).notes)
        path["segments"][0]["attachments"] = [{"object": "cube", "carrier": True}]
        self.assert_only(path)
        path["segments"][0]["knots"][1][3] += 1e-3
        self.assert_only(path, "unattached-object-moved")

    def test_a_wrong_grasp(self):
        for change, what in (([0.001, 0, 0, 0, 0, 0, 1], "translation"), (pose_about_z(0, 0, 0, 0.01), "rotation")):
            path = story()
            path["documents"]["handles"]["cube/handle"]["link_from_handle"] = change
            self.assert_only(path, "grasp")
            self.assertIn(what, self.check(path).violations[0].subject)

    def test_a_grasp_free_about_an_axis_may_turn_about_it_only(self):
        path = story()
        handle = path["documents"]["handles"]["cube/handle"]
        handle.update(link_from_handle=pose_about_z(0, 0, 0, 2.5), mask=[1] * 5 + [0], mask_complement=[0] * 5 + [1])
        self.assert_only(path)
        handle.update(link_from_handle=[0, 0, 0, math.sin(0.005), 0, 0, math.cos(0.005)])
        self.assert_only(path, "grasp")

    def test_a_second_grasp_must_not_slip(self):
        self.write("cube2.urdf", CUBE)
        path = story()
        path["documents"]["handles"]["cube/handle"].update(mask=[0] * 6, mask_complement=[1] * 6)
        path["segments"][1]["attachments"] = [{**HELD, "carrier": False}]
        path["segments"][1]["knots"] = [knot(0, 0), knot(0.1, 0, cube_in_hand(0, 0))]
        path["segments"][2]["knots"] = [knot(0.1, 0, cube_in_hand(0, 0)), knot(0.1, -0.6, cube_in_hand(0, 0))]
        self.assertIn("grasp-constancy", self.kinds(path))

    def test_a_floating_placement(self):
        path = story()
        for segment in path["segments"]:
            for row in segment["knots"]:
                row[4] += 0.01
        path["documents"]["handles"]["cube/handle"]["link_from_handle"] = [0, 0, -0.01, 0, 0, 0, 1]
        self.assert_only(path, "placement")
        self.assertIn("gap is not the margin", self.check(path).violations[0].subject)

    def test_a_placement_beside_its_support_or_tilted(self):
        path = story()
        path["documents"]["surfaces"]["table/top"]["points"] = [[x - 0.3, y, z] for x, y, z in TABLE_TOP]
        self.assert_only(path, "placement")
        self.assertIn("centre outside the support", self.check(path).violations[0].subject)
        path = story()
        path["documents"]["surfaces"]["cube/bottom"]["polygons"] = [[3, 2, 1, 0]]
        self.assertIn("normals not opposite", self.check(path).violations[0].subject)

    def test_a_constraint_holds_between_the_knots(self):
        path = story()
        constraint = {"kind": "pose", "frame": "arm/lower", "to": "world", "mask": [1, 0, 0, 0, 0, 0], "value": None}
        segment = path["segments"][2]
        segment["constraints"] = [constraint]
        cube = cube_in_hand(0.1, 0)
        segment["knots"] = [knot(0.1, 0, cube), knot(-0.1, 0, cube)]
        path["documents"]["surfaces"]["cube/bottom"]["points"] = CUBE_BOTTOM
        self.assertIn("constraint", self.kinds(path))
        segment["knots"] = [knot(0.1, 0, cube), knot(0.1, -0.6, cube)]
        self.assert_only(path)

    def test_a_centre_of_mass_constraint(self):
        path = story()
        constraint = {"kind": "centre_of_mass", "frame": "arm", "to": "world", "mask": [1, 1, 1], "value": None}
        path["segments"][1]["constraints"] = [constraint]
        self.assert_only(path, "constraint")
        path["segments"][1]["constraints"] = []
        # one kilogram at each link's origin: (0, 0, 0), (0, 0, 0.5) and the elbow
        path["segments"][2]["constraints"] = [
            {**constraint, "value": [0.5 * math.cos(0.1) / 3, 0.5 * math.sin(0.1) / 3, 1 / 3, 0, 0, 0, 1]}]
        self.assert_only(path)

    def test_an_unknown_constraint_is_not_passed_over(self):
        path = story()
        path["segments"][2]["constraints"] = [{"kind": "magic", "frame": "arm", "to": "world"}]
        self.assert_only(path, "unchecked-constraint")

    def test_two_carriers_or_a_circle_are_refused(self):
        path = story()
        path["segments"][1]["attachments"] = [HELD, PLACED]
        with self.assertRaisesRegex(InputError, "2 carriers"):
            self.check(path)


class ArticulatedObjects(Case):
    def test_an_object_held_by_a_link_beyond_its_joint(self):
        """A hinged object hangs by its lid: the root follows through the joint."""
        self.write("book.urdf", robot(link("back", (0.02, 0.02, 0.02)), link("lid"),
                                      joint("hinge", "back", "lid", (-0.1, 0, 0))))
        path = story()
        path["parts"] = [path["parts"][0], part("book", "object", root="freeflyer", urdf="book")]
        names = ("x", "y", "z", "qx", "qy", "qz", "qw")
        path["coordinates"] = ["arm/shoulder", "arm/elbow", "book/hinge"] + [f"book/{name}" for name in names]
        path["limits"], path["certificate"] = {}, {}
        path["documents"] = {
            "grippers": path["documents"]["grippers"],
            "handles": {"book/lid": {"link": "book/lid", "link_from_handle": IDENTITY, "mask": [True] * 6}},
        }
        held = {"object": "book/lid", "gripper": "arm/hand", "handle": "book/lid", "carrier": True}

        def row(shoulder: float, hinge: float) -> list[float]:
            lid = Poses.from_array(cube_in_hand(shoulder, 0))
            back_from_lid = Poses.from_array(pose_about_z(-0.1, 0, 0, hinge))
            return [shoulder, 0.0, hinge] + (lid @ back_from_lid.inverse()).to_array()

        path["segments"] = [{"attachments": [held], "knots": [row(0, 0), row(0.3, 0.5)]}]
        self.assert_only(path)
        path["segments"][0]["knots"][1][3] += 1e-4
        self.assert_only(path, "object-off-carrier")


class Bounds(Case):
    def test_no_two_points_approach_faster_than_the_bound(self):
        """Distances between points of two shapes change by at most the bound that certifying rests on."""
        path = story()
        path["segments"][1]["knots"] = [knot(0, 0), knot(0.9, -0.4), knot(-0.3, 1.2)]
        report = recheck.Report()
        scene = recheck.Scene(recheck.read_path_file(self.write("path.json", json.dumps(path))), [])
        motion = recheck.SegmentMotion(scene, scene.path.segments[1])
        tester = clearance.Clearance(scene, report)
        _, pair_reach = tester._travel_bounds(motion)
        clock = clearance._Clock(motion.cumulative_travel(), pair_reach)
        random = np.random.default_rng(4)
        times = np.sort(random.uniform(0, 1, (100, 2)), axis=1)
        bounds = clock.travel_between(times[:, 0], times[:, 1]) @ clock.pair_reach
        tightest = 0.0
        for pair, (first, second) in enumerate(zip(tester.pairs.first, tester.pairs.second)):
            lengths = []
            for column in (0, 1):
                poses = tester._shape_poses(motion.body_poses(clock.parameters(times[:, column])))
                corners = [poses[:, shape, None].apply(np.array(SIGNS) * tester.half_extents[shape]
                                                       + tester.centers[shape]) for shape in (first, second)]
                lengths.append(np.linalg.norm(corners[0][:, :, None] - corners[1][:, None], axis=-1))
            change = np.abs(lengths[1] - lengths[0]).max(axis=(1, 2))
            self.assertTrue((change <= bounds[:, pair] + 1e-12).all(), tester._pair_name(pair))
            tightest = max(tightest, float((change / np.maximum(bounds[:, pair], 1e-9)).max()))
        self.assertGreater(tightest, 0.3)


class Malformed(Case):
    def exit_code(self, text: str) -> int:
        file = self.write("path.json", text)
        with redirect_stderr(io.StringIO()) as errors, redirect_stdout(io.StringIO()):
            code = recheck.main([str(file)])
        self.assertTrue(code != 2 or "path.json" in errors.getvalue() or ".urdf" in errors.getvalue())
        return code

    def test_what_is_no_path_is_refused(self):
        def spoil(change) -> str:
            path = copy.deepcopy(story())
            change(path)
            return json.dumps(path)

        spoiled = [
            "{",
            "[]",
            json.dumps({"format": "foliate.path/2"}),
            spoil(lambda path: path.pop("coordinates")),
            spoil(lambda path: path["coordinates"].append("arm/wrist")),
            spoil(lambda path: path["segments"][0]["knots"][0].append(1.0)),
            spoil(lambda path: path["segments"][0]["knots"][0].__setitem__(0, float("nan"))),
            spoil(lambda path: path["segments"][0]["knots"][0].__setitem__(0, True)),
            spoil(lambda path: path["parts"][0].update(urdf="missing.urdf")),
            spoil(lambda path: path["parts"][0].update(urdf="package://nowhere/arm.urdf")),
            spoil(lambda path: path["parts"][0].update(root="hinged")),
            spoil(lambda path: path["documents"]["grippers"]["arm/hand"].update(link="arm/thumb")),
            spoil(lambda path: path["segments"][1]["attachments"][0].update(gripper="arm/foot")),
            spoil(lambda path: path["limits"].update({"arm/wrist": [0, 1]})),
            spoil(lambda path: path.update(ignored_pairs=[["arm/lower", "arm/thumb", "?"]])),
            spoil(lambda path: path.update(segments=[])),
        ]
        for text in spoiled:
            self.assertEqual(self.exit_code(text), 2, text[:200])

    def test_exit_code_one_for_violations(self):
        path = story()
        path["limits"]["arm/elbow"] = [-0.5, 3]
        self.assertEqual(self.exit_code(json.dumps(path)), 1)

    def test_packages_are_not_left(self):
        (self.folder / "package").mkdir()
        self.write("package/inside.urdf", CUBE)
        self.assertTrue(resolve("package:///package/inside.urdf", [self.folder], self.folder).is_file())
        with self.assertRaisesRegex(InputError, "leaves its package"):
            resolve("package://package/../cube.urdf", [self.folder], self.folder)

    def test_packages_are_found_upwards(self):
        within = self.folder / "checkout" / "urdf"
        within.mkdir(parents=True)
        self.write("checkout/cube.urdf", CUBE)
        self.write("checkout/package.xml", "<package><name> cubes </name></package>")
        for name in ("cubes", "checkout"):
            self.assertTrue(resolve(f"package://{name}/cube.urdf", [], within).is_file())
        with self.assertRaisesRegex(InputError, "not found"):
            resolve("package://spheres/cube.urdf", [], within)


class Meshes(unittest.TestCase):
    def test_winding_number(self):
        triangles = np.array(CUBE_TRIANGLES) - 0.5
        self.assertTrue(clearance.is_closed(triangles))
        self.assertFalse(clearance.is_closed(triangles[1:]))
        self.assertAlmostEqual(abs(clearance.winding_number(np.zeros(3), triangles)), 1.0)
        self.assertAlmostEqual(clearance.winding_number(np.array([2.0, 0, 0]), triangles), 0.0)

    def test_within_a_margin_agrees_with_distance(self):
        """coal decides `farther than` for meshes by a collision margin; its distance must agree."""
        random = np.random.default_rng(11)
        mesh = {"shape": "mesh", "vertices": np.array(CUBE_TRIANGLES).reshape(-1, 3).tolist(),
                "triangles": np.arange(36).reshape(12, 3).tolist()}
        pairs = []
        for _ in range(200):
            poses = np.concatenate([random.uniform(-1.5, 1.5, (2, 3)), random.normal(size=(2, 4))], axis=1)
            pairs.append({"a": {**mesh, "pose": poses[0].tolist()}, "b": {**mesh, "pose": poses[1].tolist()},
                          "security_margin": random.uniform(0.0, 1.0)})
        results = distances.answer({"pairs": pairs}, Path("."))["results"]
        for pair, result in zip(pairs, results):
            if abs(result["distance"] - pair["security_margin"]) > 1e-5:
                self.assertEqual(result["collide_within_margin"], result["distance"] < pair["security_margin"])


class Instruments(Case):
    def test_kinematics_of_the_arm(self):
        request = {"urdf": "arm.urdf", "configurations": [{"shoulder": 0.3, "elbow": -0.7}, {}], "links": ["lower"]}
        poses = kinematics.answer(request, self.folder)["poses"]
        np.testing.assert_allclose(poses[0]["lower"][:3], [0.5 * math.cos(0.3), 0.5 * math.sin(0.3), 0.5], atol=1e-12)
        np.testing.assert_allclose(poses[0]["lower"][3:], pose_about_z(0, 0, 0, -0.4)[3:], atol=1e-12)
        self.assertEqual(poses[1]["lower"], [0.5, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0])

    def test_kinematics_of_roots_and_unwrapped_angles(self):
        turn = joint("turn", "base", "rim", (1, 0, 0), "continuous")
        self.write("wheel.urdf", robot(link("base"), link("rim"), turn))
        request = {"urdf": "wheel.urdf", "root": "planar",
                   "configurations": [{"x": 1.0, "y": 2.0, "theta": math.pi / 2, "turn": 7.0}]}
        poses = kinematics.answer(request, self.folder)["poses"][0]
        np.testing.assert_allclose(poses["rim"][:3], [1.0, 3.0, 0.0], atol=1e-12)
        turn = Poses.from_array(poses["rim"]).rotation @ Poses.planar(0, 0, math.pi / 2 + 7.0).rotation.T
        self.assertLess(rotation_angle(turn), 1e-12)

    def test_kinematics_refuses_unknown_names(self):
        with self.assertRaisesRegex(InputError, "wrist"):
            kinematics.answer({"urdf": "arm.urdf", "configurations": [{"wrist": 1.0}]}, self.folder)
        with redirect_stderr(io.StringIO()):
            self.assertEqual(kinematics.main([str(self.folder / "missing.json")]), 2)

    def test_distances(self):
        ball = {"shape": "sphere", "radius": 0.5, "pose": [3, 0, 0, 0, 0, 0, 1]}
        pairs = [{"a": {"shape": "box", "size": [2, 2, 2]}, "b": ball, "security_margin": 1.6},
                 {"a": {"shape": "capsule", "radius": 1.0, "length": 4.0}, "b": ball},
                 {"a": {"shape": "cylinder", "radius": 2.75, "length": 1.0}, "b": ball}]
        results = distances.answer({"pairs": pairs}, self.folder)["results"]
        np.testing.assert_allclose([result["distance"] for result in results], [1.5, 1.5, -0.25], atol=1e-6)
        self.assertEqual([result["collide"] for result in results], [False, False, True])
        self.assertTrue(results[0]["collide_within_margin"])
        with self.assertRaisesRegex(InputError, r"pairs\[0\]"):
            distances.answer({"pairs": [{"a": ball, "b": {"shape": "cone"}}]}, self.folder)


SIGNS = [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]


def _cube_triangles() -> list:
    """The unit cube [0, 1]^3 as twelve triangles, normals outwards."""
    faces = []
    for axis in range(3):
        for side in (0, 1):
            corners = []
            for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = [0, 0, 0]
                corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3] = side, u, v
                corners.append(corner)
            corners = corners if side else corners[::-1]
            faces += [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
    return faces


CUBE_TRIANGLES = _cube_triangles()


def cube_as_stl(side: float) -> str:
    lines = ["solid cube"]
    for triangle in CUBE_TRIANGLES:
        lines.append("facet normal 0 0 0\nouter loop")
        lines += [" ".join(["vertex"] + [str((value - 0.5) * side) for value in corner]) for corner in triangle]
        lines.append("endloop\nendfacet")
    return "\n".join(lines + ["endsolid cube"])


if __name__ == "__main__":
    unittest.main()
