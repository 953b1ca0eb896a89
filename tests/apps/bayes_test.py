"""Posteriors as a user meets them: files, keys of result.json, threads, kill and resume, faults of the study.

    python3 bayes_test.py PATH_TO_MOTTLE
"""

import csv
import json
import math
import shutil
import subprocess
import sys
import time
import unittest

import support
from support import STUDY, edited, numbers, read_result

BAYES = edited(STUDY, ('method = "mares"', 'method = "bayes"'), ("[update.mares]\nweighting = \"mahalanobis\"\n",
                                                              "[update.bayes]\nparticles = 200\n"),
               ('file = "tests.csv"', 'file = "tests.csv"\nrepeatability = { "f*" = 0.02 }'))
SHELL = """title = "Shell"
units = "SI"
[model]
kind = "nastran"
file = "shell.bdf"
""" + "".join(f"""[[parameter]]
name = "E{i}"
target = "MAT1:{i}:E"
distribution = {{ kind = "lognormal", mean = 7e10, std = 7e9 }}
""" for i in range(1, 6)) + """[outputs]
frequencies = [1, 2, 3, 4, 5]
[test]
file = "tests.csv"
repeatability = { f1 = 0.693, f2 = 1.119, f3 = 2.244, f4 = 2.538, f5 = 2.715 }
[update]
method = "bayes"
samples = 200
[update.bayes]
particles = 100
"""
FILES = ("posterior.csv", "posterior.json", "cloud-final.csv")


