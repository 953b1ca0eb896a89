"""A solver that misbehaves costs its own sample: the others' numbers, the files of the user and the job stay as they are.

Runs that hang have a limit of 2 s, in which an honest one, of milliseconds, must be over.

    python3 faults_test.py PATH_TO_MOTTLE
"""

import csv
import os
import sys

import attack
import support
from attack import demand, demand_an_answer
from support import PATIENCE

SOLVER = """\
import os, sys, time
k1, k2 = map(float, open("input.txt").read().split())
values = [k1, k1 + k2, k1 + 2 * k2]
def leave(*texts, end="\\n"):
    with open("f.txt", "w") as file:
        file.write("\\n".join(texts) + end)
def leave_all():
    leave(*map(repr, values))
def leave_child():
    child = os.fork()
    if child == 0:
        os.close(1), os.close(2)
    return child == 0
if k1 > LIMIT:
    import pathlib, shutil, signal, stat
    victim, here = pathlib.Path(VICTIM), os.getcwd()
    FAULT
else:
    leave_all()
"""
# What is wrong with the run: its sample fails.
FAILS = {
    "ends with a status": "leave_all(); sys.exit(3)",
    "crashes": "leave_all(); os.kill(os.getpid(), signal.SIGSEGV)",
    "aborts": "leave_all(); os.abort()",
    "is killed": "leave_all(); os.kill(os.getpid(), signal.SIGKILL)",
    "ends its whole group": "leave_all(); os.killpg(0, signal.SIGTERM); time.sleep(600)",
    "leaves no file": "pass",
    "leaves an empty file": "open('f.txt', 'w').close()",
    "leaves a file that ends too early": "leave(repr(k1), repr(values[1])[:4], end='')",
    "leaves a folder for a file": "os.mkdir('f.txt')",
    "leaves a link to nothing": "os.symlink('nowhere', 'f.txt')",
    "leaves a link to itself": "os.symlink('f.txt', 'f.txt')",
    "makes its file a pipe": "os.mkfifo('f.txt')",
    "makes its file a link to a device": "os.symlink('/dev/zero', 'f.txt')",
    "leaves its file later": "if leave_child(): time.sleep(1.5); leave_all()",
    "loses a mode": "leave(repr(values[0]), repr(values[2]))",
    "gives modes in no order": "leave(*map(repr, values[::-1]))",
    "gives nan": "leave('nan', 'nan', 'nan')",
    "gives infinity": "leave(repr(k1), repr(values[1]), 'inf')",
    "gives what overflows": "leave(repr(k1), repr(values[1]), '1e400')",
    "gives negative frequencies": "leave('-3', '-2', '-1')",
    "gives stars": "leave(repr(k1), '********', repr(values[2]))",
    "gives commas": "leave(*(repr(v).replace('.', ',') for v in values))",
    "gives two numbers in one": "leave(repr(k1), '1.5.2', repr(values[2]))",
    "gives words": "leave('frequencies', 'not', 'found')",
    "gives noise": "open('f.txt', 'wb').write(os.urandom(100000))",
    "gives zeros": "open('f.txt', 'wb').write(bytes(100000))",
    "gives UTF-16": "open('f.txt', 'w', encoding='utf-16').write('1\\n2\\n3\\n')",
    "gives one long line": "leave('1' * 5000)",
    "writes numbers that are not text": "open('f.txt', 'wb').write(b'\\xff\\xfe 1\\n')",
    "prints bytes that are not text": "os.write(2, b'caf\\xe9 \\xff\\x1b[31m\\n'); sys.exit(1)",
    "prints commands to the terminal": "os.write(2, b'\\x1b]0;owned\\x07\\x1b[2J\\r\\0licence denied\\n'); sys.exit(1)",
    "takes its folder away": "shutil.rmtree(here); sys.exit(1)",
    "makes its folder read-only": "os.chmod('.', 0o500); sys.exit(1)",
    "puts a file in place of its folder": "shutil.rmtree(here); open(here, 'w').close(); sys.exit(1)",
    "puts a link in place of its folder": "shutil.rmtree(here); os.symlink(victim.parent, here); sys.exit(1)",
    "makes reason.txt a folder": "os.mkdir('reason.txt'); sys.exit(1)",
    "makes reason.txt a link out of the folder": "os.symlink(victim, 'reason.txt'); sys.exit(1)",
    "makes its mark a link out of the folder": "os.symlink(victim, '.mottle-run'); sys.exit(1)",
    "puts a link in place of what it printed": "os.remove('stderr.txt'); os.symlink(victim, 'stderr.txt'); sys.exit(1)",
    "makes what it printed a second name of a file of the user":
        "os.remove('stdout.txt'); os.link(victim, 'stdout.txt'); sys.exit(1)",
    "leaves a link to a folder of the user": "os.symlink(victim.parent, 'results'); sys.exit(1)",
    "leaves files of strange names": "[open(b'a\\n\\x1b[31m\\xff' + bytes([k]), 'w').close() for k in range(48, 58)]; sys.exit(1)",
    "leaves 3,000 files": "[open(f'{k}', 'w').close() for k in range(3000)]; sys.exit(1)",
    "leaves folders 600 deep": "[(os.mkdir('deep'), os.chdir('deep')) for _ in range(600)]; sys.exit(1)",
    "leaves a socket and a pipe": "os.mkfifo('pipe'); os.mknod('socket', 0o600 | stat.S_IFSOCK); sys.exit(1)",
    "gives one line of 5 MB": "leave('1' * 5000000)",
    "leaves a terabyte of nothing": "open('f.txt', 'wb').truncate(1 << 40)",
}
# The same, by the time limit.
HANGS = {
    "hangs": "leave_all(); time.sleep(600)",
    "hangs and asks not to be stopped": "signal.signal(signal.SIGTERM, signal.SIG_IGN); time.sleep(600)",
    "computes without end": "while True: pass",
    "stops itself": "os.kill(os.getpid(), signal.SIGSTOP)",
    "waits for a child that hangs": "leave_child() and time.sleep(600); os.wait()",
}
# What is odd, but gives the numbers.
PASSES = {
    "writes line ends of another system": "open('f.txt', 'wb').write('\\r\\n'.join(map(repr, values)).encode() + b'\\r\\n')",
    "writes Fortran's exponents": "leave(*(repr(v) + 'D+00' for v in values))",
    "closes its streams": "leave_all(); [os.close(k) for k in (0, 1, 2)]",
    "leaves a child in a session of its own": "leave_all(); leave_child() and (os.setsid(), time.sleep(1))",
    "leaves a link to a file of the user where the disk is tried": "leave_all(); os.symlink(victim, '.mottle-probe')",
    "leaves a pipe where the disk is tried": "leave_all(); os.mkfifo('.mottle-probe')",
    "leaves a child in its group": "leave_all(); leave_child() and time.sleep(30)",
    "makes its file a link within the folder": "leave_all(); os.rename('f.txt', 'g.txt'); os.symlink('g.txt', 'f.txt')",
    "finds 100,000 modes too many": "leave(*map(repr, [*values, *range(99, 100099)]))",
    "has removed its input": "leave_all(); os.remove('input.txt')",
}
MINE = "mine\n" * 300000  # more than is kept of an output
FAULTS = [(name, text, True, False) for name, text in FAILS.items()] + [(name, text, True, True) for name, text in HANGS.items()]
FAULTS += [(name, text, False, False) for name, text in PASSES.items()]
NOMINAL = 2.0  # k1 of the study
PROPAGATE = ("propagate", "solver.toml", "--out", "out", "--quiet", "--set", "update.samples=6", "--set", "update.max_failed=0.9")


