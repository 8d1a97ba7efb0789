"""Checks of times, velocities, limits of rates and events, in closed form: between two knots velocities and accelerations are
polynomials whose extremes are known.
"""

from __future__ import annotations

import numpy as np

from motion import SegmentMotion
from path_file import Event, Segment
from report import Report
from scene import Scene

SLACK = 1e-9
"""Rounding allowed beyond a limit, as a share of it; of times and fingers, seconds, radians and metres."""
MOST_ROUNDING = 1e-6
"""What the rounding of the file's numbers can do to a rate is allowed too, up to this share of its limit."""
AGREE = 2e-6
"""Accelerations that differ by no more than this share of their limit are one."""


def check_timing(scene: Scene, motions: list[SegmentMotion], report: Report) -> None:
    _check_events(scene, report)
    if scene.path.segments[0].velocities is None:
        return
    counts = [_moves_as_written(scene, motion) for motion in motions]
    shares = {"velocity": 0.0, "acceleration": 0.0}
    for motion, counted in zip(motions, counts):
        _check_rates(scene, motion, counted, shares, report)
        _check_carried(scene, motion, counted, report)
    _check_times(scene.path.segments, report)
    _check_velocities(scene, motions, counts, report)
    _check_accelerations(scene, motions, counts, report)
    for what, share in shares.items():
        claim = scene.path.certificate.get(f"max_{what}")
        if isinstance(claim, (int, float)) and (share > claim + 1.1e-6 or claim > 1.0 + 1.1e-6):
            report.violate(None, None, "certificate", f"max_{what}", share, claim)


def _moves_as_written(scene: Scene, motion: SegmentMotion) -> np.ndarray:
    """Whether a coordinate moves as the knots say: all but those of the roots of objects that follow a carrier, or rest."""
    counted = np.ones(len(scene.path.coordinates), dtype=bool)
    for member in scene.members:
        if motion.follows(member):
            counted[member.root_columns] = False
    return counted


def _limits(scene: Scene, key: str) -> np.ndarray:
    table = scene.path.rate_limits
    return np.array([table.get(name, {}).get(key, np.inf) for name in scene.path.coordinates])


def _rounding(segment: Segment, curve) -> np.ndarray:
    """How far the rounding of positions, velocities and times can change mean velocities (intervals, coordinates)."""
    unit, duration = np.finfo(float).eps, curve.durations[:, None]
    pairs = [np.abs(array[:-1]) + np.abs(array[1:]) for array in (segment.knots, segment.velocities)]
    stretch = unit * (np.abs(segment.times[:-1]) + np.abs(segment.times[1:]))[:, None] / duration
    return unit * (pairs[0] / duration + pairs[1]) + np.abs(np.diff(segment.knots, axis=0)) / duration * stretch


def _rates(segment: Segment, curve) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """For each rate its largest value and what rounding can do to it, (intervals, coordinates)."""
    duration, bends = curve.durations[:, None], curve.bends()
    mean = _rounding(segment, curve)
    stretch = np.finfo(float).eps * (np.abs(segment.times[:-1]) + np.abs(segment.times[1:]))[:, None] / duration
    acceleration = np.maximum(np.abs(bends[0]), np.abs(bends[1])) / duration**2
    jerk = 6.0 * np.abs(curve.third) / duration**3
    return {
        "velocity": (curve.fastest() / duration, 3.0 * mean),
        "acceleration": (acceleration, 6.0 * mean / duration + acceleration * stretch),
        "jerk": (jerk, 12.0 * mean / duration**2 + 2.0 * jerk * stretch),
    }


def _check_rates(scene: Scene, motion: SegmentMotion, counted: np.ndarray, shares: dict, report: Report) -> None:
    segment, curve = motion.segment, motion.curve
    if motion.last == 0:
        return
    passes = curve.durations > 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        rates = _rates(segment, curve)
    for key, (value, rounding) in rates.items():
        limit = np.broadcast_to(_limits(scene, key), value.shape)
        with np.errstate(invalid="ignore"):
            allowed = limit * (1.0 + SLACK) + np.minimum(rounding, MOST_ROUNDING * limit)
            counts = counted[None] & np.isfinite(limit) & passes[:, None]
            # Compared so that what is no number is beyond.
            beyond = counts & ~(value <= allowed)
        if key in shares and counts.any():
            shares[key] = max(shares[key], float((value[counts] / limit[counts]).max()))
        for knot, column in zip(*np.nonzero(beyond)):
            name = scene.path.coordinates[column]
            report.violate(segment.index, knot, f"{key}-limit", name, value[knot, column], limit[knot, column])


def _check_carried(scene: Scene, motion: SegmentMotion, counted: np.ndarray, report: Report) -> None:
    for knot, column in zip(*np.nonzero((motion.segment.velocities != 0.0) & ~counted[None])):
        report.violate(motion.segment.index, knot, "carried-velocity", scene.path.coordinates[column],
                       motion.segment.velocities[knot, column], 0.0)


def _check_times(segments: list[Segment], report: Report) -> None:
    before = 0.0
    for segment in segments:
        if segment.times[0] != before:
            subject = "a segment does not start when the one before ends" if segment.index else "the path does not start at 0"
            report.violate(segment.index, 0, "times", subject, segment.times[0], before)
        before = segment.times[-1]
        for knot in np.flatnonzero(np.diff(segment.times) == 0.0):
            pair = slice(knot, knot + 2)
            if (segment.velocities[pair] != 0.0).any() or (segment.knots[knot] != segment.knots[knot + 1]).any():
                report.violate(segment.index, knot, "times", "a motion in no time", 0.0)


