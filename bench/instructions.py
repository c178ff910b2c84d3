#!/usr/bin/env python3
"""Counts the instructions of steps under valgrind's callgrind, which repeats exactly, and compares
them with the committed numbers.

    instructions.py PROGRAM FILE [--compiler TEXT] [--write]

PROGRAM is cycloid_cost, TEXT what has compiled it. FILE says which compiler its counts are of, and
has a line for each scene: its name, warm ticks, counted ticks, instructions per tick, and the
digest at the end. Another compiler counts otherwise: then only digests are compared. A count that differs by more than 2 % is an error
in both directions: more is a loss, and less is a gain that the next change could lose unseen. A
digest that differs means that the solver does something else: then the counts are of another motion.
--write replaces the compiler, the counts and the digests of FILE.
"""

import argparse
import pathlib
import re
import subprocess
import sys
from dataclasses import dataclass, replace

SLACK_PERCENT = 2


@dataclass(frozen=True)
class Count:
    """A line of the file."""

    scene: str
    warm_ticks: int
    ticks: int
    instructions: int  # Per tick.
    digest: str

    def text(self) -> str:
        return (f"{self.scene} {self.warm_ticks} {self.ticks} {self.instructions} "
                f"{self.digest}\n")


COMPILER = "# compiler: "


def compiler_of(comments: list[str]) -> str:
    """What the counts are of; "" where nothing says so."""
    lines = [line for line in comments if line.startswith(COMPILER)]
    return lines[0][len(COMPILER):].strip() if lines else ""


def parse(text: str) -> tuple[list[str], list[Count]]:
    """The comments and the counts of a file; ValueError names a line that is none."""
    comments, counts = [], []
    for number, line in enumerate(text.splitlines(), start=1):
        if line.startswith("#") or not line.strip():
            comments.append(line + "\n")
            continue
        words = line.split()
        if len(words) != 5 or not all(word.isdecimal() for word in words[1:4]):
            raise ValueError(f"line {number}: not 'scene warm ticks instructions digest': {line}")
        counts.append(Count(words[0], int(words[1]), int(words[2]), int(words[3]), words[4]))
    if not counts:
        raise ValueError("there is no scene in it")
    return comments, counts


def collected(errors: str) -> int:
    """What callgrind says that it has counted; ValueError where it says nothing."""
    found = re.search(r"Collected : (\d+)", errors)
    if found is None or int(found[1]) == 0:
        raise ValueError("callgrind counted nothing:\n" + errors)
    return int(found[1])


def measure(program: str, scene: Count) -> Count:
    """The scene with today's numbers; ValueError where the program fails, with what it says."""
    words = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null",
             "--toggle-collect=cycloid_cost_timed", program, scene.scene,
             str(scene.warm_ticks), str(scene.ticks), "1"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise ValueError(f"{scene.scene}: exit {done.returncode}:\n{done.stderr}")
    _, _, digest = done.stdout.split()
    return replace(scene, instructions=collected(done.stderr) // scene.ticks, digest=digest)


def complaint(before: Count, now: Count, same_compiler: bool = True) -> str:
    """What is wrong with today's numbers; "" where nothing is."""
    if now.digest != before.digest:
        return f"{now.scene}: ends as {now.digest}, not as {before.digest}: another motion"
    if not same_compiler:
        return ""
    if abs(now.instructions - before.instructions) * 100 <= before.instructions * SLACK_PERCENT:
        return ""
    change = now.instructions / before.instructions - 1.0
    word = "more" if change > 0 else "less"
    return (f"{now.scene}: {abs(change):.1%} {word} instructions a tick: {now.instructions:,} "
            f"instead of {before.instructions:,}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("--compiler", default="")
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    comments, counts = parse(arguments.file.read_text(encoding="utf-8"))
    same_compiler = arguments.compiler in ("", compiler_of(comments))
    if not same_compiler:
        print(f"counted with {arguments.compiler}, the file with {compiler_of(comments)}: only "
              "digests are compared")
    complaints, measured = [], []
    for before in counts:
        now = measure(arguments.program, before)
        measured.append(now)
        change = now.instructions / before.instructions - 1.0 if before.instructions else 0.0
        print(f"{now.scene:20} {now.instructions:>12,} a tick {change:+7.2%} {now.digest}",
              flush=True)
        if before.instructions:
            complaints.append(complaint(before, now, same_compiler))
    if arguments.write:
        comments = [line for line in comments if not line.startswith(COMPILER)]
        comments.append(f"{COMPILER}{arguments.compiler}\n")
        text = "".join(comments) + "".join(each.text() for each in measured)
        arguments.file.write_text(text, encoding="utf-8")
        return 0
    complaints = [text for text in complaints if text]
    for text in complaints:
        print(f"instructions.py: {text}", file=sys.stderr)
    if complaints:
        print("instructions.py: where this was meant: ./dev instructions --write, and say why in "
              "the commit", file=sys.stderr)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
