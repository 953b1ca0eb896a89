"""The command under a real Slurm: numbers of ranks and nodes, a job script, a lost node.

Other programs at work may make Slurm count a node as lost: it is not heard of for seconds then.
"""

import pathlib
import re
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import support  # noqa: E402  (found by the line above)
from rank_jobs import AIRFRAME, numbers  # noqa: E402
from slurm_rank_jobs import SlurmRanksTest, slurm_cluster  # noqa: E402

PAGE = support.SOURCE / "docs" / "howto" / "cluster.md"


class Srun(SlurmRanksTest):
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

    def test_a_lost_node_ends_the_job_which_the_others_resume(self):
        def lose_a_node():
            node = self.cluster.call("squeue", "-h", "-s", "-o", "%N").strip()
            self.assertEqual(node, "n[1-3]")
            self.cluster.kill_node("n3")
            self.addCleanup(self.cluster.start_node, "n3")

        self.disturb(lose_a_node)


class Sbatch(SlurmRanksTest):
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
