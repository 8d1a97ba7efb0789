#!/usr/bin/env python3
"""Read what `foliate export` has written with other people's libraries, and compare it with the path file.

    read_exports.py PATH.json FOLDER [--samples RATE]

FOLDER holds ros.json, ros.yaml, all.csv, all.npz, all.mcap and all.glb of the path, sampled at RATE (100 Hz). NumPy reads the arrays and
the table, PyYAML and json the messages of ROS, `mcap` (PyPI) the recording. What they hold is compared with the path's
curve, evaluated here from knots, times and velocities alone, and with link poses of pinocchio. The GLB is taken apart by
hand: its nodes are placed as glTF says, sample by sample.

Prints the largest differences as one JSON object. Exit code 0, or 1 with the difference that is too large.
"""

from __future__ import annotations

import csv
import json
import struct
import sys
from pathlib import Path

import numpy as np
import yaml
from mcap.reader import make_reader

from packages import resolve, search_directories
from parts import Part
from rigid import Poses

EXACT = 1e-9
"""What numbers in double precision may differ by: metres, radians, and so on per second."""
ALLOWED = {"ros positions": 1e-8, "ros velocities": 1e-8, "ros roots": 1e-8, "ros twists": 1e-4, "glb poses": 2e-5}
"""What others may: times of ROS are rounded to nanoseconds, a GLB has chains of poses in single precision."""
FLYER = ("x", "y", "z", "qx", "qy", "qz", "qw")
POINT = {"positions", "velocities", "accelerations", "effort", "time_from_start"}
"""Fields of trajectory_msgs/JointTrajectoryPoint."""


class Different(Exception):
    """An export that does not say what the path says."""


