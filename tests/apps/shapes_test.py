"""Shapes without modal mass: their size is no data, whatever it is.

    python3 shapes_test.py PATH_TO_MOTTLE
"""

import json

import support
from support import edited, line_of, main, read_csv

STUDY = """\
title = "Shapes without modal mass"
seed = 11

[model]
kind = "mass-spring"
masses = { m1 = 1.0, m2 = 1.0, m3 = 1.0 }
springs = [
  { name = "k1", between = ["ground", "m1"], stiffness = 1.0 },
  { name = "k4", between = ["m1", "m2"], stiffness = 1.0 },
  { name = "k5", between = ["m2", "m3"], stiffness = 1.0 },
]

[[parameter]]
name = "mass"
target = "mass:m1"
distribution = { kind = "normal", mean = 1.0, std = 0.3 }

[[parameter]]
name = "k1"
target = "spring:k1"
distribution = { kind = "normal", mean = 1.0, std = 0.3 }

[outputs]
frequencies = [1, 2]
shapes = { modes = [1, 2], dofs = ["m1", "m2", "m3"] }

[test]
file = "modes-*.csv"
repeatability = { "f*" = "0.1 %", "phi*" = 0.005 }

[update]
method = "maximum-likelihood"
samples = 400

[truth]
specimens = 40
noise = { "f*" = "0.1 %", "phi*" = 0.005 }

[[truth.parameter]]
name = "mass"
target = "mass:m1"
distribution = { kind = "normal", mean = 1.577, std = 0.05 }

[[truth.parameter]]
name = "k1"
target = "spring:k1"
distribution = { kind = "normal", mean = 1.2, std = 0.06 }
"""
TRUTH = {"mass": (1.577, 0.05), "k1": (1.2, 0.06)}


