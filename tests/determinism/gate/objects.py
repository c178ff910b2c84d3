#!/usr/bin/env python3
"""Reads compiled objects: no fused multiply-add, no estimate, nothing imported outside a list, and
no name shared with a unit that only some processors can run.

    objects.py [--objdump PROGRAM] [--nm PROGRAM]
               [--imports FILE | --any-imports | --instructions-only] FILE...

FILE is an archive, an object or a linked program of any processor of instructions.py. Imports are
what no FILE defines. Exit status 0 when clean, 1 with one line for each finding, 2 when a file
cannot be judged: unknown processor, no machine code, a tool that fails.
"""

import argparse
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from instructions import X87, Processor, processor_of, why_forbidden

IMPORTS = Path(__file__).with_name("imports.txt")
PREFIXES = {"lock", "rep", "repz", "repnz", "data16", "cs", "ds", "es", "fs", "gs", "ss", "bnd"}


# On 32-bit x86 GCC turns an unsigned 64-bit integer, which nlohmann's numbers may be, into a double
# by fild and, where the top bit is set, fadds of 2^64: exact in the 64 bits of x87, rounded once by
# the store. No other instruction, and no other object.
X87_EXACT = (re.compile(r"json_(reader|writer)\.cpp\.o"), re.compile(r"fadds +\S+\(%e[a-z]+\)"))


# On PowerPC the table of a switch lies in the code, behind the jump that reads it: distances back to
# the function, 0xffff.... each, which a disassembler takes for no instruction or for one of these.
POWERPC_TABLE = re.compile(r"\.long 0xffff[0-9a-f]{4}|fn?m(add|sub)s? f31,f31,f\d+,f31")


# Where solver/CMakeLists.txt compiles units for some processors alone. Everywhere else such a unit is
# there, and never called.
WIDE_FORMAT = "elf64-x86-64"


@dataclass(frozen=True)
class WideUnits:
    """Units compiled for processors that have a set of instructions, and what every name that they
    define holds: the width of their lanes (solver/lanes.hpp). Of two copies of an inline function the
    linker keeps one for everybody."""

    instructions: str
    width: int
    register: str

    def have(self, member: str) -> bool:
        return re.fullmatch(rf".*_{self.instructions.lower()}(\.cpp)?\.o(bj)?", member) is not None

    def own(self, name: str) -> bool:  # As nm demangles it, or as it could not.
        return re.search(rf"\b{self.width}\b|Li{self.width}E", name) is not None


WIDE_UNITS = (WideUnits("AVX2", 264, "%ymm"), WideUnits("AVX512", 528, "%zmm"))


def units_of(member: str) -> WideUnits | None:
    return next((units for units in WIDE_UNITS if units.have(member)), None)


class CannotJudge(Exception):
    """Nothing was found because nothing was read."""


@dataclass(frozen=True)
class Instruction:
    """One line of a disassembly, and where it stands."""

    member: str  # Of the archive: "step.cpp.o"; the file itself where it is no archive.
    function: str
    text: str
    file_format: str  # As objdump names it.
    processor: Processor


@dataclass
class Imports:
    """Patterns of names, by pattern of the object that may import them."""

    allowed: list[tuple[re.Pattern[str], re.Pattern[str]]]

    def allow(self, member: str, name: str) -> bool:
        return any(m.fullmatch(member) and n.fullmatch(name) for m, n in self.allowed)


def glob(pattern: str) -> re.Pattern[str]:
    """`*` is any text; all else is itself, brackets too."""
    return re.compile(".*".join(re.escape(part) for part in pattern.split("*")))


def read_imports(text: str) -> Imports:
    """`[object]` begins a section, `#` a reason; every other line is the pattern of a name."""
    allowed: list[tuple[re.Pattern[str], re.Pattern[str]]] = []
    member = None
    for line in text.splitlines():
        if line.startswith("[") and line.endswith("]"):
            member = glob(line[1:-1])
        elif line and not line.startswith("#"):
            if member is None:
                raise CannotJudge(f"the list of imports names {line} before any [object]")
            allowed.append((member, glob(line)))
    return Imports(allowed)


