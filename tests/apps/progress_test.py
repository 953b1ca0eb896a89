"""What the command shows while it runs, on a terminal and elsewhere, with a solver that takes its time. Nothing here
depends on how busy the machine is; what is said of the time left is tested with given times, in progress_line_test.cpp.

    python3 progress_test.py PATH_TO_MOTTLE
"""

import os
import pty
import re
import subprocess
import time
import unittest

import support

SOLVER = """\
import math, time
k1, k2 = (float(word) for word in open("in.txt").read().split())
time.sleep(0.03)
mean, half = (k1 + 2 * k2) / 2, math.sqrt(k1 * k1 / 4 + k2 * k2)
for value in (mean - half, mean + half):
    print(math.sqrt(value) / (2 * math.pi))
"""

STUDY = """\
title = "A solver that takes its time"
seed = 3

[model]
kind = "command"
templates = ["in.txt.template"]
files = ["solver.py"]
command = ["python3", "-S", "-E", "solver.py"]
timeout = "20 s"
parallel = 1

[model.frequencies]
file = "stdout.txt"
format = "column"
column = 1

""" + support.two_masses(samples=8, iterations=2)

ERASE = "\r\033[K"


class Shown:
    """What came on standard error, piece by piece with its time since the start."""

    def __init__(self, arguments, folder, columns):
        self.pieces = []
        environment = {name: value for name, value in os.environ.items() if name not in ("HOME", "XDG_CACHE_HOME")}
        reader, writer = pty.openpty() if columns else os.pipe()
        if columns:
            subprocess.run(["stty", "cols", str(columns)], stdin=writer, check=True)
        start = time.monotonic()
        with subprocess.Popen([support.MOTTLE, *arguments], cwd=folder, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=writer, env=environment) as process:
            os.close(writer)
            while piece := self.read(reader):
                self.pieces.append((time.monotonic() - start, piece))
            process.communicate()
            self.code = process.returncode
        self.seconds = time.monotonic() - start
        os.close(reader)
        self.text = "".join(piece for _, piece in self.pieces)

    @staticmethod
    def read(reader):
        try:
            return os.read(reader, 65536).decode("utf-8")
        except OSError:  # the other end of a terminal is closed
            return ""

    def lines(self):
        """Each state of the line that is rewritten, with its time."""
        return [(at, line) for at, piece in self.pieces for line in piece.split(ERASE) if line]


class ProgressTest(support.CommandTest):
    update = None  # of a wide terminal, and its log

    def setUp(self):
        super().setUp()
        self.write("solver.py", SOLVER)
        self.write("in.txt.template", "{{k1}}\n{{k2:%20.14e}}\n")
        self.write("study.toml", STUDY)
        self.write("tests.csv", support.TWO_MASSES_TESTS)

    def show(self, *arguments, columns=0):
        shown = Shown(arguments, self.folder, columns)
        self.assertEqual(shown.code, 0, shown.text)
        return shown

    def shown_update(self):
        """What a wide terminal shows of an update, and its log: one run for all tests."""
        if ProgressTest.update is None:
            shown = self.show("update", "study.toml", "--out", "r", columns=120)
            ProgressTest.update = shown, (self.folder / "r" / "mottle.log").read_text()
        return ProgressTest.update

    def test_a_terminal_shows_phases_with_their_share_and_time(self):
        shown, _ = self.shown_update()
        self.assertEqual(shown.lines()[0][1], "reading the model and the tests")
        phases = []
        for _, line in shown.lines():
            name = re.split("[:,]", line)[0]
            if phases[-1:] != [name]:
                phases.append(name)
        for name in ("cloud before the update", "iteration 1 of at most 2", "iteration 2 of at most 2"):
            self.assertIn(name, phases)
        self.assertRegex(shown.text, r"iteration 1 of at most 2: model runs \d+ of \d+ \(\d+ %\)")
        self.assertNotRegex(shown.text, r"(?<![\d.])0 s")
        self.assertTrue(shown.text.endswith(ERASE), "the line is taken away at the end")

    def test_a_narrow_terminal_has_one_line_that_is_not_wrapped(self):
        shown = self.show("propagate", "study.toml", columns=30)
        self.assertTrue(shown.lines())
        self.assertLess(max(len(line) for _, line in shown.lines()), 30)

    def test_elsewhere_plain_lines_come_early_and_then_seldom(self):
        shown = self.show("update", "study.toml")
        self.assertLess(shown.pieces[0][0], 0.5 * shown.seconds, "the first line does not wait for the work")
        self.assertNotIn("\033", shown.text)
        self.assertNotIn("\r", shown.text)
        self.assertLess(len(shown.text.splitlines()), 2 + shown.seconds / 10.0)

    def test_what_is_quiet_shows_nothing(self):
        self.assertEqual(self.show("propagate", "study.toml", "--quiet", columns=80).text, "")

    def test_the_log_says_how_the_phases_shared_the_time(self):
        last = self.shown_update()[1].splitlines()[-1]
        self.assertRegex(last, r"time: cloud before the update \d+\.\d\d s \(\d+ %\)")
        self.assertRegex(last, r"iteration \d+\.\d\d s \(\d+ %, 2 of them\)")
        self.assertAlmostEqual(sum(int(share) for share in re.findall(r"\((\d+) %", last)), 100, delta=4)


if __name__ == "__main__":
    support.main()
