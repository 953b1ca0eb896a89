"""What a file of tests may get wrong: signs, units, order, header, empty rows. Each is put right, or refused, or said.

    python3 mistakes_test.py PATH_TO_MOTTLE
"""

import math
import unittest

import support
from support import edited, read_csv, read_result

SHAPES = ("frequencies = [1, 2, 3]", 'frequencies = [1, 2, 3]\nshapes = { modes = [1, 2], dofs = ["m1", "m2", "m3"] }')
ROWS = [[float(cell) for cell in line.split(",")] for line in support.TESTS.splitlines()[1:]]
# Rows of frequencies and of the shapes of modes 1 and 2 of the same three masses, simulated by examples/01-three-masses.
WITH_SHAPES = (support.THREE_MASSES / "specimens-shapes.csv").read_text(encoding="utf-8").splitlines()


class MistakesTest(support.CommandTest):
    """One claim a test."""

    def table(self, rows, header="f1,f2,f3"):
        lines = [row if isinstance(row, str) else ",".join(map(repr, row)) for row in rows]
        self.write("tests.csv", "\n".join(([header] if header else []) + lines) + "\n")

    def check(self):
        return " ".join(self.succeed("check", "study.toml").out.split())  # notes stand on several lines

    def refused(self):
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2, ended.out)
        return ended.err

    def shapes(self, change):
        """The specimens with shapes, each row changed by change(number from 1, values)."""
        self.write("study.toml", edited(support.STUDY, SHAPES))
        rows = [[float(cell) for cell in line.split(",")] for line in WITH_SHAPES[1:]]
        for number, row in enumerate(rows, 1):
            change(number, row)
        self.table(rows, WITH_SHAPES[0])

    def updated(self, folder):
        self.succeed("update", "study.toml", "--out", folder, "--quiet", "--set", "update.samples=50",
                     "--set", 'update.method="maximum-likelihood"')
        return read_result(self.folder / folder)

    # --- empty rows ---

    def test_specimens_are_numbered_by_the_rows_of_the_file_wherever_they_are_named(self):
        odd = [1.7 * value for value in ROWS[4]]
        self.table([ROWS[0], ",,", ROWS[1], "", ROWS[2], "nan,nan,nan", "# a remark", odd, ROWS[3], ROWS[5]])
        result = self.updated("out")
        self.assertEqual(result["specimens"]["numbers"], [1, 3, 5, 7, 8, 9])
        self.assertEqual([outlier["specimen"] for outlier in result["outliers"]], [7])
        self.assertIn("Specimen 7 lies", " ".join(result["verdict"]["reasons"]))
        self.assertIn("left out, 2: specimen 2, 6", " ".join(result["notes"]))
        header, rows = read_csv(self.folder / "out" / "tests.csv")
        self.assertEqual([row[header.index("specimen")] for row in rows], ["1", "3", "5", "7", "8", "9"])

    def test_the_tests_that_an_update_wrote_keep_their_numbers(self):
        self.table([ROWS[0], ",,", *ROWS[1:]])
        first = self.updated("out")
        (self.folder / "out" / "tests.csv").rename(self.folder / "tests.csv")
        again = self.updated("again")
        self.assertEqual(again["specimens"]["numbers"], [1, 3, 4, 5, 6, 7])
        self.assertEqual(again["parameters"]["mean"], first["parameters"]["mean"])

    def test_a_specimen_is_chosen_by_its_row(self):
        self.table([",,", *ROWS])
        choose = ("--set", 'update.method="deterministic"', "--set", "update.deterministic.specimen=%d")
        for specimen, code in ((2, 0), (7, 0), (1, 2), (8, 2)):
            ended = self.call("check", "study.toml", *(word.replace("%d", str(specimen)) for word in choose))
            self.assertEqual(ended.code, code, (specimen, ended.err))
        self.assertIn("the tests have 2 to 7", ended.err)

    # --- units ---

    def test_a_column_that_says_rad_s_is_refused_with_the_factor(self):
        for title in ("f2 [rad/s]", "f2_rad/s", "f2 (rad/s)"):
            self.table([[f1, 2 * math.pi * f2, f3] for f1, f2, f3 in ROWS], f"f1,{title},f3")
            self.assertIn("divide it by 2 pi", self.refused(), title)

    def test_all_columns_in_another_unit_are_refused(self):
        for factor, name in ((2 * math.pi, "2 pi"), (60.0, "60"), (0.001, "1/1000")):
            self.table([[factor * value for value in row] for row in ROWS])
            self.assertIn(f"factor is near {name}", self.refused())

    def test_one_column_in_another_unit_is_said(self):
        self.table([[f1, 2 * math.pi * f2, f3] for f1, f2, f3 in ROWS])
        self.assertRegex(self.check(), r"warning: Columns that are farther from the model .*f2 \(\d")

    def test_one_specimen_in_another_unit_is_said_with_the_unit(self):
        self.table([row if k != 3 else [2 * math.pi * value for value in row] for k, row in enumerate(ROWS)])
        self.assertRegex(self.check(), r"warning: Frequencies far from those of the other specimens.*"
                                       r"f1 of specimen 4 \(\S+ times, as in rad/s\)")

    def test_what_is_doubtful_is_a_warning_of_the_update_and_stands_in_its_result(self):
        self.table([row if k != 3 else [f2, f1, f3] for k, row in enumerate(ROWS) for f1, f2, f3 in [row]])
        ended = self.succeed("update", "study.toml", "--out", "out", "--set", "update.samples=50")
        self.assertIn("warning: The model counts its modes by frequency", ended.err)
        self.assertIn("specimen 4 (f1 > f2)", " ".join(read_result(self.folder / "out")["notes"]))

    def test_good_tests_raise_no_warning(self):
        self.assertNotIn("warning", self.check())
        self.shapes(lambda number, row: None)
        self.assertNotIn("warning", self.check())

    # --- order ---

    def test_parameters_that_move_no_output_are_refused(self):
        self.write("flat.csv", "f1\n5.03\n5.04\n5.02\n5.05\n")
        self.write("flat.toml", '''
[model]
kind = "mass-spring"
masses = { m1 = 1.0, m2 = 1.0 }
springs = [{ name = "a", between = ["ground", "m1"], stiffness = 1000.0 }, { name = "b", between = ["ground", "m2"], stiffness = 5000.0 }]
[[parameter]]
name = "k"
target = "spring:b"
distribution = { kind = "normal", mean = 5000.0, std = 100.0 }
[outputs]
frequencies = [1]
[test]
file = "flat.csv"
repeatability = { f1 = 0.01 }
''')
        ended = self.call("update", "flat.toml", "--out", "out")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("no parameter moves any of them", ended.err)

    def test_columns_may_be_in_any_order(self):
        expected = self.updated("out")["parameters"]["mean"]
        self.table([[f3, f1, f2] for f1, f2, f3 in ROWS], "f3,f1,f2")
        self.assertEqual(self.updated("again")["parameters"]["mean"], expected)

    def test_columns_under_one_anothers_names_are_said(self):
        self.table([[f2, f1, f3] for f1, f2, f3 in ROWS])
        out = self.check()
        self.assertIn("the frequencies of 6 of 6 specimens do not ascend so", out)
        self.assertIn('test.pairing = "frequency" finds it', out)

    # --- header ---

    def test_a_table_of_shapes_without_header_is_asked_for_the_names(self):
        self.shapes(lambda number, row: None)
        self.table(WITH_SHAPES[1:], None)
        self.assertIn("names its 9 columns: f1, f2, phi1:m1", self.refused())

    # --- signs ---

    def test_a_mode_that_is_upside_down_in_one_row_is_turned(self):
        self.shapes(lambda number, row: None)
        expected = self.updated("out")["parameters"]["mean"]

        def turn(number, row):
            if number == 3:
                row[3:6] = [-value for value in row[3:6]]

        self.shapes(turn)
        self.assertIn("are turned, 1: specimen 3 mode 1", self.check())
        self.assertEqual(self.updated("again")["parameters"]["mean"], expected)

    def test_a_sensor_that_is_upside_down_in_all_rows_is_said(self):
        def turn(number, row):
            row[4], row[7] = -row[4], -row[7]

        self.shapes(turn)
        out = self.check()
        self.assertIn("warning: Shapes that are unlike the model's", out)
        self.assertIn("With the other sign of m2 they are alike", out)

    def test_a_component_with_a_wrong_sign_in_one_row_is_said(self):
        def turn(number, row):
            if number == 5:
                row[4] = -row[4]

        self.shapes(turn)
        self.assertRegex(self.check(), r"used as they stand: specimen 5 mode 1 \(MAC 0\.\d+\)")


if __name__ == "__main__":
    support.main()
