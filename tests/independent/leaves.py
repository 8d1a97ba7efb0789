"""Whether a segment stays on its leaf: carried objects where their carriers take them, grasps and placements as they
should be and unchanging, further constraints held.

Errors of relative poses are told in R3 x SO3: translation (m) and rotation (rad) apart. Rotations are never measured
by single rows of a large logarithm: with all three rows fixed by the angle, with one rotation free by the angle
between the free axis and where it should be.
"""

from __future__ import annotations

import numpy as np

from motion import SegmentMotion, attachment_links
from packages import InputError
from path_file import Attachment, Constraint, Surface
from report import Report
from rigid import Poses, angle_between, log_rotation, rotation_angle
from scene import Member

CARRIER_TOLERANCE = 1e-5
"""How far (m, rad) a written object pose may be from where its carrier takes it."""
SAMPLE_TRAVEL = 5e-3
"""Between two samples of the residual no degree of freedom travels more than this (m, rad)..."""
SAMPLES_PER_INTERVAL = (4, 200)
"""...with at least and at most so many samples per knot interval."""


def check_leaf(motion: SegmentMotion, report: Report) -> None:
    """All checks of one segment against its state."""
    _check_carriers(motion, report)
    segment = motion.segment
    if not segment.attachments and not segment.constraints:
        return
    parameters = _sample_parameters(motion)
    report.count("residual_samples", len(parameters))
    worlds = motion.body_poses(parameters)
    for attachment in segment.attachments:
        _note_idle_carrier(motion, attachment, report)
        check = _check_grasp if attachment.is_grasp else _check_placement
        check(motion, attachment, parameters, worlds, report)
    for constraint in segment.constraints:
        _check_constraint(motion, constraint, parameters, worlds, report)


def _sample_parameters(motion: SegmentMotion) -> np.ndarray:
    """Knots, and points between them where a residual could swell."""
    travel = np.diff(motion.cumulative_travel(), axis=0).max(axis=1, initial=0.0)
    counts = np.clip(np.ceil(travel / SAMPLE_TRAVEL), *SAMPLES_PER_INTERVAL).astype(int)
    pieces = [knot + np.arange(count) / count for knot, count in enumerate(counts)]
    return np.concatenate(pieces + [[float(motion.last)]])


def _judge(motion, parameters, kind: str, subject: str, errors: dict, tolerance: float, report: Report) -> None:
    """Report every error (N,) that exceeds the tolerance, and remember the largest."""
    for what, error in errors.items():
        worst = int(np.argmax(error))
        report.see_residual(motion.segment.index, parameters[worst], f"{subject}: {what}", error[worst])
        for sample in np.flatnonzero(error > tolerance):
            report.violate(motion.segment.index, parameters[sample], kind, f"{subject}: {what}", error[sample],
                           tolerance)


# Carriers


def _check_carriers(motion: SegmentMotion, report: Report) -> None:
    """Written poses of floating objects at every knot against the motion that the contract gives them."""
    for carry in motion.carries:
        if carry.by is None:
            report.note(f"{carry.member.name} hangs on nothing in some segments: it must rest there")
    knots = np.arange(motion.last + 1)
    if len(knots) == 1:
        return
    tolerance = min(CARRIER_TOLERANCE, motion.scene.path.path_tolerance)
    written, carried = motion.written_body_poses(knots), motion.body_poses(knots.astype(float))
    for carry in motion.carries:
        body = carry.member.first_body
        shift = np.linalg.norm(written.translation[:, body] - carried.translation[:, body], axis=-1)
        turn = rotation_angle(np.swapaxes(carried.rotation[:, body], -1, -2) @ written.rotation[:, body])
        kind = "placed-object-moved" if carry.by and not carry.by.is_grasp else "object-off-carrier"
        kind = "unattached-object-moved" if carry.by is None else kind
        for knot in knots:
            for what, error in (("position", shift[knot]), ("orientation", turn[knot])):
                if error > tolerance:
                    subject = f"{carry.member.name} ({carry.by or 'no carrier'}): {what}"
                    report.violate(motion.segment.index, knot, kind, subject, error, tolerance)


def _note_idle_carrier(motion: SegmentMotion, attachment: Attachment, report: Report) -> None:
    member = motion.scene.by_name.get(attachment.object.partition("/")[0])
    if attachment.carrier and member and not member.floats:
        report.note(f"{attachment} carries {attachment.object}, which has no free-flying root: checked, not followed")


# Grasps and constraints


def _check_grasp(motion: SegmentMotion, attachment: Attachment, parameters, worlds: Poses, report: Report) -> None:
    attachment_links(motion.scene, attachment)
    _require_owner(motion, attachment.object, motion.scene.path.handles[attachment.handle].link, attachment.handle)
    handle = motion.scene.path.handles[attachment.handle]
    gripper = motion.frame_poses(worlds, attachment.gripper)
    relative = gripper.inverse() @ motion.frame_poses(worlds, attachment.handle)
    tolerance, subject = motion.scene.path.path_tolerance, str(attachment)
    _judge(motion, parameters, "grasp", subject, zero_errors(relative, handle.mask), tolerance, report)
    frozen = frozen_errors(relative, handle.mask, handle.mask_complement)
    _judge(motion, parameters, "grasp-constancy", subject, frozen, tolerance, report)


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


