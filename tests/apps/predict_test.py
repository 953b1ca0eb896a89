"""[predict] as a user meets it: result.json, prediction.csv, refusals."""

import support
from support import STUDY, line_of, main, numbers, read_csv, read_result

PREDICT = '\n[predict]\nfrequencies = [1, 3]\nmodel = { "mass:m1" = 2.0 }\ndraws = 1000\n'
HELD_OUT = "f1,f3\n0.14,0.40\n0.13,\n0.135,0.41\n"


class Predict(support.CommandTest):

    def setUp(self):
        super().setUp()
        self.study = STUDY.replace('method = "mares"', 'method = "maximum-likelihood"').replace(
            'file = "tests.csv"', 'file = "tests.csv"\nrepeatability = { f1 = 0.002, f2 = 0.002, f3 = 0.002 }')

    def update(self, block, *arguments):
        self.write("study.toml", self.study + block)
        self.succeed("update", "study.toml", "--out", "out", "--quiet", *arguments)
        return read_result(self.folder / "out")

    def test_without_the_block_nothing_is_predicted(self):
        self.assertNotIn("prediction", self.update(""))
        self.assertFalse((self.folder / "out" / "prediction.csv").exists())

    def test_mean_deviation_and_interval_of_every_output(self):
        prediction = self.update(PREDICT)["prediction"]
        self.assertEqual(prediction["names"], ["f1", "f3"])
        for key in ("mean", "std", "noise_std"):
            self.assertEqual(len(prediction[key]), 2)
        for mean, (lower, upper) in zip(prediction["mean"], prediction["interval95"]):
            self.assertLess(lower, mean)
            self.assertLess(mean, upper)
        self.assertIsNone(prediction["held_out"])
        header, rows = read_csv(self.folder / "out" / "prediction.csv")
        self.assertEqual(header, ["mean", "std", "lower95", "upper95", "output", "unit"])
        self.assertEqual([row[4] for row in rows], ["f1", "f3"])

    def test_a_heavier_mass_lowers_the_predicted_frequencies(self):
        heavy = self.update(PREDICT)["prediction"]["mean"]
        light = self.update(PREDICT.replace("2.0", "1.0"))["prediction"]["mean"]
        for one, other in zip(heavy, light):
            self.assertLess(one, other)

    def test_held_out_tests_are_checked(self):
        self.write("held-out.csv", HELD_OUT)
        result = self.update(PREDICT + 'held_out = "held-out.csv"\n')
        check = result["prediction"]["held_out"]
        self.assertEqual(check["specimens"], 3)
        self.assertEqual(len(check["coverage"]), 2)
        self.assertIsNone(check["transforms"][1][1])
        self.assertIsNone(check["squared_distances"][1])
        self.assertTrue(any("Held-out tests" in note for note in result["notes"]))
        header, _ = read_csv(self.folder / "out" / "prediction.csv")
        self.assertIn("held_out_coverage", header)
        self.succeed("update", self.folder / "out" / "study.toml", "--out", "again", "--quiet")  # as run, from there

    def test_the_same_numbers_on_any_threads(self):
        self.update(PREDICT, "--threads", "1")
        first = numbers(self.folder / "out")
        self.update(PREDICT, "--threads", "3")
        self.assertEqual(first, numbers(self.folder / "out"))

    def test_a_method_without_a_population_says_so(self):
        self.study = self.study.replace('method = "maximum-likelihood"', 'method = "mares"')
        notes = self.update(PREDICT)["prediction"]["notes"]
        self.assertIn("does not estimate the scatter of specimens", notes[0])

    def test_what_is_wrong_is_refused_with_its_line(self):
        for block, key, message in (
                ('[predict]\nfrequencies = [1]\nmodel = { "mass:m9" = 1.0 }\n', "model = {", "did you mean 'mass:m1'?"),
                ('[predict]\nfrequencies = [1]\nmodel = { "spring:k1" = 1.0 }\n', "model = {",
                 "is what parameter 'k1' acts on"),
                ('[predict]\nfrequencies = [1]\nheldout = "x.csv"\n', "heldout", "did you mean 'held_out'?"),
                ('[predict]\nfrequencies = [1]\nheld_out = "none.csv"\n', "held_out", "predict.held_out: "),
                ('[predict]\nfrequencies = [1]\nheld_out = "*.nothing"\n', "held_out", "predict.held_out: "),
                ('[predict]\nfrequencies = [99]\n', "frequencies = [99]", "predict.frequencies: "),
                ('[predict]\nfrequencies = [1]\nrepeatability = { f7 = 1.0 }\n', "repeatability = { f7", "output 'f7'")):
            text = self.study + "\n" + block
            self.write("study.toml", text)
            ended = self.call("update", "study.toml", "--out", "refused")
            self.assertEqual(ended.code, 2, ended.err)
            self.assertIn(message, ended.err)
            self.assertIn(f"study.toml:{line_of(text, key)}: ", ended.err)
            self.assertFalse((self.folder / "refused").exists())
            self.assertEqual(self.call("check", "study.toml").err, ended.err)


if __name__ == "__main__":
    main()
