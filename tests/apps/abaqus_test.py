"""Studies on Abaqus decks through CalculiX: the same structure written flat by hand has the same frequencies.

    python3 abaqus_test.py PATH_TO_MOTTLE
"""

import json
import shutil
import subprocess
import unittest

import support
from calculix_test import frequencies_of
from support import edited

CROSS = [(y, z) for y in (0.0, 0.2) for z in (0.0, 0.1)]
BAR = [(0.5 * x, y, z) for x in range(7) for y, z in CROSS]
BRICKS = [[4 * a + k for k in (1, 5, 7, 3, 2, 6, 8, 4)] for a in range(6)]


def rows(first, items):
    return "\n".join(f"{first + k}, " + ", ".join(map(str, item)) for k, item in enumerate(items))


# Two bars: the second one stands on the end of the first one, held by springs, and has a mass on three more.
PARTS = f"""*Heading
** Job name: bars
*Preprint, echo=NO, model=NO, history=NO, contact=NO
*Part, name=Bar
*Node
{rows(1, BAR)}
*Element, type=C3D8
{rows(1, BRICKS)}
*Nset, nset=Root, generate
 1, 4, 1
*Elset, elset=All, generate
 1, 6, 1
*Solid Section, elset=All, material=Steel
,
*End Part
*Assembly, name=Assembly
*Instance, name=Bar-1, part=Bar
*End Instance
*Instance, name=Bar-2, part=Bar
 3., 0., 0.
 3., 0., 0., 3., 0., 1., 90.
*End Instance
*Node
 1, 3., 4., 0.
*Nset, nset=Foot, internal, instance=Bar-1
 1, 2
*Nset, nset=Foot, internal, instance=Bar-1
 3, 4
*Element, type=Mass, elset=Tip
 1, 1
*Mass, elset=Tip
 300.
*Element, type=Spring2, elset=Joint1
 11, Bar-1.25, Bar-2.1
 12, Bar-1.26, Bar-2.2
 13, Bar-1.28, Bar-2.4
*Spring, elset=Joint1
1, 1
 1e9
*Element, type=Spring2, elset=Joint2
 21, Bar-1.25, Bar-2.1
 22, Bar-1.26, Bar-2.2
 23, Bar-1.28, Bar-2.4
*Spring, elset=Joint2
2, 2
 2e9
*Element, type=Spring2, elset=Joint3
 31, Bar-1.25, Bar-2.1
 32, Bar-1.26, Bar-2.2
 33, Bar-1.28, Bar-2.4
*Spring, elset=Joint3
3, 3
 3e9
*Element, type=Spring2, elset=Held1
 41, Bar-2.28, 1
*Spring, elset=Held1
1, 1
 1e6
*Element, type=Spring2, elset=Held2
 42, Bar-2.28, 1
*Spring, elset=Held2
2, 2
 2e6
*Element, type=Spring2, elset=Held3
 43, Bar-2.28, 1
*Spring, elset=Held3
3, 3
 3e6
*End Assembly
*Material, name=Steel
*Density
7800.,
*Elastic
 2.1e+11, 0.3
*Boundary
Foot, ENCASTRE
*Boundary
Bar-2.Root, 3, 3
** held in its own plane
*Step, name=Modes, nlgeom=NO, perturbation
*Frequency, eigensolver=Lanczos, acoustic coupling=on, normalization=mass
8, , , , ,
*Restart, write, frequency=0
*Output, field, variable=PRESELECT
*Output, history
*Node Output, nset=Bar-1.Root
U,
*End Step
"""

MASS_NODE, MASS_ELEMENT = 901, 901


