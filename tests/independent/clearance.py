"""Collision along a segment, decided by coal.

Which pairs: shapes on different bodies, not both fixed to the world, minus pairs of links that the part's SRDF
disables, minus the file's `ignored_pairs`. Body poses come from the motion as it is played.

How far: between two parameters, points of two shapes approach each other by at most V = sum over the degrees of
freedom between them of |travel| * reach, where the reach of a turn is an upper bound of the distance from its axis to
any point of the shape that holds all along the segment (sums of offsets along the attachment tree), and that of a
shift is one. Two ways to use it:

* `sample`: samples so close that no point of any shape moves more than the step from one to the next; every pair is
  tested at each.
* `certify`: a pair with clearance d at a sample is free as long as V < d; intervals are halved until they are covered.
  An interval in which a pair moves less than `RESOLUTION` is not halved again: it passes when its middle is free. So
  a certified motion never penetrates deeper than `RESOLUTION` and coal's accuracy.

Bounding spheres and boxes only ever decide "far enough"; coal decides the rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import coal
import numpy as np

from motion import SegmentMotion, attachment_links
from parts import Shape, read_disabled_pairs
from path_file import Segment
from report import Report
from rigid import Poses
from scene import Scene, SceneShape

RESOLUTION = 1e-6
"""Intervals of less relative movement (m) than this are not divided further."""
COAL_ACCURACY = 2e-6
"""coal's distances are trusted to this (m); its GJK stops at 1e-6."""
MESH_MARGIN = 0.02
"""coal is asked whether meshes are farther apart than the least distance allowed and this (m) only by their boxes;
intervals are halved instead."""
MEASURING_SLACK = 2e-3
"""How much farther than the smallest distance so far (m) a pair is asked to be, so as not to be asked at every knot."""
CHUNK = 256
"""Samples whose poses are computed at once when certifying..."""
RUN = 64
"""...and when sampling."""


@dataclass(frozen=True)
class Pairs:
    """The pairs to test: indices into the scene's shapes."""

    first: np.ndarray
    second: np.ndarray

    def __len__(self) -> int:
        return len(self.first)


def select_pairs(scene: Scene, report: Report) -> Pairs:
    """All pairs that count, over all segments."""
    disabled = _disabled_pairs(scene)
    ignored = _ignored_pairs(scene, report)
    first, second = [], []
    for index, one in enumerate(scene.shapes):
        for other_index in range(index + 1, len(scene.shapes)):
            other = scene.shapes[other_index]
            links = frozenset((one.link, other.link))
            if one.body == other.body or (one.world_fixed and other.world_fixed):
                continue
            if links in disabled:
                report.count("pairs_disabled_by_srdf")
            elif links in ignored:
                report.count("pairs_ignored_by_file")
            else:
                first.append(index)
                second.append(other_index)
    report.count("pairs", len(first))
    return Pairs(np.array(first, dtype=int), np.array(second, dtype=int))


def _disabled_pairs(scene: Scene) -> set[frozenset[str]]:
    return {
        frozenset(f"{member.name}/{link}" for link in links)
        for member in scene.members
        if member.srdf
        for links in read_disabled_pairs(member.srdf)
    }


def _ignored_pairs(scene: Scene, report: Report) -> set[frozenset[str]]:
    """The file's own list; each reason is told, for a file that ignored everything would be free of collisions."""
    reasons: dict[str, int] = {}
    for one, other, reason in scene.path.ignored_pairs:
        scene.link(one), scene.link(other)
        reasons[reason] = reasons.get(reason, 0) + 1
    for reason, count in reasons.items():
        report.note(f"{count} link pairs ignored by the file: {reason}")
    return {frozenset((one, other)) for one, other, _ in scene.path.ignored_pairs}


def _margins(scene: Scene) -> dict[frozenset[str], float]:
    for one, other, _ in scene.path.margins:
        scene.link(one), scene.link(other)
    return {frozenset((one, other)): margin for one, other, margin in scene.path.margins}


