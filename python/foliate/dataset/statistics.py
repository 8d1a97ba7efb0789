"""Statistics of columns, of each episode and of all."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["NUMBERS", "Statistics", "of_episodes"]

NUMBERS = ("min", "max", "mean", "std", "count")
QUANTILES = (0.01, 0.10, 0.50, 0.90, 0.99)
KEPT = 100_000
"""Most rows of which quantiles are made."""

Rows = NDArray[np.float64]


def of_episodes(values: NDArray[Any], lengths: NDArray[np.int64]) -> dict[str, Rows]:
    """The statistics of consecutive episodes of these lengths: each an array of shape (episodes, columns)."""
    rows = values.reshape(len(values), -1).astype(np.float64)
    starts = np.concatenate([[0], np.cumsum(lengths)[:-1]])
    mean = np.add.reduceat(rows, starts) / lengths[:, None]
    # Of the distances from the mean: squares of large numbers would lose what is small.
    variance = np.add.reduceat((rows - np.repeat(mean, lengths, axis=0)) ** 2, starts) / lengths[:, None]
    return {
        "min": np.minimum.reduceat(rows, starts),
        "max": np.maximum.reduceat(rows, starts),
        "mean": mean,
        "std": np.sqrt(variance),
        "count": lengths[:, None],
    }


class Statistics:
    """The statistics of a column that comes in pieces; pieces are joined as by Chan, Golub and LeVeque (1979)."""

    def __init__(self) -> None:
        self._count = 0
        self._sample: list[Rows] = []
        self._stride = 1

    def add(self, values: NDArray[Any]) -> None:
        """Adds rows."""
        rows = values.reshape(len(values), -1).astype(np.float64)
        count, mean = len(rows), rows.mean(axis=0)
        squares = ((rows - mean) ** 2).sum(axis=0)
        if self._count == 0:
            self._min, self._max, self._mean, self._squares = rows.min(axis=0), rows.max(axis=0), mean, squares
        else:
            self._min, self._max = np.minimum(self._min, rows.min(axis=0)), np.maximum(self._max, rows.max(axis=0))
            apart, total = mean - self._mean, self._count + count
            self._squares = self._squares + squares + apart**2 * self._count * count / total
            self._mean = self._mean + apart * count / total
        first = -self._count % self._stride
        # A view would keep all rows.
        self._sample.append(rows[first :: self._stride].copy())
        self._count += count
        while sum(map(len, self._sample)) > KEPT:
            # Every second row of what is kept: whole rows at a doubled stride.
            self._sample, self._stride = [np.concatenate(self._sample)[::2].copy()], 2 * self._stride

    def told(self) -> dict[str, list[float] | list[int]]:
        """All numbers, as LeRobot names them. Quantiles are of every so many rows where there are more than 100,000."""
        quantiles = np.quantile(np.concatenate(self._sample), QUANTILES, axis=0)
        told: dict[str, list[float] | list[int]] = {
            "min": self._min.tolist(),
            "max": self._max.tolist(),
            "mean": self._mean.tolist(),
            "std": np.sqrt(self._squares / self._count).tolist(),
            "count": [self._count],
        }
        return told | {f"q{round(100 * q):02d}": row.tolist() for q, row in zip(QUANTILES, quantiles, strict=True)}
