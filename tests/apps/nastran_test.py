"""Studies on a Nastran deck and `mottle modes`: numbers against closed forms, messages, files, the same numbers again.

    python3 nastran_test.py PATH_TO_MOTTLE
"""

import base64
import json
import math
import re
import shutil
import struct
import unittest
import xml.etree.ElementTree as xml

import support
from support import edited, line_of, numbers, read_csv, read_result

LENGTH, YOUNG, DENSITY, AREA, INERTIA_1, INERTIA_2 = 1.0, 7.0e10, 2700.0, 6.0e-4, 2.0e-8, 4.5e-8
ROOTS = (1.8751040687119611, 4.694091132974175, 7.854757438237613)  # cosh(x) cos(x) = -1


def deck(elements=20):
    """A cantilever along x; plane 1 is x-y: I1 bends along y, I2 along z."""
    lines = ["SOL 103", "CEND", "METHOD = 1", "SPC = 1", "BEGIN BULK", "PARAM,COUPMASS,1", "EIGRL,1,,,4",
             "MAT1,1,7.+10,,.3,2700.", f"PBAR,1,1,{AREA:.1e},{INERTIA_1:.1e},{INERTIA_2:.1e},1.0-8"]
    lines += [f"GRID,{k + 1},,{k * LENGTH / elements:.5f},0.,0." for k in range(elements + 1)]
    lines += [f"CBAR,{k + 1},1,{k + 1},{k + 2},0.,1.,0." for k in range(elements)]
    return "\n".join(lines + ["SPC1,1,123456,1", "PELAS,9,1.0+4", f"CELAS1,99,9,{elements + 1},2", "ENDDATA"]) + "\n"


def cantilever(inertia, count=2):
    return [root**2 / (2 * math.pi) * math.sqrt(YOUNG * inertia / (DENSITY * AREA * LENGTH**4)) for root in ROOTS[:count]]


DECK = deck()
FREE_DECK = edited(DECK, ("PELAS,9,1.0+4\n", ""), ("CELAS1,99,9,21,2\n", ""))
STUDY = """\
title = "A beam"
[model]
kind = "nastran"
file = "deck.bdf"
[[parameter]]
name = "E"
target = "MAT1:1:E"
relative = true
distribution = { kind = "normal", mean = 1.0, std = 0.05 }
[[parameter]]
name = "I1"
target = "PBAR:1:I1"
distribution = { kind = "lognormal", mean = 4.0e-8, std = 1.0e-8 }
[outputs]
frequencies = [1, 2]
[update]
samples = 40
"""


