"""What a row's program is asked: the goldens, its own logs, and the logs of all others."""

import concurrent.futures
import dataclasses
import hashlib
import json
import pathlib
import shutil
import subprocess
import sys

from build import Place, RowFailed, build, run
from rows import Check, Matrix, Row

GATE = pathlib.Path(__file__).resolve().parents[1] / "gate/objects.py"


def golden_ticks(file: pathlib.Path) -> dict[str, int]:
    """The scenes of the table of goldens, with the last tick of each."""
    lines = file.read_text(encoding="utf-8").splitlines()
    words = [line.split() for line in lines]
    return {line[1]: int(line[2]) for line in words if len(line) > 2 and line[0] == "scene"}


def _setting(check: Check) -> list[str]:
    return ["--workers", str(check.workers), "--lanes", str(check.lanes)]


def _ticks_of(row: Row, place: Place, scene: str, check: Check) -> list[str]:
    """'tick digest' of every tick; as far as it came, where the world stopped."""
    return run(row, place, ["run", scene, "--ticks", str(check.ticks), "--digest-every", "1",
                            *_setting(check)]).out.splitlines()


def _blame(row: Row, matrix: Matrix, place: Place, scene: str, check: Check) -> str:
    """The first tick of the scene in which the row differs from the reference row."""
    reference = matrix.row(matrix.reference)
    try:
        build(reference, place)
        theirs = _ticks_of(reference, place, scene, check)
        ours = _ticks_of(row, place, scene, check)
    except RowFailed as failure:
        return f"which tick was the first is not known: {failure}"
    for right, wrong in zip(theirs, ours):
        if right != wrong:
            tick, digest = right.split()
            return (f"{scene} first differs from {reference.name} at tick {tick}: "
                    f"{wrong.split()[-1]} instead of {digest}")
    if len(ours) != len(theirs):
        return f"{scene} stops after {len(ours)} ticks, {reference.name} after {len(theirs)}"
    return f"{scene} is the same as in {reference.name}, which may be wrong itself"


class Mismatch(RowFailed):
    """The goldens are not met."""

    def __init__(self, text: str, check: Check, scene: str | None) -> None:
        super().__init__(text)
        self.check = check
        self.scene = scene  # None where the program names none.


def compare(row: Row, check: Check, matrix: Matrix, place: Place) -> int:
    """Compares the row's program with the goldens; how many ticks were. Mismatch where one
    differs, or where the program does not say that it compared every tick of every scene."""
    wanted = {scene: min(ticks, check.ticks)
              for scene, ticks in golden_ticks(place.root / matrix.goldens).items()
              if not check.scenes or scene in check.scenes}
    named = [word for scene in check.scenes for word in ("--scene", scene)]
    ran = run(row, place, ["golden", "check", matrix.goldens, "--ticks", str(check.ticks),
                           *_setting(check), *named, "--jobs", str(place.jobs), "--json"])
    try:
        verdicts = {verdict["scene"]: verdict for verdict in json.loads(ran.out)["scenes"]}
    except (ValueError, KeyError, TypeError) as error:
        raise Mismatch(f"{check.text()}: {ran.said()} (exit {ran.exit})", check, None) from error
    for scene, verdict in verdicts.items():
        if verdict["exit"] != 0:
            raise Mismatch(f"{check.text()}: {scene}: {verdict['verdict']}", check, scene)
    ticks = {scene: verdict["ticks"] for scene, verdict in verdicts.items()}
    if ran.exit != 0:
        raise Mismatch(f"{check.text()}: {ran.said()} (exit {ran.exit})", check, None)
    if ticks != wanted or not wanted:
        missing = sorted(scene for scene in wanted if ticks.get(scene) != wanted[scene])
        raise Mismatch(f"{check.text()}: not every tick was compared of {', '.join(missing)}",
                       check, None)
    return sum(ticks.values())


