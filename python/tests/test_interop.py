"""Data of other programs. Tests that need one of them are skipped where it is not installed."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import foliate
from foliate import poses
from foliate.interop import messages, moveit


@pytest.fixture(scope="module")
def solution() -> foliate.Solution:
    return foliate.solve(foliate.Scene("demo"), seed=1)


URDF = Path(__file__).parents[2] / "scenes" / "demo" / "robot.urdf"


def test_trajectories_are_like_messages(solution: foliate.Solution) -> None:
    message = messages.joint_trajectory(solution.path, "robot", rate=20)
    assert len(message["joint_names"]) == len(message["points"][0]["positions"]) == len(solution.path.joint_names("robot"))
    seconds = [p["time_from_start"]["sec"] + 1e-9 * p["time_from_start"]["nanosec"] for p in message["points"]]
    assert seconds[0] == 0 and np.all(np.diff(seconds) > 0) and np.isclose(seconds[-1], solution.path.duration or 0.0)
    some = messages.joint_trajectory(solution.path, "robot", joints=["left_elbow_pitch"])
    assert some["joint_names"] == ["left_elbow_pitch"]
    commands = messages.gripper_commands(solution.path)
    assert [c["command"] for c in commands] == [e.kind for e in solution.path.events] and commands[0]["position"]
    json.dumps([message, commands])


def test_planning_scenes_go_out_and_come_back(solution: foliate.Solution, tmp_path: Path) -> None:
    scene = solution.scene
    message = json.loads(json.dumps(moveit.planning_scene(scene)))
    names = [thing["id"] for thing in message["world"]["collision_objects"]]
    assert names == [*scene.environments, *scene.objects]
    state = message["robot_state"]["joint_state"]
    assert dict(zip(state["name"], state["position"], strict=True))["left_elbow_pitch"] == scene.start("robot/left_elbow_pitch")[0]
    builder = foliate.SceneBuilder(folder=tmp_path)
    builder.add_robot("package://foliate_scenes/demo/robot.urdf", srdf="package://foliate_scenes/demo/robot.srdf", grippers=None, start="ready")
    added = moveit.add_planning_scene(builder, message, movable=scene.objects)
    assert set(scene.objects) <= set(added)
    builder.add_goal(objects={scene.objects[0]: poses.pose([0.5, 0.3, 0.741])})
    again = builder.scene()
    assert np.allclose(again.poses(scene.objects), scene.poses(scene.objects))
    assert len(foliate.solve(again, first=True).path) > 2


def test_planning_scenes_that_have_no_form_here_are_refused(tmp_path: Path) -> None:
    def world(**thing: object) -> dict[str, object]:
        return {"world": {"collision_objects": [{"id": "thing", **thing}]}}

    cone = {"primitives": [{"type": 4, "dimensions": [1, 1]}], "primitive_poses": [{}]}
    for message, why in [
        (world(header={"frame_id": "camera"}), "camera"),
        (world(planes=[{}]), "plane"),
        (world(**cone), "type 4"),
    ]:
        with pytest.raises(ValueError, match=why):
            moveit.add_planning_scene(foliate.SceneBuilder(folder=tmp_path), message)


def test_meshes_of_planning_scenes_become_files(tmp_path: Path) -> None:
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    mesh = {
        "vertices": [dict(zip("xyz", (0.1 * x for x in corner), strict=True)) for corner in corners],
        "triangles": [{"vertex_indices": t} for t in ([0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3])],
    }
    thing = {"id": "wedge", "pose": {"position": {"x": 1.0}}, "meshes": [mesh], "mesh_poses": [{"position": {"z": 0.5}}]}
    builder = foliate.SceneBuilder(folder=tmp_path)
    assert moveit.add_planning_scene(builder, {"world": {"collision_objects": [thing]}}) == ["wedge"]
    assert (tmp_path / "wedge.obj").read_text().count("f ") == 4
    assert builder.document["part"][0]["pose"][:3] == [1.0, 0.0, 0.5]


def test_configurations_are_in_the_order_of_pinocchio(solution: foliate.Solution) -> None:
    pin = pytest.importorskip("pinocchio")
    from foliate.interop.pinocchio import from_pinocchio, to_pinocchio

    path = solution.path
    model = pin.buildModelFromUrdf(str(URDF))
    times = path.times(5)
    rows = to_pinocchio(path, "robot", model, times)
    assert rows.shape == (times.size, model.nq)
    data = model.createData()
    links = [frame.name for frame in model.frames if frame.type == pin.FrameType.BODY][:20]
    placed = path.poses([f"robot/{link}" for link in links], times)
    for row, wanted in zip(rows, placed, strict=True):
        pin.framesForwardKinematics(model, data, row)
        for link, own in zip(links, wanted, strict=True):
            found = data.oMf[model.getFrameId(link)].homogeneous
            assert np.allclose(found, poses.matrices(own), atol=1e-9), link
    values = from_pinocchio(model, rows[0], "robot")
    assert values["robot/left_elbow_pitch"] == pytest.approx(path.joints(["robot/left_elbow_pitch"], [0.0])[0][0, 0])
    moved = solution.scene.with_start({name: value for name, value in values.items() if name in solution.scene.joint_names("robot")})
    assert moved.start("robot/left_elbow_pitch")[0] == values["robot/left_elbow_pitch"]
    with pytest.raises(ValueError, match="shape"):
        from_pinocchio(model, [0.0], "robot")


def test_roots_and_wheels_of_pinocchio_are_read() -> None:
    pin = pytest.importorskip("pinocchio")
    from foliate.interop.pinocchio import from_pinocchio

    model = pin.Model()
    base = model.addJoint(0, pin.JointModelPlanar(), pin.SE3.Identity(), "root")
    model.addJoint(base, pin.JointModelRUBZ(), pin.SE3.Identity(), "wheel")
    values = from_pinocchio(model, [1.0, 2.0, np.cos(0.3), np.sin(0.3), np.cos(2.0), np.sin(2.0)], "cart")
    assert values["cart"] == pytest.approx([1.0, 2.0, 0.3]) and values["cart/wheel"] == pytest.approx(2.0)


def test_mujoco_follows_a_path(solution: foliate.Solution) -> None:
    mujoco = pytest.importorskip("mujoco")
    from foliate.interop.mujoco import controls, replay

    spec = mujoco.MjSpec.from_file(str(URDF))
    # The planned motion keeps clear of everything; contacts of the model are not what is looked at here.
    for geom in spec.geoms:
        geom.contype = geom.conaffinity = 0
    spec.option.gravity = [0, 0, 0]
    for joint in spec.joints:
        joint.armature = 0.1
        actuator = spec.add_actuator(name=joint.name, target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        actuator.set_to_position(kp=4000, dampratio=1.0)
    model = spec.compile()
    assert controls(solution.path, "robot", model, [0.0]).shape == (1, model.nu)
    done = replay(solution.path, "robot", model)
    assert done.planned.shape == done.reached.shape and len(done.joints) == model.nu
    assert np.abs(done.planned).max() > 0.1 and done.worst.max() < 0.1, dict(zip(done.joints, done.worst, strict=True))
    with pytest.raises(ValueError, match="no actuator"):
        controls(solution.path, "robot", mujoco.MjModel.from_xml_string("<mujoco/>"), [0.0])


def test_viser_shows_a_path(solution: foliate.Solution) -> None:
    viser = pytest.importorskip("viser")
    from foliate.interop.viser import Player

    server = viser.ViserServer(port=0, verbose=False)
    try:
        player = Player(solution.path, solution.scene, server)
        before = [frame.position.copy() for frame in player._frames]
        player.show(float(player.times[player.times.size // 2]))
        moved = [not np.allclose(frame.position, old) for frame, old in zip(player._frames, before, strict=True)]
        assert any(moved) and not all(moved)
    finally:
        server.stop()