def flat():
    """By another way: the second bar's nodes from the turn by hand, (x, y) -> (3 - y, x)."""
    second = [(3.0 - y, x, z) for x, y, z in BAR]
    lines = ["*NODE", rows(1, BAR), rows(101, second), f"{MASS_NODE}, 3., 4., 0.", "*ELEMENT, TYPE=C3D8, ELSET=BARS", rows(1, BRICKS),
             rows(101, [[100 + k for k in brick] for brick in BRICKS])]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "2.1e11, 0.3", "*DENSITY", "7800.", "*SOLID SECTION, ELSET=BARS, MATERIAL=STEEL",
              f"*ELEMENT, TYPE=MASS, ELSET=TIP\n{MASS_ELEMENT}, {MASS_NODE}\n*MASS, ELSET=TIP\n300."]
    for axis in (1, 2, 3):
        ends = "\n".join(f"{200 + 10 * axis + k}, {a}, {100 + b}" for k, (a, b) in enumerate(((25, 1), (26, 2), (28, 4))))
        lines += [f"*ELEMENT, TYPE=SPRING2, ELSET=J{axis}", ends, f"*SPRING, ELSET=J{axis}\n{axis}, {axis}\n{axis}.e9",
                  f"*ELEMENT, TYPE=SPRING2, ELSET=H{axis}\n{300 + axis}, 128, {MASS_NODE}",
                  f"*SPRING, ELSET=H{axis}\n{axis}, {axis}\n{axis}.e6"]
    lines += ["*BOUNDARY", *(f"{node}, 1, 3" for node in range(1, 5)), *(f"{node}, 3, 3" for node in range(101, 105)),
              "*STEP", "*FREQUENCY", "8", "*END STEP", ""]
    return "\n".join(lines)


# As Abaqus/CAE writes it: bars tied end to end, and a reference point with a mass that a coupling holds.
TIED = PARTS[:PARTS.index("*Instance, name=Bar-2")] + """*Instance, name=Bar-2, part=Bar
 3., 0., 0.
*End Instance
*Node
 1, 6.5, 0.1, 0.05
*Nset, nset=m_Set-1
 1,
*Elset, elset=_Far_S4, internal, instance=Bar-1
 6,
*Surface, type=ELEMENT, name=Far
_Far_S4, S4
*Elset, elset=_Near_S6, internal, instance=Bar-2
 1,
*Surface, type=ELEMENT, name=Near
_Near_S6, S6
*Elset, elset=_Tip_S4, internal, instance=Bar-2
 6,
*Surface, type=ELEMENT, name=Tip
_Tip_S4, S4
*Element, type=MASS, elset=Point
 1, 1
*Mass, elset=Point
500.,
** Constraint: joint
*Tie, name=Joint, adjust=yes
Near, Far
*Coupling, constraint name=Hold, ref node=m_Set-1, surface=Tip
*Kinematic
1, 2
3, 3
4, 6
*End Assembly
*Material, name=Steel
*Density
7800.,
*Elastic
 2.1e+11, 0.3
** BOUNDARY CONDITIONS
*Boundary
Bar-1.Root, 1, 1
Bar-1.Root, 2, 2
Bar-1.Root, 3, 3
*Step, name=Modes, nlgeom=NO, perturbation
*Frequency, eigensolver=Lanczos, acoustic coupling=on, normalization=mass
6, , , , ,
*Output, field, variable=PRESELECT
*End Step
"""


def flat_tied():
    second = [(3.0 + x, y, z) for x, y, z in BAR]
    return "\n".join(["*NODE", rows(1, BAR), rows(101, second), "901, 6.5, 0.1, 0.05", "*ELEMENT, TYPE=C3D8, ELSET=BARS", rows(1, BRICKS),
                      rows(101, [[100 + k for k in brick] for brick in BRICKS]), "*ELEMENT, TYPE=MASS, ELSET=POINT\n901, 901",
                      "*SURFACE, NAME=FAR\n6, S4", "*SURFACE, NAME=NEAR\n101, S6", "*SURFACE, NAME=TIP\n106, S4",
                      "*MATERIAL, NAME=STEEL", "*ELASTIC", "2.1e11, 0.3", "*DENSITY", "7800.", "*SOLID SECTION, ELSET=BARS, MATERIAL=STEEL",
                      "*MASS, ELSET=POINT\n500.", "*TIE, NAME=J\nNEAR, FAR", "*COUPLING, CONSTRAINT NAME=H, REF NODE=901, SURFACE=TIP",
                      "*KINEMATIC\n1, 3", "*BOUNDARY", *(f"{node}, 1, 3" for node in range(1, 5)), "*STEP", "*FREQUENCY", "6", "*END STEP", ""])


STUDY = """\
[model]
kind = "calculix"
file = "bars.inp"
[[parameter]]
name = "E"
target = "*ELASTIC:STEEL:E"
distribution = { kind = "normal", mean = 2.1e11, std = 5e9 }
[[parameter]]
name = "k"
target = "*SPRING:HELD1"
relative = true
distribution = { kind = "lognormal", mean = 1.0, std = 0.1 }
[outputs]
frequencies = [1, 2, 3]
tracking = "order"
"""


