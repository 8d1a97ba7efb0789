"""What holds along a segment besides who carries whom: balance, closed chains, distances, joints at rest, objects on planes
and on what others carry. Each promise is shown kept, and then broken by little.

    python3 -m unittest tests/independent/test_what_else_holds.py        (pin, coal and numpy from PyPI)
"""

from __future__ import annotations

import copy
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import test_recheck as base
from test_recheck import IDENTITY, cube_in_hand, joint, knot, link, part, pose_about_z, robot, story

try:
    from packages import InputError
except ModuleNotFoundError:
    InputError = None


def setUpModule():
    base.setUpModule()


ALL = [True] * 6
POSITION = [True, True, True, False, False, False]
LEG, HALF_STANCE = 0.5, 0.1


def at(x: float, y: float, z: float) -> list[float]:
    return [x, y, z, 0.0, 0.0, 0.0, 1.0]


def on(name: str, pose) -> dict:
    return {"link": name, "pose": list(pose)}


def root_of(name: str) -> list[str]:
    return [f"{name}/{axis}" for axis in ("x", "y", "z", "qx", "qy", "qz", "qw")]


def alone(parts: list, coordinates: list, segments: list) -> dict:
    """A path of nothing but these."""
    path = story()
    path.update(parts=parts, coordinates=coordinates, limits={}, segments=segments,
                documents={"grippers": {}, "handles": {}, "surfaces": {}}, certificate={"path_tolerance": 2e-4})
    return path


def with_constraints(path: dict, *constraints: dict) -> dict:
    path = copy.deepcopy(path)
    path["segments"][0]["constraints"] = [{"tolerance": 2e-4, **constraint} for constraint in constraints]
    return path


class HoldsButNot(base.Case):
    def assert_kinds(self, path: dict, *kinds: str):
        report = self.check(path)
        self.assertEqual({violation.kind for violation in report.violations}, set(kinds),
                         "\n".join(map(str, report.violations)))

    def holds_but_not(self, path: dict, constraint: dict, *spoiled: dict):
        self.assert_kinds(with_constraints(path, constraint))
        for change in spoiled:
            with self.subTest(**change):
                self.assert_kinds(with_constraints(path, {**constraint, **change}), "constraint")


