"""Runs of a solver by commands of PBS and LSF; programs of the test stand in for them.

    python3 schedulers_test.py PATH_TO_MOTTLE
"""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
import stand_in_scheduler
import support

TOWER = support.SOURCE / "examples" / "04-any-solver"
SLOW = """import pathlib, time
with open({log!r}, "a") as log:
    log.write(pathlib.Path("tower.inp").read_text().replace("\\n", " ") + "\\n")
time.sleep({seconds})
import math"""


class SchedulersTest(support.CommandTest):
    def setUp(self):
        super().setUp()
        self.server = stand_in_scheduler.start(self.folder / "bin")
        self.addCleanup(self.end_server)
        self.state = self.folder / "bin" / "state"
        self.environment = {**os.environ, "PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}"}

    def end_server(self):
        self.server.terminate()
        self.server.wait()

    def tower(self, launch, seconds, options, samples=12):
        shutil.copytree(TOWER, self.folder / "tower")
        solver = self.folder / "tower" / "tower.py"
        log = str(self.folder / "runs.log")
        solver.write_text(support.edited(solver.read_text(), ("import math", SLOW.format(log=log, seconds=seconds))))
        study = self.folder / "tower" / "study.toml"
        text = support.edited(study.read_text(), ("samples = 40", f"samples = {samples}"))
        study.write_text(support.edited(text, ("parallel = 2", "parallel = 16")))
        self.succeed("propagate", "tower/study.toml", "--quiet", "--out", "alone")
        (self.folder / "runs.log").unlink(missing_ok=True)
        study.write_text(support.edited(text, ("parallel = 2", f'launch = "{launch}"'), (
            "[model.frequencies]", f"[model.scheduler]\n{options}\n[model.frequencies]")))

    def start(self, *options):
        return subprocess.Popen([support.MOTTLE, "propagate", "tower/study.toml", "--out", "out", *options], text=True,
                                cwd=self.folder, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def end(self, process, code=0):
        out, err = process.communicate(timeout=support.PATIENCE * 120)
        self.assertEqual(process.returncode, code, err + out)
        return err

    def runs(self):
        file = self.folder / "runs.log"
        return file.read_text().splitlines() if file.exists() else []

    def wait_for(self, runs):
        end = time.monotonic() + support.PATIENCE * 60
        while len(self.runs()) < runs and time.monotonic() < end:
            time.sleep(0.02)

    def kill_after(self, runs):
        process = self.start()
        self.wait_for(runs)
        process.send_signal(signal.SIGKILL)
        process.communicate()

    def expect_same(self, again=0):
        self.assertEqual(support.numbers(self.folder / "out"), support.numbers(self.folder / "alone"))
        self.assertLessEqual(len(self.runs()) - len(set(self.runs())), again)
        self.assertFalse((self.folder / "out" / "tasks").exists())

    def asked(self):
        """Arguments of the job with three tasks."""
        jobs = [json.loads(file.read_text()) for file in self.state.glob("*/asked")]
        return next(job for job in jobs if any("1-3" in part for part in job))

    def through(self, launch):
        """Killed, found again, a task cancelled by hand, and done."""
        options = 'runs_per_task = 4\ntime = "90 min"\ncores = 2\nlicences = "ansys:1"\naccount = "me"\nruns_at_once = 2\n'
        self.tower(launch, 0.3, options)
        self.kill_after(5)
        status = json.loads(subprocess.run([support.MOTTLE, "status", "out", "--json"], cwd=self.folder, text=True,
                                           env=self.environment, capture_output=True, check=True).stdout)
        self.assertEqual([array["runs"] for array in status["arrays"]], [12])
        self.assertEqual(status["arrays"][0]["tasks"], 3)
        job = max(int(folder.name) for folder in self.state.iterdir() if folder.is_dir())
        (self.state / str(job) / "cancel-3").touch()
        self.end(self.start("--resume"))
        self.expect_same(again=1)
        return self.asked()

    def test_pbs(self):
        asked = self.through("pbs")
        for option in (["-J", "1-3%2"], ["-l", "walltime=01:30:00"], ["-l", "select=1:ncpus=2"], ["-l", "ansys=1"], ["-A", "me"]):
            self.assertIn(option, [asked[i:i + 2] for i in range(len(asked))])

    def test_lsf(self):
        asked = self.through("lsf")
        for option in (["-W", "90"], ["-n", "2"], ["-R", "rusage[ansys=1]"], ["-P", "me"]):
            self.assertIn(option, [asked[i:i + 2] for i in range(len(asked))])
        self.assertTrue(any(part.endswith("[1-3]%2") for part in asked), asked)

    def test_a_cancelled_job_ends_the_driver(self):
        for launch in ("pbs", "lsf"):
            with self.subTest(launch):
                self.tower(launch, 0.3, "runs_per_task = 4")
                process = self.start()
                self.wait_for(3)
                subprocess.run([support.MOTTLE, "cancel", "out"], cwd=self.folder, env=self.environment, check=True,
                               stdout=subprocess.DEVNULL)
                words = self.end(process, code=4)
                self.assertIn("mottle cancel", words)
                self.assertEqual(words.count("--resume"), 1, words)
                self.end(self.start("--resume", "--quiet"))
                self.expect_same(again=3)
                for name in ("tower", "out", "alone"):
                    shutil.rmtree(self.folder / name)
                (self.folder / "runs.log").unlink()

    def test_a_scheduler_that_does_not_answer_for_a_while_stops_nothing(self):
        self.tower("lsf", 0.0, "")
        (self.state / "silent").touch()
        process = self.start()
        time.sleep(2.0)
        self.assertIsNone(process.poll())
        (self.state / "silent").unlink()
        self.assertIn("it is asked again until it answers", self.end(process))
        self.expect_same()

    def test_a_queue_that_is_not_there_is_told_in_the_schedulers_words(self):
        for launch, words in (("pbs", "Unknown queue"), ("lsf", "No such queue")):
            self.tower(launch, 0.0, 'partition = "no-such"')
            self.assertIn(words, self.end(self.start(), code=3))
            for name in ("tower", "alone"):
                shutil.rmtree(self.folder / name)

    def test_arrays_are_as_long_as_the_queue_takes(self):
        for launch, limit, words in (("pbs", "most", "would exceed"), ("lsf", "longest", "index too large")):
            with self.subTest(launch=launch, limit=limit):
                self.tower(launch, 0.0, "runs_per_task = 1")
                (self.state / limit).write_text("6")
                self.end(self.start())
                (self.state / limit).unlink()
                self.expect_same()
                self.assertIn(words, (self.folder / "out" / "mottle.log").read_text())
                for name in ("tower", "out", "alone"):
                    shutil.rmtree(self.folder / name)
                (self.folder / "runs.log").unlink()

    def test_a_queue_that_takes_no_array_at_all_is_told_in_its_words(self):
        self.tower("pbs", 0.0, "")
        (self.state / "longest").write_text("0")
        self.assertIn("exceeds server", self.end(self.start(), code=3))
        self.assertFalse((self.folder / "out" / "tasks").exists())

    def test_changed_files_are_not_mixed_with_runs_of_before(self):
        self.tower("pbs", 0.5, "runs_per_task = 12\nruns_at_once = 1", samples=12)
        self.kill_after(3)
        solver = self.folder / "tower" / "tower.py"
        solver.write_text(solver.read_text().replace("time.sleep(0.5)", "time.sleep(0.0)") + "# changed\n")
        self.end(self.start("--quiet"))
        self.assertIn("of other files, are ended", (self.folder / "out" / "mottle.log").read_text())
        self.assertEqual(len(set(self.runs())), 12 + 1, "and the one at the means")

    def test_a_changed_template_ends_the_tasks_of_before(self):
        self.tower("lsf", 0.5, "runs_per_task = 12\nruns_at_once = 1", samples=12)
        self.kill_after(3)
        template = self.folder / "tower" / "tower.inp.in"
        template.write_text(template.read_text() + "\n")
        self.end(self.start("--quiet"))
        self.assertIn("of other files, are ended", (self.folder / "out" / "mottle.log").read_text())

    def test_a_copied_folder_leaves_the_tasks_to_the_original(self):
        self.tower("pbs", 0.4, "runs_per_task = 4")
        self.kill_after(4)
        shutil.copytree(self.folder / "out", self.folder / "copy")
        ended = support.run("cancel", "copy", cwd=self.folder, environment=self.environment)
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("is a copy", ended.err)
        ended = support.run("status", "copy", cwd=self.folder, environment=self.environment)
        self.assertIn("a copy: its tasks belong to", ended.out)
        self.end(self.start("--resume"))
        self.expect_same()

    def test_faults_of_a_study_are_refused_with_their_line(self):
        self.tower("pbs", 0.0, "")
        for change, words in ((("launch = \"pbs\"", "launch = \"local\""), "is for model.launch"),
                              (("launch = \"pbs\"", "launch = \"pbx\""), "did you mean \"pbs\"?"),
                              (("[model.scheduler]", "[model.scheduler]\ncore = 3"), "did you mean 'cores'?"),
                              (("[model.scheduler]", "[model.scheduler]\nextra = [\"-N\", \"mine\"]"), "finds its tasks by them"),
                              (("[model.scheduler]", "[model.scheduler]\nlicences = \"a:b\""), "ansys:1"),
                              (("launch = \"pbs\"", "launch = \"pbs\"\nparallel = 3"), "runs_at_once"),
                              (("[model.scheduler]", '[model.scheduler]\npartition = "a\\nb"'), "partition: holds a line break"),
                              (("[model.scheduler]", '[model.scheduler]\naccount = "a\\u0000b"'), "account: holds a line break"),
                              (("[model.scheduler]", '[model.scheduler]\nextra = ["--x=\\u0000"]'), "extra: holds a line break")):
            text = (self.folder / "tower" / "study.toml").read_text()
            self.write("tower/wrong.toml", support.edited(text, change))
            ended = self.call("check", "tower/wrong.toml")
            self.assertEqual(ended.code, 2, change)
            self.assertIn("wrong.toml:", ended.err)
            self.assertIn(words, ended.err)
        self.write("tower/ranks.toml", support.edited(text, ('launch = "pbs"', 'launch = "mpi"'), ("[model.scheduler]", "")))
        ended = self.call("propagate", "tower/ranks.toml", "--out", "out")
        self.assertEqual(ended.code, 2)
        self.assertIn("mpirun", ended.err)
        self.succeed("check", "tower/ranks.toml")

    def test_lists_that_show_nothing_end_no_task(self):
        for launch in ("pbs", "lsf"):
            with self.subTest(launch):
                self.tower(launch, 0.5, "runs_per_task = 4\nruns_at_once = 1")
                process = self.start()
                self.wait_for(3)
                (self.state / "blind").touch()
                self.end(process)
                (self.state / "blind").unlink()
                self.expect_same()
                for name in ("tower", "out", "alone"):
                    shutil.rmtree(self.folder / name)
                (self.folder / "runs.log").unlink()

    def test_another_launch_is_refused_while_tasks_are_left(self):
        self.tower("pbs", 0.4, "runs_per_task = 6\nruns_at_once = 1")
        self.kill_after(3)
        study = self.folder / "tower" / "study.toml"
        text = study.read_text()
        scheduled = text[text.index("[model.scheduler]"):text.index("[model.frequencies]")]
        for launch, changes in (("local", (('launch = "pbs"', "parallel = 2"), (scheduled, ""))),
                                ("lsf", (('launch = "pbs"', 'launch = "lsf"'),))):
            study.write_text(support.edited(text, *changes))
            words = self.end(self.start(), code=2)
            for part in (f'"{launch}" now', 'tasks of "pbs"', "mottle cancel", "not at their end"):
                self.assertIn(part, words)
            self.assertEqual(words.count("mottle cancel"), 1, words)
        self.call_here("cancel", "out")
        end = time.monotonic() + support.PATIENCE * 30
        while (code := self.quietly_started()) == 2 and time.monotonic() < end:  # until the tasks have ended
            time.sleep(0.2)
        self.assertEqual(code, 0)
        study.write_text(support.edited(text, ('launch = "pbs"', "parallel = 2"), (scheduled, "")))
        self.end(self.start())
        self.expect_same(again=2)

    def call_here(self, *arguments):
        return subprocess.run([support.MOTTLE, *arguments], cwd=self.folder, env=self.environment, text=True, check=True,
                              capture_output=True)

    def quietly_started(self):
        process = self.start("--quiet")
        process.communicate(timeout=support.PATIENCE * 120)
        return process.returncode

    def test_tasks_with_old_options_are_told_once(self):
        self.tower("lsf", 0.4, "runs_per_task = 6\nruns_at_once = 1\ncores = 2")
        self.kill_after(3)
        study = self.folder / "tower" / "study.toml"
        study.write_text(support.edited(study.read_text(), ("cores = 2", 'cores = 3\naccount = "other"')))
        words = self.end(self.start())
        for text in (words, (self.folder / "out" / "mottle.log").read_text()):
            self.assertEqual(text.count("keep the old options"), 1, text)
            self.assertIn('account = "", now account = "other"; cores = 2, now cores = 3', text)
        self.expect_same()

    def test_what_a_killed_check_has_left_goes_with_the_next(self):
        self.tower("lsf", 1.0, "")
        process = subprocess.Popen([support.MOTTLE, "check", "tower/study.toml"], cwd=self.folder, env=self.environment,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.wait_for(1)
        process.kill()
        process.communicate()
        left = list(self.folder.glob("mottle-tasks-*"))
        self.assertEqual(len(left), 1)
        writer = f"i=0; while [ -d {left[0]} ]; do i=$((i+1)); echo > {left[0]}/late-$i || exit; done"
        late = subprocess.Popen(["sh", "-c", writer], stderr=subprocess.DEVNULL)  # a task that does not end
        self.addCleanup(late.kill)
        self.call_here("check", "tower/study.toml")
        late.communicate(timeout=support.PATIENCE * 10)
        self.assertEqual(list(self.folder.glob("mottle-tasks-*")), [])
        self.assertTrue((self.state / "1" / "cancel").exists(), "its job is cancelled")

    def test_a_task_without_an_array_is_refused(self):
        (self.folder / "nothing").mkdir()
        ended = self.call("run-task", "nothing", "1")
        self.assertEqual(ended.code, 2)
        self.assertIn("holds no array of tasks", ended.err)
        self.assertEqual(len(ended.err.splitlines()), 1, ended.err)

    def test_check_says_the_plan_and_leaves_nothing(self):
        self.tower("lsf", 0.0, "runs_at_once = 4")
        before = {path.name for path in self.folder.iterdir()}
        ended = support.run("check", "tower/study.toml", cwd=self.folder, environment=self.environment)
        self.assertEqual(ended.code, 0, ended.err)
        self.assertIn("by tasks of LSF (1000 runs: 4 tasks of 250 runs, at most 4 at once)", ended.out)
        self.assertEqual({path.name for path in self.folder.iterdir()} - before, {"runs.log"})


if __name__ == "__main__":
    support.main()