def plate(nodes_along, size):
    return [(size * i / nodes_along, size * j / nodes_along, 0.0) for j in range(nodes_along + 1) for i in range(nodes_along + 1)]


def quadrangles(along, first=1):
    return [[first + j * (along + 1) + i + k for k in (0, 1, along + 2, along + 1)] for j in range(along) for i in range(along)]


def shell_part(name, thickness, size):
    return f"""*Part, name={name}
*Node
{rows(1, plate(4, size))}
*Element, type=S4R
{rows(1, quadrangles(4))}
*Elset, elset=Skin, generate
1, 16, 1
*Nset, nset=Edge, generate
1, 5, 1
*Shell Section, elset=Skin, material=Steel
{thickness}, 5
*End Part
"""


SHELLS = shell_part("Thin", 0.02, 1.0) + shell_part("Thick", 0.03, 0.8) + """*Assembly, name=A
*Instance, name=T-1, part=Thin
*End Instance
*Instance, name=T-2, part=Thick
0., 0., 1.
*End Instance
*End Assembly
*Material, name=Steel
*Elastic
2.1e11, 0.3
*Density
7800.
*Boundary
T-1.Edge, ENCASTRE
T-2.Edge, 1, 6
*Step, perturbation
*Frequency
6,
*Output, field
*Node Output
U
*End Step
"""


def flat_shells():
    """With S4, which CalculiX's S4R is not: of a cantilever plate of 20 x 20 S4R the first frequency is 70 % too low."""
    upper = [(x, y, 1.0) for x, y, _ in plate(4, 0.8)]
    return "\n".join(["*NODE", rows(1, plate(4, 1.0)), rows(101, upper), "*ELEMENT, TYPE=S4, ELSET=A", rows(1, quadrangles(4)),
                      "*ELEMENT, TYPE=S4, ELSET=B", rows(101, quadrangles(4, 101)), "*MATERIAL, NAME=STEEL\n*ELASTIC\n2.1e11, 0.3",
                      "*DENSITY\n7800.", "*SHELL SECTION, ELSET=A, MATERIAL=STEEL\n0.02", "*SHELL SECTION, ELSET=B, MATERIAL=STEEL\n0.03",
                      "*BOUNDARY", *(f"{node}, 1, 6" for node in (1, 2, 3, 4, 5, 101, 102, 103, 104, 105)),
                      "*STEP\n*FREQUENCY\n6\n*END STEP\n"])


