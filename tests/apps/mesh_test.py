"""Studies on meshes of Gmsh: frequencies against closed forms and CalculiX, parameters, an update, mistakes.

    python3 mesh_test.py PATH_TO_MOTTLE
"""

import json
import math
import os
import re
import shutil
import subprocess
import unittest

import support
from support import edited

MESHES = support.SOURCE / "tests" / "formats" / "gmsh"
PLATE = """\
units = "SI"
seed = 3
[model]
kind = "mesh"
file = "plate41.msh"
materials = [ { name = "aluminium", young = 70e9, poisson = 0.3, density = 2700 } ]
sections = [ { group = "plate", material = "aluminium", thickness = 0.002 } ]
supports = [ { group = "edges", directions = ["X", "Y", "Z"] } ]
[[parameter]]
name = "E"
target = "material:aluminium:young"
distribution = { kind = "normal", mean = 70e9, std = 2e9 }
[[parameter]]
name = "t"
target = "section:plate:thickness"
distribution = { kind = "normal", mean = 0.002, std = 0.00005 }
[outputs]
frequencies = [1, 2, 3]
"""
BAR = """\
[model]
kind = "mesh"
file = "beam.msh"
materials = [ { name = "steel", young = 2.1e11, poisson = 0.3, density = 7850 } ]
sections = [ { group = "bar", material = "steel" } ]
supports = [ { group = "clamp" } ]
[[parameter]]
name = "E"
target = "material:steel:young"
distribution = { kind = "normal", mean = 2.1e11, std = 1e10 }
[outputs]
frequencies = [1, 2, 3, 4]
tracking = "order"
"""
ARM = """\
[model]
kind = "mesh"
file = "frame.msh"
length_factor = 0.001
materials = [ { name = "steel", young = 2.1e11, poisson = 0.3, density = 7850 } ]
sections = [ { group = "arm", material = "steel", shape = "TUBE", dimensions = [0.01, 0.008], orientation = [0, 0, 1] } ]
supports = [ { group = "root" } ]
[[parameter]]
name = "r"
target = "section:arm:dimension_1"
distribution = { kind = "normal", mean = 0.01, std = 0.0001 }
[outputs]
frequencies = [1, 2]
tracking = "order"
"""


def points_of(mesh):
    """Nodes of an MSH 4.1 file, and its ten-node tetrahedra in the order of CalculiX."""
    lines = iter(mesh.read_text().splitlines())
    nodes, elements = {}, []
    for line in lines:
        if line == "$Nodes":
            for _ in range(int(next(lines).split()[0])):
                count = int(next(lines).split()[3])
                tags = [int(next(lines)) for _ in range(count)]
                for tag in tags:
                    nodes[tag] = [float(word) for word in next(lines).split()]
        if line == "$Elements":
            for _ in range(int(next(lines).split()[0])):
                _, _, kind, count = map(int, next(lines).split())
                for _ in range(count):
                    words = [int(word) for word in next(lines).split()]
                    if kind == 11:
                        elements.append(words[:9] + [words[10], words[9]])
    return nodes, elements