def output_of(command: list[str]) -> str:
    """What a program prints; CannotJudge where it fails."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise CannotJudge(f"{command[0]}: {error.strerror}") from error
    if done.returncode != 0:
        raise CannotJudge(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout


def instructions(disassembly: str) -> Iterator[Instruction]:
    """Every instruction that objdump prints, with the function and the object around it."""
    member, function, file_format, processor, in_table = "", "", "", None, False
    for line in disassembly.splitlines():
        if match := re.match(r"(\S.*):\s+file format (\S+)", line):
            member, file_format = Path(match[1]).name, match[2].lower()
            processor = processor_of(file_format)
            if processor is None:
                raise CannotJudge(f"{match[1]}: no list of instructions for {match[2]}")
        elif match := re.match(r"[0-9a-f]+ <(.*)>:$", line):
            function = match[1]
        elif match := re.match(r"\s*[0-9a-f]+:\s+(\S.*)$", line):
            if processor is None:
                raise CannotJudge("a disassembly that does not name its file format")
            words = match[1].split()
            while len(words) > 1 and (words[0] in PREFIXES or words[0] == "{evex}"):
                words = words[1:]
            in_table = in_table and POWERPC_TABLE.fullmatch(" ".join(words)) is not None
            if in_table:
                continue
            in_table = words[0] == "bctr"
            yield Instruction(member, function, " ".join(words), file_format, processor)


def is_exact_x87(one: Instruction, reason: str) -> bool:
    member, text = X87_EXACT
    return reason == X87 and bool(member.fullmatch(one.member) and text.fullmatch(one.text))


def forbidden_instructions(disassembly: str) -> tuple[list[str], int]:
    """One line for each forbidden instruction, and each wide unit that was compiled without those that
    it is for; and how many instructions were read."""
    findings: list[str] = []
    count = 0
    is_wide: dict[str, bool] = {}
    known: dict[tuple[str, str], str] = {}
    for one in instructions(disassembly):
        count += 1
        key = (one.processor.file_format, one.text)
        if key not in known:
            known[key] = why_forbidden(one.processor, one.text)
        if known[key] and not is_exact_x87(one, known[key]):
            findings.append(f"{one.member}: {one.function}: {one.text}\n  {known[key]}")
        units = units_of(one.member)
        if units is not None and one.file_format == WIDE_FORMAT:
            is_wide[one.member] = is_wide.get(one.member, False) or units.register in one.text
    findings += [f"{member}: holds no instruction of its own\n  compile it for its processors, or "
                 "nothing of it is worth choosing" for member, wide in is_wide.items() if not wide]
    return findings, count


def names_by_member(listing: str, file: str) -> Iterator[tuple[str, str, bool]]:
    """(object, name, whether it defines the name for others) of every line of nm -A."""
    for line in listing.splitlines():
        match = re.match(r"(.*?):\s*(?:[0-9a-f]{6,})?\s*([A-Za-z?-]) (.*)$", line)
        if match is None:
            continue
        # "archive.a:member.o: " of GNU, "archive.a: member.o: " of LLVM, "object.o: " of both.
        member = Path(match[1].rstrip(":").split(":")[-1].strip() or file).name
        if match[2] in "Uwv" or match[2].isupper() or match[2] == "u":
            yield member, match[3], match[2] not in "Uwv"


def foreign_imports(listings: Iterable[tuple[str, str]], imports: Imports) -> list[str]:
    """One line for each name that an object needs, that no file defines, and that is not listed."""
    needed: dict[tuple[str, str], None] = {}
    defined: set[str] = set()
    for file, listing in listings:
        for member, name, is_defined in names_by_member(listing, file):
            if "__gnu_lto_slim" in name:
                raise CannotJudge(f"{file}: {member} holds no machine code yet (-flto); give the "
                                  "linked program and --instructions-only")
            if is_defined:
                defined.add(name)
            else:
                needed[(member, name)] = None
    if not defined:
        raise CannotJudge("no names were read")
    return [
        f"{member}: imports {name}\n  not in the list: the solver takes no libm, clock, chance, "
        "environment, locale or streams; where it is harmless, add it to imports.txt, and say why"
        for member, name in needed
        if name not in defined and not imports.allow(member, name)
    ]


# Where code moves, GCC keeps the address of what unwinds in a variable of this name: one for all units.
POINTER_OF_GCC = "DW.ref."


def shared_names(listings: Iterable[tuple[str, str]]) -> list[str]:
    """One line for each name of a wide unit that another unit could use by accident."""
    definitions = [
        (member, name, units_of(member))
        for file, listing in listings
        for member, name, is_defined in names_by_member(listing, file)
        if is_defined and not name.startswith(POINTER_OF_GCC)
    ]
    of_wide = {name: units for _, name, units in definitions if units is not None}
    findings = [
        f"{member}: defines {name}\n  it would run on processors without {units.instructions}; inline it "
        f"always, or give it the width {units.width}"
        for member, name, units in definitions
        if units is not None and not units.own(name)
    ]
    findings += [
        f"{member}: defines {name}\n  so does a unit for {of_wide[name].instructions}, which passes "
        "lanes in other registers"
        for member, name, units in definitions
        if units is None and name in of_wide
    ]
    return findings


def judge(arguments: argparse.Namespace) -> tuple[list[str], str]:
    """All findings, and a sentence on what was read."""
    findings: list[str] = []
    total = 0
    for file in arguments.files:
        command = [arguments.objdump, "-d", "-C", "--no-show-raw-insn", file]
        found, count = forbidden_instructions(output_of(command))
        if count == 0:
            raise CannotJudge(f"{file}: no machine code in it")
        findings += found
        total += count
    summary = f"{total} instructions in {len(arguments.files)} files"
    if arguments.instructions_only:
        return findings, summary
    listings = [(file, output_of([arguments.nm, "-A", "-C", file])) for file in arguments.files]
    findings += shared_names(listings)
    if arguments.any_imports:
        return findings, summary + ", and all names"
    imports = read_imports(Path(arguments.imports).read_text(encoding="utf-8"))
    findings += foreign_imports(listings, imports)
    return findings, summary + ", and all imports"


def main(words: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--objdump", default="objdump", help="of the target")
    parser.add_argument("--nm", default="nm", help="of the target")
    parser.add_argument("--imports", default=str(IMPORTS), help="the list of allowed imports")
    parser.add_argument("--any-imports", action="store_true", help="for other compilers and flags")
    parser.add_argument("--instructions-only", action="store_true", help="for linked programs")
    parser.add_argument("files", nargs="+", metavar="FILE")
    try:
        findings, summary = judge(parser.parse_args(words))
    except (CannotJudge, OSError) as error:
        print(f"objects.py: {error}", file=sys.stderr)
        return 2
    for finding in findings:
        print(finding)
    print(f"{len(findings)} findings; read {summary}")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
