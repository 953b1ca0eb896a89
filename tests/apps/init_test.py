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


class InitTest(support.CommandTest):
    def setUp(self):
        super().setUp()
        os.remove(self.folder / "study.toml")
        shutil.copy(DECK, self.folder)

    def propose(self, *arguments):
        return json.loads(self.succeed("init", *arguments, "--json").out)

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

    def test_tests_that_are_no_modes_of_the_model_are_refused(self):
        self.write("beam.bdf", BEAM)
        self.write("far.csv", "f1,f2\n1e6,2e6\n1.1e6,2.1e6\n")
        ended = self.call("init", "beam.bdf", "far.csv")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("no mode of the model is found in the tests beyond doubt", ended.err)

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
