"""A run that is killed or stopped goes on with --resume and ends with the same numbers (kills_test.py: at random moments).

    python3 resume_test.py PATH_TO_MOTTLE
"""

import os
import shutil
import signal
import subprocess
import time

from attack import support
from support import STUDY, TESTS, edited, numbers

LONG = edited(STUDY, ("samples = 200", "samples = 45000"), ("iterations = 30", "iterations = 12"))


class ResumeTest(support.CommandTest):
    """One run, uninterrupted, is what all others are compared with."""

    reference = None
    duration = None

    def setUp(self):
        super().setUp()
        self.write("study.toml", LONG)
        if ResumeTest.reference is None:
            self.succeed("update", "study.toml", "--out", "whole", "--quiet")  # files read once: timed warm
            start = time.monotonic()
            self.succeed("update", "study.toml", "--out", "whole", "--quiet")
            ResumeTest.duration = time.monotonic() - start
            ResumeTest.reference = numbers(self.folder / "whole")
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

    def test_kills_one_after_another(self):
        for size in (1 << 19, 3 << 19, 5 << 19):
            process = self.start("--quiet", "--resume")
            self.wait_for_journal(size)
            process.kill()
            process.communicate()
        self.assert_resumes("three kills in one run")

    def test_resume_uses_what_is_there(self):
        self.kill_part_way()
        self.assert_resumes("half a journal")
        self.assertIn("of the interrupted run were used again", (self.out / "mottle.log").read_text(encoding="utf-8"))

    def test_kills_while_the_results_are_written(self):
        files = ["study.toml", "history.csv", "cloud-initial.csv", "cloud-final.csv", "clouds.csv", "result.json",
                 "report.html"]
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

    def test_a_stop_request_is_answered_within_a_second(self):
        """While decks are read, a basis is trained, clouds run and derivatives are taken."""
        for moment in (0.1, 0.3, 0.6, 1.0, 1.4, 1.8, 2.2, 2.6):
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

    def test_signals_stop_the_run_resumably(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            shutil.rmtree(self.out, ignore_errors=True)
            process = self.start()
            self.wait_for_journal(1 << 18)
            process.send_signal(number)
            _, err = process.communicate(timeout=20)
            self.assertEqual(process.returncode, 4, f"{number.name}: {err}")
            self.assertIn("--resume", err)
            self.assertTrue(err.splitlines()[-1].startswith("mottle: "), err)
            self.assertFalse((self.out / "result.json").exists())
            self.assert_resumes(number.name)

    def test_a_second_signal_ends_at_once(self):
        process = self.start()
        self.wait_for_journal(1 << 18)
        os.kill(process.pid, signal.SIGSTOP)  # both arrive before the run can look at the first
        os.kill(process.pid, signal.SIGINT)
        os.kill(process.pid, signal.SIGCONT)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=20)
        self.assertIn(process.returncode, (4, -signal.SIGTERM, -signal.SIGINT))  # handlers may nest
        self.assert_resumes("two signals")

    def test_journals_cut_at_the_ends_of_their_parts(self):
        self.kill_part_way()
        journal = (self.out / "resume.journal").read_bytes()
        for size in (0, 1, 10, 24, 25, 26, len(journal) - 1):
            (self.out / "resume.journal").write_bytes(journal[:size])
            self.assert_resumes(f"journal cut to {size} of {len(journal)} bytes")

    def contents(self):
        passing = {"mottle.log", ".mottle.lock"}
        return {file.name: file.read_bytes() for file in self.out.iterdir() if file.name not in passing}

    def assert_refuses(self, *arguments):
        before = self.contents()
        ended = self.call("update", "study.toml", "--out", "out", "--resume", *arguments)
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("changed", ended.err)
        self.assertIn("without --resume", ended.err)
        self.assertEqual(self.contents(), before, "a refused resume leaves the interrupted run as it was")

    def test_resume_refuses_what_has_changed(self):
        self.kill_part_way()
        self.write("tests.csv", TESTS + "0.16,0.33,0.45\n")
        self.assert_refuses()
        self.write("tests.csv", TESTS)
        self.write("study.toml", edited(LONG, ("mean = 2.0, std = 0.3 }\nbounds", "mean = 2.1, std = 0.3 }\nbounds")))
        self.assert_refuses()
        self.write("study.toml", LONG)
        self.assert_refuses("--seed", "8")
        self.assert_refuses("--set", "update.samples=44000")
        self.assert_resumes("after all refusals")

    def test_resume_refuses_changed_repeats(self):
        self.write("repeats.csv", "f1,f2,f3\n0.16,0.32,0.45\n0.17,0.33,0.46\n")
        self.write("study.toml", edited(LONG, ('file = "tests.csv"', 'file = "tests.csv"\nrepeatability = "repeats.csv"')))
        self.kill_part_way()
        self.write("repeats.csv", "f1,f2,f3\n0.16,0.32,0.45\n0.17,0.33,0.47\n")
        self.assert_refuses()

    def test_resume_at_another_number_of_threads(self):
        self.kill_part_way()
        self.succeed("update", "study.toml", "--out", "out", "--resume", "--threads", "1", "--quiet")
        self.assertEqual(numbers(self.out), self.reference)

    def test_resume_without_anything_to_resume(self):
        self.assert_resumes("nothing there")
        self.assert_resumes("a finished run")

    def test_a_fresh_run_forgets_the_interrupted_one(self):
        self.kill_part_way()
        self.write("study.toml", edited(LONG, ("seed = 7", "seed = 8")))
        self.succeed("update", "study.toml", "--out", "out", "--quiet")
        self.assertNotEqual(numbers(self.out), self.reference)

    def test_propagate_resumes_too(self):
        self.write("study.toml", edited(LONG, ("samples = 45000", "samples = 400000")))
        self.succeed("propagate", "study.toml", "--out", "whole", "--quiet")
        process = subprocess.Popen([support.MOTTLE, "propagate", "study.toml", "--out", "out", "--quiet"],
                                   cwd=self.folder)
        self.wait_for_journal(1 << 20)
        process.kill()
        process.wait()
        self.succeed("propagate", "study.toml", "--out", "out", "--resume", "--quiet")
        self.assertEqual(numbers(self.out), numbers(self.folder / "whole"))
        self.assertEqual((self.out / "cloud.csv").read_bytes(), (self.folder / "whole" / "cloud.csv").read_bytes())


if __name__ == "__main__":
    support.main()
