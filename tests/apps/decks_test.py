"""Decks as people have them: old syntax, and natural frequencies that MSC or NX Nastran printed for public decks.

    python3 decks_test.py PATH_TO_MOTTLE
"""

import json
import math
import unittest

import support

DECKS = support.SOURCE.parent / "shared" / "data" / "decks"  # not part of the project; the tests of them are skipped without

MODERN = """\
SOL 103
CEND
SPC = 1
METHOD = 10
BEGIN BULK
EIGRL,10,,,6
GRID,1
GRID,2,,0.5
GRID,3,,1.0
GRID,4,,1.5
SPC1,1,123456,1
CBAR,1,1,1,2,0.,0.,1.
CBAR,2,1,2,3,0.,0.,1.
CBAR,3,1,3,4,0.,0.,1.
PBAR,1,1,6.-4,2.-8,4.5-8,1.-8
MAT1,1,7.+10,,.3,2700.
ENDDATA
"""
OLD = """\
ID OLD,DECK
SOL 145
TIME 5
CEND
TITLE=A WING,
SUBT = MACH IS 0.45,
SEALL = ALL
SPC   = 1
METHOD  = 10
FMETHOD = 30
OUTPUT(PLOT)
 SET 1 = AERO1
VIEW 0.,90.,0.
PLOT SET 1 LABEL GRID
BEGIN BULK
EIGRL,10,,,6
GRID    1               0.0     0.      0.
=       *1      =       *.5     ==
=2
SPC1    1       12 34 561
CBAR    1       1       1       2       .0      .0      1.0     1
=       *1      =       *1      *1      ==
=(1)
PBAR    1       1       6.-4    2.-8    4.5-8   1.-8
MAT1    1       7.+10           .3      2700.
FLFACT  3       .10000  .11111  .1250   .14286  .16667  .2      .25     KFREQ
+FREQ   .33333  .5
ENDDATA
"""


