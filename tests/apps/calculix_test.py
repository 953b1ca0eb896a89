"""Studies on a CalculiX deck, with the real solver: its own frequencies, its cache, and runs that fail.

    python3 calculix_test.py PATH_TO_MOTTLE
"""

import json
import math
import os
import re
import shutil
import subprocess
import time
import unittest

import support
from support import edited

NODES = [(x, y, z) for x in range(4) for y in (0.0, 0.2) for z in (0.0, 0.1)]
LINES = ["*NODE", *(f"{k}, {x}, {y}, {z}" for k, (x, y, z) in enumerate(NODES, 1)), "*ELEMENT, TYPE=C3D8, ELSET=BEAM"]
LINES += [f"{a + 1}, " + ", ".join(str(4 * a + k) for k in (1, 5, 7, 3, 2, 6, 8, 4)) for a in range(3)]
LINES += ["*ELEMENT, TYPE=SPRING1, ELSET=PROP", "9, 13", "*SPRING, ELSET=PROP", "3", "4.0e4",
          "*MATERIAL, NAME=STEEL", "*ELASTIC", "2.1e11, 0.3", "*DENSITY", "7800.", "*SOLID SECTION, ELSET=BEAM, MATERIAL=STEEL",
          "*BOUNDARY", "1, 1, 3", "2, 1, 3", "3, 1, 3", "4, 1, 3", "*STEP", "*FREQUENCY", "4", "*NODE FILE", "U", "*END STEP", ""]
DECK = "\n".join(LINES)
STUDY = """\
[model]
kind = "calculix"
file = "beam.inp"
timeout = 5
[[parameter]]
name = "E"
target = "*ELASTIC:STEEL:E"
distribution = { kind = "normal", mean = 2.0e11, std = 1.0e10 }
[[parameter]]
name = "k"
target = "*SPRING:PROP"
distribution = { kind = "lognormal", mean = 5.0e4, std = 1.0e4 }
[outputs]
frequencies = [1, 2, 3]
tracking = "order"
[update]
samples = 30
"""


def eigenvalues_of(folder, deck):
    """By the solver alone, 7 digits."""
    (folder / "own.inp").write_text(deck)
    subprocess.run(["ccx", "own"], cwd=folder, check=True, stdout=subprocess.DEVNULL,
                   env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})
    rows = re.findall(r"^ +\d+ +(-?\d\.\d+E[+-]\d+) +\S+ +\S+ +\S+$", (folder / "own.dat").read_text(), re.M)
    return [float(value) for value in rows]


def frequencies_of(folder, deck):
    return [value ** 0.5 / (2 * math.pi) for value in eigenvalues_of(folder, deck)[:3]]


