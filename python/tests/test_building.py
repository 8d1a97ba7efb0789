"""Scenes in code and from models."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import foliate
from foliate import poses

ROBOT = "package://foliate_scenes/demo/robot.urdf"
SRDF = "package://foliate_scenes/demo/robot.srdf"


def table_and_box() -> foliate.SceneBuilder:
    builder = foliate.SceneBuilder("cell")
    builder.add_robot(ROBOT, srdf=SRDF, grippers=None, start="ready")
    builder.add_box("table", [0.6, 1.2, 0.02], pose=[0.6, 0.0, 0.69], kind="environment", surfaces="auto")
    builder.add_box("box", [0.05, 0.05, 0.08], pose=[0.5, 0.2, 0.741], mass=0.2)
    builder.add_goal(objects={"box": [0.5, 0.3, 0.741]})
    return builder


def test_a_scene_is_built_in_code_solved_and_proved(tmp_path: Path) -> None:
    builder = table_and_box()
    assert repr(builder) == "SceneBuilder('cell': robot, table, box)"
    scene = builder.scene()
    assert (scene.name, scene.robots, scene.objects, scene.environments) == ("cell", ["robot"], ["box"], ["table"])
    answer = foliate.solve(scene, seed=1)
    assert [event.object for event in answer.path.events] == ["box", "box"]
    end = answer.path.poses(["box"], answer.path.times(10)[-1:])[0, 0]
    assert np.allclose(end[:3], [0.5, 0.3, 0.741], atol=1e-6)
    file = tmp_path / "path.json"
    answer.path.save(file)
    assert foliate.check(file, scene).proved


def test_what_is_built_is_a_dictionary_of_the_keys_of_scene_files() -> None:
    builder = table_and_box()
    builder.document["graph"] = {"preplacement_distance": np.float64(0.03)}
    builder.ignore("table", "robot/body").add_handle("box", "mine", pose=np.eye(4), clearance=0.05)
    builder.add_gripper("robot", "palm", "left_palm", pose=[0.06, 0, 0], clearance=0.05)
    assert builder.document["start"]["box"] == [0.5, 0.2, 0.741, 0, 0, 0, 1]
    scene = builder.scene()
    again = foliate.Scene.from_dict(builder.document)
    assert foliate.solve(scene, first=True).report.fingerprint == foliate.solve(again, first=True).report.fingerprint


def test_solids_of_every_form_are_added(tmp_path: Path) -> None:
    corners = np.array([[x, y, z] for x in (0, 40) for y in (0, 40) for z in (0, 40)])
    triangles = [(1, 2, 4), (1, 4, 3), (5, 8, 6), (5, 7, 8), (1, 6, 2), (1, 5, 6), (3, 4, 8), (3, 8, 7), (1, 3, 7), (1, 7, 5), (2, 6, 8), (2, 8, 4)]
    lines = [f"v {x} {y} {z}\n" for x, y, z in corners] + [f"f {a} {b} {c}\n" for a, b, c in triangles]
    (tmp_path / "cube.obj").write_text("".join(lines))
    builder = foliate.SceneBuilder(folder=tmp_path)
    builder.add_robot(ROBOT, srdf=SRDF, grippers=None, start={"left_elbow_pitch": 1.0})
    builder.add_mesh("cube", "cube.obj", scale=0.001, pose=[0.5, 0.0, 0.8], kind="environment")
    builder.add_cylinder("can", 0.02, 0.1, pose=[0.5, 0.3, 0.8])
    builder.add_sphere("ball", 0.02, pose=[0.5, -0.3, 0.8])
    builder.add_urdf("shelf", "package://foliate_scenes/demo/table.urdf", pose=[0.6, 0, 0], kind="environment")
    builder.add_goal(objects={"can": [0.5, 0.35, 0.8]})
    scene = builder.scene()
    solids = {solid.link.partition("/")[0]: solid for solid in scene.solids()}
    assert solids["can"].kind == "cylinder" and np.allclose(solids["can"].size, [0.02, 0.1])
    assert solids["ball"].kind == "sphere" and np.allclose(solids["ball"].size, [0.02])
    cube = next(solid for solid in scene.solids() if solid.link == "cube/body")
    assert cube.kind == "mesh" and cube.triangles.shape == (12, 3) and np.isclose(cube.vertices.max(), 0.04)
    assert scene.start("robot/left_elbow_pitch") == [1.0]
    assert np.allclose(scene.poses(["cube", "can/body"])[:, :3], [[0.5, 0.0, 0.8], [0.5, 0.3, 0.8]])


def test_what_is_wrong_is_told() -> None:
    builder = table_and_box()
    with pytest.raises(ValueError, match="already"):
        builder.add_box("box", [1, 1, 1], pose=[0, 0, 0])
    with pytest.raises(ValueError, match="object"):
        builder.add_box("other", [1, 1, 1], pose=[0, 0, 0], kind="thing")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="no part"):
        builder.add_handle("bax", "mine")
    with pytest.raises(ValueError, match="`weight`.*no form"):
        table_and_box().add_box("other", [1, 1, 1], pose=[0, 0, 0], weight=object()).scene()
    with pytest.raises(ValueError, match="finite|JSON"):
        table_and_box().add_goal(objects={"box": [float("nan"), 0, 0]}).scene()
    with pytest.raises(foliate.SceneError, match="wieght"):
        table_and_box().add_box("other", [1, 1, 1], pose=[5, 5, 5], wieght=1.0).scene()
    with pytest.raises(foliate.SceneError) as raised:
        table_and_box().add_robot("no_such_robot.urdf", name="second").scene()
    assert "no_such_robot.urdf" in str(raised.value)


def test_poses_have_three_forms() -> None:
    half = np.sqrt(0.5)
    turned = [1.0, 2.0, 3.0, 0.0, 0.0, half, half]
    matrix = poses.matrices(turned)
    assert np.allclose(matrix[:3, :3] @ [1, 0, 0], [0, 1, 0]) and np.allclose(matrix[:3, 3], [1, 2, 3])
    assert np.allclose(poses.pose(matrix), turned)
    assert poses.pose([1, 2, 3]) == [1, 2, 3, 0, 0, 0, 1]
    random = np.random.default_rng(7)
    for _ in range(100):
        quaternion = random.normal(size=4)
        quaternion *= np.sign(quaternion[3]) / np.linalg.norm(quaternion)
        assert np.allclose(poses.pose(poses.matrices([0, 0, 0, *quaternion]))[3:], quaternion, atol=1e-12)
    for wrong in ([1, 2], np.diag([1.0, 1.0, -1.0, 1.0]), 2 * np.eye(4)):
        with pytest.raises(ValueError):
            poses.pose(wrong)


def test_scenes_are_made_of_models(tmp_path: Path) -> None:
    made = foliate.new_scene(ROBOT, ["box 0.05 0.05 0.1"], table="1.2 0.8 0.7", folder=tmp_path)
    assert made.solved and made.grippers and made.objects[0][0] == "box" and made.objects[0][1] > 0
    assert len(foliate.solve(made.scene, first=True).path) > 2
    (tmp_path / "mine.toml").write_text(made.text)
    assert foliate.Scene(str(tmp_path / "mine.toml")).objects == ["box"]
    with pytest.raises(ValueError, match="no object"):
        foliate.new_scene(ROBOT, ["bix 1 2 3"])
    with pytest.raises(foliate.ModelError, match="cannot be held"):
        foliate.new_scene(ROBOT, ["box 0.5 0.5 0.5"])
    with pytest.raises(foliate.SceneError):
        foliate.new_scene("no_such_robot.urdf", ["box 0.05 0.05 0.1"])
