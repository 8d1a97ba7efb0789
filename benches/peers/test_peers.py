"""The comparison's own logic, without HPP: what is run, what is kept, what is divided by what."""

from __future__ import annotations

import dataclasses
import json
import os
import sys
import tempfile
import time
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import schedule  # noqa: E402
import table  # noqa: E402
from check_file import COLUMNS as CHECK_COLUMNS  # noqa: E402
from check_file import Verdicts  # noqa: E402
from rows import Results, ResultsError, Row, append, read_rows  # noqa: E402
from scene_file import SceneError, read_scene  # noqa: E402
from settings import CANNOT_STATE, SCENES  # noqa: E402
from watch import watch  # noqa: E402

SCENES_FOLDER = HERE.parents[1] / "scenes"
ROW = Row("demo", "spf", 1, "main", "solved", 2.0, 2.0, 2.5, 0.5, 60.0, 10, 4, 1.5, "", "hpp-python 9.0.2", "a machine",
          "2026-01-01T00:00:00", "demo/spf-1.npz")


def found(verdicts: dict[Row, str]) -> Verdicts:
    known = Verdicts()
    known.known = {one.key: (one.date, verdict) for one, verdict in verdicts.items()}
    return known


def row(**values) -> Row:
    return dataclasses.replace(ROW, **values)


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.file = self.folder / "rows.csv"


class ResultsAreKept(Folder):
    def test_rows_come_back_as_they_were(self):
        rows = [ROW, row(seed=2, outcome="failed", nodes=None, segments=None, length=None,
                         reason='gave up, "tired" at last')]
        results = Results(self.file)
        results.add(rows[0])
        results.add(dataclasses.replace(rows[1], reason='gave up, "tired"\nat last'))
        self.assertEqual(read_rows(self.file), rows)
        self.assertEqual(len(self.file.read_text().splitlines()), 3)

    def test_an_interrupted_line_is_made_again(self):
        Results(self.file).add(ROW)
        whole = self.file.read_bytes()
        Results(self.file).add(row(seed=2))
        self.file.write_bytes(self.file.read_bytes()[:-7])
        results = Results(self.file)
        self.assertEqual(results.rows, [ROW])
        self.assertFalse(results.has(row(seed=2).key))
        results.add(row(seed=3))
        self.assertEqual(read_rows(self.file), [ROW, row(seed=3)])
        self.assertTrue(self.file.read_bytes().startswith(whole))

    def test_another_version_is_another_solve(self):
        Results(self.file).add(row(solver="foliate", version="foliate 0.1.0 aaa"))
        results = Results(self.file)
        self.assertTrue(results.has(("demo", "foliate", 1, "main", "foliate 0.1.0 aaa")))
        self.assertFalse(results.has(("demo", "foliate", 1, "main", "foliate 0.1.0 bbb")))

    def test_a_file_that_is_something_else_is_refused(self):
        self.file.write_text("a,b\n1,2\n")
        with self.assertRaises(ResultsError):
            Results(self.file)

    def test_a_number_that_is_none_is_told_with_its_line(self):
        Results(self.file).add(ROW)
        self.file.write_text(self.file.read_text().replace(",60.0,", ",soon,"))
        with self.assertRaisesRegex(ResultsError, r"rows\.csv:2"):
            read_rows(self.file)


class SolvesAreInterleaved(unittest.TestCase):
    def test_all_scenes_have_three_seeds_before_one_has_more(self):
        solves = schedule.solves(["baxter-case1", "ur3-spheres"], 10, None)
        first = [solve for solve in solves if solve.seed <= 3]
        self.assertEqual(solves[:len(first)], first)
        self.assertEqual({solve.scene for solve in first}, {"baxter-case1", "ur3-spheres"})
        self.assertEqual(len(solves), len(set(solves)), "no solve twice")
        self.assertEqual(len(solves), 2 * 10 * 3)

    def test_solvers_take_turns(self):
        solves = schedule.solves(["baxter-case1"], 2, None)
        self.assertEqual([solve.solver for solve in solves], ["mrrt", "spf", "foliate"] * 2)

    def test_only_one_planner(self):
        self.assertEqual({solve.solver for solve in schedule.solves(list(SCENES), 1, "foliate")}, {"foliate"})
        self.assertNotIn("foliate", {solve.solver for solve in schedule.solves(list(SCENES), 1, "hpp")})

    def test_controls_repeat_short_solves_beside_a_build(self):
        known = [row(scene="baxter-case1", seed=1, solve_s=59.0), row(scene="baxter-case1", seed=2),
                 row(scene="baxter-case1", seed=3, outcome="timeout"), row(scene="baxter-case1", seed=4, solver="foliate")]
        controls = schedule.controls(["baxter-case1"], 3, "abc", known)
        self.assertEqual([(solve.solver, solve.seed, solve.series) for solve in controls], [("spf", 2, "control abc")])


