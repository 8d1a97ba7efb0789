"""Errors of what a segment lists besides its attachments: poses of any two frames, centres of mass, distances, tilts, regions, joints.

Errors of relative poses are told in R3 x SO3: translation (m) and rotation (rad) apart. Rotations are never measured
by single rows of a large logarithm: with all three rows fixed by the angle, with one rotation free by the angle
between the free axis and where it should be.
"""

from __future__ import annotations

import numpy as np

from motion import SegmentMotion
from packages import InputError
from path_file import Constraint, Frame
from report import Report
from rigid import Poses, angle_between, log_rotation, rotation_angle


def constraint_errors(
    motion: SegmentMotion, constraint: Constraint, parameters: np.ndarray, worlds: Poses, report: Report
) -> tuple[float, dict[str, np.ndarray]]:
    """The tolerance of a constraint and its errors (N,) by name. What cannot be judged here is reported."""
    path = motion.scene.path
    tolerance = path.path_tolerance if constraint.tolerance is None else constraint.tolerance
    if tolerance > path.path_tolerance:
        report.note(f"{constraint}: its tolerance {tolerance:g} exceeds the path tolerance")
    errors = {
        "pose": _pose_errors, "relative_pose": _pose_errors, "position": _pose_errors, "orientation": _pose_errors,
        "centre_of_mass": _centre_errors, "center_of_mass": _centre_errors, "centre_of_mass_between": _between_errors,
        "distance": _distance_errors, "tilt": _tilt_errors, "region": _region_errors, "joint": _joint_errors,
    }.get(constraint.kind)
    rotations, sided = sum(constraint.mask[3:]), any(constraint.inequality[3:])
    why = None
    if constraint.kind == "custom":
        why = "a function of the program's own, not proved here"
    elif errors is None:
        why = "this checker knows no such kind"
    elif errors is _pose_errors and (rotations == 1 or sided):
        why = "one rotation alone, or one that must not be negative, is not measured"
    if why:
        report.violate(motion.segment.index, None, "unchecked-constraint", f"{constraint}: {why}")
        return tolerance, {}
    return tolerance, errors(motion, constraint, parameters, worlds)


def _refuse(motion: SegmentMotion, constraint: Constraint, message: str):
    raise InputError(f"{motion.scene.path.file}: segment {motion.segment.index}: {constraint}: {message}")


def _frame(motion: SegmentMotion, constraint: Constraint, frame: Frame | None, worlds: Poses) -> Poses:
    """World poses (N,) of a frame that must be given."""
    if frame is None:
        _refuse(motion, constraint, "a frame is missing")
    poses = motion.frame_poses(worlds, frame.name)
    return poses if frame.pose is None else poses @ Poses.from_array(frame.pose)


# Poses


def _pose_errors(motion: SegmentMotion, constraint: Constraint, _, worlds: Poses) -> dict[str, np.ndarray]:
    to = _frame(motion, constraint, constraint.to or Frame("world"), worlds)
    relative = to.inverse() @ _frame(motion, constraint, constraint.frame, worlds)
    return _row_errors(relative, constraint)


def _row_errors(relative: Poses, constraint: Constraint) -> dict[str, np.ndarray]:
    """Masked rows against the value, or the first sample; zero, or not negative."""
    value = relative[0] if constraint.value is None else Poses.from_array(constraint.value)
    off = value.inverse() @ relative
    zero = [counts and not sided for counts, sided in zip(constraint.mask, constraint.inequality)]
    errors = zero_errors(off, zero)
    if any(constraint.inequality):
        depth = -off.translation[:, constraint.inequality[:3]]
        errors["negative"] = np.maximum(depth, 0.0).max(axis=1)
    return errors


def zero_errors(relative: Poses, mask: list[bool]) -> dict[str, np.ndarray]:
    """Distance (N,) of the masked rows from zero."""
    errors = {}
    if any(mask[:3]):
        errors["translation"] = np.linalg.norm(relative.translation[:, mask[:3]], axis=-1)
    if any(mask[3:]):
        errors["rotation"] = _rotation_error(relative.rotation, np.eye(3), mask[3:])
    return errors


def frozen_errors(relative: Poses, mask: list[bool], complement: list[bool]) -> dict[str, np.ndarray]:
    """Change (N,) of the rows of the complement since the first sample."""
    errors = {}
    if any(complement[:3]):
        change = relative.translation - relative.translation[0]
        errors["translation"] = np.linalg.norm(change[:, complement[:3]], axis=-1)
    if any(complement[3:]):
        rows = [fixed or frozen for fixed, frozen in zip(mask[3:], complement[3:])]
        errors["rotation"] = _rotation_error(relative.rotation, relative.rotation[0], rows)
    return errors


def _rotation_error(rotation: np.ndarray, reference: np.ndarray, rows: list[bool]) -> np.ndarray:
    """Angle (N,) by which the rows that count differ from the reference."""
    if all(rows):
        return rotation_angle(reference.T @ rotation)
    if sum(rows) == 2:
        free = rows.index(False)
        return angle_between(rotation[:, :, free], reference[:, free])
    row = rows.index(True)
    return np.abs(log_rotation(reference.T @ rotation)[:, row])


