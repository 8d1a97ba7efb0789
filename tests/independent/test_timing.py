"""Paths with times: curves, limits of rates, continuity and events are proved, and every kind of wrong one is reported by its name.

    python3 -m unittest tests/independent/test_timing.py        (pin, coal and numpy from PyPI)

The story is that of `test_recheck`, from rest to rest.
"""

from __future__ import annotations

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import test_recheck
from test_recheck import MISSING, Case, IDENTITY, joint, link, part, pose_about_z, robot, story

if not MISSING:
    import numpy as np

    from curve import Curve
    from packages import InputError


def setUpModule():
    if MISSING:
        raise unittest.SkipTest(MISSING)


DWELL = 0.2


def with_times(path: dict) -> dict:
    """A path of version 1 as one of version 2, from rest to rest, a second from knot to knot."""
    path["format"], path["events"] = "foliate.path/2", []
    width, now, was_held = len(path["coordinates"]), 0.0, False
    for index, segment in enumerate(path["segments"]):
        is_held = any("gripper" in item for item in segment["attachments"])
        times = [now]
        if index and is_held != was_held:
            path["events"].append({"time": now, "dwell": DWELL, "segment": index, "kind": "grasp" if is_held else "release",
                                   "object": "cube", "gripper": "arm/hand", "handle": "cube/handle"})
            segment["knots"].insert(0, segment["knots"][0])
            times.append(now + DWELL)
        times += [times[-1] + step for step in range(1, len(segment["knots"]) - len(times) + 1)]
        segment["times"], now, was_held = times, times[-1], is_held
        segment["velocities"] = [[0.0] * width for _ in times]
    path["rate_limits"] = {name: {"velocity": 1.0, "acceleration": 4.0} for name in path["coordinates"]}
    path["certificate"] |= {"max_velocity": 1.0, "max_acceleration": 1.0, "continuity": 1}
    return path


def timed() -> dict:
    return with_times(story())


def arm_alone(knots, velocities, plate=None) -> dict:
    """The arm past a plate, with velocities that are no rest."""
    path = story()
    path["parts"] = path["parts"][:1]
    if plate:
        path["parts"].append(part("plate", "environment", pose=plate))
    path["coordinates"] = ["arm/shoulder", "arm/elbow"]
    path["limits"] = {name: [-3, 3] for name in path["coordinates"]}
    path["documents"] = {"grippers": {}, "handles": {}, "surfaces": {}}
    path["segments"] = [{"transition": "", "state": "", "attachments": [], "constraints": [], "knots": knots}]
    path["certificate"] = {"path_tolerance": 2e-4, "max_residual": 2e-4, "joint_limits": "within"}
    path = with_times(path)
    path["segments"][0]["velocities"] = velocities
    path["rate_limits"] = {name: {"velocity": 100.0, "acceleration": 1000.0} for name in path["coordinates"]}
    return path


STILL = [0.0, 0.0]


class GoodPaths(Case):
    def test_the_timed_story_is_valid(self):
        self.assert_only(timed())

    def test_limits_of_rates_are_exact(self):
        for key, used in (("velocity", 0.9), ("acceleration", 3.6)):
            for factor, kinds in ((1.0 + 1e-12, ()), (1.0 - 1e-10, ()), (1.0 - 1e-7, (f"{key}-limit",))):
                path = timed()
                path["rate_limits"]["arm/elbow"][key] = used * factor
                path["certificate"].pop(f"max_{key}")
                self.assert_only(path, *kinds)

    def test_a_curve_with_continuous_acceleration_keeps_a_limit_of_its_jerk(self):
        jerk, h = 2.0, 0.5
        v1, q1 = jerk * h**2 / 2, jerk * h**3 / 6
        v2, q2 = 2 * v1, q1 + v1 * h + jerk * h**3 / 3
        q3 = q2 + v2 * h - jerk * h**3 / 6
        path = arm_alone([[0, q] for q in (0.0, q1, q2, q3, 2 * q2)], [[0, v] for v in (0.0, v1, v2, v1, 0.0)])
        path["segments"][0]["times"] = [0.0, h, 2 * h, 3 * h, 4 * h]
        path["rate_limits"]["arm/elbow"] = {"velocity": v2, "acceleration": jerk * h, "jerk": jerk}
        path["certificate"]["continuity"] = 2
        self.assert_only(path)
        path["rate_limits"]["arm/elbow"]["jerk"] = 0.999 * jerk
        self.assert_only(path, "jerk-limit")
        del path["rate_limits"]["arm/elbow"]["jerk"]
        path["segments"][0]["velocities"][2][1] *= 0.99
        self.assert_only(path, "acceleration-limit", "certificate")