@unittest.skipUnless(shutil.which("ccx"), "needs CalculiX: apt-get install calculix-ccx")
class AbaqusTest(support.CommandTest):
    def setUp(self):
        super().setUp()
        self.write("bars.inp", PARTS)
        self.write("study.toml", STUDY)

    def assert_equal_frequencies(self, found, deck):
        for mode, expected in enumerate(frequencies_of(self.folder, deck)):
            self.assertLess(abs(found[mode] / expected - 1), 1e-5, f"mode {mode + 1}: {found[mode]} instead of {expected}")

    def test_parts_have_the_frequencies_of_the_same_structure_written_flat(self):
        self.write("points.csv", "E,k\n1.9e11,0.5\n2.3e11,2\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out")
        header, cloud = support.read_csv(self.folder / "out" / "cloud.csv")
        for row, (young, spring) in zip(cloud, (("1.9e11", "5.e5"), ("2.3e11", "2.e6")), strict=True):
            deck = edited(flat(), ("2.1e11", young), ("1, 1\n1.e6", f"1, 1\n{spring}"))
            self.assert_equal_frequencies([float(row[header.index(f"f{mode}")]) for mode in (1, 2, 3)], deck)

    def test_ties_and_couplings_are_those_of_a_flat_deck(self):
        self.write("bars.inp", TIED)
        self.write("study.toml", STUDY[:STUDY.index('[[parameter]]\nname = "k"')] + STUDY[STUDY.index("[outputs]"):])
        found = json.loads(self.succeed("check", "study.toml", "--json").out)["frequencies"]
        self.assert_equal_frequencies(found, flat_tied())

    def test_what_is_left_out_and_how_instances_are_numbered_is_told(self):
        out = " ".join(self.succeed("check", "study.toml").out.split())
        self.assertIn("left out *PREPRINT, *RESTART, *OUTPUT, *NODE OUTPUT", out)
        self.assertIn("instance BAR-2 have 1000 added", out)
        self.assertIn("of the assembly have 2000 added", out)
        self.assertNotIn("instance BAR-1", out)

    def test_runs_of_each_sample_have_shapes(self):
        study = edited(STUDY, ("*ELASTIC:STEEL:E", "*ELASTIC:STEEL:NU"), ("mean = 2.1e11, std = 5e9", "mean = 0.3, std = 0.01"),
                       ('tracking = "order"', 'shapes = { modes = [1], dofs = ["28:+X", "1028:+X"] }'))
        self.write("study.toml", study)
        self.write("points.csv", "E,k\n0.25,1\n")
        self.assertIn("each sample is a run", self.succeed("check", "study.toml").out)
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out")
        header, cloud = support.read_csv(self.folder / "out" / "cloud.csv")
        self.assert_equal_frequencies([float(cloud[0][header.index(f"f{mode}")]) for mode in (1, 2, 3)],
                                      edited(flat(), ("2.1e11, 0.3", "2.1e11, 0.25")))

    def test_sections_of_two_parts_are_told_apart(self):
        self.write("shells.inp", SHELLS)
        study = edited(STUDY[:STUDY.index('[[parameter]]\nname = "k"')], ("bars", "shells"), ("*ELASTIC:STEEL:E", "*SHELL SECTION:SKIN:T"),
                       ("mean = 2.1e11, std = 5e9", "mean = 0.025, std = 0.001")) + "[outputs]\nfrequencies = [1, 2, 3]\ntracking = 'order'\n"
        self.write("shells.toml", study)
        ended = self.call("check", "shells.toml")
        self.assertEqual(ended.code, 2)
        self.assertIn("there are THICK.SKIN, THIN.SKIN; name one", ended.err)
        self.write("shells.toml", edited(study, ("SECTION:SKIN", "SECTION:THICK.SKIN")))
        found = json.loads(self.succeed("check", "shells.toml", "--json").out)["frequencies"]
        self.assert_equal_frequencies(found, edited(flat_shells(), ("0.03", "0.025")))

    def test_export_writes_the_deck_as_its_author_did(self):
        self.write("tests.csv", "f1,f2,f3\n" + "\n".join(",".join(str(f * k) for f in frequencies_of(self.folder, flat())) for k in (1, 1.01, 1.02)))
        self.write("study.toml", STUDY + '[test]\nfile = "tests.csv"\n')
        self.succeed("update", "study.toml", "--set", 'update.method="deterministic"', "--out", "out", "--quiet")
        self.succeed("export", "out", "--quiet")
        mean = support.read_result(self.folder / "out")["parameters"]["mean"]
        written = (self.folder / "out" / "export" / "mean" / "bars.inp").read_text()
        values = [value if "." in value else value + "." for value in (f"{mean[0]:.12g}", f"{1e6 * mean[1]:.12g}")]
        self.assertEqual(written, edited(PARTS, (" 2.1e+11, 0.3", f"{values[0]}, 0.3"), (" 1e6\n", f"{values[1]}\n")))

    def test_what_has_no_place_in_a_flat_deck_is_refused(self):
        for change, phrase in (((" 3., 0., 0.\n 3.,", " 3., x, 0.\n 3.,"), "its placement has 'x'"),
                               (("part=Bar\n 3.", "part=Bor\n 3."), "did you mean 'BAR'?"),
                               (("*Solid Section", "*Orientation, name=O\n1,0,0,0,1,0\n*Solid Section"), "instance BAR-2 is rotated"),
                               (("*Solid Section", "*Hourglass Stiffness\n1.\n*Solid Section"), "inside a part is not read"),
                               (("*Boundary\nBar-2", "*Rotary Inertia, elset=Tip\n1.\n*Boundary\nBar-2"), "CalculiX does not know"),
                               (("*End Part\n", ""), "*ASSEMBLY inside of a PART"),
                               (("instance=Bar-1\n 1, 2", "instance=Bar-9\n 1, 2"), "BAR-9")):
            with self.subTest(change=change):
                self.write("bars.inp", edited(PARTS, change))
                ended = self.call("check", "study.toml")
                self.assertEqual(ended.code, 2, ended.err)
                self.assertIn(phrase, ended.err)


if __name__ == "__main__":
    support.main()