class Clearance:
    """Tests the selected pairs along segments."""

    def __init__(self, scene: Scene, report: Report):
        self.scene, self.report = scene, report
        self.shapes = scene.shapes
        self.pairs = select_pairs(scene, report)
        self.bodies = np.array([shape.body for shape in self.shapes], dtype=int)
        self.body_from_shape = Poses(
            np.array([shape.shape.body_from_shape.rotation for shape in self.shapes]).reshape(-1, 3, 3),
            np.array([shape.shape.body_from_shape.translation for shape in self.shapes]).reshape(-1, 3),
        )
        self.centers = np.array([shape.shape.center for shape in self.shapes]).reshape(-1, 3)
        self.half_extents = np.array([shape.shape.half_extents for shape in self.shapes]).reshape(-1, 3)
        self.radii = np.array([shape.shape.radius for shape in self.shapes])
        self.reach = np.array([shape.shape.reach for shape in self.shapes])
        self.exact = ExactQueries(self.shapes, report)
        self.margins = _margins(scene)

    def check(self, motion: SegmentMotion, step: float | None) -> None:
        """One segment: certified when `step` is None, else sampled with that step (m)."""
        if not len(self.pairs):
            return
        travel = motion.cumulative_travel()
        shape_reach, pair_reach = self._travel_bounds(motion)
        thresholds = self._thresholds(motion.segment)
        if step is None:
            self._certify(motion, travel, pair_reach, thresholds)
        else:
            self._sample(motion, travel, shape_reach, pair_reach, thresholds, step)
        self._measure_at_knots(motion, travel, pair_reach)

    def check_written_end(self, motion: SegmentMotion) -> None:
        """The last knot as written (objects where the file puts them, not where carriers take them)."""
        placed = Placed(self._shape_poses(motion.written_body_poses(np.array([motion.last])))[0])
        for pair, threshold in enumerate(self._thresholds(motion.segment)):
            self._test(motion, float(motion.last), placed, pair, threshold)

    def check_enclosed(self, motion: SegmentMotion) -> None:
        """Shapes that lie wholly inside a closed mesh at the first knot. coal sees meshes as hollow; what starts
        outside and never touches the surface stays outside."""
        shape_poses = self._shape_poses(motion.body_poses(np.array([0.0])))[0]
        for first, second in zip(self.pairs.first, self.pairs.second):
            for outer, inner in ((first, second), (second, first)):
                if self.shapes[outer].shape.is_mesh and self.exact.encloses(outer, inner, shape_poses):
                    subject = f"{self.shapes[inner].link} inside {self.shapes[outer].link}"
                    self.report.violate(motion.segment.index, 0.0, "enclosed", subject)

    # Bounds

    def _travel_bounds(self, motion: SegmentMotion) -> tuple[np.ndarray, np.ndarray]:
        """Movement per travel: of shapes in the world (freedoms, shapes), and of pairs against each other
        (freedoms, pairs), counting only degrees of freedom between the two bodies."""
        moved, turning, reach = motion.reaches()
        moved, reach = moved[:, self.bodies], reach[:, self.bodies] + self.reach[None]
        shape_reach = np.where(moved, np.where(turning[:, None], reach, 1.0), 0.0)
        one, other = self.pairs.first, self.pairs.second
        return shape_reach, np.where(moved[:, one] != moved[:, other], shape_reach[:, one] + shape_reach[:, other], 0.0)

    def _thresholds(self, segment: Segment) -> np.ndarray:
        """Smallest distance allowed for each pair: zero, or the file's margin unless the pair touches by grasp or
        placement where the transition that the segment travels begins or ends."""
        thresholds = np.zeros(len(self.pairs))
        if not self.margins:
            return thresholds
        touching = self._touching_bodies(segment)
        for pair, (first, second) in enumerate(zip(self.pairs.first, self.pairs.second)):
            one, other = self.shapes[first], self.shapes[second]
            margin = self.margins.get(frozenset((one.link, other.link)), 0.0)
            if frozenset((one.body, other.body)) not in touching:
                thresholds[pair] = margin
        return thresholds

    def _touching_bodies(self, segment: Segment) -> set[frozenset[int]]:
        """Body pairs in contact by an attachment: the held body with the holder's, and for a gripper with the bodies
        that are attached directly to it (fingers)."""
        touching = set()
        for neighbour in self._of_one_transition(segment):
            for attachment in neighbour.attachments:
                holder, held = (self.scene.link(link)[0] for link in attachment_links(self.scene, attachment))
                bodies = [holder] + (self._children(holder) if attachment.is_grasp else [])
                touching |= {frozenset((body, held)) for body in bodies}
        return touching

    def _of_one_transition(self, segment: Segment) -> list[Segment]:
        """The segments that travel one transition together with this one, and the ones before and after, which lie in
        the states that it joins."""
        segments, first, last = self.scene.path.segments, segment.index, segment.index
        while segment.transition and first > 0 and segments[first - 1].transition == segment.transition:
            first -= 1
        while segment.transition and last + 1 < len(segments) and segments[last + 1].transition == segment.transition:
            last += 1
        return segments[max(first - 1, 0):last + 2]

    def _children(self, body: int) -> list[int]:
        member = self.scene.member_of_body(body)
        own = body - member.first_body
        parents = member.part.parents
        return [member.first_body + child for child in range(1, len(parents)) if parents[child] == own]

    def _shape_poses(self, worlds: Poses) -> Poses:
        return worlds[:, self.bodies] @ self.body_from_shape

    def _near(self, poses: Poses, samples: np.ndarray, pairs: np.ndarray, wanted: np.ndarray) -> np.ndarray:
        """Indices of the (sample, pair) entries that bounding spheres and boxes do not show to be `wanted` apart."""
        centers = poses.apply(self.centers)
        one, other = self.pairs.first[pairs], self.pairs.second[pairs]
        apart = centers[samples, other] - centers[samples, one]
        squared = np.einsum("ni,ni->n", apart, apart)
        near = np.flatnonzero(squared < np.maximum(wanted + self.radii[one] + self.radii[other], 0.0) ** 2)
        bounds = self._box_bounds(poses, centers, samples[near], pairs[near])
        return near[bounds < wanted[near]]

    def _box_bounds(self, poses: Poses, centers: np.ndarray, samples: np.ndarray, pairs: np.ndarray) -> np.ndarray:
        """Lower bounds of distances: each shape's local box against the other's bounding sphere."""
        one, other = self.pairs.first[pairs], self.pairs.second[pairs]
        bound = np.full(len(pairs), -np.inf)
        for box, ball in ((one, other), (other, one)):
            offset = centers[samples, ball] - centers[samples, box]
            local = np.einsum("nji,nj->ni", poses.rotation[samples, box], offset)
            outside = np.maximum(np.abs(local) - self.half_extents[box], 0.0)
            bound = np.maximum(bound, np.linalg.norm(outside, axis=1) - self.radii[ball])
        return bound

    # Certifying

    def _certify(self, motion: SegmentMotion, travel: np.ndarray, pair_reach: np.ndarray, thresholds) -> None:
        """Conservative advancement by halving: entries are (interval, pair) not yet known to be free."""
        clock = _Clock(travel, pair_reach)
        low, high = np.array([0.0]), np.array([1.0])
        entries = np.zeros(len(self.pairs), dtype=int), np.arange(len(self.pairs))
        while len(entries[0]):
            middle = (low + high) / 2.0
            keep = [
                self._certify_chunk(motion, clock, (low, middle, high), chunk, thresholds)
                for chunk in _chunks(entries)
            ]
            intervals = np.concatenate([kept[0] for kept in keep])
            pairs = np.concatenate([kept[1] for kept in keep])
            used, intervals = np.unique(intervals, return_inverse=True)
            low, high = (
                np.stack([low[used], middle[used]], axis=1).ravel(),
                np.stack([middle[used], high[used]], axis=1).ravel(),
            )
            entries = np.concatenate([2 * intervals, 2 * intervals + 1]), np.concatenate([pairs, pairs])
            order = np.argsort(entries[0], kind="stable")
            entries = entries[0][order], entries[1][order]

    def _certify_chunk(self, motion, clock: "_Clock", bounds, entries, thresholds) -> tuple[np.ndarray, np.ndarray]:
        """The entries of this chunk that need halving."""
        low, middle, high = bounds
        used, samples = np.unique(entries[0], return_inverse=True)
        pairs = entries[1]
        self.report.count("samples", len(used))
        poses = self._shape_poses(motion.body_poses(clock.parameters(middle[used])))
        ahead, behind = clock.travel_between(low[used], middle[used]), clock.travel_between(middle[used], high[used])
        needed = np.maximum(clock.movement(ahead, samples, pairs), clock.movement(behind, samples, pairs))
        wanted = needed + thresholds[pairs] + COAL_ACCURACY
        placed = [Placed(poses[sample]) for sample in range(len(used))]
        undecided = []
        for entry in self._near(poses, samples, pairs, wanted):
            sample, pair = int(samples[entry]), int(pairs[entry])
            query = placed[sample], *self._shapes_of(pair), float(wanted[entry]), float(thresholds[pair])
            if self.exact.surely_farther_than(*query):
                continue
            parameter = float(clock.parameters(middle[used[sample]]))
            if self._test(motion, parameter, placed[sample], pair, thresholds[pair]):
                continue
            if needed[entry] > RESOLUTION:
                undecided.append(entry)
            else:
                self.report.count("intervals_at_resolution")
        return entries[0][undecided], pairs[undecided]

    # Sampling

    def _sample(self, motion: SegmentMotion, travel, shape_reach, pair_reach, thresholds, step: float) -> None:
        counts = np.maximum(np.ceil((np.diff(travel, axis=0) @ shape_reach).max(axis=1, initial=0.0) / step), 1)
        pieces = [knot + np.arange(count) / count for knot, count in enumerate(counts)]
        parameters = np.concatenate(pieces + [[float(motion.last)]])
        self.report.count("samples", len(parameters))
        for start in range(0, len(parameters), RUN):
            run = parameters[start:start + RUN]
            poses = self._shape_poses(motion.body_poses(run))
            placed = [Placed(poses[sample]) for sample in range(len(run))]
            candidates = self._near_during(run, poses, travel, pair_reach, thresholds)
            samples, pairs = np.repeat(np.arange(len(run)), len(candidates)), np.tile(candidates, len(run))
            for entry in self._near(poses, samples, pairs, thresholds[pairs] + COAL_ACCURACY):
                sample, pair = int(samples[entry]), int(pairs[entry])
                self._test(motion, float(run[sample]), placed[sample], pair, thresholds[pair])

    def _near_during(self, run: np.ndarray, poses: Poses, travel, pair_reach, thresholds) -> np.ndarray:
        """Pairs that could meet somewhere in a run of samples: not kept apart by their distance at its middle."""
        knots, middle = np.arange(len(travel), dtype=float), len(run) // 2
        at = np.array([[np.interp(t, knots, column) for column in travel.T] for t in run[[0, middle, -1]]])
        movement = (np.maximum(at[1] - at[0], at[2] - at[1]) @ pair_reach) + thresholds + COAL_ACCURACY
        return self._near(poses, np.full(len(self.pairs), middle), np.arange(len(self.pairs)), movement)

    # Exact tests

    def _shapes_of(self, pair: int) -> tuple[int, int]:
        return int(self.pairs.first[pair]), int(self.pairs.second[pair])

    def _test(self, motion: SegmentMotion, parameter: float, placed: "Placed", pair: int, threshold: float) -> bool:
        """Whether a pair is in violation at one sample; reports it."""
        one, other = self._shapes_of(pair)
        collides = self.exact.collide(placed, one, other)
        if not collides and (threshold == 0.0 or self.exact.farther_than(placed, one, other, threshold)):
            return False
        distance = self.exact.distance(placed, one, other)
        if not collides and distance >= threshold:
            return False
        kind, name = "collision" if collides else "margin", self._pair_name(pair)
        self.report.violate(motion.segment.index, parameter, kind, name, distance, 0.0 if collides else threshold)
        self.report.see_distance(motion.segment.index, parameter, name, distance)
        return True

    def _measure_at_knots(self, motion: SegmentMotion, travel, pair_reach, most: int = 500) -> None:
        """The smallest distance at (at most so many) knots: what a claimed clearance must not exceed. A pair that was
        seen far apart is asked again only once it may have come near."""
        everything = np.arange(len(self.pairs))
        knots = np.unique(np.linspace(0, motion.last, most).astype(int))
        moved = travel[knots] @ pair_reach
        seen = _Seen(np.full(len(self.pairs), -np.inf), np.zeros(len(self.pairs)))
        for row, knot in enumerate(knots):
            poses = self._shape_poses(motion.body_poses(np.array([float(knot)])))
            samples = np.zeros(len(everything), dtype=int)
            bounds = self._box_bounds(poses, poses.apply(self.centers), samples, everything)
            bounds = np.maximum(bounds, seen.at_least - (moved[row] - seen.moved))
            self._measure(motion, float(knot), Placed(poses[0]), bounds, seen, moved[row])

    def _measure(self, motion, parameter: float, placed: "Placed", bounds, seen: "_Seen", moved) -> None:
        for pair in np.argsort(bounds):
            known = self.report.min_distance["value"] if self.report.min_distance else np.inf
            if bounds[pair] >= known:
                return
            one, other = self._shapes_of(pair)
            seen.moved[pair] = moved[pair]
            wanted = max(known, 0.0) * 1.5 + MEASURING_SLACK
            if np.isfinite(known) and self.exact.farther_than(placed, one, other, wanted):
                seen.at_least[pair] = wanted - COAL_ACCURACY
                continue
            distance = self.exact.distance(placed, one, other)
            seen.at_least[pair] = distance - COAL_ACCURACY
            self.report.see_distance(motion.segment.index, parameter, self._pair_name(pair), distance)

    def _pair_name(self, pair: int) -> str:
        one, other = self.shapes[self.pairs.first[pair]], self.shapes[self.pairs.second[pair]]
        return f"{one.link} - {other.link}"