# Centres of mass


def _centre(motion: SegmentMotion, constraint: Constraint, parameters: np.ndarray, worlds: Poses) -> np.ndarray:
    """The common centre of mass (N, 3) of some parts in the world; pinocchio's within each part."""
    names = constraint.parts or [constraint.frame.name.partition("/")[0] if constraint.frame else ""]
    total, moment = 0.0, np.zeros((len(parameters), 3))
    for name in names:
        member = motion.scene.by_name.get(name)
        if member is None:
            _refuse(motion, constraint, f"centre of mass: there is no part {name!r}")
        mass = member.part.mass
        if mass > 0.0:
            in_root = member.part.centre_of_mass(motion.joint_values(member, parameters))
            moment = moment + mass * worlds[:, member.first_body].apply(in_root)
            total += mass
    if not total > 0.0:
        _refuse(motion, constraint, "no mass, so no centre of mass")
    return moment / total


def _centre_errors(motion: SegmentMotion, constraint: Constraint, parameters, worlds: Poses) -> dict[str, np.ndarray]:
    to = _frame(motion, constraint, constraint.to or Frame("world"), worlds)
    centre = to.inverse().apply(_centre(motion, constraint, parameters, worlds))
    errors = _row_errors(Poses(np.broadcast_to(np.eye(3), (len(centre), 3, 3)), centre), constraint)
    for number, plane in enumerate(constraint.planes):
        off = centre @ plane.normal - plane.offset
        errors[f"plane {number}"] = np.maximum(-off, 0.0) if plane.inequality else np.abs(off)
    return errors


def _between_errors(motion: SegmentMotion, constraint: Constraint, parameters, worlds: Poses) -> dict[str, np.ndarray]:
    """Over the line between two feet as seen from above, between them, at a height over their middle."""
    centre = _centre(motion, constraint, parameters, worlds)
    first = _frame(motion, constraint, constraint.frame, worlds).translation
    second = _frame(motion, constraint, constraint.to, worlds).translation
    line = (second - first)[:, :2]
    length = np.linalg.norm(line, axis=1)
    along = line / np.where(length > 0.0, length, np.nan)[:, None]
    arm = (centre - first)[:, :2]
    reached = np.einsum("ni,ni->n", arm, along)
    errors = {
        "beside the line between the feet": np.abs(arm[:, 0] * along[:, 1] - arm[:, 1] * along[:, 0]),
        "beyond the first foot": np.maximum(-reached, 0.0),
        "beyond the second foot": np.maximum(reached - length, 0.0),
    }
    if constraint.height is not None:
        above = centre[:, 2] - (first[:, 2] + second[:, 2]) / 2.0
        errors["not at its height"] = np.abs(above - constraint.height)
    return {what: np.where(np.isnan(error), np.inf, error) for what, error in errors.items()}


# Distances, tilts, regions and joints


def _distance_errors(motion: SegmentMotion, constraint: Constraint, _, worlds: Poses) -> dict[str, np.ndarray]:
    apart = _frame(motion, constraint, constraint.frame, worlds).translation
    apart = np.linalg.norm(apart - _frame(motion, constraint, constraint.to, worlds).translation, axis=1)
    over = apart - (apart[0] if constraint.length is None else constraint.length)
    return {"length": {"equal": np.abs(over), "at_least": np.maximum(-over, 0.0),
                       "at_most": np.maximum(over, 0.0)}[constraint.bound]}


def _tilt_errors(motion: SegmentMotion, constraint: Constraint, _, worlds: Poses) -> dict[str, np.ndarray]:
    """The angle between the z axes of two frames."""
    if constraint.within is None:
        _refuse(motion, constraint, "the angle is missing")
    axes = [_frame(motion, constraint, frame, worlds).rotation[:, :, 2] for frame in (constraint.to, constraint.frame)]
    return {"tilt": np.maximum(angle_between(*axes) - constraint.within, 0.0)}


def _region_errors(motion: SegmentMotion, constraint: Constraint, _, worlds: Poses) -> dict[str, np.ndarray]:
    if not constraint.planes:
        _refuse(motion, constraint, "the planes are missing")
    to = _frame(motion, constraint, constraint.to, worlds)
    point = to.inverse().apply(_frame(motion, constraint, constraint.frame, worlds).translation)
    off = [point @ plane.normal - plane.offset for plane in constraint.planes]
    return {f"plane {number}": np.maximum(-off, 0.0) if plane.inequality else np.abs(off)
            for number, (plane, off) in enumerate(zip(constraint.planes, off))}


def _joint_errors(motion: SegmentMotion, constraint: Constraint, parameters, _) -> dict[str, np.ndarray]:
    part, _, name = (constraint.joint or "").partition("/")
    member = motion.scene.by_name.get(part)
    joint = member.part.joint_by_name.get(name) if member else None
    if joint is None:
        _refuse(motion, constraint, f"there is no joint {constraint.joint!r} of one coordinate")
    values = motion.joint_values(member, parameters)[:, joint.index]
    return {"position": np.abs(values - (values[0] if constraint.position is None else constraint.position))}
