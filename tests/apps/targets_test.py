"""mottle targets: the options of the command and what it prints; CalculiX decks, by its own runs. The numbers of Nastran
decks are in tests/study/jobs/targets_test.cpp.

    python3 targets_test.py PATH_TO_MOTTLE
"""

import csv
import io
import json
import math
import shutil

import support

# A cantilever of one material: every frequency goes with sqrt(E / rho); bending with sqrt(I / A).
BEAM = """\
SOL 103
CEND
SPC = 1
METHOD = 10
BEGIN BULK
EIGRL,10,,,4
GRID,1
GRID,2,,0.5
GRID,3,,1.0
GRID,4,,1.5
SPC1,1,123456,1
CBAR,1,1,1,2,0.,0.,1.
CBAR,2,1,2,3,0.,0.,1.
CBAR,3,1,3,4,0.,0.,1.
PBARL,1,1,,BAR
,.02,.03
MAT1,1,7.+10,,.3,2700.
ENDDATA
"""
SPRINGS = """\
*NODE, NSET=ALL
1, 0., 0., 0.
*ELEMENT, TYPE=MASS, ELSET=M
1, 1
*MASS, ELSET=M
2.
*ELEMENT, TYPE=SPRING1, ELSET=SX
2, 1
*SPRING, ELSET=SX
1
1000.
*ELEMENT, TYPE=SPRING1, ELSET=SY
3, 1
*SPRING, ELSET=SY
2
1000.
*BOUNDARY
1, 3, 3
*STEP
*FREQUENCY
2
*NODE FILE
U
*END STEP
"""


class TargetsTest(support.CommandTest):
    def targets(self, deck, *options):
        found = json.loads(self.succeed("targets", deck, "--json", *options).out)
        return {target["target"]: target for target in found["targets"]}, found

    def test_options_of_the_command(self):
        deck = self.write("deck.bdf", BEAM)
        found, whole = self.targets(deck, "--modes", "3")
        self.assertEqual(len(whole["frequencies"]), 3)
        for sensitivity in found["MAT1:1:E"]["sensitivity"]:
            self.assertAlmostEqual(sensitivity, 0.5, delta=1e-10)
        every, _ = self.targets(deck, "--all")
        self.assertEqual(len(every), len(found) + whole["left_out"])
        self.assertEqual(self.targets(deck, "--units", "mm-t-s")[0]["MAT1:1:E"]["unit"], "MPa")
        self.assertIn("units: SI (GUESSED", self.succeed("targets", deck).out)
        rows = list(csv.DictReader(io.StringIO(self.succeed("targets", deck, "--modes", "3", "--csv").out)))
        self.assertEqual([row["target"] for row in rows], list(found))
        self.assertEqual(float(rows[0]["sensitivity_3"]), next(iter(found.values()))["sensitivity"][2])

    def test_a_calculix_decks_sensitivities_sum_to_a_half(self):
        """f goes with sqrt(K / M): all stiffnesses together by +0.5 % per %, all densities by -0.5."""
        if shutil.which("ccx") is None:
            self.skipTest("CalculiX (ccx) is not here")
        shutil.copy(support.SOURCE / "examples" / "03-plate-calculix" / "plate.inp", self.folder)
        found = json.loads(self.succeed("targets", "plate.inp", "--modes", "6", "--json").out)
        self.assertEqual(len(found["frequencies"]), 6)
        for mode in range(6):
            sums = {True: 0.0, False: 0.0}
            for target in found["targets"]:
                sums[target["target"].startswith("*DENSITY")] += target["sensitivity"][mode]
            self.assertAlmostEqual(sums[True], -0.5, delta=1e-4)
            self.assertAlmostEqual(sums[False], 0.5, delta=1e-4)
        header, *rows = csv.reader(io.StringIO(self.succeed("targets", "plate.inp", "--modes", "6", "--csv").out))
        self.assertTrue(all(len(row) == len(header) for row in rows))
        ended = self.call("modes", "plate.inp")
        self.assertEqual(ended.code, 2)
        self.assertIn("is a CalculiX deck", ended.err)

    def test_a_calculix_deck_has_the_values_into_which_a_frequency_splits(self):
        if shutil.which("ccx") is None:
            self.skipTest("CalculiX (ccx) is not here")
        found, whole = self.targets(self.write("rod.inp", SPRINGS), "--modes", "2")
        self.assertAlmostEqual(whole["frequencies"][0], math.sqrt(500.0) / (2 * math.pi), delta=1e-5)
        for name in ("*SPRING:SX", "*SPRING:SY"):
            for value, right in zip(found[name]["sensitivity"], (0.0, 0.5)):
                self.assertAlmostEqual(value, right, delta=1e-4)


if __name__ == "__main__":
    support.main()