class Curves(Case):
    def test_extremes_are_those_of_fine_samples(self):
        random = np.random.default_rng(3)
        knots, velocities = random.uniform(-1, 1, (40, 3)), random.uniform(-3, 3, (40, 3))
        times = np.cumsum(random.uniform(0.1, 2.0, 40))
        curve = Curve(knots, times, velocities)
        fractions = np.linspace(0.0, 1.0, 1001)[:-1]
        rows = np.stack([curve.rows(np.arange(39), np.full(39, f)) for f in fractions] + [knots[1:]])
        low, high = curve.ranges()
        self.assertLess(np.abs(low - rows.min(axis=0)).max() + np.abs(high - rows.max(axis=0)).max(), 1e-4)
        self.assertTrue((low <= rows.min(axis=0) + 1e-12).all() and (high >= rows.max(axis=0) - 1e-12).all())
        speed = np.abs(np.diff(rows, axis=0)).max(axis=0) * 1000.0
        self.assertTrue((curve.fastest() >= speed - 1e-9).all() and (curve.fastest() < speed + 0.05).all())
        length, fastest = curve.norm_bounds([0, 1, 2])
        self.assertTrue((length <= np.linalg.norm(rows, axis=2).min(axis=0) + 1e-12).all())
        moved = np.linalg.norm(np.diff(rows, axis=0), axis=2).max(axis=0) * 1000.0
        self.assertTrue((fastest >= moved - 1e-9).all())

    def test_a_limit_exceeded_only_between_knots(self):
        for velocity, kinds in ((0.39, ()), (0.41, ("limit",))):
            knots = [[2.0, 0.0], [2.9, 0.0], [2.9, 0.0], [2.0, 0.0]]
            self.assert_only(arm_alone(knots, [STILL, [velocity, 0.0], [-velocity, 0.0], STILL]), *kinds)

    def test_a_follower_beyond_its_limit_between_knots(self):
        follower = joint("tip", "lower", "finger", (0.5, 0.3, 0), extra='<mimic joint="elbow" multiplier="-2"/>')
        self.write("arm.urdf", test_recheck.ARM.replace("</robot>", link("finger") + follower + "</robot>"))
        for velocity, kinds in ((0.39, ()), (0.41, ("follower-limit",))):
            knots = [[0.0, 0.0], [0.0, 1.4], [0.0, 1.4], [0.0, 0.0]]
            self.assert_only(arm_alone(knots, [STILL, [0.0, velocity], [0.0, -velocity], STILL]), *kinds)

    def test_a_curve_that_bulges_into_a_plate(self):
        plate = pose_about_z(0.99 * np.cos(0.2), 0.99 * np.sin(0.2), 0.5, 0.2)
        for velocity, kinds in ((0.0, ()), (0.4, ()), (0.9, ("collision",))):
            path = arm_alone([STILL] * 4, [STILL, [velocity, 0.0], [-velocity, 0.0], STILL], plate)
            self.assert_only(path, *kinds)
        # The elbow folds the arm away from the plate, which stands in the way of the arm stretched out.
        knots = [[0.0, 0.0], [0.0, -1.0], [0.4, -1.0], [0.4, 0.0]]
        self.assert_only(arm_alone(knots, [STILL] * 4, plate))
        ends = [knots[0], knots[3]]
        self.assert_only(arm_alone(ends, [STILL] * 2, plate), "collision")
        # The chord of this curve is that of the last.
        self.assert_only(arm_alone(ends, [[0.0, -8.0], [0.0, 8.0]], plate), "velocity-jump")

    def test_a_constraint_that_holds_only_at_the_knots(self):
        for velocity, kinds in ((0.0, ()), (1e-2, ("constraint",))):
            path = arm_alone([[0.0, 0.0], [0.1, 0.0], [0.2, 0.0]], [STILL, [0.1, velocity], STILL])
            path["segments"][0]["constraints"] = [
                {"kind": "joint", "joint": "arm/elbow", "position": 0.0, "tolerance": 1e-4}
            ]
            self.assert_only(path, *kinds)

    def test_quaternions_are_scaled_and_may_not_pass_by_zero(self):
        def flyer(first):
            path = story()
            path["parts"], path["limits"] = [part("cube", "robot", root="freeflyer")], {}
            path["coordinates"] = [f"cube/{axis}" for axis in ("x", "y", "z", "qx", "qy", "qz", "qw")]
            path["documents"] = {"grippers": {}, "handles": {}, "surfaces": {}}
            knots = [pose_about_z(0, 0, 0.5, 0.0), pose_about_z(0, 0, 0.5, 1.5)]
            path["segments"] = [{"transition": "", "state": "", "attachments": [], "knots": knots, "constraints": [
                {"kind": "pose", "frame": "cube", "to": "world", "value": IDENTITY[:2] + [0.5] + IDENTITY[3:],
                 "mask": [True] * 5 + [False], "tolerance": 1e-4}]}]
            path["certificate"] = {"path_tolerance": 2e-4, "max_residual": 2e-4, "joint_limits": "within"}
            path = with_times(path)
            path["rate_limits"], path["segments"][0]["velocities"] = {}, [first, [0.0] * 7]
            return path

        self.assert_only(flyer([0.0] * 7))
        self.assert_only(flyer([0.0, 0.0, 0.0, 0.05, 0.0, 0.0, 0.0]), "constraint", "velocity-jump")
        self.assertIn("quaternion-norm", self.kinds(flyer([0.0] * 6 + [-12.0])))


