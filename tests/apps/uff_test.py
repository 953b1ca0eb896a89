"""Tests that come as modes: universal files, CSV tables of shapes, MATLAB files; on examples/05-uff-population.

    python3 uff_test.py PATH_TO_MOTTLE
"""

import importlib.util
import shutil
import unittest

import support
from support import SOURCE, edited, line_of, read_csv

AIRFRAME, EXAMPLE = SOURCE / "examples" / "02-airframe", SOURCE / "examples" / "05-uff-population"
SHAPES = 'shapes = { modes = [7, 9, 11, 14], dofs = ["11:+X", "11:+Z", "111:+X", "111:+Z", "205:+Y"] }'
STUDY = (EXAMPLE / "study.toml").read_text(encoding="utf-8")
# Only the values of the tests are looked at: the cheapest update that writes them.
CHEAP = '\n[update]\nmethod = "deterministic"\nsamples = 10\niterations = 1\n'


CHAIN_STUDY = """\
[model]
kind = "nastran"
file = "chain.bdf"
[[parameter]]
name = "k2"
target = "CELAS2:2:K"
distribution = { kind = "normal", mean = 1500, std = 50 }
[outputs]
frequencies = [1, 2, 3]
shapes = { modes = [1, 2], dofs = ["1:+X", "2:+X", "3:+X"] }
[test]
file = "chain-*.uff"
"""


