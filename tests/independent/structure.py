"""Checks that need no geometry: limits, quaternions, shared knots, times, and documents against the SRDF."""

from __future__ import annotations

import numpy as np

from curve import Curve
from faces import are_joined
from parts import read_srdf_documents
from path_file import PathFile, Segment
from report import Report
from scene import Member, Scene

LIMIT_SLACK = 1e-9
"""Rounding allowed beyond a limit (rad, m)."""
UNIT_SLACK = 1e-9
"""How far a quaternion's norm may be from one."""
SHORTEST = 0.5
"""What the length of a quaternion's numbers is at least between knots, before they are scaled."""
DOCUMENT_SLACK = 1e-6
"""How far a gripper, handle or contact point may be from the SRDF's (m, and quaternion entries)."""


def check_structure(scene: Scene, report: Report) -> None:
    path = scene.path
    _check_certificate(path, report)
    _note_urdf_limits(scene, report)
    for member in scene.members:
        _check_documents(scene, member, report)
    for segment in path.segments:
        _check_quaternions(scene, segment, report)
        _check_limits(scene, segment, report)
        _check_followers(scene, segment, report)
        _check_environment(scene, segment, report)
        _check_times(segment, report)
    for before, after in zip(path.segments, path.segments[1:]):
        _check_shared_knot(path, before, after, report)


def _check_certificate(path: PathFile, report: Report) -> None:
    if "path_tolerance" not in path.certificate:
        report.note(f"no certificate.path_tolerance: {path.path_tolerance} taken")
    if not 0.0 < path.path_tolerance <= 1e-3:
        report.violate(None, None, "path-tolerance", "certificate.path_tolerance", path.path_tolerance, 1e-3)
    if path.certificate.get("joint_limits", "within") != "within":
        report.note(f"certificate.joint_limits is {path.certificate['joint_limits']!r}")


def _check_quaternions(scene: Scene, segment: Segment, report: Report) -> None:
    for member in scene.members:
        if len(member.root_columns) != 7:
            continue
        quaternions = segment.knots[:, member.root_columns[3:]]
        for knot, norm in enumerate(np.linalg.norm(quaternions, axis=1)):
            if abs(norm - 1.0) > UNIT_SLACK:
                report.violate(segment.index, knot, "quaternion-norm", member.name, norm, 1.0)
        if segment.velocities is not None:
            least, _ = _curve(segment).norm_bounds(member.root_columns[3:])
            for knot in np.flatnonzero(~(least >= SHORTEST)):
                subject = f"{member.name} between knots, before it is scaled"
                report.violate(segment.index, knot, "quaternion-norm", subject, least[knot], SHORTEST)
        for knot, dot in enumerate(np.einsum("ij,ij->i", quaternions[:-1], quaternions[1:])):
            if dot < 0.0:
                report.violate(segment.index, knot, "quaternion-sign", member.name, dot, 0.0)


def _check_limits(scene: Scene, segment: Segment, report: Report) -> None:
    """Joints and robots' roots along the whole motion, by their extremes between knots; of quaternions on the geodesic, or,
    where there are velocities, in fine samples. Floating objects only where they rest."""
    ranges = _curve(segment).ranges()
    for member in scene.members:
        for column in member.joint_columns.values():
            _check_range(scene, segment, column, ranges, report)
        if member.floats:
            for column in member.root_columns:
                _check_column(scene, segment, column, _resting_knots(segment, member), "object-bounds", report)
            continue
        linear, turning = (member.root_columns[:3], member.root_columns[3:])
        for column in linear:
            _check_range(scene, segment, column, ranges, report)
        if turning:
            _check_turning(scene, segment, turning, report)


def _resting_knots(segment: Segment, member: Member) -> list[int]:
    """Knots that begin or end a segment in which the object rests: placed, or attached to nothing."""
    mine = [item for item in segment.attachments if item.object.partition("/")[0] == member.name]
    rests = not mine or any(not item.is_grasp for item in mine)
    return [0, len(segment.knots) - 1] if rests else []


def _limits(scene: Scene, name: str) -> tuple[float, float]:
    """The file's limits of a coordinate; where it gives none, the URDF's; for roots, none."""
    if name in scene.path.limits:
        return scene.path.limits[name]
    part, _, joint = name.partition("/")
    known = scene.by_name[part].part.joint_by_name.get(joint)
    return (known.low, known.high) if known else (-np.inf, np.inf)


