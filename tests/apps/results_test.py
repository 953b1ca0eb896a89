"""What a run of each verb leaves behind and prints, and what its options do, seen from outside. What results hold is in
tests/study.

    python3 results_test.py PATH_TO_MOTTLE
"""

import json
import math
import shutil

import support
from support import STUDY, TESTS, THREE_MASSES, edited, numbers, read_csv, read_result

UPDATE_FILES = {"result.json", "report.html", "history.csv", "cloud-initial.csv", "cloud-final.csv", "study.toml",
                "mottle.log"}
ADEQUATE = {"adequate": True, "inadequate": False, "undecided": None}


class ResultsTest(support.CommandTest):
    """One claim a test."""

    def update(self, *changes, arguments=()):
        """Runs the good study with changes; hands back result.json."""
        self.write("study.toml", edited(STUDY, *changes))
        self.succeed("update", "study.toml", "--out", "out", "--quiet", *arguments)
        return read_result(self.folder / "out")

    # --- the files ---

    def test_files_of_an_update(self):
        result = self.update()
        self.assertEqual(result["mottle"], self.succeed("--version").out.split()[-1])
        names = {file.name for file in (self.folder / "out").iterdir()}
        self.assertTrue(UPDATE_FILES <= names, names)
        self.assertNotIn("resume.journal", names)
        self.assertFalse([name for name in names if name.endswith(".partial")])

    def test_results_lie_beside_the_study_by_default(self):
        self.write("below/study.toml", STUDY)
        self.write("below/tests.csv", TESTS)
        self.succeed("update", "below/study.toml", "--quiet")
        self.assertTrue((self.folder / "below" / "study.mottle" / "result.json").is_file())

    def test_report_is_one_file_without_network(self):
        self.update()
        page = (self.folder / "out" / "report.html").read_text(encoding="utf-8")
        self.assertNotIn("<script src", page)
        self.assertNotIn("<link rel=\"stylesheet\"", page)
        self.assertIn("A study for tests", page)

    def test_reports_show_posteriors_and_boxes(self):
        for method, shown in (("bayes", '"posterior"'), ("interval", '"interval"')):
            self.update(arguments=["--set", f'update.method="{method}"', "--set", 'test.repeatability.f1="1 %"', "--set",
                                   'test.repeatability.f2="1 %"', "--set", 'test.repeatability.f3="1 %"'])
            self.assertIn(shown, (self.folder / "out" / "report.html").read_text(encoding="utf-8"))

    def test_report_is_drawn_again(self):
        self.update()
        page = self.folder / "out" / "report.html"
        before = page.read_bytes()
        page.unlink()
        self.succeed("report", "out", "--quiet")
        self.assertEqual(page.read_bytes(), before)

    def test_study_as_run_gives_the_same_numbers(self):
        result = self.update(("bounds = [0.5, 3.0]", "bounds = [0.1, 3.0]"),
                             arguments=["--set", "update.samples=300", "--seed", "11"])
        self.assertEqual((result["seed"], result["sample_size"]["n_model"]), (11, 300))
        self.succeed("update", "out/study.toml", "--out", "again", "--quiet")
        self.assertEqual(numbers(self.folder / "again"), numbers(self.folder / "out"))
        self.assertEqual((self.folder / "again" / "cloud-final.csv").read_bytes(),
                         (self.folder / "out" / "cloud-final.csv").read_bytes())

    # --- options ---

    def test_inadequate_verdict_is_an_answer(self):
        for name in ("case2.toml", "specimens-case2.csv"):
            shutil.copy(THREE_MASSES / name, self.folder)
        self.succeed("update", "case2.toml", "--quiet")
        result = read_result(self.folder / "case2.mottle")
        self.assertIs(result["verdict"]["adequate"], False)
        self.assertEqual(result["parameters"]["at_bound"][1], "lower")

    def test_json_is_one_line_on_stdout(self):
        for arguments in (["update", "study.toml"], ["propagate", "study.toml"], ["check", "study.toml"],
                          ["methods"]):
            ended = self.succeed(*arguments, "--json")
            self.assertEqual(ended.out.count("\n"), 1, arguments)
            json.loads(ended.out)
        summary = json.loads(self.succeed("update", "study.toml", "--json").out)
        self.assertEqual(summary["status"], "converged")
        self.assertIs(summary["adequate"], ADEQUATE[summary["conclusion"]])
        self.assertEqual(summary["folder"], "study.mottle")

    def test_quiet_says_nothing(self):
        for verb in ("update", "propagate", "check"):
            ended = self.succeed(verb, "study.toml", "--quiet")
            self.assertEqual((ended.out, ended.err), ("", ""), verb)
        ended = self.succeed("report", "study.mottle", "--quiet")
        self.assertEqual((ended.out, ended.err), ("", ""))

    def test_plain_output_names_verdict_and_report(self):
        ended = self.succeed("update", "study.toml")
        self.assertIn("verdict: ", ended.out)
        self.assertRegex(ended.out, r"\nnext: mottle \w+ study\.toml")
        self.assertIn("study.mottle/report.html", ended.out)
        self.assertNotIn("\r", ended.err)

    def test_warnings_of_the_tests_stand_on_stderr_and_in_the_report(self):
        self.write("tests.csv", TESTS + TESTS.splitlines()[2] + "\n")
        self.assertIn("warning: ", self.succeed("check", "study.toml").out)
        ended = self.succeed("update", "study.toml")
        self.assertRegex(ended.err, r"(?m)^mottle: warning: .*as copies do: specimen 7 equals 2")
        self.assertIn("specimen 7 equals 2", (self.folder / "study.mottle" / "report.html").read_text(encoding="utf-8"))

    def test_check_writes_nothing(self):
        before = sorted(self.folder.rglob("*"))
        ended = self.succeed("check", "study.toml")
        self.assertEqual(sorted(self.folder.rglob("*")), before)
        self.assertIn("total mass 3", ended.out)

    def test_methods_lists_every_option(self):
        methods = json.loads(self.succeed("methods", "--json").out)
        self.assertLessEqual({"maximum-likelihood", "mares", "deterministic", "inversion", "perturbation",
                              "covariance-adjustment", "moment-matching", "bayes", "hierarchical", "mixture", "interval", "abc"}, {method["name"] for method in methods})
        text = self.succeed("methods").out
        markdown = self.succeed("methods", "--markdown").out
        for method in methods:
            self.assertIn(method["name"], text)
            for option in method["options"]:
                self.assertEqual(set(option), {"name", "unit", "allowed", "default", "meaning"})
                self.assertTrue(all(option.values()), option)
                self.assertIn(option["name"], text)
                self.assertIn(f"`{option['name']}`", markdown)

    def test_help_of_every_verb(self):
        for verb in ("update", "check", "propagate", "simulate", "report", "methods"):
            self.assertIn("Usage: mottle " + verb, self.succeed(verb, "--help").out)

    # --- propagate and simulate ---

    def test_propagate_leaves_a_cloud(self):
        self.succeed("propagate", "study.toml", "--out", "out", "--quiet")
        header, rows = read_csv(self.folder / "out" / "cloud.csv")
        self.assertEqual(header, ["k1", "k2", "f1", "f2", "f3", "status"])
        self.assertEqual(len(rows), 200)
        self.assertTrue((self.folder / "out" / "report.html").is_file())
        result = read_result(self.folder / "out")
        self.assertEqual(result["model_evaluations"], 200)

    def test_propagate_evaluates_given_points(self):
        self.write("points.csv", "k2,k1\n1,1\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out", "--quiet")
        _, rows = read_csv(self.folder / "out" / "cloud.csv")
        # K = [[5,-1,-3],[-1,3,-1],[-3,-1,5]], M = I: lambda = 1, 4, 8, f = sqrt(lambda) / 2 pi
        for value, eigenvalue in zip(rows[0][2:5], (1.0, 4.0, 8.0)):
            self.assertAlmostEqual(float(value), math.sqrt(eigenvalue) / (2.0 * math.pi), delta=1e-14)

    def test_simulate_makes_the_specimens_of_an_example(self):
        shutil.copy(THREE_MASSES / "truth-case1.toml", self.folder)
        self.succeed("simulate", "truth-case1.toml", "--out", "out", "--quiet")
        self.assertEqual((self.folder / "out" / "specimens.csv").read_bytes(), (THREE_MASSES / "specimens-case1.csv").read_bytes())

    # --- ends ---

    def test_too_many_lost_modes_stop_the_run(self):
        self.write("study.toml", edited(STUDY, ("[1, 2, 3]", '[1, 2, 3]\ntracking = "mac"\nminimum_mac = 1.0')))
        ended = self.call("update", "study.toml", "--out", "out")
        self.assertEqual(ended.code, 3)
        self.assertIn("of 200 model runs failed", ended.err)
        self.assertFalse((self.folder / "out" / "result.json").exists())

    def test_paths_may_hold_spaces_and_other_letters(self):
        self.write("ein Versuch/Prüfstand 1.toml", edited(STUDY, ("tests.csv", "Proben (10).csv")))
        self.write("ein Versuch/Proben (10).csv", TESTS)
        self.succeed("update", "ein Versuch/Prüfstand 1.toml", "--quiet")
        self.assertTrue((self.folder / "ein Versuch" / "Prüfstand 1.mottle" / "report.html").is_file())


if __name__ == "__main__":
    support.main()
