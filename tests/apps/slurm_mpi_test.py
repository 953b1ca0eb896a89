"""The command under a real Slurm: ranks on several nodes by srun, of which one is lost. The rest is in nightly/slurm_mpi_test.py.

The lost rank must end the job within 20 s, and a node that is not heard of for seconds, since the machine is busy, counts as
lost. On a busy machine Open MPI 4.1 may also crash in MPI_Init: a message of a rank that is through reaches one that still waits
there, and finds no receiver (exit code 139).
"""

import os
import signal

import slurm_rank_jobs
import support


class Srun(slurm_rank_jobs.SlurmRanksTest):
    nodes = 3

    def test_a_killed_rank_ends_the_job_which_another_number_of_ranks_resumes(self):
        self.disturb(lambda: os.kill(self.rank(2), signal.SIGKILL))


if __name__ == "__main__":
    support.main()
