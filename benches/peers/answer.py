"""An answer of HPP tested by pinocchio and coal: does it collide, and does it keep what it holds.

The answer is configurations so close that a checker can choose among them. Those are kept between which no point of
any shape moves farther than `STEP`; every pair that the scene tests is tested at each. What HPP calls a motion's state is
not asked: an object must lie still where it was put down, or be in some gripper as its handle demands.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import coal
import numpy as np

import independent  # noqa: F401  (puts the independent checker's folder on the path)
from check_file import BREAKS, COLLIDES, MISSES, VALID
from clearance import ExactQueries, Placed, select_pairs
from constraints import frozen_errors, zero_errors
from leaves import placement_errors
from motion import SegmentMotion
from packages import search_directories
from path_file import Segment, read_path_file
from report import Report
from rigid import Poses, rotation_angle
from scene import Scene as Models
from scene_file import Manipulated, Relation, Scene
from settings import Settings

STEP = 5e-3
"""No point of any shape moves farther (m) between samples that are tested,"""
PENETRATION = 1e-4
"""and pairs may overlap by so much (m) there: HPP moves what it holds within its tolerance."""
TOLERANCES = 10.0
"""What is held, put down or fixed may be off by so many times HPP's own error threshold."""
COARSE = 0.02
"""Where the choice of samples begins (rad or m)."""
CHUNK = 256


@dataclass
class Finding:
    """What a check found: the deepest overlap (m), the largest error of anything held, put down or fixed (m or rad),
    the largest step between samples (m), how far the last configuration is from the goal, how far the centre of mass
    from where the scene wants it (m)."""

    samples: int = 0
    depth: float = 0.0
    pair: str = ""
    error: float = 0.0
    what: str = ""
    step: float = 0.0
    goal_off: float = 0.0
    centre_off: float = 0.0

    def see_overlap(self, depth: float, pair: str) -> None:
        if depth > self.depth:
            self.depth, self.pair = depth, pair

    def see_error(self, error: float, what: str) -> None:
        if error > self.error:
            self.error, self.what = float(error), what

    def verdict(self, settings: Settings) -> str:
        """Collides, breaks (lets go, moves what no gripper holds, leaves a fixed pose), misses the goal, or is valid."""
        if self.depth > PENETRATION:
            return COLLIDES
        if self.error > TOLERANCES * settings.threshold:
            return BREAKS
        return MISSES if self.goal_off > settings.may_move else VALID


