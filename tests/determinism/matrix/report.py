"""The table of the matrix, as text, JSON and CSV."""

import csv
import dataclasses
import json
import pathlib
from typing import TextIO

from rows import Row


@dataclasses.dataclass
class Result:
    """What came of a row."""

    row: Row
    build_s: float = 0.0
    run_s: float = 0.0
    digests: int = 0  # Compared with the goldens.
    logs: int = 0  # Of all rows, verified by this one.
    reasons: list[str] = dataclasses.field(default_factory=list)  # Why it failed.

    @property
    def verdict(self) -> str:
        return "FAILED" if self.reasons else "equal"

    def record(self) -> dict[str, object]:
        return {"row": self.row.name, "group": self.row.group, "target": self.row.target,
                "compiler": self.row.compiler, "flags": self.row.flags,
                "build_s": round(self.build_s, 1), "run_s": round(self.run_s, 1),
                "digests": self.digests, "logs": self.logs, "verdict": self.verdict,
                "reason": "\n".join(self.reasons)}


def _first_line(text: str) -> str:
    return text.splitlines()[0] if text else ""


def print_table(results: list[Result], stream: TextIO) -> None:
    """A line per row; of a failed one the first line of each reason. All of them stand below."""
    stream.write(f"\n{'row':18} {'target':16} {'build s':>8} {'run s':>8} {'digests':>8} "
                 f"{'logs':>5}  verdict\n")
    for result in results:
        why = "; ".join(_first_line(reason) for reason in result.reasons)
        stream.write(f"{result.row.name:18} {result.row.target:16} {result.build_s:8.0f} "
                     f"{result.run_s:8.0f} {result.digests:8} {result.logs:5}  "
                     f"{result.verdict}{': ' + why if why else ''}\n")
    for result in results:
        for reason in result.reasons:
            if len(reason.splitlines()) > 1:
                stream.write(f"\n{result.row.name}: {reason}\n")
    failed = sum(1 for result in results if result.reasons)
    seconds = sum(result.build_s + result.run_s for result in results)
    stream.write(f"\n{len(results) - failed} of {len(results)} rows equal, {failed} failed, "
                 f"{sum(result.digests for result in results)} digests, {seconds:.0f} s\n")
    stream.flush()


def write_files(results: list[Result], folder: pathlib.Path) -> None:
    """matrix.json and matrix.csv: a record per row."""
    folder.mkdir(parents=True, exist_ok=True)
    records = [result.record() for result in results]
    (folder / "matrix.json").write_text(json.dumps({"rows": records}, indent=1) + "\n",
                                        encoding="utf-8")
    with (folder / "matrix.csv").open("w", encoding="utf-8", newline="") as stream:
        table = csv.DictWriter(stream, records[0].keys())
        table.writeheader()
        table.writerows(records)


def print_list(rows: tuple[Row, ...], stream: TextIO) -> None:
    """What rows there are: one a line, fields apart by blanks."""
    stream.write(f"{'row':18} {'group':10} {'quick':6} {'target':16} compiler and flags\n")
    for row in rows:
        stream.write(f"{row.name:18} {row.group:10} {'yes' if row.quick else 'no':6} "
                     f"{row.target:16} {row.compiler} {row.flags}\n")
