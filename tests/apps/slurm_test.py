"""Runs of a solver by a real Slurm on this machine: the same results, and nothing lost or done twice when parts die.

    python3 slurm_test.py PATH_TO_MOTTLE
"""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
import slurm_cluster
import support

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
CLUSTER = None


def setUpModule():
    global CLUSTER
    if reason := slurm_cluster.why_not():
        raise unittest.SkipTest(reason)
    CLUSTER = slurm_cluster.SlurmCluster(nodes=4, cpus=4, settings="MaxArraySize=25\n")  # at most 24 tasks
    CLUSTER.__enter__()


def tearDownModule():
    CLUSTER.__exit__()


def numbers(folder):
    """result.json without what tells of time, and of the study file, which names Slurm in one of the two."""
    result = support.read_result(folder)
    result.pop("timings_s")
    return json.dumps(result)


class Job:
    """A study of its own in a folder of its own, and a Mottle that does it."""

    def __init__(self, seconds, samples, options, kills=False, verb="propagate"):
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
        done = subprocess.run([support.MOTTLE, *arguments], cwd=self.folder, env=CLUSTER.environment(), text=True,
                              stdin=subprocess.DEVNULL, capture_output=True, timeout=support.PATIENCE * 200, check=False)
        if done.returncode != code:
            raise AssertionError(f"{arguments}: exit code {done.returncode}: {done.stderr}{done.stdout}")
        return done

    def start(self, *options, programs=None):
        """`programs`: a folder of programs that come before Slurm's own."""
        environment = CLUSTER.environment()
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


class Slurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        # What takes long is begun at once: the time that Slurm gives ends after a minute at the least.
        cls.out_of_time = Job(5.0, 24, 'time = "1 min"\nruns_per_task = 24\nextra = "--nodelist=n4"').start()
        cls.kills_its_task = Job(0.05, 12, "runs_per_task = 4\ntries = 2", kills=True).start()

    @classmethod
    def tearDownClass(cls):
        for job in (cls.out_of_time, cls.kills_its_task):
            job.process.kill()
            job.process.communicate()
            shutil.rmtree(job.folder, ignore_errors=True)

    def job(self, *what, **how):
        job = Job(*what, **how)
        self.addCleanup(shutil.rmtree, job.folder, ignore_errors=True)
        return job

    def expect_same(self, job):
        self.assertEqual(numbers(job.folder / "out"), numbers(job.folder / "alone"))
        self.assertFalse((job.folder / "out" / "tasks").exists(), "what is done is taken away")

    def test_an_update_gives_the_same_as_on_this_machine(self):
        job = self.job(0.0, 12, "runs_at_once = 6", verb="update").start()
        job.end()
        self.expect_same(job)
        self.assertEqual(job.twice(), 0)

    def test_a_killed_driver_finds_its_tasks_again(self):
        job = self.job(0.4, 24, "runs_per_task = 6").start()
        job.wait_for(6)
        job.process.kill()
        job.process.communicate()
        status = json.loads(job.call("status", "out", "--json").stdout)
        self.assertEqual(status["arrays"][0]["runs"], 24)
        self.assertGreater(status["arrays"][0]["running"], 0)
        job.start("--resume").end()
        self.expect_same(job)
        self.assertEqual(job.twice(), 0)

    def test_a_stopped_driver_leaves_its_tasks_and_says_so(self):
        job = self.job(0.4, 24, "runs_per_task = 6").start()
        job.wait_for(6)
        job.process.send_signal(signal.SIGTERM)
        begin = time.monotonic()
        words = job.end(code=4).err
        self.assertLess(time.monotonic() - begin, 2 * support.PATIENCE)
        for part in ("mottle status", "mottle cancel", "--resume"):
            self.assertIn(part, words)
        seen = len(job.runs())
        time.sleep(2.0)
        self.assertGreater(len(job.runs()), seen, "tasks go on")
        job.start("--resume").end()
        self.expect_same(job)
        self.assertEqual(job.twice(), 0)

    def test_cancelled_tasks_end_the_driver_and_can_be_resumed(self):
        job = self.job(0.4, 16, "runs_per_task = 4").start()
        job.wait_for(6)
        self.assertIn("cancelled: mottle-", job.call("cancel", "out").stdout)
        self.assertIn("mottle cancel", job.end(code=4).err)
        ids = ",".join(job.arrays())
        CLUSTER.wait_until(lambda: not CLUSTER.call("squeue", "-h", "-j", ids).strip(), "tasks are not cancelled")
        in_flight = 4
        job.start("--resume").end()
        self.expect_same(job)
        self.assertLessEqual(job.twice(), in_flight)

    def test_a_task_that_is_cancelled_by_hand_is_done_again(self):
        job = self.job(0.4, 16, "runs_per_task = 8").start()
        job.wait_for(8)
        number = max(job.arrays(), key=int)
        CLUSTER.call("scancel", f"{number}_2")
        job.end()
        self.expect_same(job)
        self.assertLessEqual(job.twice(), 1)
        self.assertIn("CANCELLED", job.log())

    def test_a_squeue_that_shows_nothing_ends_no_task_and_hides_no_end(self):
        job = self.job(0.8, 48, "runs_per_task = 24")
        (job.folder / "programs").mkdir()
        (job.folder / "programs" / "squeue").write_text("#!/bin/sh\nexit 0\n")
        (job.folder / "programs" / "squeue").chmod(0o755)
        job.start(programs=job.folder / "programs")
        job.wait_for(8)
        number = max(job.arrays(), key=int)
        CLUSTER.call("scancel", f"{number}_2")
        job.end()
        self.expect_same(job)
        self.assertLessEqual(job.twice(), 1)
        self.assertIn("CANCELLED", job.log())

    def test_a_node_that_dies_costs_the_runs_in_flight(self):
        job = self.job(0.5, 40, "runs_per_task = 5").start()
        job.wait_for(12)
        CLUSTER.kill_node("n1", notice=True)
        job.end()
        CLUSTER.start_node("n1")
        self.expect_same(job)
        self.assertLessEqual(job.twice(), 4, "as many tasks as the node did at a time")

    def test_a_wrong_partition_is_refused_in_the_words_of_slurm(self):
        job = self.job(0.0, 12, 'partition = "no-such"').start()
        self.assertIn("invalid partition", job.end(code=3).err)
        self.assertFalse((job.folder / "out" / "tasks").exists())

    def test_arrays_are_as_long_as_slurm_takes(self):
        job = self.job(0.0, 40, "runs_per_task = 1").start()
        job.end()
        self.expect_same(job)
        self.assertEqual(job.twice(), 0)
        self.assertIn("Invalid job array specification", job.log())

    def test_z_a_run_that_ends_its_task_each_time_is_one_failed_run(self):
        job = self.kills_its_task
        job.end()
        result = support.read_result(job.folder / "out")
        self.assertEqual(json.dumps(result).count("the task that did it ended 2 times"), 1)
        self.assertEqual(len(list((job.folder / "out" / "failed-runs").iterdir())), 1)
        self.assertLessEqual(job.twice(), 1)

    def test_z_a_task_that_is_out_of_time_costs_the_run_in_flight(self):
        job = self.out_of_time
        end = time.monotonic() + support.PATIENCE * 150  # Slurm looks twice a minute
        while "TIMEOUT" not in job.log() and job.process.poll() is None and time.monotonic() < end:
            time.sleep(0.1)
        job.control("runs.log", 0.1)
        job.end()
        self.expect_same(job)
        self.assertIn("TIMEOUT", job.log())
        self.assertLessEqual(job.twice(), 1)


if __name__ == "__main__":
    support.main()
