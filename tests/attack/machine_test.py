"""Machines that lie: a clock that is set, a disk that loses what was not flushed, a network file system that is late.

The command runs with a library before all others (tests/attack/shims) that plays the machine.

    python3 machine_test.py PATH_TO_MOTTLE
"""

import os
import sys

import attack
import support
from attack import demand, demand_an_answer
from kills_test import SOLVER

COMMANDS = [
    ("update", "study.toml", "--set", "update.samples=300", "--set", "update.iterations=3"),
    ("propagate", "study.toml", "--set", "update.samples=2000"),
    ("update", "solver.toml", "--set", "update.samples=6", "--set", "update.iterations=1"),
]
FILES = {"update": ("history.csv", "cloud-final.csv"), "propagate": ("cloud.csv",)}
DAY = 86400


class Machine(attack.Family):
    """A few commands and what they leave on a machine that is as it should be."""

    source = ""

    def prepare(self):
        self.library = str(attack.shim(self.folder, self.source))
        self.write("study.toml", support.STUDY)
        self.write("tests.csv", support.TESTS)
        self.write("input.txt", "{{k1}} {{k2}}\n")
        self.write("solver.py", SOLVER.replace("time.sleep(0.01)\n", ""))
        self.write("solver.toml", support.command_study([os.path.realpath(sys.executable), "-S", "-E", "solver.py"]))
        self.whole = {}
        for command in COMMANDS:
            self.remove("out")
            self.succeed(*command, "--out", "out", "--quiet")
            self.whole[command] = self.contents(command)

    def contents(self, command):
        """What is there of the results."""
        out = self.folder / "out"
        found = {name: (out / name).read_bytes() for name in FILES[command[0]] if (out / name).exists()}
        if (out / "result.json").exists():
            found["result.json"] = self.numbers()
        return found

    def demand_whole_or_absent(self, command):
        for name, text in self.contents(command).items():
            demand(text == self.whole[command][name], f"{name} is there and not whole")

    def shimmed(self, command, *more, **settings):
        environment = {"LD_PRELOAD": self.library, **{name: str(value) for name, value in settings.items()}}
        return self.call(*command, "--out", "out", "--quiet", *more, environment=environment)

    def demand_resumed(self, command):
        demand_an_answer(self.call(*command, "--out", "out", "--quiet", "--resume"), allowed=(0,))
        demand(self.contents(command) == self.whole[command], "other numbers than those of the whole run")


class PowerLoss(Machine):
    """The power goes after a rename; what was not flushed before it is lost."""

    title = "power lost after a rename, and with it what was not flushed"
    few = 15
    many = 600
    source = "flush.c"

    def attack(self, chance, number):
        command = COMMANDS[number % len(COMMANDS)]
        place = 1 + number // len(COMMANDS) % 8
        self.doing = f"power lost at rename {place} of {command[0]} {command[1]}"
        self.remove("out")
        ended = self.shimmed(command, SHIM_RENAME=place, SHIM_LOSE=1)
        demand(ended.code in (0, 98), f"ended with {ended.code}: {attack.told(ended)}")
        self.demand_whole_or_absent(command)
        self.demand_resumed(command)


class FailingFlush(Machine):
    """fsync fails from one call on."""

    title = "a disk whose flush fails"
    few = 15
    many = 600
    source = "flush.c"

    def attack(self, chance, number):
        command = COMMANDS[number % len(COMMANDS)]
        place = 1 + number // len(COMMANDS) % 10
        self.doing = f"flush {place} of {command[0]} {command[1]} fails"
        self.remove("out")
        ended = self.shimmed(command, SHIM_FSYNC=place)
        demand_an_answer(ended, allowed=(0, 3))
        demand(ended.code == 0 or "flushed" in ended.err or "Input/output error" in ended.err, f"said {attack.told(ended)}")
        self.demand_whole_or_absent(command)
        demand(ended.code == 3 or self.contents(command) == self.whole[command], "ended with 0 without its results")
        demand(not list((self.folder / "out").glob("*.partial")), "half a file is left")
        self.demand_resumed(command)


class Clocks(Machine):
    """The time of day jumps, or is of another century; files are from the future."""

    title = "clocks that jump, years before 1970 and after 2106, files of the future"
    few = 9
    many = 300
    source = "clock.c"

    def attack(self, chance, number):
        command = COMMANDS[number % len(COMMANDS)]
        shift = chance.choice([0, -80 * 365 * DAY, 100 * 365 * DAY, 300 * 365 * DAY, -DAY])
        jump = chance.choice([0, 1, DAY, 50 * 365 * DAY])
        self.doing = f"a clock {shift} s off that jumps by {jump} s, {command[0]} {command[1]}"
        if chance.random() < 0.5:
            self.remove("out")
        for path in [*self.folder.iterdir(), *(self.folder / "out").glob("*")]:
            age = chance.choice([0, 1, 4102444800, 1700000000])
            os.utime(path, (age, age))
        demand_an_answer(self.shimmed(command, SHIM_SHIFT=shift, SHIM_JUMP=jump), allowed=(0,))
        demand(self.contents(command) == self.whole[command], "other numbers than by a clock that goes well")


class LateFiles(Machine):
    """A network file system: whatever is opened, renamed or flushed takes its time."""

    title = "a file system that is late"
    few = 3
    many = 100
    source = "late.c"

    def attack(self, chance, number):
        command = COMMANDS[number % len(COMMANDS)]
        delay = chance.choice([1, 3, 8])
        self.doing = f"{delay} ms each file, {command[0]} {command[1]}"
        self.remove("out")
        demand_an_answer(self.shimmed(command, SHIM_DELAY_MS=delay), allowed=(0,))
        demand(self.contents(command) == self.whole[command], "other numbers than those of a fast file system")


class MachineTest(attack.AttackTest):
    def test_power_loss(self):
        self.assertIn(98, self.survive(PowerLoss).codes, "no power was lost")

    def test_a_flush_that_fails(self):
        self.assertIn(3, self.survive(FailingFlush).codes, "no flush has failed")

    def test_clocks(self):
        self.survive(Clocks)

    def test_late_files(self):
        self.survive(LateFiles)


if __name__ == "__main__":
    attack.main()
