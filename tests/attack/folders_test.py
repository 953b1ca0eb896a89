"""What lies in the folder of results and is not Mottle's own stays; one process at a time writes there.

    python3 folders_test.py PATH_TO_MOTTLE
"""

import os
import shutil
import subprocess
import time
import unittest

from attack import support
from support import STUDY

SOLVER = """\
import pathlib, sys, time
k1, k2 = map(float, open("input.txt").read().split())
if k1 > 2.2:
    sys.exit("too stiff")
pathlib.Path("f.txt").write_text(f"{k1}\\n{k1 + k2}\\n{k1 + 2 * k2}\\n")
"""
SLOW = SOLVER + "time.sleep(0.3)\n"
PROPAGATE = ("propagate", "solver.toml", "--out", "out", "--quiet", "--set", "update.samples=12", "--set",
             "update.max_failed=0.9")
TRUTH = ("--set", "truth={specimens = 3}")
NOISE = ("--set", 'test.repeatability={"f*" = "1 %"}')


class FoldersTest(support.CommandTest):
    """One claim a test."""

    def setUp(self):
        super().setUp()
        self.write("solver.toml", support.command_study(["python3", "-S", "-E", "solver.py"]))
        self.write("input.txt", "{{k1}} {{k2}}\n")
        self.write("solver.py", SOLVER)
        self.out = self.folder / "out"

    def user_file(self, *parts):
        path = self.folder.joinpath(*parts)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("mine\n", encoding="utf-8")
        return path

    def failed(self):
        return sorted(path.name for path in (self.out / "failed-runs").iterdir())

    def test_folders_of_the_user_with_the_names_of_runs_stay(self):
        own = [self.user_file("out", "runs", "my-thesis", "x.dat"), self.user_file("out", "runs", "plain.txt"),
               self.user_file("out", "runs", "mottle-1-abcdef", "x.dat"), self.user_file("out", "failed-runs", "precious", "y"),
               self.user_file("out", "failed-runs", "sample-0001", "y")]
        for _ in range(2):
            self.succeed(*PROPAGATE)
        for path in own:
            self.assertEqual(path.read_text(encoding="utf-8"), "mine\n", path)

    def test_failed_runs_of_the_run_before_go_and_no_others(self):
        self.succeed(*PROPAGATE)
        before = self.failed()
        self.assertTrue(before, "some samples fail")
        kept = self.user_file("out", "failed-runs", before[0] + "-of-mine", "y")
        self.succeed(*PROPAGATE)
        self.assertEqual(self.failed(), sorted(before + [kept.parent.name]))

    def test_a_link_is_not_followed(self):
        target = self.user_file("elsewhere", "deep", "f")
        self.out.mkdir()
        (self.out / "runs").symlink_to(self.folder / "elsewhere")
        ended = self.call(*PROPAGATE)
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("is a link", ended.err)
        self.assertTrue(target.exists())
        (self.out / "runs").unlink()
        (self.out / "runs").mkdir()
        (self.out / "runs" / "mottle-1-abcdef").symlink_to(self.folder / "elsewhere")
        self.user_file("elsewhere", ".mottle-run").write_text("Made by Mottle for runs of a solver, and removed by it.\n")
        self.succeed(*PROPAGATE)
        self.assertTrue(target.exists())

    def test_files_of_mottles_own_are_not_written_through_links_or_second_names(self):
        self.succeed("update", "study.toml", "--out", "earlier", "--quiet")
        own = {"mottle.log": (self.folder / "earlier" / "mottle.log").read_bytes(), "resume.journal": b""}
        for name, left in own.items():
            for make in (os.symlink, os.link):
                for written, code in ((b"mine\n", 2), (left, 0)):
                    with self.subTest(name=name, make=make.__name__, code=code):
                        target = self.user_file("elsewhere", "mine.txt")
                        target.write_bytes(written)
                        self.out.mkdir()
                        make(target, self.out / name)
                        ended = self.call("update", "study.toml", "--out", "out", "--quiet")
                        self.assertEqual(ended.code, code, ended.err)
                        self.assertTrue(code == 0 or f"{name}: is not as an earlier run wrote it" in ended.err, ended.err)
                        self.assertEqual(target.read_bytes(), written)
                        shutil.rmtree(self.out)

    def test_files_that_are_gone_on_with_are_not_links(self):
        for name, command in (("mottle.log", ("update", "study.toml", "--resume")),
                              ("resume.journal", ("update", "study.toml", "--resume")),
                              ("runs.store", ("update", "solver.toml")), ("runs.store", ("check", "solver.toml"))):
            with self.subTest(name=name, command=command):
                target = self.user_file("elsewhere", "mine.txt")
                target.write_text("", encoding="utf-8")
                self.out.mkdir()
                (self.out / name).symlink_to(target)
                ended = self.call(*command, "--out", "out", "--quiet")
                self.assertEqual(ended.code, 2, ended.err)
                self.assertIn(f"{name}: is a link", ended.err)
                self.assertEqual(target.read_text(encoding="utf-8"), "")
                (self.out / name).unlink()
                shutil.rmtree(self.out)

    def test_pipes_in_place_of_files_of_mottles_own_are_not_waited_for(self):
        for name, command in (("mottle.log", ("update", "study.toml", "--out", "out", "--quiet")),
                              ("resume.journal", ("update", "study.toml", "--out", "out", "--quiet")),
                              ("result.json", ("update", "study.toml", "--out", "out", "--quiet")), ("runs.store", PROPAGATE)):
            with self.subTest(name=name):
                self.out.mkdir()
                os.mkfifo(self.out / name)
                ended = self.call(*command)
                self.assertEqual(ended.code, 2, ended.err)
                self.assertIn(f"{name}: ", ended.err)
                self.assertTrue((self.out / name).is_fifo())
                shutil.rmtree(self.out)

    def test_no_file_that_the_study_reads_is_written_over(self):
        self.write("truth.toml", STUDY + "[truth]\nspecimens = 3\n")
        self.write("other.csv", support.TESTS)
        (self.folder / "linked").mkdir()
        (self.folder / "linked" / "tests.csv").symlink_to("../other.csv")
        before = {name: (self.folder / name).read_bytes() for name in ("study.toml", "tests.csv", "other.csv", "truth.toml")}
        for command in (("update", "study.toml", "--out", "."), ("propagate", "study.toml", "--out", "."),
                        ("check", "study.toml", "--out", "."), ("simulate", "study.toml", "--out", ".", *TRUTH),
                        ("update", "truth.toml", "--out", "."),
                        ("update", "study.toml", "--set", 'test.file="other.csv"', "--out", "linked")):
            ended = self.call(*command)
            self.assertEqual(ended.code, 2, ended.err)
            self.assertIn("the study reads this file", ended.err)
        self.succeed("simulate", "truth.toml", "--set", 'test.file="drawn/specimens.csv"', "--out", "drawn", "--quiet")
        self.succeed("update", "truth.toml", "--set", 'test.file="drawn/specimens.csv"', "--out", "drawn", "--quiet", "--set",
                     'update.method="maximum-likelihood"', *NOISE)
        self.assertEqual({name: (self.folder / name).read_bytes() for name in before}, before)

    def start(self, *arguments):
        return subprocess.Popen([support.MOTTLE, *arguments], cwd=self.folder, stdout=subprocess.DEVNULL,
                                stderr=subprocess.PIPE, text=True)

    def test_a_killed_runs_folder_is_taken_away_by_the_next(self):
        self.write("solver.py", SLOW)
        first = self.start(*PROPAGATE)
        while not list(self.out.glob("runs/*/run-1/stdout.txt")):
            time.sleep(0.01)
        first.kill()
        first.communicate()
        self.assertTrue(list(self.out.glob("runs/*")))
        self.write("solver.py", SOLVER)
        self.succeed(*PROPAGATE)
        self.assertFalse((self.out / "runs").exists())
        self.assertFalse((self.out / ".mottle.lock").exists())

    def test_a_second_command_is_refused_and_harms_nothing(self):
        hold = self.folder / "hold"  # while it is there, no run of the solver ends
        self.write("solver.py", SOLVER + f"import os\nwhile os.path.exists({str(hold)!r}):\n    time.sleep(0.02)\n")
        self.succeed("propagate", "solver.toml", "--out", "alone", *PROPAGATE[4:])
        hold.touch()
        first = self.start(*PROPAGATE)
        self.addCleanup(first.kill)
        while not list(self.out.glob("runs/*/run-1/stdout.txt")):
            time.sleep(0.01)
        for command in (PROPAGATE, ("update", "study.toml", "--out", "out"), ("diagnose", "study.toml", "--out", "out"),
                        ("simulate", "study.toml", "--out", "out"), ("report", "out")):
            ended = self.call(*command)
            self.assertEqual(ended.code, 2, ended.err)
            self.assertIn(f"another Mottle is filling this folder (process {first.pid})", ended.err)
        hold.unlink()
        _, error = first.communicate(timeout=100)
        self.assertEqual(first.returncode, 0, error)
        self.assertEqual((self.out / "cloud.csv").read_bytes(), (self.folder / "alone" / "cloud.csv").read_bytes())

    def test_a_refused_study_leaves_no_folder(self):
        self.write("bad.toml", STUDY.replace('target = "spring:k1"', 'target = "spring:k9"'))
        self.assertEqual(self.call("update", "bad.toml", "--out", "deep/er/out").code, 2)
        self.assertFalse((self.folder / "deep").exists())

    @unittest.skipIf(os.geteuid() == 0, "root may write everywhere")
    def test_a_folder_that_cannot_be_written_is_said_so(self):
        self.out.mkdir(mode=0o500)
        ended = self.call("update", "study.toml", "--out", "out")
        self.assertEqual(ended.code, 2)
        self.assertIn("--out", ended.err)


if __name__ == "__main__":
    support.main()
