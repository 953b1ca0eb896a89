"""What the command-level tests share: a study to start from, a folder to work in, and a way to run the command."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
THREE_MASSES = SOURCE / "examples" / "01-three-masses"
MOTTLE = ""

TEXTS = SOURCE / "tests" / "support" / "studies"  # which the tests in C++ start from too
STUDY = (TEXTS / "three_masses.toml").read_text(encoding="utf-8")
TESTS = (TEXTS / "three_masses.csv").read_text(encoding="utf-8")
# A Nastran deck of three masses in a row: 1.9006, 5.7822 and 8.9855 Hz.
CHAIN = (TEXTS / "chain.bdf").read_text(encoding="utf-8")
# Of two masses in a row, whose springs have a stiffness of 2 (two_masses below).
TWO_MASSES_TESTS = "f1,f2\n0.140,0.370\n0.137,0.366\n0.144,0.375\n0.139,0.374\n0.142,0.365\n0.141,0.371\n"


def two_masses(samples, iterations):
    """What follows the model in a study of two masses in a row."""
    return f"""\
[[parameter]]
name = "k1"
distribution = {{ kind = "lognormal", mean = 2.0, std = 0.2 }}

[[parameter]]
name = "k2"
distribution = {{ kind = "lognormal", mean = 2.0, std = 0.2 }}

[outputs]
frequencies = [1, 2]

[test]
file = "tests.csv"

[update]
method = "covariance-adjustment"
samples = {samples}
iterations = {iterations}
"""


def edited(text, *changes):
    """`text` with each (old, new) replaced; old must stand exactly once, so that a test cannot miss its target."""
    for old, new in changes:
        if text.count(old) != 1:
            raise AssertionError(f"{old!r} stands {text.count(old)} times in the text to edit")
        text = text.replace(old, new)
    return text


def line_of(text, needle):
    """Number, from 1, of the first line that holds `needle`."""
    for number, line in enumerate(text.splitlines(), 1):
        if needle in line:
            return number
    raise AssertionError(f"{needle!r} stands on no line")


def command_study(command):
    """The study with a solver of its own: solver.py is given the parameters in input.txt and leaves frequencies in f.txt."""
    parameters = STUDY[STUDY.index("[[parameter]]"):].splitlines()
    return (f'[model]\nkind = "command"\ncommand = {json.dumps(command)}\n'
            'templates = ["input.txt"]\nfiles = ["solver.py"]\nretries = 0\n'
            '[model.frequencies]\nfile = "f.txt"\nformat = "column"\n'
            + "".join(line + "\n" for line in parameters if "target" not in line))


class Run:
    """How one call of the command ended."""

    def __init__(self, code, out, err):
        self.code = code
        self.out = out
        self.err = err


# Solvers of tests are started hundreds of times as "python3", which may be a script that looks for the interpreter (pyenv's does,
# in 0.1 s): the interpreter itself comes before it.
if not os.path.samefile(shutil.which("python3") or os.devnull, sys.executable):
    os.environ["PATH"] = f"{os.path.dirname(os.path.realpath(sys.executable))}{os.pathsep}{os.environ['PATH']}"

# How much slower than the optimised build the command may be (sanitisers, coverage).
PATIENCE = float(os.environ.get("MOTTLE_TEST_PATIENCE", "1"))


def run(*arguments, cwd=None, timeout=60, environment=None):
    """Calls the command; bytes that are not UTF-8 come back as escapes.

    It finds no home and thus no cache: what one call has trained must not hide what another would have done. A test of
    the cache names one.
    """
    kept = {name: value for name, value in os.environ.items() if name not in ("HOME", "XDG_CACHE_HOME")}
    done = subprocess.run([MOTTLE, *map(str, arguments)], cwd=cwd, timeout=PATIENCE * timeout, stdin=subprocess.DEVNULL,
                          capture_output=True, env={**kept, **(environment or {})}, check=False)
    return Run(done.returncode, done.stdout.decode("utf-8", "backslashreplace"),
               done.stderr.decode("utf-8", "backslashreplace"))


def read_result(folder):
    """result.json, strictly: no NaN, no Infinity."""

    def refuse(text):
        raise ValueError(f"{text} is not JSON")

    return json.loads((pathlib.Path(folder) / "result.json").read_text(encoding="utf-8"), parse_constant=refuse)


def numbers(folder):
    """result.json without its timings and the study's digest, as text that is compared byte by byte."""
    result = read_result(folder)
    result.pop("timings_s")
    result.pop("study_files", None)
    return json.dumps(result, indent=1)


def read_csv(file):
    """Header and rows of a plain CSV file."""
    lines = pathlib.Path(file).read_text(encoding="utf-8").splitlines()
    return lines[0].split(","), [line.split(",") for line in lines[1:]]


class CommandTest(unittest.TestCase):
    """Gives each test a folder of its own with study.toml and tests.csv in it."""

    maxDiff = 2000

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="mottle-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.write("study.toml", STUDY)
        self.write("tests.csv", TESTS)

    def write(self, name, content):
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8"))
        return file

    def call(self, *arguments, **how):
        """Runs in the test's folder."""
        return run(*arguments, cwd=how.pop("cwd", self.folder), **how)

    def succeed(self, *arguments, **how):
        """Runs in the test's folder and demands exit code 0."""
        ended = self.call(*arguments, **how)
        self.assertEqual(ended.code, 0, ended.err)
        return ended


def main():
    """Entry of each test file: python3 x_test.py PATH_TO_MOTTLE [PATH_TO_ANOTHER_BUILD] [unittest's own arguments]."""
    global MOTTLE
    if len(sys.argv) < 2 or not os.access(sys.argv[1], os.X_OK):
        sys.exit("usage: python3 x_test.py PATH_TO_MOTTLE [PATH_TO_ANOTHER_BUILD]")
    MOTTLE = str(pathlib.Path(sys.argv.pop(1)).resolve())
    if len(sys.argv) > 1 and os.path.sep in sys.argv[1]:
        os.environ["MOTTLE_OTHER"] = sys.argv.pop(1)
    result = unittest.main(module="__main__", exit=False).result
    if result.wasSuccessful() and result.skipped and len(result.skipped) >= result.testsRun:
        sys.exit(77)  # nothing was tested: CTest says so
    sys.exit(0 if result.wasSuccessful() else 1)
