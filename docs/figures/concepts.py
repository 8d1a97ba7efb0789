"""The figures of concepts.md. They are sketches: nothing in them is measured."""

from math import cos, pi, sin

from svg import BLUE, GREEN, GREY, INK, ORANGE, RED, TINTS, Figure


def leaf_at(x, y, width, bend):
    """A leaf as a curve from left to right, for t from 0 to 1."""
    return lambda t: (x + width * t, y - bend * sin(pi * t))


def sheet(figure, x, y, width, levels, bend, fill, colour, spread=34):
    """A state as a stack of leaves; returns them from the lowest to the highest."""
    leaves = [leaf_at(x, y - spread * i, width, bend) for i in range(levels)]
    low, high = leaves[0], leaves[-1]
    steps = [i / 40 for i in range(41)]
    edge = [low(t) for t in steps] + [high(t) for t in reversed(steps)]
    figure.polygon([(px, py + 12 if i <= 40 else py - 12) for i, (px, py) in enumerate(edge)], fill)
    for leaf in leaves:
        figure.curve(leaf, 0, 1, colour=colour, thick=1.2)
    return leaves


def state_and_leaf(place):
    figure = Figure(720, 300, "A state, its leaves, and motions that stay on them")
    leaves = sheet(figure, 60, 235, 400, 5, 30, TINTS[0], BLUE)
    names = ["box at y = 0.0 m", "box at y = 0.1 m", "box at y = 0.2 m", "box at y = 0.3 m", "box at y = 0.4 m"]
    for leaf, name in zip(leaves, names):
        figure.text(leaf(1)[0] + 10, leaf(1)[1] + 4, name, 12, BLUE)
    for leaf, start, end in ((leaves[1], 0.15, 0.62), (leaves[3], 0.35, 0.85)):
        figure.curve(leaf, start, end, colour=ORANGE, thick=3.5, arrow=True)
        figure.dot(*leaf(start), 5, ORANGE)
    figure.text(60, 30, "State “the box lies on the table”", 15, bold=True)
    figure.text(60, 50, "All configurations in which it lies there. Each curve is a leaf: one place of the box.", 12)
    figure.text(60, 280, "Orange: motions of the arm. The box does not move, so each motion stays on its leaf.", 12, ORANGE)
    figure.save(place / "state-and-leaf.svg")


def transition(place):
    figure = Figure(720, 330, "A transition with its waypoints and legs")
    figure.text(30, 28, "Transition “the hand grasps the box”: three legs, two waypoints", 15, bold=True)
    figure.box(30, 50, 400, 180, TINTS[0], BLUE)
    figure.text(42, 72, "state: the box lies on the table", 12, BLUE)
    figure.box(340, 70, 350, 180, TINTS[1], ORANGE)
    figure.marks[-1] = figure.marks[-1].replace("fill='#fde7d3'", "fill='#fde7d3' fill-opacity='0.7'")
    figure.text(682, 242, "state: the hand holds the box", 12, ORANGE, "end")
    knots = [(90, 195, "q"), (250, 110, "waypoint:\npre-grasp"), (385, 150, "waypoint:\ngrasp"), (600, 110, "end: on a leaf\nof the target")]
    for (ax, ay, _), (bx, by, _), colour, name in zip(knots, knots[1:], (BLUE, BLUE, ORANGE), ("leg 1", "leg 2", "leg 3")):
        figure.line([(ax, ay), (bx, by)], colour, 3, arrow=True)
        figure.text((ax + bx) / 2 - 8, (ay + by) / 2 - 10, name, 12, colour, "end" if name == "leg 1" else "middle")
    for x, y, name in knots:
        figure.dot(x, y, 5.5, INK)
        figure.text(x, y + 22, name, 12, anchor="middle")
    figure.text(30, 275, "Leg 1 and leg 2 stay on a leaf of the first state: the box lies where it lies.", 12)
    figure.text(30, 293, "Leg 3 stays on a leaf of the second state: the hand holds the box as it holds it.", 12)
    figure.text(30, 311, "The waypoint “grasp” is in both states.", 12)
    figure.save(place / "transition.svg")


