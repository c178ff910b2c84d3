#!/usr/bin/env python3
"""What the default holds and what it costs, beside Soft Step and other engines of the plane.

    default_cost.py CYCLOID RIVALS [--rounds N] [--commit TEXT] [--out FOLDER]

CYCLOID is the program, RIVALS cycloid_rival_charts. Each trial that the default has to hold runs
for its whole time, engines in turn, so that what else the machine does meets all of them: judges say
what became of it, clocks what a tick took. Instructions of our steps are counted apart, by
callgrind, which repeats exactly but knows no AVX-512; so they are those of the kernels for AVX2.
Prints the table of docs/stability.md.
"""

import argparse
import csv
import pathlib
import subprocess
import sys
from dataclasses import dataclass

from instructions import collected

# What the default has to hold at the cost of Soft Step, and a pyramid, where nothing is loaded.
TRIALS = (
    "heavy-on-light-1000", "stack-30", "ball-and-chain", "heavy-apexes", "400-on-thin-ground",
    "400-on-thick-ground", "joint-grid-100", "card-house", "arch", "bridge", "pyramid-20",
)
COUNTED_TICKS = {"joint-grid-100": 60}  # Of others all: callgrind takes fifty times as long.
SOFT_STEP = "soft-step 4x1+1"
DEFAULT = "soft-loaded 4x1+1"
METHODS = (SOFT_STEP, DEFAULT)


@dataclass(frozen=True)
class Cell:
    """What came of a trial under one setting; "-" and 0 where it took no part."""

    outcome: str
    ns_per_tick: float


@dataclass(frozen=True)
class Row:
    """A trial, what it is judged by, and its cells by setting."""

    trial: str
    number: str
    cells: dict[str, Cell]


def outcomes_of(markdown: str) -> dict[str, dict[str, str]]:
    """By trial, its number and what each setting came to: the table of cycloid_rival_charts."""
    lines = [line.strip("|").split("|") for line in markdown.splitlines() if line.startswith("|")]
    head, _, *rows = [[cell.strip() for cell in line] for line in lines]
    return {row[0]: dict(zip(head[1:], row[1:])) for row in rows}


def setting_of(record: dict[str, str]) -> str:
    """As the head of the table calls it."""
    text = f"{record['method']} {record['substeps']}x{record['sweeps']}"
    return text if record["relax_sweeps"] == "0" else f"{text}+{record['relax_sweeps']}"


def rows_of(markdown: str, records: list[dict[str, str]]) -> list[Row]:
    """Joins what judges and clocks say. ValueError where a trial has no number."""
    outcomes = outcomes_of(markdown)
    times = {(record["scene"].removeprefix("trial-"), setting_of(record)):
             float(record["ns_per_tick"] or 0) for record in records}
    rows = []
    for trial in TRIALS:
        if trial not in outcomes:
            raise ValueError(f"nobody has judged {trial}")
        by_setting = dict(outcomes[trial])
        number = by_setting.pop("number")
        rows.append(Row(trial, number, {setting: Cell(outcome, times.get((trial, setting), 0.0))
                                        for setting, outcome in by_setting.items()}))
    return rows


def count(program: str, trial: str, setting: str, folder: pathlib.Path) -> int:
    """Instructions of all steps of a trial. Raises CalledProcessError where the program fails."""
    words = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null",
             "--toggle-collect=cycloid::solver::World<?>::step()",
             program, "chart", f"trial-{trial}", "--out", str(folder / "counted"),
             "--methods", setting.split()[0], "--substeps", "4", "--sweeps", "1", "--relax", "1",
             "--repeats", "0", "--ticks", str(COUNTED_TICKS.get(trial, 0))]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    return collected(done.stderr)


def ratio_cell(row: Row, other: str) -> str:
    """Time of the default over that of another setting; "-" where that took no part."""
    cell = row.cells.get(other)
    if cell is None or cell.outcome == "-" or cell.ns_per_tick == 0.0:
        return "-"
    return f"{row.cells[DEFAULT].ns_per_tick / cell.ns_per_tick:.2f}"


def table(rows: list[Row], counts: dict[str, float]) -> str:
    """Of `counts` by trial the default's instructions over those of Soft Step."""
    peers = [setting for setting in rows[0].cells
             if setting not in METHODS and any(r.cells[setting].outcome != "-" for r in rows)]
    head = ["trial", "number", "Soft Step", "default", *peers, "instructions / Soft Step's",
            "time / Soft Step's", *(f"/ {peer}" for peer in peers)]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for row in rows:
        cells = [row.trial, row.number, row.cells[SOFT_STEP].outcome, row.cells[DEFAULT].outcome,
                 *(row.cells[peer].outcome for peer in peers), f"{counts[row.trial]:.2f}",
                 *(ratio_cell(row, other) for other in (SOFT_STEP, *peers))]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("rivals")
    parser.add_argument("--rounds", type=int, default=5, help="of timing")
    parser.add_argument("--commit", default="unknown", help="of the sources, to stand above")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/run/default-cost"))
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    judged = arguments.out / "judged.md"
    subprocess.run([arguments.rivals, *(f"trial-{trial}" for trial in TRIALS),
                    "--methods", ",".join(setting.split()[0] for setting in METHODS),
                    "--substeps", "4", "--sweeps", "1", "--peer-substeps", "1",
                    "--iterations", "0", "--repeats", str(arguments.rounds),
                    "--commit", arguments.commit, "--out", str(arguments.out), "--table",
                    str(judged)],
                   stdout=sys.stderr, check=True)
    with open(arguments.out / "chart.csv", newline="", encoding="utf-8") as file:
        records = list(csv.DictReader(file))
    markdown = judged.read_text(encoding="utf-8")
    rows = rows_of(markdown, records)
    counts = {}
    for trial in TRIALS:
        soft_step, default = (count(arguments.program, trial, setting, arguments.out)
                              for setting in METHODS)
        counts[trial] = default / soft_step
        print(f"{trial}: {counts[trial]:.3f} of Soft Step's instructions", file=sys.stderr)
    print(markdown.splitlines()[0], table(rows, counts), sep="\n\n", end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
