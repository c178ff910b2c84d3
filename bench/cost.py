#!/usr/bin/env python3
"""What determinism costs: runs cycloid_cost of several builds in turns, and compares.

    cost.py --csv FILE [--rounds N] [--count] NAME=PROGRAM NAME=PROGRAM...

The first build is what the others are divided by. In each round every build runs each scene once,
one after the other, so that what else the machine does meets all of them; the ratio of a scene is
the median of its rounds' ratios, the spread their quartiles. --count counts instructions instead, under
valgrind's callgrind, which repeats exactly but knows no AVX-512.
"""

import argparse
import csv
import re
import statistics
import subprocess
import sys
from dataclasses import dataclass

# Small and large, of the plane and of space: piles, joints, free bodies, cloth, rounds.
SCENES = (
    "stack-10", "pyramid-20", "room-200", "half-pipe", "ragdolls", "machines", "bridge",
    "dzhanibekov", "top", "vehicle-3d", "ragdolls-3d", "wall", "pyramid-3d", "ball-pit-3d",
)
WARM_TICKS = 20
TIMED_TICKS = 40  # Before piles fall asleep.


@dataclass(frozen=True)
class Sample:
    """One run of one scene in one build."""

    cost: float  # Microseconds per tick, or instructions.
    rows: int  # That were solved: builds with other arithmetic go another way.
    digest: str


Samples = dict[str, dict[str, list[Sample]]]  # By scene, then by build.


@dataclass(frozen=True)
class Ratio:
    """A build against the first, over the rounds of a scene; rows as a ratio too."""

    median: float
    low: float
    high: float
    rows: float


def run(program: str, scene: str, runs: int, count: bool) -> Sample:
    """Raises CalledProcessError where the program fails."""
    words = [program, scene, str(WARM_TICKS), str(TIMED_TICKS), str(runs)]
    if count:
        words = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null",
                 "--toggle-collect=cycloid_cost_timed", *words]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    microseconds, rows, digest = done.stdout.split()
    cost = float(microseconds)
    if count:
        found = re.search(r"Collected : (\d+)", done.stderr)
        if found is None:
            raise RuntimeError("callgrind says no count:\n" + done.stderr)
        cost = float(found[1])
    return Sample(cost, int(rows), digest)


def ratio(base: list[Sample], other: list[Sample]) -> Ratio:
    """@pre as many samples of both, round by round."""
    ratios = [b.cost / a.cost for a, b in zip(base, other)]
    quartiles = statistics.quantiles(ratios, n=4) if len(ratios) > 1 else [ratios[0]] * 3
    rows = other[0].rows / base[0].rows if base[0].rows else 1.0
    return Ratio(statistics.median(ratios), quartiles[0], quartiles[2], rows)


def measure(builds: dict[str, str], arguments: argparse.Namespace) -> Samples:
    """By scene and build, one sample of each round."""
    samples: Samples = {s: {b: [] for b in builds} for s in SCENES}
    for round_index in range(arguments.rounds):
        for scene in SCENES:
            # Turn about, so that none always runs first.
            order = list(builds) if round_index % 2 == 0 else list(reversed(builds))
            for name in order:
                samples[scene][name].append(
                    run(builds[name], scene, arguments.runs, arguments.count))
        print(f"round {round_index + 1} of {arguments.rounds}", file=sys.stderr)
    return samples


def print_table(samples: Samples, builds: dict[str, str], unit: str) -> None:
    """The table of docs/performance.md."""
    base, *others = builds
    columns = [f"{name} / {base} (quartiles) | rows" for name in others]
    print(f"| scene | {base}, {unit} | " + " | ".join(columns) + " |")
    print("|---|---|" + "---|---|" * len(others))
    medians: dict[str, list[float]] = {name: [] for name in others}
    for scene, by_build in samples.items():
        cells = [scene, f"{statistics.median(s.cost for s in by_build[base]):,.1f}"]
        for name in others:
            found = ratio(by_build[base], by_build[name])
            medians[name].append(found.median)
            cells.append(f"{found.median:.3f} ({found.low:.3f} to {found.high:.3f})")
            cells.append(f"{found.rows:.3f}")
        print("| " + " | ".join(cells) + " |")
    means = [f"**{statistics.geometric_mean(medians[name]):.3f}** | " for name in others]
    print("| geometric mean | | " + " | ".join(means) + " |")


def write_csv(path: str, samples: Samples, unit: str) -> None:
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["scene", "build", "round", unit, "rows", "digest"])
        for scene, by_build in samples.items():
            for name, rounds in by_build.items():
                for index, one in enumerate(rounds):
                    writer.writerow([scene, name, index + 1, one.cost, one.rows, one.digest])


def strict_builds_differ(samples: Samples) -> list[str]:
    """Scenes in which builds that are not free end otherwise, so that no cost can be compared."""
    return [
        scene for scene, by_build in samples.items()
        if len({s.digest for n, rounds in by_build.items() if "free" not in n for s in rounds}) > 1
    ]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--csv", required=True)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--runs", type=int, default=3, help="of each program; the fastest counts")
    parser.add_argument("--count", action="store_true", help="instructions, not time: one round")
    parser.add_argument("builds", nargs="+", metavar="NAME=PROGRAM")
    arguments = parser.parse_args()
    if arguments.count:
        arguments.rounds = arguments.runs = 1
    builds = dict(build.split("=", 1) for build in arguments.builds)
    unit = "instructions" if arguments.count else "microseconds per tick"
    samples = measure(builds, arguments)
    write_csv(arguments.csv, samples, unit)
    print_table(samples, builds, unit)
    if differ := strict_builds_differ(samples):
        print(f"cost.py: deterministic builds differ in {', '.join(differ)}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