class MediansAndRatios(unittest.TestCase):
    def test_what_has_no_answer_counts_as_the_limit(self):
        rows = [row(seed=1, solve_s=1.0), row(seed=2, solve_s=0.1, outcome="crashed"), row(seed=3, outcome="timeout")]
        summary = table.summarise(rows, Verdicts())
        self.assertEqual((summary.median_s, summary.solved, summary.crashed), (60.0, 1, 1))
        self.assertTrue(summary.at_limit)
        self.assertFalse(table.summarise(rows[:1], Verdicts()).at_limit)

    def test_a_busy_core_costs_foliate_no_more_than_its_whole_process(self):
        busy = row(solver="foliate", solve_s=0.3, wall_s=0.3, cpu_s=0.1)
        idle = row(solver="foliate", solve_s=0.05, wall_s=0.05, cpu_s=0.1)
        self.assertEqual([table.summarise([one], Verdicts()).median_s for one in (busy, idle)], [0.1, 0.05])

    def test_half_unsolved_is_at_the_limit_too(self):
        summary = table.summarise([row(seed=1, solve_s=1.0), row(seed=2, outcome="timeout")], Verdicts())
        self.assertTrue(summary.at_limit)
        self.assertEqual(summary.median_s, 30.5)

    def test_wrong_answers_count_in_one_column_only(self):
        rows = [row(seed=seed, solve_s=float(seed)) for seed in (1, 2, 3)]
        verdicts = found({rows[0]: "collides", rows[1]: "valid"})
        summary = table.summarise(rows, verdicts)
        self.assertEqual((summary.median_s, summary.valid_median_s), (2.0, 3.0))
        self.assertEqual((summary.wrong, summary.unproved), (1, 1))

    def test_the_better_solver_is_divided_by_foliate(self):
        slow, fast = table.summarise([row(solve_s=30.0)], Verdicts()), table.summarise([row(solve_s=2.0)], Verdicts())
        foliate = table.summarise([row(solver="foliate", solve_s=0.01)], Verdicts())
        known = table.ratio([slow, fast], foliate, False)
        self.assertAlmostEqual(known.value, 200.0)
        self.assertEqual((known.required, known.at_least, str(known)), (50.0, False, "200"))

    def test_less_is_required_where_hpp_is_short(self):
        fast = table.summarise([row(solve_s=0.5)], Verdicts())
        foliate = table.summarise([row(solver="foliate", solve_s=0.05)], Verdicts())
        known = table.ratio([fast], foliate, False)
        self.assertEqual(known.required, 20.0)
        self.assertEqual(str(known), "**10** (short)")

    def test_a_limit_makes_a_lower_bound(self):
        never = table.summarise([row(outcome="timeout")], Verdicts())
        foliate = table.summarise([row(solver="foliate", solve_s=0.5)], Verdicts())
        self.assertEqual(str(table.ratio([never], foliate, False)), "≥ 120")

    def test_validity_can_change_the_better_solver(self):
        quick, sound = row(solver="spf", solve_s=1.5), row(solver="mrrt", solve_s=6.0)
        verdicts = found({quick: "collides", sound: "valid"})
        hpp = [table.summarise([quick], verdicts), table.summarise([sound], verdicts)]
        foliate = table.summarise([row(solver="foliate", solve_s=0.1)], verdicts)
        self.assertAlmostEqual(table.ratio(hpp, foliate, False).value, 15.0)
        self.assertAlmostEqual(table.ratio(hpp, foliate, True).value, 60.0)

    def test_the_last_build_and_the_last_row_count(self):
        old, new = "foliate 0.1.0 aaa", "foliate 0.1.0 bbb"
        rows = [row(solver="foliate", version=old, solve_s=9.0), row(solver="foliate", version=new, solve_s=5.0),
                row(solver="foliate", version=new, solve_s=1.0)]
        self.assertEqual([known.solve_s for known in table.newest(rows)], [1.0])