class NastranTest(support.CommandTest):
    def setUp(self):
        super().setUp()
        self.write("deck.bdf", FREE_DECK)
        self.write("study.toml", STUDY)

    def refuse(self, *phrases):
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertEqual(ended.err.count("\n"), 1, ended.err)
        for phrase in phrases:
            self.assertIn(phrase, ended.err)

    def test_modes_agree_with_the_closed_form_of_a_cantilever(self):
        result = json.loads(self.succeed("modes", "deck.bdf", "--json").out)
        exact = sorted(cantilever(INERTIA_1) + cantilever(INERTIA_2))
        for found, expected in zip(result["frequencies"], exact):
            self.assertLess(abs(found / expected - 1), 1e-5)  # 20 cubic elements: (kh)^4 / 720 / 2 of the second mode
        self.assertEqual(result["counted_below"], 4)
        self.assertLess(abs(sum(result["mass"]) / 3 / (DENSITY * AREA * LENGTH) - 1), 1e-12)

    def test_modes_leaves_a_page_a_table_and_a_grid_for_paraview(self):
        self.succeed("modes", "deck.bdf", "--modes", 3, "--quiet")
        header, rows = read_csv(self.folder / "deck.modes" / "modes.csv")
        self.assertEqual((header, len(rows)), (["mode", "frequency", "residual"], 3))
        self.assertIn('"kind":"modes"', (self.folder / "deck.modes" / "modes.html").read_text(encoding="utf-8"))
        grid = xml.parse(self.folder / "deck.modes" / "modes.vtu").getroot()
        arrays = {array.get("Name"): base64.b64decode(array.text) for array in grid.iter("DataArray")}
        positions = struct.unpack(f"<{3 * 21}d", arrays["position"][4:])
        self.assertEqual(positions[-3:], (1.0, 0.0, 0.0))
        self.assertEqual(sum(name.startswith("mode ") for name in arrays), 3)

    def test_modes_pair_with_measured_shapes(self):
        # Static-like shapes: a tip motion along z is the first mode (I1 < I2: along y), so they pair 1 - y and 2 - z.
        self.write("shapes.csv", "dof,vertical,lateral\n21:+Z,1,0\n11:+Z,0.34,0\n21:+Y,0,1\n11:+Y,0,0.34\n")
        result = json.loads(self.succeed("modes", "deck.bdf", "--compare", "shapes.csv", "--json").out)
        mac = result["mac"]["values"]
        self.assertEqual(result["mac"]["columns"], ["vertical", "lateral"])
        self.assertGreater(mac[0][1], 0.999)
        self.assertGreater(mac[1][0], 0.999)

    def test_modes_follow_their_shape_through_a_crossing_and_say_so(self):
        # I1 from 2e-8 to far above I2 = 4.5e-8: mode 1 of the deck (along y) becomes the higher of the two.
        self.write("points.csv", "E,I1\n1.0,2.0e-8\n1.0,9.0e-8\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out")
        header, rows = read_csv(self.folder / "out" / "cloud.csv")
        along_y = [float(row[header.index("f1")]) for row in rows]
        for found, inertia in zip(along_y, (2.0e-8, 9.0e-8)):
            self.assertLess(abs(found / cantilever(inertia)[0] - 1), 1e-5)
        self.assertEqual([row[-1] for row in rows], ["ok", "ok: modes 1 and 2 crossed"])
        self.assertEqual(read_result(self.folder / "out")["tracking"],
                         [{"iteration": 0, "remark": "modes 1 and 2 crossed", "samples": 1}])

    def test_a_prior_at_whose_mean_there_are_no_modes_is_refused_before_anything_is_computed(self):
        # The deck's own modulus is sound; the parameter's was given in another unit by a factor of 7e12.
        example = support.SOURCE / "examples" / "02-airframe"
        for name in ("airframe.bdf", "specimens.csv"):
            self.write(name, (example / name).read_bytes())
        study = edited((example / "study-shapes.toml").read_text(encoding="utf-8"),
                       ("mean = 70e9, std = 1e9 }\nbounds = [66e9, 74e9]", "mean = 0.01, std = 1e-4 }\nbounds = [0.0096, 0.0104]"))
        self.write("study.toml", study + "[truth]\nspecimens = 3\n")
        for verb in ("check", "update", "propagate", "simulate"):
            ended = self.call(verb, "study.toml", "--out", "out", timeout=30)
            self.assertEqual(ended.code, 2, f"{verb}: {ended.err}")
            self.assertIn("it cannot be solved at the parameters' means", ended.err)
        self.assertFalse((self.folder / "out").exists())

    def test_threads_change_no_number(self):
        for threads in (1, 2):
            self.succeed("propagate", "study.toml", "--threads", threads, "--out", f"out{threads}", "--quiet")
        self.assertEqual(numbers(self.folder / "out1"), numbers(self.folder / "out2"))

    def test_check_says_how_each_parameter_enters(self):
        self.write("study.toml", edited(STUDY, ("PBAR:1:I1", "MAT1:1:NU"), ("mean = 4.0e-8, std = 1.0e-8", "mean = 0.3, std = 0.01")))
        self.write("deck.bdf", FREE_DECK.replace("PBAR,1,1", "PBARL,1,1,,ROD\n,.01\n$"))
        out = self.succeed("check", "study.toml").out
        self.assertRegex(out, r"E +MAT1:1:E .*exactly separable, linearly")
        self.assertRegex(out, r"NU|I1 +MAT1:1:NU .*re-assembled")

    def test_check_says_what_moves_two_modes_of_one_frequency(self):
        """They have no derivative; half the relative change of a modulus is what it changes in both."""
        self.write("deck.bdf", edited(FREE_DECK, (f"{INERTIA_2:.1e}", f"{INERTIA_1:.1e}")))
        self.write("study.toml", STUDY[:STUDY.index('[[parameter]]\nname = "I1"')] + STUDY[STUDY.index("[outputs]"):])
        out = self.succeed("check", "study.toml").out
        self.assertRegex(out, r"f1 .* E \+2\.5 %")
        self.assertRegex(out, r"E changes f[12] most: \+2\.5 % by one prior")

    def test_a_changed_deck_cannot_be_resumed(self):
        self.succeed("propagate", "study.toml", "--out", "out", "--quiet")
        (self.folder / "out" / "resume.journal").write_bytes(b"mottle journal 3\n1234567812345678")
        ended = self.call("propagate", "study.toml", "--out", "out", "--resume")
        self.assertEqual(ended.code, 2)
        self.assertIn("have changed", ended.err)

    def test_wrong_targets_name_what_there_is(self):
        for target, phrases in {
            "MAT1:7:E": ("parameter 'E'", "the deck has no MAT1 7; it has 1"),
            "MAT1:1:K": ("parameter 'E'", "Known: E, NU, RHO"),
            "MAT2:1:E": ("parameter 'E'", "did you mean 'MAT1'"),
            "MAT1:1": ("is not CARD:ID:FIELD",),
            "PELAS:9:K": ("card 'PELAS' is not known here",),
        }.items():
            with self.subTest(target):
                self.write("study.toml", edited(STUDY, ('"MAT1:1:E"', f'"{target}"')))
                self.refuse("study.toml:", *phrases)

    def test_a_prediction_does_not_override_a_target_however_it_is_written(self):
        predict = '[test]\nfile = "tests.csv"\n[predict]\nfrequencies = [1]\nmodel = { "MAT1:1:E" = 6.0e10 }\n'
        self.write("tests.csv", "f1,f2\n23.2,24.6\n23.3,24.7\n23.1,24.9\n23.4,24.5\n")
        self.write("study.toml", edited(STUDY, ('"MAT1:1:E"', '"mat1:1:e"')) + predict)
        self.refuse("study.toml:", "is what parameter 'E' acts on")

    def test_a_number_that_no_element_uses_is_no_target(self):
        self.write("deck.bdf", FREE_DECK.replace("ENDDATA", "MAT1,2,1.+9,,.3\nENDDATA"))
        self.write("study.toml", edited(STUDY, ("MAT1:1:E", "MAT1:2:E")))
        self.refuse("parameter 'E'", "acts on nothing")

    def test_faults_of_the_deck_name_its_line(self):
        for old, new, phrase in (
            ("GRID,3,,0.10000,0.,0.", "GRID,3,,abc,0.,0.", "X1 is 'ABC'"),
            ("CBAR,5,1,5,6,0.,1.,0.", "CBAR,5,1,5,777,0.,1.,0.", "777"),
            ("PBAR,1,1,", "PBAR,1,4,", "MID is 4"),
            ("CBAR,7,1,7,8,0.,1.,0.", "CWELD,7,1,7,8,9,10,11,12", "ignore_cards"),
        ):
            with self.subTest(new):
                text = edited(FREE_DECK, (old, new))
                self.write("deck.bdf", text)
                self.refuse(f"deck.bdf:{line_of(text, new)}:", phrase)

    def test_an_element_that_cannot_be_is_named(self):
        self.write("deck.bdf", edited(FREE_DECK, ("GRID,3,,0.10000,0.,0.", "GRID,3,,0.05000,0.,0.")))
        ended = self.call("modes", "deck.bdf")
        self.assertEqual(ended.code, 2)
        self.assertIn("CBAR 2", ended.err)

    def test_a_deck_that_is_not_there(self):
        (self.folder / "deck.bdf").unlink()
        self.refuse("deck.bdf")

    def test_shapes_at_grid_points_that_the_deck_does_not_have(self):
        self.write("study.toml", edited(STUDY, ("frequencies = [1, 2]", 'frequencies = [1, 2]\nshapes = { modes = [1], dofs = ["77:+Z"] }')))
        self.refuse("outputs.shapes.dofs", "no grid point 77")

    def test_a_mechanism_is_reported_with_its_degree_of_freedom(self):
        loose = "PARAM,AUTOSPC,NO\nGRID,500,,5.,0.,0.\nGRID,501,,6.,0.,0.\nCELAS2,500,1.,500,1,501,1\n"
        self.write("deck.bdf", edited(FREE_DECK, ("PARAM,COUPMASS,1\n", loose)))
        ended = self.call("modes", "deck.bdf")
        self.assertEqual(ended.code, 2)
        self.assertRegex(ended.err, "50[01]:[+]X")

    def frequencies(self, lines):
        head = ["SOL 103", "CEND", "METHOD=1", "SPC=1", "BEGIN BULK", "EIGRL,1,,,6", "GRID,1,,0.,0.,0.", "GRID,2,,1.,0.,0.", "SPC1,1,123456,1",
                "PBUSH,1,K,1.+4,2.+4,3.+4,4.+3,5.+3,6.+3", "CBUSH,5,1,1,2,0.,1.,0.", "MAT1,1,7.+10,,.3,2700."]
        self.write("deck.bdf", "\n".join(head + lines + ["ENDDATA"]) + "\n")
        return json.loads(self.succeed("modes", "deck.bdf", "--json").out)["frequencies"]

    def test_terms_without_diagonal_hold_at_dependent_points(self):
        # A rigid element to a point at the same place changes nothing.
        body = "CONM2,9,{0},,2.\n,.5,-.1,.6,-.15,-.2,.7"
        bar = ("CONM2,9,2,,2.\n,.5,,.6,,,.7\nGRID,3,,2.,0.,0.\nCONM2,8,3,,1.\nCBAR,7,7,{0},3,0.,1.,0.\nPBAR,7,1,6.-4,2.-8,4.5-8,4.-8,,,+\n+\n+,,,2.-8")
        for card in (body, bar):
            own = self.frequencies([card.format(2)])
            for rigid in ("RBE2,60,2,123456,9", "RBAR,60,2,9,123456"):
                tied = self.frequencies(["GRID,9,,1.,0.,0.", rigid, card.format(9)])
                for one, other in zip(own, tied):
                    self.assertAlmostEqual(one / other, 1.0, delta=1e-9)

    def test_k1_and_k2_are_not_used_beside_i12(self):
        bar = "GRID,3,,1.2,0.,0.\nCONM2,8,3,,1.\nCBAR,7,7,2,3,0.,1.,0.\nPBAR,7,1,6.-4,2.-8,4.5-8,4.-8,,,+\n+\n+,{0},{0},2.-8"
        self.assertEqual(self.frequencies([bar.format("")]), self.frequencies([bar.format(".5")]))
        self.assertIn("PBAR 7: K1 and K2 are not used", self.succeed("modes", "deck.bdf").out)

    def test_shapes_of_decks_are_compared_along_the_same_axes(self):
        self.write("own.bdf", edited(DECK, ("PELAS,9,1.0+4\n", ""), ("CELAS1,99,9,21,2\n", "")))
        turned = "CORD2R,8,,0.,0.,0.,.3,1.,1.\n,1.,0.,0.\n"
        points = "".join(f"GRID,{k + 1},,{k * LENGTH / 20:.5f},0.,0." + (",8\n" if k else "\n") for k in range(21))
        plain = "".join(f"GRID,{k + 1},,{k * LENGTH / 20:.5f},0.,0.\n" for k in range(21))
        bars = "".join(f"CBAR,{k + 1},1,{k + 1},{k + 2},0.,1.,0.\n" for k in range(20))
        to_point = "GRID,91,,0.,5.,0.\nSPC1,1,123456,91\n" + "".join(f"CBAR,{k + 1},1,{k + 1},{k + 2},91\n" for k in range(20))
        text = (self.folder / "own.bdf").read_text(encoding="utf-8")
        self.write("turned.bdf", edited(text, (plain, turned + points), (bars, to_point)))
        found = self.succeed("modes", "own.bdf", "--compare", "turned.bdf").out
        self.assertEqual(found.count("MAC 1.000"), 4, found)

    def test_a_free_bar_is_told_of_its_missing_inertia(self):
        bar = edited(deck(1), ("SPC1,1,123456,1\nPELAS,9,1.0+4\nCELAS1,99,9,2,2\n", ""), ("SPC = 1\n", ""))  # pivots are exact
        self.write("deck.bdf", edited(bar, ("PARAM,COUPMASS,1\n", "")))
        ended = self.call("modes", "deck.bdf")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("+RX, a rotation without inertia", ended.err)

    def test_a_mode_far_above_the_others_is_found(self):
        # Free masses of 1 and 1e-5 on a spring of 1000: 0 and sqrt(1000 (1 + 1e5)) rad/s.
        lines = ["SOL 103", "CEND", "METHOD=1", "BEGIN BULK", "EIGRL,1,,,5", "SPOINT,1,2", "CMASS2,1,1.,1,0", "CMASS2,2,1.-5,2,0",
                 "CELAS2,3,1000.,1,0,2,0", "ENDDATA"]
        self.write("deck.bdf", "\n".join(lines) + "\n")
        found = json.loads(self.succeed("modes", "deck.bdf", "--json").out)["frequencies"]
        self.assertEqual(len(found), 2)
        self.assertAlmostEqual(found[1] / (math.sqrt(1000 * (1 + 1e5)) / (2 * math.pi)), 1.0, delta=1e-9)

    def test_points_that_nothing_acts_on_have_no_mode_without_autospc(self):
        self.write("other.bdf", edited(FREE_DECK, ("PARAM,COUPMASS,1\n", "PARAM,COUPMASS,1\nPARAM,AUTOSPC,NO\nGRID,500,,5.,0.,0.\n")))
        both = [json.loads(self.succeed("modes", deck, "--json").out) for deck in ("deck.bdf", "other.bdf")]
        self.assertEqual(both[0]["frequencies"], both[1]["frequencies"])
        self.assertEqual(both[1]["automatic_constraints"], both[0]["automatic_constraints"] + 6)

    def test_measured_modes_are_renumbered_by_their_shapes(self):
        self.write("study.toml", edited(STUDY, ("frequencies = [1, 2]", 'frequencies = [1, 2]\nshapes = { modes = [1, 2], '
                                                'dofs = ["21:+Y", "21:+Z"] }\n[test]\nfile = "tests.csv"\npairing = "mac"')))
        self.write("tests.csv", "f1,f2,phi1:21:+Y,phi1:21:+Z,phi2:21:+Y,phi2:21:+Z\n15.9,10.6,0,1.57,1.57,0\n15.8,10.5,0,1.58,-1.56,0\n")
        out = self.succeed("check", "study.toml").out
        self.assertIn("4 modes renumbered", out)
        self.assertIn("specimen 1 mode 2 is the model's 1 (MAC 1.00)", out)

    def test_an_update_recovers_the_modulus(self):
        truth = edited(STUDY, ("[update]\nsamples = 40\n", "[truth]\nspecimens = 12\n[[truth.parameter]]\nname = \"E\"\n"
                               "target = \"MAT1:1:E\"\nrelative = true\ndistribution = { kind = \"normal\", mean = 1.1, std = 0.03 }\n"
                               "[[truth.parameter]]\nname = \"I1\"\ntarget = \"PBAR:1:I1\"\n"
                               "distribution = { kind = \"normal\", mean = 3.0e-8, std = 1.0e-10 }\n"))
        self.write("truth.toml", truth)
        self.succeed("simulate", "truth.toml", "--out", "truth", "--quiet")
        self.write("study.toml", STUDY + 'method = "deterministic"\n[update.deterministic]\nregularisation = "none"\n'
                   '[test]\nfile = "truth/specimens.csv"\n')
        self.succeed("update", "study.toml", "--out", "out", "--quiet")
        result = read_result(self.folder / "out")
        drawn = read_csv(self.folder / "truth" / "specimens-truth.csv")
        mean = sum(float(row[drawn[0].index("E")]) for row in drawn[1]) / len(drawn[1])
        # Frequencies go with the root of E: the mean of roots is the root of the mean to a part of the variance, 1e-4.
        self.assertLess(abs(result["parameters"]["mean"][0] - mean), 1e-3)
        self.assertIn('"modes"', (self.folder / "out" / "report.html").read_text(encoding="utf-8"))

    def test_the_airframe_is_updated_by_its_reduced_model(self):
        """Eight parameters, consistent masses, inclined shells: hardly a sample is left to full solutions."""
        study = support.SOURCE / "examples" / "02-airframe" / "study.toml"
        self.succeed("update", study, "--out", "out", "--quiet", "--set", "update.starts=0")
        result = read_result(self.folder / "out")
        self.assertEqual(result["status"], "converged")
        self.assertLess(20 * result["reduction"]["exact_samples"], result["model_evaluations"])

    def test_an_update_by_the_reduced_model_comes_to_rest_on_logarithms(self):
        """Its derivatives by differences jump where another basis answers; the iteration went round in a circle."""
        airframe = support.SOURCE / "examples" / "02-airframe"
        for name in ("airframe.bdf", "specimens.csv"):
            shutil.copy(airframe / name, self.folder)
        text = (airframe / "study.toml").read_text(encoding="utf-8")
        self.write("log.toml", re.sub(r"(bounds = .*\n)", r'\1scale = "log"\n', text))
        self.succeed("update", "log.toml", "--out", "out", "--quiet", "--set", 'update.method="maximum-likelihood"',
                     "--set", "update.tolerance=1e-4", "--set", "update.starts=0")
        self.assertEqual(read_result(self.folder / "out")["status"], "converged")


if __name__ == "__main__":
    support.main()