class MeshTest(support.CommandTest):
    def setUp(self):
        super().setUp()
        for mesh in MESHES.glob("*.msh"):
            shutil.copy(mesh, self.folder)

    def frequencies(self, study, *arguments):
        self.write("study.toml", study)
        return json.loads(self.succeed("check", "study.toml", "--json", *arguments).out)["frequencies"]

    def test_a_plate_on_simple_supports_has_naviers_frequencies(self):
        # f = pi / 2 (m^2 / a^2 + n^2 / b^2) sqrt(D / (rho t)), t / b = 1 / 200. Of 12 by 8 elements with consistent mass they
        # come out too high, by the order of the squared phase of a wave across an element; meshes of 2 and 4 times as many
        # elements a side had a quarter and a sixteenth of it.
        stiffness = 70e9 * 0.002**3 / 12 / (1 - 0.3**2)
        waves = sorted((m * m / 0.36 + n * n / 0.16, (m / 12) ** 2 + (n / 8) ** 2) for m in range(1, 5) for n in range(1, 5))
        for own, (wave, phase) in zip(self.frequencies(PLATE)[:3], waves):
            exact = math.pi / 2 * wave * math.sqrt(stiffness / (2700 * 0.002))
            self.assertGreater(own / exact - 1, 0.0)
            self.assertLess(own / exact - 1, math.pi**2 * phase / 12)

    def test_both_versions_of_a_mesh_give_the_same_frequencies(self):
        now = self.frequencies(PLATE)
        before = self.frequencies(edited(PLATE, ("plate41", "plate22")))
        for one, other in zip(now, before):
            self.assertLess(abs(one / other - 1), 1e-10)

    @unittest.skipUnless(shutil.which("ccx"), "needs CalculiX: apt-get install calculix-ccx")
    def test_second_order_tetrahedra_have_the_frequencies_of_calculix(self):
        nodes, elements = points_of(MESHES / "beam.msh")
        deck = ["*NODE, NSET=ALL", *(f"{tag}, {x!r}, {y!r}, {z!r}" for tag, (x, y, z) in nodes.items()), "*ELEMENT, TYPE=C3D10, ELSET=BAR"]
        deck += [", ".join(map(str, words)) for words in elements]
        deck += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "2.1e11, 0.3", "*DENSITY", "7850.", "*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL", "*BOUNDARY"]
        deck += [f"{tag}, 1, 3" for tag, (x, _, _) in nodes.items() if x == 0.0]
        self.write("bar.inp", "\n".join(deck + ["*STEP", "*FREQUENCY", "4", "*END STEP", ""]))
        subprocess.run(["ccx", "bar"], cwd=self.folder, check=True, stdout=subprocess.DEVNULL,
                       env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})
        rows = re.findall(r"^ +\d+ +\d\.\d+E[+-]\d+ +\S+ +(\d\.\d+E[+-]\d+) +\S+$", (self.folder / "bar.dat").read_text(), re.M)
        own = self.frequencies(BAR)
        for one, other in zip(own[:4], rows):
            self.assertLess(abs(one / float(other) - 1), 5e-5, "CalculiX rounds the mass off, see validation/elements")

    def test_bars_of_all_second_order_solids_agree(self):
        tetrahedra = self.frequencies(BAR)[:3]
        for mesh, tolerance in (("hexahedra20", 1e-2), ("prisms15", 1e-2), ("pyramids13", 1e-2)):
            for one, other in zip(self.frequencies(edited(BAR, ("beam.msh", f"{mesh}.msh"))), tetrahedra):
                self.assertLess(abs(one / other - 1), tolerance, mesh)

    def test_plates_of_second_order_shells_have_naviers_frequencies(self):
        stiffness = 70e9 * 0.002**3 / 12 / (1 - 0.3**2)
        waves = sorted(m * m / 0.36 + n * n / 0.16 for m in range(1, 5) for n in range(1, 5))[:3]
        for mesh in ("quadrangles8", "triangles6"):
            for one, wave in zip(self.frequencies(edited(PLATE, ("plate41", mesh))), waves):
                exact = math.pi / 2 * wave * math.sqrt(stiffness / (2700 * 0.002))
                self.assertLess(abs(one / exact - 1), 0.02, mesh)

    def test_a_tube_with_a_mass_has_the_frequencies_of_beams(self):
        outer, inner = 0.01, 0.008
        inertia, area = math.pi / 4 * (outer**4 - inner**4), math.pi * (outer**2 - inner**2)
        own = self.frequencies(ARM)
        exact = 1.87510406871**2 / (2 * math.pi) * math.sqrt(2.1e11 * inertia / (7850 * area))
        self.assertLess(abs(own[0] / exact - 1), 2e-3, "shear takes (r / L)^2 of it")
        self.assertLess(abs(own[0] / own[1] - 1), 1e-9)
        loaded = self.frequencies(edited(ARM, ("[[parameter]]", 'masses = [ { group = "tip", mass = 50.0 } ]\n[[parameter]]')))
        rod = 3 * 2.1e11 * inertia / 1.0
        self.assertLess(abs(loaded[0] / (math.sqrt(rod / (50.0 + 33 / 140 * 7850 * area)) / (2 * math.pi)) - 1), 2e-3)
        sprung = self.frequencies(edited(ARM, ("[[parameter]]", 'masses = [ { group = "tip", mass = 50.0 } ]\n'
                                               'springs = [ { name = "k", groups = ["tip"], direction = "Y", stiffness = 1e5 } ]\n[[parameter]]')))
        stiff = math.sqrt((rod + 1e5) / 50.0) / (2 * math.pi)
        self.assertTrue(any(abs(f / stiff - 1) < 0.01 for f in sprung), sprung)

    def test_parameters_move_what_their_targets_name(self):
        self.write("study.toml", PLATE)
        self.write("points.csv", "E,t\n70e9,0.002\n77e9,0.002\n70e9,0.0022\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "out")
        header, rows = support.read_csv(self.folder / "out" / "cloud.csv")
        first, stiff, thick = (float(row[header.index("f1")]) for row in rows)
        self.assertLess(abs(stiff / first - math.sqrt(1.1)), 1e-9)
        self.assertLess(abs(thick / first - 1.1), 1e-3, "the thin plate's bending")
        self.assertIn("exactly separable", self.succeed("check", "study.toml").out)

    def test_an_update_finds_the_scatter_and_shows_the_elements(self):
        self.write("study.toml", PLATE)
        self.write("points.csv", "E,t\n" + "".join(f"{70e9 * (1 + 0.01 * (k % 4))},{0.002 * (1 + 0.002 * (k % 5))}\n" for k in range(12)))
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "truth")
        header, rows = support.read_csv(self.folder / "truth" / "cloud.csv")
        columns = [header.index(f"f{mode}") for mode in (1, 2, 3)]
        self.write("tests.csv", "f1,f2,f3\n" + "".join(",".join(row[c] for c in columns) + "\n" for row in rows))
        self.write("study.toml", PLATE + '[test]\nfile = "tests.csv"\nrepeatability = { f1 = 0.05, f2 = 0.05, f3 = 0.05 }\n[update]\nsamples = 50\n')
        self.succeed("update", "study.toml", "--out", "out")
        result = json.loads((self.folder / "out" / "result.json").read_text())
        self.assertEqual(result["parameters"]["units"], ["Pa", "m"])
        parts = json.loads((self.folder / "out" / "modes.json").read_text())["modes"]["parameters"]
        self.assertTrue(all(part["triangles"] for part in parts), "elements to colour")
        self.succeed("export", "out", "--out", "exported")

    def test_mistakes_are_told_where_they_are(self):
        for change, phrase in ((('group = "plate"', 'group = "plat"'), "model.sections[0].group: physical group 'plat' is not known here; did you mean 'plate'?"),
                               (("thickness = 0.002 ", "area = 1.0 "), "model.sections[0].thickness: is missing; 'plate' is a group of surfaces"),
                               (('group = "plate"', 'group = "edges"'), "'edges' is a group of lines, which need area"),
                               (('group = "edges", directions', 'group = "9:9", directions'), "physical group '9:9' is not known here"),
                               (('["X", "Y", "Z"]', '["U"]'), "'U' is no direction"),
                               (('material = "aluminium"', 'material = "steel"'), "no section is made of 'aluminium'"),
                               (("plate:thickness", "plate:thicknes"), "did you mean 'section:plate:thickness'?"),
                               (("plate41.msh", "study.toml"), "this is no mesh of Gmsh"),
                               (("plate41.msh", "none.msh"), "none.msh"),
                               (("poisson = 0.3", "poisson = 0.5"), "materials.1.poisson: found 0.5, allowed is less than 0.5")):
            self.write("study.toml", edited(PLATE, change))
            ended = self.call("check", "study.toml")
            self.assertEqual(ended.code, 2, ended.err)
            self.assertIn(phrase, ended.err)

    def test_a_mesh_alone_is_no_model(self):
        ended = self.call("modes", "plate41.msh")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("a mesh alone has no materials", ended.err)

    def test_elements_that_are_not_made_are_named(self):
        self.write("study.toml", edited(PLATE, ("plate41", "quadrangles8"), ('group = "plate"', 'group = "edges"')))
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2, ended.err)
        self.assertIn("is a 3-node line; elements are made of", ended.err)


if __name__ == "__main__":
    support.main()