class Curve:
    """The path of a file: numbers by coordinate at any times, and poses of links by pinocchio."""

    def __init__(self, path: Path):
        self.file = json.loads(path.read_text())
        if self.file["format"] != "foliate.path/2":
            raise Different(f"{path}: not a path with velocities")
        self.names = self.file["coordinates"]
        self.column = {name: index for index, name in enumerate(self.names)}
        self.segments = self.file["segments"]
        self.arrays = [[np.array(segment[key]) for key in ("times", "knots", "velocities")] for segment in self.segments]
        self.last = (None, None)
        self.start, self.end = self.segments[0]["times"][0], self.segments[-1]["times"][-1]
        folders = search_directories()
        self.parts = {}
        for entry in self.file["parts"]:
            urdf = resolve(entry["urdf"], folders, path.parent)
            self.parts[entry["name"]] = (entry, Part(urdf, folders, entry["mimic"]))

    def kind(self, kind: str) -> list[str]:
        return [name for name, (entry, _) in self.parts.items() if entry["kind"] == kind]

    def segment_at(self, time: float) -> int:
        return max((i for i, segment in enumerate(self.segments) if segment["times"][0] <= time), default=0)

    def at(self, time: float) -> np.ndarray:
        """Values, rates and accelerations (3, coordinates) of the cubic Hermite polynomials."""
        if self.last[0] != time:
            self.last = (time, self.evaluated(time))
        return self.last[1]

    def evaluated(self, time: float) -> np.ndarray:
        times, knots, rates = self.arrays[self.segment_at(time)]
        k = int(np.clip(np.searchsorted(times, time, side="right") - 1, 0, len(times) - 2))
        h = times[k + 1] - times[k]
        if h == 0.0:
            return np.stack([knots[k + 1], 0 * knots[k], 0 * knots[k]])
        # Coefficients by Newton's divided differences: another form of the same polynomial.
        slope = (knots[k + 1] - knots[k]) / h
        bend = (slope - rates[k]) / h
        twist = (rates[k] - 2 * slope + rates[k + 1]) / h**2
        s, r = time - times[k], time - times[k + 1]
        value = knots[k] + rates[k] * s + bend * s**2 + twist * s**2 * r
        rate = rates[k] + 2 * bend * s + twist * (2 * s * r + s**2)
        return np.stack([value, rate, 2 * bend + twist * (4 * s + 2 * r)])

    def joint_values(self, part: Part, name: str, row: np.ndarray) -> np.ndarray:
        values = np.zeros((1, part.body_count))
        for joint in part.free_joints():
            column = self.column.get(f"{name}/{joint.name}")
            values[0, joint.index] = 0.0 if column is None else row[column]
        return part.complete(values)

    def written_root(self, name: str, row: np.ndarray) -> Poses:
        entry, _ = self.parts[name]
        base = Poses.from_array(entry["world_from_root"])
        pick = lambda axes: np.array([row[self.column[f"{name}/{axis}"]] for axis in axes])
        if entry["root"] == "freeflyer":
            return Poses.from_array(pick(FLYER))
        return base @ Poses.planar(*pick(["x", "y", "theta"])) if entry["root"] == "planar" else base

    def holder(self, attachment: dict) -> str:
        documents = self.file["documents"]
        if "gripper" in attachment:
            return documents["grippers"][attachment["gripper"]]["link"]
        if "support" in attachment:
            return documents["surfaces"][attachment["support"]]["link"]
        return attachment["on"]

    def roots(self, time: float) -> dict[str, Poses]:
        """World poses of all root links, objects on what carries them."""
        segment = self.segments[self.segment_at(time)]
        row, first = self.at(time)[0], self.arrays[self.segment_at(time)][1][0]
        before = {name: self.written_root(name, first) for name in self.parts}
        now = {name: self.written_root(name, row) for name in self.parts}
        waiting = []
        for name in self.kind("object"):
            if self.parts[name][0]["root"] != "freeflyer":
                continue
            mine = [item for item in segment["attachments"] if item["object"] == name]
            carriers = [item for item in mine if item["carrier"]]
            if not carriers and not any("gripper" in item for item in mine):
                now[name] = before[name]
            elif carriers and ("gripper" in carriers[0] or "support" in carriers[0] or "on" in carriers[0]):
                waiting.append((name, self.holder(carriers[0])))
            elif carriers:
                now[name] = before[name]
        while waiting:
            carried = {name for name, _ in waiting}
            ready = [item for item in waiting if item[1].split("/")[0] not in carried]
            if not ready:
                raise Different(f"at {time} s objects carry each other")
            for name, link in ready:
                was, is_now = self.link(link, before, first), self.link(link, now, row)
                now[name] = is_now @ was.inverse() @ before[name]
                waiting.remove((name, link))
        return now

    def link(self, name: str, roots: dict[str, Poses], row: np.ndarray) -> Poses:
        part_name, _, local = name.partition("/")
        part = self.parts[part_name][1]
        body, body_from_link = part.links[local]
        return roots[part_name] @ part.body_poses(self.joint_values(part, part_name, row))[0][body] @ body_from_link

    def links(self, time: float) -> dict[str, Poses]:
        """World poses of all links of robots and objects."""
        roots, row, found = self.roots(time), self.at(time)[0], {}
        for name in self.kind("robot") + self.kind("object"):
            part = self.parts[name][1]
            bodies = part.body_poses(self.joint_values(part, name, row))[0]
            for link, (body, body_from_link) in part.links.items():
                found[f"{name}/{link}"] = roots[name] @ bodies[body] @ body_from_link
        return found

    def joint(self, name: str, time: float) -> np.ndarray:
        """Value, rate and acceleration of a joint, also of one that follows another."""
        part_name, _, local = name.partition("/")
        part = self.parts[part_name][1]
        for follower in part.followers:
            if part.model.names[follower.joint] == local:
                leader = self.joint(f"{part_name}/{part.model.names[follower.leader]}", time)
                return follower.multiplier * leader + np.array([follower.offset, 0.0, 0.0])
        return self.at(time)[:, self.column[name]]

    def held(self, segment: dict) -> list[tuple]:
        """Object, gripper, handle of every grasp."""
        grasps = [item for item in segment["attachments"] if "gripper" in item]
        return [(item["object"].split("/")[0], item["gripper"], item["handle"]) for item in grasps]

    def events(self) -> list[tuple]:
        """Time, kind, object, gripper, handle of every grasp and release."""
        found = []
        for before, after in zip(self.segments, self.segments[1:]):
            had, has, time = self.held(before), self.held(after), after["times"][0]
            found += [(time, "release", *item) for item in had if item not in has]
            found += [(time, "grasp", *item) for item in has if item not in had]
        return found


