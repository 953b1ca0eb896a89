"""Layered shells as parameters: sensitivities and samples against decks with other numbers in them, solved anew.

    python3 laminate_test.py PATH_TO_MOTTLE
"""

import json
import unittest

import support

NUMBERS = {"E1": 1.3e11, "E2": 9e9, "G12": 5e9, "G1Z": 4e9, "G2Z": 3e9, "RHO": 1600.0, "T1": 0.002, "T3": 0.0015, "THETA2": 35.0}


def deck(**changes):
    """A cantilevered plate of three plies, not symmetric, 4 by 2 CQUAD4."""
    n = {**NUMBERS, **changes}
    lines = ["SOL 103", "CEND", "SPC = 1", "METHOD = 10", "BEGIN BULK", "EIGRL,10,,,5"]
    for j in range(3):
        for i in range(5):
            lines.append(f"GRID,{10 * j + i + 1},,{0.1 * i:.2f},{0.1 * j:.2f},0.")
    for j in range(2):
        for i in range(4):
            a = 10 * j + i + 1
            lines.append(f"CQUAD4,{a},1,{a},{a + 1},{a + 11},{a + 10},20.")
    lines += ["SPC1,1,123456,1,11,21",
              f"MAT8,7,{n['E1']:.9e},{n['E2']:.9e},.3,{n['G12']:.9e},{n['G1Z']:.9e},{n['G2Z']:.9e},{n['RHO']:.9e}",
              "PCOMP,1", f",7,{n['T1']:.9e},0.,,7,.001,{n['THETA2']:.9e}", f",7,{n['T3']:.9e},-60.", "ENDDATA", ""]
    return "\n".join(lines)


def target(name):
    return f"{'PCOMP:1' if name[0] == 'T' else 'MAT8:7'}:{name}"


