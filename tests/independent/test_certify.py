"""`foliate certify` against pinocchio and coal: random cubic and quintic splines of an arm among thin posts, sampled so that no
point moves farther than half a millimetre. What is called free never collides at a sample, nor does what is proved before a
contact; at a contact coal finds the pair overlapping.

Needs the program: `FOLIATE`, or what cargo has built below target/.
"""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import coal  # noqa: F401  (pinocchio's geometry needs its types)
import numpy as np
import pinocchio as pin

ROOT = Path(__file__).resolve().parents[2]
STEP = 0.5e-3
ROUNDS = 12
JOINTS = ("j0", "j1", "j2")
LENGTH = 0.4


def program() -> Path | None:
    given = os.environ.get("FOLIATE")
    places = [Path(given)] if given else [ROOT / "target" / kind / "foliate" for kind in ("release", "debug")]
    return next((place for place in places if place.is_file()), None)


def link(name: str, size: str, at: str) -> str:
    mass = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    shape = f'<collision><origin xyz="{at}"/><geometry><box size="{size}"/></geometry></collision>' if size else ""
    return f'<link name="{name}">{mass}{shape}</link>'


def models(random: np.random.Generator) -> tuple[str, str]:
    """An arm of three joints, and four posts around it."""
    arm, parent, x = link("base", "", ""), "base", 0.0
    for index, axis in enumerate(("0 0 1", "0 1 0", "0 0 1")):
        arm += link(f"link{index}", "0.3 0.04 0.04", "0.2 0 0")
        arm += (f'<joint name="j{index}" type="revolute"><origin xyz="{x} 0 0"/><axis xyz="{axis}"/>'
                f'<parent link="{parent}"/><child link="link{index}"/>'
                '<limit lower="-9" upper="9" effort="1" velocity="99"/></joint>')
        parent, x = f"link{index}", LENGTH
    posts = link("root", "", "")
    for index in range(4):
        angle, far, high = random.uniform(0, 6.28), random.uniform(0.45, 1.15), random.uniform(-0.5, 0.5)
        posts += link(f"post{index}", "0.003 0.003 0.6", f"{far * np.cos(angle)} {far * np.sin(angle)} {high}")
        posts += f'<joint name="f{index}" type="fixed"><parent link="root"/><child link="post{index}"/></joint>'
    return f'<robot name="arm">{arm}</robot>', f'<robot name="posts">{posts}</robot>'


def hermite(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Coefficients (powers, joints) of the polynomial between two points of (derivatives, joints), by the general linear
    system of its ends."""
    orders, joints = a.shape
    degree = 2 * orders
    rows, values = np.zeros((degree, degree)), np.zeros((degree, joints))
    for order in range(orders):
        for power in range(order, degree):
            factor = np.prod(np.arange(power, power - order, -1, dtype=float)) if order else 1.0
            rows[order, power] = factor if power == order else 0.0
            rows[orders + order, power] = factor
        values[order], values[orders + order] = a[order], b[order]
    return np.linalg.solve(rows, values)


class World:
    def __init__(self, arm: str, posts: str):
        self.model = pin.buildModelFromXML(arm)
        self.geometry = pin.buildGeomFromUrdfString(self.model, arm, pin.GeometryType.COLLISION)
        others = pin.buildModelFromXML(posts)
        for shape in pin.buildGeomFromUrdfString(others, posts, pin.GeometryType.COLLISION).geometryObjects:
            self.geometry.addGeometryObject(pin.GeometryObject(shape.name, 0, 0, shape.placement, shape.geometry))
        self.geometry.addAllCollisionPairs()
        self.data, self.geometry_data = self.model.createData(), self.geometry.createData()

    def collides(self, state: np.ndarray) -> bool:
        return pin.computeCollisions(self.model, self.data, self.geometry, self.geometry_data, state, True)

    def distance(self, pair: list[str], state: np.ndarray) -> float:
        pin.updateGeometryPlacements(self.model, self.data, self.geometry, self.geometry_data, state)
        one, other = (self.geometry.getGeometryId(name.split("/")[1]) for name in pair)
        number = self.geometry.findCollisionPair(pin.CollisionPair(min(one, other), max(one, other)))
        return pin.computeDistance(self.geometry, self.geometry_data, number).min_distance


@unittest.skipIf(program() is None, "SKIPPED: no program; build it, or set FOLIATE")
class CertifyAgainstCoal(unittest.TestCase):
    def test_verdicts_hold_at_half_a_millimetre(self):
        random = np.random.default_rng(11)
        verdicts = {"free": 0, "contact": 0, "undecided": 0}
        for number in range(ROUNDS):
            with self.subTest(number=number), tempfile.TemporaryDirectory() as folder:
                arm, posts = models(random)
                orders = 2 + number % 2
                points = random.uniform(-1.2, 1.2, (3, orders, len(JOINTS)))
                report = self.certify(Path(folder), arm, posts, points)
                verdicts[report["verdict"]] += 1
                self.compare(World(arm, posts), points, report)
        self.assertGreater(min(verdicts["free"], verdicts["contact"]), 1, verdicts)

    def certify(self, folder: Path, arm: str, posts: str, points: np.ndarray) -> dict:
        (folder / "arm.urdf").write_text(arm)
        (folder / "posts.urdf").write_text(posts)
        (folder / "scene.toml").write_text(
            'format = "foliate.scene/1"\nname = "posts"\n'
            '[[part]]\nname = "arm"\nkind = "robot"\nurdf = "arm.urdf"\nignore = "none"\n'
            '[[part]]\nname = "posts"\nkind = "environment"\nurdf = "posts.urdf"\n'
            '[start]\n"arm/j0" = 0.0\n[[goal]]\nconfiguration = { "arm/j0" = 0.5 }\n')
        suffixes = ("", ".velocity", ".acceleration")[: points.shape[1]]
        header = ",".join(["time", *(f"{joint}{suffix}" for suffix in suffixes for joint in JOINTS)])
        rows = [",".join(map(repr, [float(i), *map(float, point.ravel())])) for i, point in enumerate(points)]
        (folder / "motion.csv").write_text("\n".join([header, *rows]))
        command = [str(program()), "certify", "motion.csv", "--scene", "scene.toml", "--json"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        self.assertIn(done.returncode, (0, 1, 4), done.stderr)
        return json.loads(done.stdout)["report"]

    def compare(self, world: World, points: np.ndarray, report: dict) -> None:
        curves = [hermite(a, b) for a, b in zip(points, points[1:])]
        powers = np.arange(len(curves[0]))

        def state(time: float) -> np.ndarray:
            index = min(int(time), len(points) - 2)
            return np.power(time - index, powers) @ curves[index]

        reach = sum(LENGTH * (3 - joint) for joint in range(3))
        time, end = 0.0, float(len(points) - 1)
        while time < end:
            if time < report["free_until"] or report["verdict"] == "free":
                self.assertFalse(world.collides(state(time)), f"{time}: {report}")
            # No joint is faster than what two states a little apart show, within a factor of two.
            speed = np.abs(state(min(time + 1e-4, end)) - state(time)).max() / 1e-4
            time += min(STEP / (2.0 * reach * max(speed, 0.1)), 1e-2)
        contact = report["contact"]
        if contact:
            times = np.linspace(contact["at"], contact["until"], 9)
            nearest = min(world.distance(contact["pair"]["shapes"], state(time)) for time in times)
            self.assertLess(nearest, 2e-6, contact)


if __name__ == "__main__":
    unittest.main()
