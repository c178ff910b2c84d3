"""Plants what objects.py has to find, and sees it found. CXX, OBJDUMP, NM and FLAGS (those of the
solver) come from the environment; the planted objects are of this machine's processor."""

import contextlib
import io
import os
import platform
import shlex
import subprocess
import tempfile
import unittest
from pathlib import Path

import objects
from instructions import processor_of, why_forbidden

CXX = os.environ.get("CXX", "g++")
OBJDUMP = os.environ.get("OBJDUMP", "objdump")
NM = os.environ.get("NM", "nm")
FLAGS = shlex.split(os.environ.get("FLAGS", ""))
X86 = platform.machine() == "x86_64"
WITH_FUSED = ["-march=x86-64-v3"] if X86 else []

# By the name of the file format: instructions that are found, and their harmless neighbours.
INSTRUCTIONS = {
    "elf64-x86-64": (
        "vfmadd132ss %xmm0,%xmm1,%xmm2; vfmaddsub231ps %ymm0,%ymm1,%ymm2; vfnmadd213sd; "
        "vfmsubadd132ps; vfmaddps %xmm0,%xmm1; v4fmaddps; rcpps; vrcp14ps; rsqrtss; vrsqrt28sd; "
        "faddp; fmuls (%rax); fsqrt",
        "vaddps %ymm0,%ymm1; vmulss; vaddsubps; vsqrtps; vdivss; vpmaddwd; flds (%rax); "
        "vfpclassps; vpsadbw; prefetcht0; vpmadd52luq",
    ),
    "elf32-i386": ("fadds 0x0(%ebx); fmulp; fidivl", "fildll (%esp); fstps; fxch; addss"),
    "pe-x86-64": ("vfmadd231ss", "mulss"),
    "elf64-littleaarch64": (
        "fmadd s0, s1, s2, s3; fnmsub s0; fmla v0.4s, v1.4s, v2.s[0]; fmls; fcmla; fmlal2; fnmad; "
        "frecpe; frsqrts; fmad z0.s",
        "fmul v0.4s; fadd; fsqrt; madd x0, x1; mla v0.4s; fmov; frintm; fcvtzs; fcmle; smlal",
    ),
    "elf32-littlearm": (
        "vfma.f32 s0, s1; vfnms.f64; vrecpe.f32 q0; vrsqrts.f32; vadd.f32 q8, q9; vmla.f32 d0, d1",
        "vmla.f32 s0, s1, s2; vmls.f64 d0, d1; vadd.f64 d0, d1; vmul.f32 s0, s1; vadd.i32 q0, q1",
    ),
    "elf64-littleriscv": (
        "fmadd.s; fnmsub.d; vfmacc.vv; vfrsqrt7.v",
        "fmul.s; fadd.s; fmv.w.x; vfmul.vv",
    ),
    "elf64-powerpcle": (
        "fmadds f0; fnmsub; xvmaddasp; xsnmsubmdp; vmaddfp; vnmsubfp; fres; xvrsqrtesp",
        "fmuls; fadds; xvmulsp; maddld; xssqrtsp; fmr; vmsumuhm",
    ),
    "elf64-s390": (
        "maebr; madb; msebr; wfmadb; vfmasb; wfnmssb",
        "meebr; aebr; msgr; vfmaxsb; ms; msy",
    ),
    "wasm": ("f32x4.relaxed_madd", "f32x4.mul; f32x4.add"),
}


