"""What lies in the folder of results and is not Mottle's own stays; one process at a time writes there.

    python3 folders_test.py PATH_TO_MOTTLE
"""

import json
import os
import subprocess
import time
import unittest

import support
from support import STUDY

SOLVER = """\
import pathlib, sys, time
k1, k2 = map(float, open("input.txt").read().split())
if k1 > 2.2:
    sys.exit("too stiff")
pathlib.Path("f.txt").write_text(f"{k1}\\n{k1 + k2}\\n{k1 + 2 * k2}\\n")
"""
SLOW = SOLVER + "time.sleep(0.3)\n"
# What a solver may do to its folder before it fails; each costs its sample alone.
ATTACKS = {
    "takes its folder away": "import shutil, os; shutil.rmtree(os.getcwd())",
    "makes its folder read-only": "import os; os.chmod('.', 0o500)",
    "puts a file in place of its folder": "import shutil, os; d = os.getcwd(); shutil.rmtree(d); open(d, 'w').close()",
    "makes reason.txt a folder": "import os; os.mkdir('reason.txt')",
    "makes reason.txt a link out of the folder": "import os; os.symlink(VICTIM, 'reason.txt')",
    "makes its mark a link out of the folder": "import os; os.symlink(VICTIM, '.mottle-run')",
    "prints bytes that are not text": "import os; os.write(2, b'caf\\xe9 \\xff\\x1b[31m\\n')",
    "writes numbers that are not text": "open('f.txt', 'wb').write(b'\\xff\\xfe 1\\n'); sys.exit(0)",
}
PROPAGATE = ("propagate", "solver.toml", "--out", "out", "--quiet", "--set", "update.samples=12", "--set",
             "update.max_failed=0.9")


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

    def test_what_a_solver_does_to_its_folder_costs_its_sample_alone(self):
        self.succeed(*PROPAGATE)
        clean = json.loads((self.out / "result.json").read_text(encoding="utf-8"))
        victim = self.user_file("victim", "x")
        for name, attack in ATTACKS.items():
            with self.subTest(name):
                attack = attack.replace("VICTIM", repr(str(victim)))
                self.write("solver.py", SOLVER.replace('sys.exit("too stiff")', attack + "; sys.exit(1)"))
                self.succeed(*PROPAGATE)
                result = json.loads((self.out / "result.json").read_text(encoding="utf-8"))
                self.assertEqual(result["outputs"], clean["outputs"])
                self.assertEqual(len(result["failed_evaluations"]), len(clean["failed_evaluations"]))
                self.assertEqual(victim.read_text(encoding="utf-8"), "mine\n")

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
        self.write("solver.py", SLOW)
        self.succeed("propagate", "solver.toml", "--out", "alone", *PROPAGATE[4:])
        first = self.start(*PROPAGATE)
        while not list(self.out.glob("runs/*/run-1/stdout.txt")):
            time.sleep(0.01)
        for command in (PROPAGATE, ("update", "study.toml", "--out", "out"), ("diagnose", "study.toml", "--out", "out"),
                        ("simulate", "study.toml", "--out", "out"), ("report", "out")):
            ended = self.call(*command)
            self.assertEqual(ended.code, 2, ended.err)
            self.assertIn(f"another Mottle is filling this folder (process {first.pid})", ended.err)
        _, error = first.communicate(timeout=100)
        self.assertEqual(first.returncode, 0, error)
        self.assertEqual((self.out / "cloud.csv").read_bytes(), (self.folder / "alone" / "cloud.csv").read_bytes())

    def test_of_two_updates_at_once_the_folder_holds_one_whole(self):
        alone = {}
        for seed in ("1", "2"):
            self.succeed("update", "study.toml", "--out", "alone", "--quiet", "--seed", seed)
            alone[seed] = self.contents("alone")
        for delay in (0.0, 0.01, 0.03, 0.06):
            runs = {}
            for seed in ("1", "2"):
                runs[seed] = self.start("update", "study.toml", "--out", "out", "--quiet", "--seed", seed)
                time.sleep(delay)
            codes = {seed: (process.communicate()[1], process.returncode)[1] for seed, process in runs.items()}
            self.assertIn(0, codes.values())
            self.assertLessEqual(set(codes.values()), {0, 2})
            self.assertIn(self.contents("out"), [alone[seed] for seed in codes if codes[seed] == 0])

    def contents(self, name):
        folder = self.folder / name
        return {file: (folder / file).read_bytes() for file in ("history.csv", "cloud-final.csv", "clouds.csv")}

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
