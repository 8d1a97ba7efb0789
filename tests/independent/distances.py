#!/usr/bin/env python3
"""coal's distances and collision verdicts for pairs of shapes.

    distances.py [REQUEST.json]         (the request comes on standard input when no file is named)

The request is one JSON object:

    { "package_path": ["DIR", ...],                       optional, for package:// mesh files
      "meshes": { "name": MESH, ... },                    optional, to name a mesh once and use it often
      "pairs": [ { "a": SHAPE, "b": SHAPE, "security_margin": m }, ... ] }     security_margin optional, 0 by default

    SHAPE = { "shape": "box",      "size": [x, y, z],            "pose": POSE }      full sides, centred
          | { "shape": "sphere",   "radius": r,                  "pose": POSE }
          | { "shape": "cylinder", "radius": r, "length": l,     "pose": POSE }      axis z, centred
          | { "shape": "capsule",  "radius": r, "length": l,     "pose": POSE }      axis z, centred, l without the caps
          | { "shape": "mesh", "name": "...",                    "pose": POSE }      one of "meshes"
          | { "shape": "mesh", ...MESH,                          "pose": POSE }
    MESH  = { "file": "package://... | file", "scale": [x, y, z] }                   scale optional
          | { "vertices": [[x, y, z], ...], "triangles": [[i, j, k], ...] }
    POSE  = [x, y, z, qx, qy, qz, qw] in a common frame; optional, identity by default

The answer is `{"results": [ {"distance": d, "collide": b, "collide_within_margin": b}, ... ]}` in the order of the
pairs. Metres. `distance` is negative for penetration (between two meshes: zero or less, its size means nothing).
Meshes are surfaces, hollow inside. coal's GJK and EPA stop at 1e-6 unless "tolerance" is given in the request.
Exit code 0, or 2 with a message on standard error.
"""

from __future__ import annotations

import json
import sys
from functools import lru_cache
from pathlib import Path

import coal
import numpy as np

from kinematics import read_request
from packages import InputError, resolve, search_directories
from rigid import Poses

NEEDS = {
    "box": lambda item: coal.Box(*_numbers(item, "size", 3)),
    "sphere": lambda item: coal.Sphere(_number(item, "radius")),
    "cylinder": lambda item: coal.Cylinder(_number(item, "radius"), _number(item, "length")),
    "capsule": lambda item: coal.Capsule(_number(item, "radius"), _number(item, "length")),
}


class Shapes:
    """Builds coal's shapes; meshes named in the request, or read from a file, are built once."""

    def __init__(self, request: dict, beside: Path):
        self._folders = search_directories(request.get("package_path", []))
        self._beside = beside
        self._from_file = lru_cache(maxsize=None)(self._load)
        self._named = {name: self._mesh(item) for name, item in request.get("meshes", {}).items()}

    def build(self, item: dict) -> tuple[coal.CollisionGeometry, coal.Transform3s]:
        kind = item.get("shape")
        if kind in NEEDS:
            geometry = NEEDS[kind](item)
        elif kind == "mesh" and "name" in item:
            if item["name"] not in self._named:
                raise InputError(f"mesh {item['name']!r} is not in 'meshes'")
            geometry = self._named[item["name"]]
        elif kind == "mesh":
            geometry = self._mesh(item)
        else:
            raise InputError(f"shape {kind!r} is none of {', '.join(NEEDS)}, mesh")
        pose = Poses.from_array(_numbers({"pose": [0, 0, 0, 0, 0, 0, 1], **item}, "pose", 7))
        return geometry, coal.Transform3s(pose.rotation, pose.translation)

    def _mesh(self, item: dict) -> coal.BVHModelOBBRSS:
        if "file" in item:
            return self._from_file(item["file"], tuple(_numbers({"scale": [1, 1, 1], **item}, "scale", 3)))
        vertices = np.array(item.get("vertices", []), dtype=float).reshape(-1, 3)
        triangles = np.array(item.get("triangles", []), dtype=int).reshape(-1, 3)
        if not len(triangles) or triangles.min() < 0 or triangles.max() >= len(vertices):
            raise InputError("a mesh needs a file, or vertices and triangles that index them")
        mesh = coal.BVHModelOBBRSS()
        mesh.beginModel(len(triangles), len(vertices))
        for triangle in triangles:
            mesh.addTriangle(*(vertices[corner] for corner in triangle))
        mesh.endModel()
        return mesh

    def _load(self, url: str, scale: tuple[float, ...]) -> coal.BVHModelOBBRSS:
        file = resolve(url, self._folders, self._beside)
        try:
            return coal.MeshLoader(coal.NODE_TYPE.BV_OBBRSS).load(str(file), np.array(scale))
        except Exception as error:
            raise InputError(f"{file}: coal cannot load it: {error}") from error


def answer(request: dict, beside: Path) -> dict:
    """Distances and verdicts for all pairs of a request."""
    shapes, results = Shapes(request, beside), []
    tolerance = request.get("tolerance")
    for index, pair in enumerate(request.get("pairs", [])):
        try:
            one, other = shapes.build(pair["a"]), shapes.build(pair["b"])
            results.append(_query(one, other, float(pair.get("security_margin", 0.0)), tolerance))
        except (InputError, KeyError, TypeError, ValueError, AttributeError) as error:
            raise InputError(f"request: pairs[{index}]: {type(error).__name__}: {error}") from error
    return {"results": results}


def _query(one, other, margin: float, tolerance: float | None) -> dict:
    distance_request, collision_request = coal.DistanceRequest(), coal.CollisionRequest()
    for request in (distance_request, collision_request):
        if tolerance is not None:
            request.gjk_tolerance = request.epa_tolerance = tolerance
    arguments = one[0], one[1], other[0], other[1]
    distance = coal.distance(*arguments, distance_request, coal.DistanceResult())
    collide = bool(coal.collide(*arguments, collision_request, coal.CollisionResult()))
    collision_request.security_margin = margin
    within = bool(coal.collide(*arguments, collision_request, coal.CollisionResult()))
    return {"distance": distance, "collide": collide, "collide_within_margin": within}


def _number(item: dict, key: str) -> float:
    return float(_numbers({key: [item[key]]}, key, 1)[0])


def _numbers(item: dict, key: str, count: int) -> np.ndarray:
    values = np.array(item[key], dtype=float)
    if values.shape != (count,) or not np.isfinite(values).all():
        raise InputError(f"{key!r}: {count} finite numbers expected")
    return values


def main(arguments: list[str]) -> int:
    try:
        print(json.dumps(answer(*read_request(arguments))))
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