class AnswerCheck:
    """For one scene. `template` is a path file of Foliate for the scene: it names models, documents and pairs."""

    def __init__(self, scene: Scene, template: Path, settings: Settings):
        self.scene, self.settings, self.allowed = scene, settings, TOLERANCES * settings.threshold
        self.models = Models(read_path_file(template), search_directories())
        report = Report()
        self.pairs = select_pairs(self.models, report)
        self.exact = ExactQueries(self.models.shapes, report)
        shapes = [entry.shape for entry in self.models.shapes]
        self.bodies = np.array([entry.body for entry in self.models.shapes], dtype=int)
        self.body_from_shape = Poses(
            np.array([shape.body_from_shape.rotation for shape in shapes]).reshape(-1, 3, 3),
            np.array([shape.body_from_shape.translation for shape in shapes]).reshape(-1, 3),
        )
        self.centers = np.array([shape.center for shape in shapes]).reshape(-1, 3)
        self.half_extents = np.array([shape.half_extents for shape in shapes]).reshape(-1, 3)
        self.radii = np.array([shape.radius for shape in shapes])

    def check(self, configurations: np.ndarray, pieces: np.ndarray) -> Finding:
        """`configurations` (N, coordinates), in the order of the scene's coordinates; `pieces` (N,) says of which
        sub-path each is."""
        finding = Finding()
        motion = SegmentMotion(self.models, Segment(0, "", "", [], [], self._in_file_order(configurations), None))
        kept = self._collisions(motion, pieces, finding)
        finding.samples = len(kept)
        worlds = motion.written_body_poses(kept)
        held = self._grasps(motion, worlds, finding)
        for name, entry in self.scene.objects.items():
            self._rests(motion, worlds, name, entry, held, finding)
        for relation in self.scene.everywhere:
            self._relation(motion, worlds, kept, relation, finding)
        finding.goal_off = float(np.abs(_difference(self.scene, configurations[-1], np.array(self.scene.goal))).max())
        return finding

    def grasp_changes(self, configurations: np.ndarray, pieces: np.ndarray) -> int:
        """How many grasps and releases there are: how often some handle begins or ceases to be where a gripper holds it."""
        motion = SegmentMotion(self.models, Segment(0, "", "", [], [], self._in_file_order(configurations), None))
        kept = _coarse(motion.knots, pieces)
        held = self._grasps(motion, motion.written_body_poses(kept), Finding())
        return sum(int(np.count_nonzero(samples[1:] != samples[:-1])) for samples in held.values())

    def _in_file_order(self, configurations: np.ndarray) -> np.ndarray:
        order = {name: column for column, name in enumerate(self.scene.coordinates)}
        return configurations[:, [order[name] for name in self.models.path.coordinates]]

    # Collisions

    def _collisions(self, motion: SegmentMotion, pieces: np.ndarray, finding: Finding) -> np.ndarray:
        """Tests the samples that are kept, and tells which they are."""
        kept, poses, finding.step = self._keep(motion, _coarse(motion.knots, pieces))
        for sample in range(len(kept)):
            self._test(poses[sample], finding)
        return kept

    def _keep(self, motion: SegmentMotion, kept: np.ndarray) -> tuple[np.ndarray, Poses, float]:
        """Samples between which no point of any shape moves farther than `STEP`, as far as the answer has them: a coarse
        choice, halved where something moves too far. Also the shapes' poses there, and the longest step."""
        poses = self._shape_poses(motion, kept)
        while True:
            moved = self._moved(poses)
            wide = np.flatnonzero((moved > STEP) & (np.diff(kept) > 1))
            if not len(wide):
                return kept, poses, float(moved.max(initial=0.0))
            middles = (kept[wide] + kept[wide + 1]) // 2
            between = self._shape_poses(motion, middles)
            kept = np.insert(kept, wide + 1, middles)
            poses = Poses(np.insert(poses.rotation, wide + 1, between.rotation, axis=0),
                          np.insert(poses.translation, wide + 1, between.translation, axis=0))

    def _shape_poses(self, motion: SegmentMotion, samples: np.ndarray) -> Poses:
        chunks = [motion.written_body_poses(samples[first:first + CHUNK])[:, self.bodies] @ self.body_from_shape
                  for first in range(0, len(samples), CHUNK)]
        return Poses(np.concatenate([chunk.rotation for chunk in chunks]),
                     np.concatenate([chunk.translation for chunk in chunks]))

    def _moved(self, poses: Poses) -> np.ndarray:
        """From each sample to the next: no point of any shape is farther from where it was (m)."""
        longest = []
        for first in range(0, len(poses.translation) - 1, CHUNK):
            here = poses[first:first + CHUNK + 1]
            shift = np.linalg.norm(np.diff(here.apply(self.centers), axis=0), axis=-1)
            chord = np.linalg.norm(np.diff(here.rotation, axis=0), axis=(-2, -1)) / np.sqrt(2.0)
            longest.append((shift + self.radii * chord).max(axis=1))
        return np.concatenate(longest) if longest else np.zeros(0)

    def _test(self, poses: Poses, finding: Finding) -> None:
        placed = Placed(poses)
        for pair in self._near(poses):
            one, other = int(self.pairs.first[pair]), int(self.pairs.second[pair])
            if self.exact.collide(placed, one, other):
                names = f"{self.models.shapes[one].link} - {self.models.shapes[other].link}"
                finding.see_overlap(self._depth(placed, one, other), names)

    def _near(self, poses: Poses) -> np.ndarray:
        """Pairs that neither bounding spheres nor a box against a sphere show to be apart."""
        centers = poses.apply(self.centers)
        one, other = self.pairs.first, self.pairs.second
        apart = np.linalg.norm(centers[other] - centers[one], axis=1)
        near = np.flatnonzero(apart < self.radii[one] + self.radii[other])
        for box, ball in ((one, other), (other, one)):
            offset = centers[ball[near]] - centers[box[near]]
            local = np.einsum("nji,nj->ni", poses.rotation[box[near]], offset)
            outside = np.maximum(np.abs(local) - self.half_extents[box[near]], 0.0)
            near = near[np.linalg.norm(outside, axis=1) < self.radii[ball[near]]]
        return near

    def _depth(self, placed: Placed, one: int, other: int) -> float:
        """How deep a pair overlaps; of meshes the deepest pair of triangles, which is never more than the truth."""
        request, result = coal.CollisionRequest(), coal.CollisionResult()
        request.enable_contact = True
        request.num_max_contacts = 64 if self.exact.meshes[one] or self.exact.meshes[other] else 1
        geometries = self.exact.geometries
        coal.collide(geometries[one], placed.transform(one), geometries[other], placed.transform(other), request, result)
        return max((abs(result.getContact(index).penetration_depth) for index in range(result.numContacts())), default=0)

    # What is held, and what lies

    def _grasps(self, motion: SegmentMotion, worlds: Poses, finding: Finding) -> dict[tuple[str, str], np.ndarray]:
        """For every grasp that may occur: at which samples it holds. While it does its free rows must not change."""
        held = {}
        for gripper in self.scene.grippers:
            for handle in self._handles_for(gripper):
                relative = motion.frame_poses(worlds, gripper).inverse() @ motion.frame_poses(worlds, handle)
                known = self.models.path.handles[handle]
                errors = np.max(list(zero_errors(relative, known.mask).values()), axis=0)
                held[gripper, handle] = errors <= self.allowed
                for run in _runs(held[gripper, handle]):
                    frozen = frozen_errors(relative[run], known.mask, known.mask_complement)
                    for rows in frozen.values():
                        finding.see_error(rows.max(), f"{handle} slips in {gripper}")
        return held

    def _handles_for(self, gripper: str) -> list[str]:
        everything = [handle for entry in self.scene.objects.values() for handle in entry.handles]
        return self.scene.grasps.get(gripper, []) if self.scene.grasps else everything

    def _rests(self, motion: SegmentMotion, worlds: Poses, name: str, entry: Manipulated, held: dict, finding) -> None:
        """An object lies still, or is held from one sample to the next; where it lies it is put down as it should."""
        poses = motion.frame_poses(worlds, name)
        mine = [samples for (_, handle), samples in held.items() if handle in entry.handles]
        anyhow = np.any(mine, axis=0) if mine else np.zeros(len(poses.translation), dtype=bool)
        rest: int | None = None if anyhow[0] else 0
        lies = [0] if rest == 0 else []
        for sample in range(1, len(poses.translation)):
            if rest is not None and _apart(poses[rest], poses[sample]) <= self.allowed:
                continue
            carried = any(samples[sample - 1] and samples[sample] for samples in mine)
            if carried:
                rest = None
                continue
            before = rest if rest is not None else sample - 1
            error = _apart(poses[before], poses[sample])
            finding.see_error(error, f"{name} moves while no gripper holds it")
            rest = before if error <= self.allowed else sample
            lies.append(rest)
        for sample in lies:
            self._placement(motion, worlds[sample:sample + 1], name, entry, finding)

    def _placement(self, motion: SegmentMotion, worlds: Poses, name: str, entry: Manipulated, finding) -> None:
        documents = self.models.path.surfaces
        if entry.plane is not None:
            relative = Poses.from_array(np.array(entry.plane)).inverse() @ motion.frame_poses(worlds, name)
            error = max(rows.max() for rows in zero_errors(relative, [False, False, True, True, True, False]).values())
            finding.see_error(error, f"{name} does not lie in its plane")
            return
        best = np.inf
        for surface in entry.surfaces:
            for support in self.scene.supports:
                upper, lower = documents[surface], documents[support]
                relative = motion.frame_poses(worlds, lower.link).inverse() @ motion.frame_poses(worlds, upper.link)
                errors = placement_errors(relative, upper, lower, self.scene.placement_margin)
                best = min(best, max(rows.max() for rows in errors.values()))
        finding.see_error(best, f"{name} lies on nothing")

    # What holds everywhere

    def _relation(self, motion: SegmentMotion, worlds: Poses, kept: np.ndarray, relation: Relation, finding) -> None:
        frames = motion.frame_poses(worlds, relation.frame)
        if relation.kind == "centre_of_mass":
            finding.centre_off = max(finding.centre_off, self._centre_off(motion, kept, frames, relation))
            return
        if relation.to is not None:
            frames = motion.frame_poses(worlds, relation.to).inverse() @ frames
        start = frames[:1].inverse()
        relative = Poses(start.rotation @ frames.rotation, start.apply(frames.translation))
        for rows in zero_errors(relative, relation.mask).values():
            finding.see_error(rows.max(), relation.name)

    def _centre_off(self, motion: SegmentMotion, kept: np.ndarray, frames: Poses, relation: Relation) -> float:
        """Told, but no part of the verdict: HPP 9.0.2 keeps another point than the centre of mass (README)."""
        member = self.models.by_name[relation.frame.partition("/")[0]]
        rows = motion.knots[kept]
        roots = motion.root_poses(member, rows, kept, np.zeros(len(kept)))
        centres = roots.apply(member.part.centre_of_mass(member.joint_values(rows)))
        local = frames.inverse().apply(centres)
        return float(np.linalg.norm((local - local[0])[:, relation.mask], axis=1).max())


