"""[test] model_error: an error of the model that all specimens share, from the study file to results and predictions.

    python3 model_error_test.py PATH_TO_MOTTLE
"""

import unittest

import support
from support import STUDY, edited, read_result

METHOD = ('method = "mares"', 'method = "maximum-likelihood"')
FILE = 'file = "tests.csv"'
NOISE = FILE + '\nrepeatability = { "f*" = "0.05 %" }\n'


def width(result):
    lower, upper = result["parameters"]["mean_ci95"][0]
    return upper - lower


class ModelErrorTest(support.CommandTest):
    """One claim a test."""

    def update(self, test_section, *changes):
        self.write("study.toml", edited(STUDY, METHOD, (FILE, test_section), *changes))
        self.succeed("update", "study.toml", "--out", "out", "--quiet")
        return read_result(self.folder / "out")

    def test_widens_the_means_and_is_in_the_results(self):
        without = self.update(NOISE)
        self.assertIsNone(without["outputs"]["model_error_std"])
        self.assertIsNone(without["outputs"]["model_error"])
        result = self.update(NOISE + 'model_error = { "f*" = "0.3 %", f3 = 0.01 }')
        std = result["outputs"]["model_error_std"]
        self.assertAlmostEqual(std[0], 0.003 * result["outputs"]["test_mean"][0], places=12)
        self.assertEqual(std[2], 0.01)
        for error, deviation in zip(result["outputs"]["model_error"], std):
            self.assertLessEqual(error["standard_error"], deviation * (1 + 1e-9))
            self.assertLess(abs(error["shift"]), 5 * deviation)
        self.assertGreater(width(result), width(without))
        self.assertTrue(any(note.startswith("Model error f* = 0.3 %: applies to f1, f2") for note in result["notes"]))

    def test_estimated(self):
        result = self.update(NOISE + 'model_error = "estimated"')
        self.assertEqual(len(result["outputs"]["model_error_std"]), 3)
        self.assertTrue(any("This estimate has only" in note for note in result["notes"]))

    def test_a_prediction_of_what_was_tested_is_not_made_less_sure(self):
        # d moves the tested frequencies and the mean together: their sum is what the tests have measured.
        truth = "\n[truth]\nspecimens = 12\n" + "".join(
            f'\n[[truth.parameter]]\nname = "{k}"\ntarget = "spring:{k}"\n'
            'distribution = { kind = "normal", mean = 2.0, std = 0.2 }\n' for k in ("k1", "k2"))
        self.write("truth.toml", STUDY + truth)
        self.succeed("simulate", "truth.toml", "--out", "truth", "--quiet")
        predict = "\n[predict]\nfrequencies = [1, 2]\ndraws = 4000\n"

        def widths(entry, section=predict):
            ends = self.update('file = "truth/specimens.csv"\n' + entry, ("frequencies = [1, 2, 3]", "frequencies = [1, 2]"),
                               ("weighting = \"mahalanobis\"\n", "weighting = \"mahalanobis\"\n" + section))
            return [upper - lower for lower, upper in ends["prediction"]["interval95"]]

        without = widths("")
        for one, other in zip(without, widths('model_error = { "f*" = "0.5 %" }')):
            self.assertAlmostEqual(other / one, 1.0, delta=0.1)
        # Of another structure the error is a new one: 3 % of f1 and what the mean carries.
        changed = predict + 'model = { "mass:m1" = 1.5 }\n'
        plain = widths("", changed)
        self.assertGreater(widths('model_error = { "f*" = "3 %" }', changed)[0], 1.1 * plain[0])

    def test_what_is_wrong_is_said(self):
        for entry, words in (('model_error = "guess"', '"estimated", or a table'),
                             ("model_error = { g1 = 0.1 }", "output 'g1'"),
                             ('model_error = { "f*" = "-1 %" }', "a number >= 0")):
            with self.subTest(entry=entry):
                self.write("study.toml", edited(STUDY, METHOD, (FILE, NOISE + entry)))
                ended = self.call("update", "study.toml", "--out", "out", "--quiet")
                self.assertEqual(ended.code, 2, ended.err)
                self.assertIn("test.model_error", ended.err)
                self.assertIn(words, ended.err)


class DistancesTest(support.CommandTest):
    """Eight specimens of the study's own population and noise."""

    EIGHT = """\
f1,f2,f3
0.209488,0.355357,0.46863
0.188222,0.341468,0.456915
0.207764,0.352537,0.467762
0.20649,0.353103,0.466936
0.2026,0.347843,0.466301
0.195871,0.33948,0.465722
0.197441,0.345765,0.462437
0.201111,0.35116,0.4634
"""

    def test_does_not_make_a_right_model_inadequate_by_distances(self):
        # Standard deviations had come out half as large as without the error.
        self.write("tests.csv", self.EIGHT)
        self.write("study.toml", edited(STUDY, ('method = "mares"', 'method = "abc"'), (FILE, FILE + (
            '\nrepeatability = { "f*" = "0.1 %" }\nmodel_error = { "f*" = "0.3 %" }\n')))
            + "[update.abc]\nsimulations = 2000\ncalibration_sets = 100\n")
        self.succeed("update", "study.toml", "--out", "out", "--quiet")
        self.assertEqual(read_result(self.folder / "out")["verdict"]["conclusion"], "adequate")


if __name__ == "__main__":
    support.main()
