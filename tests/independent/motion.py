"""How everything moves along one segment, as the path contract says it.

The parameter of a segment is counted in knots: `s = k + f` is the fraction `f` of the way from knot `k` to knot
`k + 1`. Joints and root positions are linear in `f`, roots of robots turn on the quaternion geodesic. In a path with
velocities `f` is the share of the time, and all numbers are cubic polynomials (`curve`); quaternions are scaled to length 1.
An object with a free-flying root keeps the pose it has in its carrier (or in the world) at the first knot.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from curve import Curve
from packages import InputError
from path_file import Attachment, Segment
from rigid import Poses, half_angle_between, slerp
from scene import Member, Scene


@dataclass(frozen=True)
class Carry:
    """An object that is attached to something: `carrier_from_carried` is constant; bodies in the scene's numbering,
    `carrier` None for the world. `carried` is the object's body that is held, mostly its root."""

    member: Member
    carrier: int | None
    carried: int
    carrier_from_carried: Poses
    by: Attachment | None


@dataclass(frozen=True)
class Edge:
    """Body `child` moves against `parent` (None: the world) by the degrees of freedom `turns` and `shifts`.
    `before` bounds the distance from the parent's origin to the anchor of the turn, `after` from the anchor to the
    child's origin."""

    parent: int | None
    child: int
    turns: tuple[int, ...]
    shifts: tuple[int, ...]
    before: float
    after: float


