#!/usr/bin/env python3
"""Writes a scene file for every instance of the installed guided-tamp-benchmark package.

    python convert.py --out DIR [--fingers free|open] [--only TEXT]

`DIR` gets the scenes, their models in `DIR/models`, and `DIR/instances.json`: what the package's own checks say of each
start and goal, how many grasps its demonstration has, which models had to be changed, and by how much objects were moved to rest.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from package import Models, colliding, convert, ends, grasps_shown, instances, load
from scene_text import FREE, OPEN, scene_text


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--fingers", choices=(FREE, OPEN), default=FREE)
    parser.add_argument("--only", default="", help="instances whose name contains this")
    options = parser.parse_args()
    models = Models(options.out / "models")
    file = options.out / "instances.json"
    index = json.loads(file.read_text()) if file.is_file() else {}
    for name in instances():
        if options.only not in name.text:
            continue
        task = load(name)
        converted = convert(name, task, models)
        (options.out / f"{name.text}.toml").write_text(scene_text(converted.instance, options.fingers))
        at = dict(zip(("start", "goal"), ends(task)))
        index[name.text] = {
            "group": name.group, "fingers": options.fingers, "grasps": grasps_shown(task), "changes": converted.changes,
            "moved": converted.moved,
            "collisions": {end: colliding(task, configuration) for end, configuration in at.items()},
        }
        print(name.text, {end: len(pairs) for end, pairs in index[name.text]["collisions"].items()}, flush=True)
    if not any(options.only in name for name in index):
        print(f"no instance has {options.only!r} in its name", file=sys.stderr)
        return 2
    file.write_text(json.dumps(index, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