class OnTwoFeet(HoldsButNot):
    """A trunk on two legs of two links each: hips, knees and ankles turn about y."""

    def setUp(self):
        super().setUp()
        elements = [link("trunk")]
        for side, y in (("left", HALF_STANCE), ("right", -HALF_STANCE)):
            thigh, shank, foot = (f"{side}_{name}" for name in ("thigh", "shank", "foot"))
            elements += [
                link(thigh), f'<link name="{shank}"/>', link(foot),
                joint(f"{side}_hip", "trunk", thigh, (0, y, 0), axis="0 1 0"),
                joint(f"{side}_knee", thigh, shank, (0, 0, -LEG), axis="0 1 0"),
                joint(f"{side}_ankle", shank, foot, (0, 0, -LEG), axis="0 1 0"),
            ]
        self.write("biped.urdf", robot(*elements))

    @staticmethod
    def height(bend: float) -> float:
        return 2.0 * LEG * math.cos(bend)

    @staticmethod
    def stance(trunk: float, left: float, right: float) -> list[float]:
        """Feet flat on the ground, knees bent by twice the angle."""
        return at(0, 0, trunk) + [value for bend in (left, right) for value in (-bend, 2.0 * bend, -bend)]

    def crouch(self) -> list:
        bends = [0.2 + 0.005 * step for step in range(81)]
        return [self.stance(self.height(bend), bend, bend) for bend in bends]

    def path(self, knots: list) -> dict:
        names = [f"biped/{side}_{name}" for side in ("left", "right") for name in ("hip", "knee", "ankle")]
        return alone([part("biped", "robot", root="freeflyer")], root_of("biped") + names, [{"knots": knots}])

    def feet(self) -> list[dict]:
        return [{"kind": "pose", "name": f"{side} foot stands", "frame": f"biped/{side}_foot", "to": "world", "mask": ALL,
                 "value": at(0, y, 0)} for side, y in (("left", HALF_STANCE), ("right", -HALF_STANCE))]

    def test_feet_stay_where_they_stand(self):
        path = with_constraints(self.path(self.crouch()), *self.feet())
        self.assert_kinds(path)
        path["segments"][0]["knots"][40][0] = 1e-3
        self.assert_kinds(path, "constraint")
        coarse = with_constraints(self.path([self.crouch()[0], self.crouch()[-1]]), *self.feet())
        self.assert_kinds(coarse, "constraint")

    def test_a_knee_does_not_jump_to_its_other_branch(self):
        for angle in (0.4, 0.1, 0.03):
            knots = [self.stance(self.height(angle), angle, angle), self.stance(self.height(angle), angle, -angle)]
            report = self.check(with_constraints(self.path(knots), *self.feet()))
            self.assertEqual({violation.kind for violation in report.violations}, {"constraint"})
            self.assertTrue(all(0.0 < violation.t < 1.0 for violation in report.violations))

    def test_a_centre_of_mass_is_that_of_the_links(self):
        path = self.path(self.crouch())
        centre = {"kind": "centre_of_mass", "parts": ["biped"], "to": "biped/left_foot",
                  "mask": [True, True, False, False, False, False], "value": at(0, -HALF_STANCE, 0)}
        self.holds_but_not(path, centre, {"value": at(2e-3, -HALF_STANCE, 0)}, {"value": at(0, -0.102, 0)})
        still = self.path([self.stance(self.height(0.5), 0.5, 0.5)] * 2)
        height = 0.6 * self.height(0.5)
        centre = {**centre, "mask": POSITION, "value": at(0, -HALF_STANCE, height)}
        self.holds_but_not(still, centre, {"value": at(0, -HALF_STANCE, height + 2e-3)})
        self.assert_kinds(with_constraints(path, {**centre, "value": None}), "constraint")

    def test_a_centre_of_mass_stays_on_its_side_of_planes(self):
        lowest = 0.6 * self.height(0.6)

        def planes(x=0.0, z=lowest - 1e-4, sided=True, y=-0.2):
            return {"planes": [{"normal": [1, 0, 0], "offset": x}, {"normal": [0, 0, 1], "offset": z, "inequality": sided},
                               {"normal": [0, -1, 0], "offset": y, "inequality": True}]}

        centre = {"kind": "centre_of_mass", "parts": ["biped"], "to": "world", **planes()}
        self.holds_but_not(self.path(self.crouch()), centre, planes(x=2e-3), planes(z=lowest + 1e-3), planes(sided=False),
                           planes(y=2e-3))

    def test_a_centre_of_mass_is_over_the_line_between_the_feet(self):
        balance = {"kind": "centre_of_mass_between", "parts": ["biped"], "frame": "biped/left_foot",
                   "to": "biped/right_foot"}
        self.holds_but_not(
            self.path(self.crouch()), balance, {"frame": on("biped/left_foot", at(0.01, 0, 0))},
            {"frame": on("biped/left_foot", at(0, -0.11, 0))}, {"to": on("biped/right_foot", at(0, 0.11, 0))},
            {"frame": "biped/right_foot"}, {"height": 0.55},
        )
        still = self.path([self.stance(self.height(0.3), 0.3, 0.3)] * 2)
        self.holds_but_not(still, {**balance, "height": 0.6 * self.height(0.3)}, {"height": 0.575})


