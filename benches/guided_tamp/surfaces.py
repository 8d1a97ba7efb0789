"""Contact surfaces of an SRDF text: polygons that are bent are made flat, as HPP does when it reads them.

HPP takes the plane through the mean of a polygon's corners whose normal is the cross product of its first two sides.
The package's start and goal poses lie on these planes, and not on planes of least squares.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np

BENT = 1e-5
"""A corner that is farther from its plane than this (metres) is moved onto it."""


def flattened(polygon: np.ndarray) -> np.ndarray:
    """The corners of one polygon (n x 3, metres), each moved onto the plane that HPP uses."""
    centre = polygon.mean(axis=0)
    normal = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[1])
    normal /= np.linalg.norm(normal)
    return polygon - np.outer((polygon - centre) @ normal, normal)


def bend(polygon: np.ndarray) -> float:
    """How far the corners are moved at most (metres)."""
    return float(np.abs(flattened(polygon) - polygon).max())


def polygons(contact: ET.Element) -> list[np.ndarray]:
    """The polygons of a `<contact>`: `<point>` holds three numbers a point, `<shape>` a count and that many indices."""
    points = np.array(contact.find("point").text.split(), dtype=float).reshape(-1, 3)
    indices = [int(word) for word in contact.find("shape").text.split()]
    found = []
    while indices:
        count, indices = indices[0], indices[1:]
        found.append(points[indices[:count]])
        indices = indices[count:]
    return found


def flatten_srdf(text: str, links: set[str]) -> tuple[str, list[str]]:
    """The SRDF with flat polygons and without collision pairs of links that are not in `links`. Also says what changed.

    Polygons that share corners are given corners of their own where one of them is bent.
    """
    root = ET.fromstring(text)
    changes = []
    for contact in root.iter("contact"):
        known = polygons(contact)
        worst = max(bend(polygon) for polygon in known)
        if worst > BENT:
            _write(contact, [flattened(polygon) for polygon in known])
            changes.append(f"{contact.get('name')}: polygons bent by up to {1e3 * worst:.2f} mm made flat")
    for pair in list(root.findall("disable_collisions")):
        unknown = [name for name in (pair.get("link1"), pair.get("link2")) if name not in links]
        if unknown:
            root.remove(pair)
            changes.append(f"disable_collisions of {unknown[0]}, which is no link, removed")
    return ET.tostring(root, encoding="unicode"), changes


def _write(contact: ET.Element, flat: list[np.ndarray]) -> None:
    contact.find("point").text = " ".join(f"{value:.12g}" for polygon in flat for value in polygon.ravel())
    shapes, first = [], 0
    for polygon in flat:
        shapes += [len(polygon), *range(first, first + len(polygon))]
        first += len(polygon)
    contact.find("shape").text = " ".join(map(str, shapes))
