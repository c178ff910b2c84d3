"""What the matrix makes of programs that are wrong, of compilers that are missing, and of words
that it does not know. The build is a fake one; the program is a script."""

import contextlib
import io
import json
import os
import pathlib
import stat
import subprocess
import sys
import tempfile
import tomllib
import unittest
from unittest import mock

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import build  # noqa: E402
import main  # noqa: E402

ROWS = """
reference = "good"
goldens = "goldens.txt"
[logs]
scenes = ["hill"]
ticks = 2
[checks]
full = [{ticks = 100}, {ticks = 10, workers = 2, lanes = 1}]
short = [{ticks = 10}]
[[row]]
name = "good"
group = "right"
target = "here"
compiler = "sh"
flags = ""
checks = "full"
environment = {FAKE = "good"}
[[row]]
name = "other"
group = "wrong"
target = "here"
compiler = "sh"
flags = ""
checks = "full"
environment = {FAKE = "OTHER"}
[[row]]
name = "absent"
group = "missing"
target = "nowhere"
compiler = "no-such-compiler-g++"
packages = ["g++-nowhere"]
flags = ""
checks = "full"
[[row]]
name = "no-cpu"
group = "missing"
target = "here"
compiler = "sh"
cpu = ["avx1024"]
flags = ""
checks = "full"
"""

# Does what a program of the matrix does; FAKE says what is wrong with it.
PROGRAM = r"""#!@python@
import json, os, pathlib, sys
fake, words = os.environ["FAKE"], sys.argv[1:]
def option(name):
    return words[words.index(name) + 1]
def digest(tick):
    return "bad" if fake == "digest" and tick >= 37 else f"{tick:03x}"
if words[:2] == ["golden", "check"]:
    ticks = int(option("--ticks"))
    wrong = fake == "digest" and ticks >= 37 or fake == "lanes" and option("--lanes") == "1"
    done = 1 if fake == "lazy" else ticks
    scenes = [{"scene": scene, "ticks": done, "verdict": "good", "exit": 0}
              for scene in ("hill", "valley")]
    if wrong:
        scenes[1].update(exit=1, verdict="tick 100: expected digest 64, found bad")
    print("" if fake == "silent" else json.dumps({"scenes": scenes}))
    sys.exit(int(wrong))
if words[0] == "run":
    ticks = int(option("--ticks"))
    if "--log" in words:
        pathlib.Path(option("--log")).write_text("torn" if fake == "log" else "log")
    elif option("--digest-every") == "1":
        print("\n".join(f"{tick} {digest(tick)}" for tick in range(1, ticks + 1)))
if words[0] == "verify":
    torn = 0
    for log in sorted(pathlib.Path(words[1]).glob("*.cylog")):
        bad = log.read_text() == "torn"
        torn |= bad
        print(f"{log}: {'torn' if bad else 'good'}, 2 ticks")
    sys.exit(3 if torn else 0)
"""


