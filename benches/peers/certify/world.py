"""A scene of one fixed robot among fixed obstacles, as one URDF that every peer reads, and as pinocchio and coal see it.

The obstacles of the scene are attached to the robot's root by fixed joints. Joints that the scene locks keep their values;
what mimics a locked joint keeps its own.
"""

from __future__ import annotations

import sys
import tomllib
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import coal  # noqa: F401  (pinocchio's geometry needs its types)
import numpy as np
import pinocchio as pin

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from independent import resolve, search_directories  # noqa: E402

SCENES = HERE.parents[2] / "scenes"
ROBOT = "panda"
SCENE_NAMES = ("panda-table", "panda-shelf", "panda-box", "panda-cage")


class World:
    """`joints` are planned for, in this order; a state is their values (rad)."""

    def __init__(self, name: str):
        self.name = name
        file = SCENES / name / "scene.toml"
        scene = tomllib.loads(file.read_text())
        folders = search_directories()
        parts = {part["name"]: part for part in scene["part"]}
        robot, beside = parts.pop(ROBOT), file.parent
        urdf = resolve(robot["urdf"], folders, beside)
        self.package_directories = [str(folder) for folder in folders]
        self.srdf = resolve(robot["srdf"], folders, beside).read_text()
        self.urdf = _with_obstacles(urdf, [resolve(part["urdf"], folders, beside) for part in parts.values()])
        self.joints = [f"panda_joint{i}" for i in range(1, 8)]
        self.model = pin.buildModelFromXML(self.urdf)
        self.geometry = pin.buildGeomFromUrdfString(
            self.model, self.urdf, pin.GeometryType.COLLISION, package_dirs=self.package_directories)
        self.geometry.addAllCollisionPairs()
        pin.removeCollisionPairsFromXML(self.model, self.geometry, self.srdf)
        self.data, self.geometry_data = self.model.createData(), self.geometry.createData()
        self.broad = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
            self.model, self.geometry, self.geometry_data)
        self.base = np.array(pin.neutral(self.model))
        for finger in ("panda_finger_joint1", "panda_finger_joint2"):
            self.base[self._index(finger)] = 0.04
        self.columns = [self._index(joint) for joint in self.joints]
        self.low = self.model.lowerPositionLimit[self.columns]
        self.high = self.model.upperPositionLimit[self.columns]
        self.start = np.array([scene["start"][f"{ROBOT}/{joint}"] for joint in self.joints])
        goal = scene["goal"][0]["configuration"]
        self.goal = np.array([goal[f"{ROBOT}/{joint}"] for joint in self.joints])
        self.reach = self._reaches()

    def _index(self, joint: str) -> int:
        return self.model.idx_qs[self.model.getJointId(joint)]

    @property
    def pairs(self) -> int:
        return len(self.geometry.collisionPairs)

    def whole(self, state) -> np.ndarray:
        q = self.base.copy()
        q[self.columns] = state
        return q

    def collides(self, state) -> bool:
        """Whether any pair of shapes overlaps, by coal."""
        return pin.computeCollisions(self.model, self.data, self.broad, self.whole(state), True)

    def _place(self, pair: list[str], state) -> tuple[int, int]:
        """Numbers of two shapes by our names (`part/link_0`), everything placed."""
        pin.updateGeometryPlacements(self.model, self.data, self.geometry, self.geometry_data, self.whole(state))
        one, other = (self.geometry.getGeometryId(name.split("/", 1)[1]) for name in pair)
        return one, other

    def overlaps(self, pair: list[str], state) -> bool:
        """Whether two shapes overlap, by coal; surfaces closer than it can tell (1e-6 m) do."""
        one, other = self._place(pair, state)
        number = self.geometry.findCollisionPair(pin.CollisionPair(min(one, other), max(one, other)))
        return pin.computeDistance(self.geometry, self.geometry_data, number).min_distance < 1e-6

    def encloses(self, pair: list[str], state) -> bool:
        """Whether the middle of one shape lies inside the other, a closed mesh: the mesh turns around it once."""
        one, other = self._place(pair, state)
        return any(self._turns(*shapes) > 0.5 for shapes in ((one, other), (other, one)))

    def _turns(self, outer: int, inner: int) -> float:
        mesh, shape = (self.geometry.geometryObjects[i].geometry for i in (outer, inner))
        if not hasattr(mesh, "tri_indices"):
            return 0.0
        shape.computeLocalAABB()
        place = self.geometry_data.oMg
        point = place[outer].actInv(place[inner].act(np.array(shape.aabb_center)))
        corners = np.array([mesh.vertices(int(i)) for i in range(mesh.num_vertices)]).reshape(-1, 3) - point
        triangles = np.array([[mesh.tri_indices(i)[k] for k in range(3)] for i in range(mesh.num_tris)])
        a, b, c = (corners[triangles[:, i]] for i in range(3))
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        dot = lambda x, y: np.einsum("ij,ij->i", x, y)  # noqa: E731
        volume = dot(a, np.cross(b, c))
        angle = np.arctan2(volume, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
        return abs(angle.sum() / (2.0 * np.pi))

    def valid(self, state) -> bool:
        return bool(np.all(state >= self.low) and np.all(state <= self.high)) and not self.collides(state)

    def queries(self, count: int, seed: int) -> list[tuple[np.ndarray, np.ndarray]]:
        """Pairs of random configurations that are valid; the first pair is the scene's own start and goal."""
        random = np.random.default_rng(seed)
        found = [(self.start, self.goal)]
        while len(found) < count:
            pair = []
            while len(pair) < 2:
                state = random.uniform(self.low, self.high)
                if self.valid(state):
                    pair.append(state)
            found.append((pair[0], pair[1]))
        return found

    def samples(self, states: np.ndarray, step: float):
        """Along a polyline, so that no point of any body moves farther than `step` (m) from one to the next, with their
        parameters in points."""
        for index in range(len(states) - 1):
            a, b = states[index], states[index + 1]
            count = max(1, int(np.ceil(np.abs(b - a) @ self.reach / step)))
            for number in range(count):
                yield index + number / count, a + (b - a) * (number / count)
        yield float(len(states) - 1), states[-1]

    def _reaches(self) -> np.ndarray:
        """How far from each joint's axis any point beyond it can be at most (m): sums of offsets."""
        far = np.zeros(self.model.njoints)
        for shape in self.geometry.geometryObjects:
            if shape.parentJoint == 0:
                continue
            shape.geometry.computeLocalAABB()
            reach = np.linalg.norm(shape.placement.act(shape.geometry.aabb_center)) + shape.geometry.aabb_radius
            far[shape.parentJoint] = max(far[shape.parentJoint], reach)
        for joint in range(self.model.njoints - 1, 0, -1):
            parent = self.model.parents[joint]
            slides = 0.04 if "finger" in self.model.names[joint] else 0.0
            beyond = far[joint] + slides + np.linalg.norm(self.model.jointPlacements[joint].translation)
            far[parent] = max(far[parent], beyond)
        return np.array([far[self.model.getJointId(joint)] for joint in self.joints])


def _with_obstacles(robot: Path, obstacles: list[Path]) -> str:
    root = ElementTree.parse(robot).getroot()
    links = {link.get("name") for link in root.findall("link")}
    children = {joint.find("child").get("link") for joint in root.findall("joint")}
    base = next(iter(links - children))
    for file in obstacles:
        for element in ElementTree.parse(file).getroot():
            if element.tag == "link" and element.get("name") not in links:
                root.append(element)
                joint = ElementTree.SubElement(root, "joint", name=f"{element.get('name')}_to_base", type="fixed")
                ElementTree.SubElement(joint, "parent", link=base)
                ElementTree.SubElement(joint, "child", link=element.get("name"))
    return ElementTree.tostring(root, encoding="unicode")
