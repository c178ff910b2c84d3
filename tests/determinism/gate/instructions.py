"""What no machine code of the solver may hold, by the processor that it is for.

Each processor names its instructions otherwise; the reasons are three. FUSED rounds once where the
source rounds twice, so only some processors would. ESTIMATE is a table of the processor's maker.
EXCESS is arithmetic in another format than float: x87, or NEON of 32-bit ARM, which flushes
subnormal numbers to zero.
"""

import re
from dataclasses import dataclass

FUSED = "a fused multiply-add: compile with -ffp-contract=off, and on x86 -mno-fma -mno-avx512f"
ESTIMATE = "an estimate that differs between processors: write 1 / x and sqrt(x)"
X87 = "x87 arithmetic: compile with -msse2 -mfpmath=sse"
FLUSHES = "NEON arithmetic, which flushes subnormals: compile with -mfpu=vfpv3-d16"

X86_FUSED = r"v?4?fn?m(add|sub)(sub|add)?\d*[ps][shd]|vfn?m(add|sub|addsub|subadd)\w*|vfc?maddc\w*"
X86_ESTIMATE = r"v?(rcp|rsqrt)(14|28)?[ps][shd]"
X87_ARITHMETIC = (
    r"fi?(add|sub|subr|mul|div|divr)(p|s|l)?|fsqrt|fsin|fcos|fsincos|fptan|fpatan|f2xm1|fyl2x|"
    r"fyl2xp1|fscale|fprem1?|frndint"
)


@dataclass(frozen=True)
class Processor:
    """How one family of processors is recognised, and what its code may not hold."""

    file_format: str  # What objdump says behind "file format", as a pattern.
    forbidden: tuple[tuple[str, str], ...]  # Pattern of the whole instruction, and why.


PROCESSORS = (
    Processor(
        r"elf64-x86-64|pe-x86-64|pei-x86-64",
        ((X86_FUSED, FUSED), (X86_ESTIMATE, ESTIMATE), (X87_ARITHMETIC, X87)),
    ),
    Processor(
        r"elf32-i386|pe-i386|pei-i386",
        ((X86_FUSED, FUSED), (X86_ESTIMATE, ESTIMATE), (X87_ARITHMETIC, X87)),
    ),
    Processor(
        r"elf64-(little|big)?-?aarch64",
        (
            (r"fn?m(add|sub|ad|sb)|fn?ml[as]l?[bt2]?|fcmla|fmmla|bfml\w+|bfmmla", FUSED),
            (r"(f|u)r(ecp|sqrt)[esx]", ESTIMATE),
        ),
    ),
    Processor(
        # VFP's vmla rounds its product and its sum, as the source does: allowed.
        r"elf32-(little|big)?-?arm",
        (
            (r"vfn?m[as]\w*(\.\w+)*|vcmla(\.\w+)*", FUSED),
            (r"vr(ecp|sqrt)[es](\.\w+)*", ESTIMATE),
            (r"v(add|sub|mul|ml[as]|abd|padd)\w*\.f32\s+[dq].*", FLUSHES),
        ),
    ),
    Processor(
        r"elf64-(little)?riscv",
        (
            (r"fn?m(add|sub)\.[shdq]|vfn?w?n?m(acc|sac|add|sub)\.\w+", FUSED),
            (r"vf(rec7|rsqrt7)\.v", ESTIMATE),
        ),
    ),
    Processor(
        r"elf64-powerpc(le)?",
        (
            (r"fn?m(add|sub)s?\.?|x[sv]n?m(add|sub)[am]?(sp|dp|qpo?)|vn?m(add|sub)fp", FUSED),
            (r"frsqrtes?\.?|fres?\.?|x[sv]r(sqrt)?e(sp|dp)|vr(sqrt)?efp", ESTIMATE),
        ),
    ),
    Processor(r"elf64-s390", ((r"m[as][edx]b?r?|[vw]fn?m[as]([sdx]b)?", FUSED),)),
    Processor(
        r"wasm", ((r"[fi]\d+x\d+\.relaxed_\w+", "relaxed: the engine may fuse; leave it out"),)
    ),
)


def processor_of(file_format: str) -> Processor | None:
    """The family of what objdump calls this; None where there is no list for it."""
    for processor in PROCESSORS:
        if re.fullmatch(processor.file_format, file_format):
            return processor
    return None


def why_forbidden(processor: Processor, instruction: str) -> str:
    """Why the code may not hold this instruction; "" where it may."""
    words = instruction.split(maxsplit=1)
    for pattern, reason in processor.forbidden:
        if re.fullmatch(pattern, instruction) or re.fullmatch(pattern, words[0]):
            return reason
    return ""