class MatrixTest(unittest.TestCase):
    """Every test has a repository of its own with the rows above."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "goldens.txt").write_text(
            "cycloid-golden 1\nscene hill 100 0 0\nscene valley 100 0 0\n", encoding="utf-8")

    def matrix(self, *words: str, fake: str = "good", breaks: bool = False,
               built: list[str] | None = None) -> tuple[int, str]:
        """Runs the script with a build that lays the fake program down; exit and output. Appends
        the rows that were built to `built`."""
        rows_file = self.root / "rows.toml"
        rows_file.write_text(ROWS.replace("OTHER", fake), encoding="utf-8")

        def fake_build(command: list[str], log: pathlib.Path, *_: object) -> bool:
            if "--build" in command:
                program = pathlib.Path(command[2]) / "cycloid"
                program.write_text(PROGRAM.replace("@python@", sys.executable), encoding="utf-8")
                program.chmod(program.stat().st_mode | stat.S_IXUSR)
                log.write_text("x.cpp:1: error: no such thing\n", encoding="utf-8")
                (built if built is not None else []).append(log.parent.name)
            return not (breaks and "--build" in command)

        said = io.StringIO()
        with mock.patch.object(build, "_logged", fake_build), \
                contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            try:
                code = main.main(["--rows-file", str(rows_file), "--root", str(self.root), *words])
            except SystemExit as usage:
                code = int(usage.code or 0)
        return code, said.getvalue()

    def record(self, row: str) -> dict[str, object]:
        text = (self.root / "build/matrix/matrix.json").read_text(encoding="utf-8")
        return next(record for record in json.loads(text)["rows"] if record["row"] == row)

    def test_programs_that_agree_are_equal(self) -> None:
        code, said = self.matrix("--group", "right", "--group", "wrong")
        self.assertEqual(code, 0, said)
        self.assertIn("2 of 2 rows equal, 0 failed, 440 digests", said)
        self.assertEqual(self.record("other")["digests"], 2 * 100 + 2 * 10)
        self.assertEqual(self.record("other")["logs"], 2)
        table = (self.root / "build/matrix/matrix.csv").read_text(encoding="utf-8")
        self.assertEqual(len(table.splitlines()), 3)

    def test_a_wrong_digest_fails_the_row_and_the_first_tick_is_named(self) -> None:
        code, said = self.matrix("--row", "good", "--row", "other", fake="digest")
        self.assertEqual(code, 1)
        self.assertIn("valley first differs from good at tick 37: bad instead of 025", said)
        self.assertEqual(self.record("good")["verdict"], "equal")
        self.assertEqual(self.record("other")["verdict"], "FAILED")

    def test_the_reference_is_built_for_the_first_tick_where_it_was_not_asked_for(self) -> None:
        code, said = self.matrix("--row", "other", fake="digest")
        self.assertEqual(code, 1)
        self.assertIn("first differs from good at tick 37", said)

    def test_one_setting_that_differs_is_enough(self) -> None:
        code, said = self.matrix("--row", "other", fake="lanes")
        self.assertEqual(code, 1)
        self.assertIn("10 ticks, 2 workers, 1 lanes: valley", said)

    def test_a_quick_run_compares_what_the_row_says_of_it(self) -> None:
        other = 'environment = {FAKE = "OTHER"}\n'
        quick = ROWS.replace(other, other + 'quick = true\nquick_checks = "short"\n')
        with mock.patch.object(sys.modules[__name__], "ROWS", quick):
            for words, digests in ((["--quick"], 2 * 10), (["--row", "other"], 2 * 100 + 2 * 10)):
                code, said = self.matrix(*words)
                self.assertEqual(code, 0, said)
                self.assertEqual(self.record("other")["digests"], digests)

    def test_a_program_that_compares_too_little_fails(self) -> None:
        for fake, reason in (("lazy", "not every tick was compared of hill, valley"),
                             ("silent", "100 ticks, 1 workers, 4 lanes:")):
            code, said = self.matrix("--row", "other", fake=fake)
            self.assertEqual(code, 1, fake)
            self.assertIn(reason, said)

    def test_a_log_that_one_row_wrote_fails_all_that_verify_it(self) -> None:
        code, said = self.matrix("--row", "good", "--row", "other", fake="log")
        self.assertEqual(code, 1)
        self.assertIn("(written by other)", str(self.record("good")["reason"]))
        self.assertIn("0 of 2 rows equal", said)

    def test_a_missing_compiler_or_processor_fails_with_the_reason(self) -> None:
        code, said = self.matrix("--group", "missing")
        self.assertEqual(code, 1)
        self.assertIn("FAILED: the compiler no-such-compiler-g++ is missing (package g++-nowhere)",
                      said)
        self.assertIn("FAILED: this processor lacks avx1024", said)
        self.assertIn("0 of 2 rows equal, 2 failed", said)

    def test_a_fused_operation_in_an_object_fails_the_row(self) -> None:
        objdump = self.root / "objdump"
        for instruction, code in (("vaddss", 0), ("vfmadd213ss", 1)):
            lines = ["x.o:     file format elf64-x86-64", "0000 <turn>:",
                     f"  0: {instruction} %xmm0,%xmm1,%xmm2"]
            objdump.write_text("#!/bin/sh\n" + "".join(f"echo '{line}'\n" for line in lines),
                               encoding="utf-8")
            objdump.chmod(0o755)
            reads = ROWS.replace('name = "other"', 'name = "other"\nobjdump = "{root}/objdump"')
            with mock.patch.object(sys.modules[__name__], "ROWS", reads):
                found, said = self.matrix("--row", "other")
            self.assertEqual(found, code, said)
            self.assertEqual("its objects: x.o: turn: vfmadd213ss" in said, code == 1, said)

    def git(self, *words: str) -> None:
        who = ["-c", "user.name=t", "-c", "user.email=t@t.example"]
        subprocess.run(["git", *who, *words], cwd=self.root, check=True, capture_output=True)

    def test_a_resumed_run_keeps_rows_that_were_equal_of_the_same_sources(self) -> None:
        (self.root / ".gitignore").write_text("/build/\n/rows.toml\n", encoding="utf-8")
        self.git("init")
        self.git("add", "-A")
        self.git("commit", "-m", "first")
        rows = ["--row", "good", "--row", "other"]
        self.matrix(*rows, fake="lanes")
        built: list[str] = []
        code, said = self.matrix(*rows, "--resume", built=built)
        self.assertEqual((code, built), (0, ["other"]), said)  # It failed, so it is run again.
        self.assertIn("2 of 2 rows equal, 0 failed, 440 digests", said)
        code, said = self.matrix(*rows, "--resume", built=built)
        self.assertEqual((code, built), (0, ["other"]), said)
        self.assertEqual(self.record("good")["logs"], 2)  # Logs are exchanged all the same.
        self.matrix(*rows, built=built)
        self.assertEqual(built, ["other", "good", "other"])
        del built[:]
        (self.root / "build/matrix/good/cycloid").unlink()
        self.matrix(*rows, "--resume", built=built)
        self.assertEqual(built, ["good"])
        (self.root / "goldens.txt").write_text("cycloid-golden 1\nscene valley 100 0 0\n"
                                               "scene hill 100 0 0\n", encoding="utf-8")
        del built[:]
        self.matrix(*rows, "--resume", built=built)
        self.assertEqual(built, ["good", "other"])  # A file differs from the commit.
        self.git("commit", "-a", "-m", "second")
        del built[:]
        self.matrix(*rows, "--resume", built=built)
        self.assertEqual(built, ["good", "other"])  # The goldens are others.
        (self.root / "server.cpp").write_text("of no row", encoding="utf-8")
        self.git("add", "-A")
        self.git("commit", "-m", "third")
        del built[:]
        self.matrix(*rows, "--resume", built=built)
        self.assertEqual(built, [])
        (self.root / "solver").mkdir()
        (self.root / "solver/step.cpp").write_text("of every row", encoding="utf-8")
        self.git("add", "-A")
        self.git("commit", "-m", "fourth")
        self.matrix(*rows, "--resume", built=built)
        self.assertEqual(built, ["good", "other"])

    def test_a_build_that_breaks_fails_with_the_end_of_its_log(self) -> None:
        self.matrix("--row", "good")
        code, said = self.matrix("--row", "good", breaks=True)
        self.assertEqual(code, 1)
        self.assertIn("x.cpp:1: error: no such thing", said)

    def test_unknown_words_are_usage_errors(self) -> None:
        for words in (["--row", "nix"], ["--group", "nix"], ["--nix"], ["--quick"]):
            code, said = self.matrix(*words)
            self.assertEqual(code, 2, said)

    def test_rows_with_unknown_or_missing_fields_are_refused(self) -> None:
        for text, reason in ((ROWS + 'colour = "red"\n', "there is no field 'colour'"),
                             (ROWS.replace('target = "nowhere"\n', ""), "'target' is missing"),
                             (ROWS + 'quick_checks = "nix"\n', "quick_checks: there are none"),
                             (ROWS.replace('name = "other"', 'name = "good"'), "is there 2 times")):
            with mock.patch.object(sys.modules[__name__], "ROWS", text):
                code, said = self.matrix("--list")
            self.assertEqual(code, 2)
            self.assertIn(reason, said)


class RowsTest(unittest.TestCase):
    """The real rows.toml."""

    def test_list_prints_every_row_of_the_file_in_its_order(self) -> None:
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            self.assertEqual(main.main(["--list"]), 0)
        with (HERE / "rows.toml").open("rb") as stream:
            rows = tomllib.load(stream)["row"]
        listed = [line.split()[0] for line in said.getvalue().splitlines()[1:]]
        self.assertEqual(listed, [row["name"] for row in rows])
        self.assertGreater(len(rows), 30)

    def test_toolchain_files_scenes_and_quick_rows_exist(self) -> None:
        with (HERE / "rows.toml").open("rb") as stream:
            document = tomllib.load(stream)
        root = HERE.parents[2]
        for row in document["row"]:
            if "toolchain" in row:
                self.assertTrue((root / "cmake/toolchains" / row["toolchain"]).is_file(), row)
        named = [scene for checks in document["checks"].values() for check in checks
                 for scene in check.get("scenes", [])] + document["logs"]["scenes"]
        for scene in named:
            self.assertTrue((root / f"scenes/catalogue/{scene}.json").is_file(), scene)
        self.assertTrue(any(row.get("quick") for row in document["row"]))


if __name__ == "__main__":
    os.chdir(HERE)
    unittest.main()