@unittest.skipUnless(shutil.which("ccx"), "needs CalculiX: apt-get install calculix-ccx")
class CalculixTest(support.CommandTest):
    def setUp(self):
        super().setUp()
        self.write("beam.inp", DECK)
        self.write("study.toml", STUDY)

    def solver(self, text):
        """A program in place of CalculiX that answers -v as it does."""
        file = self.write("solver", f"#!/bin/sh\nif [ \"$1\" = -v ]; then echo This is Version 9; exit 0; fi\n{text}\n")
        file.chmod(0o755)
        return ["--set", f'model.program="{file}"']

    def test_frequencies_are_the_solvers_own(self):
        self.write("points.csv", "E,k\n1.7e11,9e4\n2.6e11,1e3\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out")
        header, rows = support.read_csv(self.folder / "out" / "cloud.csv")
        for row, (young, stiffness) in zip(rows, (("1.7e11", "9.0e4"), ("2.6e11", "1.0e3"))):
            own = frequencies_of(self.folder, edited(DECK, ("2.1e11", young), ("4.0e4", stiffness)))
            for mode, expected in enumerate(own, 1):
                self.assertLess(abs(float(row[header.index(f"f{mode}")]) / expected - 1), 1e-6)

    def test_a_free_structure_has_rigid_body_modes(self):
        """Their eigenvalues are zero but for the digits of the matrices that CalculiX writes, of either sign."""
        plate = (support.SOURCE / "examples" / "03-plate-calculix" / "plate.inp").read_text(encoding="utf-8").splitlines()
        mounts = [i for i, line in enumerate(plate) if line.startswith(("*ELEMENT, TYPE=SPRING1", "*SPRING"))]
        left_out = {k for i in mounts for k in range(i, next(j for j in range(i + 1, len(plate)) if plate[j][0] == "*"))}
        self.write("free.inp", "\n".join(line for i, line in enumerate(plate) if i not in left_out) + "\n")
        own = eigenvalues_of(self.folder, (self.folder / "free.inp").read_text(encoding="utf-8"))
        self.assertLess(own[0], 0.0)
        self.write("free.toml", '[model]\nkind = "calculix"\nfile = "free.inp"\n[[parameter]]\nname = "E"\n'
                   'target = "*ELASTIC:ALUMINIUM:E"\ndistribution = { kind = "normal", mean = 70e9, std = 1e9 }\n'
                   "[outputs]\nfrequencies = [7, 8, 9, 10]\n")
        self.write("points.csv", "E\n70e9\n")
        self.succeed("propagate", "free.toml", "--points", "points.csv", "--out", "out")
        header, rows = support.read_csv(self.folder / "out" / "cloud.csv")
        for mode in range(7, 11):
            expected = own[mode - 1] ** 0.5 / (2 * math.pi)
            self.assertLess(abs(float(rows[0][header.index(f"f{mode}")]) / expected - 1), 1e-6)

    def test_a_thin_free_plate_is_not_called_unstable(self):
        """What rounding leaves of its rigid-body motions has the size of membrane stiffness, however few modes are asked for."""
        nodes = [f"{j * 100 + i + 1}, {i * 100.0}, {j * 50.0}, 0.0" for j in range(3) for i in range(7)]
        corners = [j * 100 + i + 1 for j in range(2) for i in range(6)]
        elements = [f"{e}, {a}, {a + 1}, {a + 101}, {a + 100}" for e, a in enumerate(corners, 1)]
        for thickness in (5.0, 2.0):
            with self.subTest(thickness=thickness):
                self.write("thin.inp", "\n".join([
                    "*NODE", *nodes, "*ELEMENT, TYPE=S4, ELSET=P", *elements, "*MATERIAL, NAME=AL", "*ELASTIC", "7e4, 0.3",
                    "*DENSITY", "2.7e-9", "*SHELL SECTION, ELSET=P, MATERIAL=AL", f"{thickness}", "*STEP", "*FREQUENCY", "12",
                    "*END STEP", ""]))
                own = [max(value, 0.0) ** 0.5 / (2 * math.pi)
                       for value in eigenvalues_of(self.folder, (self.folder / "thin.inp").read_text(encoding="utf-8"))]
                for modes in (7, 20):
                    found = json.loads(self.succeed("targets", "thin.inp", "--modes", modes, "--json").out)["frequencies"]
                    self.assertLess(max(found[:6]), 0.02 * own[6])
                    self.assertAlmostEqual(found[6] / own[6], 1.0, 4)

    def test_of_one_free_element_only_rigid_body_modes_are_compared(self):
        """All four that CalculiX finds of 24 equations are: there is no elastic one to measure them by."""
        corners = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        cube = ["*NODE", *(f"{k}, {x}, {y}, {z}" for k, (x, y, z) in enumerate(corners, 1)),
                "*ELEMENT, TYPE=C3D8I, ELSET=CUBE", "1, 1, 2, 3, 4, 5, 6, 7, 8", "*MATERIAL, NAME=S", "*ELASTIC", "7e10, 0.3",
                "*DENSITY", "2700.", "*SOLID SECTION, ELSET=CUBE, MATERIAL=S", "*STEP", "*FREQUENCY", "10", "*END STEP", ""]
        self.write("cube.inp", "\n".join(cube))
        listed = self.succeed("targets", "cube.inp", "--json")
        self.assertRegex(self.succeed("targets", "cube.inp").out, "matrices from .*are rigid-body motions, there is nothing to compare")
        self.assertNotIn("nan", listed.out)
        targets = {target["target"]: target["sensitivity"] for target in json.loads(listed.out)["targets"]}
        self.assertEqual(targets["*DENSITY:S"][:6], [None] * 6)
        for value in targets["*ELASTIC:S:E"][6:]:
            self.assertAlmostEqual(value, 0.5, 3)  # four of eight modes of a frequency that rounding splits, by differences

    def test_a_second_command_runs_no_solver(self):
        first = self.succeed("check", "study.toml", "--cache", "cache")
        self.assertIn("matrices from 4 decks (4 runs, 0 from the cache)", first.out)
        again = self.succeed("check", "study.toml", "--cache", "cache")
        self.assertIn("(0 runs, 4 from the cache)", again.out)
        self.write("beam.inp", edited(DECK, ("7800.", "7900.")))
        self.assertIn("(4 runs, 0 from the cache)", self.succeed("check", "study.toml", "--cache", "cache").out)
        for file in (self.folder / "cache").glob("*.matrices"):
            whole = file.read_bytes()
            file.write_bytes(whole[:-9] + bytes([whole[-9] ^ 1]) + whole[-8:])
        self.assertIn("(4 runs, 0 from the cache)", self.succeed("check", "study.toml", "--cache", "cache").out)

    def test_an_entry_under_another_key_is_not_taken(self):
        """Two entries of the cache that change places are whole, but not what their names say."""
        reference = self.succeed("check", "study.toml", "--json", "--cache", "cache").out
        first, second = sorted((self.folder / "cache").glob("*.matrices"))[:2]
        bytes_of_first = first.read_bytes()
        first.write_bytes(second.read_bytes())
        second.write_bytes(bytes_of_first)
        again = self.succeed("check", "study.toml", "--cache", "cache")
        self.assertIn("(2 runs, 2 from the cache)", again.out)
        self.assertEqual(self.succeed("check", "study.toml", "--json", "--cache", "cache").out, reference)

    def test_matrices_that_are_not_whole_are_not_kept(self):
        """CalculiX ends with 0 where the disk was full."""
        sound = self.succeed("check", "study.toml", "--json", "--cache", "off").out
        for file, cut in (("model.sti", "-c -4"), ("model.sti", "-n -1"), ("model.mas", "-c -40"), ("model.mas", "-n -3"),
                          ("model.dof", "-c -1"), ("model.dof", "-n -1"), ("model.sti", "-c 0"), ("model.dof", "-c 0")):
            with self.subTest(file=file, cut=cut):
                shortened = self.solver(f'ccx "$@" && head {cut} {file} > short && mv short {file}')
                ended = self.call("check", "study.toml", "--cache", "cache", *shortened)
                self.assertEqual(ended.code, 3, ended.err)
                self.assertIn("full?", ended.err)
                self.assertFalse(list((self.folder / "cache").glob("*")))
        both = self.solver('ccx "$@" && for f in sti mas; do head -n -1 model.$f > short && mv short model.$f; done')
        self.assertIn("diagonal entries, model.dof", self.call("check", "study.toml", "--cache", "cache", *both).err)
        self.assertEqual(self.succeed("check", "study.toml", "--json", "--cache", "cache").out, sound)

    def test_placeholders_are_filled(self):
        self.write("beam.inp", edited(DECK, ("2.1e11", "{{young}}")))
        self.write("study.toml", edited(STUDY, ("*ELASTIC:STEEL:E", "{{young}}")))
        result = json.loads(self.succeed("check", "study.toml", "--json").out)
        own = frequencies_of(self.folder, edited(DECK, ("2.1e11", "2.0e11"), ("4.0e4", "5.0e4")))
        self.assertLess(abs(result["frequencies"][0] / own[0] - 1), 1e-6)

    def test_each_sample_is_a_run_where_there_is_no_separable_form(self):
        study = edited(STUDY, ('"*ELASTIC:STEEL:E"', '"*ELASTIC:STEEL:NU"'), ("mean = 2.0e11, std = 1.0e10", "mean = 0.3, std = 0.02"),
                       ('"*SPRING:PROP"', '"*SPRING:PROP"\nrelative = true'), ("mean = 5.0e4, std = 1.0e4", "mean = 1.0, std = 0.1"),
                       ('tracking = "order"', 'tracking = "mac"\nshapes = { modes = [1], dofs = ["13:+Z"] }'))
        self.write("study.toml", edited(study, ("timeout = 5", 'timeout = "5 s"\nparallel = 2')))
        self.assertIn("each sample is a run, since parameter 'E': '*ELASTIC:STEEL:NU'", self.succeed("check", "study.toml").out)
        self.write("points.csv", "E,k\n0.28,0.5\n0.35,2\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out")
        header, rows = support.read_csv(self.folder / "out" / "cloud.csv")
        for row, (poisson, stiffness) in zip(rows, (("0.28", "2.0e4"), ("0.35", "8.0e4"))):
            own = frequencies_of(self.folder, edited(DECK, (", 0.3", f", {poisson}"), ("4.0e4", stiffness)))
            for mode, expected in enumerate(own, 1):
                self.assertLess(abs(float(row[header.index(f"f{mode}")]) / expected - 1), 1e-6)
        self.assertTrue((self.folder / "out" / "runs.store").exists())

    def assert_own(self, deck, changes, row, header):
        for mode, expected in enumerate(frequencies_of(self.folder, edited(deck, *changes)), 1):
            self.assertLess(abs(float(row[header.index(f"f{mode}")]) / expected - 1), 1e-6)

    def test_modes_of_a_preloaded_structure_are_those_of_runs(self):
        deck = edited(DECK, ("*STEP\n*FREQUENCY", "*STEP\n*STATIC\n*CLOAD\n13, 1, -6e6\n14, 1, -6e6\n15, 1, -6e6\n16, 1, -6e6\n"
                             "*NODE FILE\nU\n*END STEP\n*STEP, PERTURBATION\n*FREQUENCY"))
        self.write("beam.inp", deck)
        self.write("study.toml", edited(STUDY, ('tracking = "order"', 'tracking = "mac"\nshapes = { modes = [1], dofs = ["13:+Z"] }')))
        out = self.succeed("check", "study.toml").out
        self.assertIn("each sample is a run, since its *FREQUENCY step is a PERTURBATION of the state after *STATIC", out)
        self.write("points.csv", "E,k\n1.7e11,9e4\n2.1e11,4e4\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out")
        header, rows = support.read_csv(self.folder / "out" / "cloud.csv")
        self.assert_own(deck, [("2.1e11", "1.7e11"), ("4.0e4", "9.0e4")], rows[0], header)
        unloaded = frequencies_of(self.folder, DECK)
        self.assertGreater(abs(float(rows[1][header.index("f1")]) / unloaded[0] - 1), 0.01, "the preload is seen")

    def test_moduli_of_other_materials_are_targets(self):
        card = "*ELASTIC, TYPE=ORTHO\n2.8e11, 1.2e11, 2.8e11, 1.2e11, 1.2e11, 2.8e11, 8.1e10, 8.1e10\n8.1e10"
        deck = edited(DECK, ("*ELASTIC\n2.1e11, 0.3", card))
        self.write("beam.inp", deck)
        self.write("study.toml", edited(STUDY, (":STEEL:E", ":STEEL:D1111"), ("mean = 2.0e11", "mean = 2.8e11")))
        self.write("points.csv", "E,k\n3.1e11,4e4\n")
        self.assertNotIn("each sample is a run", self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out").out)
        header, rows = support.read_csv(self.folder / "out" / "cloud.csv")
        self.assert_own(deck, [("*ELASTIC, TYPE=ORTHO\n2.8e11", "*ELASTIC, TYPE=ORTHO\n3.1e11")], rows[0], header)
        deck = edited(DECK, ("*ELASTIC\n2.1e11, 0.3", "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n2.1e11, 1e11, 1e11, .3, .3, .3, 4e10, 4e10\n3e10"))
        self.write("beam.inp", deck)
        self.write("study.toml", edited(STUDY, (":STEEL:E", ":STEEL:E1")))
        self.write("points.csv", "E,k\n1.9e11,4e4\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out2")
        header, rows = support.read_csv(self.folder / "out2" / "cloud.csv")
        self.assert_own(deck, [("2.1e11", "1.9e11")], rows[0], header)

    def test_a_factor_moves_the_modulus_at_all_temperatures(self):
        deck = edited(DECK, ("2.1e11, 0.3", "2.1e11, 0.3, 20.\n1.5e11, 0.3, 320."),
                      ("*STEP", "*INITIAL CONDITIONS, TYPE=TEMPERATURE\n" + "\n".join(f"{k}, 170." for k in range(1, 17)) + "\n*STEP"))
        self.write("beam.inp", deck)
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2)
        self.assertIn("has a value at each of 2 temperatures; relative = true multiplies all of them", ended.err)
        self.write("study.toml", edited(STUDY, ('"*ELASTIC:STEEL:E"', '"*ELASTIC:STEEL:E"\nrelative = true'),
                                        ("mean = 2.0e11, std = 1.0e10", "mean = 1.0, std = 0.1")))
        self.write("points.csv", "E,k\n1.2,4e4\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out")
        header, rows = support.read_csv(self.folder / "out" / "cloud.csv")
        self.assert_own(deck, [("2.1e11", "2.52e11"), ("1.5e11", "1.8e11")], rows[0], header)

    def test_a_thin_shell_whose_printed_matrices_have_too_few_digits_is_solved_by_runs(self):
        """1 mm on 1 m: of the matrices in 14 digits the first frequency is 2.7 % off that of the solver's own."""
        nodes = "\n".join(f"{5 * j + i + 1}, {i / 4}, {j / 4}, 0." for j in range(5) for i in range(5))
        shells = "\n".join(f"{4 * j + i + 1}, " + ", ".join(str(5 * j + i + k) for k in (1, 2, 7, 6)) for j in range(4) for i in range(4))
        deck = (f"*NODE\n{nodes}\n*ELEMENT, TYPE=S4, ELSET=PANEL\n{shells}\n*MATERIAL, NAME=STEEL\n*ELASTIC\n2.1e11, 0.3\n*DENSITY\n7800.\n"
                "*SHELL SECTION, ELSET=PANEL, MATERIAL=STEEL\n1e-3\n*BOUNDARY\n" + "".join(f"{k}, 1, 6\n" for k in range(1, 6))
                + "*STEP\n*FREQUENCY\n6\n*END STEP\n")
        self.write("beam.inp", deck)
        self.write("study.toml", STUDY[:STUDY.index('[[parameter]]\nname = "k"')] + STUDY[STUDY.index("[outputs]"):])
        self.assertIn("each sample is a run, since CalculiX prints its matrices with 14 digits, and of those mode 1 has 0.8",
                      " ".join(self.succeed("check", "study.toml").out.split()))
        self.write("points.csv", "E\n1.9e11\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out")
        header, rows = support.read_csv(self.folder / "out" / "cloud.csv")
        self.assert_own(deck, [("2.1e11", "1.9e11")], rows[0], header)

    def test_matrices_are_compared_with_the_solvers_own_modes_once(self):
        first = " ".join(self.succeed("check", "study.toml", "--cache", "cache").out.split())
        self.assertIn("their 7 lowest frequencies are CalculiX's own to", first)
        counted = self.solver(f'echo run >> {self.folder}/runs; exec ccx "$@"')
        for _ in range(2):
            self.succeed("check", "study.toml", "--cache", "cache", *counted)
            self.assertEqual((self.folder / "runs").read_text(), 5 * "run\n", "four for the matrices, one for the modes")

    def test_a_card_that_the_solver_ignores_is_refused(self):
        """CalculiX warns, and gives the modes of the structure without it."""
        self.write("beam.inp", edited(DECK, ("*BOUNDARY", "*Rotary Inertia, elset=BEAM\n1., 1., 1.\n*BOUNDARY")))
        for change in ((), (('"*ELASTIC:STEEL:E"', '"*ELASTIC:STEEL:NU"'), ("mean = 2.0e11, std = 1.0e10", "mean = 0.3, std = 0.02"))):
            self.write("study.toml", edited(STUDY, *change))
            ended = self.call("check", "study.toml", "--cache", "cache")
            self.assertEqual(ended.code, 2, ended.err)
            self.assertIn("CalculiX does not know", ended.err)
            self.assertIn("beam.inp:", ended.err)
            self.assertIn("*ROTARYINERTIA,ELSET=BEAM", ended.err)

    def test_a_factor_moves_a_modulus_that_is_zero_at_one_temperature(self):
        card = ("*ELASTIC, TYPE=ORTHO\n0., 0., 0., 0., 0., 0., 0., 0.\n0., 0.\n"
                "2.8e11, 1.2e11, 2.8e11, 1.2e11, 1.2e11, 2.8e11, 8.1e10, 8.1e10\n8.1e10, 300.")
        deck = edited(DECK, ("*ELASTIC\n2.1e11, 0.3", card),
                      ("*STEP", "*INITIAL CONDITIONS, TYPE=TEMPERATURE\n" + "\n".join(f"{k}, 300." for k in range(1, 17)) + "\n*STEP"))
        self.write("beam.inp", deck)
        self.write("study.toml", edited(STUDY, ('"*ELASTIC:STEEL:E"', '"*ELASTIC:STEEL:D1111"\nrelative = true'),
                                        ("mean = 2.0e11, std = 1.0e10", "mean = 1.0, std = 0.1")))
        self.write("points.csv", "E,k\n1.1,4e4\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out")
        header, rows = support.read_csv(self.folder / "out" / "cloud.csv")
        self.assert_own(deck, [("\n2.8e11", "\n3.08e11")], rows[0], header)

    def test_modes_of_a_contact_with_friction_are_refused(self):
        blocks = "\n".join(f"{k}, {x}, {y}, {z}" for k, (x, y, z) in enumerate(
            [(x, y, z) for z in (0, 1, 1, 2) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], 1))
        deck = (f"*NODE, NSET=ALL\n{blocks}\n*ELEMENT, TYPE=C3D8, ELSET=BLOCKS\n1, 1,2,3,4,5,6,7,8\n2, 9,10,11,12,13,14,15,16\n"
                "*SURFACE, NAME=LOW\n1, S2\n*SURFACE, NAME=HIGH\n2, S1\n*MATERIAL, NAME=STEEL\n*ELASTIC\n2.1e11, 0.3\n*DENSITY\n7800.\n"
                "*SOLID SECTION, ELSET=BLOCKS, MATERIAL=STEEL\n*CONTACT PAIR, INTERACTION=C, TYPE=SURFACE TO SURFACE\nHIGH, LOW\n"
                "*SURFACE INTERACTION, NAME=C\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e13, 3.\n*FRICTION\n0.2, 1e11\n"
                "*BOUNDARY\n" + "".join(f"{k}, 1, 3\n" for k in (1, 2, 3, 4, 13, 14, 15, 16)) +
                "*STEP, NLGEOM\n*STATIC\n*BOUNDARY\n" + "".join(f"{k}, 3, 3, -1e-3\n" for k in (13, 14, 15, 16)) +
                "*END STEP\n*STEP, PERTURBATION\n*FREQUENCY\n4\n*END STEP\n")
        self.write("beam.inp", deck)
        self.write("study.toml", STUDY[:STUDY.index('[[parameter]]\nname = "k"')] + STUDY[STUDY.index("[outputs]"):])
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 3, ended.err)
        self.assertIn("a stiffness that is not symmetric", ended.err)

    def test_a_diagnosis_tries_the_decks_other_numbers(self):
        base = frequencies_of(self.folder, DECK)
        rows = [",".join(f"{f * (1 + 0.002 * ((7 * s + 3 * k) % 5 - 2)):.8g}" for k, f in enumerate(base)) for s in range(8)]
        self.write("tests.csv", "f1,f2,f3\n" + "\n".join(rows) + "\n")
        self.write("study.toml", STUDY + '[test]\nfile = "tests.csv"\nrepeatability = { "f*" = "0.1 %" }\n')
        self.assertIn("*DENSITY:STEEL", self.succeed("diagnose", "study.toml", "--out", "out", timeout=300).out)

    def test_runs_that_fail_are_told_with_what_the_solver_printed(self):
        for text, code, phrase in (("echo '*ERROR in calinput: no mesh'; exit 201", 3, "*ERROR in calinput: no mesh"),
                                   ("exit 0", 3, "it stored no matrices"),
                                   ("sleep 30", 3, "not done in 5 s")):
            ended = self.call("check", "study.toml", *self.solver(text))
            self.assertEqual((ended.code, phrase in ended.err), (code, True), ended.err)
        ended = self.call("check", "study.toml", "--set", 'model.program="no-such-ccx"')
        self.assertEqual(ended.code, 2)
        self.assertIn("there is no program 'no-such-ccx'", ended.err)

    def test_a_stop_request_ends_the_solver(self):
        waiting = self.solver(f"touch {self.folder}/began; sleep 60")
        process = subprocess.Popen([support.MOTTLE, "check", "study.toml", "--cache", "off", "--set", "model.timeout=60", *waiting],
                                   cwd=self.folder, stderr=subprocess.PIPE)
        while not (self.folder / "began").exists() and process.poll() is None:
            time.sleep(0.01)
        process.terminate()
        start = time.monotonic()
        process.communicate()
        self.assertEqual(process.returncode, 4)
        self.assertLess(time.monotonic() - start, 20)

    def test_what_the_deck_does_not_have_is_refused(self):
        for change, phrase in ((("*SPRING:PROP", "*SPRING:PROB"), "did you mean 'PROP'?"),
                               (("*SPRING:PROP", "*ELASTIC:STEEL:E"), "already tied to parameter 'E'")):
            self.write("other.toml", edited(STUDY, change))
            ended = self.call("check", "other.toml")
            self.assertEqual(ended.code, 2, ended.err)
            self.assertIn(phrase, ended.err)


if __name__ == "__main__":
    support.main()