def expect(condition: bool, message: str) -> None:
    if not condition:
        raise Different(message)


def apart(found, wanted) -> float:
    found, wanted = np.asarray(found, dtype=float), np.asarray(wanted, dtype=float)
    expect(found.shape == wanted.shape, f"shape {found.shape} instead of {wanted.shape}")
    return float(np.abs(found - wanted).max()) if found.size else 0.0


def pose_apart(row, pose: Poses) -> float:
    """Largest entry of the difference of two poses; `row` is x y z qx qy qz qw."""
    expect(abs(float(np.linalg.norm(row[3:])) - 1.0) < 1e-9, f"quaternion {row[3:]} is not of length 1")
    found = Poses.from_array(row)
    return max(apart(found.rotation, pose.rotation), apart(found.translation, pose.translation))


def times_of(curve: Curve, rate: float) -> np.ndarray:
    steps = int(np.ceil((curve.end - curve.start) * rate - 1e-6))
    return np.append(curve.start + np.arange(steps) / rate, curve.end)


def some(times: np.ndarray) -> np.ndarray:
    """Every sample would take minutes: some forty of them, the first and the last included."""
    return np.unique(np.linspace(0, len(times) - 1, 40).astype(int))


def check_npz(curve: Curve, file: Path, rate: float) -> dict[str, float]:
    arrays = np.load(file)
    times = times_of(curve, rate)
    expect(arrays["time"][-1] == curve.end, "the last sample is not at the end")
    off = {"npz time": apart(arrays["time"], times)}
    names = arrays["joint_names"]
    rows = np.stack([[curve.joint(name, time) for name in names] for time in times])
    # Quaternions of roots are scaled, which is not done here.
    plain = [i for i, name in enumerate(names) if name.rpartition("/")[2] not in FLYER[3:]]
    for index, key in enumerate(["positions", "velocities", "accelerations"]):
        scale = 1.0 + np.abs(rows[:, plain, index]).max(initial=0.0)
        off[f"npz {key}"] = apart(arrays[key][:, plain], rows[:, plain, index]) / scale
    robots = [f"{name}/{link}" for name in curve.kind("robot") for link in curve.parts[name][1].links]
    expect(sorted(arrays["link_names"]) == sorted(robots), "the links of robots are others")
    off["npz link poses"] = off["npz object poses"] = 0.0
    for index in some(times):
        wanted = curve.links(times[index])
        root = lambda name: name if "/" in name else f"{name}/{curve.parts[name][1].root_link}"
        for kind in ("link", "object"):
            for name, row in zip(arrays[f"{kind}_names"], arrays[f"{kind}_poses"][index]):
                what = f"npz {kind} poses"
                off[what] = max(off[what], pose_apart(row, wanted[root(name)]))
    told = list(zip(*(arrays[f"event_{key}"] for key in ("times", "kinds", "objects", "grippers", "handles"))))
    expect([tuple(event) for event in told] == curve.events(), f"events {told} instead of {curve.events()}")
    expect(list(arrays["segment_states"]) == [segment["state"] for segment in curve.segments], "states are others")
    return off


