"""The command under mpirun: the same numbers by any number of ranks, one voice, and an end of all where one ends."""

import collections
import json
import os
import pathlib
import shutil
import signal
import subprocess
import time
import unittest
import urllib.request

import support
import umbridge_test
from support import CommandTest, SOURCE, THREE_MASSES

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
        return "tower/study.toml"

    def pace(self, seconds):
        """From now on, a run of the tower's solver takes so long."""
        self.write("runs.seconds", str(seconds))

    def runs(self):
        """Inputs of the solver's runs so far."""
        file = self.folder / "runs"
        return file.read_text().splitlines() if file.exists() else []


class Numbers(RanksTest):
    def test_three_masses(self):
        self.expect_same("update", THREE_MASSES / "case1.toml")

    def test_an_airframe(self):
        self.expect_same("update", AIRFRAME / "study.toml", ranks=(2, 4),
                         options=("--set", "update.samples=200"))

    def test_an_airframe_whose_samples_are_solved_in_full(self):
        self.expect_same("propagate", AIRFRAME / "study.toml", ranks=(3,),
                         options=("--set", "update.samples=30", "--set", "model.reduction=\"off\""))
        log = (self.folder / "by3" / "mottle.log").read_text()
        self.assertIn("3 ranks on 1 node", log)

    def test_a_diagnosis(self):
        self.write("more.toml", support.edited(
            support.STUDY, ('file = "tests.csv"\n', 'file = "tests.csv"\nrepeatability = { "f*" = "0.5 %" }\n')))
        self.succeed("diagnose", "more.toml", "--quiet", "--out", "alone")
        self.succeed_ranked(2, "diagnose", "more.toml", "--quiet", "--out", "by2")
        one, two = (json.loads((self.folder / name / "diagnosis.json").read_text()) for name in ("alone", "by2"))
        self.assertEqual((one.pop("ranks"), two.pop("ranks")), (1, 2))
        one.pop("timings_s"), two.pop("timings_s")
        self.assertEqual(one, two)

    def test_a_solver_by_command_runs_each_sample_once(self):
        study = self.tower(0.0)
        self.expect_same("update", study, ranks=(3,))
        runs = self.runs()
        self.assertEqual(len(runs), 2 * len(set(runs)))  # once alone, once by ranks
        self.assertFalse([run for run in runs if run.endswith("as a rank")])

    def test_runs_of_ranks_serve_a_later_job_of_any_number(self):
        study = self.tower(0.0)
        self.succeed_ranked(3, "update", study, "--quiet", "--out", "by3")
        done = len(self.runs())
        first = numbers(self.folder / "by3")[1]
        self.succeed("update", study, "--quiet", "--out", "by3")
        self.assertEqual(numbers(self.folder / "by3")[1], first)
        self.succeed_ranked(2, "update", study, "--quiet", "--out", "by3")
        self.assertEqual(numbers(self.folder / "by3")[1], first)
        self.assertEqual(len(self.runs()), done)

    def test_runs_that_fail_are_the_same_failures(self):
        study = self.tower(0.0)
        solver = self.folder / "tower" / "tower.py"
        fails = 'import math\nif sum(pathlib.Path("tower.inp").read_bytes()) % 7 == 4:\n    raise SystemExit(3)'
        solver.write_text(support.edited(solver.read_text(), ("\nimport math", "\n" + fails)))
        options = ("--set", "model.largest_failed_part=0.9", "--set", "model.retries=0")
        alone = self.call("propagate", study, "--quiet", "--out", "alone", *options)
        ranked = self.ranked(3, "propagate", study, "--quiet", "--out", "by3", *options)
        self.assertEqual((alone.code, ranked.code), (0, 0), alone.err + ranked.err)
        one, three = (numbers(self.folder / name)[1] for name in ("alone", "by3"))
        self.assertIn("exit status 3", one)
        self.assertEqual(one, three)


