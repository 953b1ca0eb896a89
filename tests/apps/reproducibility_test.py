"""The same study and seed give the same numbers: at any number of threads, on repetition, and from another build.

    python3 reproducibility_test.py PATH_TO_MOTTLE [PATH_TO_ANOTHER_BUILD]        (or MOTTLE_OTHER=PATH)
"""

import os
import pathlib
import shutil
import subprocess
import unittest

import support
from support import STUDY, THREE_MASSES, edited, numbers, read_result

RELATIVE = 1e-12  # what two builds may differ by
STUDIES = {
    "mares": STUDY,
    "many samples": edited(STUDY, ("samples = 200", "samples = 20000"), ("iterations = 30", "iterations = 4")),
    "shapes by MAC": edited(STUDY, ("[1, 2, 3]", '[1, 2, 3]\ntracking = "mac"'), ("samples = 200", "samples = 3000")),
    "Latin hypercube": edited(STUDY, ("samples = 200", 'samples = 200\nsampling = "latin-hypercube"')),
    "Sobol": edited(STUDY, ("samples = 200", 'samples = 256\nsampling = "sobol"')),
    "rejected draws": edited(STUDY, ('mean = 2.0, std = 0.3 }\nbounds = [0.5, 3.0]', "mean = 0.5, std = 0.4 }")),
    "correlated": edited(STUDY, ("[outputs]", '[correlation]\npairs = [{ between = ["k1", "k2"], value = 0.6 }]\n\n'
                                 "[outputs]")),
    "deterministic": edited(STUDY, ('method = "mares"', 'method = "deterministic"')),
    "bayes": edited(STUDY, ('method = "mares"', 'method = "bayes"')),
    "interval": edited(STUDY, ('method = "mares"', 'method = "interval"')),
    "hierarchical": edited(STUDY, ('method = "mares"', 'method = "hierarchical"'),
                           ('weighting = "mahalanobis"\n', 'weighting = "mahalanobis"\n[update.hierarchical]\nparticles = 100\ndecorrelation = 0.9\n')),
    "abc": edited(STUDY, ('method = "mares"', 'method = "abc"')),
}


def largest_difference(a, b, path=""):
    """(relative difference, where) of two results; texts, keys and lengths must be equal.

    A number is compared with the largest of its own list, else a mean that is zero but for rounding never agrees.
    """
    if isinstance(a, dict) and isinstance(b, dict):
        if list(a) != list(b):
            return float("inf"), path
        return max((largest_difference(a[key], b[key], f"{path}/{key}") for key in a), default=(0.0, path))
    if isinstance(a, list) and isinstance(b, list):
        if len(a) != len(b):
            return float("inf"), path
        if a and all(isinstance(value, float) for value in a + b):
            scale = max(abs(value) for value in a + b) or 1.0
            return max((abs(x - y) / scale, f"{path}/{i}") for i, (x, y) in enumerate(zip(a, b)))
        return max((largest_difference(x, y, f"{path}/{i}") for i, (x, y) in enumerate(zip(a, b))),
                   default=(0.0, path))
    if isinstance(a, float) and isinstance(b, float):
        return abs(a - b) / (max(abs(a), abs(b)) or 1.0), path
    return (0.0 if a == b else float("inf")), path


class ReproducibilityTest(support.CommandTest):
    """One claim a test."""

    def test_threads_do_not_change_the_numbers(self):
        for name, study in STUDIES.items():
            with self.subTest(name):
                self.write("study.toml", study)
                for threads in (1, 3):
                    self.succeed("update", "study.toml", "--out", f"t{threads}", "--threads", threads, "--quiet")
                self.assertEqual(numbers(self.folder / "t3"), numbers(self.folder / "t1"))
                self.assertEqual((self.folder / "t3" / "cloud-final.csv").read_bytes(),
                                 (self.folder / "t1" / "cloud-final.csv").read_bytes())

    def test_repetition_gives_the_same_numbers(self):
        for case in range(1, 5):
            for name in (f"case{case}.toml", f"specimens-case{case}.csv"):
                shutil.copy(THREE_MASSES / name, self.folder)
            for attempt in ("a", "b"):
                self.succeed("update", f"case{case}.toml", "--out", attempt, "--quiet")
            self.assertEqual(numbers(self.folder / "a"), numbers(self.folder / "b"), f"case {case}")

    def test_the_environment_does_not_change_the_numbers(self):
        self.succeed("update", "study.toml", "--out", "a", "--quiet")
        self.succeed("update", "study.toml", "--out", "b", "--quiet",
                     environment={"LC_ALL": "C", "LANG": "de_DE.UTF-8", "TZ": "Asia/Tokyo", "OMP_NUM_THREADS": "2",
                                  "OPENBLAS_NUM_THREADS": "2"})
        self.assertEqual(numbers(self.folder / "a"), numbers(self.folder / "b"))

    def test_the_place_does_not_change_the_numbers(self):
        self.succeed("update", "study.toml", "--out", "a", "--quiet")
        self.write("elsewhere/study.toml", STUDY)
        shutil.copy(self.folder / "tests.csv", self.folder / "elsewhere")
        self.succeed("update", str(self.folder / "elsewhere" / "study.toml"), "--quiet", cwd="/")
        self.assertEqual(numbers(self.folder / "a"), numbers(self.folder / "elsewhere" / "study.mottle"))

    def test_another_build_agrees(self):
        other = os.environ.get("MOTTLE_OTHER")
        if not other:
            self.skipTest("no second build given (second argument, or MOTTLE_OTHER)")
        other = str(pathlib.Path(other).resolve())
        for name, study in STUDIES.items():
            with self.subTest(name):
                self.write("study.toml", study)
                self.succeed("update", "study.toml", "--out", "a", "--quiet")
                subprocess.run([other, "update", "study.toml", "--out", "b", "--quiet"], cwd=self.folder, check=True,
                               timeout=300)
                a, b = (read_result(self.folder / out) for out in ("a", "b"))
                a.pop("timings_s")
                b.pop("timings_s")
                difference, where = largest_difference(a, b)
                self.assertLessEqual(difference, RELATIVE, where)


if __name__ == "__main__":
    support.main()