def check_csv(curve: Curve, file: Path, rate: float) -> dict[str, float]:
    with file.open(newline="") as text:
        rows = list(csv.reader(text))
    names, numbers = rows[0], np.array(rows[1:], dtype=float)
    still = tuple(f"{name}/" for name in curve.kind("environment"))
    expect(names == ["time"] + [name for name in curve.names if not name.startswith(still or ("\0",))], "columns are others")
    times = times_of(curve, rate)
    off = {"csv time": apart(numbers[:, 0], times), "csv joints": 0.0, "csv objects": 0.0}
    free = [name for name in curve.kind("object") if curve.parts[name][0]["root"] == "freeflyer"]
    for index in some(times):
        row, roots = curve.at(times[index])[0], curve.roots(times[index])
        named = dict(zip(names[1:], numbers[index, 1:]))
        for name, value in named.items():
            part, _, local = name.partition("/")
            # Roots of objects are where their carriers take them, quaternions are scaled.
            if not (part in free and local in FLYER) and local not in FLYER[3:]:
                off["csv joints"] = max(off["csv joints"], abs(value - row[curve.column[name]]))
        for name in free:
            pose = np.array([named[f"{name}/{axis}"] for axis in FLYER])
            off["csv objects"] = max(off["csv objects"], pose_apart(pose, roots[name]))
    return off


def seconds(time: dict) -> float:
    expect(set(time) == {"sec", "nanosec"} and 0 <= time["nanosec"] < 10**9, f"{time} is no time")
    return time["sec"] + time["nanosec"] * 1e-9


def check_ros(curve: Curve, folder: Path) -> dict[str, float]:
    message = json.loads((folder / "ros.json").read_text())
    expect(yaml.safe_load((folder / "ros.yaml").read_text()) == message, "JSON and YAML differ")
    off = {"ros positions": 0.0, "ros velocities": 0.0}
    expect([entry["robot"] for entry in message["robots"]] == curve.kind("robot"), "robots are others")
    for entry in message["robots"]:
        trajectory = entry["joint_trajectory"]
        expect(set(trajectory) == {"header", "joint_names", "points"}, f"fields {set(trajectory)}")
        expect(all(set(point) == POINT for point in trajectory["points"]), "points have other fields")
        names = [f"{entry['robot']}/{name}" for name in trajectory["joint_names"]]
        times = np.array([seconds(point["time_from_start"]) for point in trajectory["points"]])
        expect(bool((np.diff(times) > 0).all()), "times do not increase")
        positions = np.array([point["positions"] for point in trajectory["points"]])
        velocities = np.array([point["velocities"] for point in trajectory["points"]])
        expect(not any(point["accelerations"] for point in trajectory["points"]), "there are accelerations")
        expect(abs(times[-1] - (curve.end - curve.start)) < 1e-9, "the last point is not at the end")
        for time in np.linspace(0.0, times[-1], 400)[1:-1]:
            # What joint_trajectory_controller does between two points with positions and velocities.
            k = int(np.searchsorted(times, time, side="right") - 1)
            h, s = times[k + 1] - times[k], time - times[k]
            by = positions[k + 1] - positions[k]
            two = (3 * by - h * (2 * velocities[k] + velocities[k + 1])) / h**2
            three = (-2 * by + h * (velocities[k] + velocities[k + 1])) / h**3
            value = positions[k] + velocities[k] * s + two * s**2 + three * s**3
            rate = velocities[k] + 2 * two * s + 3 * three * s**2
            wanted = curve.at(curve.start + time)[:2, [curve.column[name] for name in names]]
            off["ros positions"] = max(off["ros positions"], apart(value, wanted[0]))
            # Both times are rounded to nanoseconds, which changes slopes of short pieces.
            rounding = 4e-9 / h * (np.abs(velocities[k]) + np.abs(velocities[k + 1]) + np.abs(by) / h)
            off["ros velocities"] = max(off["ros velocities"], float((np.abs(rate - wanted[1]) - rounding).max()))
        if "multi_dof_joint_trajectory" in entry:
            check_root(curve, entry, off)
    told = []
    wanted = [(curve.start, "grasp", *item) for item in curve.held(curve.segments[0])] + curve.events()
    expect(len(message["events"]) == len(wanted), f"{len(message['events'])} events instead of {wanted}")
    # Times of ROS are rounded: an instant earlier another segment would answer.
    for event, (time, *_) in zip(message["events"], wanted):
        attached = event["attached_collision_object"]
        kind = {("attach", 0): "grasp", ("detach", 1): "release"}[event["type"], attached["object"]["operation"]]
        link = f"{event['robot']}/{attached['link_name']}"
        expect(link == curve.file["documents"]["grippers"][event["gripper"]]["link"], f"{link} is no gripper's link")
        expect(attached["link_name"] in attached["touch_links"], "a gripper does not touch what it holds")
        pose = attached["object"]["pose"]
        for name, position in zip(event["fingers"]["name"], event["fingers"]["position"], strict=True):
            stands = curve.joint(f"{event['robot']}/{name}", time + event["dwell"])[0]
            off["ros fingers"] = max(off.get("ros fingers", 0.0), abs(position - stands))
        row = np.array([pose["position"][axis] for axis in "xyz"] + [pose["orientation"][axis] for axis in "xyzw"])
        off["ros objects"] = max(off.get("ros objects", 0.0), pose_apart(row, curve.roots(time)[attached["object"]["id"]]))
        told.append((seconds(event["time_from_start"]), kind, attached["object"]["id"], event["gripper"], event["handle"]))
    expect([event[1:] for event in told] == [event[1:] for event in wanted], f"events {told} instead of {wanted}")
    expect(apart([t[0] for t in told], [t[0] - curve.start for t in wanted]) < 1e-9, "events are at other times")
    return off


