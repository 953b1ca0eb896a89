"""Runs of a solver by commands of PBS and LSF, for which programs of the tests stand in: what the tests of schedulers share."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time

import support

sys.path.insert(0, str(support.SOURCE / "tests" / "tools"))
import stand_in_scheduler  # noqa: E402  (found by the line above)

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

    def call_here(self, *arguments):
        return subprocess.run([support.MOTTLE, *arguments], cwd=self.folder, env=self.environment, text=True, check=True,
                              capture_output=True)

    def quietly_started(self):
        process = self.start("--quiet")
        process.communicate(timeout=support.PATIENCE * 120)
        return process.returncode