def example_module(folder):
    spec = importlib.util.spec_from_file_location("make_files", folder / "make_files.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class TestsAsModes(support.CommandTest):
    def setUp(self):
        super().setUp()
        (self.folder / "02-airframe").mkdir()
        shutil.copy(AIRFRAME / "airframe.bdf", self.folder / "02-airframe")
        self.home = self.folder / "05"
        shutil.copytree(EXAMPLE, self.home, ignore=shutil.ignore_patterns("*.mottle"))

    def study(self, *changes):
        self.write("05/study.toml", edited(STUDY, *changes) + CHEAP)

    def values_of_tests(self):
        """Column -> values of the tests as the update used them."""
        self.succeed("update", "05/study.toml", "--out", "out", "--quiet")
        header, rows = read_csv(self.folder / "out" / "tests.csv")
        return {name: [row[k] for row in rows] for k, name in enumerate(header) if name != "specimen"}

    def pairing(self):
        header, rows = read_csv(self.folder / "out" / "pairing.csv")
        return [dict(zip(header, row)) for row in rows]

    def test_every_habit_of_a_file_gives_the_frequencies_and_shapes_that_were_drawn(self):
        self.succeed("simulate", "05/truth.toml", "--out", "05/truth.mottle", "--quiet")
        example_module(self.home).main()
        self.study(("frequencies = [7,", SHAPES + "\nfrequencies = [7,"), ('"f*" = "0.1 %"', '"f*" = "0.1 %"\n"phi*" = 0.01'))
        used = self.values_of_tests()
        header, rows = read_csv(self.home / "truth.mottle" / "specimens.csv")
        compared = 0
        for name, values in used.items():
            for specimen, (value, row) in enumerate(zip(values, rows), 1):
                true = float(row[header.index(name)])
                is_missing = specimen == 3 and (name == "f9" or name.startswith("phi9:"))
                if is_missing or (specimen == 6 and name.startswith("phi")):  # without modal mass
                    self.assertEqual(value, "", name)
                    continue
                # Six digits of the largest component. The complex file turns each sensor by 0.03 sin(node) besides the
                # common phase, of which the real part is left.
                tolerance = {4: 2e-3}.get(specimen, 2e-5) if name.startswith("phi") else 1e-5 * true
                self.assertLess(abs(float(value) - true), tolerance, f"{name} of specimen {specimen}")
                compared += 1
        self.assertEqual(compared, 10 * 29 - 6 - 20)

    def test_shapes_of_free_size_have_the_ratios_that_were_drawn(self):
        self.succeed("simulate", "05/truth.toml", "--out", "05/truth.mottle", "--quiet")
        example_module(self.home).main()
        self.study(("frequencies = [7,", SHAPES.replace("] }", '], size = "free" }') + "\nfrequencies = [7,"), ('"f*" = "0.1 %"', '"f*" = "0.1 %"\n"phi*" = 0.01'))
        used = self.values_of_tests()
        header, rows = read_csv(self.home / "truth.mottle" / "specimens.csv")
        compared = 0
        for specimen, row in enumerate(rows):
            for mode in (7, 9, 11, 14):
                if (specimen, mode) == (2, 9):
                    continue  # a mode that was not found
                names = [name for name in used if name.startswith(f"phi{mode}:")]
                found, drawn = ([float(numbers) for numbers in shape] for shape in
                                ([used[name][specimen] for name in names], [row[header.index(name)] for name in names]))
                largest = max(range(len(names)), key=lambda k: abs(drawn[k]), default=0)
                for one, other in zip(found, drawn):
                    # Six digits of the largest component, which is not among these. The complex file turns each sensor by
                    # 0.03 sin(node) besides the common phase, of which the real part is left.
                    tolerance = {3: 5e-3}.get(specimen, 2e-4)
                    self.assertLess(abs(one / found[largest] - other / drawn[largest]), tolerance, f"{names} of {specimen + 1}")
                    compared += 1
        self.assertEqual(compared, 10 * 16 - 4)

    def test_the_files_of_the_example_are_paired_without_a_doubt(self):
        self.study()
        self.values_of_tests()
        rows = self.pairing()
        kinds = {kind: [row for row in rows if row["verdict"] == kind] for kind in ("paired", "missing", "doubtful", "left out")}
        self.assertEqual({kind: len(found) for kind, found in kinds.items()},
                         {"paired": 89, "missing": 1, "doubtful": 0, "left out": 10})
        self.assertEqual((kinds["missing"][0]["specimen"], kinds["missing"][0]["mode"]), ("3", "9"))
        self.assertTrue(all(row["mode"] == "13" for row in kinds["left out"]))
        self.assertTrue(all(float(row["mac"]) > 0.98 for row in kinds["paired"]))
        other_order = [row["test_mode"] for row in kinds["paired"] if row["specimen"] == "5"]
        self.assertEqual(other_order, ["6", "1", "7", "2", "8", "3", "4", "10", "5"])
        self.assertIn("Modes that were not found: specimen 3 mode 9.", (self.folder / "out" / "mottle.log").read_text(encoding="utf-8"))

    def test_modes_that_were_written_are_the_models_when_read_again(self):
        self.succeed("modes", "02-airframe/airframe.bdf", "--modes", "16", "--uff", "--out", "modes", "--quiet")
        self.study(('file = "specimens" ', 'file = "../modes/modes.uff" '), ("frequencies = [7,", SHAPES + "\nfrequencies = [7,"))
        used = self.values_of_tests()
        self.assertEqual({row["verdict"] for row in self.pairing() if int(row["mode"]) in range(7, 17) and row["mode"] != "13"}, {"paired"})
        self.assertTrue(all(float(row["mac"]) > 1 - 1e-9 for row in self.pairing() if row["verdict"] == "paired"))
        _, modes = read_csv(self.folder / "modes" / "modes.csv")
        self.assertLess(abs(float(used["f9"][0]) / float(modes[8][1]) - 1), 1e-5)

    def test_variables_of_a_matlab_file_are_a_table_or_modes(self):
        folder = SOURCE / "tests" / "formats" / "mat"
        system = edited(support.STUDY, ('file = "tests.csv"', f'file = "{folder}/octave-v4.mat"'), ("[1, 2, 3]", "[1, 2]"))
        self.write("study.toml", system)
        self.assertIn("f1 10.62 against 0.2027 Hz, f2 20.25 against", self.call("check", "study.toml").err)
        self.write("study.toml", edited(system, ("octave-v4", "scipy-v7")))
        out = self.succeed("check", "study.toml", "--set", "outputs.frequencies=[1]", "--set",
                           'update.method="maximum-likelihood"').out
        self.assertIn("tests: 2 specimens of 1 outputs", out)
        self.assertIn("Measured components that the model does not have: 2 of specimen 1", out)

    def test_lists_and_patterns_name_specimens(self):
        self.study(('file = "specimens" ', 'file = ["specimens/*-0[2].uff"] '))
        self.assertIn("no file fits this pattern", self.call("check", "05/study.toml").err)
        self.study(('file = "specimens" ', 'file = ["specimens/*-0?.uff", "specimens/aeroplane-10.uff"] '))
        self.assertIn("tests: 10 specimens of 9 outputs", self.succeed("check", "05/study.toml").out)

    def test_a_study_in_other_units_gets_the_same_shapes(self):
        self.study(("frequencies = [7,", SHAPES + "\nfrequencies = [7,"), ('"f*" = "0.1 %"', '"f*" = "0.1 %"\n"phi*" = 0.01'),
                   ('units = "SI"', 'units = "mm-t-s"'))
        tonnes = self.values_of_tests()
        self.study(("frequencies = [7,", SHAPES + "\nfrequencies = [7,"), ('"f*" = "0.1 %"', '"f*" = "0.1 %"\n"phi*" = 0.01'))
        kilograms = self.values_of_tests()
        for small, large in zip(kilograms["phi9:11:+Z"], tonnes["phi9:11:+Z"]):
            if small and abs(abs(float(large) / float(small)) - 1) > 1e-9:  # 1: no modal mass, scaled to the model's
                self.assertAlmostEqual(abs(float(large) / float(small)), 1000**0.5, places=6)
        self.assertEqual(kilograms["f9"], tonnes["f9"])

    def test_tables_of_shapes_a_specimen_a_file(self):
        shutil.copy(AIRFRAME / "shapes-test.csv", self.home / "a.csv")
        table = (AIRFRAME / "shapes-test.csv").read_text(encoding="utf-8")
        # The accelerometer of the second specimen hung upside down and says so by its name.
        row = next(line for line in table.splitlines() if line.startswith("11:+Z"))
        turned = "11:-Z," + ",".join(str(-float(value)) for value in row.split(",")[1:])
        self.write("05/b.csv", table.replace(row, turned))
        self.study(('file = "specimens" ', 'file = ["a.csv", "b.csv"] '))
        used = self.values_of_tests()
        self.assertEqual(used["f7"], ["5.99", "5.99"])
        macs = {row["mode"]: [] for row in self.pairing()}
        for row in self.pairing():
            macs[row["mode"]].append(row["mac"])
        self.assertTrue(all(first == second for first, second in macs.values()), macs)

    def test_a_file_that_was_copied_is_named(self):
        shutil.copy(self.home / "specimens" / "aeroplane-02.uff", self.home / "specimens" / "aeroplane-2b.uff")
        self.study()
        said = " ".join(self.succeed("check", "05/study.toml").out.split())
        self.assertIn("as copies do: specimen 11 (aeroplane-2b.uff) equals 2 (aeroplane-02.uff).", said)

    def refusal_of_chain(self, masses, points):
        """Of a chain of three masses, tested with modal masses by mode at some of its points."""
        shapes = {1: (9.2975, 14.7955, -26.356), 2: (14.637, 11.923, 11.963), 3: (17.97, -18.17, -3.90)}
        for specimen in range(3):
            text = ""
            for mode, frequency in enumerate((1.90, 5.78, 8.98)):
                lines = ["shape", "NONE", "NONE", "NONE", "NONE", f"{1:10d}{2:10d}{2:10d}{8:10d}{2:10d}{3:10d}",
                         f"{2:10d}{4:10d}{1:10d}{mode + 1:10d}", f"{frequency + 0.01 * specimen:13.5E}{masses[mode]:13.5E}{0.01:13.5E}{0.0:13.5E}"]
                for point in points:
                    lines += [f"{point:10d}", f"{shapes[point][mode]:13.5E}{0.0:13.5E}{0.0:13.5E}"]
                text += "    -1\n    55\n" + "\n".join(lines) + "\n    -1\n"
            self.write(f"chain-{specimen}.uff", text)
        self.write("chain.bdf", support.CHAIN)
        self.write("chain.toml", CHAIN_STUDY)
        ended = self.call("check", "chain.toml")
        self.assertEqual(ended.code, 2, ended.out)
        return ended.err

    def test_shapes_without_size_are_told_from_components_that_were_not_measured(self):
        said = self.refusal_of_chain((0.0, 1.0, 1.0), (1, 2, 3))
        self.assertIn("output 'phi1:1:+X' is not used of any specimen: the tests' shapes of mode 1 have no modal mass", said)
        self.assertIn('outputs.shapes.size = "free"', said)
        said = self.refusal_of_chain((1.0, 1.0, 1.0), (1, 2))
        self.assertIn("output 'phi1:3:+X' is never measured", said)

    def test_of_free_shapes_the_component_that_is_missing_is_named(self):
        said = self.refusal_of_chain((0.0, 0.0, 0.0), (1, 2))
        self.assertIn("output 'phi1:1:+X' follows from no specimen", said)
        self.assertIn("and phi1:3:+X is never measured; leave it out of dofs", said)

    def test_a_mistake_in_a_file_is_told_with_its_line(self):
        file = self.home / "specimens" / "aeroplane-01.uff"
        text = file.read_text(encoding="ascii")
        file.write_text(edited(text, (text.splitlines()[-4], "          what")), encoding="ascii")
        ended = self.call("check", "05/study.toml")
        self.assertEqual(ended.code, 2)
        self.assertIn(f"aeroplane-01.uff:{line_of(file.read_text(encoding='ascii'), 'what')}:", ended.err)
        self.assertIn("'what' stands where a number should be", ended.err)

    def test_files_whose_nodes_are_not_the_models_are_refused(self):
        (self.home / "specimens" / "aeroplane-08.uff").unlink()  # dataset 2414: not every number alone on a line is a node
        for file in (self.home / "specimens").glob("*.uff"):
            lines = file.read_text(encoding="ascii").splitlines()
            shifted = [f"{int(line) + 500000:10d}" if line.strip().isdigit() and len(line) == 10 else line for line in lines]
            file.write_text("\n".join(shifted) + "\n", encoding="ascii")
        ended = self.call("check", "05/study.toml")
        self.assertEqual(ended.code, 2)
        self.assertIn("none of its 22 measured degrees of freedom is in the model", ended.err)


if __name__ == "__main__":
    support.main()
