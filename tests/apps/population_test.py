"""The keys of a study that shape the population: scale, covariance, repeatability, and the methods that use them.

    python3 population_test.py PATH_TO_MOTTLE
"""

import math
import statistics
import unittest

import support
from support import STUDY, edited, read_csv, read_result

METHODS = ("inversion", "perturbation", "covariance-adjustment", "moment-matching")
REPEATS = """\
specimen,f1,f2,f3
a,0.170,0.310,0.450
a,0.172,0.312,0.449
a,0.171,0.308,0.451
b,0.160,0.320,0.440
b,0.163,,0.442
"""


class PopulationTest(support.CommandTest):
    """One claim a test."""

    def check(self, *changes, arguments=()):
        self.write("study.toml", edited(STUDY, *changes))
        return self.succeed("check", "study.toml", *arguments).out

    def update(self, method, *changes, arguments=()):
        self.write("study.toml", edited(STUDY, ('method = "mares"', f'method = "{method}"'), *changes))
        self.succeed("update", "study.toml", "--out", "out", "--quiet", *arguments)
        return read_result(self.folder / "out")

    def test_every_method_estimates_the_population(self):
        for method in METHODS:
            with self.subTest(method=method):
                result = self.update(method)
                self.assertEqual(result["status"], "converged", result["message"])
                self.assertEqual(result["method"], method)

    def test_a_parameter_pressed_to_the_end_of_its_logit_is_an_answer(self):
        # Tests from far outside of the bounds: the outputs no longer see the parameter, its mean rounds to the end.
        narrow = ('mean = 2.0, std = 0.3 }\nbounds = [0.5, 3.0]', 'mean = 0.8, std = 0.03 }\nbounds = [0.76, 0.88]\nscale = "logit"')
        for method in (*METHODS, "maximum-likelihood"):
            for surrogate in ("", '[surrogate]\nkind = "chaos"\n', '[surrogate]\nkind = "kriging"\n'):
                with self.subTest(method=method, surrogate=surrogate):
                    study = edited(STUDY, ('method = "mares"', f'method = "{method}"'), ("iterations = 30", "iterations = 3"), narrow)
                    self.write("study.toml", study + surrogate)
                    ended = self.call("update", "study.toml", "--out", "out", "--quiet")
                    self.assertIn(ended.code, (0, 3), ended.err)
                    self.assertNotIn("nan", ended.err)
                    if ended.code == 0:
                        found = read_result(self.folder / "out")
                        self.assertTrue(0.76 < found["parameters"]["mean"][0] < 0.88)
                        for value in (found["identifiability"] or {"singular_values": []})["singular_values"]:
                            self.assertTrue(value == 0.0 or value > 1e-300, value)

    def test_a_diagonal_covariance(self):
        for method in METHODS:
            with self.subTest(method=method):
                result = self.update(method, ("samples = 200", 'samples = 200\ncovariance = "diagonal"'))
                self.assertEqual(result["parameters"]["covariance"][0][1], 0.0)

    def test_groups_of_parameters(self):
        result = self.update("perturbation", ("samples = 200", 'samples = 200\ncovariance = [["k1", "k2"]]'))
        self.assertNotEqual(result["parameters"]["covariance"][0][1], 0.0)

    def test_check_says_what_may_be_correlated(self):
        how = ('method = "mares"', 'method = "inversion"')
        self.assertIn("covariance: full", self.check(how))
        self.assertIn("covariance: diagonal", self.check(how, ("samples = 200", 'samples = 200\ncovariance = "diagonal"')))
        self.assertIn("covariance: only within [k1, k2]",
                      self.check(how, ("samples = 200", 'samples = 200\ncovariance = [["k2", "k1"]]')))
        self.assertIn("covariance: not used", self.check(("samples = 200", 'samples = 200\ncovariance = "diagonal"')))

    def test_scales(self):
        for scale in ("log", "logit"):
            for method in METHODS:
                with self.subTest(method=method, scale=scale):
                    change = ("bounds = [0.5, 3.0]", f'bounds = [0.5, 3.0]\nscale = "{scale}"')
                    plain = self.update(method)["parameters"]
                    result = self.update(method, change)
                    self.assertEqual(result["status"], "converged", result["message"])
                    # The scatter is 20 %: mean and deviation of x depend little on the scale.
                    for key in ("mean", "std"):
                        self.assertAlmostEqual(result["parameters"][key][0], plain[key][0], delta=0.06)
                    header, rows = read_csv(self.folder / "out" / "cloud-final.csv")
                    values = [float(row[header.index("k1")]) for row in rows]
                    self.assertGreater(min(values), 0.5 if scale == "logit" else 0.0)

    def test_check_names_the_scale(self):
        self.assertIn("normal on its logarithm", self.check(("bounds = [0.5, 3.0]", 'scale = "log"')))

    def test_repeatability_by_patterns(self):
        out = self.check(('"tests.csv"', '"tests.csv"\nrepeatability = { "f*" = 0.001, f2 = 0.002, "f?" = 0.003 }'))
        self.assertIn("f2 = 0.002: applies to f2.", out)
        self.assertIn("f? = 0.003: applies to f1, f3.", out)
        self.assertIn("f* = 0.001: applies to no output", out)

    def test_repeatability_in_per_cent_is_that_of_the_mean(self):
        part = self.update("perturbation", ('"tests.csv"', '"tests.csv"\nrepeatability = { "f*" = "1 %" }'))
        means = part["outputs"]["test_mean"]
        numbers = ", ".join(f"f{i + 1} = {0.01 * mean!r}" for i, mean in enumerate(means))
        whole = self.update("perturbation", ('"tests.csv"', f'"tests.csv"\nrepeatability = {{ {numbers} }}'))
        for first, second in zip(part["parameters"]["std"], whole["parameters"]["std"]):
            self.assertAlmostEqual(first, second, delta=1e-9)

    def test_noise_is_taken_off_the_scatter(self):
        plain = self.update("perturbation")["parameters"]["std"]
        noisy = self.update("perturbation", ('"tests.csv"', '"tests.csv"\nrepeatability = { "f*" = 0.003 }'))
        self.assertLess(noisy["parameters"]["std"][0], plain[0])

    def test_repeatability_from_repeats_is_pooled_within_specimens(self):
        self.write("repeats.csv", REPEATS)
        repeats = self.update("perturbation", ('"tests.csv"', '"tests.csv"\nrepeatability = "repeats.csv"'))
        squares = [2 * statistics.variance([0.170, 0.172, 0.171]) + statistics.variance([0.160, 0.163]),
                   2 * statistics.variance([0.310, 0.312, 0.308]),
                   2 * statistics.variance([0.450, 0.449, 0.451]) + statistics.variance([0.440, 0.442])]
        numbers = ", ".join(f"f{i + 1} = {math.sqrt(value / freedom)!r}"
                            for i, (value, freedom) in enumerate(zip(squares, (3, 2, 3))))
        given = self.update("perturbation", ('"tests.csv"', f'"tests.csv"\nrepeatability = {{ {numbers} }}'))
        for first, second in zip(repeats["parameters"]["std"], given["parameters"]["std"]):
            self.assertAlmostEqual(first, second, delta=1e-9)
        self.assertIn("2 to 3 degrees of freedom", self.check(('"tests.csv"', '"tests.csv"\nrepeatability = "repeats.csv"')))

    def test_the_study_as_run_finds_its_repeats(self):
        self.write("repeats.csv", REPEATS)
        first = self.update("perturbation", ('"tests.csv"', '"tests.csv"\nrepeatability = "repeats.csv"'))
        self.succeed("update", "out/study.toml", "--out", "again", "--quiet")
        self.assertEqual(first["parameters"]["std"], read_result(self.folder / "again")["parameters"]["std"])

    def test_noise_of_the_truth_by_patterns_and_in_per_cent(self):
        truth = '[truth]\nspecimens = 400\nnoise = { "f*" = "10 %", f3 = 0.0 }\n\n[outputs]'
        self.write("study.toml", edited(STUDY, ("[outputs]", truth)))
        self.succeed("simulate", "study.toml", "--out", "drawn", "--quiet")
        header, rows = read_csv(self.folder / "drawn" / "specimens.csv")
        names, exact = read_csv(self.folder / "drawn" / "specimens-truth.csv")
        for name, expected in (("f1", 0.1 * 0.2), ("f3", 0.0)):  # f1 is about 0.2 Hz at k1 = k2 = 2
            noise = [float(row[header.index(name)]) - float(true[names.index(name)]) for row, true in zip(rows, exact)]
            self.assertAlmostEqual(statistics.pstdev(noise), expected, delta=0.15 * expected)


if __name__ == "__main__":
    support.main()
