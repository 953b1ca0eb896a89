"""Runs of a solver by a real Slurm on this machine: nothing is lost or done twice when tasks, nodes or their time end.

Takes minutes, as Slurm looks only twice a minute whether a task's time is over. Other programs at work delay what is awaited
here; a stopped driver has two seconds to end.

    python3 nightly/slurm_test.py PATH_TO_MOTTLE
"""

import json
import pathlib
import shutil
import signal
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import support  # noqa: E402  (found by the line above)
from slurm_jobs import Job, SlurmTest  # noqa: E402


class Slurm(SlurmTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # What takes long is begun at once: the time that Slurm gives ends after a minute at the least.
        cls.out_of_time = Job(cls.cluster, 5.0, 24, 'time = "1 min"\nruns_per_task = 24\nextra = "--nodelist=n4"').start()
        cls.kills_its_task = Job(cls.cluster, 0.05, 12, "runs_per_task = 4\ntries = 2", kills=True).start()

    @classmethod
    def tearDownClass(cls):
        for job in (cls.out_of_time, cls.kills_its_task):
            job.process.kill()
            job.process.communicate()
            shutil.rmtree(job.folder, ignore_errors=True)

    def test_an_update_gives_the_same_as_on_this_machine(self):
        job = self.job(0.0, 12, "runs_at_once = 6", verb="update").start()
        job.end()
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
        self.cluster.wait_until(lambda: not self.cluster.call("squeue", "-h", "-j", ids).strip(), "tasks are not cancelled")
        in_flight = 4
        job.start("--resume").end()
        self.expect_same(job)
        self.assertLessEqual(job.twice(), in_flight)

    def test_a_task_that_is_cancelled_by_hand_is_done_again(self):
        job = self.job(0.4, 16, "runs_per_task = 8").start()
        job.wait_for(8)
        number = max(job.arrays(), key=int)
        self.cluster.call("scancel", f"{number}_2")
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
        self.cluster.call("scancel", f"{number}_2")
        job.end()
        self.expect_same(job)
        self.assertLessEqual(job.twice(), 1)
        self.assertIn("CANCELLED", job.log())

    def test_a_node_that_dies_costs_the_runs_in_flight(self):
        job = self.job(0.5, 40, "runs_per_task = 5").start()
        job.wait_for(12)
        self.cluster.kill_node("n1", notice=True)
        job.end()
        self.cluster.start_node("n1")
        self.expect_same(job)
        self.assertLessEqual(job.twice(), 4, "as many tasks as the node did at a time")

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