class DecksTest(support.CommandTest):
    def frequencies(self, deck, *options):
        return json.loads(self.succeed("modes", deck, "--json", "--out", "modes", *options).out)["frequencies"]

    def agree(self, deck, modes=None):
        """Within 0.5 %: elements of the programs differ in details that these decks do not resolve."""
        if not DECKS.is_dir():
            self.skipTest(f"{DECKS} is not there")
        expected = json.loads((DECKS / "frequencies.json").read_text(encoding="utf-8"))[deck][:modes]
        found = self.frequencies(DECKS / deck, "--modes", str(len(expected)))
        for mode, (one, other) in enumerate(zip(found, expected, strict=True), 1):
            self.assertLess(abs(one / other - 1), 0.005, f"mode {mode}: {one} Hz, reference {other} Hz")

    def test_a_deck_in_old_syntax_has_the_modes_of_the_same_deck_in_modern_syntax(self):
        self.write("old.bdf", OLD)
        self.write("modern.bdf", MODERN)
        self.assertEqual(self.frequencies("old.bdf"), self.frequencies("modern.bdf"))

    def test_a_swept_wing_of_msc_nastran_has_its_modes(self):
        self.agree("pt145.bdf")

    def test_a_beam_of_cbar_and_one_cbeam_with_lumped_mass_has_the_modes_of_nx_nastran(self):
        self.agree("beam_modes.dat")

    def test_solids_laminates_and_a_tapered_beam_have_the_modes_of_msc_nastran(self):
        self.agree("mode_solid_shell_bar.bdf")

    def test_pyramids_and_coarse_shells_have_the_modes_of_nx_nastran(self):
        # The deck asks for modes up to 2000 Hz: eight. The six others of the reference lie above.
        self.agree("nx_sine.bdf", 8)

    def test_a_satellite_of_orthotropic_sandwich_is_solved_with_its_mass(self):
        if not DECKS.is_dir():
            self.skipTest(f"{DECKS} is not there")
        out = self.succeed("modes", DECKS / "ISat_Launch_Sm_Rgd.dat", "--modes", "7", "--out", "modes").out
        self.assertRegex(out, r"mass: 1\.7746 along x")
        self.assertIn("7 modes, none missed", out)

    def test_a_shaft_of_cbar_has_the_torsional_inertia_of_its_disc_alone(self):
        # One element, J = 1e-8: w^2 = G J / (L I). A CBEAM adds rho (I1 + I2) L / 2 = 1e4 * 2e-7 * 1 / 2 where mass is lumped.
        shaft = ("CEND\nSPC = 1\nBEGIN BULK\nEIGRL,1,,,1\nGRID,1\nGRID,2,,1.\nSPC1,1,123456,1\nSPC1,1,12356,2\n"
                 "MAT1,1,,8.+10,.3,1.+4\n{}\n{},1,1,1,2,0.,1.,0.\nCONM2,2,2,,0.\n,.001\n")
        for element, section, inertia in (("CBAR", "PBAR,1,1,1.-3,1.-7,1.-7,1.-8", 0.001),
                                          ("CBEAM", "PBEAM,1,1,1.-3,1.-7,1.-7,,1.-8", 0.002)):
            self.write("shaft.bdf", shaft.format(section, element))
            exact = math.sqrt(8e10 * 1e-8 / inertia) / (2 * math.pi)
            self.assertAlmostEqual(self.frequencies("shaft.bdf", "--modes", "1")[0] / exact, 1, 10)

    def test_bars_need_no_poissons_ratio_where_e_and_g_are_given(self):
        """MAT1 of a public deck: NU = 2.5 beside E and G; blank, it would be E / 2G - 1, of the same size."""
        found = []
        for poisson in ("", "2.5"):
            self.write("bars.bdf", MODERN.replace("7.+10,,.3", f"7.+10,1.+10,{poisson}"))
            self.succeed("modes", "bars.bdf", "--out", "modes")
            found.append(support.read_csv(self.folder / "modes" / "modes.csv"))
        self.assertEqual(*found)
        self.write("bars.bdf", MODERN.replace("7.+10,,.3", "7.+10,,2.5"))
        ended = self.call("modes", "bars.bdf", "--out", "modes")
        self.assertEqual(ended.code, 2)
        self.assertIn("MAT1 1: NU is 2.5, it must lie in (-1, 0.5] unless E and G are both given", ended.err)

    def test_the_range_of_eigrl_says_how_many_modes_are_solved(self):
        self.write("deck.bdf", MODERN)
        all_of = self.frequencies("deck.bdf", "--modes", "9")
        below = [f for f in all_of if f < 0.5 * (all_of[6] + all_of[7])]
        for v1, v2, nd, expected in (("", f"{0.5 * (all_of[6] + all_of[7]):.1f}", "", below),
                                     ("", f"{0.5 * (all_of[6] + all_of[7]):.1f}", "3", all_of[:3]),
                                     (f"{0.5 * (all_of[1] + all_of[2]):.1f}", "", "4", all_of[:6])):
            self.write("deck.bdf", support.edited(MODERN, ("EIGRL,10,,,6", f"EIGRL,10,{v1},{v2},{nd}")))
            found = self.frequencies("deck.bdf")
            self.assertEqual(len(found), len(expected), (v1, v2, nd))
            for one, other in zip(found, expected, strict=True):
                self.assertAlmostEqual(one / other, 1, 8)

    def test_a_static_subcase_in_front_is_not_that_of_the_modes(self):
        self.write("one.bdf", MODERN)
        self.write("two.bdf", support.edited(MODERN, ("SPC = 1\nMETHOD = 10\n",
                                                      "SUBCASE 1\nSPC = 2\nSUBCASE 2\nSPC = 1\nMETHOD = 10\n"),
                                             ("SPC1,1,123456,1\n", "SPC1,1,123456,1\nSPC1,2,123456,1,4\n")))
        self.assertEqual(self.frequencies("two.bdf"), self.frequencies("one.bdf"))
        self.assertGreater(self.frequencies("two.bdf", "--subcase", "1")[0], 2 * self.frequencies("one.bdf")[0])

    def test_a_deck_without_mass_says_so(self):
        for deck in (MODERN, support.edited(MODERN, ("SPC = 1\n", "SPC = 2\n"), ("SPC1,1,123456,1", "SPC1,2,123,1"))):
            self.write("deck.bdf", support.edited(deck, (",2700.", "")))
            ended = self.call("modes", "deck.bdf")
            self.assertEqual(ended.code, 2, ended.err)
            self.assertIn("deck.bdf: the model has no mass, and so no natural modes", ended.err)

    def test_a_rigid_body_mode_has_the_frequency_zero(self):
        # Held but for the motion along x: one rigid-body mode, and the modes of a free rod above it.
        self.write("deck.bdf", support.edited(MODERN, ("SPC1,1,123456,1", "SPC1,1,23456,1,2,3,4")))
        ended = self.succeed("modes", "deck.bdf", "--json", "--modes", "1").out
        self.assertEqual(json.loads(ended)["frequencies"], [0.0])
        self.assertNotIn("null", ended)
        found = self.succeed("modes", "deck.bdf", "--modes", "3").out
        self.assertRegex(found, r"(?m)^1 +0 ")
        self.assertNotIn("nan", found)
        self.assertGreater(self.frequencies("deck.bdf", "--modes", "2")[1], 1000.0)


if __name__ == "__main__":
    support.main()