class Planted(unittest.TestCase):
    """A folder for objects, and the gate run on them."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def compile(self, text: str, *flags: str, name: str = "planted") -> str:
        source, target = self.folder / f"{name}.cpp", self.folder / f"{name}.o"
        source.write_text(text, encoding="utf-8")
        command = [CXX, "-std=c++20", "-O2", *flags, "-c", str(source), "-o", str(target)]
        subprocess.run(command, check=True)
        return str(target)

    def gate(self, *words: str) -> tuple[int, str]:
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            status = objects.main(["--objdump", OBJDUMP, "--nm", NM, *words])
        return status, out.getvalue() + err.getvalue()

    def expect(self, file: str, status: int, *parts: str) -> None:
        found, text = self.gate(file)
        self.assertEqual(found, status, text)
        for part in parts:
            self.assertIn(part, text)


class Objects(Planted):
    def test_a_clean_object_is_clean(self) -> None:
        self.expect(self.compile("float f(float a, float b) { return a * b + a; }", *FLAGS), 0)

    def test_a_fused_operation_is_named_with_its_object_and_function(self) -> None:
        text = "float fused(float a) { return __builtin_fmaf(a, a, a); }"
        file = self.compile(text, *WITH_FUSED)
        self.expect(file, 1, "planted.o: fused(float): ", "fused multiply-add")

    @unittest.skipUnless(X86, "the estimates of this test are those of x86")
    def test_an_estimate_is_found(self) -> None:
        text = 'float f(float a) { asm("rsqrtss %0, %0" : "+x"(a)); return a; }'
        self.expect(self.compile(text), 1, "planted.o: f(float): rsqrtss", "estimate")

    @unittest.skipUnless(X86, "only x86 has wide units")
    def test_names_of_wide_units_hold_their_width_and_are_theirs_alone(self) -> None:
        for suffix, width, register in (("avx2", 264, "ymm"), ("avx512", 528, "zmm")):
            kernel = f"""template <int W> struct K {{
              static int f(int a) {{ asm("vaddps %{register}0, %{register}0, %{register}0"); return a; }}
            }};
            """
            wide = kernel + f"template struct K<{width}>;\n"
            shared = "inline int g(int a) { return a; }\nauto* used = &g;\n"
            own = self.compile(wide, name=f"kernels_{suffix}")
            self.expect(own, 0)
            more = self.compile(wide + shared, name=f"more_{suffix}")
            self.expect(more, 1, f"more_{suffix}.o: defines g(int)")
            other = self.compile(wide)
            status, text = self.gate(own, other)
            self.assertEqual(status, 1, text)
            self.assertIn(f"planted.o: defines K<{width}>::f(int)", text)
            self.assertEqual(self.gate("--any-imports", own, other)[0], 1)
            narrow = self.compile(kernel + "template struct K<8>;\n" + shared)
            self.assertEqual(self.gate(own, narrow)[0], 0)

    @unittest.skipUnless(X86, "only x86 has wide units")
    def test_a_wide_unit_without_an_instruction_of_its_own_is_found(self) -> None:
        for suffix, width in (("avx2", 264), ("avx512", 528)):
            text = (f"template <int W> struct K {{ static int f(int a) {{ return a; }} }};\n"
                    f"template struct K<{width}>;")
            self.expect(self.compile(text, name=f"kernels_{suffix}"), 1,
                        f"kernels_{suffix}.o: holds no instruction")

    @unittest.skipUnless(X86, "only x86 has AVX-512")
    def test_the_fused_operations_of_avx512_are_found(self) -> None:
        text = 'void f() { asm("vfmaddsub132ps %zmm0, %zmm0, %zmm0"); }'
        self.expect(self.compile(text, name="planted"), 1, "fused multiply-add")

    def test_a_unit_for_avx2_is_an_ordinary_one_where_it_is_not_compiled_for_avx2(self) -> None:
        for file_format, findings in (("elf64-x86-64", 1), ("pe-x86-64", 0), ("elf64-littleaarch64", 0)):
            text = f"kernels_avx2.cpp.o:     file format {file_format}\n00000000 <f>:\n  88:\tret\n"
            self.assertEqual(len(objects.forbidden_instructions(text)[0]), findings, file_format)

    @unittest.skipUnless(X86, "only x86 has an x87")
    def test_x87_is_found(self) -> None:
        self.expect(self.compile("long double f(long double a) { return a + a; }"), 1, "x87")

    def test_only_the_exact_conversion_of_json_is_let_through(self) -> None:
        def listing(member: str, text: str) -> str:
            return f"{member}:     file format elf32-i386\n00000000 <f>:\n  88:\t{text}\n"

        for member, text, findings in (("json_reader.cpp.o", "fadds  0x0(%edi)", 0),
                                       ("json_reader.cpp.o", "fmuls  0x0(%edi)", 1),
                                       ("step.cpp.o", "fadds  0x0(%edi)", 1)):
            found, count = objects.forbidden_instructions(listing(member, text))
            self.assertEqual((len(found), count), (findings, 1), member + " " + text)

    def test_the_table_of_a_switch_is_no_instruction(self) -> None:
        head = "a.o:     file format elf64-powerpcle\n00000000 <f>:\n"
        table = " 10:\tbctr\n 14:\t.long 0xfffffaa4\n 18:\tfnmsub  f31,f31,f15,f31\n"
        code = " 1c:\tnop\n 20:\tfnmsub  f31,f31,f15,f31\n"
        self.assertEqual(objects.forbidden_instructions(head + table), ([], 1))
        found, count = objects.forbidden_instructions(head + table + code)
        self.assertEqual((len(found), count), (1, 3))

    def test_imports_outside_the_list_are_found(self) -> None:
        for name, text in {
            "sinf": '#include <cmath>\nfloat f(float a) { return std::sin(a); }',
            "fmaf": "float f(float a) { return __builtin_fmaf(a, a, a); }",
            "clock_gettime": "#include <ctime>\nint f(timespec* t) { return clock_gettime(0, t); }",
            "rand": "#include <cstdlib>\nint f() { return rand(); }",
            "getenv": '#include <cstdlib>\nchar* f() { return getenv("A"); }',
            "std::cout": '#include <iostream>\nvoid f() { std::cout << 1; }',
            "pthread_self": "#include <pthread.h>\nauto f() { return pthread_self(); }",
            "std::_Hash_bytes": "#include <string>\nauto f(const std::string& s) {"
            " return std::hash<std::string>{}(s); }",
            "std::thread::join()": "#include <thread>\nvoid f(std::thread& t) { t.join(); }",
        }.items():
            if name == "fmaf" and not X86:
                continue  # An instruction of its own there: the other test.
            with self.subTest(name):
                self.expect(self.compile(text, "-ffp-contract=off"), 1, f"imports {name}")

    def test_what_another_file_defines_is_no_import(self) -> None:
        caller = self.compile("int g(); int f() { return g() + 1; }")
        self.expect(caller, 1, "imports g()")
        os.rename(caller, self.folder / "caller.o")
        callee = self.compile("int g() { return 1; }")
        status, text = self.gate(str(self.folder / "caller.o"), callee)
        self.assertEqual(status, 0, text)

    def test_what_another_file_keeps_for_itself_is_an_import(self) -> None:
        caller = self.compile("int g(); int f() { return g() + 1; }")
        os.rename(caller, self.folder / "caller.o")
        text = "[[gnu::used]] static int g() { return 1; }\nint h() { return g(); }"
        status, text = self.gate(str(self.folder / "caller.o"), self.compile(text))
        self.assertEqual(status, 1, text)

    def test_what_cannot_be_judged_is_no_success(self) -> None:
        self.expect(self.compile("int x;"), 2, "no machine code")
        self.expect(str(self.folder / "missing.o"), 2)
        self.assertEqual(self.gate("--objdump", "no-such-program", "x.o")[0], 2)
        self.assertIsNone(processor_of("elf64-unheard-of"))
        with self.assertRaises(objects.CannotJudge):
            objects.forbidden_instructions("a.o:     file format elf64-unheard-of\n")
        with self.assertRaises(objects.CannotJudge):
            objects.foreign_imports([("a.a", "a.a:a.o:0000000000 C __gnu_lto_slim\n")],
                                    objects.Imports([]))


class Instructions(unittest.TestCase):
    def test_each_processor_finds_its_own_and_no_neighbour(self) -> None:
        for name, (bad, good) in INSTRUCTIONS.items():
            processor = processor_of(name)
            self.assertIsNotNone(processor, name)
            for text in bad.split("; "):
                self.assertTrue(why_forbidden(processor, text), f"{name}: {text} is not found")
            for text in good.split("; "):
                self.assertFalse(why_forbidden(processor, text), f"{name}: {text} is found")


# The vectoriser of GCC 12 makes fused operations of these in spite of -ffp-contract=off.
ROTATION = """
struct P { float x, y; };
void rotate(P* __restrict to, const P* __restrict from, float c, float s, int n) {
  for (int i = 0; i < n; ++i) {
    to[i].x = c * from[i].x - s * from[i].y;
    to[i].y = s * from[i].x + c * from[i].y;
  }
}
void rotate_two(float* __restrict to, const float* __restrict from, float c, float s) {
  to[0] = c * from[0] - s * from[1];
  to[1] = s * from[0] + c * from[1];
  to[2] = c * from[2] - s * from[3];
  to[3] = s * from[2] + c * from[3];
}
"""


def is_gcc_12() -> bool:
    macros = subprocess.run([CXX, "-dM", "-E", "-x", "c++", "/dev/null"], capture_output=True,
                            text=True, check=True).stdout
    return "__clang__" not in macros and "#define __GNUC__ 12\n" in macros


@unittest.skipUnless(X86, "the trap's flags are those of x86")
class Trap(Planted):
    MACHINES = ("x86-64-v3", "x86-64-v4")
    LEVELS = ("-O2", "-O3")

    @unittest.skipUnless(is_gcc_12(), "the trap is one of GCC 12")
    def test_gcc_12_fuses_in_spite_of_contract_off_and_the_gate_sees_it(self) -> None:
        for machine, *less in (("x86-64-v3",), ("x86-64-v4", "-mno-fma")):
            for level in self.LEVELS:
                with self.subTest(machine=machine, level=level):
                    file = self.compile(ROTATION, level, f"-march={machine}", *less,
                                        "-ffp-contract=off")
                    self.expect(file, 1, "rotate", "vfmaddsub")

    def test_the_flags_of_the_solver_do_not(self) -> None:
        self.assertIn("-mno-fma", FLAGS)
        for machine in self.MACHINES:
            for level in self.LEVELS:
                with self.subTest(machine=machine, level=level):
                    self.expect(self.compile(ROTATION, level, f"-march={machine}", *FLAGS), 0)


if __name__ == "__main__":
    unittest.main()
