"""mottle init: the study that it proposes runs, it asks on a terminal, and it writes over nothing. What is proposed, and
why, is in tests/study/jobs.

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
        self.succeed("check", "s.toml")
        self.succeed("update", "s.toml", "--set", "update.samples=50", "--quiet")
        self.assertEqual(support.read_result(self.folder / "s.mottle")["status"], "converged")

    def test_outputs_and_targets_can_be_named(self):
        found = self.propose("airframe.bdf", EXAMPLES / "02-airframe" / "specimens.csv", "--out", "s.toml",
                             "--outputs", "7,8,10", "--targets", "mat1:1:e,PBUSH:101:K4", "--units", "mm-t-s")
        self.assertEqual(found["units"], "mm-t-s")
        self.assertEqual(self.outputs(found), [7, 8, 10])
        self.assertEqual(self.parameters(found), ["MAT1:1:E", "PBUSH:101:K4"])
        ended = self.call("init", "airframe.bdf", "--out", "t.toml", "--outputs", "77")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("mode 77 cannot be an output", ended.err)
        self.assertFalse((self.folder / "t.toml").exists())

    def test_nothing_is_written_over(self):
        self.write("airframe.toml", "mine")
        ended = self.call("init", "airframe.bdf")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("airframe.toml: is there already", ended.err)
        self.assertEqual((self.folder / "airframe.toml").read_text(), "mine")

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