def check_root(curve: Curve, entry: dict, off: dict[str, float]) -> None:
    """Poses and twists of a root that moves; angular velocities against differences of rotations."""
    name, trajectory = entry["robot"], entry["multi_dof_joint_trajectory"]
    expect(trajectory["joint_names"] == [name], "a root of another name")
    base = Poses.from_array(curve.parts[name][0]["world_from_root"]) if curve.parts[name][0]["root"] == "planar" else Poses.identity()
    numbers = lambda value: np.array([value[axis] for axis in "xyzw" if axis in value])
    pose_at = lambda time: base.inverse() @ curve.written_root(name, curve.at(time)[0])
    step = 1e-5
    for point in trajectory["points"]:
        time = curve.start + seconds(point["time_from_start"])
        [transform], [twist] = point["transforms"], point["velocities"]
        row = np.concatenate([numbers(transform["translation"]), numbers(transform["rotation"])])
        off["ros roots"] = max(off.get("ros roots", 0.0), pose_apart(row, pose_at(time)))
        if curve.start + step < time < curve.end - step:
            before, after = pose_at(time - step), pose_at(time + step)
            turn = after.rotation @ before.rotation.T
            angular = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / (4 * step)
            linear = (after.translation - before.translation) / (2 * step)
            wrong = max(apart(numbers(twist["angular"]), angular), apart(numbers(twist["linear"]), linear))
            off["ros twists"] = max(off.get("ros twists", 0.0), wrong)


def frames_of(message: dict) -> dict[str, tuple[str, Poses]]:
    """Parent and pose in it by frame."""
    frames = {}
    for transform in message["transforms"]:
        numbers = [transform[key][axis] for key, axes in (("translation", "xyz"), ("rotation", "xyzw")) for axis in axes]
        expect(abs(float(np.linalg.norm(numbers[3:])) - 1.0) < 1e-9, "a rotation is not of length 1")
        frames[transform["child_frame_id"]] = (transform["parent_frame_id"], Poses.from_array(numbers))
    return frames


def in_world(frames: dict, name: str) -> Poses:
    parent, pose = frames[name]
    return pose if parent == "world" else in_world(frames, parent) @ pose


