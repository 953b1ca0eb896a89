"""Runs of a solver by a real Slurm on this machine: the same results, and nothing done twice when the driver dies.

Runs are awaited, not timed; a node that is not heard of for seconds, since the machine is busy, counts as lost, however.
Everything else that may die is in nightly/slurm_test.py.

    python3 slurm_test.py PATH_TO_MOTTLE
"""

import json

import slurm_jobs
import support


class Slurm(slurm_jobs.SlurmTest):
    nodes = 2

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

    def test_a_wrong_partition_is_refused_in_the_words_of_slurm(self):
        job = self.job(0.0, 12, 'partition = "no-such"').start()
        self.assertIn("invalid partition", job.end(code=3).err)
        self.assertFalse((job.folder / "out" / "tasks").exists())


if __name__ == "__main__":
    support.main()
