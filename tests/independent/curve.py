"""What coordinates do between knots, in closed form.

Without velocities they are linear. With velocities each is the cubic Hermite polynomial through both positions and both
velocities. All arrays have the shape (intervals, coordinates); the parameter of an interval goes from 0 to 1.
"""

from __future__ import annotations

import numpy as np


class Curve:
    """The polynomials q(s) = q0 + c1 s + c2 s^2 + c3 s^3 of all intervals of a segment."""

    def __init__(self, knots: np.ndarray, times: np.ndarray | None = None, velocities: np.ndarray | None = None):
        self.knots, self.is_timed = knots, velocities is not None
        change = np.diff(knots, axis=0)
        self.first, self.second, self.third = change, np.zeros_like(change), np.zeros_like(change)
        self.durations = None
        if velocities is not None:
            self.durations = np.diff(times)
            start, end = self.durations[:, None] * velocities[:-1], self.durations[:, None] * velocities[1:]
            self.first, self.second = start, 3.0 * change - 2.0 * start - end
            self.third = start + end - 2.0 * change

    def rows(self, low: np.ndarray, fraction: np.ndarray) -> np.ndarray:
        """Values (N, coordinates) at fractions (N,) of the intervals that start at knots `low` (N,)."""
        last = len(self.knots) - 1
        if last == 0:
            return self.knots[low]
        piece, s = np.minimum(low, last - 1), fraction[:, None]
        inside = self.knots[piece] + s * (self.first[piece] + s * (self.second[piece] + s * self.third[piece]))
        return np.where((low == last)[:, None] | (s == 0.0), self.knots[low], inside)

    def ranges(self) -> tuple[np.ndarray, np.ndarray]:
        """Least and greatest value of every interval; of a single knot, the knot."""
        if len(self.knots) == 1:
            return self.knots, self.knots
        low, high = np.minimum(self.knots[:-1], self.knots[1:]), np.maximum(self.knots[:-1], self.knots[1:])
        for place in self._turning_places():
            value = self.knots[:-1] + place * (self.first + place * (self.second + place * self.third))
            inside = (place > 0.0) & (place < 1.0)
            low, high = np.where(inside, np.minimum(low, value), low), np.where(inside, np.maximum(high, value), high)
        return low, high

    def _turning_places(self) -> list[np.ndarray]:
        """Where c1 + 2 c2 s + 3 c3 s^2 is zero; -1 where there is no such place."""
        a, b, c = 3.0 * self.third, self.second, self.first
        root = b * b - a * c
        large = -(b + np.copysign(np.sqrt(np.maximum(root, 0.0)), b))
        with np.errstate(divide="ignore", invalid="ignore"):
            places = [large / a, c / large]
        return [np.where((root >= 0.0) & np.isfinite(place), place, -1.0) for place in places]

    def fastest(self) -> np.ndarray:
        """Largest derivative by s: at an end, or where the second derivative is zero."""
        end = self.first + 2.0 * self.second + 3.0 * self.third
        with np.errstate(divide="ignore", invalid="ignore"):
            crest = -self.second / (3.0 * self.third)
        inside = (crest > 0.0) & (crest < 1.0)
        top = np.where(inside, np.abs(self.first + self.second * np.where(inside, crest, 0.0)), 0.0)
        return np.maximum(np.maximum(np.abs(self.first), np.abs(end)), top)

    def bends(self) -> tuple[np.ndarray, np.ndarray]:
        """Second derivatives by s at both ends; they are linear in between."""
        return 2.0 * self.second, 2.0 * self.second + 6.0 * self.third

    def norm_bounds(self, columns: list[int]) -> tuple[np.ndarray, np.ndarray]:
        """Of the vector of some columns, for each interval: a lower bound of its length, and an upper bound of the length
        of its derivative by s. Both are read from Bezier control points, the first after four cuts of the interval."""
        start, first = self.knots[:-1][:, columns], self.first[:, columns]
        second, third = self.second[:, columns], self.third[:, columns]
        speeds = [first, first + second, first + 2.0 * second + 3.0 * third]
        fastest = np.max([np.linalg.norm(speed, axis=1) for speed in speeds], axis=0)
        least = np.full(len(first), np.inf)
        for a, b in zip(np.linspace(0.0, 0.75, 4), np.linspace(0.25, 1.0, 4)):
            # The polynomial on [a, b] as one on [0, 1], and its control points.
            at = start + a * (first + a * (second + a * third))
            c1 = (b - a) * (first + a * (2.0 * second + 3.0 * a * third))
            c2, c3 = (b - a) ** 2 * (second + 3.0 * a * third), (b - a) ** 3 * third
            points = np.array([at, at + c1 / 3.0, at + (2.0 * c1 + c2) / 3.0, at + c1 + c2 + c3])
            mean = points.sum(axis=0)
            along = mean / np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-300)
            least = np.minimum(least, np.einsum("pij,ij->pi", points, along).min(axis=0))
        return least, fastest
