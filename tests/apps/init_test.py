"""mottle init: the study that it proposes runs, says what it guessed, and writes over nothing.

    python3 init_test.py PATH_TO_MOTTLE
"""

import json
import os
import pty
import re
import shutil
import subprocess
import unittest

import support

EXAMPLES = support.SOURCE / "examples"
DECK = EXAMPLES / "02-airframe" / "airframe.bdf"
# A cantilever in mm, t, s.
BEAM = """\
SOL 103
CEND
SPC = 1
BEGIN BULK
GRID,1
GRID,2,,500.
GRID,3,,1000.
GRID,4,,1500.
SPC1,1,123456,1
CBAR,1,1,1,2,0.,0.,1.
CBAR,2,1,2,3,0.,0.,1.
CBAR,3,1,3,4,0.,0.,1.
PBARL,1,1,,BAR
,20.,30.
MAT1,1,70000.,,.3,2.7-9
ENDDATA
"""


REPEATED = """\
SOL 103
CEND
METHOD = 10
SPC = 1
BEGIN BULK
EIGRL,10,,,4
GRID,1,,0.,0.,0.
SPC1,1,3456,1
PELAS,1,1000.
PELAS,2,1000.
CELAS1,1,1,1,1
CELAS1,2,2,1,2
CONM2,3,1,,2.
SPOINT,11,12
CELAS2,11,9000.,11
CMASS2,12,1.,11
CELAS2,21,30000.,12
CMASS2,22,1.,12
ENDDATA
"""


