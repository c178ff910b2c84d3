"""Tests of bench/instructions.py, on numbers that are made up."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench"))

import instructions  # noqa: E402

COUNT = instructions.Count("room", 60, 20, 1_000_000, "00ff")


class Complaints(unittest.TestCase):
    def test_two_percent_are_slack(self) -> None:
        for count in (980_000, 1_000_000, 1_020_000):
            now = instructions.replace(COUNT, instructions=count)
            self.assertEqual(instructions.complaint(COUNT, now), "")

    def test_more_and_less_are_seen(self) -> None:
        for count, word in ((1_020_001, "more"), (979_999, "less")):
            now = instructions.replace(COUNT, instructions=count)
            self.assertIn(word, instructions.complaint(COUNT, now))

    def test_another_motion_is_seen(self) -> None:
        now = instructions.replace(COUNT, digest="00fe")
        self.assertIn("another motion", instructions.complaint(COUNT, now))


class Files(unittest.TestCase):
    def test_what_is_written_is_read(self) -> None:
        comments, counts = instructions.parse("# why\n" + COUNT.text())
        self.assertEqual((comments, counts), (["# why\n"], [COUNT]))

    def test_bad_lines_are_named(self) -> None:
        for text in ("room 60 20 1000\n", "room 60 x 1 2\n"):
            with self.assertRaisesRegex(ValueError, "line 1"):
                instructions.parse(text)
        with self.assertRaisesRegex(ValueError, "no scene"):
            instructions.parse("# nothing\n")

    def test_a_count_of_nothing_is_an_error(self) -> None:
        self.assertEqual(instructions.collected("==1== Collected : 12\n"), 12)
        for text in ("==1== Collected : 0\n", ""):
            with self.assertRaises(ValueError):
                instructions.collected(text)


class Committed(unittest.TestCase):
    def test_has_three_scenes_with_numbers(self) -> None:
        file = pathlib.Path(instructions.__file__).with_name("instructions.txt")
        _, counts = instructions.parse(file.read_text(encoding="utf-8"))
        self.assertEqual(len(counts), 3)
        for count in counts:
            self.assertGreater(count.instructions, 0)
            self.assertEqual(len(count.digest), 16)


if __name__ == "__main__":
    unittest.main()
