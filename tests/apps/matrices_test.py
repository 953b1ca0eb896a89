"""Studies on matrices from files: numbers against a closed form, messages, paths that hold after a move.

    python3 matrices_test.py PATH_TO_MOTTLE
"""

import json
import math
import unittest

import support
from support import edited, read_csv

MASSES = 40  # a chain fixed at one end: omega_r = 2 sqrt(k / m) sin((2 r - 1) pi / (4 n + 2))


def market(entries, size=MASSES):
    lines = [f"{i} {j} {value!r}" for i, j, value in entries]
    return "\n".join(["%%MatrixMarket matrix coordinate real symmetric", f"{size} {size} {len(lines)}", *lines]) + "\n"


def spring(k):
    """Between mass k and k + 1; spring 0 holds the first mass."""
    return [(1, 1, 1.0)] if k == 0 else [(k, k, 1.0), (k + 1, k, -1.0), (k + 1, k + 1, 1.0)]


def added(springs):
    total = {}
    for i, j, value in (entry for k in springs for entry in spring(k)):
        total[i, j] = total.get((i, j), 0.0) + value
    return [(i, j, value) for (i, j), value in sorted(total.items(), key=lambda item: (item[0][1], item[0][0]))]


def closed_form(mode, ratio=1.0):
    return math.sqrt(ratio) * 2 * math.sin((2 * mode - 1) * math.pi / (4 * MASSES + 2)) / (2 * math.pi)


STUDY = """\
[model]
kind = "matrices"
mass = "data/M.mtx"
degrees_of_freedom = "data/names.dof"
terms = [
  { name = "near", stiffness = "data/K1.mtx", nominal = 2.0 },
  { name = "far", stiffness = "data/K2.mtx", nominal = 2.0 },
]
[[parameter]]
name = "k"
target = ["K:near", "K:far"]
distribution = { kind = "normal", mean = 2.0, std = 0.1 }
[outputs]
frequencies = [1, 2]
shapes = { modes = [1], dofs = ["40:+X"] }
[update]
samples = 40
"""


class MatricesTest(support.CommandTest):
    def setUp(self):
        super().setUp()
        self.write("data/K1.mtx", market(added(range(20))))
        self.write("data/K2.mtx", market(added(range(20, MASSES))))
        self.write("data/M.mtx", market([(k, k, 1.0) for k in range(1, MASSES + 1)]))
        self.write("data/names.dof", "".join(f"{k}.1\n" for k in range(1, MASSES + 1)))
        self.write("study.toml", STUDY)

    def test_check_finds_the_closed_form_and_the_mass(self):
        result = json.loads(self.succeed("check", "study.toml", "--json").out)
        for mode in (1, 2):
            self.assertAlmostEqual(result["frequencies"][mode - 1], closed_form(mode), delta=1e-12)
        self.assertAlmostEqual(result["total_mass"], MASSES, delta=1e-12)

    def test_parameters_scale_the_parts_from_their_nominal_value(self):
        self.write("points.csv", "k\n2.0\n8.0\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out")
        header, rows = read_csv(self.folder / "out" / "cloud.csv")
        for row, ratio in zip(rows, (1.0, 4.0)):
            self.assertAlmostEqual(float(row[header.index("f1")]), closed_form(1, ratio), delta=1e-12)
        tip = [float(row[header.index("phi1:40:+X")]) for row in rows]
        self.assertAlmostEqual(tip[0], tip[1], delta=1e-12)

    def test_a_last_number_that_may_be_cut_short_is_told(self):
        self.assertNotIn("has no end", self.succeed("check", "study.toml").out)
        file = self.folder / "data" / "K2.mtx"
        file.write_bytes(file.read_bytes().rstrip())
        self.assertIn("K2.mtx: its last line has no end", self.succeed("check", "study.toml").out)

    def test_the_study_in_the_results_finds_the_matrices(self):
        self.succeed("propagate", "study.toml", "--out", "elsewhere/out")
        self.succeed("check", "elsewhere/out/study.toml")

    def test_faults_are_told_with_file_and_line(self):
        for change, phrases in (
                (("K2.mtx", "K3.mtx"), ("data/K3.mtx", "no such file")),
                (('"K:far"', '"K:fra"'), ("study.toml:", "did you mean 'K:far'?")),
                (("40:+X", "41:+X"), ("study.toml:", "have no row '41:+X'")),
                (('mass = "data/M.mtx"\n', ""), ("there is no mass matrix",)),
                (("nominal = 2.0 },\n]", "nominal = -2.0 },\n]"), ("study.toml:", "nominal")),
                (("nominal = 2.0 },\n]", "exponent = 0 },\n]"), ("study.toml:", "exponent"))):
            self.write("other.toml", edited(STUDY, change))
            ended = self.call("check", "other.toml")
            self.assertEqual(ended.code, 2, ended.out)
            for phrase in phrases:
                self.assertIn(phrase, ended.err.replace("other.toml", "study.toml"))
        self.write("data/K1.mtx", "%%MatrixMarket matrix coordinate real symmetric\n40 40 1\n41 1 1.0\n")
        self.assertIn("K1.mtx:3: entry (41, 1) is outside", self.call("check", "study.toml").err)

    def test_samples_with_an_indefinite_mass_fail_and_name_the_row(self):
        # The last ten masses are 1 - 0.8 m: negative above m = 1.25.
        self.write("data/M1.mtx", market([(k, k, 0.2 if k <= 30 else -0.8) for k in range(1, MASSES + 1)]))
        moved = edited(STUDY, ('nominal = 2.0 },\n]', 'nominal = 2.0 },\n  { name = "moved", mass = "data/M1.mtx" },\n]'),
                       ("[outputs]", '[[parameter]]\nname = "m"\ntarget = "M:moved"\n'
                        'distribution = { kind = "uniform", lower = 0.1, upper = 1.6 }\n[outputs]'))
        self.write("moved.toml", moved)
        self.write("points.csv", "k,m\n2.0,0.5\n2.0,1.2\n2.0,1.3\n2.0,1.5\n" + 4 * "2.0,1.0\n")
        self.succeed("propagate", "moved.toml", "--points", "points.csv", "--out", "out")
        header, rows = read_csv(self.folder / "out" / "cloud.csv")
        status = [row[header.index("status")] for row in rows]
        self.assertEqual(status[:2], ["ok", "ok"])
        for text, value in zip(status[2:4], ("-0.04", "-0.2")):
            self.assertEqual(text, f"the mass matrix is not positive semidefinite: the diagonal entry of row 31:+X is {value}")
        self.assertEqual([row[header.index("f1")] for row in rows[2:4]], ["", ""])
        self.write("moved.toml", edited(moved, ("lower = 0.1", "lower = 1.4")))  # mean 1.5
        ended = self.call("check", "moved.toml")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("the diagonal entry of row 31:+X is -0.2", ended.err)


if __name__ == "__main__":
    support.main()