class InitTest(support.CommandTest):
    def setUp(self):
        super().setUp()
        os.remove(self.folder / "study.toml")
        shutil.copy(DECK, self.folder)

    def propose(self, *arguments):
        return json.loads(self.succeed("init", *arguments, "--json", timeout=300).out)

    def outputs(self, found):
        return [mode["mode"] for mode in found["modes"] if mode["is_output"]]

    def parameters(self, found):
        return [parameter["target"] for parameter in found["parameters"] if parameter["is_parameter"]]

    def test_universal_files_become_a_study_that_runs(self):
        shutil.copytree(EXAMPLES / "05-uff-population" / "specimens", self.folder / "specimens")
        found = self.propose("airframe.bdf", "specimens", "--out", "s.toml")
        self.assertEqual((found["pairing"], found["specimens"]), ("mac", 10))
        self.assertEqual(self.outputs(found), list(range(7, 17)))  # as truth.toml of the example made them
        for mode in found["modes"]:
            if mode["is_output"]:
                self.assertGreater(mode["mac"], 0.95)
        self.assertLessEqual(len(self.parameters(found)), 5)
        self.assertFalse([note for note in found["notes"] if "does not run" in note])
        self.succeed("check", "s.toml")
        self.succeed("update", "s.toml", "--set", "update.samples=50", "--quiet")
        self.assertEqual(support.read_result(self.folder / "s.mottle")["status"], "converged")

    def test_a_table_is_paired_by_frequency_whatever_its_numbers(self):
        lines = (EXAMPLES / "02-airframe" / "specimens.csv").read_text().splitlines()
        expected = self.propose("airframe.bdf", self.write("a.csv", "\n".join(lines) + "\n"), "--out", "a.toml")
        header = re.sub(r"\bf(\d+)", lambda name: f"f{int(name[1]) - 6}", lines[0])
        again = self.propose("airframe.bdf", self.write("b.csv", "\n".join([header, *lines[1:]]) + "\n"), "--out", "b.toml")
        self.assertEqual(self.outputs(expected), list(range(7, 17)))
        self.assertEqual(self.outputs(again), self.outputs(expected))
        self.assertEqual(self.parameters(again), self.parameters(expected))
        self.succeed("check", "b.toml")

    def test_no_two_parameters_are_one_for_the_outputs(self):
        found = self.propose("airframe.bdf", EXAMPLES / "02-airframe" / "specimens.csv", "--out", "s.toml")
        # Young's modulus and area of one kind of spring-like rod, or mass on either wing, would move the same modes alike.
        self.assertFalse({"CONM2:7001:M", "CONM2:7002:M"} <= set(self.parameters(found)))
        self.assertEqual(len(set(self.parameters(found))), len(self.parameters(found)))

    def test_outputs_and_targets_can_be_named(self):
        found = self.propose("airframe.bdf", EXAMPLES / "02-airframe" / "specimens.csv", "--out", "s.toml",
                             "--outputs", "7,8,10", "--targets", "mat1:1:e,PBUSH:101:K4")
        self.assertEqual(self.outputs(found), [7, 8, 10])
        self.assertEqual(self.parameters(found), ["MAT1:1:E", "PBUSH:101:K4"])
        ended = self.call("init", "airframe.bdf", "--out", "t.toml", "--targets", "MAT1:1:EE")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("did you mean 'MAT1:1:E'?", ended.err)
        ended = self.call("init", "airframe.bdf", "--out", "t.toml", "--outputs", "77")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("mode 77 cannot be an output", ended.err)
        self.assertFalse((self.folder / "t.toml").exists())

    def test_units_are_guessed_and_said_to_be_guessed(self):
        self.write("beam.bdf", BEAM)
        found = self.propose("beam.bdf")
        self.assertEqual(found["units"], "mm-t-s")
        self.assertIn('units = "mm-t-s"   # GUESSED from E = 7e+04 MPa', (self.folder / "beam.toml").read_text())
        os.remove(self.folder / "beam.toml")
        self.assertEqual(self.propose("beam.bdf", "--units", "SI")["units"], "SI")

    def test_without_tests_the_study_propagates(self):
        self.write("beam.bdf", BEAM)
        self.propose("beam.bdf")
        self.assertIn("UNKNOWN: no tests were given", (self.folder / "beam.toml").read_text())
        self.succeed("propagate", "beam.toml", "--set", "update.samples=20", "--quiet")

    def test_nothing_is_written_over(self):
        self.write("airframe.toml", "mine")
        ended = self.call("init", "airframe.bdf")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("airframe.toml: is there already", ended.err)
        self.assertEqual((self.folder / "airframe.toml").read_text(), "mine")

    def test_numbers_that_split_one_frequency_are_not_called_alike(self):
        # A mass on a spring along X and one along Y, and two oscillators far above.
        self.write("repeated.bdf", REPEATED)
        self.write("tests.csv", "f1,f2,f3,f4\n3.50,3.60,15.1,27.1\n3.51,3.64,15.4,27.3\n3.58,3.67,15.2,27.6\n")
        found = self.propose("repeated.bdf", "tests.csv", "--out", "s.toml")
        why = {parameter["target"]: parameter["left_out"] for parameter in found["parameters"]}
        self.assertFalse([target for target in ("PELAS:1:K", "PELAS:2:K") if "hardly tell" in why[target]], why)
        self.assertIn("hardly tell it from", why["CELAS2:21:K"] + why["CMASS2:22:M"])  # of one oscillator
        self.assertTrue([note for note in found["notes"] if "any combination is a mode: f1, f2." in note], found["notes"])

    def test_numbers_that_move_one_frequency_as_a_whole_are_called_alike(self):
        # One spring property in both directions, and the mass: whatever combination, f1 and f2 move together.
        self.write("repeated.bdf", support.edited(REPEATED, ("CELAS1,2,2,1,2", "CELAS1,2,1,1,2"), ("PELAS,2,1000.\n", "")))
        self.write("tests.csv", "f1,f2,f3,f4\n3.50,3.60,15.1,27.1\n3.51,3.64,15.4,27.3\n3.58,3.67,15.2,27.6\n")
        found = self.propose("repeated.bdf", "tests.csv", "--out", "s.toml", "--targets", "PELAS:1:K")
        why = {parameter["target"]: parameter["left_out"] for parameter in found["parameters"]}
        self.assertEqual(why["CONM2:3:M"], "the outputs can hardly tell it from K_PELAS_1")

    def test_shapes_that_agree_at_frequencies_in_rad_per_second_tell_the_unit(self):
        self.write("chain.bdf", support.CHAIN)
        shapes = "1:+X,9.2975,14.7955,-26.356\n2:+X,14.637,11.923,11.963\n3:+X,17.97,-18.17,-3.90\n"
        for factor, question in ((6.2832, "are the tests in rad/s? Divide them by 2 pi."),
                                 (1000.0, "--units names others"), (60.0, "are the tests in 1/min (rpm)?")):
            for k in (1, 2):
                self.write(f"t{k}.csv", "dof," + ",".join(f"{factor * (f + 0.01 * k):.6g}" for f in (1.90, 5.78, 8.98)) + "\n" + shapes)
            ended = self.call("init", "chain.bdf", "t1.csv", "t2.csv", "--out", "s.toml")
            self.assertEqual(ended.code, 2, ended.out)
            self.assertIn("in the 3 modes whose shapes are those of the model the frequencies are", ended.err)
            self.assertIn(question, ended.err)
            self.assertNotIn("by chance", ended.err)

    def test_tests_that_are_no_modes_of_the_model_are_refused(self):
        self.write("beam.bdf", BEAM)
        self.write("far.csv", "f1,f2\n1e6,2e6\n1.1e6,2.1e6\n")
        ended = self.call("init", "beam.bdf", "far.csv")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("no mode of the model is found in the tests beyond doubt", ended.err)

    # --- shapes in a table ---

    def test_a_table_with_shapes_that_counts_as_the_model_becomes_one_with_shapes_as_outputs(self):
        found = self.propose("airframe.bdf", EXAMPLES / "02-airframe" / "specimens.csv", "--out", "s.toml")
        self.assertEqual(found["pairing"], "named")
        text = (self.folder / "s.toml").read_text()
        self.assertIn('pairing = "named"', text)
        self.assertIn('shapes = { modes = [8, 9, 11, 13], dofs = ["105:+Z", "111:+Z", "112:+Z", "303:+Z"] }', text)
        self.assertIn("Taken as mass-normalised", text)
        self.succeed("check", "s.toml")

    def test_shapes_of_another_size_are_outputs_by_their_directions(self):
        lines = (EXAMPLES / "02-airframe" / "specimens.csv").read_text().splitlines()
        names = lines[0].split(",")
        rows = [[repr(50 * float(cell)) if name.startswith("phi") and cell else cell for name, cell in zip(names, line.split(","))]
                for line in lines[1:]]
        self.write("t.csv", "\n".join([lines[0], *map(",".join, rows)]) + "\n")
        self.propose("airframe.bdf", "t.csv", "--out", "s.toml")
        self.assertIn('size = "free"', (self.folder / "s.toml").read_text())
        self.assertIn("compared after scaling", " ".join(self.succeed("check", "s.toml").out.split()))

    def test_shapes_of_a_table_that_counts_otherwise_are_said_to_be_left_out(self):
        lines = (EXAMPLES / "02-airframe" / "specimens.csv").read_text().splitlines()
        header = re.sub(r"\b(f|phi)(\d+)", lambda name: f"{name[1]}{int(name[2]) - 6}", lines[0])
        self.write("t.csv", "\n".join([header, *lines[1:]]) + "\n")
        found = self.propose("airframe.bdf", "t.csv", "--out", "s.toml")
        self.assertEqual(found["pairing"], "frequency")
        self.assertIn("f2 is the model's f8", " ".join(found["notes"]))
        self.assertNotIn("shapes = {", (self.folder / "s.toml").read_text())
        self.succeed("check", "s.toml")

    # --- ambiguous pairs ---

    def test_modes_at_equal_distance_are_said_in_the_study(self):
        # A cantilever of nearly equal sides has each bending mode twice, 20 % apart; the tests' lowest is midway.
        self.write("square.bdf", BEAM.replace("20.,30.", "20.,24."))
        f = [mode["model"] for mode in self.propose("square.bdf", "--out", "modes.toml")["modes"]]
        self.write("t.csv", "f1,f2,f3\n" + "".join(f"{(f[0] * f[1]) ** 0.5 * x!r},{f[2] * x!r},{f[3] * x!r}\n" for x in (1.0, 1.001)))
        found = self.propose("square.bdf", "t.csv", "--out", "s.toml")
        self.assertEqual(self.outputs(found), [2, 3, 4])
        self.assertRegex((self.folder / "s.toml").read_text(), r"f2 .*DOUBTFUL: f1 at \S+ is as near")
        # Where nothing at all tells the two apart, the pair is no output.
        self.write("one.csv", "f1\n" + "".join(f"{(f[0] * f[1]) ** 0.5 * x!r}\n" for x in (0.999, 1.001)))
        ended = self.call("init", "square.bdf", "one.csv", "--out", "t.toml")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("is as near", ended.err)

    def test_tests_in_another_unit_are_said(self):
        lines = (EXAMPLES / "02-airframe" / "specimens.csv").read_text().splitlines()
        rows = [",".join(cell and repr(6.283185307179586 * float(cell)) for cell in line.split(",")[:10]) for line in lines[1:]]
        self.write("t.csv", "\n".join([",".join(lines[0].split(",")[:10]), *rows]) + "\n")
        ended = self.call("init", "airframe.bdf", "t.csv", "--out", "s.toml")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("(rad/s)", ended.err)

    # --- other kinds of model ---

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX (ccx) is not installed")
    def test_a_calculix_deck_becomes_a_study_that_runs(self):
        example = EXAMPLES / "03-plate-calculix"
        shutil.copy(example / "plate.inp", self.folder)
        found = self.propose("plate.inp", example / "specimens.csv", "--out", "s.toml", "--cache", "kept")
        self.assertEqual(found["kind"], "calculix")
        self.assertEqual((found["units"], found["specimens"]), ("SI", 15))
        self.assertEqual(found["pairing"], "named", "f3 of the first row is above f4: the columns are numbered as the model")
        self.assertEqual(self.outputs(found), list(range(1, 11)))
        # Of the deck's nine numbers; a density, a modulus and a thickness of one sheet scale all modes alike.
        self.assertIn("*SPRING:MOUNTS3", self.parameters(found))
        self.assertFalse([target for target in self.parameters(found) if target.endswith(":T")])
        self.assertIn("each sample is a run of CalculiX", " ".join(found["notes"]))
        self.assertTrue(2 <= len(self.parameters(found)) <= 5, self.parameters(found))
        self.assertFalse([note for note in found["notes"] if "does not run" in note])
        self.assertIn('kind = "calculix"', (self.folder / "s.toml").read_text())
        self.succeed("update", "s.toml", "--set", "update.samples=50", "--quiet", "--cache", "kept", timeout=300)
        self.assertEqual(support.read_result(self.folder / "s.mottle")["status"], "converged")

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX (ccx) is not installed")
    def test_sensitivities_of_a_calculix_deck_are_those_of_its_own_runs(self):
        shutil.copy(EXAMPLES / "03-plate-calculix" / "plate.inp", self.folder)
        found = self.propose("plate.inp", "--out", "s.toml")
        sensitivity = {parameter["target"]: parameter for parameter in found["parameters"]}
        before = [mode["model"] for mode in found["modes"]]
        deck = (self.folder / "plate.inp").read_text()
        self.write("stiffer.inp", deck.replace("800000.0", "816000.0"))  # MOUNTS3 by 2 %
        after = [mode["model"] for mode in self.propose("stiffer.inp", "--out", "t.toml")["modes"]]
        changes = [100 * (b / a - 1) / 2 for a, b in zip(before, after)]
        largest = max(range(len(changes)), key=lambda k: abs(changes[k]))
        self.assertIn("*SPRING:MOUNTS3", sensitivity)
        text = (self.folder / "s.toml").read_text()
        said = re.search(r'target = "\*SPRING:MOUNTS3".*f(\d+) by ([+-][\d.]+) % per %', text)
        self.assertEqual(int(said[1]), largest + 1)
        self.assertAlmostEqual(float(said[2]), changes[largest], delta=0.02)  # two digits, and half of 2 % by curvature

    def test_a_solvers_input_becomes_a_study_with_marked_unknowns(self):
        example = EXAMPLES / "04-any-solver"
        for name in ("tower.inp.in", "tower.py", "specimens.csv"):
            shutil.copy(example / name, self.folder)
        found = self.propose("tower.inp.in", "specimens.csv", "--out", "s.toml")
        self.assertEqual(found["kind"], "command")
        self.assertEqual([parameter["name"] for parameter in found["parameters"]], ["m_roof", "k_base", "k_upper"])
        self.assertEqual(self.outputs(found), [1, 2, 3, 4])
        text = (self.folder / "s.toml").read_text()
        # Whatever is unknown is refused, all of it in one message; filled in, it runs.
        ended = self.call("check", "s.toml")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn(f"s.toml:{support.line_of(text, 'command = ')}: model.command[0] still says UNKNOWN", ended.err)
        for key, start in (("model.frequencies.file", 'file = "UNKNOWN"'), ("model.frequencies.column", 'column = "UNKNOWN"')):
            self.assertIn(f"{key} (line {support.line_of(text, start)})", ended.err)
        for number in range(3):
            self.assertIn(f"parameter[{number}].distribution.mean (line ", ended.err)
        for old, new in (('["UNKNOWN", "tower.inp"]', '["python3", "tower.py", "tower.inp"]'),
                         ('file = "UNKNOWN" ', 'file = "tower.out" '),
                         ('mean = "UNKNOWN", std = "UNKNOWN"', "mean = 2e4, std = 2e3"),
                         ('mean = "UNKNOWN", std = "UNKNOWN"', "mean = 4e7, std = 8e6"),
                         ('mean = "UNKNOWN", std = "UNKNOWN"', "mean = 4e7, std = 8e6"),
                         ('# files = ["mesh.inc"] ', 'files = ["tower.py"] '),
                         ("line = 1 ", 'after = "NATURAL FREQUENCIES"\nline = 3 ')):
            self.assertIn(old, text)
            text = text.replace(old, new, 1)
        self.write("s.toml", support.edited(text, ('column = "UNKNOWN" ', "column = 1 ")))
        checked = self.succeed("check", "s.toml").out
        self.assertIn("as if the column of the modes' numbers had been read", checked)
        self.write("s.toml", support.edited(text, ('column = "UNKNOWN" ', "column = 3 ")))
        checked = self.succeed("check", "s.toml").out
        self.assertNotIn("numbers had been read", checked)
        self.assertRegex(checked, r"one model run took [\d.]+ s")
        self.assertRegex(checked, r"the update would take about \d+ runs, some \d+ s with \d+ at a time")

    def test_on_a_terminal_it_asks(self):
        master, slave = pty.openpty()
        process = subprocess.Popen([support.MOTTLE, "init", "airframe.bdf", "--out", "s.toml"], cwd=self.folder, stdin=slave,
                                   stdout=slave, stderr=slave, close_fds=True)
        os.close(slave)
        os.write(master, b"\n7 8 9 10\nMAT1:1:E\n\n\n")  # units as guessed; outputs; targets; then accepted
        text = b""
        while True:
            try:
                block = os.read(master, 4096)
            except OSError:
                break
            if not block:
                break
            text += block
        os.close(master)
        self.assertEqual(process.wait(60), 0, text)
        self.assertIn(b"Modes that are outputs", text)
        self.assertIn("frequencies = [7, 8, 9, 10]", (self.folder / "s.toml").read_text())
        self.assertIn('target = "MAT1:1:E"', (self.folder / "s.toml").read_text())


if __name__ == "__main__":
    support.main()