class TheTable(Folder):
    def test_a_line_per_scene_that_both_have(self):
        results = Results(self.file)
        for solver, seconds in (("mrrt", 60.0), ("spf", 3.0), ("foliate", 0.03)):
            outcome = "timeout" if solver == "mrrt" else "solved"
            version = "foliate 0.1.0 aaa" if solver == "foliate" else ROW.version
            results.add(row(scene="baxter-case2", solver=solver, solve_s=seconds, outcome=outcome, version=version))
        results.add(row(scene="baxter-case3", solver="spf"))
        results.add(row(scene="baxter-case2", solver="spf", series="control bbb", solve_s=3.3))
        text = table.markdown(self.folder)
        lines = [line for line in text.splitlines() if line.startswith("| baxter")]
        self.assertEqual(len(lines), 1)
        self.assertIn("| 100 | 100 | 50 |", lines[0])
        self.assertIn("0/1: 60 / **>60** / 60", lines[0])
        self.assertIn("1.10 times as long", text)
        for scene in CANNOT_STATE:
            self.assertIn(scene, text)

    def test_the_last_verdict_counts_unless_the_solve_was_made_again(self):
        file = self.folder / "checks.csv"
        for verdict in ("collides", "valid"):
            known = dict.fromkeys(CHECK_COLUMNS, "")
            append(file, CHECK_COLUMNS, known | {"scene": "demo", "solver": "spf", "seed": 1, "series": "main",
                                                 "version": ROW.version, "verdict": verdict, "date": ROW.date})
        self.assertEqual(Verdicts(file).of(ROW), "valid")
        self.assertIsNone(Verdicts(file).of(row(date="2026-01-02T00:00:00")))
        self.assertIsNone(Verdicts(file).of(row(seed=2)))


class ProcessesAreEnded(unittest.TestCase):
    def told_by(self, work, limit_s: float = 5.0, afterwards_s: float = 5.0) -> dict:
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(reading)
            with os.fdopen(writing, "w") as pipe:
                work(lambda told: (pipe.write(json.dumps(told) + "\n"), pipe.flush()))
            os._exit(0)
        os.close(writing)
        return watch(child, reading, limit_s, afterwards_s)

    def test_what_is_told_is_collected(self):
        told = self.told_by(lambda tell: (tell({"outcome": "solved", "cpu_s": 1.0}), tell({"samples": 3})))
        self.assertEqual(told, {"outcome": "solved", "cpu_s": 1.0, "samples": 3})

    def test_processor_time_ends_it_and_sleep_does_not(self):
        def burn(tell):
            while True:
                pass

        told = self.told_by(burn, limit_s=0.2)
        self.assertEqual(told["outcome"], "timeout")
        self.assertGreaterEqual(told["cpu_s"], 0.2)
        slept = self.told_by(lambda tell: (time.sleep(0.4), tell({"outcome": "solved"})), limit_s=0.2)
        self.assertEqual(slept["outcome"], "solved")

    def test_a_crash_is_no_timeout(self):
        told = self.told_by(lambda tell: os.kill(os.getpid(), 11))
        self.assertEqual((told["outcome"], told["reason"]), ("crashed", "SIGSEGV"))

    def test_a_solve_is_kept_though_its_answer_cannot_be_written(self):
        told = self.told_by(lambda tell: (tell({"outcome": "solved", "cpu_s": 0.1}), os.kill(os.getpid(), 11)))
        self.assertEqual(told["outcome"], "solved")


class ScenesAreRead(unittest.TestCase):
    def test_every_scene_of_the_comparison(self):
        for name in SCENES:
            scene = read_scene(SCENES_FOLDER / name / "scene.toml")
            self.assertEqual(scene.name, name)
            self.assertEqual(len(scene.start), len(scene.coordinates))
            self.assertEqual(len(scene.goal), len(scene.coordinates))

    def test_every_shipped_scene_is_run_or_excused(self):
        shipped = {file.parent.name for file in SCENES_FOLDER.glob("*/scene.toml")}
        self.assertEqual(shipped, set(SCENES) | set(CANNOT_STATE))

    def test_what_has_no_counterpart_is_refused(self):
        with self.assertRaises(SceneError):
            read_scene(SCENES_FOLDER / "romeo-fridge-upright" / "scene.toml")


if __name__ == "__main__":
    unittest.main()