def _check_constraint(motion: SegmentMotion, constraint: Constraint, parameters, worlds, report: Report) -> None:
    subject = f"{constraint.kind} of {constraint.frame} in {constraint.to}"
    tolerance = motion.scene.path.path_tolerance if constraint.tolerance is None else constraint.tolerance
    if tolerance > motion.scene.path.path_tolerance:
        report.note(f"{subject}: its tolerance {tolerance:g} exceeds the path tolerance")
    mask = _full_mask(constraint)
    if constraint.kind in ("pose", "position", "orientation", "relative_pose"):
        to = motion.frame_poses(worlds, constraint.to)
        relative = to.inverse() @ motion.frame_poses(worlds, constraint.frame)
    elif constraint.kind in ("centre_of_mass", "center_of_mass"):
        relative = _centre_of_mass(motion, constraint, parameters, worlds)
    else:
        subject = f"{subject}: this checker knows no such kind"
        report.violate(motion.segment.index, None, "unchecked-constraint", subject)
        return
    value = relative[0] if constraint.value is None else Poses.from_array(constraint.value)
    errors = zero_errors(value.inverse() @ relative, mask)
    _judge(motion, parameters, "constraint", subject, errors, tolerance, report)


def _full_mask(constraint: Constraint) -> list[bool]:
    """Six rows; a mask of three belongs to the constraint's only kind of rows."""
    mask = constraint.mask
    if len(mask) == 6:
        mask = list(mask)
        if constraint.kind == "position" or constraint.kind.endswith("of_mass"):
            mask[3:] = [False] * 3
        if constraint.kind == "orientation":
            mask[:3] = [False] * 3
        return mask
    return [False] * 3 + list(mask) if constraint.kind == "orientation" else list(mask) + [False] * 3


def _centre_of_mass(motion: SegmentMotion, constraint: Constraint, parameters, worlds: Poses) -> Poses:
    """The part's centre of mass as a frame without rotation in `to`."""
    name = constraint.frame.partition("/")[0]
    member = motion.scene.by_name.get(name)
    if member is None:
        raise InputError(f"{motion.scene.path.file}: centre of mass of {constraint.frame!r}: there is no part {name!r}")
    in_root = member.part.centre_of_mass(motion.joint_values(member, parameters))
    in_world = worlds[:, member.first_body].apply(in_root)
    centre = motion.frame_poses(worlds, constraint.to).inverse().apply(in_world)
    return Poses(np.broadcast_to(np.eye(3), (len(centre), 3, 3)), centre)


# Placements


def _check_placement(motion: SegmentMotion, attachment: Attachment, parameters, worlds: Poses, report: Report) -> None:
    attachment_links(motion.scene, attachment)
    path = motion.scene.path
    surface, support = path.surfaces[attachment.surface], path.surfaces[attachment.support]
    _require_owner(motion, attachment.object, surface.link, attachment.surface)
    support_from_surface = (
        motion.frame_poses(worlds, support.link).inverse() @ motion.frame_poses(worlds, surface.link)
    )
    errors = placement_errors(support_from_surface, surface, support, path.placement_margin)
    _judge(motion, parameters, "placement", str(attachment), errors, path.path_tolerance, report)
    frozen = frozen_errors(support_from_surface, [False] * 6, [True] * 6)
    _judge(motion, parameters, "placement-constancy", str(attachment), frozen, path.path_tolerance, report)


def placement_errors(
    support_from_surface: Poses, surface: Surface, support: Surface, margin: float
) -> dict[str, np.ndarray]:
    """Errors (N,) of the best pair of polygons at the first sample: angle between the object's normal and the
    opposite of the support's, gap minus margin, and how far the object polygon's centre lies outside the support."""
    best = None
    for lower in _polygons(support):
        for upper in _polygons(surface):
            errors = _contact_errors(support_from_surface, upper, lower, margin)
            worst = sum(error[0] for error in errors.values())
            if best is None or worst < best[0]:
                best = (worst, errors)
    return best[1] if best else {"no polygon": np.array([np.inf])}


def _polygons(surface: Surface) -> list[np.ndarray]:
    return [surface.points[polygon] for polygon in surface.polygons]


def _contact_errors(support_from_surface: Poses, upper: np.ndarray, lower: np.ndarray, margin: float) -> dict:
    lower_normal, lower_centre = polygon_normal(lower), lower.mean(axis=0)
    centre = support_from_surface.apply(upper.mean(axis=0))
    normal = support_from_surface.rotation @ polygon_normal(upper)
    edges = np.roll(lower, -1, axis=0) - lower
    outward = np.cross(edges, lower_normal)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    outside = np.einsum("ej,nej->ne", outward, centre[:, None] - lower[None]).max(axis=1)
    return {
        "normals not opposite": angle_between(normal, -lower_normal),
        "gap is not the margin": np.abs((centre - lower_centre) @ lower_normal - margin),
        "centre outside the support": np.maximum(outside, 0.0),
    }


def polygon_normal(points: np.ndarray) -> np.ndarray:
    """Unit normal by the right-hand rule (sum over the edges, so any vertex may lie on a straight edge)."""
    normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    length = np.linalg.norm(normal)
    if length == 0.0:
        raise InputError("a polygon without area has no normal")
    return normal / length


def _require_owner(motion: SegmentMotion, name: str, link: str, what: str) -> Member:
    """The object must own the handle or surface that the attachment names."""
    owner, _, part_of = name.partition("/")
    if link.partition("/")[0] != owner or (part_of and link != name):
        where = f"{motion.scene.path.file}: segment {motion.segment.index}"
        raise InputError(f"{where}: {what} is on {link}, not on {name}")
    return motion.scene.by_name[owner]
