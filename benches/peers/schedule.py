"""Which solves, in which order: interleaved, and so that a run that is stopped leaves a thinner, but complete table."""

from __future__ import annotations

from dataclasses import dataclass

from rows import FOLIATE, Row
from settings import SCENES

MAIN, CONTROL = "main", "control"
FIRST_SEEDS = 3
"""All scenes and solvers have so many seeds before any has more."""
CONTROL_LONGEST_S = 20.0
"""Solves that took longer are not repeated as a control."""


@dataclass(frozen=True)
class Solve:
    scene: str
    solver: str
    seed: int
    series: str = MAIN

    def __str__(self) -> str:
        return f"{self.scene} {self.solver} seed {self.seed}" + (f" ({self.series})" if self.series != MAIN else "")


def solves(scenes: list[str], seeds: int, only: str | None) -> list[Solve]:
    """Per scene and seed first HPP's solvers, then Foliate."""
    order = []
    for first, last in ((1, min(FIRST_SEEDS, seeds)), (FIRST_SEEDS + 1, seeds)):
        for scene in scenes:
            for seed in range(first, last + 1):
                order += [Solve(scene, solver, seed) for solver in _solvers(scene, only)]
    return order


def _solvers(scene: str, only: str | None) -> list[str]:
    hpp = list(SCENES[scene].solvers)
    return {FOLIATE: [FOLIATE], "hpp": hpp}.get(only or "", [*hpp, FOLIATE])


def controls(scenes: list[str], count: int, commit: str, known: list[Row]) -> list[Solve]:
    """The same searches again, `count` per scene, beside the rows of another build of Foliate: HPP repeats itself
    exactly, so its times tell how fast the machine is now."""
    order = []
    for scene in scenes:
        short = [row for row in known
                 if row.scene == scene and row.series == MAIN and row.solver != FOLIATE and row.solved
                 and row.solve_s <= CONTROL_LONGEST_S]
        short.sort(key=lambda row: (row.seed, row.solver))
        order += [Solve(scene, row.solver, row.seed, f"{CONTROL} {commit}".strip()) for row in short[:count]]
    return order
