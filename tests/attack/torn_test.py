"""Journals, kept runs and caches that are cut, flipped, mixed up: used, done again or refused, never wrong numbers.

The process is killed as soon as a file has so many bytes, looked for every half millisecond: it may have written more, or ended.

    python3 torn_test.py PATH_TO_MOTTLE
"""

import os
import shutil
import sys
import time

import attack
import mutation_test
import readers
import support
from attack import demand, demand_an_answer
from kills_test import FEW, SOLVER
from support import STUDY, edited

JOURNALLED = edited(STUDY, ("samples = 200", "samples = 4000"), ("iterations = 30", "iterations = 6"))
CACHED = """
[update]
samples = 30
iterations = 1
"""


def cut_at_the_end(chance, data):
    return data[:max(0, len(data) - chance.randrange(1, 60))]


def flip_in_the_head(chance, data):
    return mutation_test.flip(chance, data[:80]) + data[80:]


def append_noise(chance, data):
    return data + chance.randbytes(5000)


def append_itself(_, data):
    return data + data


def fill_with_zeros(chance, data):
    """What a file system leaves of blocks that were never written."""
    begin = chance.randrange(len(data)) // 512 * 512
    return data[:begin] + bytes(len(data) - begin)


def empty(_chance, _data):
    return b""


MUTATIONS = [mutation_test.flip, mutation_test.flip, mutation_test.cut, mutation_test.leave_out, mutation_test.repeat,
             mutation_test.replace_word, cut_at_the_end, flip_in_the_head, append_noise, append_itself, fill_with_zeros, empty]


class Torn(attack.Family):
    """A file of Mottle's own is damaged; three kinds in turn."""

    title = "torn journals, kept runs and caches"
    few = 30
    many = 3000
    minutes = 30

    def prepare(self):
        self.write("tests.csv", support.TESTS)
        self.write("journal.toml", JOURNALLED)
        self.write("input.txt", "{{k1}} {{k2}}\n")
        self.write("solver.py", SOLVER.replace("time.sleep(0.01)\n", ""))
        self.write("store.toml", support.command_study([os.path.realpath(sys.executable), "-S", "-E", "solver.py"]))
        for name in ("airframe.bdf", "specimens.csv"):
            shutil.copy(readers.AIRFRAME / name, self.folder)
        study = (readers.AIRFRAME / "study.toml").read_text(encoding="utf-8")
        self.write("cache.toml", study)
        self.jobs = [
            ("journal", ("update", "journal.toml"), "resume.journal", ("--resume",)),
            ("store", ("update", "store.toml", *FEW), "runs.store", ()),
            ("cache", ("propagate", "cache.toml", "--set", "update.samples=30", "--cache", "cache"), None, ()),
        ]
        self.whole, self.files = {}, {}
        for name, arguments, file, _ in self.jobs:
            self.succeed(*arguments, "--out", "whole", "--quiet")
            self.whole[name] = self.numbers("whole")
            if name == "journal":
                self.interrupt(arguments, file)
            path = next((self.folder / "cache").iterdir()) if file is None else self.folder / "whole" / file
            self.files[name] = (path.name, path.read_bytes())
            self.remove("whole")

    def interrupt(self, arguments, file):
        """Leaves the journal of a run that was killed on its way."""
        journal = self.folder / "whole" / file
        for _ in range(20):
            self.remove("whole")
            process = self.start(*arguments, "--out", "whole", "--quiet")
            end = time.monotonic() + 60 * support.PATIENCE
            while process.poll() is None and time.monotonic() < end:
                if journal.exists() and journal.stat().st_size > 250000:
                    break
                time.sleep(0.0005)
            process.kill()
            process.wait()
            if journal.exists():
                return
        raise AssertionError("the run was over before it was killed, twenty times")

    def attack(self, chance, number):
        name, arguments, file, resume = self.jobs[number % len(self.jobs)]
        own, content = self.files[name]
        mutations = chance.choices(MUTATIONS, k=chance.choice([1, 1, 2]))
        self.doing = f"{own if file else 'cache entry'}: {', '.join(mutation.__name__ for mutation in mutations)}"
        for mutation in mutations:
            content = mutation(chance, content) if content else content
        self.remove("out", "cache")
        self.write(f"out/{own}" if file else f"cache/{own}", content)
        if file and chance.random() < 0.5:
            resume = ("--resume",)
        ended = self.call(*arguments, "--out", "out", "--quiet", *resume)
        # A journal or store whose head is another's is refused; a cache is made again.
        demand_an_answer(ended, allowed=(0, 2) if file else (0,))
        if ended.code == 2:
            demand(own in ended.err, f"refused for another reason: {attack.told(ended)}")
            demand(not (self.folder / "out" / "result.json").exists(), "refused, and left a result")
            self.remove(f"out/{own}")
            demand_an_answer(self.call(*arguments, "--out", "out", "--quiet"), allowed=(0,))
        demand(self.numbers() == self.whole[name], "other numbers than with the whole file")


class TornTest(attack.AttackTest):
    def test_a_torn_file_gives_no_wrong_number(self):
        self.survive(Torn)


if __name__ == "__main__":
    attack.main()
