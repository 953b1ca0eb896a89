"""The command under mpirun: the same numbers by any number of ranks, one voice, and an end of all where one ends.

Ranks are killed in the midst of runs of 0.1 s, and their job must end within 10 s of that: a busy machine may be too slow.
"""

import collections
import json
import os
import pathlib
import shutil
import signal
import subprocess
import time
import urllib.request

import served_model
import support
from rank_jobs import AIRFRAME, RanksTest, numbers
from support import THREE_MASSES


class Numbers(RanksTest):
    def test_three_masses(self):
        self.expect_same("update", THREE_MASSES / "case1.toml")

    def test_an_airframe(self):
        self.expect_same("update", AIRFRAME / "study.toml", ranks=(3,), options=("--set", "update.samples=100"))

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
        fails = 'import math\nif sum(pathlib.Path("tower.inp").read_bytes()) % 3 == 1:\n    raise SystemExit(3)'
        solver.write_text(support.edited(solver.read_text(), ("\nimport math", "\n" + fails)))
        options = ("--set", "model.largest_failed_part=0.9", "--set", "model.retries=0", "--set", "update.max_failed=0.9")
        alone = self.call("propagate", study, "--quiet", "--out", "alone", *options)
        ranked = self.ranked(3, "propagate", study, "--quiet", "--out", "by3", *options)
        self.assertEqual((alone.code, ranked.code), (0, 0), alone.err + ranked.err)
        one, three = (numbers(self.folder / name)[1] for name in ("alone", "by3"))
        self.assertIn("exit status 3", one)
        self.assertEqual(one, three)


class Servers(RanksTest):
    """A model behind UM-Bridge servers: one that counts what it is asked."""

    def model(self, **what):
        server = served_model.Model(**what)
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        self.write("tests.csv", support.TWO_MASSES_TESTS)
        self.write("served.toml", served_model.HEAD + served_model.MODEL.replace("URL", server.url) +
                   "parallel = 4\nlargest_failed_part = 0.9\n" + served_model.REST)
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
    def test_a_rank_that_never_joins_is_told(self):
        update = [support.MOTTLE, "update", "study.toml", "--out", "out", "--quiet"]
        self.expect_told(update, ["/bin/true"], update_is_first=True)
        self.expect_told(update, [support.MOTTLE, "check", "study.toml"], update_is_first=False)

    def test_a_rank_with_another_command_is_told(self):
        update = [support.MOTTLE, "update", "study.toml", "--out", "out", "--quiet"]
        propagate = [support.MOTTLE, "propagate", "study.toml", "--out", "out", "--quiet"]
        ended = self.ranked_as(update, propagate, patience_s=30)
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