def _coarse(knots: np.ndarray, pieces: np.ndarray) -> np.ndarray:
    """The ends of all sub-paths, where grasps begin and end, and samples between them from one to the next of which all
    numbers together change by about `COARSE`."""
    travelled = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(knots, axis=0)).sum(axis=1))])
    between = np.searchsorted(travelled, np.arange(0.0, travelled[-1], COARSE))
    changes = np.flatnonzero(np.diff(pieces))
    return np.unique(np.concatenate([between, changes, changes + 1, [0, len(knots) - 1]]))


def _runs(flags: np.ndarray) -> list[slice]:
    """The maximal runs of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    return [slice(int(start), int(end)) for start, end in zip(edges[::2], edges[1::2])]


def _apart(one: Poses, other: Poses) -> float:
    """Of two poses: the larger of distance (m) and angle (rad)."""
    turned = one.rotation.T @ other.rotation
    return max(float(np.linalg.norm(other.translation - one.translation)), float(rotation_angle(turned)))


def _difference(scene: Scene, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Of two configurations, number by number; angles the short way, quaternions whatever their sign."""
    difference = one - other
    for column, name in enumerate(scene.coordinates):
        part, _, coordinate = name.partition("/")
        if scene.part(part).root == "freeflyer" and coordinate == "qx":
            turned = slice(column, column + 4)
            if one[turned] @ other[turned] < 0.0:
                difference[turned] = one[turned] + other[turned]
        elif coordinate not in ("x", "y", "z", "qy", "qz", "qw"):
            difference[column] = (difference[column] + np.pi) % (2.0 * np.pi) - np.pi
    return difference
