"""Compiles a user's file with flags that Cycloid refuses, and reads what the compiler says.

CXX and FLAGS (those of the solver) come from the environment, as does SOURCE, the root.
"""

import os
import platform
import shlex
import subprocess
import tempfile
import unittest

CXX = os.environ.get("CXX", "g++")
FLAGS = shlex.split(os.environ.get("FLAGS", ""))
SOURCE = os.environ.get("SOURCE", ".")
X86 = platform.machine() == "x86_64"
# No standard header, so that 32-bit builds need no 32-bit library.
USER = '#include "solver/arithmetic.hpp"\nfloat f() { return cycloid::solver::opaque(1.0f); }\n'
# The public interface; every header with arithmetic includes the one above.
HEADERS = ("solver/world.hpp", "solver/lanes.hpp", "solver/dim.hpp", "scenes/simulation.hpp")


def compile_user(text: str, *flags: str) -> tuple[int, str]:
    """The compiler's exit status, and what it says."""
    command = [CXX, "-std=c++20", *flags, "-I", SOURCE, "-isystem", "/usr/include/eigen3",
               "-fsyntax-only", "-x", "c++", "-"]
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    return done.returncode, done.stderr


def is_gcc() -> bool:
    done = subprocess.run([CXX, "--version"], capture_output=True, text=True, check=True)
    return "clang" not in done.stdout


class Refusals(unittest.TestCase):
    def refused(self, *flags: str, remedy: str, text: str = USER) -> None:
        with self.subTest(flags=flags):
            status, message = compile_user(text, *flags)
            self.assertNotEqual(status, 0, "it compiles")
            self.assertIn("Cycloid refuses", message)
            self.assertIn(remedy, message)

    def accepted(self, *flags: str) -> None:
        with self.subTest(flags=flags):
            status, message = compile_user(USER, *flags)
            self.assertEqual(status, 0, message)

    def test_fast_math_and_what_it_is_made_of(self) -> None:
        for flag in ("-ffast-math", "-Ofast", "-ffinite-math-only"):
            self.refused(flag, remedy="-fno-fast-math")
        if is_gcc():  # Clang tells no macro of these: World.create sees what they do.
            for flag in ("-funsafe-math-optimizations", "-freciprocal-math", "-fno-signed-zeros"):
                self.refused(flag, remedy="-fno-fast-math")
        self.accepted("-O2")
        self.accepted("-O2", *FLAGS)

    def test_every_public_header_with_arithmetic_refuses(self) -> None:
        for header in HEADERS:
            self.refused("-ffast-math", remedy="-fno-fast-math", text=f'#include "{header}"\n')

    def test_a_program_with_free_arithmetic_does_not_link(self) -> None:
        text = USER + "int main() { return cycloid::solver::rounds_as_written(); }\n"
        with tempfile.TemporaryDirectory() as folder:
            for free, status in (([], 0), (["-DCYCLOID_FREE_ARITHMETIC"], 1)):
                command = [CXX, "-std=c++20", *free, "-I", SOURCE, "-x", "c++", "-",
                           "-o", f"{folder}/a"]
                done = subprocess.run(command, input=text, capture_output=True, text=True,
                                      check=False)
                self.assertEqual(done.returncode != 0, status != 0, done.stderr)
                self.assertEqual("kMeasuresFreeArithmetic" in done.stderr, status != 0)

    @unittest.skipUnless(X86, "only x86 has an x87")
    def test_x87(self) -> None:
        self.refused("-m32", "-mno-sse", remedy="-msse2 -mfpmath=sse")
        self.accepted("-m32", "-msse2", "-mfpmath=sse")
        if is_gcc():
            self.refused("-m32", "-msse2", "-mfpmath=387", remedy="-msse2 -mfpmath=sse")
            self.refused("-mfpmath=387", remedy="-msse2 -mfpmath=sse")

    @unittest.skipUnless(X86 and is_gcc(), "GCC for x86 fuses in spite of -ffp-contract=off")
    def test_gcc_with_fused_instructions(self) -> None:
        self.refused("-march=x86-64-v3", "-ffp-contract=off", remedy="-mno-fma")
        self.refused("-march=x86-64-v4", "-mno-fma", remedy="-mno-avx512f")
        self.refused("-mfma4", remedy="-mno-fma4")
        self.accepted("-march=x86-64-v4", *FLAGS)


if __name__ == "__main__":
    unittest.main()