class DistancesAndJoints(HoldsButNot):
    @staticmethod
    def turning(shoulder, elbow) -> dict:
        path = alone([story()["parts"][0]], ["arm/shoulder", "arm/elbow"], [{"knots": [list(q) for q in zip(shoulder, elbow)]}])
        path["documents"]["grippers"] = story()["documents"]["grippers"]
        return path

    def test_two_points_stay_apart(self):
        swing = self.turning((-1.0, 1.2), (0.0, 0.0))
        apart = {"kind": "distance", "frame": on("arm/lower", at(0.5, 0, 0)), "to": on("world", at(0, 0, 0.5))}
        self.holds_but_not(swing, {**apart, "length": 1.0}, {"length": 1.001})
        self.holds_but_not(swing, {**apart, "length": 0.9, "bound": "at_least"}, {"length": 1.001})
        self.holds_but_not(swing, {**apart, "length": 1.1, "bound": "at_most"}, {"length": 0.999})
        through, ends = self.turning((0.0, 0.0), (-1.0, 1.0)), math.cos(0.5)
        self.holds_but_not(through, {**apart, "length": 1.0, "bound": "at_most"}, {"bound": "equal"}, {"length": ends})

    def test_an_axis_tilts_no_farther_than_it_may(self):
        swing = self.turning((-0.4, 0.9), (0.0, 0.0))
        # The x axis of the lower arm as a z axis, against the world's x axis.
        aside = [0, math.sqrt(0.5), 0, math.sqrt(0.5)]
        tilt = {"kind": "tilt", "frame": on("arm/lower", [0, 0, 0, *aside]), "to": on("world", [0, 0, 0, *aside])}
        self.holds_but_not(swing, {**tilt, "within": 0.9}, {"within": 0.899})

    def test_a_point_stays_in_its_region(self):
        swing = self.turning((-0.4, 1.0), (0.0, 0.0))
        planes = [{"normal": [0, -1, 0], "offset": -math.sin(1.0), "inequality": True},
                  {"normal": [1, 0, 0], "offset": math.cos(1.0), "inequality": True}]
        nearer = [{**planes[0], "offset": -math.sin(1.0) + 1e-3}, planes[1]]
        region = {"kind": "region", "frame": on("arm/lower", at(0.5, 0, 0)), "to": "world"}
        self.holds_but_not(swing, {**region, "planes": planes}, {"planes": nearer})

    def test_a_joint_rests(self):
        still = self.turning((0.0, 1.0), (0.3, 0.3))
        self.holds_but_not(still, {"kind": "joint", "joint": "arm/elbow", "position": 0.3}, {"position": 0.301})
        moved = self.turning((0.0, 1.0), (0.3, 0.31))
        self.assert_kinds(with_constraints(moved, {"kind": "joint", "joint": "arm/elbow"}), "constraint")

    def test_rows_that_must_not_be_negative(self):
        mask = [True] + [False] * 5

        def beyond(x: float) -> dict:
            return {"kind": "pose", "frame": on("arm/lower", at(0.5, 0, 0)), "to": "world", "mask": mask, "inequality": mask,
                    "value": pose_about_z(x * math.cos(0.3), x * math.sin(0.3), 0, 0.3)}

        swing, least = self.turning((-0.4, 1.0), (0.0, 0.0)), math.cos(0.7)
        self.assert_kinds(with_constraints(swing, beyond(least)))
        self.assert_kinds(with_constraints(swing, beyond(least + 1e-3)), "constraint")
        sided = {**beyond(0.5), "mask": ALL, "inequality": [False] * 3 + [True] + [False] * 2}
        self.assert_kinds(with_constraints(swing, sided), "unchecked-constraint")

    def test_an_elbow_does_not_flip_while_the_tip_is_held(self):
        tip = {"kind": "pose", "frame": "arm/hand", "to": "world", "mask": POSITION, "value": at(math.cos(0.5), 0, 0.5)}
        self.assert_kinds(with_constraints(self.turning((-0.5, -0.5), (1.0, 1.0)), tip))
        self.assert_kinds(with_constraints(self.turning((-0.5, 0.5), (1.0, -1.0)), tip), "constraint")

    def test_what_is_not_proved_is_told(self):
        still = self.turning((0.0, 1.0), (0.0, 0.0))
        for kind in ("custom", "magic"):
            self.assert_kinds(with_constraints(still, {"kind": kind, "name": "gaze"}), "unchecked-constraint")

    def test_what_is_no_constraint_is_refused(self):
        still = self.turning((0.0, 1.0), (0.0, 0.0))
        for constraint in (
            {"kind": "pose", "to": "world", "mask": ALL},
            {"kind": "distance", "frame": "arm/thumb", "to": "world"},
            {"kind": "distance", "frame": on("arm/lower", [0, 0, 0, 0, 0, 0, 2]), "to": "world"},
            {"kind": "distance", "frame": "arm", "to": "world", "bound": "often"},
            {"kind": "tilt", "frame": "arm/lower", "to": "world"}, {"kind": "region", "frame": "arm/lower", "to": "world"},
            {"kind": "joint", "joint": "arm/wrist"}, {"kind": "joint"},
            {"kind": "joint", "joint": "arm/elbow", "position": True},
            {"kind": "centre_of_mass", "parts": ["leg"], "to": "world"},
            {"kind": "centre_of_mass", "parts": ["arm"], "planes": [{"normal": [1, 1, 0], "offset": 0}]},
            {"kind": "centre_of_mass_between", "parts": ["arm"], "frame": "arm"},
            {"kind": "pose", "frame": "arm", "mask": [False] + [True] * 5, "inequality": [True] + [False] * 5},
        ):
            with self.subTest(**constraint), self.assertRaises(InputError):
                self.check(with_constraints(still, constraint))


