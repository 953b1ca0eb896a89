"""Ranks that a Slurm on this machine starts: what slurm_mpi_test.py and nightly/slurm_mpi_test.py share."""

import os
import pathlib
import subprocess
import sys
import time

import rank_jobs
import support
from rank_jobs import numbers

sys.path.insert(0, str(support.SOURCE / "tests" / "tools"))
import slurm_cluster  # noqa: E402  (found by the line above)

SRUN = ["srun", "--mpi=pmix", "--kill-on-bad-exit=1"]


class SlurmRanksTest(rank_jobs.RanksTest):
    """Tests of a class share a cluster."""

    nodes = 4

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        if not rank_jobs.why_not() and not slurm_cluster.why_not():
            cls.cluster = cls.enterClassContext(slurm_cluster.SlurmCluster(nodes=cls.nodes))

    def setUp(self):
        super().setUp()
        if reason := slurm_cluster.why_not():
            self.skipTest(reason)
        self.environment = self.cluster.environment(HOME=str(self.folder))

    def start(self, ranks, *arguments, options=()):
        command = [*SRUN, f"--ntasks={ranks}", f"--nodes={ranks}", *options, support.MOTTLE, *arguments]
        return subprocess.Popen(list(map(str, command)), cwd=self.folder, env=self.environment, text=True,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def rank(self, number):
        """Process of a rank."""
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                environment = (process / "environ").read_bytes().split(b"\0")
                is_mottle = os.path.samefile(process / "exe", support.MOTTLE)
            except OSError:
                continue  # it ended while we looked
            if is_mottle and {f"SLURM_PROCID={number}".encode(), f"HOME={self.folder}".encode()} <= set(environment):
                return int(process.name)
        self.fail(f"rank {number} does not run")

    def wait_for_runs(self, count, job):
        while len(self.runs()) < count and job.poll() is None:
            time.sleep(0.05)
        self.assertIsNone(job.poll(), "the job ended before it could be disturbed")

    def disturb(self, harm):
        """Starts a job of three ranks, calls harm() in its midst; it must fail soon, and be resumed by two ranks."""
        study = self.tower(0.0)
        self.succeed("update", study, "--quiet", "--out", "alone")
        alone = len(self.runs())
        self.pace(0.1)
        job = self.start(3, "update", study, "--quiet", "--out", "out")
        self.wait_for_runs(alone + 12, job)
        self.pace(60.0)  # it does not end before the harm is done, however busy the machine
        harm()
        begin = time.monotonic()
        _, err = job.communicate(timeout=support.PATIENCE * 60)
        self.assertNotEqual(job.returncode, 0, err)
        self.assertLess(time.monotonic() - begin, support.PATIENCE * 20)
        self.assertFalse((self.folder / "out" / "result.json").exists())

        self.pace(0.0)
        self.succeed_ranked(2, "update", study, "--quiet", "--out", "out", "--resume")
        self.assertEqual(numbers(self.folder / "out"), (2, numbers(self.folder / "alone")[1]))
        in_flight = 3 * 2
        self.assertLessEqual(len(self.runs()), 2 * alone + in_flight)