def _check_velocities(scene: Scene, motions: list[SegmentMotion], counts: list[np.ndarray], report: Report) -> None:
    """Equal on both sides of every joint knot, zero at both ends of the path and where a coordinate begins to count."""
    ends = np.zeros(len(scene.path.coordinates))
    for motion, counted in zip(motions, counts):
        starts = np.where(counted, motion.segment.velocities[0], 0.0)
        _report_jumps(scene, motion, 0, starts, ends, report)
        ends = np.where(counted, motion.segment.velocities[-1], 0.0)
    _report_jumps(scene, motions[-1], motions[-1].last, ends, np.zeros_like(ends), report)


def _report_jumps(scene: Scene, motion: SegmentMotion, knot: int, found, wanted, report: Report) -> None:
    for column in np.flatnonzero(found != wanted):
        name = scene.path.coordinates[column]
        report.violate(motion.segment.index, knot, "velocity-jump", name, found[column], wanted[column])


def _check_accelerations(scene: Scene, motions: list[SegmentMotion], counts: list[np.ndarray], report: Report) -> None:
    """Where the file claims it, or a limit of the jerk needs it, accelerations do not jump."""
    limits, jerks = _limits(scene, "acceleration"), np.isfinite(_limits(scene, "jerk"))
    watched = jerks | (scene.path.certificate.get("continuity") == 2)
    before, before_rounding = np.zeros(len(limits)), np.zeros(len(limits))

    def agree(motion: SegmentMotion, knot: int, here, rounding) -> None:
        limit = np.where(np.isfinite(limits), limits, 1.0 + np.abs(here))
        allowed = AGREE * limit + np.minimum(rounding + before_rounding, MOST_ROUNDING * limit)
        for column in np.flatnonzero(watched & ~(np.abs(here - before) <= allowed)):
            kind = "jerk-limit" if jerks[column] else "certificate"
            subject = f"the acceleration of {scene.path.coordinates[column]} jumps"
            report.violate(motion.segment.index, knot, kind, subject, abs(here[column] - before[column]), allowed[column])

    if not watched.any():
        return
    for motion, counted in zip(motions, counts):
        if motion.last == 0:
            continue
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = [bend / motion.curve.durations[:, None] ** 2 for bend in motion.curve.bends()]
            rounding = _rates(motion.segment, motion.curve)["acceleration"][1]
        for knot in np.flatnonzero(motion.curve.durations > 0.0):
            agree(motion, knot, np.where(counted, ends[0][knot], 0.0), np.where(counted, rounding[knot], 0.0))
            before, before_rounding = np.where(counted, ends[1][knot], 0.0), np.where(counted, rounding[knot], 0.0)
    agree(motions[-1], motions[-1].last, np.zeros_like(before), np.zeros_like(before))


# Events


def _check_events(scene: Scene, report: Report) -> None:
    """Every grasp and release that the attachments make is listed, nothing else is, and everything stands still there."""
    events, segments = scene.path.events, scene.path.segments
    if events is None:
        return
    if [event.segment for event in events] != sorted(event.segment for event in events):
        report.violate(None, None, "event", "events are not in the order of travel")
    for before, after in zip(segments, segments[1:]):
        mine = [event for event in events if event.segment == after.index]
        had, has = _grasps(before), _grasps(after)
        happened = sorted([("release", *grasp) for grasp in had - has] + [("grasp", *grasp) for grasp in has - had])
        listed = sorted((event.kind, event.object, event.gripper, event.handle) for event in mine)
        if happened != listed:
            report.violate(after.index, 0, "event", f"{listed} are listed, {happened} happen")
        for event in mine:
            _check_event(scene, event, after, report)
        if happened and after.velocities is not None:
            for row in (before.velocities[-1], after.velocities[0]):
                for column in np.flatnonzero(row):
                    subject = f"{scene.path.coordinates[column]} moves at an event"
                    report.violate(after.index, 0, "event-moves", subject, row[column], 0.0)


def _grasps(segment: Segment) -> set[tuple[str, str, str]]:
    return {(item.object, item.gripper, item.handle) for item in segment.attachments if item.is_grasp}


def _check_event(scene: Scene, event: Event, segment: Segment, report: Report) -> None:
    stands = 0.0
    if segment.velocities is not None:
        if abs(event.time - segment.times[0]) > SLACK:
            report.violate(event.segment, 0, "event", "time of an event, and of its segment", event.time, segment.times[0])
        still = (segment.knots == segment.knots[0]).all(axis=1) & (segment.velocities == 0.0).all(axis=1)
        count = len(still) if still.all() else int(np.argmin(still))
        stands = segment.times[max(count, 1) - 1] - segment.times[0]
    if event.dwell > stands + SLACK:
        report.violate(event.segment, 0, "event-moves", "a segment stands still for less than the dwell", stands, event.dwell)
    done = _knot_of_event(scene, event, segment)
    for name, position in event.fingers.items():
        column = scene.columns.get(name)
        if column is None or name.partition("/")[0] != event.gripper.partition("/")[0]:
            report.violate(event.segment, 0, "event", f"{name} is no finger of {event.gripper}")
        elif abs(done[column] - position) > SLACK:
            report.violate(event.segment, 0, "event", f"finger {name}", position, done[column])


def _knot_of_event(scene: Scene, event: Event, segment: Segment) -> np.ndarray:
    """Where the hand has done what the event says: the last knot where the segment moves the fingers alone, else the first one.

    Objects that are taken may be written anew by a micrometre.
    """
    first, last = segment.knots[0], segment.knots[-1]
    fingers = {scene.columns[name] for name in event.fingers if name in scene.columns}
    moved = set(np.flatnonzero(np.abs(last - first) > 1e-6).tolist())
    return last if moved and moved <= fingers else first
