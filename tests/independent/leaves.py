"""Whether a segment stays on its leaf: carried objects where their carriers take them, grasps and placements as they
should be and unchanging, further constraints held, joints of objects at rest while no gripper holds them.
"""

from __future__ import annotations

import numpy as np

from constraints import constraint_errors, frozen_errors, zero_errors
from motion import SegmentMotion, attachment_links
from packages import InputError
from path_file import Attachment, Surface
from report import Report
from rigid import Poses, angle_between, rotation_angle
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
    _check_unheld_joints(motion, report)
    segment = motion.segment
    if not segment.attachments and not segment.constraints:
        return
    parameters = _sample_parameters(motion)
    report.count("residual_samples", len(parameters))
    worlds = motion.body_poses(parameters)
    for attachment in segment.attachments:
        _note_idle_carrier(motion, attachment, report)
        check = _check_grasp if attachment.is_grasp else _check_rest if attachment.on else _check_placement
        check(motion, attachment, parameters, worlds, report)
    for constraint in segment.constraints:
        tolerance, errors = constraint_errors(motion, constraint, parameters, worlds, report)
        judge(motion, parameters, "constraint", str(constraint), errors, tolerance, report)


def _sample_parameters(motion: SegmentMotion) -> np.ndarray:
    """Knots, and points between them where a residual could swell."""
    travel = np.diff(motion.cumulative_travel(), axis=0).max(axis=1, initial=0.0)
    counts = np.clip(np.ceil(travel / SAMPLE_TRAVEL), *SAMPLES_PER_INTERVAL).astype(int)
    pieces = [knot + np.arange(count) / count for knot, count in enumerate(counts)]
    return np.concatenate(pieces + [[float(motion.last)]])


def judge(motion, parameters, kind: str, subject: str, errors: dict, tolerance: float, report: Report) -> None:
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
            report.note(f"{carry.member.name} has no attachment in some segments: it must rest there")
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


def _check_unheld_joints(motion: SegmentMotion, report: Report) -> None:
    """Joints of objects move only while a gripper holds what is beyond them."""
    tolerance = min(CARRIER_TOLERANCE, motion.scene.path.path_tolerance)
    for member in motion.scene.members:
        if member.entry.kind != "object" or not member.part.joints:
            continue
        first = member.joint_values(motion.knots[:1])
        # Joint values are linear in coordinates, so the extremes of the one are those of the other.
        moved = np.max([np.abs(member.joint_values(rows) - first) for rows in motion.curve.ranges()], axis=0)
        held = _bodies_between_root_and_hands(motion, member)
        for joint in member.part.joints:
            if joint.index not in held:
                for knot in np.flatnonzero(moved[:, joint.index] > tolerance):
                    name = f"{member.name}/{joint.name}"
                    report.violate(motion.segment.index, knot, "joint-unheld", name, moved[knot, joint.index], tolerance)


def _bodies_between_root_and_hands(motion: SegmentMotion, member: Member) -> set[int]:
    """A part's bodies (its own numbering) with a held handle on them or beyond them."""
    between = set()
    for attachment in motion.segment.attachments:
        if attachment.is_grasp and attachment.handle in motion.scene.path.handles:
            body = motion.scene.link(motion.scene.path.handles[attachment.handle].link)[0]
            if motion.scene.member_of_body(body) is member:
                own = body - member.first_body
                while own > 0:
                    between.add(own)
                    own = member.part.parents[own]
    return between


def _note_idle_carrier(motion: SegmentMotion, attachment: Attachment, report: Report) -> None:
    member = motion.scene.by_name.get(attachment.object.partition("/")[0])
    if attachment.carrier and member and not member.floats:
        report.note(f"{attachment} carries {attachment.object}, which has no free-flying root: checked, not followed")


# Grasps


def _check_grasp(motion: SegmentMotion, attachment: Attachment, parameters, worlds: Poses, report: Report) -> None:
    attachment_links(motion.scene, attachment)
    _require_owner(motion, attachment.object, motion.scene.path.handles[attachment.handle].link, attachment.handle)
    handle = motion.scene.path.handles[attachment.handle]
    gripper = motion.frame_poses(worlds, attachment.gripper)
    relative = gripper.inverse() @ motion.frame_poses(worlds, attachment.handle)
    tolerance, subject = motion.scene.path.path_tolerance, str(attachment)
    judge(motion, parameters, "grasp", subject, zero_errors(relative, handle.mask), tolerance, report)
    frozen = frozen_errors(relative, handle.mask, handle.mask_complement)
    judge(motion, parameters, "grasp-constancy", subject, frozen, tolerance, report)


# Placements


