"""The harness's own logic, without the package: surfaces, rests, scene text, paths, checks, rows, table."""

from __future__ import annotations

import dataclasses
import sys
import tempfile
import tomllib
import unittest
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import checks  # noqa: E402
import table  # noqa: E402
from instance_name import InstanceName  # noqa: E402
from overhang import counter_clockwise, overhang  # noqa: E402
from path_knots import WORLD, PathError, between, path_of  # noqa: E402
from resting import GAP_M, RestError, outward, put_down  # noqa: E402
from rows import Row, Verdict, append, read  # noqa: E402
from run import rows_of  # noqa: E402
from scene_text import FREE, OPEN, Instance, Part, scene_text  # noqa: E402
from surfaces import bend, flatten_srdf, flattened, polygons  # noqa: E402

SQUARE = np.array([[0.1, 0.1, 0.0], [-0.1, 0.1, 0.0], [-0.1, -0.1, 0.0], [0.1, -0.1, 0.0]])
BENT = SQUARE + np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.004]])
UNDERSIDE = SQUARE[::-1]


class SurfacesAreMadeFlat(unittest.TestCase):
    def test_a_flat_polygon_stays(self):
        np.testing.assert_allclose(flattened(SQUARE), SQUARE, atol=1e-15)

    def test_the_plane_is_that_of_the_first_corners_through_the_mean(self):
        flat = flattened(BENT)
        np.testing.assert_allclose(flat[:, 2], 0.001, atol=1e-12)
        np.testing.assert_allclose(flat[:, :2], BENT[:, :2], atol=1e-12)
        self.assertAlmostEqual(bend(BENT), 0.003)

    def test_polygons_that_share_a_bent_corner_get_corners_of_their_own(self):
        text = srdf("0.1 0.1 0  -0.1 0.1 0  -0.1 -0.1 0  0.1 -0.1 0.004  0.1 -0.1 1  0.1 0.1 1", "4 0 1 2 3  4 0 3 4 5")
        changed, changes = flatten_srdf(text, {"body", "other"})
        first, second = polygons(ET.fromstring(changed).find("contact"))
        np.testing.assert_allclose(first[:, 2], 0.001, atol=1e-9)
        np.testing.assert_allclose(second[:, 0], 0.1, atol=1e-9)
        self.assertEqual(changes, ["top: polygons bent by up to 3.00 mm made flat"])

    def test_flat_polygons_and_known_links_are_not_touched(self):
        changed, changes = flatten_srdf(srdf("0.1 0.1 0 -0.1 0.1 0 -0.1 -0.1 0", "3 0 1 2"), {"body", "other"})
        self.assertEqual(changes, [])
        self.assertEqual(ET.fromstring(changed).find("contact/shape").text, "3 0 1 2")
        self.assertEqual(len(ET.fromstring(changed).findall("disable_collisions")), 1)

    def test_pairs_of_links_that_are_none_are_left_out(self):
        changed, changes = flatten_srdf(srdf("0.1 0.1 0 -0.1 0.1 0 -0.1 -0.1 0", "3 0 1 2"), {"body"})
        self.assertEqual(ET.fromstring(changed).findall("disable_collisions"), [])
        self.assertEqual(len(changes), 1)


def srdf(points: str, shape: str) -> str:
    return (f'<robot name="r"><contact name="top"><link name="body"/><point>{points}</point><shape>{shape}</shape></contact>'
            '<disable_collisions link1="body" link2="other"/></robot>')


