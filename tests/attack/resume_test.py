"""A run that is killed or stopped goes on with --resume and ends with the same numbers (kills_test.py: at random moments).

Runs are killed when their journal or files have come so far, which a busy machine does not change; a stop request must be
answered within 1.2 s. Further moments are in nightly/resume_test.py.

    python3 resume_test.py PATH_TO_MOTTLE
"""

import os
import shutil
import signal
import subprocess

from attack import support
from interrupted_runs import LONG, InterruptedRuns
from support import TESTS, edited, numbers


class ResumeTest(InterruptedRuns):
    def test_kills_while_the_results_are_written(self):
        self.assert_resumes_when_killed_at("cloud-initial.csv", "report.html")

    def test_a_stop_request_is_answered_within_a_second(self):
        self.assert_stops_at(1.0)

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
        self.write("study.toml", edited(LONG, ("samples = 45000", "samples = 200000")))
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