class Shapes(support.CommandTest):
    def setUp(self):
        super().setUp()
        self.write("study.toml", STUDY)
        self.succeed("simulate", "study.toml", "--out", "truth", "--quiet")
        header, rows = read_csv(self.folder / "truth" / "specimens.csv")
        names = ["f1", "f2"] + [f"phi{mode}:{name}" for mode in (1, 2) for name in ("m1", "m2", "m3")]
        self.tests = [{name: float(row[header.index(name)]) for name in names} for row in rows]

    def write_modes(self, size):
        """A table of shapes a specimen; `size` of specimen and mode is the factor on the mass-normalised shape."""
        for s, test in enumerate(self.tests):
            lines = ["dof," + ",".join(repr(test[f"f{mode}"]) for mode in (1, 2))]
            for name in ("m1", "m2", "m3"):
                shape = [test[f"phi{mode}:{name}"] * size(s, mode) for mode in (1, 2)]
                lines.append(f"{name},{shape[0]!r},{shape[1]!r}")
            self.write(f"modes-{s + 1:02}.csv", "\n".join(lines) + "\n")

    def updated(self, study=STUDY, out="out"):
        self.write("study.toml", study)
        self.succeed("update", "study.toml", "--out", out, "--quiet")
        return json.loads((self.folder / out / "result.json").read_text(encoding="utf-8"))

    def test_their_size_does_not_matter_and_the_truth_is_found(self):
        self.write_modes(lambda s, mode: 1.0)
        first = self.updated()
        self.write_modes(lambda s, mode: (-1.0) ** s * 10.0 ** (s % 7 - 3) * mode)
        other = self.updated()
        self.assertEqual(first["outputs"]["names"], ["f1", "f2", "phi1:m1", "phi1:m2", "phi2:m2", "phi2:m3"])
        for k, (mean, std) in enumerate(TRUTH.values()):
            found, same = ([result["parameters"][key][k] for key in ("mean", "std")] for result in (first, other))
            for one, again in zip(found, same):
                self.assertAlmostEqual(again, one, delta=1e-9)
            # Four standard errors of a mean and of a standard deviation from 40 specimens.
            self.assertAlmostEqual(found[0], mean, delta=4 * std / 40**0.5)
            self.assertAlmostEqual(found[1], std, delta=4 * std / 80**0.5)
        self.assertEqual(first["verdict"]["conclusion"], "adequate")
        self.assertTrue(any("size of shapes is free" in note for note in first["notes"]), first["notes"])

    def test_all_methods_compare_directions(self):
        self.write_modes(lambda s, mode: 3.0 + s)
        for method in ("mares", "deterministic", "inversion", "perturbation", "moment-matching", "covariance-adjustment"):
            result = self.updated(edited(STUDY, ("maximum-likelihood", method)))
            for found, (mean, _) in zip(result["parameters"]["mean"], TRUTH.values()):
                # First-order methods start 1.9 standard deviations of the prior away.
                self.assertAlmostEqual(found, mean, delta=0.05, msg=method)

    def test_that_they_are_mass_normalised_may_be_said(self):
        stated = edited(STUDY, ('"m3"] }', '"m3"], size = "mass-normalised" }'))
        self.write_modes(lambda s, mode: 1.0)
        result = self.updated(stated)
        self.assertEqual(len(result["outputs"]["names"]), 8)
        self.write_modes(lambda s, mode: 50.0)
        self.write("study.toml", stated)
        self.assertIn("times as large as the model's", self.succeed("check", "study.toml").out)

    def test_a_table_of_outputs_may_have_free_sizes(self):
        study = edited(STUDY, ('"m3"] }', '"m3"], size = "free" }'), ("modes-*.csv", "tests.csv"))
        names = list(self.tests[0])
        means = []
        for factor, out in ((1.0, "one"), (-20.0, "other")):
            rows = [",".join(repr(test[name] * (factor if name.startswith("phi2") else 1.0)) for name in names)
                    for test in self.tests]
            self.write("tests.csv", ",".join(names) + "\n" + "\n".join(rows) + "\n")
            result = self.updated(study, out)
            self.assertEqual(len(result["outputs"]["names"]), 6)
            means.append(result["parameters"]["mean"])
        for one, other in zip(*means):
            self.assertAlmostEqual(one, other, delta=1e-9)

    def test_a_shape_that_misses_a_component_is_left_out_and_said_to_be(self):
        self.write_modes(lambda s, mode: 2.0)
        file = self.folder / "modes-03.csv"
        lines = file.read_text(encoding="utf-8").splitlines()
        lines[1] = "m1,nan," + lines[1].split(",", 2)[2]
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")
        self.write("study.toml", STUDY)
        self.assertIn("nearly orthogonal to the reference's: specimen 3 mode 1", self.succeed("check", "study.toml").out)

    def test_a_specimen_of_which_nothing_is_left_is_left_out(self):
        self.write_modes(lambda s, mode: 0.0 if s == 0 else 2.0)
        result = self.updated()
        self.assertTrue(any("no output is left" in note and "specimen 1;" in note for note in result["notes"]), result["notes"])
        for found, (mean, std) in zip(result["parameters"]["mean"], TRUTH.values()):
            self.assertAlmostEqual(found, mean, delta=4 * std / 39**0.5)

    def test_directions_far_from_the_reference_are_told_apart(self):
        """Two masses whose shape turns by more than 22 degrees between the prior and the truth."""
        two = STUDY[:STUDY.index("masses =")] + """\
masses = { m1 = 1.0, m2 = 1.0 }
springs = [
  { name = "k1", between = ["ground", "m1"], stiffness = 1.0 },
  { name = "k2", between = ["ground", "m2"], stiffness = 1.0 },
  { name = "kc", between = ["m1", "m2"], stiffness = 0.1 },
]
""" + "".join(f'[[{table}]]\nname = "{name}"\ntarget = "spring:{name}"\ndistribution = {{ kind = "normal", mean = {mean}, std = {std} }}\n'
             for table, values in (("parameter", (("k1", 1.0, 0.3), ("k2", 1.0, 0.3))),
                                   ("truth.parameter", (("k1", 1.26, 0.02), ("k2", 1.0, 0.02))))
             for name, mean, std in values) + """
[outputs]
frequencies = [1]
shapes = { modes = [1], dofs = ["m1", "m2"], size = "free" }
[test]
file = "tests.csv"
repeatability = { "f*" = "0.01 %", "phi*" = 0.002 }
[update]
method = "maximum-likelihood"
samples = 400
[truth]
specimens = 40
noise = { "f*" = "0.01 %", "phi*" = 0.002 }
"""
        self.write("study.toml", two)
        self.succeed("simulate", "study.toml", "--out", "two", "--quiet")
        (self.folder / "two" / "specimens.csv").rename(self.folder / "tests.csv")
        for method in ("maximum-likelihood", "deterministic", "mares"):
            result = self.updated(edited(two, ("maximum-likelihood", method)))
            for found, mean in zip(result["parameters"]["mean"], (1.26, 1.0)):
                self.assertAlmostEqual(found, mean, delta=4 * 0.03 / 40**0.5, msg=method)

    def test_faults_are_found_with_file_and_line(self):
        self.write_modes(lambda s, mode: 1.0)
        for change, fault in (('"m3"], size = "unknown" }', "size"), ('"m3"], size = 3 }', "size")):
            study = edited(STUDY, ('"m3"] }', change))
            self.write("study.toml", study)
            ended = self.call("check", "study.toml")
            self.assertEqual(ended.code, 2)
            self.assertIn(f"study.toml:{line_of(study, 'shapes =')}: outputs.shapes.{fault}", ended.err)
        self.write("study.toml", edited(STUDY, ('dofs = ["m1", "m2", "m3"]', 'dofs = ["m2"]')))
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2)
        self.assertIn("one component alone", ended.err)


if __name__ == "__main__":
    main()
