"""Planning scenes of MoveIt as dictionaries: the fields of ``moveit_msgs/PlanningScene``, without ROS."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from foliate.poses import matrices, pose

if TYPE_CHECKING:
    from foliate._foliate import Scene, Solid
    from foliate.building import SceneBuilder

__all__ = ["add_planning_scene", "planning_scene"]

# Of shape_msgs/SolidPrimitive.
BOX, SPHERE, CYLINDER = 1, 2, 3


def planning_scene(scene: Scene, robot: str | None = None) -> dict[str, Any]:
    """The start of a scene: joints of ``robot`` (default: the first), and every object and environment as a collision object in the frame ``world``.

    Poses of collision objects are those of their root links. Links that turn or shift in them stand as they do at the start. A capsule becomes a mesh. What a
    hand holds at the start is a collision object like any other: MoveIt's attached objects are not made.
    """
    name = robot if robot is not None else scene.robots[0]
    joints = scene.joint_names(name)
    state = {"name": [joint.partition("/")[2] for joint in joints], "position": [scene.start(joint)[0] for joint in joints]}
    solids: dict[str, list[Solid]] = {part: [] for part in [*scene.environments, *scene.objects]}
    for solid in scene.solids():
        part = solid.link.partition("/")[0]
        if part in solids:
            solids[part].append(solid)
    return {
        "name": scene.name,
        "robot_model_name": name,
        "robot_state": {"joint_state": {"header": _header(), **state}, "attached_collision_objects": [], "is_diff": False},
        "world": {"collision_objects": [_collision_object(scene, part, of) for part, of in solids.items()]},
        "is_diff": False,
    }


def add_planning_scene(builder: SceneBuilder, message: Mapping[str, Any], *, movable: Collection[str] = ()) -> list[str]:
    """Adds the collision objects of a planning scene to a builder; returns the names of the parts.

    Those in ``movable`` become objects, with grasps and resting faces that are found; they have one primitive or mesh. All others are environment, each
    primitive a part: ``shelf``, or ``shelf_0``, ``shelf_1`` and so on. Meshes are written as OBJ files into the builder's folder.

    Raises ``ValueError`` for what has no form here: cones and prisms, frames other than the world's, planes.
    """
    added: list[str] = []
    for thing in message["world"]["collision_objects"]:
        name = str(thing["id"])
        frame = thing.get("header", {}).get("frame_id", "")
        if frame not in ("", "world", "/world"):
            raise ValueError(f"the collision object {name!r} is given in the frame {frame!r}, not in `world`")
        if thing.get("planes"):
            raise ValueError(f"the collision object {name!r} has a plane; use a box")
        placed = _matrix(thing["pose"]) if "pose" in thing else np.eye(4)
        shapes = [*zip(thing.get("primitives", []), thing.get("primitive_poses", []), strict=True)]
        meshes = [*zip(thing.get("meshes", []), thing.get("mesh_poses", []), strict=True)]
        if name in movable and len(shapes) + len(meshes) != 1:
            raise ValueError(f"the collision object {name!r} has {len(shapes) + len(meshes)} shapes; one that is moved has one")
        several = len(shapes) + len(meshes) > 1
        for number, (shape, own) in enumerate([*shapes, *meshes]):
            part = f"{name}_{number}" if several else name
            _add_shape(builder, part, shape, placed @ _matrix(own), "object" if name in movable else "environment")
            added.append(part)
    return added


def _add_shape(builder: SceneBuilder, part: str, shape: Mapping[str, Any], placed: NDArray[np.float64], kind: Any) -> None:
    if "triangles" in shape:
        file = FilePath(builder.folder) / f"{part}.obj"
        vertices = [f"v {v['x']!r} {v['y']!r} {v['z']!r}\n" for v in shape["vertices"]]
        faces = ["f " + " ".join(str(int(index) + 1) for index in t["vertex_indices"]) + "\n" for t in shape["triangles"]]
        file.write_text("".join([*vertices, *faces]), encoding="ascii")
        builder.add_mesh(part, file.name, pose=placed, kind=kind)
        return
    sizes = [float(x) for x in shape["dimensions"]]
    form = int(shape["type"])
    if form == BOX:
        builder.add_box(part, sizes, pose=placed, kind=kind)
    elif form == SPHERE:
        builder.add_sphere(part, sizes[0], pose=placed, kind=kind)
    elif form == CYLINDER:
        builder.add_cylinder(part, sizes[1], sizes[0], pose=placed, kind=kind)
    else:
        raise ValueError(f"the collision object {part!r} has a primitive of type {form}; known are boxes (1), spheres (2), cylinders (3)")


def _collision_object(scene: Scene, part: str, solids: list[Solid]) -> dict[str, Any]:
    root = matrices(scene.poses([part]))[0]
    links = {link: matrices(scene.poses([link]))[0] for link in {solid.link for solid in solids}}
    thing: dict[str, Any] = {"header": _header(), "id": part, "pose": _pose_message(root), "operation": 0}
    thing |= {"primitives": [], "primitive_poses": [], "meshes": [], "mesh_poses": []}
    for solid in solids:
        own = _pose_message(np.linalg.inv(root) @ links[solid.link] @ matrices(np.asarray(solid.pose)))
        kinds = {"box": (BOX, solid.size), "sphere": (SPHERE, solid.size), "cylinder": (CYLINDER, solid.size[::-1])}
        if solid.kind in kinds:
            kind, sizes = kinds[solid.kind]
            thing["primitives"].append({"type": kind, "dimensions": list(sizes)})
            thing["primitive_poses"].append(own)
        else:
            vertices = [{"x": x, "y": y, "z": z} for x, y, z in solid.vertices.tolist()]
            thing["meshes"].append({"vertices": vertices, "triangles": [{"vertex_indices": t} for t in solid.triangles.tolist()]})
            thing["mesh_poses"].append(own)
    return thing


def _header() -> dict[str, Any]:
    return {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "world"}


def _pose_message(matrix: NDArray[np.float64]) -> dict[str, Any]:
    numbers = pose(matrix)
    return {"position": dict(zip("xyz", numbers[:3], strict=True)), "orientation": dict(zip("xyzw", numbers[3:], strict=True))}


def _matrix(message: Mapping[str, Any]) -> NDArray[np.float64]:
    place, turn = message.get("position", {}), message.get("orientation", {"w": 1.0})
    numbers = [float(place.get(axis, 0.0)) for axis in "xyz"] + [float(turn.get(axis, 0.0)) for axis in "xyzw"]
    return matrices(np.asarray(numbers))