class LaminateTest(support.CommandTest):
    def frequencies(self, **changes):
        self.write("moved.bdf", deck(**changes))
        return json.loads(self.succeed("modes", "moved.bdf", "--json", "--out", "modes").out)["frequencies"]

    def test_sensitivities_are_those_of_decks_solved_anew(self):
        self.write("plate.bdf", deck())
        listed = json.loads(self.succeed("targets", "plate.bdf", "--all", "--json").out)["targets"]
        found = {one["target"]: one for one in listed}
        step = 1e-3
        for name, value in NUMBERS.items():
            above = self.frequencies(**{name: (1 + step) * value})
            below = self.frequencies(**{name: (1 - step) * value})
            for mode, sensitivity in enumerate(found[target(name)]["sensitivity"]):
                again = (above[mode] - below[mode]) / (above[mode] + below[mode]) / step
                self.assertAlmostEqual(sensitivity, again, delta=2e-5, msg=f"{name}, mode {mode + 1}")

    def test_samples_are_those_of_decks_solved_anew(self):
        self.write("plate.bdf", deck())
        parameters = "".join(f'[[parameter]]\nname = "{name}"\ntarget = "{target(name)}"\n'
                             f'distribution = {{ kind = "normal", mean = {value!r}, std = {0.05 * value!r} }}\n'
                             for name, value in NUMBERS.items())
        self.write("study.toml", '[model]\nkind = "nastran"\nfile = "plate.bdf"\n[outputs]\nfrequencies = [1, 2, 3, 4, 5]\n'
                   'tracking = "order"\n' + parameters)
        factors = [[1 + 0.01 * (-1) ** (i + k) * (1 + (i * k) % 5) for i in range(len(NUMBERS))] for k in range(3)]
        rows = [[factor * value for factor, value in zip(row, NUMBERS.values(), strict=True)] for row in factors]
        self.write("points.csv", "\n".join([",".join(NUMBERS), *(",".join(map(repr, row)) for row in rows)]) + "\n")
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--quiet")
        header, cells = support.read_csv(self.folder / "study.mottle" / "cloud.csv")
        for row, values in zip(cells, rows, strict=True):
            again = self.frequencies(**dict(zip(NUMBERS, values, strict=True)))
            for mode in range(5):
                # nine digits in the deck; PSHELL's and PCOMP's shares of edges are held at the deck's numbers
                self.assertLess(abs(float(row[header.index(f"f{mode + 1}")]) / again[mode] - 1), 1e-6, f"mode {mode + 1}")

    def test_plies_of_one_metal_beside_a_shell_of_it(self):
        # E and G are given: E stands in front of the laminate's matrices, and within the transverse shear of both.
        def thick(E=7e10, G=2e10, T1=0.03):
            text = deck().replace("CQUAD4,3,1,3,4,14,13,20.", "CTRIA3,3,2,3,4,14\nCTRIA3,93,2,3,14,13")
            lines = [line for line in text.split("\n") if not line.startswith(("MAT8", "PCOMP", ",7,"))]
            return "\n".join(lines[:-2] + [f"MAT1,7,{E:.9e},{G:.9e},.33,2700.", "PSHELL,2,7,.05,7,,7", "PCOMP,1",
                                           f",7,{T1:.9e},0.,,7,.02,0.", "ENDDATA", ""])

        def frequencies(**changes):
            self.write("moved.bdf", thick(**changes))
            return json.loads(self.succeed("modes", "moved.bdf", "--json", "--out", "modes").out)["frequencies"]

        self.write("plate.bdf", thick())
        listed = json.loads(self.succeed("targets", "plate.bdf", "--all", "--json").out)["targets"]
        found = {one["target"]: one for one in listed}
        self.write("points.csv", "p\n1.1\n")
        for name, value, target in (("E", 7e10, "MAT1:7:E"), ("G", 2e10, "MAT1:7:G"), ("T1", 0.03, "PCOMP:1:T1")):
            ends = [frequencies(**{name: factor * value}) for factor in (1.001, 0.999)]
            for mode, sensitivity in enumerate(found[target]["sensitivity"]):
                again = (ends[0][mode] - ends[1][mode]) / (ends[0][mode] + ends[1][mode]) / 1e-3
                self.assertAlmostEqual(sensitivity, again, delta=2e-5, msg=f"{name}, mode {mode + 1}")
            self.write("one.toml", f'[model]\nkind = "nastran"\nfile = "plate.bdf"\n[outputs]\nfrequencies = [1, 2, 3]\n'
                       f'tracking = "order"\n[[parameter]]\nname = "p"\ntarget = "{target}"\nrelative = true\n'
                       'distribution = { kind = "normal", mean = 1.0, std = 0.05 }\n')
            self.succeed("propagate", "one.toml", "--points", "points.csv", "--quiet")
            header, rows = support.read_csv(self.folder / "one.mottle" / "cloud.csv")
            again = frequencies(**{name: 1.1 * value})
            for mode in range(3):
                self.assertLess(abs(float(rows[0][header.index(f"f{mode + 1}")]) / again[mode] - 1), 1e-6, f"{name}, mode {mode + 1}")

    def test_one_isotropic_ply_is_a_shell(self):
        isotropic = deck().replace("MAT8,7,", "$").replace("PCOMP,1", "PCOMP,1\n,7,.003,0.\n$").split("\n")
        isotropic = [line for line in isotropic if not line.startswith((",7,2.0", ",7,1.5"))]
        text = "\n".join(isotropic).replace("ENDDATA", "MAT1,7,7.+10,,.33,2700.\nENDDATA")
        self.write("ply.bdf", text)
        self.write("shell.bdf", text.replace("PCOMP,1\n,7,.003,0.", "PSHELL,1,7,.003,7,,7"))
        one, other = (json.loads(self.succeed("modes", name, "--json", "--out", "modes").out)["frequencies"]
                      for name in ("ply.bdf", "shell.bdf"))
        for mode, (first, second) in enumerate(zip(one, other, strict=True), 1):
            self.assertLess(abs(first / second - 1), 1e-3, f"mode {mode}")  # their shear factors differ: 5/6 in both


if __name__ == "__main__":
    support.main()