class Objects(HoldsButNot):
    def test_an_object_stands_on_a_plane(self):
        start, path = cube_in_hand(0, 0), story()
        path["segments"] = [{"knots": [knot(0, -0.6, start), knot(0, 0, start)]}]
        plane = [0.3, -0.2, 0.48, math.sin(0.005), 0, 0, math.cos(0.005)]
        standing = {"kind": "pose", "frame": on("cube/cube", at(0, 0, -0.02)),
                    "to": on("world", pose_about_z(0.3, -0.2, 0.48, 0.7)), "value": IDENTITY,
                    "mask": [False, False, True, True, True, False]}
        self.holds_but_not(path, standing, {"to": on("world", pose_about_z(0.3, -0.2, 0.479, 0.7))},
                           {"frame": on("cube/cube", at(0, 0, -0.021))}, {"to": on("world", plane)})
        path["segments"][0]["knots"][1][2] += 1e-3
        self.assert_kinds(with_constraints(path, standing), "unattached-object-moved")

    def test_what_rests_on_a_link_touches_it_and_stays(self):
        start, path = cube_in_hand(0, 0), story()
        path["margins"], path["certificate"] = [["cube/cube", "table/top", 0.01]], {"path_tolerance": 2e-4}
        path["segments"] = [{"knots": [knot(0, -0.6, start), knot(0, -0.3, start)]}]
        self.assert_kinds(path, "margin")
        path["segments"][0]["attachments"] = [{"object": "cube", "on": "table/top", "carrier": True}]
        self.assert_kinds(path)
        path["segments"][0]["knots"][1][2] += 1e-3
        self.assert_kinds(path, "placed-object-moved")

    def test_what_is_held_by_a_point_moves_as_written(self):
        path = story()
        path["documents"]["handles"]["cube/handle"]["mask"] = POSITION

        def turned(shoulder: float, turn: float) -> list[float]:
            return knot(shoulder, 0, pose_about_z(*cube_in_hand(shoulder, 0)[:3], turn))

        free = {"object": "cube", "gripper": "arm/hand", "handle": "cube/handle", "carrier": False}
        path["segments"] = [{"attachments": [free], "knots": [turned(0, 0), turned(0.02, 0.5)]}]
        self.assert_kinds(path)
        torn = copy.deepcopy(path)
        torn["segments"][0]["knots"][1][2] += 1e-3
        self.assert_kinds(torn, "grasp")
        path["segments"][0]["knots"][1] = turned(0.1, 0.5)
        self.assert_kinds(path, "grasp")
        path["segments"][0]["attachments"] = []
        self.assert_kinds(path, "unattached-object-moved")

    def tray(self) -> dict:
        """The story's arm carries a tray on which the cube stands."""
        self.write("tray.urdf", robot(link("tray", (0.08, 0.08, 0.02))))
        full = story()

        def row(shoulder: float) -> list[float]:
            tip = cube_in_hand(shoulder, 0)
            return [shoulder, 0.0] + tip[:2] + [tip[2] + 0.031] + tip[3:] + tip

        attachments = [{"object": "cube", "surface": "cube/bottom", "support": "tray/top", "carrier": True},
                       {"object": "tray", "gripper": "arm/hand", "handle": "tray/handle", "carrier": True}]
        path = alone(full["parts"] + [part("tray", "object", root="freeflyer")],
                     ["arm/shoulder", "arm/elbow"] + root_of("cube") + root_of("tray"),
                     [{"attachments": attachments, "knots": [row(0.0), row(0.4)]}])
        path["documents"] = full["documents"]
        path["documents"]["handles"]["tray/handle"] = {**full["documents"]["handles"]["cube/handle"], "link": "tray/tray"}
        corners = [[0.04, 0.04, 0.01], [-0.04, 0.04, 0.01], [-0.04, -0.04, 0.01], [0.04, -0.04, 0.01]]
        path["documents"]["surfaces"]["tray/top"] = {"link": "tray/tray", "points": corners, "polygons": [[0, 1, 2, 3]]}
        return path

    def test_a_cube_rides_on_a_tray(self):
        path = self.tray()
        self.assert_kinds(path)
        slid = copy.deepcopy(path)
        slid["segments"][0]["knots"][1][2] += 1e-3
        self.assert_kinds(slid, "placed-object-moved")
        swapped = copy.deepcopy(path)
        swapped["segments"][0]["attachments"][0]["support"] = "table/top"
        self.assertLessEqual({"placement", "placed-object-moved"}, self.kinds(swapped))
        for row in path["segments"][0]["knots"]:
            row[4] += 1e-3
        self.assert_kinds(path, "placement")

    def test_a_gripper_sits_on_an_object(self):
        path = self.tray()
        magnet = {"link": "tray/tray", "link_from_gripper": at(0, 0, 0.031)}
        path["documents"]["grippers"]["tray/magnet"] = magnet
        path["segments"][0]["attachments"][0] = {"object": "cube", "gripper": "tray/magnet", "handle": "cube/handle",
                                                 "carrier": True}
        self.assert_kinds(path)
        magnet["link_from_gripper"][2] += 1e-3
        self.assert_kinds(path, "grasp")

    def test_a_door_moves_only_while_it_is_held(self):
        hinge = joint("hinge", "frame", "leaf", (0, 0, 0.5))
        self.write("door.urdf", robot(link("frame"), link("leaf"), hinge))
        full = story()
        held = [{"object": "door/leaf", "gripper": "arm/hand", "handle": "door/handle", "carrier": False}]
        good = alone([full["parts"][0], part("door", "object")], ["arm/shoulder", "arm/elbow", "door/hinge"], [
            {"knots": [[0.0, -0.6, 0.0], [0.0, 0.0, 0.0]]},
            {"attachments": held, "knots": [[0.0, 0.0, 0.0], [0.7, 0.0, 0.7]]},
            {"knots": [[0.7, 0.0, 0.7], [0.7, -0.6, 0.7]]},
        ])
        good["documents"]["grippers"] = full["documents"]["grippers"]
        good["documents"]["handles"]["door/handle"] = {"link": "door/leaf", "link_from_handle": at(1, 0, 0), "mask": ALL}
        self.assert_kinds(good)
        haunted = copy.deepcopy(good)
        haunted["segments"][2]["knots"][1][2] += math.radians(1.0)
        self.assert_kinds(haunted, "joint-unheld")
        unheld = copy.deepcopy(good)
        unheld["segments"][1]["attachments"] = []
        self.assert_kinds(unheld, "joint-unheld")
        slips = copy.deepcopy(good)
        slips["segments"][1]["knots"][1][2] = 0.701
        slips["segments"][2]["knots"] = [[0.7, 0.0, 0.701], [0.7, -0.6, 0.701]]
        self.assert_kinds(slips, "grasp")
        shut = {"kind": "joint", "joint": "door/hinge", "position": 0.0}
        self.assert_kinds(with_constraints(good, shut))
        good["segments"][2]["constraints"] = [shut]
        self.assert_kinds(good, "constraint")


if __name__ == "__main__":
    unittest.main()
