"""What the families of attacks share: an attack is named by family, seed and number, and can be made again alone.

tests/attack/x_test.py makes the first few of each family, validation/attack/run.py thousands of the same.
"""

import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "apps"))
import support  # noqa: E402  (of the command-level tests)

SHIMS = pathlib.Path(__file__).resolve().parent / "shims"
SEED = 15
# Sanitizers reserve terabytes of addresses and must be the first library: limits of memory and shims do not go with them.
IS_INSTRUMENTED = support.PATIENCE > 1
GIGABYTE = 1 << 30


class Finding(Exception):
    """The command did what it must not."""


def demand(claim, what):
    if not claim:
        raise Finding(what)


class Ended(support.Run):
    """How one call ended, and what it took."""

    def __init__(self, code, out, err, seconds, megabytes):
        super().__init__(code, out, err)
        self.seconds = seconds
        self.megabytes = megabytes  # resident at its peak


class Family:
    """One family of attacks, with a folder and the command."""

    title = ""
    few = 10      # attacks in the tests
    many = 1000   # attacks in the long run
    minutes = 10  # that the long run takes, about; where many is None, exactly
    seconds = 60  # that one call of the command may take

    def __init__(self, mottle, folder):
        self.mottle = str(mottle)
        self.folder = pathlib.Path(folder)
        self.doing = ""
        self.codes = set()  # that calls have ended with

    def prepare(self):
        """Once, before the first attack; raises unittest.SkipTest where the machine does not have what is needed."""

    def attack(self, chance, number):
        """Makes one attack and says in self.doing which; raises Finding."""
        raise NotImplementedError

    def make(self, seed, number):
        """What was found by the attack of this seed and number; empty: nothing."""
        self.doing = ""
        try:
            self.attack(random.Random(f"{type(self).__name__} {seed} {number}"), number)
        except Finding as found:
            return str(found)
        return ""

    # --- files and calls --------------------------------------------------------------------------------------------
    def write(self, name, content):
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8"))
        return file

    def remove(self, *names):
        for name in names:
            path = self.folder / name
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)

    def environment(self, **more):
        """Without a home, and thus without a cache; see support.run."""
        kept = {name: value for name, value in os.environ.items() if name not in ("HOME", "XDG_CACHE_HOME")}
        return {**kept, **more}

    def start(self, *arguments, limits=(), environment=None, out=subprocess.DEVNULL, err=subprocess.DEVNULL):
        """The command at work; its streams go to `out` and `err`, files or nothing."""
        return subprocess.Popen([self.mottle, *map(str, arguments)], cwd=self.folder, stdin=subprocess.DEVNULL, stdout=out,
                                stderr=err, env=self.environment(**(environment or {})), preexec_fn=lambda: hold(limits))

    def call(self, *arguments, seconds=None, memory=4 * GIGABYTE, limits=(), environment=None):
        """The command, held to a time and to addresses; one that is over its time is a finding."""
        if not IS_INSTRUMENTED:
            limits = (*limits, (resource.RLIMIT_AS, memory))
        seconds = support.PATIENCE * (seconds or self.seconds)
        began = time.monotonic()
        # Pipes, not files: a limit on the size of files must not be one on what the command says.
        process = self.start(*arguments, limits=limits, environment=environment, out=subprocess.PIPE, err=subprocess.PIPE)
        out, err = Drain(process.stdout), Drain(process.stderr)
        status, usage = wait(process, began + seconds)
        took = time.monotonic() - began
        demand(status is not None, f"no end within {seconds:.0f} s: {' '.join(map(str, arguments))}")
        self.codes.add(status)
        return Ended(status, out.text(), err.text(), took, usage.ru_maxrss / 1024)

    def succeed(self, *arguments, **how):
        ended = self.call(*arguments, **how)
        demand(ended.code == 0, f"ended with {ended.code}: {told(ended)}")
        return ended

    def numbers(self, name="out"):
        return support.numbers(self.folder / name)


def hold(limits):
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for limit, value in limits:
        resource.setrlimit(limit, (value, value))


def wait(process, end):
    """Exit code and use of a process; kills it at `end` and gives None for its code then."""
    pause = 0.001
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            process.returncode = os.waitstatus_to_exitcode(status)
            return process.returncode, usage
        if time.monotonic() > end:
            process.kill()
            _, _, usage = os.wait4(process.pid, 0)
            process.returncode = -9
            return None, usage
        time.sleep(pause)
        pause = min(0.02, 1.5 * pause)


class Drain(threading.Thread):
    """Reads a pipe to its end, and keeps the first megabyte."""

    def __init__(self, pipe):
        super().__init__(daemon=True)
        self.pipe, self.kept = pipe, b""
        self.start()

    def run(self):
        with self.pipe:
            while block := self.pipe.read1(65536):
                self.kept += block[:max(0, 1000000 - len(self.kept))]

    def text(self):
        self.join(10 * support.PATIENCE)  # a child that outlives the command may hold the pipe
        return self.kept.decode("utf-8", "backslashreplace")


def told(ended):
    return (ended.err.strip() or ended.out.strip())[-300:]


def demand_an_answer(ended, allowed=(0, 2, 3), megabytes=1024):
    """The command ended as it may: an allowed code, a message where it is not 0, no control characters, little memory."""
    demand(ended.code in allowed, f"ended with {ended.code}: {told(ended)}")
    demand("Traceback" not in ended.err and "terminate called" not in ended.err, f"a trace of itself: {told(ended)}")
    lines = ended.err.splitlines()
    demand(ended.code == 0 or any(re.match(r"mottle: (?!warning)", line) for line in lines), f"no message: {told(ended)!r}")
    demand(not re.search("[\x00-\x08\x0b-\x1f\x7f]", ended.err), f"control characters in its message: {ended.err[-300:]!r}")
    demand(IS_INSTRUMENTED or ended.megabytes < megabytes, f"took {ended.megabytes:.0f} MB: {told(ended)}")


def compiled(folder, source, *options):
    """Path of what the C compiler makes of shims/`source`: a library to load before all others, or a program."""
    if shutil.which("cc") is None:
        raise unittest.SkipTest("needs a C compiler: apt-get install gcc")
    made = pathlib.Path(folder) / pathlib.Path(source).stem
    subprocess.run(["cc", "-O1", "-Wall", "-Werror", *options, "-o", made, SHIMS / source, "-ldl"], check=True)
    return made


def shim(folder, source):
    if IS_INSTRUMENTED:
        raise unittest.SkipTest("a sanitizer must be the first library, a shim too")
    return compiled(folder, source, "-shared", "-fPIC")


class AttackTest(unittest.TestCase):
    """Makes the first attacks of a family."""

    def survive(self, family, attacks=None):
        """`attacks`: their numbers, where they are not the family's few."""
        with tempfile.TemporaryDirectory(prefix="mottle-attack-") as folder:
            made = family(support.MOTTLE, folder)
            made.prepare()
            numbers = attacks or range(made.few)
            # An instrumented command takes five to ten times as long: a quarter of many attacks.
            for number in numbers[::4 if IS_INSTRUMENTED and len(numbers) > 20 else 1]:
                found = made.make(SEED, number)
                with self.subTest(family.__name__, number=number):
                    self.assertEqual(found, "", f"attack {number}: {made.doing}")
            return made


def main():
    support.main()