class PosesAreMadeToRest(unittest.TestCase):
    def test_a_tilt_and_a_gap_go(self):
        tilt = 5e-4
        pose = np.eye(4)
        pose[:3, :3] = [[np.cos(tilt), 0, np.sin(tilt)], [0, 1, 0], [-np.sin(tilt), 0, np.cos(tilt)]]
        pose[:3, 3] = [0.3, -0.2, 0.75 + 0.0013]
        put, moved = put_down(pose, [UNDERSIDE, SQUARE], [0.75, 1.2])
        corners = UNDERSIDE @ put[:3, :3].T + put[:3, 3]
        np.testing.assert_allclose(corners[:, 2], 0.75 + GAP_M, atol=1e-12)
        np.testing.assert_allclose(put[:2, 3], pose[:2, 3], atol=1e-12)
        np.testing.assert_allclose(put[:3, :3] @ put[:3, :3].T, np.eye(3), atol=1e-12)
        self.assertAlmostEqual(moved, tilt, places=9)

    def test_what_does_not_rest_is_refused(self):
        pose = np.eye(4)
        pose[2, 3] = 0.9
        with self.assertRaises(RestError):
            put_down(pose, [UNDERSIDE], [0.75])

    def test_the_surface_on_top_is_no_rest(self):
        pose = np.eye(4)
        pose[2, 3] = 0.751
        with self.assertRaises(RestError):
            put_down(pose, [SQUARE], [0.75])

    def test_outward_is_where_corners_turn_left(self):
        np.testing.assert_allclose(outward(SQUARE), [0, 0, 1])


INSTANCE = Instance(
    name="shelf-0-arm-1", description="an arm", parts=[
        Part("arm", "robot", "models/arm.urdf", "models/arm.srdf", [1.0, 0, 0, 0, 0, 0, 1.0]),
        Part("can", "object", "models/can.urdf", "models/can.srdf"),
        Part("table", "environment", "models/table.urdf", "models/table.srdf"),
    ],
    joints={"arm/elbow": 0.5, "arm/finger": 0.0}, start={"can": [0, 0, 1, 0, 0, 0, 1]}, goal={"can": [1, 0, 1, 0, 0, 0, 1]},
    gripper="arm/hand", handles={"can": ["top", "side"]}, supports=["table/top"], bounds=[[-1, 1], [-1, 1], [0, 2]],
    finger=("arm/finger", 0.04), untested=[("arm", "table/wall")],
)


class ScenesSayWhatInstancesHold(unittest.TestCase):
    def test_free_fingers_are_joints_like_others(self):
        scene = tomllib.loads(scene_text(INSTANCE, FREE))
        self.assertNotIn("locked", scene)
        self.assertEqual(scene["start"]["arm/finger"], 0.0)
        self.assertEqual(scene["goal"], [{"configuration": {"can": [1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]}}])
        self.assertEqual(scene["graph"]["grasps"], {"arm/hand": ["can/top", "can/side"]})
        self.assertEqual(scene["graph"]["rests"], "whole-face")
        self.assertEqual([part["kind"] for part in scene["part"]], ["robot", "object", "environment"])
        self.assertEqual([("pose" in part, "root_bounds" in part) for part in scene["part"]],
                         [(True, False), (False, True), (False, False)])
        self.assertEqual(scene["ignore"], [["arm", "table/wall"]])

    def test_open_fingers_are_locked_at_the_start_too(self):
        scene = tomllib.loads(scene_text(INSTANCE, OPEN))
        self.assertEqual(scene["locked"], {"arm/finger": 0.04})
        self.assertEqual(scene["start"]["arm/finger"], 0.04)
        self.assertEqual(INSTANCE.joints["arm/finger"], 0.0)

    def test_another_word_is_refused(self):
        with self.assertRaises(ValueError):
            scene_text(INSTANCE, "shut")


class NamesOfInstances(unittest.TestCase):
    def test_there_and_back(self):
        name = InstanceName("shelf", 2, "kmr_iiwa", 0)
        self.assertEqual(InstanceName.of(name.text), name)
        self.assertEqual(name.group, "shelf-3")
        self.assertEqual(InstanceName.of("tunnel-0-ur5-10").group, "tunnel")
        for text in ("shelf-0-panda", "shelf-a-panda-1"):
            with self.assertRaises(ValueError):
                InstanceName.of(text)


