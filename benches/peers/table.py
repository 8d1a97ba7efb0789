"""The table of both planners: medians, ratios, and what was found when the answers were proved."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from statistics import median

from check_file import VALID, Verdicts
from rows import FOLIATE, Row, read_rows
from schedule import CONTROL, MAIN
from settings import BIRRT, CANNOT_STATE, DIFFUSING, MRRT, SCENES, SPF

TITLES = {MRRT: "M-RRT", SPF: "StatesPathFinder", DIFFUSING: "Diffusing", BIRRT: "BiRRT"}
SHORT_S = 1.0
"""Where HPP needs less than this,"""
REQUIRED, REQUIRED_WHERE_SHORT = 50.0, 20.0
"""a smaller ratio is required."""


@dataclass(frozen=True)
class Summary:
    """Solves of one solver on one scene. Times (s) of those that are not solved are the limit; `median_s` counts every
    answer, `valid_median_s` only those that were not found wrong; the flags say that the median is such a limit. `whole_s`
    counts reading the models and building the problem too."""

    runs: int
    solved: int
    wrong: int
    crashed: int
    unproved: int
    low_s: float
    high_s: float
    median_s: float
    valid_median_s: float
    at_limit: bool
    valid_at_limit: bool
    whole_s: float


def summarise(rows: list[Row], verdicts: Verdicts) -> Summary | None:
    """None without rows."""
    if not rows:
        return None
    times = [row.compared_s if row.solved else row.limit_s for row in rows]
    good = [row.solved and verdicts.of(row) in (None, VALID) for row in rows]
    valid = [time if fine else row.limit_s for time, fine, row in zip(times, good, rows)]
    solved = sum(row.solved for row in rows)
    return Summary(
        runs=len(rows), solved=solved, wrong=solved - sum(good),
        crashed=sum(row.outcome == "crashed" for row in rows),
        unproved=sum(row.solved and verdicts.of(row) is None for row in rows),
        low_s=min(times), high_s=max(times), median_s=median(times), valid_median_s=median(valid),
        at_limit=2 * solved <= len(rows), valid_at_limit=2 * sum(good) <= len(rows),
        whole_s=median(time + row.setup_s for time, row in zip(times, rows)),
    )


@dataclass(frozen=True)
class Ratio:
    """HPP's better median over Foliate's; `at_least` where HPP's is the limit."""

    value: float
    at_least: bool
    required: float

    def __str__(self) -> str:
        text = f"{'≥ ' if self.at_least else ''}{self.value:.{0 if self.value >= 10.0 else 1}f}"
        return text if self.value >= self.required else f"**{text}** (short)"


def ratio(hpp: list[Summary], foliate: Summary, valid_only: bool) -> Ratio:
    """Of the solver whose median is smaller; required is less where it needs under a second."""
    better = min(hpp, key=lambda known: known.valid_median_s if valid_only else known.median_s)
    above = better.valid_median_s if valid_only else better.median_s
    below = foliate.valid_median_s if valid_only else foliate.median_s
    at_least = better.valid_at_limit if valid_only else better.at_limit
    return Ratio(above / below, at_least, REQUIRED_WHERE_SHORT if above < SHORT_S else REQUIRED)


def newest(rows: list[Row]) -> list[Row]:
    """One row per solver and seed: the last of the version that was run last."""
    if not rows:
        return []
    version = rows[-1].version
    return list({(row.solver, row.seed): row for row in rows if row.version == version}.values())


def markdown(results: Path) -> str:
    """The table of `results`, with what must be known to read it."""
    rows = read_rows(results / "rows.csv")
    verdicts = Verdicts(results / "checks.csv")
    main = [row for row in rows if row.series == MAIN]
    lines = [
        "| scene | HPP M-RRT | HPP StatesPathFinder | Foliate | ratio | ratio, valid only | required | from files |",
        "| :-- | :-- | :-- | :-- | --: | --: | --: | --: |",
    ]
    for scene in SCENES:
        if line := _line(scene, [row for row in main if row.scene == scene], verdicts):
            lines.append(line)
    return "\n".join([*lines, "", *_about(rows, main, verdicts)])


