"""mottle targets: closed forms, another way to the same sensitivities, and what it says of wrong input.

    python3 targets_test.py PATH_TO_MOTTLE
"""

import csv
import io
import json
import math
import shutil
import unittest

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
,{width},{height}
MAT1,1,7.+10,,.3,2700.
ENDDATA
"""
FREE = """\
SOL 103
CEND
METHOD = 10
BEGIN BULK
EIGRL,10,,,4
SPOINT,1,2
CELAS2,1,1000.,1,1,2,1
CMASS2,2,2.,1,1
CMASS2,3,3.,2,1
ENDDATA
"""

# A mass on two springs of one stiffness across each other, and another far above: two modes of one frequency.
PAIR = """\
SOL 103
CEND
METHOD = 10
SPC = 1
BEGIN BULK
EIGRL,10,,,3
GRID,1,,0.,0.,0.
SPC1,1,3456,1
PELAS,1,1000.
PELAS,2,1000.
CELAS1,1,1,1,1
CELAS1,2,2,1,2
CONM2,3,1,,2.
SPOINT,9
CELAS2,4,90000.,9,0
CMASS2,5,1.,9,0
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

# Ground - k1 - m1 - k2 - m2 - k3 - ground, m2 omitted: u2 = k2 / (k2 + k3) u1.
OMITTED = """\
SOL 103
CEND
METHOD = 10
BEGIN BULK
EIGRL,10,,,1
SPOINT,1,2
CELAS2,1,300.,1,0
CELAS2,2,500.,1,0,2,0
CELAS2,3,200.,2,0
CMASS2,4,2.,1,0
CMASS2,5,.7,2,0
OMIT,2,0
ENDDATA
"""


def omitted_hz(k1, k2, k3):
    ratio = k2 / (k2 + k3)
    return math.sqrt((k1 + k3 * ratio) / (2.0 + 0.7 * ratio**2)) / (2 * math.pi)