class Servers(RanksTest):
    """A model behind UM-Bridge servers: one that counts what it is asked."""

    def model(self, **what):
        server = umbridge_test.Model(**what)
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        self.write("tests.csv", umbridge_test.TESTS)
        self.write("served.toml", umbridge_test.HEAD + umbridge_test.MODEL.replace("URL", server.url) +
                   "parallel = 4\nlargest_failed_part = 0.9\n" + umbridge_test.REST)
        return server

    def inputs(self, server, begin=0):
        return [json.dumps(request["input"]) for request in server.evaluations()[begin:]]

    def test_each_request_is_made_once(self):
        for method in ("covariance-adjustment", "maximum-likelihood"):
            server = self.model(features=("Evaluate", "ApplyJacobian"),
                                spoil=lambda path, *_: time.sleep(0.01) if path == "/Evaluate" else None)
            options = ["--quiet", "--set", f'update.method="{method}"', "--set", "update.samples=60"]
            self.succeed("update", "served.toml", "--out", f"alone-{method}", *options)
            asked = [path for path, _ in server.seen]
            alone = self.inputs(server)
            server.most_at_once = 0
            self.succeed_ranked(3, "update", "served.toml", "--out", f"by3-{method}", *options)
            shared = collections.Counter(self.inputs(server, len(alone)))
            again = shared - collections.Counter(alone)
            self.assertEqual(collections.Counter(alone) - shared, {}, method)
            # A rank that asks for a derivative may not have evaluated there itself: then it does, once for all.
            points = {json.dumps(request["input"]) for path, request in server.seen if path == "/ApplyJacobian"}
            self.assertLessEqual(set(again), points, method)
            self.assertTrue(all(count == 1 for count in again.values()), again)
            self.assertEqual([path for path, _ in server.seen].count("/ApplyJacobian"), 2 * asked.count("/ApplyJacobian"))
            self.assertLessEqual(server.most_at_once, 4, "parallel is the limit of all ranks together")
            one, three = (numbers(self.folder / f"{name}-{method}")[1] for name in ("alone", "by3"))
            self.assertEqual(one, three)

    def test_a_request_that_fails_once_costs_its_sample_on_all_ranks(self):
        self.model(spoil=lambda path, _, number: (500, b"once") if path == "/Evaluate" and number in (5, 30, 55) else None)
        ended = self.ranked(3, "propagate", "served.toml", "--quiet", "--out", "by3", "--set", "update.samples=60")
        self.assertEqual(ended.code, 0, ended.err)
        failed = support.read_result(self.folder / "by3")["failed_evaluations"]
        self.assertEqual(len(failed), 3)

    def test_ranks_find_what_earlier_ranks_were_answered(self):
        slow = self.model(spoil=lambda path, *_: time.sleep(0.08) if path == "/Evaluate" else None)
        options = ["--quiet", "--out", "out", "--set", "update.samples=60"]
        job = self.start(3, "propagate", "served.toml", *options)
        while slow.count < 40 and job.poll() is None:
            time.sleep(0.01)
        job.kill()
        job.communicate()
        self.wait_for_killed_ranks()
        before = self.inputs(slow)
        self.succeed_ranked(2, "propagate", "served.toml", *options, "--resume")
        again = [x for x in self.inputs(slow, len(before)) if x in before]
        self.assertLessEqual(len(again), 1 + 4, "the means, and those under way")


class Voices(RanksTest):
    def voices(self, ended):
        return [line for line in (ended.out + ended.err).splitlines() if line.startswith("mottle: ")]

    def test_a_wrong_study_is_told_once(self):
        self.write("wrong.toml", support.edited(support.STUDY, ("samples = 200", "samples = -3")))
        ended = self.ranked(4, "update", "wrong.toml", "--out", "out")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertEqual(len(self.voices(ended)), 1, ended.err)
        self.assertIn("wrong.toml:", ended.err)
        self.assertFalse((self.folder / "out" / "result.json").exists())

    def test_a_folder_that_is_in_use_is_told_once(self):
        study = self.tower(0.2)
        with subprocess.Popen([support.MOTTLE, "update", study, "--quiet", "--out", "out"], cwd=self.folder,
                              env=self.environment, stderr=subprocess.DEVNULL) as other:
            time.sleep(1.0)
            ended = self.ranked(3, "update", study, "--out", "out")
            other.terminate()
        self.assertEqual(ended.code, 2, ended.err)
        self.assertEqual(len(self.voices(ended)), 1, ended.err)

    def test_other_verbs_are_done_by_one(self):
        ended = self.succeed_ranked(3, "--version")
        self.assertEqual(ended.out.count("mottle"), 1)
        ended = self.succeed_ranked(3, "check", "study.toml")
        self.assertEqual(ended.out.count("(units SI)"), 1)

    def test_a_model_is_offered_by_one(self):
        job = self.start(3, "propagate", "study.toml", "--umbridge", "0", "--json")
        self.addCleanup(job.communicate)
        self.addCleanup(job.kill)
        address = json.loads(job.stdout.readline())["address"]
        time.sleep(1.0)  # for others to offer theirs, or to end this one
        with urllib.request.urlopen(address + "/Info", timeout=support.PATIENCE * 10) as answer:
            self.assertEqual(json.load(answer)["models"], ["forward"])
        job.send_signal(signal.SIGTERM)
        out, err = job.communicate(timeout=support.PATIENCE * 20)
        self.assertEqual(out, "", "a second address")
        self.assertLessEqual(err.count("mottle: "), 1, err)

    def test_without_the_module_the_job_is_refused(self):
        shutil.copy(support.MOTTLE, self.folder / "mottle")
        ended = self.ranked(3, "update", "study.toml", "--out", "out", mottle=self.folder / "mottle")
        self.assertEqual(ended.code, 3, ended.err)
        self.assertEqual(len(self.voices(ended)), 1, ended.err)
        self.assertIn("mottle-mpi", ended.err)
        self.assertFalse((self.folder / "out").exists())

    def test_the_environment_of_another_launcher_is_seen(self):
        ended = self.call("update", "study.toml", "--out", "out",
                          environment={"SLURM_STEP_NUM_TASKS": "4", "SLURM_PROCID": "0"})
        self.assertEqual(ended.code, 3, ended.err)
        self.assertIn("MPI connects 1 of these processes", ended.err)