def document(**changes) -> dict:
    """The arm takes the can with its elbow at 1 rad and turns to 3 rad."""
    rest = {"object": "can", "surface": "can/bottom", "support": "table/top", "carrier": True}
    grasp = {"object": "can", "gripper": "arm/hand", "handle": "can/top", "carrier": True}
    can = [0.2, 0.0, 0.8, 0.0, 0.0, 0.0, 1.0]
    known = {
        "parts": [{"name": "arm", "kind": "robot"}, {"name": "can", "kind": "object"}, {"name": "table", "kind": "environment"}],
        "coordinates": ["can/x", "can/y", "can/z", "can/qx", "can/qy", "can/qz", "can/qw", "arm/elbow", "arm/finger"],
        "documents": {"grippers": {"arm/hand": {"link": "arm/palm"}}, "surfaces": {"table/top": {"link": "table/desk"}}},
        "segments": [
            {"attachments": [rest], "knots": [[*can, 0.0, 0.04], [*can, 1.0, 0.04]]},
            {"attachments": [grasp], "knots": [[*can, 1.0, 0.04], [*can, 3.0, 0.04], [*can, 3.0, 0.04]]},
        ],
        "events": [{"kind": "grasp"}, {"kind": "release"}],
    }
    return known | changes


class PathsAreRead(unittest.TestCase):
    def test_equal_steps_are_equal_ways(self):
        path = path_of(document())
        for t, elbow in ((0.0, 0.0), (1.0 / 6.0, 0.5), (0.5, 1.5), (1.0, 3.0), (1.001, 3.0)):
            piece, share = path.at(t)
            self.assertAlmostEqual(float((piece.before + share * (piece.after - piece.before))[0]), elbow)

    def test_objects_follow_who_carries_them(self):
        path = path_of(document())
        self.assertEqual(path.joints, ["elbow", "finger"])
        self.assertEqual([path.at(t)[0].carriers["can"] for t in (0.1, 0.9)], [WORLD, "palm"])
        self.assertEqual((path.grasps, [(name, support) for name, support, _ in path.rests]), (1, [("can", "table/top")]))

    def test_a_path_with_times_is_refused(self):
        timed = document()
        timed["segments"][0]["times"] = [0.0, 1.0]
        with self.assertRaises(PathError):
            path_of(timed)

    def test_the_hand_opens_before_and_closes_after(self):
        path = between(path_of(document()), "finger", 0.0)
        self.assertEqual(len(path.pieces), 5)
        first, last = path.pieces[0], path.pieces[-1]
        self.assertEqual((first.before.tolist(), first.after.tolist()), ([0.0, 0.0], [0.0, 0.04]))
        self.assertEqual((last.before.tolist(), last.after.tolist()), ([3.0, 0.04], [3.0, 0.0]))
        self.assertEqual(last.carriers, {"can": WORLD})
        self.assertEqual(len(between(path, "finger", 0.0).pieces), 5, "already there")


class OverhangsAreMeasured(unittest.TestCase):
    def test_the_worst_corner_counts(self):
        support = SQUARE[:, :2]
        self.assertEqual(overhang(support * 0.5, support), 0.0)
        self.assertAlmostEqual(overhang(support + [0.03, 0.0], support), 0.03)

    def test_clockwise_polygons_are_turned(self):
        np.testing.assert_allclose(counter_clockwise(UNDERSIDE[:, :2]), SQUARE[:, :2])
        np.testing.assert_allclose(counter_clockwise(SQUARE[:, :2]), SQUARE[:, :2])


def sample(t: float, furniture=(), robot=(), grasped=(), collides=False, **poses) -> checks.Sample:
    return checks.Sample(t, collides, frozenset(furniture), frozenset(robot), frozenset(grasped), poses)


def same(one: object, other: object) -> bool:
    return one == other


