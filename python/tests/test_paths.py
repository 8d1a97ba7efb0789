"""Paths as arrays: shapes, units, agreement with each other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import foliate


@pytest.fixture(scope="module")
def path() -> foliate.Path:
    return foliate.solve(foliate.Scene("demo"), seed=3).path


def test_knots_are_those_of_the_segments(path: foliate.Path) -> None:
    rows = [segment.knots for segment in path.segments]
    joined = np.concatenate([rows[0], *[more[1:] for more in rows[1:]]])
    assert np.array_equal(path.knots, joined)
    assert len(path) == len(rows)
    for before, after in zip(rows, rows[1:], strict=False):
        assert np.array_equal(before[-1], after[0])


def test_times_reach_the_end(path: foliate.Path) -> None:
    times = path.times(50)
    assert path.duration is not None
    assert times[-1] - times[0] == pytest.approx(path.duration, abs=1e-12)
    assert np.all(np.diff(times) > 0)


def test_configurations_pass_the_knots(path: foliate.Path) -> None:
    for segment in path.segments:
        assert segment.times is not None
        assert np.allclose(path.configurations(segment.times), segment.knots, atol=1e-9)


def test_velocities_are_derivatives(path: foliate.Path) -> None:
    robot = path.robots[0]
    times = path.times(200)[10:-10]
    step = 1e-6
    _, velocities, _ = path.joints(robot, times)
    after, _, _ = path.joints(robot, times + step)
    before, _, _ = path.joints(robot, times - step)
    assert velocities.shape == (times.size, len(path.joint_names(robot)))
    # A knot may lie between the two: there the acceleration jumps.
    assert np.allclose((after - before) / (2 * step), velocities, atol=1e-4)


def test_poses_of_objects_are_their_numbers(path: foliate.Path) -> None:
    times = path.times(20)
    poses = path.poses(path.objects, times)
    assert poses.shape == (times.size, len(path.objects), 7)
    assert np.allclose(np.linalg.norm(poses[:, :, 3:], axis=2), 1.0)
    rows = path.configurations(times)
    # A free part is x, y, z and its quaternion: its seven numbers stand somewhere in the configuration.
    for number in range(len(path.objects)):
        starts = [at for at in range(rows.shape[1] - 6) if np.allclose(rows[:, at : at + 7], poses[:, number], atol=1e-9)]
        assert len(starts) == 1


def test_clearances_are_over_the_proven_bound(path: foliate.Path, tmp_path: Path) -> None:
    times = path.times(200)
    measured = path.clearances(times)
    assert path.min_clearance is not None and measured.shape == times.shape
    assert measured.min() >= path.min_clearance and measured.max() > 0.01
    path.save(tmp_path / "path.json")
    assert np.array_equal(foliate.load_path(tmp_path / "path.json").clearances(times), measured)
    knots = path.clearances()
    assert len(knots) == len(path.knots) and knots[0] == pytest.approx(measured[0], abs=1e-12) and knots[-1] == pytest.approx(measured[-1], abs=1e-12)
    without_times = foliate.solve(foliate.Scene("demo"), first=True).path
    assert len(without_times.clearances()) == len(without_times.knots)


def test_events_alternate(path: foliate.Path) -> None:
    kinds: dict[str, list[str]] = {}
    for event in path.events:
        kinds.setdefault(event.object, []).append(event.kind)
    assert kinds
    for told in kinds.values():
        assert told == ["grasp", "release"] * (len(told) // 2)


def test_unknown_names_are_told(path: foliate.Path) -> None:
    with pytest.raises(foliate.PathError, match="no_such_robot"):
        path.joints("no_such_robot", [0.0])
    with pytest.raises(foliate.PathError, match="no_such_part"):
        path.poses(["no_such_part"], [0.0])
    with pytest.raises(foliate.PathError):
        path.times(-1.0)


def test_first_paths_have_no_times() -> None:
    path = foliate.solve(foliate.Scene("demo"), first=True).path
    assert path.duration is None and path.segments[0].times is None
    with pytest.raises(foliate.PathError, match="time"):
        path.times(10)


def test_pages_are_text_and_files(path: foliate.Path, tmp_path: object) -> None:
    text = path.view()
    assert text.lstrip().lower().startswith("<!doctype html>")
    shown = path._repr_html_()
    assert shown.startswith("<iframe srcdoc=") and len(shown) > len(text)