def crossed(place):
    figure = Figure(720, 400, "Crossed foliation: without and with rendezvous")
    for shift, title in ((0, "Projected anywhere"), (360, "With a rendezvous")):
        figure.text(24 + shift, 28, title, 15, bold=True)
        leaves = sheet(figure, 40 + shift, 310, 220, 5, 14, TINTS[0], BLUE, 50)
        start, goal = leaves[0], leaves[3]
        figure.curve(start, 0.1, 0.75, colour=GREEN, thick=3.2)
        figure.dot(*start(0.1), 5, GREEN)
        figure.text(start(1)[0] + 6, start(1)[1] + 4, "start tree", 12, GREEN)
        figure.curve(goal, 0.2, 0.9, colour=ORANGE, thick=3.2)
        figure.dot(*goal(0.9), 5, ORANGE)
        figure.text(goal(1)[0] + 6, goal(1)[1] + 4, "goal tree", 12, ORANGE)
        target = leaves[1] if shift == 0 else leaves[3]
        at = 0.5 if shift == 0 else 0.4
        figure.line([start(0.6), (start(0.6)[0] + 26, (start(0.6)[1] + target(at)[1]) / 2), target(at)], GREY, 1.6, "5 4", arrow=True)
        figure.dot(*target(at), 5, INK)
    figure.text(24, 366, "The box is put down at a random place:\na leaf that the goal tree has never reached.", 12)
    figure.text(384, 366, "The values of the placement come from a leaf\nof the other tree: both are now on one leaf.", 12)
    figure.text(24, 50, "Leaves: places of the box. Dashed: the box is carried.", 12, GREY)
    figure.text(384, 50, "The target leaf is drawn first, then solved for.", 12, GREY)
    figure.save(place / "crossed-foliation.svg")


def certificate(place):
    figure = Figure(720, 350, "A certificate: intervals that cover a motion")
    left, right, top, bottom = 70, 690, 70, 290
    across = lambda t: left + (right - left) * t
    distance = lambda t: 0.09 + 0.055 * cos(2 * pi * t) + 0.012 * sin(6 * pi * t)
    up = lambda d: bottom - (bottom - top) * d / 0.17
    rate, margin = 0.9, 0.01
    figure.text(24, 28, "How one pair of shapes is certified along a motion", 15, bold=True)
    figure.line([(left, top), (left, bottom), (right, bottom)], GREY, 1.2)
    figure.text(right, bottom + 18, "time of the motion", 12, GREY, "end")
    figure.text(left - 4, top - 12, "distance", 12, GREY, "middle")
    covered = 0.0
    while covered < 1.0:
        # The sample whose interval begins where the last one ended: distance(t) - margin = rate * (t - covered).
        low, high = covered, 1.0 + (1.0 - covered)
        for _ in range(60):
            middle = (low + high) / 2
            if distance(min(middle, 1.0)) - margin > rate * (middle - covered):
                low = middle
            else:
                high = middle
        at = min(low, 1.0)
        reach = (distance(at) - margin) / rate
        begin, end = max(at - reach, 0.0), min(at + reach, 1.0)
        cone = [(begin, distance(at) - rate * (at - begin)), (at, distance(at)), (end, distance(at) - rate * (end - at))]
        shape = [(across(begin), bottom)] + [(across(t), up(d)) for t, d in cone] + [(across(end), bottom)]
        figure.polygon(shape, TINTS[2], GREEN, 0.8)
        figure.dot(across(at), up(distance(at)), 4.5, GREEN)
        covered = at + reach
    figure.curve(lambda t: (across(t), up(distance(t))), 0, 1, 160, colour=INK, thick=2.2)
    figure.line([(left, up(margin)), (right, up(margin))], RED, 1.4, "6 4")
    figure.text(right - 4, up(margin) - 6, "margin", 12, RED, "end")
    figure.text(across(0.2), up(distance(0.2)) - 10, "true distance", 12)
    figure.text(left, 322, "Dots: measured distances. Green: what each one proves, since the pair cannot come closer faster than", 12)
    figure.text(left, 339, "its motion bound. The motion is certified where the green regions cover all of it above the margin.", 12)
    figure.save(place / "certificate.svg")


def draw(place):
    for figure in (state_and_leaf, transition, crossed, certificate):
        figure(place)
