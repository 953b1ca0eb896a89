"""Results of an earlier run never stand as those of a run that did not come to its end.

    python3 earlier_results_test.py PATH_TO_MOTTLE
"""

import json
import shutil
import subprocess
import tempfile
import time
import unittest

import nastran_test
import support
from support import STUDY, edited, numbers

OLD_TITLE, NEW_TITLE = 'title = "A study for tests"', 'title = "Another study"'
# The study with a solver that only knows the parameters' means; they are places in a template.
SOLVER = """\
import sys
if [float(word) for word in open("input.txt").read().split()] != [2.0, 2.0]:
    sys.exit("no")
open("f.txt", "w").write("0.2\\n0.3\\n0.5\\n")
"""
FAILING = edited(support.command_study(["python3", "-S", "-E", "solver.py"]), ("samples = 200", "samples = 12"))
TRUTH = "\n[truth]\nspecimens = 3\n"
# One that says that it has begun and does not end; in place of CalculiX too.
ENDLESS = """\
#!/usr/bin/env python3
import pathlib, sys, time
if sys.argv[1:] == ["-v"]:
    print("This is Version 9")
    sys.exit()
pathlib.Path({}).touch()
time.sleep(600)
"""


class EarlierResultsTest(support.CommandTest):
    """One claim a test."""

    earlier = None

    def setUp(self):
        super().setUp()
        self.write("failing.toml", FAILING)
        self.write("input.txt", "{{k1}} {{k2}}\n")
        self.write("solver.py", SOLVER)
        self.out = self.folder / "out"
        self.previous = self.out / "previous-results"
        self.copy_earlier_results()
        self.first = numbers(self.out)

    def copy_earlier_results(self):
        """Those of an update that is made once."""
        if EarlierResultsTest.earlier is None:
            place = tempfile.TemporaryDirectory(prefix="mottle-test-")
            self.addClassCleanup(place.cleanup)
            EarlierResultsTest.earlier = f"{place.name}/out"
            self.succeed("update", "study.toml", "--out", EarlierResultsTest.earlier, "--quiet")
        shutil.copytree(EarlierResultsTest.earlier, self.out)

    def run_into_failure(self, *arguments):
        ended = self.call("update", "failing.toml", "--out", "out", "--quiet", *arguments)
        self.assertEqual(ended.code, 3, ended.err)

    def kill_when(self, has_begun, *arguments):
        process = subprocess.Popen([support.MOTTLE, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + 60 * support.PATIENCE
        while not has_begun():
            self.assertIsNone(process.poll(), "it ended by itself")
            self.assertLess(time.monotonic(), end)
            time.sleep(0.001)
        process.kill()
        self.assertEqual(process.wait(), -9)

    def kill_in_first_run(self, *arguments):
        begun = self.folder / "begun"
        begun.unlink(missing_ok=True)
        self.write("solver.py", ENDLESS.format(repr(str(begun))))
        self.kill_when(begun.exists, *arguments, "--out", "out", "--quiet")

    def names(self):
        return {file.name for file in self.out.iterdir()}

    def test_a_run_that_fails_leaves_no_result_and_the_earlier_ones_beside_it(self):
        results = {"result.json", "report.html", "history.csv", "cloud-initial.csv", "cloud-final.csv"}
        self.run_into_failure()
        self.assertFalse(results & self.names())
        self.assertEqual(numbers(self.previous), self.first)
        self.assertTrue(results < {file.name for file in self.previous.iterdir()})
        self.assertIn("earlier run", (self.previous / "README.txt").read_text(encoding="utf-8"))

    def test_a_failure_of_the_very_first_run_does_the_same(self):
        self.write("solver.py", 'import sys\nsys.exit("no")\n')
        for verb in ("update", "propagate"):
            self.succeed("update", "study.toml", "--out", "out", "--quiet")
            ended = self.call(verb, "failing.toml", "--out", "out", "--quiet")
            self.assertEqual(ended.code, 3, ended.err)
            self.assertFalse({"result.json", "report.html"} & self.names(), verb)
            self.assertEqual(numbers(self.previous), self.first, verb)

    def test_a_kill_in_the_very_first_run_does_the_same(self):
        for verb in ("update", "propagate"):
            with self.subTest(verb=verb):
                self.succeed("update", "study.toml", "--out", "out", "--quiet")
                self.kill_in_first_run(verb, "failing.toml")
                self.assertFalse({"result.json", "report.html", "history.csv", "cloud-final.csv"} & self.names())
                self.assertEqual(numbers(self.previous), self.first)
                self.assertEqual(self.call("report", "out").code, 2)

    def test_a_simulation_that_is_killed_in_its_first_run_leaves_no_specimens(self):
        self.write("study.toml", STUDY + TRUTH)
        self.succeed("simulate", "study.toml", "--out", "out", "--quiet")
        files = {name: (self.out / name).read_bytes() for name in ("specimens.csv", "specimens-truth.csv")}
        self.write("failing.toml", FAILING + TRUTH)
        self.kill_in_first_run("simulate", "failing.toml")
        self.assertFalse(set(files) & self.names())
        self.assertEqual({name: (self.previous / name).read_bytes() for name in files}, files)
        self.assertEqual(numbers(self.out), self.first, "an update's results are of another kind")
        self.succeed("simulate", "study.toml", "--out", "out", "--quiet")
        self.assertTrue(set(files) < self.names())
        self.assertFalse(self.previous.exists())

    def test_a_diagnosis_that_is_killed_in_its_first_run_leaves_none(self):
        example = support.SOURCE / "examples" / "03-plate-calculix"
        for name in ("plate.inp", "specimens.csv"):
            self.write(name, (example / name).read_bytes())
        self.write("plate.toml", (example / "study.toml").read_text(encoding="utf-8") + """
[diagnose]
candidates = [{ name = "rho", target = "*DENSITY:ALUMINIUM", distribution = { kind = "normal", mean = 2700.0, std = 30.0 } }]
""")
        self.write("solver.py", "").chmod(0o755)
        self.succeed("diagnose", "study.toml", "--out", "out", "--quiet", "--set", 'test.repeatability={"f*" = "1 %"}')
        earlier = (self.out / "diagnosis.json").read_bytes()
        self.kill_in_first_run("diagnose", "plate.toml", "--set", f'model.program="{self.folder / "solver.py"}"')
        self.assertNotIn("diagnosis.json", self.names())
        self.assertEqual((self.previous / "diagnosis.json").read_bytes(), earlier)
        self.assertEqual(numbers(self.out), self.first, "an update's results are of another kind")

    def test_modes_that_are_killed_while_they_are_sought_leave_none(self):
        self.write("deck.bdf", nastran_test.deck())
        self.succeed("modes", "deck.bdf", "--uff", "--out", "modes", "--quiet")
        folder, previous = self.folder / "modes", self.folder / "modes" / "previous-results"
        files = {file.name: file.read_bytes() for file in folder.iterdir() if file.name != ".mottle-files"}
        self.write("deck.bdf", nastran_test.deck(20000))
        self.kill_when((previous / "modes.html").exists, "modes", "deck.bdf", "--out", "modes", "--quiet")
        self.assertFalse(set(files) & {file.name for file in folder.iterdir()})
        self.assertEqual({name: (previous / name).read_bytes() for name in files}, files)
        self.write("deck.bdf", "no deck\n")
        self.assertEqual(self.call("modes", "deck.bdf", "--out", "modes").code, 2)
        self.assertTrue(previous.exists())
        self.write("deck.bdf", nastran_test.deck())
        self.succeed("modes", "deck.bdf", "--uff", "--out", "modes", "--quiet")
        self.assertEqual({*files, ".mottle-files"}, {file.name for file in folder.iterdir()})

    def test_a_study_that_is_refused_after_its_first_run_puts_the_earlier_results_back(self):
        self.write("solver.py", SOLVER)
        self.write("tests.csv", support.TESTS.replace("f1,f2,f3", "f1,f2,f9"))
        before = self.names()
        ended = self.call("update", "failing.toml", "--out", "out", "--quiet")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertEqual(numbers(self.out), self.first)
        self.assertEqual(self.names() - {"runs.store"}, before)

    def test_a_result_that_the_study_reads_stays(self):
        self.succeed("propagate", "study.toml", "--out", "out", "--quiet")
        cloud = (self.out / "cloud.csv").read_bytes()
        changes = ("--set", 'test.file="out/cloud.csv"')
        self.write("solver.py", 'import sys\nsys.exit("no")\n')
        ended = self.call("update", "failing.toml", "--out", "out", "--quiet", *changes)
        self.assertEqual(ended.code, 3, ended.err)
        self.assertEqual((self.out / "cloud.csv").read_bytes(), cloud)
        self.assertNotIn("result.json", self.names())
        self.succeed("update", "study.toml", "--out", "out", "--quiet", *changes)
        self.assertEqual((self.out / "cloud.csv").read_bytes(), cloud)

    def test_what_a_killed_run_had_moved_already_stays_with_the_rest(self):
        self.run_into_failure()
        mark = (self.previous / "README.txt").read_bytes()
        self.succeed("update", "study.toml", "--out", "out", "--quiet")
        self.previous.mkdir()
        (self.previous / "README.txt").write_bytes(mark)
        report = (self.out / "report.html").read_bytes()
        (self.out / "report.html").rename(self.previous / "report.html")
        self.run_into_failure()
        self.assertEqual((self.previous / "report.html").read_bytes(), report)
        self.assertEqual(numbers(self.previous), self.first)

    def test_a_report_of_a_run_that_failed_is_refused(self):
        self.run_into_failure()
        ended = self.call("report", "out")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("previous-results", ended.err)

    def test_a_second_failure_keeps_the_earlier_results(self):
        self.run_into_failure()
        self.run_into_failure()
        self.run_into_failure("--resume")
        self.assertEqual(numbers(self.previous), self.first)

    def test_when_a_run_ends_the_earlier_results_go(self):
        before = self.names()
        self.run_into_failure()
        self.write("study.toml", edited(STUDY, (OLD_TITLE, NEW_TITLE)))
        self.succeed("update", "study.toml", "--out", "out", "--quiet")
        self.assertEqual(json.loads((self.out / "result.json").read_text(encoding="utf-8"))["title"], "Another study")
        self.assertEqual(self.names() - {"runs.store", "failed-runs"}, before)

    def test_a_study_that_is_refused_leaves_the_earlier_results(self):
        for change in (("f1,f2,f3", "f1,f2,f9"), ("iterations = 30", "iterations = 0")):
            with self.subTest(change=change):
                files = {"study.toml": STUDY, "tests.csv": support.TESTS}
                for name, text in files.items():
                    self.write("refused-" + name, text.replace("tests.csv", "refused-tests.csv").replace(*change))
                ended = self.call("update", "refused-study.toml", "--out", "out", "--quiet")
                self.assertEqual(ended.code, 2, ended.err)
                self.assertEqual(numbers(self.out), self.first)
                self.assertFalse(self.previous.exists())

    def test_a_study_that_is_refused_by_its_method_leaves_the_earlier_results(self):
        # As many outputs as parameters: the noise cannot be estimated, which only the method finds.
        study = edited(STUDY, ('method = "mares"', 'method = "maximum-likelihood"'), ("[1, 2, 3]", "[1, 2]"))
        self.write("study.toml", study + '\n[update.maximum-likelihood]\nnoise = "estimated"\n')
        ended = self.call("update", "study.toml", "--out", "out", "--quiet")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertEqual(numbers(self.out), self.first)
        self.assertFalse(self.previous.exists())

    def test_a_diagnosis_that_is_refused_leaves_an_interrupted_update_alone(self):
        files = {"resume.journal": "of an update", "mottle.log": "of an update"}
        for name, text in files.items():
            (self.out / name).write_text(text, encoding="utf-8")
        # Three outputs beside two parameters and a candidate, and no noise known: only the method finds that it cannot be.
        self.write("tests.csv", "\n".join(support.TESTS.splitlines()[:1] + 6 * support.TESTS.splitlines()[1:]) + "\n")
        ended = self.call("diagnose", "study.toml", "--out", "out", "--quiet")
        self.assertEqual(ended.code, 2, ended.err)
        for name, text in files.items():
            self.assertEqual((self.out / name).read_text(encoding="utf-8"), text)
        self.assertFalse({"diagnosis.log", "diagnosis.journal"} & self.names())

    def test_a_folder_of_the_users_with_that_name_is_left_alone(self):
        self.previous.mkdir()
        (self.previous / "result.json").write_text("mine", encoding="utf-8")
        ended = self.call("update", "failing.toml", "--out", "out", "--quiet")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("previous-results", ended.err)
        self.assertEqual((self.previous / "result.json").read_text(encoding="utf-8"), "mine")
        self.assertEqual(numbers(self.out), self.first)

    def test_a_folder_of_that_name_with_a_readme_of_the_users_is_left_alone(self):
        self.previous.mkdir()
        for name in ("README.txt", "result.json", "clouds.csv"):
            (self.previous / name).write_text("results of March; keep\n", encoding="utf-8")
        for verb in ("update", "propagate"):
            ended = self.call(verb, "study.toml", "--out", "out", "--quiet")
            self.assertEqual(ended.code, 2, ended.err)
            self.assertIn("something else has that name", ended.err)
            self.assertEqual(len(list(self.previous.iterdir())), 3)

    def test_a_folder_that_a_killed_run_left_without_its_mark_is_used(self):
        for leftover in ([], ["README.txt.4711-1.partial"]):
            with self.subTest(leftover=leftover):
                self.previous.mkdir()
                for name in leftover:
                    (self.previous / name).touch()
                self.run_into_failure()
                self.assertEqual(numbers(self.previous), self.first)
                self.succeed("update", "study.toml", "--out", "out", "--quiet")
                self.assertFalse(self.previous.exists())

    def test_a_link_with_that_name_is_left_alone(self):
        (self.folder / "elsewhere").mkdir()
        self.previous.symlink_to("../elsewhere")
        self.assertEqual(self.call("update", "failing.toml", "--out", "out", "--quiet").code, 2)
        self.assertEqual(list((self.folder / "elsewhere").iterdir()), [])
        self.assertEqual(numbers(self.out), self.first)

    def test_files_that_are_not_results_stay(self):
        (self.out / "notes.txt").write_text("mine", encoding="utf-8")
        self.run_into_failure()
        self.assertEqual((self.out / "notes.txt").read_text(encoding="utf-8"), "mine")
        self.assertTrue({"study.toml", "tests.csv"} <= self.names())

    def test_a_study_or_tests_of_the_users_in_the_folder_stay(self):
        self.write("study-of-truth.toml", STUDY + TRUTH)
        for verb, study, name in (("update", "study.toml", "study.toml"), ("update", "study.toml", "tests.csv"),
                                  ("check", "study.toml", "study.toml"), ("propagate", "study.toml", "study.toml"),
                                  ("simulate", "study-of-truth.toml", "study.toml")):
            with self.subTest(verb=verb, name=name):
                mine = self.write(f"{verb}-{name}/{name}", "mine")
                ended = self.call(verb, study, "--out", mine.parent)
                self.assertEqual(ended.code, 2, ended.err)
                self.assertIn(f"{name}: is not as an earlier run wrote it", ended.err)
                self.assertEqual(mine.read_text(encoding="utf-8"), "mine")
                self.assertEqual(list(mine.parent.iterdir()), [mine])

    def test_names_alone_do_not_make_a_file_the_programs_own(self):
        """What stands beside is no proof unless it holds what a job leaves."""
        self.write("study-of-truth.toml", STUDY + TRUTH)
        for verb, study, names in (("update", "study.toml", ("specimens.csv", "history.csv")),
                                   ("update", "study.toml", ("result.json", "cloud-final.csv")),
                                   ("update", "study.toml", ("mottle.log",)), ("update", "study.toml", ("resume.journal",)),
                                   ("update", "study.toml", ("modes.json",)), ("propagate", "study.toml", ("result.json",)),
                                   ("propagate", "study.toml", ("specimens.csv", "cloud.csv")),
                                   ("simulate", "study-of-truth.toml", ("specimens.csv",)),
                                   ("simulate", "study-of-truth.toml", ("specimens.csv", "specimens-truth.csv")),
                                   ("diagnose", "study.toml", ("diagnosis.json",)),
                                   ("diagnose", "study.toml", ("diagnosis.log",))):
            with self.subTest(verb=verb, names=names):
                folder = self.folder / "-".join((verb, *names))
                for name in names:
                    self.write(folder / name, "f1,f2\n1,2\n")
                ended = self.call(verb, study, "--out", folder)
                self.assertEqual(ended.code, 2, ended.err)
                self.assertIn("is not as an earlier run wrote it", ended.err)
                self.assertEqual({file.name: file.read_text(encoding="utf-8") for file in folder.iterdir()},
                                 dict.fromkeys(names, "f1,f2\n1,2\n"))

    def test_what_lies_beside_a_file_of_the_programs_own_is_not_its_own_too(self):
        """Not by the words of a log, of JSON, or since an earlier job left results there."""
        self.write("study-of-truth.toml", STUDY + TRUTH)
        traces = {"mottle.log": "   12.000 s  mottle\n", "diagnosis.json": "", "resume.journal": "mottle journal",
                  "modes.json": '{"modes": [1.0]}', "result.json": '{"schema": 1, "mottle": "0.1.0"}'}
        for trace, text in traces.items():
            for verb, study, name in (("update", "study.toml", "clouds.csv"), ("update", "study.toml", "posterior.csv"),
                                      ("simulate", "study-of-truth.toml", "study.toml"), ("modes", "deck.bdf", "modes.csv")):
                with self.subTest(trace=trace, verb=verb, name=name):
                    folder = self.folder / f"{trace}-{verb}-{name}"
                    self.write(folder / trace, text)
                    self.write(folder / name, "mine\n")
                    self.write("deck.bdf", nastran_test.deck())
                    ended = self.call(verb, study, "--out", folder)
                    self.assertEqual(ended.code, 2, ended.err)
                    self.assertIn("is not as an earlier run wrote it", ended.err)
                    self.assertEqual((folder / name).read_text(encoding="utf-8"), "mine\n")
        for name in ("specimens.csv", "posterior.csv", "modes.uff"):
            for verb, study in (("simulate", "study-of-truth.toml"), ("update", "study.toml"), ("modes", "deck.bdf")):
                with self.subTest(verb=verb, name=name):
                    mine = self.write(self.out / name, "mine\n")
                    self.call(verb, study, "--out", "out", "--quiet")
                    self.assertEqual(mine.read_text(encoding="utf-8"), "mine\n")
                    mine.unlink()

    def test_a_result_that_was_edited_is_its_owners(self):
        tests = self.out / "tests.csv"
        edited_text = tests.read_text(encoding="utf-8") + "0.1,0.2,0.3\n"
        tests.write_text(edited_text, encoding="utf-8")
        ended = self.call("update", "study.toml", "--out", "out", "--quiet")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("tests.csv: is not as an earlier run wrote it", ended.err)
        self.assertEqual(tests.read_text(encoding="utf-8"), edited_text)

    def test_what_a_kill_left_empty_is_used(self):
        folder = self.write("killed/mottle.log", "").parent
        self.write("killed/resume.journal", "mottle jour")
        self.succeed("update", "study.toml", "--out", folder, "--quiet")

    def test_a_study_that_is_simulated_is_updated_in_the_same_folder(self):
        self.write("study-of-truth.toml", STUDY + TRUTH)
        for verb in ("simulate", "update", "simulate", "propagate"):
            self.succeed(verb, "study-of-truth.toml", "--out", "all", "--quiet")

    def test_points_that_lie_in_the_folder_are_not_moved_from_under_the_run(self):
        arguments = ("propagate", "study.toml", "--points", "out/cloud-final.csv", "--out", "out", "--quiet")
        (self.out / "cloud-final.csv").write_text("k1,k2\n1.0,1.0\n1.1,1.2\n", encoding="utf-8")
        self.succeed(*arguments)
        self.succeed(*arguments)
        self.assertFalse(self.previous.exists())

    def test_points_that_lie_beside_a_diagnosis_stay(self):
        points = "k1,k2\n1.0,1.0\n1.1,1.2\n"
        (self.out / "cloud-final.csv").write_text(points, encoding="utf-8")
        (self.out / "diagnosis.json").write_text("{}", encoding="utf-8")
        self.succeed("propagate", "study.toml", "--points", "out/cloud-final.csv", "--out", "out", "--quiet")
        self.assertEqual((self.out / "cloud-final.csv").read_text(encoding="utf-8"), points)
        self.assertFalse((self.previous / "cloud-final.csv").exists())


if __name__ == "__main__":
    support.main()