def _check_placement(motion: SegmentMotion, attachment: Attachment, parameters, worlds: Poses, report: Report) -> None:
    attachment_links(motion.scene, attachment)
    path = motion.scene.path
    surface, support = path.surfaces[attachment.surface], path.surfaces[attachment.support]
    _require_owner(motion, attachment.object, surface.link, attachment.surface)
    support_from_surface = (
        motion.frame_poses(worlds, support.link).inverse() @ motion.frame_poses(worlds, surface.link)
    )
    centre = _centre_of_mass(motion, attachment, surface, parameters, worlds)
    errors = placement_errors(support_from_surface, surface, support, path.placement_margin, path.rests, centre)
    if path.rests and path.rests[0] == "stable" and centre is None:
        report.note(f"{attachment}: that the centre of mass is over the support is not checked, for want of masses of one body")
    judge(motion, parameters, "placement", str(attachment), errors, path.path_tolerance, report)
    frozen = frozen_errors(support_from_surface, [False] * 6, [True] * 6)
    judge(motion, parameters, "placement-constancy", str(attachment), frozen, path.path_tolerance, report)


def _centre_of_mass(motion: SegmentMotion, attachment: Attachment, surface: Surface, parameters, worlds: Poses):
    """Of an object of one body with a mass: pinocchio's, in the frame of the surface's link (3,)."""
    member = motion.scene.by_name.get(attachment.object.partition("/")[0])
    if member is None or len(member.part.model.inertias) > 1 or member.part.mass == 0.0:
        return None
    in_root = member.part.centre_of_mass(motion.joint_values(member, parameters))
    surface_from_root = motion.frame_poses(worlds, surface.link).inverse() @ worlds[:, member.first_body]
    return surface_from_root.apply(in_root)[0]


def _check_rest(motion: SegmentMotion, attachment: Attachment, parameters, worlds: Poses, report: Report) -> None:
    """How it rests is said by a constraint; here that it stays."""
    holder, held = attachment_links(motion.scene, attachment)
    support_from_object = motion.frame_poses(worlds, holder).inverse() @ motion.frame_poses(worlds, held)
    frozen = frozen_errors(support_from_object, [False] * 6, [True] * 6)
    tolerance = motion.scene.path.path_tolerance
    judge(motion, parameters, "placement-constancy", str(attachment), frozen, tolerance, report)


def placement_errors(
    support_from_surface: Poses, surface: Surface, support: Surface, margin: float,
    rests: tuple[str, float] | None = None, centre: np.ndarray | None = None,
) -> dict[str, np.ndarray]:
    """Errors (N,) of the best pair of polygons at the first sample: angle between the object's normal and the
    opposite of the support's, gap minus margin, and how far the object polygon's centre (by the rule whole-face: the
    worst of its corners, by its margin; by the rule stable the centre of mass, where it is known) lies outside the support."""
    best = None
    for lower in _polygons(support):
        for upper in _polygons(surface):
            errors = _contact_errors(support_from_surface, upper, lower, margin, rests, centre)
            worst = sum(error[0] for error in errors.values())
            if best is None or worst < best[0]:
                best = (worst, errors)
    return best[1] if best else {"no polygon": np.array([np.inf])}


def _polygons(surface: Surface) -> list[np.ndarray]:
    return [surface.points[polygon] for polygon in surface.polygons]


def _contact_errors(
    support_from_surface: Poses, upper: np.ndarray, lower: np.ndarray, margin: float, rests: tuple[str, float] | None,
    mass_centre: np.ndarray | None,
) -> dict:
    lower_normal, lower_centre = polygon_normal(lower), lower.mean(axis=0)
    centre = support_from_surface.apply(upper.mean(axis=0))
    normal = support_from_surface.rotation @ polygon_normal(upper)
    errors = {
        "normals not opposite": angle_between(normal, -lower_normal),
        "gap is not the margin": np.abs((centre - lower_centre) @ lower_normal - margin),
    }
    beyond = lambda points: _beyond(lower, points)
    if rests is None:
        errors["centre outside the support"] = np.maximum(beyond(centre), 0.0)
    elif rests[0] == "whole-face":
        corners = [beyond(support_from_surface.apply(corner)) for corner in upper]
        errors["corner hangs over the support"] = np.maximum(np.max(corners, axis=0) + rests[1], 0.0)
    elif mass_centre is not None:
        over = np.maximum(beyond(support_from_surface.apply(mass_centre)) + rests[1], 0.0)
        errors["centre of mass not over the support"] = over
        within = np.maximum(_beyond(upper, mass_centre[None]) + rests[1], 0.0)
        errors["centre of mass not over the object's polygon"] = np.full_like(over, within[0])
    return errors


def _beyond(polygon: np.ndarray, points: np.ndarray) -> np.ndarray:
    """How far points (N, 3) are beyond the worst edge of a convex polygon, seen along its normal; negative inside."""
    outward = np.cross(np.roll(polygon, -1, axis=0) - polygon, polygon_normal(polygon))
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    return np.einsum("ej,nej->ne", outward, points[:, None] - polygon[None]).max(axis=1)


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
