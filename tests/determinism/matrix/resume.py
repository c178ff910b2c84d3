"""What an interrupted matrix has already shown, for `--resume`."""

import dataclasses
import hashlib
import json
import pathlib
import subprocess

from build import Place
from report import Result
from rows import Row


# What decides the bits of a row, beside its own declaration: what it is built from, and how it is
# compared. The server, the tests and the documents can change while a long matrix goes on.
DECISIVE = ("CMakeLists.txt", "cmake", "cli", "protocol", "scenes", "solver",
            *(f"tests/determinism/matrix/{name}" for name in (
                "build.py", "checks.py", "precompile.cmake")))


def state_of(root: pathlib.Path, goldens: str) -> str:
    """The git objects of all that decides the bits; "" where a file differs from its commit, and
    results of now are of no use later."""
    said = []
    for command in (["git", "ls-tree", "HEAD", "--"], ["git", "status", "--porcelain", "--"]):
        done = subprocess.run([*command, goldens, *DECISIVE], cwd=root, capture_output=True,
                              text=True, check=False)
        if done.returncode != 0:
            return ""
        said.append(done.stdout.strip())
    objects, changes = said
    return "" if changes else hashlib.sha256(objects.encode()).hexdigest()


def _file(row: Row, place: Place) -> pathlib.Path:
    return place.folder(row) / "result.json"


def _key(row: Row, state: str) -> dict[str, object]:
    """What has to be the same for a result to hold: the sources and the row's own declaration."""
    return {"state": state, "row": json.loads(json.dumps(dataclasses.asdict(row)))}


def keep(result: Result, state: str, place: Place) -> None:
    """Keeps the result of a row that was equal; of any other nothing, so that it is run again."""
    _file(result.row, place).unlink(missing_ok=True)
    if not result.reasons and state:
        record = _key(result.row, state) | {"build_s": result.build_s, "run_s": result.run_s,
                                            "digests": result.digests}
        _file(result.row, place).write_text(json.dumps(record), encoding="utf-8")


def kept(row: Row, state: str, place: Place, logs: pathlib.Path) -> Result | None:
    """The kept result of a row; None where there is none of these sources and this declaration, or
    where its program or its logs are gone, which the exchange of logs still needs."""
    try:
        record = json.loads(_file(row, place).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    is_whole = (place.folder(row) / row.program).is_file() and any(logs.glob("*.cylog"))
    if not state or not is_whole or {name: record.get(name) for name in ("state", "row")} != _key(
            row, state):
        return None
    return Result(row, record["build_s"], record["run_s"], record["digests"])
