#!/usr/bin/env python3
"""Make the file of problems from an archive of MotionBenchMaker's requests and scenes, as VAMP's source package has one for each robot.

    convert.py resources/panda/problems.tar.bz2 panda panda.json.gz

The archive has `FOLDER/SET_ROBOT/sceneNNNN.yaml` and `requestNNNN.yaml`, messages of MoveIt. Needs PyYAML.
"""

from __future__ import annotations

import argparse
import gzip
import json
import re
import sys
import tarfile
from pathlib import Path, PurePosixPath

import numpy as np
import yaml

Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
NUMBERS = {"box": lambda d: {"size": d[:3]}, "cylinder": lambda d: {"length": d[0], "radius": d[1]}, "sphere": lambda d: {"radius": d[0]}}


class ConvertError(Exception):
    """An archive that is not of this form; the message names the member."""


def convert(archive: Path, robot: str) -> dict:
    """The document that `problems.read` reads. Numbers are floats, poses those of the primitives in the world."""
    scenes: dict[tuple[str, int], dict] = {}
    requests: dict[tuple[str, int], dict] = {}
    with tarfile.open(archive) as tar:
        for member in tar:
            name = PurePosixPath(member.name)
            kind = re.fullmatch(r"(scene|request)(\d+)\.yaml", name.name)
            if not member.isfile() or kind is None:
                continue
            key = (name.parent.name.removesuffix(f"_{robot}"), int(kind[2]))
            try:
                message = yaml.load(tar.extractfile(member).read(), Loader=Loader)
                if kind[1] == "scene":
                    scenes[key] = {"obstacles": [_obstacle(entry) for entry in message["world"]["collision_objects"]]}
                else:
                    requests[key] = _request(message)
            except (KeyError, IndexError, TypeError, ValueError, yaml.YAMLError) as error:
                raise ConvertError(f"{archive}: {member.name}: {error!r}") from error
    if not requests or scenes.keys() != requests.keys():
        odd = sorted(scenes.keys() ^ requests.keys())
        raise ConvertError(f"{archive}: no pairs of sceneNNNN.yaml and requestNNNN.yaml" + (f": {odd[0]} has one of them" if odd else ""))
    sets: dict[str, list] = {}
    for key in sorted(scenes):
        sets.setdefault(key[0], []).append({"index": key[1], **requests[key], **scenes[key]})
    return {"robot": robot, "source": f"MotionBenchMaker, {archive.name}", "quaternions": "x y z w", "sets": sets}


def _request(message: dict) -> dict:
    state = message["start_state"]["joint_state"]
    goal = message["goal_constraints"][0]["joint_constraints"]
    return {"start": dict(zip(state["name"], map(float, state["position"]), strict=True)),
            "goal": {entry["joint_name"]: float(entry["position"]) for entry in goal}}


def _obstacle(entry: dict) -> dict:
    if len(entry["primitives"]) != 1:
        raise ValueError(f"{entry['id']} has {len(entry['primitives'])} primitives")
    primitive, pose = entry["primitives"][0], entry["primitive_poses"][0]
    translation, turn = _pose(pose)
    if "pose" in entry:
        outer, outer_turn = _pose(entry["pose"])
        translation, turn = outer + _rotated(outer_turn, translation), _product(outer_turn, turn)
    sizes = NUMBERS[primitive["type"]]([float(size) for size in primitive["dimensions"]])
    return {"name": entry["id"], "type": primitive["type"], **sizes, "xyz": translation.tolist(), "quaternion": turn.tolist()}


def _pose(pose: dict) -> tuple[np.ndarray, np.ndarray]:
    turn = np.array(pose["orientation"], dtype=float)
    return np.array(pose["position"], dtype=float), turn / np.linalg.norm(turn)


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    vector = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.append(vector, a[3] * b[3] - a[:3] @ b[:3])


def _rotated(turn: np.ndarray, vector: np.ndarray) -> np.ndarray:
    across = 2.0 * np.cross(turn[:3], vector)
    return vector + turn[3] * across + np.cross(turn[:3], across)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("archive", type=Path)
    parser.add_argument("robot")
    parser.add_argument("out", type=Path, metavar="FILE.json[.gz]")
    given = parser.parse_args()
    try:
        document = convert(given.archive, given.robot)
        text = json.dumps(document).encode()
        # Without a time in its header, the file depends on the archive alone.
        given.out.write_bytes(gzip.compress(text, mtime=0) if given.out.suffix == ".gz" else text)
    except (ConvertError, OSError, tarfile.TarError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(", ".join(f"{name} {len(problems)}" for name, problems in document["sets"].items()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