def compare_all(row: Row, matrix: Matrix, place: Place) -> int:
    """Every check of the row, as many at a time as there are jobs; the sum of their digests. Of a
    mismatch, RowFailed also names the first tick that differs from the reference row."""
    with concurrent.futures.ThreadPoolExecutor(place.jobs) as pool:
        futures = [pool.submit(compare, row, check, matrix, place) for check in row.checks]
        try:
            return sum(future.result() for future in futures)
        except Mismatch as mismatch:
            pool.shutdown(cancel_futures=True)
            if mismatch.scene is None or row.name == matrix.reference:
                raise
            found = _blame(row, matrix, place, mismatch.scene, mismatch.check)
            raise RowFailed(f"{mismatch}\n{found}") from mismatch


def read_objects(row: Row, place: Place) -> None:
    """RowFailed where the solver or the scenes were compiled into an instruction that rounds
    otherwise, which the digests of the catalogue's scenes need not meet; or where a unit has a copy
    of a kernel for AVX, which would be run in its place."""
    if not row.objdump:
        return
    archives = [place.folder(row) / part / f"libcycloid_{part}.a" for part in ("solver", "scenes")]
    read = "--any-imports" if row.target == "x86_64-linux" else "--instructions-only"
    done = subprocess.run([sys.executable, str(GATE), "--objdump", place.text(row, row.objdump),
                           read, *map(str, archives)],
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RowFailed(f"its objects: {(done.stdout + done.stderr).strip()}")


def log_folder(row: Row, place: Place) -> pathlib.Path:
    return place.builds / "logs" / row.name


def write_logs(row: Row, matrix: Matrix, place: Place) -> pathlib.Path:
    """Writes a log of every scene of the exchange; the folder they lie in."""
    folder = log_folder(row, place)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for scene in matrix.log_scenes:
        log = folder / f"{scene}.cylog"
        ran = run(row, place, ["run", scene, "--ticks", str(matrix.log_ticks), "--digest-every",
                               "0", "--log", str(log.relative_to(place.root))])
        if ran.exit != 0 or not log.is_file():
            raise RowFailed(f"it writes no log of {scene}: {ran.said()} (exit {ran.exit})")
    return folder


@dataclasses.dataclass(frozen=True)
class Exchange:
    """All logs of all rows in one folder. Logs of the same bytes lie there once: what a program
    says of one it says of all of them."""

    folder: pathlib.Path
    writers: dict[str, list[str]]  # The rows that wrote each file of the folder.

    @property
    def logs(self) -> int:
        return sum(len(rows) for rows in self.writers.values())


def gather(folders: dict[str, pathlib.Path], place: Place) -> Exchange:
    """Puts the logs of the rows, by the row's name, into one folder."""
    gathered = place.builds / "exchange"
    shutil.rmtree(gathered, ignore_errors=True)
    gathered.mkdir(parents=True)
    writers: dict[str, list[str]] = {}
    for name, folder in folders.items():
        for log in sorted(folder.glob("*.cylog")):
            content = log.read_bytes()
            shared = f"{log.stem}-{hashlib.sha256(content).hexdigest()[:8]}.cylog"
            if shared not in writers:
                (gathered / shared).write_bytes(content)
            writers.setdefault(shared, []).append(name)
    return Exchange(gathered, writers)


def verify(row: Row, exchange: Exchange, place: Place) -> int:
    """Verifies all logs of all rows; how many. RowFailed names the rows whose logs it refused."""
    if not exchange.writers:
        raise RowFailed("no row has written a log to verify")
    ran = run(row, place, ["verify", str(exchange.folder.relative_to(place.root))])
    unnamed = [file for file in exchange.writers if file not in ran.out]
    if ran.exit == 0 and not unnamed:
        return exchange.logs
    if ran.exit == 0:
        raise RowFailed(f"verify says nothing of {', '.join(unnamed)}")
    bad = [f"{line.strip()} (written by {', '.join(exchange.writers[file])})"
           for line in ran.out.splitlines() for file in exchange.writers
           if file in line and ": good" not in line]
    raise RowFailed("verify: " + "\n".join(bad or [ran.said()]) + f" (exit {ran.exit})")
