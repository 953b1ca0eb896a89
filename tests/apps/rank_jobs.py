"""Jobs under mpirun, and a solver that leaves a trace of each run: what the tests of ranks share."""

import json
import os
import pathlib
import shutil
import subprocess
import time

import support
from support import CommandTest, SOURCE

AIRFRAME = SOURCE / "examples" / "02-airframe"
TOWER = SOURCE / "examples" / "04-any-solver"
MPIRUN = ["mpirun", "--oversubscribe", "--allow-run-as-root", "-n"]
# Each run of the tower's solver leaves a line, and takes as long as a file says: long enough to be killed.
SLOW_SOLVER = ('import os, pathlib, time\n'
               'with open({log!r}, "a") as log:\n'
               '    log.write(pathlib.Path("tower.inp").read_text().replace("\\n", " ")\n'
               '              + ("as a rank" if "OMPI_COMM_WORLD_RANK" in os.environ else "") + "\\n")\n'
               'time.sleep(float(pathlib.Path({log!r} + ".seconds").read_text()))\n'
               'import math')


def why_not():
    """Why nothing can be tested here; empty: it can."""
    if shutil.which("mpirun") is None:
        return "no mpirun here (Debian: openmpi-bin)"
    if not (pathlib.Path(support.MOTTLE).parent / "libmottle_mpi.so").exists():
        return "built without MPI (Debian: libopenmpi-dev)"
    return ""


def numbers(folder):
    """result.json without what tells of the machine."""
    result = support.read_result(folder)
    result.pop("timings_s")
    return result.pop("ranks"), json.dumps(result)


class RanksTest(CommandTest):
    def setUp(self):
        super().setUp()
        if reason := why_not():
            self.skipTest(reason)
        self.environment = {name: value for name, value in os.environ.items() if name != "XDG_CACHE_HOME"}
        self.environment["HOME"] = str(self.folder)  # no cache of another run

    def start(self, ranks, *arguments, mottle=None):
        return subprocess.Popen([*MPIRUN, str(ranks), str(mottle or support.MOTTLE), *map(str, arguments)],
                                cwd=self.folder, env=self.environment, text=True, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def ranked(self, ranks, *arguments, timeout=120, **how):
        job = self.start(ranks, *arguments, **how)
        out, err = job.communicate(timeout=support.PATIENCE * timeout)
        return support.Run(job.returncode, out, err)

    def succeed_ranked(self, ranks, *arguments):
        ended = self.ranked(ranks, *arguments)
        self.assertEqual(ended.code, 0, ended.err)
        return ended

    def wait_for_killed_ranks(self):
        """Ranks end some time after their launcher."""
        def is_here(process):
            try:
                return process.joinpath("cwd").readlink() == self.folder
            except OSError:  # it has just ended
                return False

        end = time.monotonic() + 20 * support.PATIENCE
        while any(map(is_here, pathlib.Path("/proc").glob("[0-9]*"))) and time.monotonic() < end:
            time.sleep(0.05)

    def expect_same(self, verb, study, ranks=(1, 2, 4), options=()):
        self.succeed(verb, study, "--quiet", "--out", "alone", *options)
        for count in ranks:
            self.succeed_ranked(count, verb, study, "--quiet", "--out", f"by{count}", *options)
            self.assertEqual(numbers(self.folder / f"by{count}"), (count, numbers(self.folder / "alone")[1]))

    def tower(self, seconds):
        shutil.copytree(TOWER, self.folder / "tower")
        solver = self.folder / "tower" / "tower.py"
        slow = SLOW_SOLVER.format(log=str(self.folder / "runs"))
        self.pace(seconds)
        solver.write_text(support.edited(solver.read_text(), ("import math", slow)))
        study = self.folder / "tower" / "study.toml"
        study.write_text(support.edited(study.read_text(), ("samples = 40", "samples = 12\niterations = 3")))
        return "tower/study.toml"

    def pace(self, seconds):
        """From now on, a run of the tower's solver takes so long."""
        self.write("runs.seconds", str(seconds))

    def runs(self):
        """Inputs of the solver's runs so far."""
        file = self.folder / "runs"
        return file.read_text().splitlines() if file.exists() else []

    def ranked_as(self, *commands, patience_s, timeout=60):
        """Ranks that are started with different commands, and wait so long for each other."""
        parts = [part for command in commands for part in (":", "-n", "1", *map(str, command))][1:]
        job = subprocess.run([*MPIRUN[:-1], *parts], cwd=self.folder, env={**self.environment, "MOTTLE_RANKS_TIMEOUT": str(patience_s)},
                             text=True, stdin=subprocess.DEVNULL, capture_output=True, check=False,
                             timeout=support.PATIENCE * timeout)
        return support.Run(job.returncode, job.stdout, job.stderr)

    def expect_told(self, command, others, update_is_first):
        """A rank that never joins, since another program was started in its place, is told."""
        commands = (command, others) if update_is_first else (others, command)
        ended = self.ranked_as(*commands, patience_s=4)
        self.assertNotEqual(ended.code, 0, ended.err)
        # Open MPI's mpirun sees it by itself where the others had called MPI_Init before that rank ended.
        self.assertRegex(ended.err, "has waited 4 s for the other ranks to join|exiting improperly")
        self.assertEqual("has waited" in ended.err, ended.code == 3, ended.err)