class BayesTest(support.CommandTest):
    """One claim a test."""

    def setUp(self):
        super().setUp()
        self.write("study.toml", BAYES)

    def update(self, *options):
        self.succeed("update", "study.toml", "--out", "out", "--quiet", *options)
        return read_result(self.folder / "out")

    def test_the_files_hold_what_the_result_says(self):
        result = self.update()
        posterior = result["posterior"]
        self.assertEqual((posterior["chains"], posterior["draws"]), (8, 200))
        with open(self.folder / "out" / posterior["file"], encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), ["chain", "draw", *posterior["names"]])
        self.assertEqual([(row["chain"], row["draw"]) for row in rows],
                         [(str(c + 1), str(d + 1)) for c in range(8) for d in range(200)])
        for name, mean, std in zip(*(result["parameters"][key] for key in ("names", "mean", "std"))):
            values = [float(row[name]) for row in rows]
            own = sum(values) / len(values)
            self.assertAlmostEqual(own, mean, delta=1e-12)
            self.assertAlmostEqual(math.sqrt(sum((v - own) ** 2 for v in values) / len(values)), std, delta=1e-12)
        for key in ("r_hat", "ess_bulk", "ess_tail"):
            self.assertEqual(len(posterior[key]), len(posterior["names"]))
        evidence = result["evidence"]
        self.assertTrue(evidence["ci95"][0] < evidence["ln_evidence"] < evidence["ci95"][1])
        self.assertEqual(result["parameters"]["estimate"]["log_evidence"], evidence["ln_evidence"])
        self.assertAlmostEqual(sum(mode["probability"] for mode in result["modes"]), 1.0, delta=1e-12)

    def test_the_layout_is_that_of_arviz(self):
        result = self.update()
        groups = json.loads((self.folder / "out" / "posterior.json").read_text(encoding="utf-8"))
        self.assertEqual(set(groups), {"posterior", "log_likelihood", "posterior_predictive", "observed_data"})
        self.assertEqual(list(groups["posterior"]), result["posterior"]["names"][:-1])
        for group in ("posterior", "log_likelihood", "posterior_predictive"):
            for variable in groups[group].values():
                self.assertEqual([len(chain) for chain in variable], [200] * 8)
        self.assertEqual({len(values) for values in groups["observed_data"].values()}, {6})
        try:
            import arviz  # pylint: disable=import-outside-toplevel
        except ImportError:
            return
        data = arviz.from_json(str(self.folder / "out" / "posterior.json"))
        self.assertEqual(data.posterior.sizes["chain"], 8)

    def test_the_specimens_log_likelihoods_add_up_to_that_of_the_table(self):
        posterior = self.update()["posterior"]
        groups = json.loads((self.folder / "out" / "posterior.json").read_text(encoding="utf-8"))
        sums = [math.fsum(specimens) for chain in groups["log_likelihood"]["tests"] for specimens in chain]
        with open(self.folder / "out" / "posterior.csv", encoding="utf-8") as file:
            for row, own in zip(csv.DictReader(file), sums, strict=True):
                self.assertAlmostEqual(float(row["log_likelihood"]), own, delta=1e-9)
        self.assertEqual(len(posterior["leave_one_out"]["pointwise"]), 6)
        self.assertAlmostEqual(math.fsum(posterior["leave_one_out"]["pointwise"]), posterior["leave_one_out"]["elpd"], delta=1e-9)
        self.assertEqual({len(chain) for name in posterior["ranks"]["counts"] for chain in name}, {posterior["ranks"]["bins"]})
        for name in posterior["ranks"]["counts"]:
            self.assertEqual([sum(chain) for chain in name], [200] * 8)
        self.assertEqual([len(row) for row in posterior["predictive"]["tests"]], [5] * 3)

    def test_one_specimen_is_not_left_out_and_why_is_said(self):
        self.write("tests.csv", "\n".join(support.TESTS.splitlines()[:2]) + "\n")
        posterior = self.update()["posterior"]
        self.assertIsNone(posterior["leave_one_out"])
        self.assertIn("two specimens", posterior["not_left_out"])

    def test_other_methods_have_none(self):
        self.write("study.toml", STUDY)
        result = self.update()
        self.assertEqual((result["evidence"], result["posterior"], result["modes"]), (None, None, []))
        self.assertFalse((self.folder / "out" / "posterior.csv").exists())

    def test_an_earlier_posterior_does_not_stay(self):
        self.update()
        self.write("study.toml", STUDY)
        self.update()
        self.assertFalse((self.folder / "out" / "posterior.csv").exists())
        self.assertFalse((self.folder / "out" / "posterior.json").exists())

    def test_threads_do_not_change_the_bits(self):
        expected = {}
        for threads in (1, 2, 8):
            self.succeed("update", "study.toml", "--out", f"t{threads}", "--threads", threads, "--quiet")
            found = {name: (self.folder / f"t{threads}" / name).read_bytes() for name in FILES}
            found["numbers"] = numbers(self.folder / f"t{threads}")
            expected = expected or found
            self.assertEqual(found, expected, f"{threads} threads")

    def test_a_killed_run_is_resumed_to_the_same_bits(self):
        self.update()
        expected = {name: (self.folder / "out" / name).read_bytes() for name in FILES}
        expected_numbers = numbers(self.folder / "out")
        for delay in (0.1, 0.2, 0.4):
            shutil.rmtree(self.folder / "out")
            process = subprocess.Popen([support.MOTTLE, "update", "study.toml", "--out", "out", "--quiet"],
                                       cwd=self.folder)
            time.sleep(delay)
            process.kill()
            process.wait()
            self.update("--resume")
            self.assertEqual({name: (self.folder / "out" / name).read_bytes() for name in FILES}, expected)
            self.assertEqual(numbers(self.folder / "out"), expected_numbers)

    def test_a_reduced_model_keeps_its_bound_under_the_sampler(self):
        """Draws whose likelihood is that of exact solutions to within the bound on the frequencies, at any number of threads."""
        make = support.SOURCE / "benchmarks" / "make_models.py"
        subprocess.run([sys.executable, str(make), "shell", "1500", "5", str(self.folder / "shell.bdf")], check=True)
        names = [f"f{i}" for i in range(1, 6)]
        self.write("tests.csv", ",".join(names) + "\n23.1,37.3,74.8,84.6,90.5\n")
        self.write("study.toml", SHELL)
        files = {}
        for threads in (1, 2, 8):
            self.succeed("update", "study.toml", "--out", "out", "--threads", threads, "--quiet")
            files[threads] = (self.folder / "out" / "posterior.csv").read_bytes()
            self.assertEqual(files[threads], files[1], f"{threads} threads")
        result = read_result(self.folder / "out")
        self.assertGreater(result["reduction"]["samples"], 5000)
        self.assertLess(result["reduction"]["exact_samples"], 0.01 * result["reduction"]["samples"])
        draws = list(csv.DictReader(files[1].decode().splitlines()))[::20]
        points = [f"E{i}" for i in range(1, 6)]
        self.write("points.csv", "\n".join([",".join(points), *(",".join(draw[name] for name in points) for draw in draws)]) + "\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "exact", "--quiet", "--set", 'model.reduction="off"')
        with open(self.folder / "exact" / "cloud.csv", encoding="utf-8") as file:
            exact = list(csv.DictReader(file))
        tested = dict(zip(names, (23.1, 37.3, 74.8, 84.6, 90.5)))
        bound = result["reduction"]["frequency_error_bound"]
        self.assertGreater(bound, 0.0)
        largest = 0.0
        for draw, outputs in zip(draws, exact):
            log_likelihood = allowed = 0.0
            for name, z in tested.items():
                f, std = float(outputs[name]), 0.03 * z
                log_likelihood -= 0.5 * ((z - f) / std) ** 2 + math.log(std * math.sqrt(2 * math.pi))
                allowed += abs(z - f) * bound * f / std**2 + 0.5 * (bound * f / std) ** 2
            error = abs(log_likelihood - float(draw["log_likelihood"]))
            self.assertLessEqual(error, allowed)
            largest = max(largest, error)
        self.assertGreater(largest, 0.0, "the reduced model was not used")

    def test_noise_without_a_number_is_sampled(self):
        self.write("study.toml", edited(BAYES, ('repeatability = { "f*" = 0.02 }\n', "")))
        result = self.update()
        self.assertEqual(result["posterior"]["names"], ["k1", "k2", "noise:f", "log_likelihood"])
        self.assertEqual(result["verdict"]["conclusion"], "undecided")

    def test_an_output_of_one_specimen_counts(self):
        first, *others = support.TESTS.splitlines()[1:]
        gaps = [line.rsplit(",", 1)[0] + "," for line in others]
        self.write("tests.csv", "\n".join(["f1,f2,f3", first, *gaps, ""]))
        for method in ("bayes", "hierarchical"):
            with self.subTest(method):
                self.write("study.toml", BAYES.replace("bayes", method))
                result = self.update()
                self.assertEqual(result["status"], "converged")
                self.assertEqual([test["name"] for test in result["verdict"]["tests"]][0],
                                 {"bayes": "residuals", "hierarchical": "mean-residuals"}[method])
        self.write("study.toml", BAYES.replace("bayes", "maximum-likelihood").replace("particles = 200", ""))
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2)
        self.assertIn("test: output 'f3' is measured once in 6 specimens", ended.err)

    def test_noise_that_is_neither_known_nor_sampled_is_refused(self):
        self.write("study.toml", edited(BAYES, ('repeatability = { "f*" = 0.02 }\n', ""),
                                        ("particles = 200", 'noise = "given"')))
        ended = self.call("update", "study.toml", "--out", "out", "--quiet")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("the noise of f1, f2, f3 is not known", ended.err)

    def test_a_prior_without_probability_at_the_tests_is_refused(self):
        self.write("study.toml", edited(BAYES, ("0.02 }", "1e-170 }")))
        ended = self.call("update", "study.toml", "--out", "out", "--quiet")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("below 1e-10 of them rounding decides", ended.err)
        self.write("study.toml", edited(BAYES, ('repeatability = { "f*" = 0.02 }\n', "")))
        ended = self.call("update", "study.toml", "--out", "out", "--quiet", "--set", "update.bayes.noise_scale=1e-320")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("likelihood above zero", ended.err)

    def test_noise_of_zero_is_refused(self):
        self.write("study.toml", edited(BAYES, ("0.02 }", "0.0 }"), ("particles = 200", 'noise = "given"')))
        ended = self.call("update", "study.toml", "--out", "out", "--quiet")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("the noise of f1, f2, f3 is not known", ended.err)

    def test_the_ends_of_each_option_give_a_posterior(self):
        ends = {"effective_fraction": (0.1, 0.99), "decorrelation": (0.02, 0.9), "max_moves": (1, 60000), "islands": (8, 256),
                "noise_scale": (1e-9, 1e9), "noise_degrees_of_freedom": (1.0, 1e6)}
        for option, values in ends.items():
            for value in values:
                self.write("study.toml", edited(BAYES, ("particles = 200", f'particles = 100\nnoise = "estimated"\n{option} = {value}')))
                ended = self.call("update", "study.toml", "--out", "out", "--quiet", "--set", "update.samples=100")
                self.assertEqual(ended.code, 0, f"{option} = {value}: {ended.err}")
                self.assertIn(read_result(self.folder / "out")["status"], ("converged", "stalled"), f"{option} = {value}")

    def test_the_report_opens(self):
        self.update()
        self.assertIn("posterior", (self.folder / "out" / "report.html").read_text(encoding="utf-8"))


if __name__ == "__main__":
    support.main()
