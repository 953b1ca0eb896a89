"""Posteriors as a user meets them: ArviZ, kill and resume, a reduced model under the sampler. Their files and the keys of
result.json are in tests/study.

    python3 bayes_test.py PATH_TO_MOTTLE
"""

import csv
import importlib.util
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

    @unittest.skipUnless(importlib.util.find_spec("arviz"), "ArviZ is not installed")
    def test_arviz_reads_the_posterior(self):
        import arviz  # pylint: disable=import-outside-toplevel
        self.update()
        data = arviz.from_json(str(self.folder / "out" / "posterior.json"))
        self.assertEqual(data.posterior.sizes["chain"], 8)

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



if __name__ == "__main__":
    support.main()
