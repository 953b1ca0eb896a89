"""What a run leaves behind and what its options do: the contract of docs/, seen from outside.

    python3 results_test.py PATH_TO_MOTTLE
"""

import json
import math
import shutil
import unittest

import support
from support import STUDY, TESTS, THREE_MASSES, edited, numbers, read_csv, read_result

UPDATE_FILES = {"result.json", "report.html", "history.csv", "cloud-initial.csv", "cloud-final.csv", "study.toml",
                "mottle.log"}
ADEQUATE = {"adequate": True, "inadequate": False, "undecided": None}
STATUSES = {"converged", "max-iterations", "stalled", "stopped", "failed"}
K1 = '{ kind = "normal", mean = 2.0, std = 0.3 }\nbounds = [0.5, 3.0]'


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


class ResultsTest(support.CommandTest):
    """One claim a test."""

    def update(self, *changes, arguments=(), tests=None):
        """Runs the good study with changes; hands back result.json."""
        self.write("study.toml", edited(STUDY, *changes))
        if tests is not None:
            self.write("tests.csv", tests)
        self.succeed("update", "study.toml", "--out", "out", "--quiet", *arguments)
        return read_result(self.folder / "out")

    def assert_vector(self, value, size):
        self.assertEqual(len(value), size)
        self.assertTrue(all(is_number(entry) for entry in value), value)

    def assert_matrix(self, value, rows, columns):
        self.assertEqual(len(value), rows)
        for row in value:
            self.assert_vector(row, columns)

    # --- result.json ---

    def test_head_of_the_result(self):
        result = self.update()
        self.assertEqual(result["schema"], 1)
        version = self.succeed("--version").out.split()[-1]
        self.assertEqual(result["mottle"], version)
        self.assertEqual(result["title"], "A study for tests")
        self.assertEqual(result["method"], "mares")
        self.assertEqual(result["seed"], 7)
        self.assertIn(result["status"], STATUSES)
        self.assertIsInstance(result["message"], str)

    def test_a_factor_is_shown_with_the_number_that_it_gives(self):
        factor = ('target = "spring:k1"\ndistribution = { kind = "normal", mean = 2.0, std = 0.3 }\nbounds = [0.5, 3.0]',
                  'target = ["spring:k4", "spring:k5"]\nrelative = true\ndistribution = { kind = "normal", mean = 1.0, std = 0.3 }')
        several = ('target = "spring:k2"\n', 'target = ["spring:k2", "spring:k6"]\nrelative = true\n')
        self.write("study.toml", edited(STUDY, factor, several, ('"mares"\nsamples', '"perturbation"\nsamples')))
        out = self.succeed("update", "study.toml", "--out", "out").out
        parameters = read_result(self.folder / "out")["parameters"]
        self.assertEqual(parameters["factor_of"], [1.0, None])  # k2 and k6 are different numbers
        self.assertEqual(parameters["factor_units"], ["N/m", None])
        self.assertIn(f" {parameters['mean'][0]:.5g} N/m\n", out)
        self.assertRegex(out, r"\nnext: mottle \w+ study\.toml")

    def test_parameters_of_the_result(self):
        parameters = self.update()["parameters"]
        self.assertEqual(parameters["names"], ["k1", "k2"])
        for key in ("prior_mean", "prior_std", "mean", "std"):
            self.assert_vector(parameters[key], 2)
        self.assert_matrix(parameters["covariance"], 2, 2)
        for key in ("mean_ci95", "std_ci95"):
            self.assertIn(key, parameters)
            if parameters[key] is not None:
                self.assert_matrix(parameters[key], 2, 2)
        self.assertEqual(len(parameters["at_bound"]), 2)
        self.assertTrue(set(parameters["at_bound"]) <= {None, "lower", "upper"})
        self.assertEqual(parameters["prior_mean"], [2.0, 2.0])
        self.assertEqual([prior["kind"] for prior in parameters["prior"]], ["normal", "normal"])
        self.assertEqual([prior["mean"] for prior in parameters["prior"]], [2.0, 2.0])
        self.assertEqual(parameters["scale"], ["identity", "identity"])
        for i in range(2):  # std is printed, covariance is computed: the same to rounding
            self.assertAlmostEqual(parameters["std"][i] ** 2, parameters["covariance"][i][i], delta=1e-15)

    def test_outputs_of_the_result(self):
        outputs = self.update()["outputs"]
        self.assertEqual(outputs["names"], ["f1", "f2", "f3"])
        self.assertEqual(outputs["units"], ["Hz", "Hz", "Hz"])
        self.assertEqual(outputs["test_count"], [6, 6, 6])
        for key in ("test_mean", "initial_mean", "final_mean"):
            self.assert_vector(outputs[key], 3)
        for key in ("test_covariance", "initial_covariance", "final_covariance"):
            self.assert_matrix(outputs[key], 3, 3)

    def test_iterations_of_the_result(self):
        iterations = self.update()["iterations"]
        self.assertEqual([state["index"] for state in iterations], list(range(len(iterations))))
        for state in iterations:
            self.assertTrue(is_number(state["distance_euclidean"]))
            self.assertTrue(is_number(state["distance_mahalanobis"]))
            self.assert_vector(state["parameter_mean"], 2)
            self.assert_vector(state["parameter_std"], 2)
            self.assert_vector(state["output_mean"], 3)
            self.assert_vector(state["output_std"], 3)

    def test_analysis_in_the_result(self):
        result = self.update()
        self.assert_matrix(result["regression"]["sensitivity"], 3, 2)
        self.assert_vector(result["regression"]["r_squared"], 3)
        self.assertTrue(is_number(result["regression"]["condition"]))
        self.assert_matrix(result["spearman"], 2, 3)
        self.assertTrue(all(-1.0 <= value <= 1.0 for row in result["spearman"] for value in row))
        size = result["sample_size"]
        self.assertEqual((size["alpha"], size["n_test"], size["n_model"]), (0.05, 6, 200))
        self.assertTrue(is_number(size["t_critical"]))
        self.assert_vector(size["monte_carlo_error"], 3)

    def test_verdict_in_the_result(self):
        verdict = self.update()["verdict"]
        self.assertIs(verdict["adequate"], ADEQUATE[verdict["conclusion"]])
        self.assertEqual(verdict["level"], 0.05)
        self.assertTrue(verdict["tests"])
        for test in verdict["tests"]:
            self.assertTrue({"name", "statistic", "critical", "p_value", "passed", "meaning"} <= set(test))
        self.assertTrue(verdict["reasons"])
        self.assertTrue(all(reason.endswith(".") for reason in verdict["reasons"]), "reasons are sentences")
        self.assertEqual(verdict["conclusion"], "undecided", "mares does not estimate the scatter")
        self.assertTrue(verdict["not_tested"])
        self.assertTrue(all(sentence.endswith(".") for sentence in verdict["not_tested"]), "sentences")

    def test_what_could_hide_in_the_result(self):
        """Every spring and mass that no parameter moves, the most harmful first."""
        hidden = self.update()["verdict"]["could_hide"]
        self.assertEqual({error["name"] for error in hidden}, {"k3", "k4", "k5", "k6", "m1", "m2", "m3"})
        harms = []
        for error in hidden:
            self.assertEqual(error["nominal"], 3.0 if error["name"] == "k6" else 1.0)
            self.assertTrue(0.0 < error["relative_change"] <= 1.0)
            self.assertIsInstance(error["is_detected"], bool)
            self.assertEqual([move["parameter"] for move in error["would_move"]], ["k1", "k2"])
            harms.append(max(abs(move["half_widths"]) for move in error["would_move"]))
        self.assertEqual(harms, sorted(harms, reverse=True))

    def test_an_error_that_no_test_sees_moves_the_means_as_said(self):
        """As many frequencies as parameters: k6 off by 10 % in the tests moves the estimate by what was said of it."""
        k5 = ('[[parameter]]\nname = "k5"\ntarget = "spring:k5"\n'
              'distribution = { kind = "normal", mean = 2.0, std = 0.3 }\n\n[outputs]')
        method = ('method = "mares"', 'method = "maximum-likelihood"')
        right = self.update(("[outputs]", k5), method)
        error = next(entry for entry in right["verdict"]["could_hide"] if entry["name"] == "k6")
        self.assertEqual((error["is_detected"], error["relative_change"]), (False, 0.1))
        # The model off by 10 % downwards, against the same tests, errs as tests off by 10 % upwards do.
        small = 0.01
        wrong = self.update(("[outputs]", k5), method, ("stiffness = 3.0", f"stiffness = {3.0 * (1.0 - small)!r}"))
        for i, move in enumerate(error["would_move"]):
            lower, upper = right["parameters"]["mean_ci95"][i]
            said = move["half_widths"] * 0.5 * (upper - lower) * small / 0.1
            found = wrong["parameters"]["mean"][i] - right["parameters"]["mean"][i]
            # First order at the mean; the specimens scatter by a fifth about it, so that their mean differs by some per cent.
            self.assertAlmostEqual(found, said, delta=0.1 * abs(said))

    def test_a_number_that_is_zero_in_the_model_could_hide_too(self):
        """A spring of stiffness 0: its error is absolute, at a tenth of the other springs' median where no test sees it."""
        k7 = 'stiffness = 3.0 },\n  { name = "k7", between = ["m1", "m3"], stiffness = 0.0 },'
        result = self.update(("stiffness = 3.0 },", k7))
        error = next(entry for entry in result["verdict"]["could_hide"] if entry["name"] == "k7")
        self.assertEqual((error["nominal"], error["relative_change"]), (0.0, None))
        self.assertTrue(0.0 < error["change"] <= 1.0)

    def test_where_the_means_are_not_tested_no_error_is_refused(self):
        """A model error that is estimated from the means leaves no test of them: no size may be said to be refused."""
        verdict = self.update(('method = "mares"', 'method = "maximum-likelihood"'),
                              ("[test]", '[test]\nrepeatability = { "f*" = 0.001 }\nmodel_error = "estimated"'))["verdict"]
        self.assertNotIn("mean-residuals", [test["name"] for test in verdict["tests"]])
        self.assertFalse(any(error["is_detected"] for error in verdict["could_hide"]))
        self.assertNotIn("80 % of cases", " ".join(verdict["not_tested"]))

    def test_an_estimated_noise_is_said_to_refuse_fewer(self):
        """The level of the noise comes from the same tests, where an error of the model counts as noise too."""
        result = self.update(('method = "mares"', 'method = "maximum-likelihood"'))
        seen = [error for error in result["verdict"]["could_hide"] if error["is_detected"]]
        self.assertTrue(all(error["assumes_estimated_noise"] for error in seen), seen)
        given = self.update(('method = "mares"', 'method = "maximum-likelihood"'),
                            ("[test]", '[test]\nrepeatability = { "f*" = 0.001 }'))
        self.assertFalse(any(error["assumes_estimated_noise"] for error in given["verdict"]["could_hide"]))

    def test_identifiability_and_counts_in_the_result(self):
        result = self.update()
        seen = result["identifiability"]
        self.assertEqual(seen["rank"], 2)
        self.assert_vector(seen["singular_values"], 2)
        self.assertEqual(seen["unseen_directions"], [])
        # And the mean, the point nearest to the tests, and two beside it for each parameter, for the test of the means.
        self.assertEqual(result["model_evaluations"], 200 * len(result["iterations"]) + 6)
        self.assertEqual(result["failed_evaluations"], [])
        self.assertTrue(result["timings_s"])
        self.assertTrue(all(is_number(value) and value >= 0.0 for value in result["timings_s"].values()))

    # --- the files ---

    def test_files_of_an_update(self):
        self.update()
        names = {file.name for file in (self.folder / "out").iterdir()}
        self.assertTrue(UPDATE_FILES <= names, names)
        self.assertNotIn("resume.journal", names)
        self.assertFalse([name for name in names if name.endswith(".partial")])

    def test_history_has_a_row_a_state(self):
        result = self.update()
        header, rows = read_csv(self.folder / "out" / "history.csv")
        self.assertEqual(header, ["iteration", "distance_euclidean", "distance_mahalanobis", "k1_mean", "k2_mean",
                                  "k1_std", "k2_std", "f1_mean", "f2_mean", "f3_mean", "f1_std", "f2_std", "f3_std"])
        self.assertEqual(len(rows), len(result["iterations"]))
        self.assertEqual([float(rows[-1][3]), float(rows[-1][4])], result["parameters"]["mean"])

    def test_clouds_have_a_row_a_sample(self):
        result = self.update()
        for name, key in (("cloud-initial.csv", "initial_mean"), ("cloud-final.csv", "final_mean")):
            header, rows = read_csv(self.folder / "out" / name)
            self.assertEqual(header, ["k1", "k2", "f1", "f2", "f3", "status"])
            self.assertEqual(len(rows), 200)
            self.assertEqual({row[-1] for row in rows}, {"ok"})
            mean = sum(float(row[2]) for row in rows) / 200
            self.assertAlmostEqual(mean, result["outputs"][key][0], delta=1e-12)  # summed in another order

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

    def test_report_is_drawn_again(self):
        self.update()
        page = self.folder / "out" / "report.html"
        before = page.read_bytes()
        page.unlink()
        self.succeed("report", "out", "--quiet")
        self.assertEqual(page.read_bytes(), before)

    def test_study_as_run_gives_the_same_numbers(self):
        self.update(('bounds = [0.5, 3.0]', 'bounds = [0.1, 3.0]'),
                    arguments=["--set", "update.samples=300", "--seed", "11"])
        self.succeed("update", "out/study.toml", "--out", "again", "--quiet")
        self.assertEqual(numbers(self.folder / "again"), numbers(self.folder / "out"))
        self.assertEqual((self.folder / "again" / "cloud-final.csv").read_bytes(),
                         (self.folder / "out" / "cloud-final.csv").read_bytes())

    def test_study_as_run_keeps_the_order_of_masses(self):
        self.update(("m1 = 1.0, m2 = 1.0, m3 = 1.0", "m3 = 1.1, m1 = 1.3, m2 = 0.7"))
        self.succeed("update", "out/study.toml", "--out", "again", "--quiet")
        self.assertEqual(numbers(self.folder / "again"), numbers(self.folder / "out"))

    def test_study_as_run_holds_overridden_values(self):
        self.update(arguments=["--set", "parameter.k2.distribution.mean=1.7", "--set", "model.springs.k6.stiffness=2.9",
                               "--set", "model.masses.m2=1.1", "--set", 'title="Ü \\"quoted\\" # title"',
                               "--set", "update.deterministic.specimen=2"])
        text = (self.folder / "out" / "study.toml").read_text(encoding="utf-8")
        self.assertIn("mean = 1.7,", text)
        self.assertEqual(read_result(self.folder / "out")["title"], 'Ü "quoted" # title')
        self.succeed("update", "out/study.toml", "--out", "again", "--quiet")
        self.assertEqual(numbers(self.folder / "again"), numbers(self.folder / "out"))

    def test_study_as_run_finds_its_tests_from_a_linked_folder(self):
        (self.folder / "far" / "away").mkdir(parents=True)
        (self.folder / "link").symlink_to(self.folder / "far" / "away")
        self.succeed("update", "study.toml", "--out", "link/out", "--quiet")
        self.succeed("check", "link/out/study.toml")

    def test_study_as_run_is_written_as_a_person_would(self):
        self.update()
        text = (self.folder / "out" / "study.toml").read_text(encoding="utf-8")
        self.assertIn("std = 0.3 ", text)

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
        self.assertIn("std (mean's)", ended.out, "mares does not estimate the scatter")
        population = self.succeed("update", "study.toml", "--set", 'update.method="maximum-likelihood"')
        self.assertNotIn("std (mean's)", population.out)
        self.assertIn("study.mottle/report.html", ended.out)
        self.assertNotIn("\r", ended.err)

    def test_set_takes_effect(self):
        result = self.update(arguments=["--set", "update.samples=150", "--set", "update.mares.weighting=euclidean",
                                        "--set", "parameter.k1.bounds=[0.6, 2.9]", "--set", "title=other"])
        self.assertEqual(result["sample_size"]["n_model"], 150)
        self.assertEqual(result["title"], "other")
        self.assertEqual(result["options"]["weighting"], "euclidean")
        self.assertEqual(result["parameters"]["bounds"][0], [0.6, 2.9])

    def test_seed_changes_the_draw_and_nothing_else(self):
        first = self.update(arguments=["--seed", "1"])
        second = self.update(arguments=["--seed", "2"])
        self.assertEqual((first["seed"], second["seed"]), (1, 2))
        self.assertEqual(first["outputs"]["test_mean"], second["outputs"]["test_mean"])
        self.assertNotEqual(first["outputs"]["initial_mean"], second["outputs"]["initial_mean"])

    def test_largest_seed_is_kept(self):
        self.assertEqual(self.update(arguments=["--seed", str(2 ** 63 - 1)])["seed"], 2 ** 63 - 1)

    # --- tests far from the model are no unit error ---

    def test_a_stiffness_that_is_truly_double_is_updated(self):
        header, *rows = TESTS.splitlines()
        doubled = [",".join(f"{float(value) * math.sqrt(2.0)!r}" for value in row.split(",")) for row in rows]
        self.update(tests="\n".join([header, *doubled]))

    def test_a_factor_near_2_pi_that_the_prior_gives_is_updated(self):
        springs = ["spring:k1", "spring:k2", "spring:k3", "spring:k4", "spring:k5", "spring:k6"]
        start, rest = STUDY.split("[[parameter]]", 1)
        tied = (f'[[parameter]]\nname = "k"\ntarget = {springs}\nrelative = true\n'
                'distribution = { kind = "uniform", lower = 0.02, upper = 1.0 }\n\n[outputs]')
        self.write("study.toml", start + tied + rest.split("[outputs]")[1])
        header, *rows = TESTS.splitlines()
        soft = [",".join(f"{float(value) * 0.15!r}" for value in row.split(",")) for row in rows]
        self.write("tests.csv", "\n".join([header, *soft]))
        self.succeed("check", "study.toml")

    def test_check_writes_nothing(self):
        before = sorted(self.folder.rglob("*"))
        ended = self.succeed("check", "study.toml")
        self.assertEqual(sorted(self.folder.rglob("*")), before)
        for fragment in ("total mass 3", "k1", "mode 1", "6 specimens", "mares", "200 samples"):
            self.assertIn(fragment, ended.out)

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
                accepted = f"update.{method['name']}.{option['name']}={option['default']}"
                self.succeed("check", "study.toml", "--quiet", "--set", accepted)

    def test_help_of_every_verb(self):
        for verb in ("update", "check", "propagate", "simulate", "report", "methods"):
            self.assertIn("Usage: mottle " + verb, self.succeed(verb, "--help").out)

    # --- propagate and simulate ---

    def test_identical_specimens_with_unknown_noise_are_undecided(self):
        head, first = support.TESTS.splitlines()[:2]
        self.write("tests.csv", "\n".join([head, first, first, first]) + "\n")
        self.succeed("update", "study.toml", "--out", "same", "--quiet", "--set", 'update.method="maximum-likelihood"')
        verdict = json.loads((self.folder / "same" / "result.json").read_text(encoding="utf-8"))["verdict"]
        self.assertEqual(verdict["conclusion"], "undecided")
        self.assertIn("the specimens are the same to the last digits", " ".join(verdict["not_tested"]))

    def test_frequencies_that_noise_makes_impossible_are_not_simulated(self):
        self.write("noisy.toml", support.STUDY + "\n[truth]\nspecimens = 50\nnoise = { f1 = 0.9 }\n")
        ended = self.call("simulate", "noisy.toml", "--out", "noisy")
        self.assertEqual(ended.code, 0, ended.err)
        self.assertIn("of 150 frequencies 0 or less: left out", ended.err)
        rows = [line.split(",") for line in (self.folder / "noisy" / "specimens.csv").read_text().splitlines()]
        column = [name.startswith("f1") for name in rows[0]].index(True)
        values = [row[column] for row in rows[1:]]
        self.assertTrue(all(value in ("", "nan") or float(value) > 0.0 for value in values))
        self.assertIn(True, [value in ("", "nan") for value in values])
        study = support.edited(support.STUDY, ('"tests.csv"', '"noisy/specimens.csv"'))
        self.write("read.toml", study)
        self.succeed("check", "read.toml")

    def test_propagate_leaves_a_cloud(self):
        self.succeed("propagate", "study.toml", "--out", "out", "--quiet")
        header, rows = read_csv(self.folder / "out" / "cloud.csv")
        self.assertEqual(header, ["k1", "k2", "f1", "f2", "f3", "status"])
        self.assertEqual(len(rows), 200)
        self.assertTrue((self.folder / "out" / "report.html").is_file())
        result = read_result(self.folder / "out")
        self.assertEqual(result["model_evaluations"], 200)

    def test_propagated_cloud_is_the_first_of_an_update(self):
        self.update()
        self.succeed("propagate", "study.toml", "--out", "cloud", "--quiet")
        self.assertEqual((self.folder / "cloud" / "cloud.csv").read_bytes(),
                         (self.folder / "out" / "cloud-initial.csv").read_bytes())

    def test_propagate_needs_no_tests(self):
        self.write("study.toml", edited(STUDY, ('[test]\nfile = "tests.csv"', "")))
        self.succeed("propagate", "study.toml", "--out", "out", "--quiet")

    def test_propagate_evaluates_given_points(self):
        self.write("points.csv", "k2,k1\n1,1\n2.5,1.5\n1,1\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out", "--quiet")
        header, rows = read_csv(self.folder / "out" / "cloud.csv")
        self.assertEqual(header, ["k1", "k2", "f1", "f2", "f3", "status"])
        self.assertEqual([row[:2] for row in rows], [["1", "1"], ["1.5", "2.5"], ["1", "1"]])
        self.assertEqual(rows[0], rows[2])
        # K = [[5,-1,-3],[-1,3,-1],[-3,-1,5]], M = I: lambda = 1, 4, 8, f = sqrt(lambda) / 2 pi
        for value, eigenvalue in zip(rows[0][2:5], (1.0, 4.0, 8.0)):
            self.assertAlmostEqual(float(value), math.sqrt(eigenvalue) / (2.0 * math.pi), delta=1e-14)

    def test_one_point_is_enough(self):
        self.write("points.csv", "k1,k2\n1,1\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out", "--quiet")
        self.assertEqual(len(read_csv(self.folder / "out" / "cloud.csv")[1]), 1)

    def test_simulate_makes_the_specimens_of_the_examples(self):
        for case in range(1, 5):
            shutil.copy(THREE_MASSES / f"truth-case{case}.toml", self.folder)
            self.succeed("simulate", f"truth-case{case}.toml", "--out", f"out{case}", "--quiet")
            self.assertEqual((self.folder / f"out{case}" / "specimens.csv").read_bytes(),
                             (THREE_MASSES / f"specimens-case{case}.csv").read_bytes(), f"case {case}")

    def test_simulated_specimens_are_tests(self):
        study = edited(STUDY, ('"tests.csv"', '"study.mottle/specimens.csv"'),
                       ("[outputs]", "[truth]\nspecimens = 20\nnoise = { f1 = 1e-4 }\n\n[outputs]"))
        self.write("study.toml", study)
        self.succeed("simulate", "study.toml", "--quiet")
        header, rows = read_csv(self.folder / "study.mottle" / "specimens.csv")
        _, truth = read_csv(self.folder / "study.mottle" / "specimens-truth.csv")
        self.assertEqual((header, len(rows), len(truth)), (["f1", "f2", "f3"], 20, 20))
        self.assertNotEqual(rows[0][0], truth[0][2])  # noise on f1 alone
        self.assertEqual(rows[0][1:], truth[0][3:])
        self.succeed("update", "study.toml", "--out", "out", "--quiet")

    # --- what a study may say ---

    def test_automatic_samples(self):
        result = self.update(("samples = 200", 'samples = "auto"'))
        samples = result["sample_size"]["n_model"]
        self.assertGreaterEqual(samples, 100)
        self.assertEqual(len(read_csv(self.folder / "out" / "cloud-final.csv")[1]), samples)
        self.assertEqual(result["options"]["samples_rule"], "auto")

    def test_every_distribution(self):
        kinds = ['kind = "lognormal", mean = 2.0, std = 0.3', 'kind = "uniform", lower = 1.0, upper = 3.0',
                 'kind = "truncated-normal", mean = 2.0, std = 0.5, lower = 1.0, upper = 3.0',
                 'kind = "beta", mean = 2.0, std = 0.3, lower = 1.0, upper = 3.0',
                 'kind = "gamma", mean = 2.0, std = 0.3']
        for kind in kinds:
            with self.subTest(kind):
                result = self.update((K1, "{ " + kind + " }"))
                self.assertAlmostEqual(result["parameters"]["prior_mean"][0], 2.0, delta=1e-9)  # all are symmetric or by mean
                _, rows = read_csv(self.folder / "out" / "cloud-initial.csv")
                drawn = [float(row[0]) for row in rows]
                self.assertGreater(min(drawn), 0.0)
                if "lower" in kind:
                    self.assertTrue(1.0 <= min(drawn) and max(drawn) <= 3.0)

    def test_correlation_by_pairs_and_by_matrix_is_the_same(self):
        table = "[correlation]\n{}\n\n[outputs]"
        pairs = self.update(("[outputs]", table.format('pairs = [{ between = ["k1", "k2"], value = 0.9 }]')))
        matrix = self.update(("[outputs]", table.format("matrix = [[1, 0.9], [0.9, 1]]")))
        self.assertEqual(pairs["outputs"], matrix["outputs"])
        _, rows = read_csv(self.folder / "out" / "cloud-initial.csv")
        x, y = ([float(row[i]) for row in rows] for i in range(2))
        mean_x, mean_y = sum(x) / 200, sum(y) / 200
        product = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y))
        spread = math.sqrt(sum((a - mean_x) ** 2 for a in x) * sum((b - mean_y) ** 2 for b in y))
        self.assertAlmostEqual(product / spread, 0.9, delta=0.06)  # 4 standard errors (1 - r^2) / sqrt(200)

    def test_every_sampling(self):
        for sampling in ("monte-carlo", "latin-hypercube", "sobol"):
            with self.subTest(sampling):
                result = self.update(("samples = 200", f'samples = 256\nsampling = "{sampling}"'))
                _, rows = read_csv(self.folder / "out" / "cloud-initial.csv")
                mean = sum(float(row[0]) for row in rows) / 256
                # 5 standard errors of plain sampling; stratified designs are far closer
                self.assertAlmostEqual(mean, 2.0, delta=5 * 0.3 / 16 if sampling == "monte-carlo" else 0.01)
                self.assertIn(result["status"], STATUSES)

    def test_damping_is_an_output(self):
        dampers = 'dampers = [{ name = "c1", between = ["ground", "m1"], damping = 0.05 }]\nsprings = ['
        tests = "\n".join(line + (",zeta1" if i == 0 else f",0.00{50 + i}") for i, line in
                          enumerate(TESTS.splitlines()))
        result = self.update(("springs = [", dampers), ("[1, 2, 3]", "[1, 2, 3]\ndamping = [1]"),
                             ('target = "spring:k2"\ndistribution = { kind = "normal", mean = 2.0, std = 0.3 }',
                              'target = "damper:c1"\ndistribution = { kind = "gamma", mean = 0.05, std = 0.01 }'),
                             tests=tests)
        self.assertEqual(result["outputs"]["names"], ["f1", "f2", "f3", "zeta1"])
        self.assertEqual(result["outputs"]["units"][3], "-")
        self.assertEqual(result["parameters"]["units"][1], "N s/m")

    def test_shapes_are_outputs(self):
        study = edited(STUDY, ("[1, 2, 3]", '[1, 2]\nshapes = { modes = [1], dofs = ["m1", "m3"] }'),
                       ("[outputs]", "[truth]\nspecimens = 12\n\n[outputs]"),
                       ('"tests.csv"', '"made/specimens.csv"'))
        self.write("study.toml", study)
        self.succeed("simulate", "study.toml", "--out", "made", "--quiet")
        self.succeed("update", "study.toml", "--out", "out", "--quiet")
        result = read_result(self.folder / "out")
        self.assertEqual(result["outputs"]["names"], ["f1", "f2", "phi1:m1", "phi1:m3"])

    def test_modes_are_tracked_by_mac(self):
        by_order = self.update()
        by_mac = self.update(("[1, 2, 3]", '[1, 2, 3]\ntracking = "mac"'))
        # No mode crosses another in this study, so both say the same up to the kernels' rounding.
        for a, b in zip(by_order["parameters"]["mean"], by_mac["parameters"]["mean"]):
            self.assertAlmostEqual(a, b, delta=1e-9)

    def test_lost_modes_are_counted_and_left_out(self):
        result = self.update(("[1, 2, 3]", '[1, 2, 3]\ntracking = "mac"\nminimum_mac = 0.98'),
                             ("samples = 200", "samples = 200\nmax_failed = 1.0"))
        failed = result["failed_evaluations"]
        self.assertTrue(failed)
        self.assertTrue(all("lost" in entry["reason"] and 0 <= entry["sample"] < 200 for entry in failed))
        _, rows = read_csv(self.folder / "out" / "cloud-initial.csv")
        lost = [row for row in rows if "ok" not in row[-1]]
        self.assertEqual(len(lost), sum(1 for entry in failed if entry["iteration"] == 0))
        self.assertEqual(lost[0][2:5], ["", "", ""])
        _, rows = read_csv(self.folder / "out" / "clouds.csv")
        for state in result["iterations"]:
            drawn = sum(1 for row in rows if float(row[0]) == state["index"])
            self.assertEqual(drawn, 200 - state["failed"], f"iteration {state['index']}")

    def test_too_many_lost_modes_stop_the_run(self):
        self.write("study.toml", edited(STUDY, ("[1, 2, 3]", '[1, 2, 3]\ntracking = "mac"\nminimum_mac = 1.0')))
        ended = self.call("update", "study.toml", "--out", "out")
        self.assertEqual(ended.code, 3)
        self.assertIn("of 200 model runs failed", ended.err)
        self.assertFalse((self.folder / "out" / "result.json").exists())

    def test_missing_measurements_are_left_out(self):
        tests = edited(TESTS, ("0.3080098662667982", ""), ("0.44854953970272743", "nan"))
        outputs = self.update(tests=tests)["outputs"]
        self.assertEqual(outputs["test_count"], [6, 5, 5])
        f2 = [float(line.split(",")[1]) for i, line in enumerate(TESTS.splitlines()) if i not in (0, 2)]
        self.assertAlmostEqual(outputs["test_mean"][1], sum(f2) / 5, delta=1e-15)

    def test_test_files_of_other_habits_read_the_same(self):
        expected = numbers_of(self.update())
        lines = TESTS.splitlines()
        swapped = [",".join([*reversed(line.split(","))]) for line in lines]
        habits = {
            "semicolons": TESTS.replace(",", ";"),
            "tabs": TESTS.replace(",", "\t"),
            "Windows line ends": TESTS.replace("\n", "\r\n").encode(),
            "a byte order mark": b"\xef\xbb\xbf" + TESTS.encode(),
            "comments and empty lines": "# measured in May\n\n" + TESTS.replace("\n0.165", "\n# next day\n0.165"),
            "units in the header": TESTS.replace("f1,f2,f3", "f1_Hz,f2 [Hz],f3 (Hz)"),
            "quoted cells": "\n".join(",".join(f'"{cell}"' for cell in line.split(",")) for line in lines),
            "columns in another order": "\n".join(swapped),
            "no line end at the end": TESTS.rstrip("\n"),
        }
        for habit, tests in habits.items():
            with self.subTest(habit):
                self.assertEqual(numbers_of(self.update(tests=tests)), expected)

    def test_columns_that_are_not_used_are_noted(self):
        tests = "\n".join(line + (",f4,k1,specimen" if i == 0 else f",0.6,1.0,S{i}") for i, line in
                          enumerate(TESTS.splitlines()))
        result = self.update(tests=tests)
        self.assertTrue(any("f4" in note and "k1" in note for note in result["notes"]), result["notes"])

    def test_relative_parameter_is_a_factor(self):
        values = self.update(('name = "k6", between = ["m1", "m3"], stiffness = 3.0',
                              'name = "k6", between = ["m1", "m3"], stiffness = 2.0'),
                             ('target = "spring:k2"', 'target = "spring:k6"'))
        factors = self.update(('name = "k6", between = ["m1", "m3"], stiffness = 3.0',
                               'name = "k6", between = ["m1", "m3"], stiffness = 2.0'),
                              ('target = "spring:k2"\ndistribution = { kind = "normal", mean = 2.0, std = 0.3 }',
                               'target = "spring:k6"\nrelative = true\n'
                               'distribution = { kind = "normal", mean = 1.0, std = 0.15 }'))
        self.assertEqual(factors["parameters"]["units"][1], "-")
        # A factor on 2 is half the value. The clouds differ: the root of a covariance depends on the parameters' scale,
        # so this agrees to the Monte-Carlo error of 200 samples only, a third of it here.
        self.assertAlmostEqual(2.0 * factors["parameters"]["mean"][1], values["parameters"]["mean"][1],
                               delta=0.3 * 0.3 / math.sqrt(200))

    def test_tied_elements_share_one_parameter(self):
        result = self.update(('target = "spring:k2"', 'target = ["spring:k2", "spring:k5"]'))
        self.assertEqual(result["parameters"]["names"], ["k1", "k2"])
        self.write("points.csv", "k1,k2\n1,1.5\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "tied", "--quiet")
        self.write("plain.toml", edited(STUDY, ('name = "k5", between = ["m2", "m3"], stiffness = 1.0',
                                                'name = "k5", between = ["m2", "m3"], stiffness = 1.5')))
        self.succeed("propagate", "plain.toml", "--points", "points.csv", "--out", "plain", "--quiet")
        tied, plain = (read_csv(self.folder / name / "cloud.csv")[1][0] for name in ("tied", "plain"))
        for a, b in zip(tied[2:5], plain[2:5]):
            self.assertAlmostEqual(float(a), float(b), delta=1e-15)

    def test_a_mass_is_a_parameter(self):
        result = self.update(('target = "spring:k2"\ndistribution = { kind = "normal", mean = 2.0',
                              'target = "mass:m2"\ndistribution = { kind = "normal", mean = 2.0'))
        self.assertEqual(result["parameters"]["units"], ["N/m", "kg"])

    def test_deterministic_method(self):
        for regularisation in ("none", "tikhonov", "bayesian"):
            with self.subTest(regularisation):
                result = self.update(('method = "mares"', 'method = "deterministic"'),
                                     ("[update.mares]", "[update.deterministic]\nspecimen = 2\n"
                                      f'regularisation = "{regularisation}"\n\n[update.mares]'))
                self.assertEqual(result["method"], "deterministic")
                self.assertEqual(result["status"], "converged")
                self.assertEqual(result["options"]["specimen"], 2)

    def test_deterministic_method_takes_one_specimen(self):
        result = self.update(('method = "mares"', 'method = "deterministic"'), tests="\n".join(TESTS.splitlines()[:2]))
        self.assertEqual(result["status"], "converged")
        self.assertEqual(result["outputs"]["test_count"], [1, 1, 1])

    def test_impossible_draws_are_replaced_and_counted(self):
        result = self.update((K1, '{ kind = "normal", mean = 0.5, std = 0.4 }'))
        first = result["iterations"][0]["rejected_draws"]
        # Of 200 draws a share of Phi(-1.25) = 0.106 is impossible, each redraw again: 23.6 expected, deviation 5.1.
        self.assertTrue(3 <= first <= 45, first)
        self.assertGreaterEqual(result["rejected_draws"]["count"], first)
        self.assertIn("rejected", result["rejected_draws"]["rule"])
        _, rows = read_csv(self.folder / "out" / "cloud-initial.csv")
        self.assertGreater(min(float(row[0]) for row in rows), 0.0)

    def test_max_iterations_is_a_status(self):
        result = self.update(("iterations = 30", "iterations = 1"))
        self.assertEqual(result["status"], "max-iterations")
        self.assertEqual(result["verdict"]["conclusion"], "undecided", "an unfinished update is no evidence")

    def test_other_systems_of_units(self):
        result = self.update(('units = "SI"', 'units = "mm-kg-ms"'))
        self.assertEqual(result["outputs"]["units"], ["kHz"] * 3)
        self.assertIn("kHz", self.succeed("check", "study.toml").out)

    def test_paths_may_hold_spaces_and_other_letters(self):
        self.write("ein Versuch/Prüfstand 1.toml", edited(STUDY, ("tests.csv", "Proben (10).csv")))
        self.write("ein Versuch/Proben (10).csv", TESTS)
        self.succeed("update", "ein Versuch/Prüfstand 1.toml", "--quiet")
        self.assertTrue((self.folder / "ein Versuch" / "Prüfstand 1.mottle" / "report.html").is_file())


def numbers_of(result):
    return {key: value for key, value in result.items() if key not in ("timings_s", "notes")}


if __name__ == "__main__":
    support.main()