def _curve(segment: Segment) -> Curve:
    return Curve(segment.knots, segment.times, segment.velocities)


def _check_range(scene: Scene, segment: Segment, column: int, ranges, report: Report) -> None:
    """The extremes of a column in all intervals."""
    name = scene.path.coordinates[column]
    low, high = _limits(scene, name)
    for rows in ranges:
        values = rows[:, column]
        for knot in np.flatnonzero((values < low - LIMIT_SLACK) | (values > high + LIMIT_SLACK)):
            _check_value(segment.index, knot, "limit", name, values[knot], low, high, report)


def _check_column(scene: Scene, segment: Segment, column: int, knots, kind: str, report: Report) -> None:
    name = scene.path.coordinates[column]
    low, high = _limits(scene, name)
    for knot in knots:
        _check_value(segment.index, knot, kind, name, segment.knots[knot, column], low, high, report)


def _check_value(segment: int, t: float, kind: str, name: str, value: float, low, high, report: Report) -> None:
    if value < low - LIMIT_SLACK:
        report.violate(segment, t, kind, f"{name} below", value, low)
    if value > high + LIMIT_SLACK:
        report.violate(segment, t, kind, f"{name} above", value, high)


def _check_turning(scene: Scene, segment: Segment, columns: list[int], report: Report) -> None:
    if segment.velocities is not None:
        parameters = np.arange(max(len(segment.knots) - 1, 1) * 64) / 64.0
        low = parameters.astype(int)
        numbers = _curve(segment).rows(low, parameters - low)[:, columns]
        numbers /= np.linalg.norm(numbers, axis=1, keepdims=True)
        for column, values in zip(columns, numbers.T):
            name = scene.path.coordinates[column]
            for value in (values.min(), values.max()):
                _check_value(segment.index, 0, "limit", name, value, *_limits(scene, name), report)
        return
    for knot in range(len(segment.knots)):
        first = segment.knots[knot, columns]
        second = segment.knots[min(knot + 1, len(segment.knots) - 1), columns]
        for column, low_end, high_end in zip(columns, *_geodesic_extremes(first, second)):
            name = scene.path.coordinates[column]
            low, high = _limits(scene, name)
            _check_value(segment.index, knot, "limit", name, low_end, low, high, report)
            _check_value(segment.index, knot, "limit", name, high_end, low, high, report)