class ConfigurationsAreJudged(unittest.TestCase):
    def test_what_is_carried_may_move_while_others_rest(self):
        samples = [sample(0.0, ["a", "b"], grasped=["c"], a=0, b=0, c=0), sample(0.5, ["a", "b"], grasped=["c"], a=0, b=0, c=1)]
        self.assertEqual(checks.verdict(samples, ["a", "b", "c"], same), checks.VALID)

    def test_what_rests_on_the_robot_may_move(self):
        samples = [sample(0.0, robot=["a"], a=0), sample(0.5, robot=["a"], a=1)]
        self.assertEqual(checks.verdict(samples, ["a"], same), checks.VALID)

    def test_what_rests_may_not(self):
        samples = [sample(0.0, ["a"], a=0), sample(0.5, ["a"], a=1)]
        self.assertIn("a moved", checks.verdict(samples, ["a"], same))

    def test_a_grasp_begins_and_ends_at_rest(self):
        samples = [sample(0.0, ["a"], grasped=["a"], a=0), sample(0.5, ["a"], a=1e-9)]
        self.assertEqual(checks.verdict(samples, ["a"], same), checks.VALID)

    def test_what_nothing_holds_and_what_collides_is_wrong(self):
        self.assertIn("unconstrained", checks.verdict([sample(0.0, ["a"], a=0, b=0)], ["a", "b"], same))
        self.assertIn("collision", checks.verdict([sample(0.0, ["a"], collides=True, a=0)], ["a"], same))


ROW = Row("shelf-0-panda-1", "shelf-1", FREE, 1, "solved", 50.0, 60.0, 2, 1, "shelf-0-panda-1/paths/1.json", "")


def row(**values) -> Row:
    return dataclasses.replace(ROW, **values)


class ResultsAreKept(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_records_come_back_as_they_were(self):
        rows = [ROW, row(seed=2, outcome="timeout", solve_ms=60001.5, grasps=0, path="", message='no, "none"')]
        verdicts = [Verdict("shelf-0-panda-1", 1, "valid", "valid", 0.0, 2)]
        for record in [*rows, *verdicts]:
            append(self.folder / f"{type(record).__name__}.csv", record)
        self.assertEqual(read(self.folder / "Row.csv", Row), rows)
        self.assertEqual(read(self.folder / "Verdict.csv", Verdict), verdicts)
        self.assertEqual(read(self.folder / "none.csv", Row), [])

    def test_rows_of_a_bench(self):
        (self.folder / "shelf-0-panda-1/paths").mkdir(parents=True)
        (self.folder / "shelf-0-panda-1/paths/shelf-0-panda-1-1.json").write_text('{"events": [{"kind": "grasp"}, {"kind": "release"}]}')
        bench = [{"seed": "1", "outcome": "solved", "solve_ms": "12.5", "message": ""},
                 {"seed": "2", "outcome": "infeasible_start", "solve_ms": "", "message": "collides"}]
        found = rows_of(bench, "shelf-0-panda-1", {"group": "shelf-1", "fingers": OPEN, "grasps": 1}, 60.0, self.folder)
        self.assertEqual([(one.grasps, one.solve_ms, one.path != "") for one in found], [(1, 12.5, True), (0, 0.0, False)])


class TheTable(unittest.TestCase):
    def test_what_was_refused_is_in_no_median(self):
        rows = [row(seed=1, solve_ms=10.0), row(seed=2, solve_ms=30.0), row(seed=3, outcome="timeout", solve_ms=60.1e3, grasps=0),
                row(instance="shelf-0-panda-7", outcome="infeasible_start", solve_ms=0.1, grasps=0)]
        verdicts = [Verdict(ROW.instance, 1, "valid", "valid", 0.0, 2), Verdict(ROW.instance, 2, "moved", "valid", 0.0, 2)]
        line = table.table(rows, verdicts).splitlines()[-1]
        self.assertEqual(line, "| shelf-1 | 2 | 1 | 2/3 | 30 | 60000 | 4/2 | 1/2 | 2/2 |")

    def test_a_median_without_an_answer_is_marked(self):
        line = table.table([row(group="tunnel", outcome="timeout", grasps=0)], []).splitlines()[-1]
        self.assertEqual(line, "| tunnel | 1 | 0 | 0/1 | > 60000 | 60000 | – | – | – |")

    def test_tasks_have_their_order(self):
        rows = [row(group=group) for group in ("tunnel", "other", "shelf-2", "shelf-1")]
        lines = table.table(rows, []).splitlines()[2:]
        self.assertEqual([line.split(" | ")[0] for line in lines], ["| shelf-1", "| shelf-2", "| tunnel", "| other"])


if __name__ == "__main__":
    unittest.main()
