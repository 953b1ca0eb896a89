"""Runs of a solver by commands of PBS and LSF: cancelled, changed, cut in arrays, and asked for while nobody answers.

Takes minutes, as the driver asks a scheduler only every few seconds. Runs take so long that a driver can be killed in their
midst: on a busy machine they may be over before it is.

    python3 nightly/schedulers_test.py PATH_TO_MOTTLE
"""

import pathlib
import shutil
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import scheduler_jobs  # noqa: E402  (found by the line above)
import support  # noqa: E402


class Schedulers(scheduler_jobs.SchedulersTest):
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


if __name__ == "__main__":
    support.main()