class Faults(attack.Family):
    """A fault a run of the command: of six samples one has it."""

    title = "solvers that misbehave"
    few = len(FAULTS)
    many = 100 * len(FAULTS)
    minutes = 60
    table = FAULTS

    def prepare(self):
        self.write("input.txt", "{{k1}} {{k2}}\n")
        self.write("tests.csv", support.TESTS)
        self.python = [os.path.realpath(sys.executable), "-S", "-E", "solver.py"]
        self.references = {}

    def lay_out(self, fault, limit, patience):
        study = support.command_study(self.python).replace("retries = 0\n", f'retries = 0\nparallel = 2\ntimeout = "{patience} s"\n')
        self.write("solver.toml", study)
        victim = self.write("victim/x", MINE)
        self.write("solver.py", SOLVER.replace("VICTIM", repr(str(victim))).replace("LIMIT", repr(limit)).replace("FAULT", fault))

    def cloud(self):
        """Without the last column, the reasons of failures."""
        with open(self.folder / "out" / "cloud.csv", newline="", encoding="utf-8") as file:
            return [row[:-1] for row in csv.reader(file)]

    def reference(self, seed, limit):
        """What must come out where the samples whose k1 is above the limit fail; runs once a seed."""
        if (seed, limit) not in self.references:
            self.lay_out("sys.exit('too stiff')", limit, 60)
            self.remove("out")
            self.succeed(*PROPAGATE, "--seed", seed)
            self.references[seed, limit] = self.cloud()
        return self.references[seed, limit]

    def limit(self, seed):
        """A value of k1 that one sample exceeds."""
        values = sorted(float(row[0]) for row in self.reference(seed, 1e9)[1:])
        return (values[-1] + values[-2]) / 2

    def attack(self, chance, number):
        name, fault, is_failure, is_slow = self.table[number % len(self.table)]
        seed = number // len(self.table) + 7
        limit = self.limit(seed)
        while limit <= NOMINAL:  # the run at the nominal values, which everything needs, is not to be the faulty one
            seed += 1000
            limit = self.limit(seed)
        self.doing = f"a solver that {name}, --seed {seed}"
        expected = self.reference(seed, limit if is_failure else 1e9)
        self.lay_out(fault, limit, 2 * PATIENCE if is_slow else 60)
        self.remove("out")
        ended = self.call(*PROPAGATE, "--seed", seed)
        demand_an_answer(ended, allowed=(0,))
        result = support.read_result(self.folder / "out")
        failed = len(result["failed_evaluations"])
        demand(failed == is_failure, f"{failed} samples failed: {result['failed_evaluations'][:1]}")
        demand(self.cloud() == expected, "the numbers of other samples have changed")
        demand((self.folder / "victim" / "x").read_text(encoding="utf-8") == MINE, "a file of the user has changed")
        demand(len(list((self.folder / "victim").iterdir())) == 1, "something was put beside a file of the user")
        demand(not (self.folder / "out" / "runs").exists(), "folders of runs are left")


class FaultsTest(attack.AttackTest):
    def test_a_fault_costs_its_sample_alone(self):
        self.survive(Faults)


if __name__ == "__main__":
    attack.main()