@dataclass(frozen=True)
class _Seen:
    """For each pair a lower bound of its distance, and how far it had moved by then."""

    at_least: np.ndarray
    moved: np.ndarray


class _Clock:
    """A segment's parameter re-read so that halving it halves the movement: `u` in [0, 1], shared by all pairs."""

    def __init__(self, travel: np.ndarray, pair_reach: np.ndarray):
        self.active = np.flatnonzero(travel[-1] > 0.0)
        self.travel, self.pair_reach = travel[:, self.active], pair_reach[self.active]
        weight = self.travel @ self.pair_reach.max(axis=1, initial=0.0)
        even = np.linspace(0.0, 1.0, len(travel)) if len(travel) > 1 else np.zeros(1)
        # a little of the even clock keeps knots apart where nothing moves
        self.times = 0.999 * weight / weight[-1] + 0.001 * even if len(self.active) and weight[-1] > 0.0 else even

    def parameters(self, times) -> np.ndarray:
        return np.interp(times, self.times, np.arange(len(self.times), dtype=float))

    def travel_between(self, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Travel (N, active freedoms) between clock times."""
        columns = [
            np.interp(end, self.times, column) - np.interp(start, self.times, column) for column in self.travel.T
        ]
        return np.stack(columns, 1) if columns else np.zeros((len(start), 0))

    def movement(self, travel: np.ndarray, samples: np.ndarray, pairs: np.ndarray) -> np.ndarray:
        """Bound on the relative movement of (sample, pair) entries."""
        total = np.zeros(len(pairs))
        for freedom in range(travel.shape[1]):
            total += travel[samples, freedom] * self.pair_reach[freedom, pairs]
        return total


def _chunks(entries: tuple[np.ndarray, np.ndarray]):
    """Entries (sorted by interval) in groups of at most CHUNK intervals."""
    intervals, pairs = entries
    _, starts = np.unique(intervals, return_index=True)
    cuts = list(starts[::CHUNK]) + [len(intervals)]
    for start, end in zip(cuts, cuts[1:]):
        yield intervals[start:end], pairs[start:end]


class Placed:
    """All shapes at one sample, as coal wants their poses."""

    def __init__(self, poses: Poses):
        self.poses = poses
        self._transforms: dict[int, coal.Transform3s] = {}

    def transform(self, shape: int) -> coal.Transform3s:
        known = self._transforms.get(shape)
        if known is None:
            known = coal.Transform3s(self.poses.rotation[shape], self.poses.translation[shape])
            self._transforms[shape] = known
        return known

    def transform_of_box(self, shape: int, what: Shape) -> coal.Transform3s:
        """Where the local box of a mesh is; any other shape is where it is."""
        if not what.is_mesh:
            return self.transform(shape)
        center = self.poses.rotation[shape] @ what.center + self.poses.translation[shape]
        return coal.Transform3s(self.poses.rotation[shape], center)


class ExactQueries:
    """coal's answers for pairs of shapes."""

    def __init__(self, shapes: list[SceneShape], report: Report):
        self.shapes, self.report = shapes, report
        self.geometries = [shape.shape.geometry for shape in shapes]
        self.meshes = [shape.shape.is_mesh for shape in shapes]
        self.distance_request, self.distance_result = coal.DistanceRequest(), coal.DistanceResult()
        self.collision_request, self.collision_result = coal.CollisionRequest(), coal.CollisionResult()
        self.boxes = [
            coal.Box(2.0 * shape.shape.half_extents) if shape.shape.is_mesh else shape.shape.geometry
            for shape in shapes
        ]
        self.margin_request = coal.CollisionRequest()
        self._closed: dict[int, np.ndarray | None] = {}

    def distance(self, placed: Placed, one: int, other: int) -> float:
        """Signed distance (m); for two meshes in collision coal says zero or less."""
        self.report.count("distance_queries")
        self.distance_result.clear()
        return coal.distance(
            self.geometries[one], placed.transform(one), self.geometries[other], placed.transform(other),
            self.distance_request, self.distance_result,
        )

    def box_distance(self, placed: Placed, one: int, other: int) -> float:
        """A lower bound of the distance: meshes stand in their local boxes."""
        self.report.count("distance_queries")
        self.distance_result.clear()
        return coal.distance(
            self.boxes[one], placed.transform_of_box(one, self.shapes[one].shape), self.boxes[other],
            placed.transform_of_box(other, self.shapes[other].shape), self.distance_request, self.distance_result,
        )

    def collide(self, placed: Placed, one: int, other: int) -> bool:
        return self._collide(placed, one, other, self.collision_request)

    def surely_farther_than(self, placed: Placed, one: int, other: int, wanted: float, threshold: float) -> bool:
        """Whether the distance is known to be more than `wanted`. Where that would take long (meshes and `MESH_MARGIN`
        more than the threshold), only their boxes are asked: no is then no answer."""
        meshes = self.meshes[one] or self.meshes[other]
        if meshes and wanted > threshold + MESH_MARGIN:
            return self.box_distance(placed, one, other) > wanted
        return self.farther_than(placed, one, other, wanted)

    def farther_than(self, placed: Placed, one: int, other: int, wanted: float) -> bool:
        """Whether the distance is more than `wanted`. For meshes coal is asked for a collision within a margin,
        which for small margins it decides much faster than a distance."""
        if not (self.meshes[one] or self.meshes[other]):
            return self.distance(placed, one, other) > wanted
        if self.box_distance(placed, one, other) > wanted:
            return True
        self.margin_request.security_margin = wanted
        return not self._collide(placed, one, other, self.margin_request)

    def _collide(self, placed: Placed, one: int, other: int, request: coal.CollisionRequest) -> bool:
        self.report.count("collision_queries")
        self.collision_result.clear()
        return bool(
            coal.collide(
                self.geometries[one], placed.transform(one), self.geometries[other], placed.transform(other),
                request, self.collision_result,
            )
        )

    def encloses(self, mesh: int, inner: int, poses: Poses) -> bool:
        """Whether one point of a shape lies inside a closed mesh."""
        point = poses[inner].apply(self._some_point(inner))
        local = poses[mesh].inverse().apply(point)
        shape = self.shapes[mesh].shape
        if (np.abs(local - shape.center) > shape.half_extents).any():
            return False
        triangles = self._closed_triangles(mesh)
        return triangles is not None and abs(winding_number(local, triangles)) > 0.5

    def _some_point(self, index: int) -> np.ndarray:
        shape = self.shapes[index].shape
        return np.array(shape.geometry.vertex(0)).ravel() if shape.is_mesh else shape.center

    def _closed_triangles(self, index: int) -> np.ndarray | None:
        if index not in self._closed:
            triangles = mesh_triangles(self.geometries[index])
            self._closed[index] = triangles if is_closed(triangles) else None
        return self._closed[index]


def mesh_triangles(mesh: coal.BVHModelBase) -> np.ndarray:
    """Corners (triangles, 3, 3) of a mesh."""
    vertices = np.array(mesh.vertices())
    triangles = [mesh.tri_indices(index) for index in range(mesh.num_tris)]
    indices = np.array([[triangle[0], triangle[1], triangle[2]] for triangle in triangles], dtype=int)
    return vertices[indices]


def is_closed(triangles: np.ndarray) -> bool:
    """Whether every edge borders exactly two triangles once equal corners are merged."""
    _, corners = np.unique(np.round(triangles.reshape(-1, 3), 7), axis=0, return_inverse=True)
    corners = corners.reshape(-1, 3)
    corners = corners[(corners != np.roll(corners, 1, axis=1)).all(axis=1)]
    edges = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
    _, counts = np.unique(edges, axis=0, return_counts=True)
    return bool(len(counts)) and bool((counts == 2).all())


def winding_number(point: np.ndarray, triangles: np.ndarray) -> float:
    """How often a mesh winds round a point: the sum of the solid angles of its triangles / 4 pi
    (A. Van Oosterom, J. Strackee, The solid angle of a plane triangle, IEEE Trans. Biomed. Eng. 30, 1983)."""
    a, b, c = np.moveaxis(triangles - point, 1, 0)
    la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    triple = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = [np.einsum("ij,ij->i", one, other) for one, other in ((a, b), (a, c), (b, c))]
    solid = 2.0 * np.arctan2(triple, la * lb * lc + dots[0] * lc + dots[1] * lb + dots[2] * la)
    return float(solid.sum() / (4.0 * np.pi))
