"""Updates that are killed or stopped, and what --resume makes of them: what resume_test.py and nightly/resume_test.py share."""

import shutil
import signal
import subprocess
import time

from attack import support
from support import STUDY, edited, numbers

LONG = edited(STUDY, ("samples = 200", "samples = 45000"), ("iterations = 30", "iterations = 12"))


class InterruptedRuns(support.CommandTest):
    """One run, uninterrupted, is what all others are compared with."""

    reference = None

    def setUp(self):
        super().setUp()
        self.write("study.toml", LONG)
        if InterruptedRuns.reference is None:
            self.succeed("update", "study.toml", "--out", "whole", "--quiet")
            InterruptedRuns.reference = numbers(self.folder / "whole")
            shutil.rmtree(self.folder / "whole")

    @property
    def out(self):
        return self.folder / "out"

    def start(self, *arguments):
        return subprocess.Popen([support.MOTTLE, "update", "study.toml", "--out", "out", *arguments], cwd=self.folder,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def wait_for_journal(self, size):
        """Until the journal holds `size` bytes; says whether it did before the run ended."""
        end = time.monotonic() + 30
        journal = self.out / "resume.journal"
        while time.monotonic() < end:
            try:
                if journal.stat().st_size >= size:
                    return True
            except FileNotFoundError:
                if (self.out / "result.json").exists():
                    return False
            time.sleep(0.001)
        self.fail("the run wrote no journal")

    def assert_resumes(self, what):
        ended = self.call("update", "study.toml", "--out", "out", "--resume", "--quiet")
        self.assertEqual(ended.code, 0, f"{what}: {ended.err}")
        self.assertEqual(numbers(self.out), self.reference, what)
        self.assertFalse((self.out / "resume.journal").exists())
        self.assertFalse(list(self.out.glob("*.partial")))

    def kill_part_way(self):
        """A folder with half a journal."""
        process = self.start("--quiet")
        self.wait_for_journal(1 << 20)
        process.kill()
        process.communicate()
        self.assertTrue((self.out / "resume.journal").exists(), "the run was over before it was killed")

    def assert_resumes_when_killed_at(self, *files):
        """Killed as soon as a file is there."""
        for name in files:
            shutil.rmtree(self.out, ignore_errors=True)
            process = self.start("--quiet")
            end = time.monotonic() + 30
            while not (self.out / name).exists() and process.poll() is None and time.monotonic() < end:
                time.sleep(0.0005)
            process.kill()
            process.communicate()
            for file in self.out.iterdir():  # complete or not there
                if file.name.endswith(".csv"):
                    self.assertTrue(file.read_bytes().endswith(b"\n"), file.name)
                if file.name == "result.json":
                    self.assertEqual(numbers(self.out), self.reference)
            self.assert_resumes(f"killed when {name} appeared")

    def assert_stops_at(self, *moments):
        """A stop request is answered within a second while decks are read, a basis is trained, clouds run and derivatives are taken."""
        for moment in moments:
            process = subprocess.Popen([support.MOTTLE, "update", str(support.SOURCE / "examples" / "02-airframe" / "study.toml"), "--out", str(self.out),
                                        "--cache", "off", "--quiet", "--set", "update.iterations=30"], stderr=subprocess.PIPE, text=True)
            time.sleep(moment)
            if process.poll() is not None:
                break
            start = time.monotonic()
            process.send_signal(signal.SIGINT)
            _, err = process.communicate(timeout=20)
            self.assertLess(time.monotonic() - start, 1.2 * support.PATIENCE, f"after {moment} s")
            if process.returncode == -signal.SIGINT:
                continue  # it had not begun
            if process.returncode == 0:
                break  # it was at its end
            self.assertEqual(process.returncode, 4, err)
            self.assertIn("--resume", err)
