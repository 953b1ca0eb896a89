"""The command under a real Slurm: ranks on several nodes by srun, a job script, lost ranks and lost nodes."""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import ranks_test
import support
from ranks_test import AIRFRAME, numbers

sys.path.insert(0, str(support.SOURCE / "tests" / "tools"))
import slurm_cluster  # noqa: E402  (found by the line above)

PAGE = support.SOURCE / "docs" / "howto" / "cluster.md"
SRUN = ["srun", "--mpi=pmix", "--kill-on-bad-exit=1"]


class SlurmTest(ranks_test.RanksTest):
    """Tests of a class share a cluster."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        if not ranks_test.why_not() and not slurm_cluster.why_not():
            cls.cluster = cls.enterClassContext(slurm_cluster.SlurmCluster())

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


class Srun(SlurmTest):
    def test_an_airframe_by_one_two_and_four_nodes(self):
        shutil.copytree(AIRFRAME, self.folder / "airframe", ignore=shutil.ignore_patterns("*.mottle"))
        self.expect_same("update", "airframe/study.toml")

    def test_two_ranks_a_node(self):
        self.succeed("update", AIRFRAME / "study.toml", "--quiet", "--out", "alone")
        ended = self.start(4, "update", AIRFRAME / "study.toml", "--quiet", "--out", "by4",
                           options=("--nodes=2", "--ntasks-per-node=2"))
        _, err = ended.communicate(timeout=support.PATIENCE * 60)
        self.assertEqual(ended.returncode, 0, err)
        self.assertEqual(numbers(self.folder / "by4"), (4, numbers(self.folder / "alone")[1]))

    def test_without_pmix_open_mpi_refuses_and_nothing_is_done(self):
        ended = self.ranked(2, "update", "study.toml", "--out", "out", options=("--mpi=none",))
        self.assertNotEqual(ended.code, 0, ended.err)
        self.assertFalse((self.folder / "out").exists())

    def test_a_step_of_one_process_is_mottle_alone(self):
        ended = self.ranked(1, "update", "study.toml", "--quiet", "--out", "out", options=("--mpi=none",))
        self.assertEqual(ended.code, 0, ended.err)
        self.assertEqual(numbers(self.folder / "out")[0], 1)

    def test_a_killed_rank_ends_the_job_which_another_number_of_ranks_resumes(self):
        self.disturb(lambda: os.kill(self.rank(2), signal.SIGKILL))

    def test_a_lost_node_ends_the_job_which_the_others_resume(self):
        def lose_a_node():
            node = self.cluster.call("squeue", "-h", "-s", "-o", "%N").strip()
            self.assertEqual(node, "n[1-3]")
            self.cluster.kill_node("n3")
            self.addCleanup(self.cluster.start_node, "n3")

        self.disturb(lose_a_node)


class Sbatch(SlurmTest):
    def test_the_job_script_of_the_page(self):
        script = re.search(r"```\n(#!/bin/bash\n#SBATCH.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL).group(1)
        shutil.copytree(AIRFRAME, self.folder / "airframe", ignore=shutil.ignore_patterns("*.mottle"))
        self.write("airframe/job.sh", script)
        done = subprocess.run(["sbatch", "--wait", "job.sh"], cwd=self.folder / "airframe", text=True, check=False,
                              env={**self.environment, "PATH": f"{pathlib.Path(support.MOTTLE).parent}:{slurm_cluster.PATH}"},
                              capture_output=True, timeout=support.PATIENCE * 60)
        output = "".join(file.read_text() for file in (self.folder / "airframe").glob("slurm-*.out"))
        self.assertEqual(done.returncode, 0, done.stderr + output)
        self.succeed("update", "airframe/study.toml", "--quiet", "--out", "alone")
        self.assertEqual(numbers(self.folder / "airframe" / "results"), (8, numbers(self.folder / "alone")[1]))


if __name__ == "__main__":
    support.main()