class SegmentMotion:
    """Poses of all bodies along a segment, and bounds on how far anything can move."""

    def __init__(self, scene: Scene, segment: Segment):
        self.scene, self.segment = scene, segment
        self.knots = segment.knots
        self.curve = Curve(segment.knots, segment.times, segment.velocities)
        self.last = len(self.knots) - 1
        self._first_freedom = np.cumsum([0] + [member.part.body_count + 1 for member in scene.members])
        self.carries = self._find_carries()

    # Poses

    def body_poses(self, parameters: np.ndarray) -> Poses:
        """Poses (N, bodies) in the world at parameters (N,)."""
        parameters = np.asarray(parameters, dtype=float)
        low, fraction = self._locate(parameters)
        rows = self._rows(low, fraction)
        worlds = self._empty(len(parameters))
        for member in self.scene.members:
            if not self.follows(member):
                roots = self.root_poses(member, rows, low, fraction)
                self._place(worlds, member, roots, self._in_root(member, rows))
        for carry in self.carries:
            in_root = self._in_root(carry.member, rows)
            roots = self._carried_roots(carry, worlds, in_root, len(parameters))
            self._place(worlds, carry.member, roots, in_root)
        return worlds

    def written_body_poses(self, knots: np.ndarray) -> Poses:
        """Poses (N, bodies) at knots (indices), objects placed where the file writes them, carriers unheeded."""
        low = np.asarray(knots, dtype=int)
        rows, worlds = self.knots[low], self._empty(len(low))
        for member in self.scene.members:
            roots = self.root_poses(member, rows, low, np.zeros(len(low)))
            self._place(worlds, member, roots, self._in_root(member, rows))
        return worlds

    def root_poses(self, member: Member, rows: np.ndarray, low: np.ndarray, fraction: np.ndarray) -> Poses:
        """World poses (N,) of a root link read from its own coordinates."""
        base = Poses.from_array(member.entry.world_from_root)
        if member.entry.root == "fixed":
            return Poses(np.broadcast_to(base.rotation, (len(rows), 3, 3)),
                         np.broadcast_to(base.translation, (len(rows), 3)))
        columns = rows[:, member.root_columns]
        if member.entry.root == "planar":
            return base @ Poses.planar(columns[:, 0], columns[:, 1], columns[:, 2])
        if self.curve.is_timed:
            return Poses.from_array(columns)
        quaternions = self.knots[:, member.root_columns[3:]]
        high = np.minimum(low + 1, self.last)
        turned = slerp(quaternions[low], quaternions[high], fraction)
        return Poses.from_array(np.concatenate([columns[:, :3], turned], axis=1))

    def joint_values(self, member: Member, parameters: np.ndarray) -> np.ndarray:
        """Joint values (N, body_count) of a part at parameters (N,)."""
        return member.joint_values(self._rows(*self._locate(np.asarray(parameters, dtype=float))))

    def frame_poses(self, worlds: Poses, name: str) -> Poses:
        """World poses (N,) of a named frame, given the bodies' poses."""
        body, body_from_frame = self.scene.frame(name)
        if body is None:
            count = len(worlds.translation)
            return Poses(np.broadcast_to(np.eye(3), (count, 3, 3)), np.zeros((count, 3)))
        return worlds[:, body] @ body_from_frame

    def _locate(self, parameters: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        low = np.clip(np.floor(parameters).astype(int), 0, self.last)
        return low, parameters - low

    def _rows(self, low: np.ndarray, fraction: np.ndarray) -> np.ndarray:
        return self.curve.rows(low, fraction)

    def _empty(self, count: int) -> Poses:
        bodies = self.scene.body_count
        return Poses(np.empty((count, bodies, 3, 3)), np.empty((count, bodies, 3)))

    def _in_root(self, member: Member, rows: np.ndarray) -> Poses:
        return member.part.body_poses(member.joint_values(rows))

    @staticmethod
    def _place(worlds: Poses, member: Member, roots: Poses, in_root: Poses) -> None:
        bodies = slice(member.first_body, member.first_body + member.part.body_count)
        placed = roots[:, None] @ in_root
        worlds.rotation[:, bodies], worlds.translation[:, bodies] = placed.rotation, placed.translation

    def _carried_roots(self, carry: Carry, worlds: Poses, in_root: Poses, count: int) -> Poses:
        if carry.carrier is None:
            carried = Poses(np.broadcast_to(carry.carrier_from_carried.rotation, (count, 3, 3)),
                            np.broadcast_to(carry.carrier_from_carried.translation, (count, 3)))
        else:
            carried = worlds[:, carry.carrier] @ carry.carrier_from_carried
        return carried @ in_root[:, carry.carried - carry.member.first_body].inverse()

    # Carriers

    def _find_carries(self) -> list[Carry]:
        """One carry per floating object, carriers before what they carry."""
        written = self.written_body_poses(np.array([0]))[0]
        waiting = {member.index: self._carry(member, written) for member in self.scene.members if self.follows(member)}
        ordered = []
        while waiting:
            ready = [index for index, carry in waiting.items() if self._holder(carry) not in waiting]
            if not ready:
                names = ", ".join(self.scene.members[index].name for index in waiting)
                raise InputError(f"{self._where()}: {names} carry each other")
            ordered += [waiting.pop(index) for index in ready]
        return ordered

    def follows(self, member: Member) -> bool:
        """Whether an object's root is no motion of its own: it has a carrier, or nothing holds it. One that is held
        without a carrier (its handle leaves rotations free) moves as written."""
        mine = [item for item in self.segment.attachments if item.object.partition("/")[0] == member.name]
        return member.floats and (any(item.carrier for item in mine) or not any(item.is_grasp for item in mine))

    def _holder(self, carry: Carry) -> int | None:
        return None if carry.carrier is None else self.scene.member_of_body(carry.carrier).index

    def _carry(self, member: Member, written: Poses) -> Carry:
        carriers = [
            attachment
            for attachment in self.segment.attachments
            if attachment.carrier and attachment.object.partition("/")[0] == member.name
        ]
        if len(carriers) > 1:
            raise InputError(f"{self._where()}: {member.name} has {len(carriers)} carriers")
        if not carriers:
            return Carry(member, None, member.first_body, written[member.first_body], None)
        holder, held = attachment_links(self.scene, carriers[0])
        carrier, carried = self.scene.link(holder)[0], self.scene.link(held)[0]
        if self.scene.member_of_body(carried) is not member or self.scene.member_of_body(carrier) is member:
            raise InputError(f"{self._where()}: {carriers[0]} does not carry {member.name}")
        return Carry(member, carrier, carried, written[carrier].inverse() @ written[carried], carriers[0])

    def _where(self) -> str:
        return f"{self.scene.path.file}: segment {self.segment.index}"

    # Bounds on movement

    def joint_freedom(self, member: Member, joint: int) -> int:
        """Number of a joint's degree of freedom; a member has two more, for its root's shift and turn."""
        return int(self._first_freedom[member.index]) + joint - 1

    def root_freedoms(self, member: Member) -> tuple[int, int]:
        """Numbers of the root's shift and turn."""
        after = int(self._first_freedom[member.index + 1])
        return after - 2, after - 1

    @property
    def freedom_count(self) -> int:
        return int(self._first_freedom[-1])

    def cumulative_travel(self) -> np.ndarray:
        """How far each degree of freedom has gone (rad or m) at most from the first knot to each knot, (knots, freedoms).
        Within a knot interval it is linear in the parameter: as if the freedom were always at its fastest."""
        steps = np.zeros((self.last + 1, self.freedom_count))
        fastest = self.curve.fastest()
        for member in self.scene.members:
            # Followers are linear in their leaders.
            values = np.abs(member.joint_values(fastest) - member.joint_values(np.zeros_like(fastest)))
            for joint in member.part.joints:
                steps[1:, self.joint_freedom(member, joint.index)] = values[:, joint.index]
            if member.root_columns and not self.follows(member):
                shift, turn = self.root_freedoms(member)
                steps[1:, shift], steps[1:, turn] = self._root_steps(member)
        return np.cumsum(steps, axis=0)

    def _root_steps(self, member: Member) -> tuple[np.ndarray, np.ndarray]:
        columns = self.knots[:, member.root_columns]
        if self.curve.is_timed:
            fastest = self.curve.fastest()[:, member.root_columns]
            shifts = np.linalg.norm(fastest[:, :2 if member.entry.root == "planar" else 3], axis=1)
            if member.entry.root == "planar":
                return shifts, fastest[:, 2]
            # A unit quaternion that is scaled from length n turns by twice its derivative over n at most.
            least, turning = self.curve.norm_bounds(member.root_columns[3:])
            return shifts, 2.0 * turning / np.maximum(least, 0.1)
        if member.entry.root == "planar":
            return np.linalg.norm(np.diff(columns[:, :2], axis=0), axis=1), np.abs(np.diff(columns[:, 2]))
        turns = 2.0 * half_angle_between(columns[:-1, 3:], columns[1:, 3:])
        return np.linalg.norm(np.diff(columns[:, :3], axis=0), axis=1), turns

    def edges(self) -> list[Edge]:
        """The segment's attachment tree, parents before children: joints within parts, carried objects on their
        carriers, from the held link outwards."""
        edges = []
        for member in self.scene.members:
            if not self.follows(member):
                edges += [self._root_edge(member)] + self._joint_edges(member, 0)
        for carry in self.carries:
            offset = float(np.linalg.norm(carry.carrier_from_carried.translation)) if carry.carrier is not None else 0.0
            edges.append(Edge(carry.carrier, carry.carried, (), (), offset, 0.0))
            edges += self._joint_edges(carry.member, carry.carried - carry.member.first_body)
        return edges

    def _root_edge(self, member: Member) -> Edge:
        if member.entry.root == "fixed":
            return Edge(None, member.first_body, (), (), 0.0, 0.0)
        shift, turn = self.root_freedoms(member)
        return Edge(None, member.first_body, (turn,), (shift,), 0.0, 0.0)

    def _joint_edges(self, member: Member, start: int) -> list[Edge]:
        """The part's joints as edges that lead away from body `start`."""
        parents = member.part.parents
        values = np.concatenate([member.joint_values(rows) for rows in self.curve.ranges()])
        joints = {joint.index: joint for joint in member.part.joints}
        edges, visited, frontier = [], {start}, [start]
        while frontier:
            body = frontier.pop()
            forward = [joint for joint in joints if parents[joint] == body]
            backward = [body] if body in joints else []
            for index in forward + backward:
                other = index if index != body else parents[body]
                if other in visited:
                    continue
                offset = float(np.linalg.norm(member.part.placements[index].translation))
                slide = float(np.abs(values[:, index]).max()) if joints[index].prismatic else 0.0
                before, after = (offset, slide) if index == other else (slide, offset)
                freedom = (self.joint_freedom(member, index),)
                turns, shifts = ((), freedom) if joints[index].prismatic else (freedom, ())
                edges.append(Edge(member.first_body + body, member.first_body + other, turns, shifts, before, after))
                visited.add(other)
                frontier.append(other)
        return edges

    def reaches(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """For degrees of freedom x bodies: whether the body is moved by it (in the attachment tree), whether it
        turns, and an upper bound of the distance from the axis to the body's origin that holds all along."""
        moved = np.zeros((self.freedom_count, self.scene.body_count), dtype=bool)
        reach = np.zeros((self.freedom_count, self.scene.body_count))
        turning = np.zeros(self.freedom_count, dtype=bool)
        for edge in self.edges():
            if edge.parent is not None:
                moved[:, edge.child] = moved[:, edge.parent]
                reach[:, edge.child] = reach[:, edge.parent] + edge.before + edge.after
            for freedom in edge.turns + edge.shifts:
                moved[freedom, edge.child] = True
                reach[freedom, edge.child] = edge.after
                turning[freedom] = freedom in edge.turns or turning[freedom]
        return moved, turning, reach


def attachment_links(scene: Scene, attachment: Attachment) -> tuple[str, str]:
    """Links (`part/link`) that hold and are held: gripper and handle, support and surface, or what is rested on and the
    object's root."""
    path = scene.path
    if attachment.on:
        return attachment.on, scene.root_link(attachment.object.partition("/")[0])
    documents = (
        [(path.grippers, attachment.gripper), (path.handles, attachment.handle)]
        if attachment.is_grasp
        else [(path.surfaces, attachment.support), (path.surfaces, attachment.surface)]
    )
    for known, name in documents:
        if name not in known:
            raise InputError(f"{path.file}: attachment {attachment}: {name!r} is not in documents")
    holder, held = (known[name].link for known, name in documents)
    return holder, held