class Lies(Case):
    def spoiled(self, change) -> dict:
        path = timed()
        change(path)
        return path

    def assert_kinds(self, change, *kinds: str):
        found = self.kinds(self.spoiled(change))
        self.assertEqual(found, set(kinds))

    def test_times_that_do_not_go_on(self):
        def shifted(path):
            path["segments"][2]["times"] = [time + 0.5 for time in path["segments"][2]["times"]]
            path["events"][1]["time"] += 0.5

        self.assert_kinds(shifted, "times")

        def late(path):
            for segment in path["segments"]:
                segment["times"] = [time + 1.0 for time in segment["times"]]
            for event in path["events"]:
                event["time"] += 1.0

        self.assert_kinds(late, "times")

        def at_once(path):
            path["segments"][0]["times"][1] = 0.0

        self.assert_kinds(at_once, "times")

    def test_velocities_that_jump(self):
        def set_velocity(segment, knot, column, value=0.1):
            def change(path):
                path["segments"][segment]["velocities"][knot][column] = value
            return change

        self.assert_kinds(set_velocity(0, 0, 0), "velocity-jump")
        self.assert_kinds(set_velocity(2, -1, 1), "velocity-jump")
        self.assert_kinds(set_velocity(0, 1, 2), "carried-velocity")
        self.assert_kinds(set_velocity(0, -1, 1), "velocity-jump", "event-moves")
        self.assertIn("event-moves", self.kinds(self.spoiled(set_velocity(1, 1, 0))))

    def test_claims_and_limits(self):
        def claim(path):
            path["certificate"]["max_velocity"] = 0.8

        self.assert_kinds(claim, "certificate")

        def continuity(path):
            path["certificate"]["continuity"] = 2

        self.assert_kinds(continuity, "certificate")

        def faster(path):
            path["segments"][2]["times"][-1] -= 0.2

        self.assert_kinds(faster, "velocity-limit", "acceleration-limit", "certificate")

    def test_events_that_do_not_happen(self):
        def change(key, value):
            def spoil(path):
                path["events"][0][key] = value
            return spoil

        self.assert_kinds(change("time", 1.9), "event")
        self.assert_kinds(change("kind", "release"), "event")
        self.assert_kinds(change("handle", "cube/lid"), "event")
        self.assert_kinds(change("dwell", 0.3), "event-moves")
        self.assert_kinds(change("fingers", {"arm/elbow": 0.1}), "event")
        self.assert_kinds(change("segment", 2), "event", "event")
        self.assert_kinds(lambda path: path["events"].pop(), "event")
        self.assert_kinds(lambda path: path["events"].reverse(), "event")

    def test_what_is_not_of_the_version(self):
        for key, value in (("rate_limits", {}), ("events", [])):
            path = story()
            path[key] = value
            with self.assertRaisesRegex(InputError, "version 2"):
                self.check(path)
        for change in (
            lambda path: path["segments"][0].pop("velocities"),
            lambda path: path["segments"][0].pop("times"),
            lambda path: path["segments"][0]["velocities"].pop(),
            lambda path: path.pop("rate_limits"),
            lambda path: path["rate_limits"].update({"nothing": {"velocity": 1.0}}),
            lambda path: path["rate_limits"]["arm/elbow"].update({"velocity": 0.0}),
            lambda path: path["events"][0].update({"segment": 0}),
            lambda path: path["events"][0].pop("time"),
        ):
            with self.assertRaises(InputError):
                self.check(self.spoiled(change))


if __name__ == "__main__":
    unittest.main()
