"""The rows of the matrix, as rows.toml declares them."""

import dataclasses
import pathlib
import tomllib
from typing import Any


class MatrixError(Exception):
    """rows.toml does not say what it should; the text names the row and the field."""


@dataclasses.dataclass(frozen=True)
class Check:
    """One comparison of scenes with the table of goldens."""

    ticks: int
    workers: int = 1
    lanes: int = 4
    scenes: tuple[str, ...] = ()  # None named: every scene of the table.

    def text(self) -> str:
        return f"{self.ticks} ticks, {self.workers} workers, {self.lanes} lanes"


@dataclasses.dataclass(frozen=True)
class Row:
    """How one program is built, how it runs, and what it is asked.

    In the texts, {root} stands for the repository, {folder} for the row's build folder and
    {unpacked} for the folder that the packages of `unpacked` are laid out in.
    """

    name: str
    group: str
    target: str
    compiler: str
    flags: str
    checks: tuple[Check, ...]
    link_flags: str = ""
    toolchain: str = ""  # A file of cmake/toolchains; none: the compiler's own target.
    cmake: tuple[str, ...] = ()
    program: str = "cycloid"
    runner: tuple[str, ...] = ()  # What runs the program; none: the machine itself.
    environment: tuple[tuple[str, str], ...] = ()
    packages: tuple[str, ...] = ()  # To be installed by ./dev.
    unpacked: tuple[str, ...] = ()  # To be unpacked beside the system, because they conflict.
    cpu: tuple[str, ...] = ()  # What the processor must have, as /proc/cpuinfo calls it.
    objdump: str = ""  # Disassembles for the target; none: the objects are not read.
    quick: bool = False
    quick_checks: tuple[Check, ...] = ()  # What --quick compares, where it is not all of `checks`.
    timeout_s: int = 3600  # Of a single run of the program.

    def as_quick(self) -> "Row":
        """The row as --quick runs it."""
        return dataclasses.replace(self, checks=self.quick_checks or self.checks)


@dataclasses.dataclass(frozen=True)
class Matrix:
    """All rows in their order, and what they share."""

    rows: tuple[Row, ...]
    reference: str  # The row that names the first tick in which another one differs.
    goldens: str
    log_scenes: tuple[str, ...]
    log_ticks: int

    def row(self, name: str) -> Row:
        return next(row for row in self.rows if row.name == name)


def _fields_of(kind: type, table: dict[str, Any], where: str) -> dict[str, Any]:
    """The table with lists as tuples; a MatrixError where a name is unknown or one is missing."""
    known = {field.name: field for field in dataclasses.fields(kind)}
    for name in table:
        if name not in known:
            raise MatrixError(f"{where}: there is no field '{name}'")
    for name, field in known.items():
        if field.default is dataclasses.MISSING and name not in table:
            raise MatrixError(f"{where}: the field '{name}' is missing")
    return {name: tuple(value) if isinstance(value, list) else value
            for name, value in table.items()}


def _row(table: dict[str, Any], checks: dict[str, tuple[Check, ...]]) -> Row:
    where = f"row '{table.get('name', '?')}'"
    asked = {}
    for field in ("checks", "quick_checks"):
        named = table.get(field, "")
        if named not in checks and (named or field == "checks"):
            raise MatrixError(f"{where}: {field}: there are none called '{named}'")
        asked[field] = checks.get(named, ())
    environment = tuple(table.get("environment", {}).items())
    table = table | asked | {"environment": environment}
    return Row(**_fields_of(Row, table, where))


def load(file: pathlib.Path) -> Matrix:
    """Reads and checks rows.toml; a MatrixError names what is wrong with it."""
    with file.open("rb") as stream:
        document = tomllib.load(stream)
    checks = {name: tuple(Check(**_fields_of(Check, check, f"checks '{name}'")) for check in listed)
              for name, listed in document["checks"].items()}
    rows = tuple(_row(table, checks) for table in document["row"])
    names = [row.name for row in rows]
    for name in names:
        if names.count(name) > 1:
            raise MatrixError(f"row '{name}' is there {names.count(name)} times")
    if document["reference"] not in names:
        raise MatrixError(f"reference: there is no row '{document['reference']}'")
    return Matrix(rows, document["reference"], document["goldens"],
                  tuple(document["logs"]["scenes"]), document["logs"]["ticks"])
