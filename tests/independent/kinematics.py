#!/usr/bin/env python3
"""World poses of a model's links, computed by pinocchio.

    kinematics.py [REQUEST.json]        (the request comes on standard input when no file is named)

The request is one JSON object:

    { "urdf": "package://... | file",       relative files lie beside the request (or in the current folder)
      "package_path": ["DIR", ...],         optional
      "root": "fixed | freeflyer | planar", optional, fixed by default
      "mimic": "follow | free",             optional, follow by default
      "configurations": [ {"joint": value, "x": 0.1, ...}, ... ],
      "links": ["name", ...] }              optional; empty for all links

A configuration names joints (rad or m; a continuous joint is one unwrapped angle) and, for a moving root, its
coordinates x y z qx qy qz qw or x y theta. What is not named is zero (qw: one). Under "follow" mimic joints are
computed from their leaders and may not be named.

The answer is `{"poses": [ {"link": [x, y, z, qx, qy, qz, qw], ...}, ... ]}`, one entry per configuration, poses in
the world; for a fixed root the world is the root link's frame. Metres; unit quaternions with qw >= 0.
Exit code 0, or 2 with a message on standard error.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

from packages import InputError, resolve, search_directories
from parts import Part
from path_file import FREEFLYER_COORDINATES, MIMIC, PLANAR_COORDINATES, ROOTS
from rigid import Poses

ROOT_COORDINATES = {"fixed": (), "freeflyer": FREEFLYER_COORDINATES, "planar": PLANAR_COORDINATES}


def answer(request: dict, beside: Path) -> dict:
    """The poses that a request asks for."""
    root = _choice(request, "root", ROOTS, "fixed")
    mimic = _choice(request, "mimic", MIMIC, "follow")
    folders = search_directories(_list(request, "package_path"))
    if not isinstance(request.get("urdf"), str):
        raise InputError("request: 'urdf' is missing")
    part = Part(resolve(request["urdf"], folders, beside), folders, mimic)
    links = _list(request, "links") or sorted(part.links)
    for link in links:
        if link not in part.links:
            raise InputError(f"{part.urdf}: no link {link!r}")
    configurations = _list(request, "configurations")
    return {"poses": [_link_poses(part, root, configuration, links) for configuration in configurations]}


def _link_poses(part: Part, root: str, configuration: dict, links: list[str]) -> dict[str, list[float]]:
    joints = {joint.name: joint.index for joint in part.free_joints()}
    values, root_values = np.zeros((1, part.body_count)), dict.fromkeys(ROOT_COORDINATES[root], 0.0)
    if root == "freeflyer":
        root_values["qw"] = 1.0
    for name, value in configuration.items():
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise InputError(f"request: {name!r} is no number")
        if name in joints:
            values[0, joints[name]] = value
        elif name in root_values:
            root_values[name] = float(value)
        else:
            raise InputError(f"{part.urdf}: {name!r} is neither a free joint nor a coordinate of a {root} root")
    bodies = part.body_poses(part.complete(values))[0]
    world_from_root = _root_pose(root, list(root_values.values()))
    poses = {}
    for link in links:
        body, body_from_link = part.links[link]
        poses[link] = (world_from_root @ bodies[body] @ body_from_link).to_array()
    return poses


def _root_pose(root: str, values: list[float]) -> Poses:
    if root == "fixed":
        return Poses.identity()
    if root == "planar":
        return Poses.planar(*values)
    if np.linalg.norm(values[3:]) < 1e-9:
        raise InputError("request: the root's quaternion is zero")
    return Poses.from_array(values)


def _choice(request: dict, key: str, choices: tuple[str, ...], default: str) -> str:
    value = request.get(key, default)
    if value not in choices:
        raise InputError(f"request: {key!r} is {value!r}, none of {', '.join(choices)}")
    return value


def _list(request: dict, key: str) -> list:
    value = request.get(key, [])
    if not isinstance(value, list):
        raise InputError(f"request: {key!r} is no list")
    return value


def read_request(arguments: list[str]) -> tuple[dict, Path]:
    """The request and the folder that relative files are beside."""
    name = arguments[0] if arguments else "standard input"
    try:
        text = Path(arguments[0]).read_text(encoding="utf-8") if arguments else sys.stdin.read()
        request = json.loads(text)
    except (OSError, ValueError) as error:
        raise InputError(f"{name}: {error}") from error
    if not isinstance(request, dict):
        raise InputError(f"{name}: a JSON object expected")
    return request, Path(arguments[0]).parent if arguments else Path(".")


def main(arguments: list[str]) -> int:
    try:
        print(json.dumps(answer(*read_request(arguments))))
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
