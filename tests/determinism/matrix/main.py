"""Builds the program in every way that rows.toml declares and compares the bits. See
docs/determinism.md; `./dev matrix` calls it."""

import argparse
import pathlib
import sys
import time

import build
import checks
import report
import resume
import rows

HERE = pathlib.Path(__file__).resolve().parent


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="./dev matrix", description="The same bits from every compiler and target of "
        "tests/determinism/matrix/rows.toml; exit 1 if a row fails, 2 for bad arguments.")
    parser.add_argument("--list", action="store_true", help="print the rows and stop")
    parser.add_argument("--row", action="append", default=[], metavar="NAME",
                        help="this row only; may be repeated")
    parser.add_argument("--group", action="append", default=[], metavar="NAME",
                        help="the rows of this group only; may be repeated")
    parser.add_argument("--quick", action="store_true", help="the rows that CI runs")
    parser.add_argument("--resume", action="store_true",
                        help="keep the rows that were equal in an earlier run at this commit")
    parser.add_argument("--jobs", type=int, default=1, help="compilers and programs at a time")
    parser.add_argument("--packages", action="store_true",
                        help="print what must be installed, a line per row, and stop")
    parser.add_argument("--rows-file", type=pathlib.Path, default=HERE / "rows.toml",
                        help="another list of rows")
    parser.add_argument("--root", type=pathlib.Path, default=HERE.parents[2],
                        help="another repository")
    return parser


def _chosen(arguments: argparse.Namespace, matrix: rows.Matrix,
            parser: argparse.ArgumentParser) -> list[rows.Row]:
    """The rows asked for, in the order of the file; a usage error where there are none such."""
    names = [row.name for row in matrix.rows]
    groups = {row.group for row in matrix.rows}
    for name in arguments.row:
        if name not in names:
            parser.error(f"--row: there is no row '{name}'; see --list")
    for group in arguments.group:
        if group not in groups:
            parser.error(f"--group: there is no group '{group}'; there are "
                         f"{', '.join(sorted(groups))}")
    chosen = [row for row in matrix.rows
              if (not arguments.row or row.name in arguments.row)
              and (not arguments.group or row.group in arguments.group)
              and (not arguments.quick or row.quick)]
    if not chosen:
        parser.error("no row is in all of --row, --group and --quick; see --list")
    return [row.as_quick() for row in chosen] if arguments.quick else chosen


def _say(text: str) -> None:
    print(f"matrix: {text}", flush=True)


def _make(result: report.Result, matrix: rows.Matrix, place: build.Place) -> pathlib.Path | None:
    """Builds a row, compares it with the goldens and lets it write its logs; where they lie."""
    started = time.monotonic()
    try:
        build.build(result.row, place)
    except build.RowFailed as failure:
        result.reasons.append(str(failure))
        return None
    finally:
        result.build_s = time.monotonic() - started
    started = time.monotonic()
    (place.folder(result.row) / "run.log").unlink(missing_ok=True)
    folder = None
    for step in ("objects", "logs", "goldens"):  # A row whose bits differ still writes its logs.
        try:
            if step == "objects":
                checks.read_objects(result.row, place)
            elif step == "logs":
                folder = checks.write_logs(result.row, matrix, place)
            else:
                result.digests = checks.compare_all(result.row, matrix, place)
        except build.RowFailed as failure:
            result.reasons.append(str(failure))
    result.run_s = time.monotonic() - started
    return folder


def _exchange(results: list[report.Result], folders: dict[str, pathlib.Path],
              place: build.Place) -> None:
    """Every row that was built verifies the logs of all rows."""
    exchange = checks.gather(folders, place)
    _say(f"verifying {exchange.logs} logs, of which {len(exchange.writers)} differ, by every row")
    for result in results:
        if not (place.folder(result.row) / result.row.program).is_file():
            continue
        started = time.monotonic()
        try:
            result.logs = checks.verify(result.row, exchange, place)
        except build.RowFailed as failure:
            result.reasons.append(str(failure))
        result.run_s += time.monotonic() - started


def run_matrix(chosen: list[rows.Row], matrix: rows.Matrix, place: build.Place,
               is_resumed: bool) -> int:
    """Runs the rows, but those kept of an earlier run, and prints the table; 1 if one failed."""
    place.builds.mkdir(parents=True, exist_ok=True)
    state = resume.state_of(place.root, matrix.goldens)
    results: list[report.Result] = []
    folders: dict[str, pathlib.Path] = {}
    for number, row in enumerate(chosen, 1):
        _say(f"{number} of {len(chosen)}: {row.name}")
        kept = resume.kept(row, state, place, checks.log_folder(row, place)) if is_resumed else None
        result = kept or report.Result(row)
        results.append(result)
        folder = checks.log_folder(row, place) if kept else _make(result, matrix, place)
        resume.keep(result, state, place)
        if folder is not None:
            folders[row.name] = folder
        _say(f"{result.row.name}: {result.verdict}, built in {result.build_s:.0f} s, "
             f"run in {result.run_s:.0f} s")
        for reason in result.reasons:
            _say(f"{result.row.name}: {reason}")
    _exchange(results, folders, place)
    report.print_table(results, sys.stdout)
    report.write_files(results, place.builds)
    return 1 if any(result.reasons for result in results) else 0


def main(words: list[str]) -> int:
    parser = _parser()
    arguments = parser.parse_args(words)
    try:
        matrix = rows.load(arguments.rows_file)
    except rows.MatrixError as error:
        parser.error(f"{arguments.rows_file}: {error}")
    chosen = _chosen(arguments, matrix, parser)
    if arguments.list:
        report.print_list(tuple(chosen), sys.stdout)
        return 0
    if arguments.packages:
        for row in chosen:
            print(*row.packages)
        return 0
    root = arguments.root.resolve()
    return run_matrix(chosen, matrix, build.Place(root, root / "build/matrix",
                                                  max(1, arguments.jobs)), arguments.resume)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
