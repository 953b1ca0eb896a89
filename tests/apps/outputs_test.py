"""Eigenvalues and ratios of shape components as outputs of every kind of model and test file.

    python3 outputs_test.py PATH_TO_MOTTLE
"""

import math
import re
import unittest

import support
from support import edited, read_csv, read_result

OUTPUTS = ("frequencies = [1, 2, 3]",
           'eigenvalues = [1, 2, 3]\nshape_ratios = [{ mode = 1, dofs = ["m2", "m1"] }, { mode = 2, dofs = ["m1", "m2"] }]')
NAMES = ["lambda1", "lambda2", "lambda3", "ratio1:m2/m1", "ratio2:m1/m2"]
TRUTH = """
[truth]
specimens = 30
noise = { "lambda*" = "0.1 %", "ratio*" = 0.002 }
[[truth.parameter]]
name = "k1"
target = "spring:k1"
distribution = { kind = "normal", mean = 1.6, std = 0.1 }
[[truth.parameter]]
name = "k2"
target = "spring:k2"
distribution = { kind = "normal", mean = 2.3, std = 0.2 }
"""


class OutputsTest(support.CommandTest):
    """One claim a test."""

    def setUp(self):
        super().setUp()
        self.text = edited(support.STUDY, OUTPUTS) + TRUTH
        self.write("study.toml", self.text)

    def simulated(self):
        """Tests of the truth, drawn by simulate."""
        self.succeed("simulate", "study.toml", "--out", "drawn", "--quiet")
        header, rows = read_csv(self.folder / "drawn" / "specimens.csv")
        return header, [[float(cell) for cell in row] for row in rows]

    def table(self, header, rows):
        self.write("tests.csv", "\n".join([",".join(header), *(",".join(map(repr, row)) for row in rows)]) + "\n")

    def update(self, folder="out", *more):
        self.succeed("update", "study.toml", "--out", folder, "--quiet", "--set", 'update.method="maximum-likelihood"',
                     "--set", "update.samples=100", *more)
        return read_result(self.folder / folder)

    def test_an_update_finds_the_population_from_them(self):
        self.table(*self.simulated())
        result = self.update()
        self.assertEqual(result["outputs"]["names"], NAMES)
        self.assertEqual(result["outputs"]["units"], ["(rad/s)^2"] * 3 + ["-"] * 2)
        # Thirty specimens: standard errors of 0.1 / sqrt(30) and 0.2 / sqrt(30), of which four are taken.
        for mean, truth, std in zip(result["parameters"]["mean"], (1.6, 2.3), (0.1, 0.2)):
            self.assertAlmostEqual(mean, truth, delta=4 * std / math.sqrt(30))
        for std, truth in zip(result["parameters"]["std"], (0.1, 0.2)):
            self.assertAlmostEqual(std, truth, delta=0.55 * truth)  # four of std / sqrt(2 * 29)

    def test_eigenvalues_tell_the_same_as_the_frequencies(self):
        header, rows = self.simulated()
        self.write("study.toml", edited(support.STUDY, ("frequencies = [1, 2, 3]", "eigenvalues = [1, 2, 3]")))
        self.table(header[:3], [row[:3] for row in rows])
        by_eigenvalue = self.update()["parameters"]
        self.write("study.toml", support.STUDY)
        self.table(["f1", "f2", "f3"], [[math.sqrt(value) / (2 * math.pi) for value in row[:3]] for row in rows])
        by_frequency = self.update()["parameters"]
        # The same data on a curved scale: half a per cent of noise and scatter of 3 % differ by their squares.
        for a, b in zip(by_eigenvalue["mean"], by_frequency["mean"]):
            self.assertAlmostEqual(a, b, delta=0.01)

    def test_a_column_may_state_the_unit_and_no_other(self):
        header, rows = self.simulated()
        for title in ("lambda1 [(rad/s)^2]", "lambda1 [rad^2/s^2]", "lambda1_(rad/s)^2", "lambda1 ((rad/s)^2)"):
            self.table([title, *header[1:]], rows)
            self.succeed("check", "study.toml")
        self.table(["lambda1 [Hz^2]", *header[1:]], rows)
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("multiply it by 4 pi^2", ended.err)

    def test_eigenvalues_in_another_unit_are_refused(self):
        header, rows = self.simulated()
        self.table(header, [[value / (4 * math.pi**2) for value in row[:3]] + row[3:] for row in rows])  # Hz^2
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("factor is near 1/(2 pi)", ended.err)

    def test_they_move_with_their_modes_where_columns_are_paired_by_frequency(self):
        header, rows = self.simulated()
        study = edited(self.text, ('file = "tests.csv"\n', 'file = "tests.csv"\npairing = "frequency"\n'))
        self.write("study.toml", study)
        self.table(header, rows)
        expected = self.update()["parameters"]["mean"]
        self.table(["lambda7", "lambda8", "lambda9", "ratio7:m2/m1", "ratio8:m1/m2"], rows)
        self.assertEqual(self.update("again")["parameters"]["mean"], expected)

    def test_tests_as_modes_give_them_whatever_size_and_sign_shapes_have(self):
        header, rows = self.simulated()
        size = [0.3, -2.0, 11.0]
        for number, row in enumerate(rows[:6]):
            f1, f2, f3 = (math.sqrt(value) / (2 * math.pi) for value in row[:3])
            a, b = size[number % 3], size[(number + 1) % 3]
            self.write(f"modes-{number}.csv", f"dof,{f1!r} Hz,{f2!r} Hz,{f3!r} Hz\nm1,{a!r},{b * row[4]!r},1\n"
                                              f"m2,{a * row[3]!r},{b!r},0\nm3,{a!r},{-b!r},-1\n")
        self.write("study.toml", edited(self.text, ('file = "tests.csv"', 'file = "modes-*.csv"')))
        self.succeed("update", "study.toml", "--out", "out", "--quiet", "--set", "update.samples=50")
        names, values = read_csv(self.folder / "out" / "tests.csv")
        self.assertEqual(names, NAMES + ["specimen"])
        for row, expected in zip(values, rows[:6]):
            for cell, value in zip(row[:4], expected[:4]):
                self.assertAlmostEqual(float(cell) / value, 1.0, delta=1e-12)

    def test_a_solver_by_command_gives_them(self):
        self.write("input.txt", "{{k1}} {{k2}}")
        # Two masses of 1 on springs k1 and k2, tied by 1: eigenvalues and shapes by the quadratic.
        self.write("solver.py", "import math\nk1, k2 = map(float, open('input.txt').read().split())\n"
                                "m, h = 1 + (k1 + k2) / 2, math.hypot((k1 - k2) / 2, 1)\n"
                                "l = [m - h, m + h]\n"
                                "open('f.txt', 'w').write(''.join(f'{x!r}\\n' for x in l))\n"
                                "open('s.csv', 'w').write('dof,1,2\\na,1,1\\nb,%r,%r\\n' % tuple(k1 + 1 - x for x in l))\n")
        text = support.command_study(["python3", "solver.py"])
        text = edited(text, ('format = "column"\n', 'format = "column"\nquantity = "eigenvalue"\n[model.shapes]\nfile = "s.csv"\nformat = "csv"\n'),
                      ("frequencies = [1, 2, 3]", 'eigenvalues = [1, 2]\nshape_ratios = [{ mode = 1, dofs = ["b", "a"] }]'))
        self.write("study.toml", text)
        self.write("tests.csv", "lambda1,lambda2,ratio1:b/a\n2,4,0.5\n3,5,0.6\n")
        self.write("points.csv", "k1,k2\n2,2\n2,3.5\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out", "--quiet")
        header, rows = read_csv(self.folder / "out" / "cloud.csv")
        for row in rows:
            cells = dict(zip(header, row))
            k1, k2 = float(cells["k1"]), float(cells["k2"])
            low = 1 + (k1 + k2) / 2 - math.hypot((k1 - k2) / 2, 1)
            self.assertAlmostEqual(float(cells["lambda1"]), low, delta=1e-12)
            self.assertAlmostEqual(float(cells["ratio1:b/a"]), k1 + 1 - low, delta=1e-12)

    def test_they_can_be_predicted(self):
        header, rows = self.simulated()
        self.table(header, rows)
        self.write("study.toml", self.text + '\n[predict]\neigenvalues = [1]\nshape_ratios = [{ mode = 1, dofs = ["m3", "m1"] }]\n')
        self.assertEqual(self.update()["prediction"]["names"], ["lambda1", "ratio1:m3/m1"])

    def test_wrong_keys_are_refused_with_their_line(self):
        for wrong, said in (("eigenvalues = [1, 9]", "mode 9 is not there"), ("shape_ratios = [{ mode = 1, dofs = [\"m1\"] }]", "two different"),
                            ("shape_ratios = [{ dofs = [\"m1\", \"m2\"] }]", "mode: is missing"),
                            ("shape_ratios = [{ mode = 1, dofs = [\"m1\", \"m7\"] }]", "m7")):
            self.write("study.toml", edited(support.STUDY, ("frequencies = [1, 2, 3]", wrong)))
            ended = self.call("check", "study.toml")
            self.assertEqual(ended.code, 2, (wrong, ended.out))
            self.assertIn(said, ended.err)
            self.assertRegex(ended.err, r"study\.toml:\d+: ")

    def test_a_solution_outside_a_priors_range_is_said_to_be(self):
        uniform = "{{ kind = \"uniform\", lower = {}, upper = {} }}".format
        self.write("study.toml", edited(support.STUDY, ('target = "spring:k2"', 'target = "spring:k3"')))
        self.write("points.csv", "k1,k2\n1.2,2.2\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "cloud", "--quiet")
        header, rows = read_csv(self.folder / "cloud" / "cloud.csv")
        self.table(["f1", "f2", "f3"], [[float(rows[0][header.index(name)]) for name in ("f1", "f2", "f3")]])
        text = (self.folder / "study.toml").read_text(encoding="utf-8")
        ranges = iter((uniform(0.5, 1.8), uniform(1.4, 2.8)))
        text = re.sub(r"distribution = \{[^}]*\}", lambda _: "distribution = " + next(ranges), text)
        self.write("study.toml", text)
        self.succeed("update", "study.toml", "--out", "out", "--quiet", "--set", 'update.method="deterministic"', "--set",
                     'update.deterministic.regularisation="none"', "--set", "update.samples=50", "--set", "update.deterministic.starts=20")
        reasons = " ".join(read_result(self.folder / "out")["verdict"]["reasons"])
        self.assertIn("k1 lies outside the range of its prior, [0.5, 1.8]", reasons)

    def test_the_deterministic_method_names_solutions_and_local_minima(self):
        # Masses 1 and 3 hang alike: their springs exchanged give the same frequencies.
        self.write("study.toml", edited(support.STUDY, ('target = "spring:k2"', 'target = "spring:k3"')))
        self.write("points.csv", "k1,k2\n1.2,2.2\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "cloud", "--quiet")
        header, rows = read_csv(self.folder / "cloud" / "cloud.csv")
        self.table(["f1", "f2", "f3"], [[float(rows[0][header.index(name)]) for name in ("f1", "f2", "f3")]])
        self.succeed("update", "study.toml", "--out", "out", "--quiet", "--set", 'update.method="deterministic"', "--set",
                     'update.deterministic.regularisation="none"', "--set", "parameter.k2.distribution.mean=1.6", "--set", "update.samples=50", "--set", "update.deterministic.starts=20")
        result = read_result(self.folder / "out")
        self.assertIn("better_solution", result)
        self.assertEqual(result["options"]["starts"], 20)
        mean = result["parameters"]["mean"]
        self.assertAlmostEqual(sum(mean), 3.4, delta=0.003)
        self.assertEqual(len(result["other_solutions"]), 1)
        for other, own in zip(result["other_solutions"][0], reversed(mean)):
            self.assertAlmostEqual(other, own, delta=0.003)  # both iterations end at steps of 0.001 of 0.3
        self.assertIn("Other parameters explain the mean of the tests equally well", " ".join(result["verdict"]["reasons"]))


if __name__ == "__main__":
    support.main()
