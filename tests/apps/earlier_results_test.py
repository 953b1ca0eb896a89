"""Results of an earlier run never stand as those of a run that did not come to its end.

    python3 earlier_results_test.py PATH_TO_MOTTLE
"""

import json
import unittest

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


class EarlierResultsTest(support.CommandTest):
    """One claim a test."""

    def setUp(self):
        super().setUp()
        self.write("failing.toml", support.command_study(["python3", "solver.py"]))
        self.write("input.txt", "{{k1}} {{k2}}\n")
        self.write("solver.py", SOLVER)
        self.out = self.folder / "out"
        self.previous = self.out / "previous-results"
        self.succeed("update", "study.toml", "--out", "out", "--quiet")
        self.first = numbers(self.out)

    def run_into_failure(self, *arguments):
        ended = self.call("update", "failing.toml", "--out", "out", "--quiet", *arguments)
        self.assertEqual(ended.code, 3, ended.err)

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
