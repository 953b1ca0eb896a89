"""Tables of tests without shapes: test.pairing = "frequency", tables without header, and what is said of doubtful numbers.

    python3 pairing_test.py PATH_TO_MOTTLE
"""

import unittest

import support

FREQUENCY = ('file = "tests.csv"\n', 'file = "tests.csv"\npairing = "frequency"\n')


OSCILLATORS = """\
SOL 103
CEND
METHOD = 10
BEGIN BULK
EIGRL,10,,,4
SPOINT,1,2,3,4
CELAS2,1,1000.,1
CELAS2,2,3000.,2
CELAS2,3,9000.,3
CELAS2,4,15791.,4
CMASS2,5,1.,1
CMASS2,6,1.,2
CMASS2,7,1.,3
CMASS2,8,1.,4
ENDDATA
"""
OSCILLATORS_STUDY = """\
[model]
kind = "nastran"
file = "model.bdf"
[[parameter]]
name = "k3"
target = "CELAS2:3:K"
distribution = { kind = "normal", mean = MEAN, std = 300 }
[outputs]
frequencies = [1, 2, 3]
[test]
file = "tests.csv"
"""


class PairingTest(support.CommandTest):
    def rearrange(self, header, columns):
        """tests.csv with the columns (of f1, f2, f3) in another order and under other names."""
        rows = [row.split(",") for row in support.TESTS.splitlines()[1:]]
        lines = [",".join(row[column] for column in columns) for row in rows]
        self.write("tests.csv", "\n".join(([header] if header else []) + lines) + "\n")

    def results(self):
        self.succeed("update", "study.toml", "--quiet")
        result = support.read_result(self.folder / "study.mottle")
        return result["parameters"]["mean"], result["parameters"]["std"]

    def test_columns_in_another_order_and_numbering_give_the_same_numbers(self):
        expected = self.results()
        self.write("study.toml", support.edited(support.STUDY, FREQUENCY))
        for header, columns in (("f1,f2,f3", [0, 1, 2]), ("f3_Hz,f9 [Hz],f12", [0, 1, 2]), ("f7,f2,f5", [2, 0, 1]),
                                (None, [0, 1, 2]), (None, [1, 2, 0])):
            self.rearrange(header, columns)
            self.assertEqual(self.results(), expected, (header, columns))

    def test_the_pairs_are_said(self):
        self.write("study.toml", support.edited(support.STUDY, FREQUENCY))
        self.rearrange("f4,f5,f6", [0, 1, 2])
        self.assertRegex(self.succeed("check", "study.toml").out, r"f4 is the model's f1 \([+-]\d+\.\d %\)")

    def test_a_mode_that_the_tests_missed_is_passed_over(self):
        self.write("study.toml", support.edited(support.STUDY, FREQUENCY, ("frequencies = [1, 2, 3]", "frequencies = [1, 3]")))
        self.rearrange("f1,f2", [0, 2])
        self.assertIn("f2 is the model's f3", self.succeed("check", "study.toml").out)

    def test_unused_modes_have_the_names_that_the_tests_gave_them(self):
        self.write("study.toml", support.edited(support.STUDY, FREQUENCY, ("frequencies = [1, 2, 3]", "frequencies = [1, 3]")))
        self.rearrange("f4,f5,f6", [0, 1, 2])
        said = self.succeed("check", "study.toml").out
        self.assertIn("not used, by the tests' own numbers: f5.", said)
        self.assertNotIn("Columns of the test file that are not used", said)

    def test_an_output_without_partner_is_refused(self):
        self.write("study.toml", support.edited(support.STUDY, FREQUENCY))
        self.rearrange("f1,f2", [0, 2])
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("output 'f2' has no column", ended.err)

    def test_a_table_without_header_asks_how_its_modes_are_paired(self):
        self.rearrange(None, [0, 1, 2])
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("tests.csv:1: has no line with the names of the columns", ended.err)
        self.assertIn('pairing = "frequency"', ended.err)
        self.write("study.toml", support.edited(support.STUDY, ('file = "tests.csv"\n', 'file = "tests.csv"\npairing = "order"\n')))
        self.succeed("check", "study.toml")

    def test_numbers_that_frequencies_contradict_are_noted(self):
        # Each column is more than 15 % away from the mode of its number and near the next one.
        self.write("study.toml", support.edited(support.STUDY, ("frequencies = [1, 2, 3]", "frequencies = [1, 2]")))
        self.rearrange("f1,f2", [1, 2])
        self.assertIn("outputs.frequencies = [2, 3] with test.pairing = \"frequency\" takes them so",
                      " ".join(self.succeed("check", "study.toml").out.split()))
        self.write("study.toml", support.edited(support.STUDY, FREQUENCY, ("frequencies = [1, 2, 3]", "frequencies = [2, 3]")))
        self.succeed("check", "study.toml")

    def check_oscillators(self, mean, tests, *changes):
        """What `check` says of four oscillators of 5.033, 8.717, 15.099 and 20.000 Hz in the deck, the third of k3."""
        self.write("model.bdf", OSCILLATORS)
        self.write("tests.csv", tests)
        self.write("study.toml", support.edited(OSCILLATORS_STUDY.replace("MEAN", str(mean)), *changes))
        return " ".join(self.succeed("check", "study.toml").out.split())

    def test_numbers_are_not_doubted_where_the_prior_means_agree(self):
        # 18.12 Hz is nearer to the deck's fourth mode; with the prior's mean of k3 the third has 18.118 Hz.
        tests = "f1,f2,f3\n5.03,8.72,18.12\n5.035,8.725,18.2\n5.025,8.715,18.05\n"
        self.assertNotIn("Columns of the tests", self.check_oscillators(12960, tests))
        self.assertIn("By frequency f3 (18.12 Hz) is mode 4 (20), not 3 (15.1).", self.check_oscillators(9000, tests))

    def test_only_columns_that_differ_are_named_and_the_advice_works(self):
        tests = "f1,f2,f3\n5.03,8.72,20.1\n5.035,8.725,20.2\n5.025,8.715,20.05\n"
        said = self.check_oscillators(9000, tests)
        self.assertIn("By frequency f3 (20.12 Hz) is mode 4 (20), not 3 (15.1). outputs.frequencies = [1, 2, 4] with "
                      'test.pairing = "frequency" takes them so', said)
        said = self.check_oscillators(9000, tests, FREQUENCY, ("[1, 2, 3]", "[1, 2, 4]"))
        self.assertIn("f3 is the model's f4", said)
        permuted = tests.replace("f1,f2,f3", "f1,f3,f2").replace("20.", "15.")
        self.assertIn('test.pairing = "frequency" pairs them so', self.check_oscillators(9000, permuted))
        self.assertIn("f2 is the model's f3", self.check_oscillators(9000, permuted, FREQUENCY))

    def test_rows_of_one_specimen_and_copies_of_rows_are_named(self):
        header, *rows = support.TESTS.splitlines()
        numbered = [f"{1 + k // 2},{row}" for k, row in enumerate(rows)]
        self.write("tests.csv", "\n".join(["specimen," + header, *numbered]) + "\n")
        said = " ".join(self.succeed("check", "study.toml").out.split())
        self.assertIn("a specimen of its own: 1 in 2 rows, 2 in 2 rows, 3 in 2 rows.", said)
        self.assertNotIn("as copies do", said)
        # A gap is equal to a gap, 0.30800 to 0.308; a row with one value tells nothing.
        self.write("tests.csv", "\n".join([header, *rows, "0.16,0.308,", "0.16,0.30800,", rows[1], "0.161,,", "0.161,,"]) + "\n")
        said = " ".join(self.succeed("check", "study.toml").out.split())
        self.assertIn("as copies do: specimen 8 equals 7, specimen 9 equals 2. Each", said)
        self.assertIn("as copies do: specimen 8 equals 7", self.call("update", "study.toml").err)
        report = (self.folder / "study.mottle" / "report.html").read_text(encoding="utf-8")
        self.assertIn("specimen 9 equals 2", report)

    def test_equal_values_have_no_scatter(self):
        row = "0.1655,0.31,0.4484"  # the mean of three of these is not quite the number itself
        self.write("tests.csv", f"f1,f2,f3\n{row}\n{row}\n{row}\n")
        said = self.succeed("check", "study.toml", "--set", 'update.method="deterministic"').out
        for line in said.splitlines():
            if line.startswith(("f1 ", "f2 ", "f3 ")):
                self.assertEqual(line.split()[5], "0", line)

    def test_tests_in_another_unit_are_not_paired_with_other_modes(self):
        self.write("study.toml", support.edited(support.STUDY, FREQUENCY))
        for factor, unit in ((6.283185307179586, "rad/s"), (60.0, "1/min"), (0.001, "kHz")):
            rows = [[factor * float(cell) for cell in row.split(",")] for row in support.TESTS.splitlines()[1:]]
            self.write("tests.csv", "f1,f2,f3\n" + "".join(",".join(map(repr, row)) + "\n" for row in rows))
            ended = self.call("check", "study.toml")
            self.assertEqual(ended.code, 2, ended.out)
            self.assertIn(f"({unit})", ended.err)

    def test_shapes_are_paired_by_shape(self):
        self.write("study.toml", support.edited(
            support.STUDY, FREQUENCY, ("frequencies = [1, 2, 3]", 'frequencies = [1]\nshapes = { modes = [1], dofs = ["m1", "m2"] }')))
        self.write("tests.csv", "f1,phi1:m1,phi1:m2\n0.16,0.5,0.6\n0.17,0.5,0.6\n")
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn('say "mac"', ended.err)


if __name__ == "__main__":
    support.main()