def check_mcap(curve: Curve, file: Path, rate: float) -> dict[str, float]:
    off = {"mcap joints": 0.0, "mcap transforms": 0.0}
    times = times_of(curve, rate)
    chosen, seen, events, still = set(some(times)), {}, [], {}
    with file.open("rb") as stream:
        reader = make_reader(stream)
        for schema, channel, record in reader.iter_messages():
            expect((channel.message_encoding, schema.encoding) == ("json", "jsonschema"), "not in JSON")
            json.loads(schema.data)
            index = seen[channel.topic] = seen.get(channel.topic, -1) + 1
            message = json.loads(record.data)
            if channel.topic == "/events":
                events.append((message["kind"], message["object"], message["gripper"], message["handle"]))
                continue
            if channel.topic == "/tf_static":
                still = frames_of(message)
                continue
            if index not in chosen:
                continue
            expect(abs(record.log_time * 1e-9 - (times[index] - curve.start)) < 1e-9, "a message at another time")
            if channel.topic == "/tf":
                expect(schema.name == "foxglove.FrameTransforms", schema.name)
                wanted, frames = curve.links(times[index]), still | frames_of(message)
                for name, pose in wanted.items():
                    found = in_world(frames, name)
                    wrong = max(apart(found.rotation, pose.rotation), apart(found.translation, pose.translation))
                    off["mcap transforms"] = max(off["mcap transforms"], wrong)
            else:
                expect(schema.name == "sensor_msgs/JointState", schema.name)
                robot = channel.topic.split("/")[1]
                rows = np.array([curve.joint(f"{robot}/{name}", times[index]) for name in message["name"]])
                off["mcap joints"] = max(off["mcap joints"], apart(message["position"], rows[:, 0]))
                off["mcap joints"] = max(off["mcap joints"], apart(message["velocity"], rows[:, 1]) / (1.0 + np.abs(rows[:, 1]).max()))
    expect(seen["/tf"] == len(times) - 1, "other numbers of samples")
    expect(events == [event[1:] for event in curve.events()], f"events {events}")
    return off


def check_glb(curve: Curve, file: Path, rate: float) -> dict[str, float]:
    content = file.read_bytes()
    length = struct.unpack_from("<I", content, 12)[0]
    document, binary = json.loads(content[20:20 + length]), content[28 + length:]

    def read(accessor: int) -> np.ndarray:
        entry = document["accessors"][accessor]
        view = document["bufferViews"][entry["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[entry["type"]]
        numbers = np.frombuffer(binary, "<f4", entry["count"] * width, view["byteOffset"]).astype(float)
        return numbers.reshape(-1, width)

    nodes = document["nodes"]
    parents = {child: index for index, node in enumerate(nodes) for child in node.get("children", [])}
    animated, seconds = {}, None
    for animation in document.get("animations", []):
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            seconds = read(sampler["input"])[:, 0]
            animated[channel["target"]["node"], channel["target"]["path"]] = read(sampler["output"])
    times = times_of(curve, rate)
    expect(seconds is not None and apart(seconds, times - curve.start) < 1e-5, "samples at other times")
    up = Poses.from_array([0, 0, 0, np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
    off = 0.0
    for index in some(times):
        wanted = curve.links(times[index])
        placed = {}

        def place(number: int) -> Poses:
            if number not in placed:
                node = nodes[number]
                value = lambda path, usual: animated[number, path][index] if (number, path) in animated else node.get(path, usual)
                own = Poses.from_array(np.concatenate([value("translation", [0.0] * 3), value("rotation", [0.0, 0.0, 0.0, 1.0])]))
                placed[number] = place(parents[number]) @ own if number in parents else own
            return placed[number]

        for number, node in enumerate(nodes):
            if node["name"] in wanted:
                found, pose = up @ place(number), wanted[node["name"]]
                off = max(off, apart(found.rotation, pose.rotation), apart(found.translation, pose.translation))
    expect(any("mesh" in node for node in nodes), "nothing is to be seen")
    return {"glb poses": off}


def main() -> int:
    path, folder = Path(sys.argv[1]), Path(sys.argv[2])
    rate = float(sys.argv[4]) if len(sys.argv) > 4 else 100.0
    curve = Curve(path)
    off = check_npz(curve, folder / "all.npz", rate) | check_csv(curve, folder / "all.csv", rate)
    off |= check_ros(curve, folder) | check_mcap(curve, folder / "all.mcap", rate)
    off |= check_glb(curve, folder / "all.glb", rate)
    print(json.dumps(off))
    wrong = {what: value for what, value in off.items() if not value <= ALLOWED.get(what, EXACT)}
    expect(not wrong, f"too far off: {wrong}")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Different as error:
        print(f"{sys.argv[1]}: {error}", file=sys.stderr)
        sys.exit(1)
