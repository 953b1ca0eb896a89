"""A Slurm on this machine and jobs whose runs it does: what slurm_test.py and nightly/slurm_test.py share."""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

import support

sys.path.insert(0, str(support.SOURCE / "tests" / "tools"))
import slurm_cluster  # noqa: E402  (found by the line above)

TOWER = support.SOURCE / "examples" / "04-any-solver"
# Each run leaves a line as it begins, and takes a while; how long, a file tells that is no input of the study, so that the
# solver's bytes are the same. The worker is the parent of the guard that started the solver; one run kills it each time.
CONTROLLED = """import json, os, pathlib, signal, time
text = pathlib.Path("tower.inp").read_text().replace("\\n", " ")
control = json.loads(pathlib.Path({control!r}).read_text())
with open(control["log"], "a") as log:
    log.write(text + "\\n")
if text == control["kills"]:
    worker = int(pathlib.Path(f"/proc/{{os.getppid()}}/stat").read_text().rpartition(")")[2].split()[1])
    os.kill(worker, signal.SIGKILL)
    time.sleep(100)
time.sleep(control["seconds"])
import math"""


def numbers(folder):
    """result.json without what tells of time, and of the study file, which names Slurm in one of the two."""
    result = support.read_result(folder)
    result.pop("timings_s")
    return json.dumps(result)


class Job:
    """A study of its own in a folder of its own, and a Mottle that does it."""

    def __init__(self, cluster, seconds, samples, options, kills=False, verb="propagate"):
        self.cluster = cluster
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="mottle-slurm-test-", dir="/tmp"))
        self.verb = verb
        self.process = None
        shutil.copytree(TOWER, self.folder / "tower")
        solver = self.folder / "tower" / "tower.py"
        solver.write_text(support.edited(solver.read_text(), (
            "import math", CONTROLLED.format(control=str(self.folder / "control.json")))))
        study = self.folder / "tower" / "study.toml"
        text = support.edited(study.read_text(), ("samples = 40", f"samples = {samples}"),
                              ("parallel = 2\n", "largest_failed_part = 0.9\n"))
        study.write_text(text)
        self.control("alone.log", 0.0)
        self.call(verb, "tower/study.toml", "--quiet", "--out", "alone")
        first = (self.folder / "alone.log").read_text().splitlines()[5]
        self.control("runs.log", seconds, first if kills else "")
        study.write_text(support.edited(text, (
            "largest_failed_part", 'launch = "slurm"\nlargest_failed_part'), (
            "[model.frequencies]", f"[model.scheduler]\n{options}\n[model.frequencies]")))

    def control(self, log, seconds, kills=""):
        (self.folder / "control.json").write_text(
            json.dumps({"log": str(self.folder / log), "seconds": seconds, "kills": kills}))

    def call(self, *arguments, code=0):
        done = subprocess.run([support.MOTTLE, *arguments], cwd=self.folder, env=self.cluster.environment(), text=True,
                              stdin=subprocess.DEVNULL, capture_output=True, timeout=support.PATIENCE * 200, check=False)
        if done.returncode != code:
            raise AssertionError(f"{arguments}: exit code {done.returncode}: {done.stderr}{done.stdout}")
        return done

    def start(self, *options, programs=None):
        """`programs`: a folder of programs that come before Slurm's own."""
        environment = self.cluster.environment()
        if programs:
            environment["PATH"] = f"{programs}:{environment['PATH']}"
        self.process = subprocess.Popen([support.MOTTLE, self.verb, "tower/study.toml", "--out", "out", *options],
                                        cwd=self.folder, env=environment, text=True, stdin=subprocess.DEVNULL,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        return self

    def end(self, code=0):
        out, err = self.process.communicate(timeout=support.PATIENCE * 200)
        if self.process.returncode != code:
            raise AssertionError(f"exit code {self.process.returncode}: {err}{out}{self.log()}")
        return support.Run(code, out, err)

    def log(self):
        file = self.folder / "out" / "mottle.log"
        return file.read_text() if file.exists() else ""

    def runs(self):
        file = self.folder / "runs.log"
        return file.read_text().splitlines() if file.exists() else []

    def wait_for(self, runs):
        end = time.monotonic() + support.PATIENCE * 60
        while len(self.runs()) < runs:
            if time.monotonic() > end or self.process.poll() is not None:
                raise AssertionError(f"{len(self.runs())} runs after a minute, {runs} awaited")
            time.sleep(0.02)

    def twice(self):
        """Runs that were begun again."""
        return len(self.runs()) - len(set(self.runs()))

    def arrays(self):
        """Numbers of this job's arrays, as Slurm knows them."""
        return [file.read_text().strip() for file in (self.folder / "out" / "tasks").glob("*/job")]


class SlurmTest(unittest.TestCase):
    """Tests of a class share a cluster."""

    nodes = 4

    @classmethod
    def setUpClass(cls):
        if reason := slurm_cluster.why_not():
            raise unittest.SkipTest(reason)
        at_most_24_tasks = "MaxArraySize=25\n"
        cls.cluster = cls.enterClassContext(slurm_cluster.SlurmCluster(nodes=cls.nodes, cpus=4, settings=at_most_24_tasks))

    def job(self, *what, **how):
        job = Job(self.cluster, *what, **how)
        self.addCleanup(shutil.rmtree, job.folder, ignore_errors=True)
        return job

    def expect_same(self, job):
        self.assertEqual(numbers(job.folder / "out"), numbers(job.folder / "alone"))
        self.assertFalse((job.folder / "out" / "tasks").exists(), "what is done is taken away")
