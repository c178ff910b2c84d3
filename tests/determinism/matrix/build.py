"""Builds the program of a row, and knows how to run it."""

import dataclasses
import os
import pathlib
import shutil
import subprocess

from rows import Row

BUILD_LINES_SHOWN = 15


class RowFailed(Exception):
    """The row cannot be built or run, or gave other bits; the text says why."""


@dataclasses.dataclass(frozen=True)
class Place:
    """Where the matrix works: the repository, its folder of builds, and jobs at a time."""

    root: pathlib.Path
    builds: pathlib.Path
    jobs: int

    def folder(self, row: Row) -> pathlib.Path:
        return self.builds / row.name

    def text(self, row: Row, text: str) -> str:
        """`text` with its {root}, {folder} and {unpacked} filled in."""
        return text.format(root=self.root, folder=self.folder(row),
                           unpacked=self.builds / "unpacked")


def processor_flags() -> set[str]:
    """What the processor can do, as /proc/cpuinfo calls it; nothing where there is no such file."""
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return set()
    return {flag for line in lines if line.startswith("flags") for flag in line.split()[2:]}


def why_impossible(row: Row, place: Place) -> str | None:
    """What this machine lacks for the row; None where it lacks nothing."""
    hint = f" (package {', '.join(row.packages)})" if row.packages else ""
    if shutil.which(row.compiler) is None:
        return f"the compiler {row.compiler} is missing{hint}"
    if row.runner and shutil.which(place.text(row, row.runner[0])) is None:
        return f"{row.runner[0]}, which runs it, is missing{hint}"
    lacking = sorted(set(row.cpu) - processor_flags())
    return f"this processor lacks {', '.join(lacking)}" if lacking else None


def _logged(command: list[str], log: pathlib.Path, cwd: pathlib.Path,
            environment: dict[str, str]) -> bool:
    with log.open("a", encoding="utf-8") as stream:
        stream.write(f"$ {' '.join(command)}\n")
        stream.flush()
        done = subprocess.run(command, cwd=cwd, env=os.environ | environment, stdout=stream,
                              stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, check=False)
    return done.returncode == 0


def _unpack(row: Row, place: Place, log: pathlib.Path) -> None:
    """Lays out packages beside the system that conflict with what is installed."""
    packages = place.builds / "packages"
    packages.mkdir(parents=True, exist_ok=True)
    for package in row.unpacked:
        if not list(packages.glob(f"{package}_*.deb")) and not _logged(
                ["apt-get", "download", package], log, packages, {}):
            raise RowFailed(f"the package {package} cannot be downloaded; see {log}")
        for file in packages.glob(f"{package}_*.deb"):
            if not _logged(["dpkg", "-x", str(file), "../unpacked"], log, packages, {}):
                raise RowFailed(f"{file} cannot be unpacked; see {log}")


def configure_command(row: Row, place: Place) -> list[str]:
    """The configuration without a build type: the row's flags alone decide. `--fresh`, so that
    nothing of an earlier one stays."""
    command = ["cmake", "--fresh", "-S", str(place.root), "-B", str(place.folder(row)),
               "-G", "Ninja", "-DCMAKE_BUILD_TYPE=None",
               f"-DCMAKE_CXX_COMPILER={row.compiler}",
               "-DCYCLOID_NETWORK=OFF", "-DCYCLOID_TESTS=OFF", "-DCYCLOID_EXPERIMENTS=OFF",
               "-DCYCLOID_TOOLS=OFF", "-DCYCLOID_PROGRAM_OPTIONS=-O0",
               f"-DCMAKE_PROJECT_INCLUDE={pathlib.Path(__file__).with_name('precompile.cmake')}"]
    if row.toolchain:
        command.append(f"-DCMAKE_TOOLCHAIN_FILE={place.root / 'cmake/toolchains' / row.toolchain}")
    return command + [place.text(row, argument) for argument in row.cmake]


def build(row: Row, place: Place) -> None:
    """Builds the row's program; RowFailed with the end of the log where that fails."""
    folder = place.folder(row)
    (folder / row.program).unlink(missing_ok=True)  # Never the program of another day.
    reason = why_impossible(row, place)
    if reason:
        raise RowFailed(reason)
    folder.mkdir(parents=True, exist_ok=True)
    log = folder / "build.log"
    log.unlink(missing_ok=True)
    if row.unpacked:
        _unpack(row, place, log)
    build_command = ["cmake", "--build", str(folder), "--parallel", str(place.jobs),
                     "--target", "cycloid_cli"]
    # By the environment, because a toolchain file's own flags are then kept beside these.
    environment = {"CXXFLAGS": place.text(row, row.flags),
                   "LDFLAGS": place.text(row, row.link_flags)}
    for command in (configure_command(row, place), build_command):
        if not _logged(command, log, place.root, environment):
            end = log.read_text(encoding="utf-8", errors="replace").splitlines()
            raise RowFailed("it does not build:\n" + "\n".join(end[-BUILD_LINES_SHOWN:]))
    if not (folder / row.program).is_file():
        raise RowFailed(f"the build left no {folder / row.program}")


@dataclasses.dataclass(frozen=True)
class Ran:
    exit: int
    out: str
    err: str

    def said(self) -> str:
        """The last lines of what it said, for a verdict."""
        lines = (self.err.strip() or self.out.strip()).splitlines()
        return "\n".join(lines[-BUILD_LINES_SHOWN:])


def run(row: Row, place: Place, arguments: list[str]) -> Ran:
    """Runs the row's program in the repository's root. Paths in `arguments` are relative to it, so
    that they mean the same to a program of another system."""
    environment = os.environ | {name: place.text(row, value) for name, value in row.environment}
    command = [place.text(row, word) for word in row.runner]
    command += [str(place.folder(row) / row.program)] + arguments
    try:
        done = subprocess.run(command, cwd=place.root, env=environment, capture_output=True,
                              stdin=subprocess.DEVNULL, timeout=row.timeout_s, check=False)
    except subprocess.TimeoutExpired as expired:
        raise RowFailed(f"'{' '.join(arguments)}' took more than {row.timeout_s} s") from expired
    except OSError as error:
        raise RowFailed(f"it does not start: {error}") from error
    out = done.stdout.decode(errors="replace").replace("\r\n", "\n")
    err = done.stderr.decode(errors="replace").replace("\r\n", "\n")
    with (place.folder(row) / "run.log").open("a", encoding="utf-8") as log:
        log.write(f"$ {' '.join(command)}\n{out}{err}exit {done.returncode}\n")
    return Ran(done.returncode, out, err)
