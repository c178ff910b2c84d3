"""Tests of bench/default_cost.py, on numbers that are made up."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench"))

import default_cost  # noqa: E402

PEER = "Box2D 3.2.0 1x4"
OUTSIDER = "ODE 0.16 1x20"  # Takes part in none.


def judged(trials: tuple[str, ...]) -> str:
    head = ("trial", "number", default_cost.SOFT_STEP, default_cost.DEFAULT, PEER, OUTSIDER)
    lines = ["a machine, a day", "", "| " + " | ".join(head) + " |", "|---|---|---|---|---|---|"]
    lines += [f"| {trial} | gap, m | x 1 | **0.5** | 0.7 | - |" for trial in trials]
    return "\n".join(lines) + "\n"


def records(trials: tuple[str, ...]) -> list[dict[str, str]]:
    settings = (("soft-step", "4", "1", "1", "10"), ("soft-loaded", "4", "1", "1", "15"),
                ("Box2D 3.2.0", "1", "4", "0", "20"))
    keys = ("method", "substeps", "sweeps", "relax_sweeps", "ns_per_tick")
    return [{"scene": f"trial-{trial}"} | dict(zip(keys, setting))
            for trial in trials for setting in settings]


class Tables(unittest.TestCase):
    def setUp(self) -> None:
        trials = default_cost.TRIALS
        self.rows = default_cost.rows_of(judged(trials), records(trials))

    def test_judges_and_clocks_are_joined(self) -> None:
        self.assertEqual([row.trial for row in self.rows], list(default_cost.TRIALS))
        self.assertEqual(self.rows[0].number, "gap, m")
        self.assertEqual(self.rows[0].cells[PEER], default_cost.Cell("0.7", 20.0))

    def test_the_default_is_divided_by_the_others(self) -> None:
        counts = dict.fromkeys(default_cost.TRIALS, 1.25)
        head, _, first, *_ = default_cost.table(self.rows, counts).splitlines()
        self.assertTrue(first.endswith("| x 1 | **0.5** | 0.7 | 1.25 | 1.50 | 0.75 |"), first)
        self.assertIn(PEER, head)
        self.assertNotIn(OUTSIDER, head)

    def test_who_took_no_part_is_not_compared(self) -> None:
        self.assertEqual(default_cost.ratio_cell(self.rows[0], OUTSIDER), "-")
        self.assertEqual(default_cost.ratio_cell(self.rows[0], "nobody"), "-")

    def test_a_trial_that_nobody_judged_is_named(self) -> None:
        trials = default_cost.TRIALS[1:]
        with self.assertRaisesRegex(ValueError, default_cost.TRIALS[0]):
            default_cost.rows_of(judged(trials), records(trials))


if __name__ == "__main__":
    unittest.main()