def _geodesic_extremes(first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smallest and largest value of each quaternion entry between two unit quaternions: entries are
    a cos(angle) + b sin(angle) along the arc."""
    across = second - np.dot(first, second) * first
    length = np.linalg.norm(across)
    ends = np.stack([first, second])
    if length < 1e-12:
        return ends.min(axis=0), ends.max(axis=0)
    across = across / length
    arc = np.arctan2(length, np.dot(first, second))
    crest = np.arctan2(across, first)
    amplitude = np.hypot(first, across)
    top = np.where((crest > 0.0) & (crest < arc), amplitude, ends.max(axis=0))
    trough = np.where(crest <= 0.0, crest + np.pi, crest - np.pi)
    bottom = np.where((trough > 0.0) & (trough < arc), -amplitude, ends.min(axis=0))
    return bottom, top


def _check_followers(scene: Scene, segment: Segment, report: Report) -> None:
    """Joints that follow a leader obey the URDF's limits too."""
    for member in scene.members:
        if not member.part.followers:
            continue
        joints = {joint.index: joint for joint in member.part.joints}
        for values in map(member.joint_values, _curve(segment).ranges()):
            for follower in member.part.followers:
                joint, name = joints[follower.joint], f"{member.name}/{joints[follower.joint].name}"
                for knot, value in enumerate(values[:, follower.joint]):
                    _check_value(segment.index, knot, "follower-limit", name, value, joint.low, joint.high, report)


def _check_environment(scene: Scene, segment: Segment, report: Report) -> None:
    first = scene.path.segments[0].knots[0]
    for member in scene.members:
        if member.entry.kind == "environment":
            for column in member.joint_columns.values():
                moved = float(np.abs(segment.knots[:, column] - first[column]).max())
                if segment.velocities is not None:
                    moved = max(moved, float(np.abs(segment.velocities[:, column]).max()))
                if moved > 0.0:
                    report.violate(segment.index, None, "environment-moves", scene.path.coordinates[column], moved, 0.0)


def _check_times(segment: Segment, report: Report) -> None:
    if segment.times is None:
        return
    for knot, step in enumerate(np.diff(segment.times)):
        if step < 0.0:
            report.violate(segment.index, knot, "times", "time runs backwards", step, 0.0)


def _check_shared_knot(path: PathFile, before: Segment, after: Segment, report: Report) -> None:
    """Bit for bit: zeros of different sign differ."""
    last, first = before.knots[-1], after.knots[0]
    for column, name in enumerate(path.coordinates):
        if last[column].tobytes() != first[column].tobytes():
            report.violate(after.index, 0, "shared-knot", name, first[column] - last[column], 0.0)


def _note_urdf_limits(scene: Scene, report: Report) -> None:
    path = scene.path
    for member in scene.members:
        for joint in member.part.free_joints():
            name = f"{member.name}/{joint.name}"
            if name not in scene.columns:
                continue
            if name not in path.limits:
                if not joint.continuous:
                    report.note(f"no limits of {name}: the URDF's [{joint.low:g}, {joint.high:g}] taken")
                continue
            low, high = path.limits[name]
            if abs(low - joint.low) > LIMIT_SLACK or abs(high - joint.high) > LIMIT_SLACK:
                report.note(f"limits of {name} are [{low:g}, {high:g}], the URDF says [{joint.low:g}, {joint.high:g}]")


def _check_documents(scene: Scene, member: Member, report: Report) -> None:
    """Grippers, handles and surfaces of the file against the part's SRDF."""
    path, prefix = scene.path, member.name + "/"
    named = [name for table in (path.grippers, path.handles, path.surfaces) for name in table if _owned(name, prefix)]
    if member.srdf is None:
        if named:
            report.note(f"{member.name} names no SRDF: {', '.join(named)} come from the scene")
        return
    srdf = read_srdf_documents(member.srdf)
    for name, gripper in path.grippers.items():
        if _owned(name, prefix):
            known = srdf.grippers.get(name.removeprefix(prefix))
            _compare(name, gripper.link, gripper.link_from_gripper, known, prefix, report)
    for name, handle in path.handles.items():
        if _owned(name, prefix):
            known = srdf.handles.get(name.removeprefix(prefix))
            _compare(name, handle.link, handle.link_from_handle, known, prefix, report)
            if known and (known[2], known[3]) != (handle.mask, handle.mask_complement):
                report.note(f"masks of {name} are not the SRDF's: the scene overrides them")
    for name, surface in path.surfaces.items():
        if _owned(name, prefix):
            _compare_surface(name, surface, srdf.surfaces.get(name.removeprefix(prefix)), prefix, report)


def _owned(name: str, prefix: str) -> bool:
    return name.startswith(prefix)


def _compare(name: str, link: str, pose: np.ndarray, known, prefix: str, report: Report) -> None:
    if known is None:
        report.note(f"{name} is not in the SRDF: it comes from the scene")
        return
    if link != prefix + known[0]:
        report.violate(None, None, "document", f"{name} is on {link}, in the SRDF on {prefix + known[0]}")
    sign = 1.0 if np.dot(pose[3:], known[1][3:]) >= 0.0 else -1.0
    difference = max(np.abs(pose[:3] - known[1][:3]).max(), np.abs(sign * pose[3:] - known[1][3:]).max())
    if difference > DOCUMENT_SLACK:
        report.violate(None, None, "document", f"pose of {name} is not the SRDF's", difference, DOCUMENT_SLACK)


def _compare_surface(name: str, surface, known, prefix: str, report: Report) -> None:
    if known is None:
        report.note(f"{name} is not in the SRDF: it comes from the scene")
        return
    link, points, polygons = known
    if surface.link != prefix + link:
        report.violate(None, None, "document", f"{name} is on {surface.link}, in the SRDF on {prefix + link}")
    ours = [surface.points[polygon] for polygon in surface.polygons]
    theirs = [points[polygon] for polygon in polygons]
    shapes = [[len(polygon) for polygon in polygons] for polygons in (ours, theirs)]
    if shapes[0] != shapes[1] and are_joined(ours, theirs):
        return
    if shapes[0] != shapes[1]:
        report.violate(None, None, "document", f"polygons of {name} are not the SRDF's")
        return
    difference = max((np.abs(a - b).max() for a, b in zip(ours, theirs)), default=0.0)
    if difference > DOCUMENT_SLACK:
        report.violate(None, None, "document", f"polygons of {name} are not the SRDF's", difference, DOCUMENT_SLACK)