def _line(scene: str, rows: list[Row], verdicts: Verdicts) -> str | None:
    foliate = summarise(newest([row for row in rows if row.solver == FOLIATE]), verdicts)
    solvers = SCENES[scene].solvers
    hpp = {solver: summarise(newest([row for row in rows if row.solver == solver]), verdicts) for solver in solvers}
    known = [summary for summary in hpp.values() if summary]
    if foliate is None or not known:
        return None
    cells = [_cell(hpp[solver], "" if solver in (MRRT, SPF) else f"{TITLES[solver]}: ") for solver in solvers]
    cells += ["–"] * (2 - len(cells))
    ratios = [ratio(known, foliate, valid_only) for valid_only in (False, True)]
    whole = f"{_seconds(min(summary.whole_s for summary in known))} / {_seconds(foliate.whole_s)}"
    cells += [_cell(foliate, ""), str(ratios[0]), str(ratios[1]), f"{ratios[0].required:.0f}", whole]
    return f"| {' | '.join([scene, *cells])} |"


def _cell(summary: Summary | None, title: str) -> str:
    """Solved of runs, what was wrong, then min / median / max in seconds; a median that is the limit has a `>`."""
    if summary is None:
        return "–"
    marks = [f"{summary.wrong} wrong"] * bool(summary.wrong) + [f"{summary.crashed} crashed"] * bool(summary.crashed)
    count = f"{summary.solved}/{summary.runs}" + (f" ({', '.join(marks)})" if marks else "")
    middle = (">" if summary.at_limit else "") + _seconds(summary.median_s)
    return f"{title}{count}: {_seconds(summary.low_s)} / **{middle}** / {_seconds(summary.high_s)}"


def _seconds(value: float) -> str:
    return f"{value:.3g}"


def _about(rows: list[Row], main: list[Row], verdicts: Verdicts) -> list[str]:
    versions = sorted({row.version for row in main if row.solver != FOLIATE})
    foliate = [row for row in main if row.solver == FOLIATE]
    machines = sorted({row.machine for row in main})
    days = sorted({row.date[:10] for row in main})
    limits = sorted({row.limit_s for row in main})
    unproved = sum(row.solved and verdicts.of(row) is None for row in main)
    lines = [
        f"Machine: {'; '.join(machines)}; {' to '.join(sorted({days[0], days[-1]}))}; one core, others busy. "
        f"{', '.join(versions)}; {foliate[-1].version if foliate else 'no Foliate'}.",
        "Cells: solved/runs: min / **median** / max, seconds; a solve that gave no answer counts as the limit "
        f"({', '.join(f'{limit:g}' for limit in limits)} s), `>` marks a median that is the limit.",
        "HPP: processor time of the solve, its graph already built. Foliate: wall time from the loaded problem, graph "
        "building included, or processor time of the whole process where that is less. Last column: medians with reading models and building the problem (HPP / Foliate, s).",
    ]
    if unproved:
        lines.append(f"{unproved} answers are not proved yet, and count as valid.")
    lines += _speed(rows)
    lines += ["", "Not in the table:", ""]
    lines += [f"* {scene}: {why}" for scene, why in CANNOT_STATE.items()]
    return lines


def _speed(rows: list[Row]) -> list[str]:
    """What repeated solves say about the machine: the same search's time then and before."""
    before = {(row.scene, row.solver, row.seed): row for row in rows if row.series == MAIN and row.solved}
    factors: dict[str, list[float]] = {}
    for row in rows:
        first = before.get((row.scene, row.solver, row.seed))
        if row.series.startswith(CONTROL) and row.solved and first:
            factors.setdefault(row.series, []).append(row.solve_s / first.solve_s)
    return [f"Beside the rows of {series.removeprefix(CONTROL).strip() or 'Foliate'}, {len(known)} solves of HPP were "
            f"repeated: they took {median(known):.2f} times as long as at first."
            for series, known in factors.items()]
