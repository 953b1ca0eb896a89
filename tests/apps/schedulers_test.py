"""Runs of a solver by commands of PBS and LSF; programs of the test stand in for them. More in nightly/schedulers_test.py.

A run takes 0.3 s so that a driver can be killed in their midst: on a busy machine they may be over before it is.

    python3 schedulers_test.py PATH_TO_MOTTLE
"""

import json
import re
import shutil
import subprocess

import scheduler_jobs
import support


class Schedulers(scheduler_jobs.SchedulersTest):
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

    def test_a_queue_that_is_not_there_is_told_in_the_schedulers_words(self):
        for launch, words in (("pbs", "Unknown queue"), ("lsf", "No such queue")):
            self.tower(launch, 0.0, 'partition = "no-such"')
            self.assertIn(words, self.end(self.start(), code=3))
            for name in ("tower", "alone"):
                shutil.rmtree(self.folder / name)

    def test_a_queue_that_takes_no_array_at_all_is_told_in_its_words(self):
        self.tower("pbs", 0.0, "")
        (self.state / "longest").write_text("0")
        self.assertIn("exceeds server", self.end(self.start(), code=3))
        self.assertFalse((self.folder / "out" / "tasks").exists())

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
        plan = re.search(r"by tasks of LSF \(1000 runs: (\d+) tasks of (\d+) runs, at most 4 at once\)", ended.out)
        self.assertTrue(plan, ended.out)
        tasks, runs = map(int, plan.groups())  # 4 of 250; more where a run takes seconds, as on a busy machine
        self.assertGreaterEqual(tasks, 4)
        self.assertTrue((tasks - 1) * runs < 1000 <= tasks * runs, plan.group())
        self.assertEqual({path.name for path in self.folder.iterdir()} - before, {"runs.log"})


if __name__ == "__main__":
    support.main()