class TargetsTest(support.CommandTest):
    def targets(self, deck, *options):
        found = json.loads(self.succeed("targets", deck, "--json", *options).out)
        return {target["target"]: target for target in found["targets"]}, found

    def test_a_uniform_cantilever_has_the_closed_forms(self):
        found, _ = self.targets(self.write("deck.bdf", BEAM.format(width=0.02, height=0.03)))
        for sensitivity in found["MAT1:1:E"]["sensitivity"]:
            self.assertAlmostEqual(sensitivity, 0.5, delta=1e-10)
        for sensitivity in found["MAT1:1:RHO"]["sensitivity"]:
            self.assertAlmostEqual(sensitivity, -0.5, delta=1e-10)
        self.assertEqual(found["MAT1:1:E"]["elements"], 3)
        self.assertEqual(found["MAT1:1:E"]["unit"], "Pa")
        for energies in (found["MAT1:1:E"]["strain_energy"], found["MAT1:1:RHO"]["kinetic_energy"]):
            for energy in energies:
                self.assertAlmostEqual(energy, 1.0, delta=1e-10)

    def test_a_section_has_the_sensitivities_of_decks_solved_anew(self):
        step = 1e-3
        found, _ = self.targets(self.write("deck.bdf", BEAM.format(width=0.02, height=0.03)))
        for name, change in (("DIM1", "width"), ("DIM2", "height")):
            sizes = {"width": 0.02, "height": 0.03}
            ends = []
            for sign in (1.0, -1.0):
                moved = {**sizes, change: sizes[change] * (1.0 + sign * step)}
                modes = self.succeed("modes", self.write("moved.bdf", BEAM.format(**moved)), "--json")
                ends.append(json.loads(modes.out)["frequencies"])
            for mode, sensitivity in enumerate(found[f"PBARL:1:{name}"]["sensitivity"]):
                again = (ends[0][mode] - ends[1][mode]) / (ends[0][mode] + ends[1][mode]) / step
                self.assertAlmostEqual(sensitivity, again, delta=1e-5)  # (h^2) times a third derivative of order one

    def test_a_static_reduction_moves_with_the_stiffnesses(self):
        deck = self.write("deck.bdf", OMITTED)
        frequencies = json.loads(self.succeed("modes", deck, "--json").out)["frequencies"]
        self.assertEqual(len(frequencies), 1)
        self.assertAlmostEqual(frequencies[0], omitted_hz(300, 500, 200), delta=1e-10)
        found, _ = self.targets(deck)
        step = 1e-4
        for number in range(3):
            ends = []
            for sign in (1.0, -1.0):
                springs = [300.0, 500.0, 200.0]
                springs[number] *= 1.0 + sign * step
                ends.append(math.log(omitted_hz(*springs)))
            self.assertAlmostEqual(found[f"CELAS2:{number + 1}:K"]["sensitivity"][0], (ends[0] - ends[1]) / (2 * step), delta=1e-7)

    def test_modes_of_one_frequency_have_the_values_into_which_it_splits(self):
        found, whole = self.targets(self.write("deck.bdf", PAIR))
        self.assertAlmostEqual(whole["frequencies"][0], whole["frequencies"][1], delta=1e-12)
        for number in (1, 2):  # each moves one combination of the two by half, the other not at all
            spring = found[f"PELAS:{number}:K"]
            for values, expected in ((spring["sensitivity"], (0.0, 0.5, 0.0)), (spring["strain_energy"], (0.0, 1.0, 0.0))):
                for value, right in zip(values, expected):
                    self.assertAlmostEqual(value, right, delta=1e-10)

    def test_a_repeated_frequency_is_not_cut(self):
        found, whole = self.targets(self.write("deck.bdf", PAIR), "--modes", "1")
        self.assertEqual(len(whole["frequencies"]), 2)
        for value, right in zip(found["PELAS:1:K"]["sensitivity"], (0.0, 0.5)):
            self.assertAlmostEqual(value, right, delta=1e-10)

    def test_frequencies_have_the_unit_that_goes_with_the_others(self):
        deck = self.write("deck.bdf", BEAM.format(width=20.0, height=30.0).replace("7.+10,,.3,2700.", "70.,,.3,2.7-6"))
        self.assertEqual(self.targets(deck)[1]["frequency_unit"], "kHz")
        self.assertIn("modes [kHz]:", self.succeed("targets", deck).out)
        self.assertIn("frequency kHz", self.succeed("modes", deck).out)

    def test_what_wtmass_multiplies_is_no_mass_of_the_units(self):
        deck = self.write("deck.bdf", BEAM.format(width=0.8, height=1.2).replace("7.+10,,.3,2700.", "1.+7,,.3,.1")
                          .replace("EIGRL,10", "PARAM,WTMASS,.00259\nEIGRL,10"))
        self.assertEqual(self.targets(deck)[0]["MAT1:1:RHO"]["unit"], "lbf s^2/in^4 / WTMASS")

    def test_units_are_guessed_where_none_are_given(self):
        deck = self.write("deck.bdf", BEAM.format(width=20.0, height=30.0).replace("7.+10,,.3,2700.", "7.+4,,.3,2.7-9"))
        self.assertEqual(self.targets(deck)[0]["MAT1:1:E"]["unit"], "MPa")
        self.assertIn("units: mm-t-s (GUESSED", self.succeed("targets", deck).out)
        self.assertEqual(self.targets(deck, "--units", "SI")[0]["MAT1:1:E"]["unit"], "Pa")

    def test_a_rigid_body_mode_has_no_sensitivity(self):
        found, whole = self.targets(self.write("deck.bdf", FREE), "--modes", "2")
        self.assertEqual(whole["frequencies"][0], 0.0)
        self.assertEqual(found["CELAS2:1:K"]["sensitivity"][0], None)
        # reduced mass 6/5: the mass m has the fraction 1 - m / (m1 + m2) of the kinetic energy
        self.assertAlmostEqual(found["CELAS2:1:K"]["sensitivity"][1], 0.5, delta=1e-10)
        self.assertAlmostEqual(found["CMASS2:2:M"]["sensitivity"][1], -0.3, delta=1e-10)
        self.assertAlmostEqual(found["CMASS2:3:M"]["sensitivity"][1], -0.2, delta=1e-10)

    def test_the_table_has_the_numbers_of_the_json(self):
        deck = self.write("deck.bdf", BEAM.format(width=0.02, height=0.03))
        found, _ = self.targets(deck)
        rows = list(csv.DictReader(io.StringIO(self.succeed("targets", deck, "--csv").out)))
        self.assertEqual([row["target"] for row in rows], list(found))
        for row in rows:
            for mode, sensitivity in enumerate(found[row["target"]]["sensitivity"], start=1):
                self.assertEqual(float(row[f"sensitivity_{mode}"]), sensitivity)

    def test_all_numbers_are_listed_where_they_are_asked_for(self):
        deck = self.write("deck.bdf", BEAM.format(width=0.02, height=0.03))
        usual, whole = self.targets(deck)
        every, _ = self.targets(deck, "--all")
        self.assertEqual(len(every), len(usual) + whole["left_out"])
        self.assertIn("MAT1:1:NU", every)

    def test_a_deck_that_is_not_there_is_named(self):
        ended = self.call("targets", "none.bdf")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("none.bdf", ended.err)

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
