"""Tables of tests without shapes: test.pairing = "frequency", tables without header, and what is said of doubtful numbers.

    python3 pairing_test.py PATH_TO_MOTTLE
"""

import unittest

import support

FREQUENCY = ('file = "tests.csv"\n', 'file = "tests.csv"\npairing = "frequency"\n')


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
        self.assertIn('test.pairing = "frequency" pairs them so', self.succeed("check", "study.toml").out)

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
