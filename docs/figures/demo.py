"""The figure of the README: the constraint graph of the scene `demo`, and a path of it, leaf by leaf.

Both are what the program says: `foliate graph demo --dot` and the path file of `foliate solve demo`.
"""

import json
import re
import subprocess
import tempfile
from pathlib import Path

from svg import BLUE, GREEN, GREY, LIGHT, ORANGE, PALE, TINTS, Figure

# Where each state stands, in pixels.
CENTRES = {
    "free": (95, 190),
    "robot/left_hand grasps box1/top": (330, 70),
    "robot/right_hand grasps box2/top": (330, 150),
    "robot/right_hand grasps box1/top": (330, 230),
    "robot/left_hand grasps box2/top": (330, 310),
    "robot/left_hand grasps box1/top : robot/right_hand grasps box2/top": (590, 110),
    "robot/left_hand grasps box2/top : robot/right_hand grasps box1/top": (590, 270),
}
LABELS = {
    "free": "both boxes\non the table",
    "robot/left_hand grasps box1/top": "left hand: box 1",
    "robot/right_hand grasps box2/top": "right hand: box 2",
    "robot/right_hand grasps box1/top": "right hand: box 1",
    "robot/left_hand grasps box2/top": "left hand: box 2",
    "robot/left_hand grasps box1/top : robot/right_hand grasps box2/top": "left hand: box 1\nright hand: box 2",
    "robot/left_hand grasps box2/top : robot/right_hand grasps box1/top": "left hand: box 2\nright hand: box 1",
}
HALF = {name: (64, 26) if name == "free" or " : " in name else (66, 18) for name in CENTRES}


def graph(program):
    """Names of the states, and (from, to, style) of the transitions."""
    dot = subprocess.run([program, "graph", "demo", "--dot"], check=True, capture_output=True, text=True).stdout
    states = [m.split("\\n")[0] for m in re.findall(r"s\d+ \[label=\"([^\"]*)\"\]", dot)]
    found = re.findall(r"s(\d+) -> s(\d+) \[style=(\w+),", dot)
    assert set(states) == set(CENTRES), "the scene has other states than this figure"
    return states, [(states[int(a)], states[int(b)], style) for a, b, style in found]


def path(program, seed):
    """The path file of a solve."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "demo.json"
        command = [program, "solve", "demo", "--seed", str(seed), "--out", str(out), "--json"]
        subprocess.run(command, check=True, capture_output=True)
        return json.loads(out.read_text())


def border(name, towards):
    """Where the line from a state's middle to a point leaves its box."""
    (x, y), (w, h) = CENTRES[name], HALF[name]
    dx, dy = towards[0] - x, towards[1] - y
    shrink = min(w / abs(dx) if dx else 9e9, h / abs(dy) if dy else 9e9)
    return x + dx * shrink, y + dy * shrink


def draw_graph(figure, states, transitions, visited):
    pairs = set()
    for a, b, style in transitions:
        if a == b:
            continue
        (ax, ay), (bx, by) = CENTRES[a], CENTRES[b]
        if style == "dashed":
            # Beside the regular ones, and only towards the side that the crossed transition leads to.
            length = ((bx - ax) ** 2 + (by - ay) ** 2) ** 0.5
            sx, sy = 9 * (by - ay) / length, -9 * (bx - ax) / length
            start, end = border(a, (bx + sx, by + sy)), border(b, (ax + sx, ay + sy))
            figure.line([(start[0] + sx, start[1] + sy), (end[0] + sx, end[1] + sy)], BLUE, 1.3, "5 4", arrow=True)
        elif (b, a) not in pairs:
            pairs.add((a, b))
            figure.line([border(a, (bx, by)), border(b, (ax, ay))], GREY, 1.3, arrow=True, arrow_back=True)
    for a, b in zip(visited, visited[1:]):
        figure.line([border(a, CENTRES[b]), border(b, CENTRES[a])], ORANGE, 3.5, arrow=True)
    for name in states:
        (x, y), (w, h) = CENTRES[name], HALF[name]
        on_path = name in visited
        figure.box(x - w, y - h, 2 * w, 2 * h, PALE if not on_path else TINTS[1], ORANGE if on_path else GREY, 1.6)
        lines = LABELS[name].split("\n")
        figure.text(x, y + 5 - 8 * (len(lines) - 1), LABELS[name], 13, anchor="middle")


def columns(file):
    return [file["coordinates"].index(f"{box}/y") for box in ("box1", "box2")]


def draw_path(figure, file):
    left, right, top, bottom = 90, 650, 432, 590
    segments = file["segments"]
    count = len(segments)
    across = lambda t: left + (right - left) * t / count
    lowest, highest = -0.24, 0.24
    up = lambda y: bottom - (bottom - top) * (y - lowest) / (highest - lowest)
    begin = 0
    for index in range(1, count + 1):
        if index == count or segments[index]["state"] != segments[begin]["state"]:
            state = segments[begin]["state"]
            tint = TINTS[0] if state == "free" else TINTS[2] if " : " in state else TINTS[1]
            figure.box(across(begin), top, across(index) - across(begin), bottom - top, tint, "white", 1.0, 0)
            words = "\n".join(LABELS[state].replace(" hand", "").split("\n"))
            words = "on the table" if state == "free" else words
            figure.text((across(begin) + across(index)) / 2, top - 22 if "\n" in words else top - 8, words, 11, anchor="middle")
            begin = index
    for value in (-0.2, -0.1, 0.0, 0.1, 0.2):
        figure.line([(left, up(value)), (right, up(value))], LIGHT, 0.7)
        figure.text(left - 8, up(value) + 4, f"{value:.1f}", 11, GREY, "end")
    for column, colour, name in zip(columns(file), (GREEN, BLUE), ("box 1", "box 2")):
        knots = [(i + k / (len(s["knots"]) - 1), knot[column]) for i, s in enumerate(segments) for k, knot in enumerate(s["knots"])]
        figure.line([(across(t), up(y)) for t, y in knots], colour, 2.2)
        for t, y in knots:
            figure.dot(across(t), up(y), 2.6, colour)
        figure.text(right + 8, up(knots[-1][1]) + 4, name, 13, colour, bold=True)
    for index in range(count):
        figure.text(across(index + 0.5), bottom + 14, str(index + 1), 10, GREY, "middle")
    figure.text((left + right) / 2, bottom + 32, "motions, each on one leaf", 12, anchor="middle")
    figure.text(20, top - 24, "y at the\nknots (m)", 11, GREY)


def draw(program, place, seed=1):
    states, transitions = graph(program)
    file = path(program, seed)
    visited = []
    for segment in file["segments"]:
        if not visited or visited[-1] != segment["state"]:
            visited.append(segment["state"])
    figure = Figure(720, 640, "The constraint graph of the scene demo, and a path through it")
    figure.text(20, 26, "The constraint graph of the scene demo", 15, bold=True)
    draw_graph(figure, states, transitions, visited)
    figure.line([(425, 26), (453, 26)], GREY, 1.3, arrow=True, arrow_back=True)
    figure.text(460, 30, "transition", 11)
    figure.line([(520, 26), (548, 26)], BLUE, 1.3, "5 4", arrow=True)
    figure.text(555, 30, "crossed", 11)
    figure.line([(606, 26), (634, 26)], ORANGE, 3.5, arrow=True)
    figure.text(641, 30, f"path, seed {seed}", 11)
    figure.text(20, 378, f"A path that swaps the boxes: {len(file['segments'])} certified motions", 15, bold=True)
    draw_path(figure, file)
    figure.save(place / "demo.svg")
