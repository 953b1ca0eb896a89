"""Killed at any moment, resumed, killed again: what is there is whole, and the end is that of an undisturbed run.

Moments are parts of the time that an undisturbed run took: on a machine that is busy by turns, some come after the end.

    python3 kills_test.py PATH_TO_MOTTLE
"""

import os
import signal
import sys
import time

import attack
import support
from attack import demand, demand_an_answer
from support import PATIENCE, STUDY, edited

LONG = edited(STUDY, ("samples = 200", "samples = 25000"), ("iterations = 30", "iterations = 8"))
SOLVER = """\
import time
time.sleep(0.01)
k1, k2 = map(float, open("input.txt").read().split())
if 1.99 < k1 < 2.0:
    raise SystemExit("no")
open("f.txt", "w").write(f"{k1 / 10}\\n{(k1 + k2) / 12}\\n{(k1 + 2 * k2) / 13}\\n")
"""
FEW = ("--set", "update.samples=10", "--set", "update.iterations=2")
# (name, arguments, files that a finished run leaves and that are complete as soon as they are there)
JOBS = [
    ("update", ("update", "long.toml"), ("history.csv", "cloud-initial.csv", "cloud-final.csv", "clouds.csv")),
    ("an update by a solver", ("update", "solver.toml", *FEW), ("history.csv", "cloud-final.csv")),
    ("propagate", ("propagate", "long.toml", "--set", "update.samples=150000"), ("cloud.csv",)),
]


class Kills(attack.Family):
    """One to three kills in one run, then its end."""

    title = "kills at random moments, then --resume"
    few = 12
    many = 1000
    minutes = 60
    seconds = 120

    def prepare(self):
        self.write("long.toml", LONG)
        self.write("tests.csv", support.TESTS)
        self.write("input.txt", "{{k1}} {{k2}}\n")
        self.write("solver.py", SOLVER)
        self.write("solver.toml", support.command_study([os.path.realpath(sys.executable), "-S", "-E", "solver.py"]))
        self.whole, self.durations = {}, {}
        for name, arguments, files in JOBS:
            began = time.monotonic()
            self.succeed(*arguments, "--out", "whole", "--quiet")
            self.durations[name] = time.monotonic() - began
            self.whole[name] = self.contents("whole", files)
            self.remove("whole")

    def contents(self, folder, files):
        texts = {file: (self.folder / folder / file).read_bytes() for file in files}
        return {"result.json": self.numbers(folder), **texts}

    def kill(self, arguments, moment, number):
        process = self.start(*arguments, "--out", "out", "--quiet")
        time.sleep(moment)
        os.kill(process.pid, number)
        status, _ = attack.wait(process, time.monotonic() + 30 * PATIENCE)
        demand(status is not None, f"no end within 30 s of {number.name}")
        demand(status in (0, 4, -number), f"ended with {status} after {number.name}")

    def demand_whole(self, name, files):
        """Files of results are there whole or not at all."""
        out = self.folder / "out"
        for file in files:
            if (out / file).exists():
                demand((out / file).read_bytes() == self.whole[name][file], f"{file} is not that of the whole run after a kill")
        if (out / "result.json").exists():
            demand(self.numbers() == self.whole[name]["result.json"], "result.json is not that of the whole run after a kill")

    def attack(self, chance, number):
        name, arguments, files = JOBS[number % len(JOBS)]
        self.remove("out")
        self.doing = name
        more = ()
        for _ in range(chance.choice([1, 1, 2, 3])):
            moment = chance.uniform(0.0, 1.0) * self.durations[name]
            kind = chance.choice([signal.SIGKILL] * 4 + [signal.SIGTERM, signal.SIGINT])
            self.doing += f", {kind.name} after {moment:.3f} s"
            self.kill((*arguments, *more), moment, kind)
            self.demand_whole(name, files)
            more = ("--resume",)
        ended = self.call(*arguments, "--out", "out", "--quiet", "--resume")
        demand_an_answer(ended, allowed=(0,))
        demand(self.contents("out", files) == self.whole[name], "other numbers than those of the whole run")
        left = {path.name for path in (self.folder / "out").iterdir()}
        demand(not left & {"runs", "resume.journal", ".mottle.lock"}, f"left behind: {left}")
        demand(not any(".partial" in file for file in left), f"half a file is left: {left}")


class KillsTest(attack.AttackTest):
    def test_a_killed_run_ends_with_the_numbers_of_a_whole_one(self):
        self.survive(Kills)


if __name__ == "__main__":
    attack.main()