class Ends(RanksTest):
    def ranked_as(self, *commands, timeout=60):
        """Ranks that are started with different commands."""
        parts = [part for command in commands for part in (":", "-n", "1", *map(str, command))][1:]
        job = subprocess.run([*MPIRUN[:-1], *parts], cwd=self.folder, env={**self.environment, "MOTTLE_RANKS_TIMEOUT": "4"},
                             text=True, stdin=subprocess.DEVNULL, capture_output=True, check=False,
                             timeout=support.PATIENCE * timeout)
        return support.Run(job.returncode, job.stdout, job.stderr)

    def test_a_rank_that_never_joins_is_told(self):
        update = [support.MOTTLE, "update", "study.toml", "--out", "out", "--quiet"]
        for others in (["/bin/true"], [support.MOTTLE, "check", "study.toml"]):
            for commands in ((update, others), (others, update)):
                ended = self.ranked_as(*commands)
                self.assertNotEqual(ended.code, 0, ended.err)
                # Open MPI's mpirun sees it by itself where the others had called MPI_Init before that rank ended.
                self.assertRegex(ended.err, "has waited 4 s for the other ranks to join|exiting improperly")
                self.assertEqual("has waited" in ended.err, ended.code == 3, ended.err)
        ended = self.ranked_as(update, [support.MOTTLE, "propagate", "study.toml", "--out", "out", "--quiet"])
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("rank 1 was started with 'mottle propagate' and rank 0 with 'mottle update'", ended.err)

    def signalled(self, number, rank):
        """How a job of three ends when one of its ranks gets a signal, and within how many seconds."""
        study = self.tower(0.0)
        self.succeed("update", study, "--quiet", "--out", "alone")
        before = len(self.runs())
        self.pace(0.1)
        job = self.start(3, "update", study, "--quiet", "--out", "out")
        while len(self.runs()) < before + 12 and job.poll() is None:
            time.sleep(0.05)
        self.signal_rank(job, number, rank)
        begin = time.monotonic()
        out, err = job.communicate(timeout=support.PATIENCE * 60)
        return support.Run(job.returncode, out, err), time.monotonic() - begin, study, before

    def expect_resumed(self, study, before):
        self.pace(0.0)
        self.succeed_ranked(2, "update", study, "--quiet", "--out", "out", "--resume")
        self.assertEqual(numbers(self.folder / "out")[1], numbers(self.folder / "alone")[1])
        in_flight = 3 * 2
        self.assertLessEqual(len(self.runs()), 2 * before + in_flight)

    def test_a_killed_rank_ends_the_job(self):
        ended, seconds, study, before = self.signalled(signal.SIGKILL, 2)
        self.assertNotEqual(ended.code, 0)
        self.assertLess(seconds, support.PATIENCE * 10)
        self.expect_resumed(study, before)

    def signal_rank(self, job, number, rank):
        children = subprocess.run(["pgrep", "-P", str(job.pid)], capture_output=True, text=True, check=True).stdout
        for process in map(int, children.split()):
            environment = pathlib.Path(f"/proc/{process}/environ").read_bytes().split(b"\0")
            if f"OMPI_COMM_WORLD_RANK={rank}".encode() in environment:
                os.kill(process, number)

    def test_a_stop_of_a_rank_that_waits_for_others_stops_all(self):
        study = self.tower(60)
        job = self.start(2, "update", study, "--quiet", "--out", "out")
        while not self.runs() and job.poll() is None:  # the run at the means: rank 1 waits for it
            time.sleep(0.05)
        time.sleep(0.5)
        self.signal_rank(job, signal.SIGTERM, 1)
        out, err = job.communicate(timeout=support.PATIENCE * 20)
        self.assertEqual(job.returncode, 4, err)
        self.assertEqual(err.count("mottle: stopped on request"), 1, err)

    def test_an_error_that_one_rank_alone_meets_is_told_once_and_names_it(self):
        study = self.tower(0.05)
        (self.folder / "out" / "runs-1.store").mkdir(parents=True)
        ended = self.ranked(3, "update", study, "--quiet", "--out", "out")
        self.assertIn(ended.code, (2, 3), ended.err)
        told = [line for line in ended.err.splitlines() if line.startswith("mottle: ")]
        self.assertEqual(len(told), 1, ended.err)
        self.assertIn(f"mottle: rank 1 on {os.uname().nodename}: ", told[0])
        self.assertIn("runs-1.store", told[0])

    def test_a_stop_of_one_rank_stops_all(self):
        ended, seconds, study, before = self.signalled(signal.SIGTERM, 1)
        self.assertEqual(ended.code, 4, ended.err)
        self.assertEqual(ended.err.count("mottle: stopped on request"), 1, ended.err)
        self.assertLess(seconds, support.PATIENCE * 10)
        self.expect_resumed(study, before)


if __name__ == "__main__":
    support.main()
