"""Limits of files, descriptors, memory and places: a message and exit code 3, or the numbers of a run without limits.

    python3 limits_test.py PATH_TO_MOTTLE
"""

import json
import os
import resource
import sys
import time
import unittest

import attack
import support
from attack import demand, demand_an_answer
from kills_test import SOLVER

MEGABYTE = 1 << 20
COMMANDS = [
    ("update", "study.toml", "--set", "update.samples=400", "--set", "update.iterations=4"),
    ("propagate", "study.toml", "--set", "update.samples=5000"),
    ("update", "solver.toml", "--set", "update.samples=6", "--set", "update.iterations=1"),
]


class Limited(attack.Family):
    """What limits are put on, and what ends they may come to."""

    few = 16
    commands = COMMANDS

    def prepare(self):
        self.write("study.toml", support.edited(support.STUDY, ('"tests.csv"', '"tests.csv"\nrepeatability = { "f*" = "0.5 %" }')))
        self.write("tests.csv", support.TESTS)
        self.write("input.txt", "{{k1}} {{k2}}\n")
        self.write("solver.py", SOLVER.replace("time.sleep(0.01)\n", ""))
        self.write("solver.toml", support.command_study([os.path.realpath(sys.executable), "-S", "-E", "solver.py"]))
        self.whole = {}
        for command in self.commands:
            self.succeed(*command, "--out", "out", "--quiet")
            self.whole[command] = self.result()
            self.remove("out")

    def result(self):
        """The command's result, without its timings."""
        for name in ("result.json", "diagnosis.json"):
            if (self.folder / "out" / name).exists():
                result = json.loads((self.folder / "out" / name).read_text(encoding="utf-8"))
                if result.get("stage") == "linear":  # of a diagnosis whose fits did not come to be written, as it says
                    return None
                return {key: value for key, value in result.items() if key != "timings_s"}
        return None

    def demand_all_or_nothing(self, command, allowed=(0, 3), **how):
        self.remove("out")
        ended = self.call(*command, "--out", "out", "--quiet", **how)
        demand_an_answer(ended, allowed=allowed)
        if ended.code == 0:
            demand(self.result() == self.whole[command], "other numbers than without the limit")
        else:
            demand(self.result() in (None, self.whole[command]), "half a result")
        return ended


class FileSizes(Limited):
    """RLIMIT_FSIZE: no file may grow beyond it; the journal, the results, the report."""

    title = "limits on the size of files"
    many = 500

    def attack(self, chance, number):
        command = self.commands[number % len(self.commands)]
        limit = int(2 ** chance.uniform(0, 21))
        self.doing = f"ulimit -f of {limit} bytes, {command[0]} {command[1]}"
        self.demand_all_or_nothing(command, limits=((resource.RLIMIT_FSIZE, limit),))


class Places(Limited):
    """A temporary folder that is not there, places that are files, links to nothing, or without end."""

    title = "places that are missing or not what they should be"
    few = many = 8

    def attack(self, chance, number):
        kind = number % 8
        self.remove("out", "place")
        command = self.commands[number // 8 % len(self.commands)]
        self.doing = f"place {kind}, {command[0]} {command[1]}"
        if kind == 0:
            self.demand_all_or_nothing(command, environment={"TMPDIR": "/no/such/place"})
            return
        if kind == 1:
            self.demand_all_or_nothing(command, environment={"TMPDIR": str(self.write("place", ""))})
            return
        if kind == 2:
            os.symlink("place", self.folder / "place")
        elif kind == 3:
            os.symlink("/proc/self/nowhere", self.folder / "place")
        elif kind == 4:
            self.write("place", "mine\n")
        out = {5: "/dev/null", 6: "/proc/self", 7: "x" * 300}.get(kind, "place")
        ended = self.call(*command, "--out", out, "--quiet")
        demand_an_answer(ended, allowed=(2, 3))
        demand(kind != 4 or (self.folder / "place").read_text(encoding="utf-8") == "mine\n", "a file of the user is gone")


class Descriptors(Limited):
    """RLIMIT_NOFILE, from hardly enough for the libraries."""

    title = "limits on open files"
    allowed = (0, 3)
    many = 300

    def attack(self, chance, number):
        command = self.commands[number % len(self.commands)]
        limit = chance.randrange(5, 16)
        self.doing = f"ulimit -n {limit}, {command[0]} {command[1]}"
        # A solver that cannot start is a failed run; too many of those end the job.
        self.demand_all_or_nothing(command, self.allowed, limits=((resource.RLIMIT_NOFILE, limit),))


class Memory(Limited):
    """RLIMIT_AS, from what the libraries take before anything begins (about 400 MB) to plenty."""

    title = "limits on memory"
    few, many = 6, 400
    seconds = 30

    def attack(self, chance, number):
        command = COMMANDS[number % 3]
        limit = int(2 ** chance.uniform(8.7, 11) * MEGABYTE)
        self.doing = f"ulimit -v {limit // 1024}, {command[0]} {command[1]}"
        self.demand_all_or_nothing(command, memory=limit)


class DiagnosisFileSizes(FileSizes):
    """A journal that cannot be written is no model that fails."""

    title = "limits on the size of files, diagnose"
    commands = [("diagnose", "study.toml")]
    few, many = 3, 20


class FullStreams(Limited):
    """A standard error that takes nothing."""

    title = "a full standard error"
    few, many = 3, 3

    def attack(self, chance, number):
        arguments = [("check", "nowhere.toml"), ("update", "nowhere.toml"), ("update", "study.toml", "--out", "/dev/null")][number]
        self.doing = f"{' '.join(arguments)} 2>/dev/full"
        with open("/dev/full", "wb") as full:
            status, _ = attack.wait(self.start(*arguments, err=full), time.monotonic() + 60 * support.PATIENCE)
        demand(status in (2, 3), f"ended with {status}")


class LimitsTest(attack.AttackTest):
    @unittest.skipIf(attack.IS_INSTRUMENTED, "what watches the command writes files of its own")
    def test_limits_of_file_sizes(self):
        self.assertIn(3, self.survive(FileSizes).codes, "no limit was met")

    @unittest.skipIf(attack.IS_INSTRUMENTED, "what watches the command takes memory of its own")
    def test_limits_of_memory(self):
        self.survive(Memory)

    @unittest.skipIf(attack.IS_INSTRUMENTED, "what watches the command writes files of its own")
    def test_a_journal_that_cannot_be_written(self):
        self.survive(DiagnosisFileSizes)

    def test_a_full_standard_error(self):
        self.survive(FullStreams)

    def test_places(self):
        self.survive(Places)

    @unittest.skipIf(attack.IS_INSTRUMENTED, "what watches the command opens files of its own")
    def test_limits_of_open_files(self):
        self.assertNotEqual(self.survive(Descriptors).codes, {0}, "no limit was met")


if __name__ == "__main__":
    attack.main()
