"""Compares distances that the checker found with those of coal.

    FOLIATE_WRITE_DISTANCES=/path/rows.jsonl cargo test --lib check::distance
    python tests/independent/checker_distances.py /path/rows.jsonl

Each row is a random pair of shapes, the pose of the second in the first's frame, and the checker's bounds. Exits with 1 where
a lower bound exceeds what coal finds by more than 1e-6 m, or a pair that coal has apart is open by more than that.
"""

import json
import sys
from collections import defaultdict

import coal
import numpy as np

ALLOWED = 1e-6


def shape(entry):
    kind = entry["kind"]
    if kind == "sphere":
        return coal.Sphere(entry["radius"])
    if kind == "box":
        return coal.Box(*(2 * x for x in entry["half"]))
    if kind == "cylinder":
        return coal.Cylinder(entry["radius"], 2 * entry["half"])
    if kind == "capsule":
        return coal.Capsule(entry["radius"], 2 * entry["half"])
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(len(entry["triangles"]), len(entry["vertices"]))
    vertices = np.array(entry["vertices"])
    for a, b, c in entry["triangles"]:
        mesh.addTriangle(vertices[a], vertices[b], vertices[c])
    mesh.endModel()
    return mesh


def main(path):
    worst = defaultdict(lambda: [0, 0.0, 0.0])
    for line in open(path):
        row = json.loads(line)
        x, y, z, w = row["quaternion"]
        pose = coal.Transform3s(coal.Quaternion(w, x, y, z).matrix() if hasattr(coal, "Quaternion") else rotation(x, y, z, w),
                                np.array(row["position"]))
        result = coal.DistanceResult()
        request = coal.DistanceRequest()
        request.gjk_tolerance = 1e-9
        theirs = coal.distance(shape(row["a"]), coal.Transform3s(), shape(row["b"]), pose, request, result)
        entry = worst[(row["a"]["kind"], row["b"]["kind"])]
        entry[0] += 1
        if theirs > ALLOWED:
            entry[1] = max(entry[1], row["lower"] - theirs)
            entry[2] = max(entry[2], theirs - row["lower"])
        elif row["lower"] > ALLOWED:
            entry[1] = max(entry[1], row["lower"])
    above = max(e[1] for e in worst.values())
    below = max(e[2] for e in worst.values())
    for (a, b), (count, more, less) in sorted(worst.items()):
        print(f"{a:9} {b:9} {count:5} pairs: at most {more:9.2e} m above, {less:9.2e} m below coal")
    print(f"worst: {above:.2e} m above, {below:.2e} m below")
    return 0 if max(above, below) <= ALLOWED else 1


def rotation(x, y, z, w):
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
