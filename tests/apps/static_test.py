"""Static displacements as outputs, as a user meets them: numbers by hand, unit systems, predictions, refusals."""

import json
import math
import re

import support
from support import STUDY, command_study, edited, line_of, main, numbers, read_csv, read_result

STATIC = 'static = [{ forces = { m3 = 1.0 }, dofs = ["m1", "m3"] }, { forces = { m1 = 1.0, m2 = -0.5 }, dofs = ["m2"] }]'
NAMES = ["u1:m1", "u1:m3", "u2:m2"]

# A cantilever along x of one beam: w(L) = F L^3 / (3 E I), w'(L) = F L^2 / (2 E I), which one element gives exactly.
BEAM = """\
SOL 103
CEND
SPC = 1
METHOD = 1
BEGIN BULK
EIGRL,1,,,3
GRID,1,,0.0,0.0,0.0
GRID,2,,{length},0.0,0.0
GRID,3,,{length},{arm},0.0
CBAR,1,1,1,2,0.0,1.0,0.0
RBE2,5,2,123456,3
PBAR,1,1,{area},{inertia},{inertia},{inertia}
MAT1,1,{young},,0.3,{density}
SPC1,1,123456,1
ENDDATA
"""
BEAM_STUDY = """\
units = "{units}"
[model]
kind = "nastran"
file = "beam.bdf"
[[parameter]]
name = "E"
target = "MAT1:1:E"
relative = true
distribution = {{ kind = "normal", mean = 1.0, std = 0.1 }}
[outputs]
static = [{{ forces = {{ "2:+Y" = {force} }}, dofs = ["2:+Y", "2:+RZ"] }},
          {{ forces = {{ "3:+X" = {force} }}, dofs = ["2:+RZ"] }}]
"""


class Static(support.CommandTest):

    def made_tests(self, k1s):
        """u of the study's loads at each k1, by hand: K = [k1+4, -1, -3; -1, 3, -1; -3, -1, 5]."""
        lines = [",".join(NAMES)]
        for k1 in k1s:
            det = 14.0 * (k1 + 4.0) - 38.0  # by the first row
            inverse = {(1, 3): 10.0, (3, 3): 3.0 * (k1 + 4.0) - 1.0, (2, 1): 8.0, (2, 2): 5.0 * (k1 + 4.0) - 9.0}
            u = {key: value / det for key, value in inverse.items()}
            lines.append(f"{u[1, 3]!r},{u[3, 3]!r},{u[2, 1] - 0.5 * u[2, 2]!r}")
        return "\n".join(lines) + "\n"

    def static_study(self):
        k2 = STUDY[STUDY.index('[[parameter]]\nname = "k2"'):STUDY.index("[outputs]")]
        return edited(STUDY, ("frequencies = [1, 2, 3]", STATIC), (k2, ""),
                      ('method = "mares"', 'method = "maximum-likelihood"'),
                      ('file = "tests.csv"', 'file = "tests.csv"\nrepeatability = { "u*" = 1e-6 }'))

    def test_static_tests_alone_give_the_stiffness_back(self):
        k1s = [0.8, 0.9, 1.0, 1.1, 1.2]
        self.write("study.toml", self.static_study())
        self.write("tests.csv", self.made_tests(k1s))
        self.succeed("check", "study.toml")
        self.succeed("update", "study.toml", "--out", "out", "--quiet", "--threads", "1")
        result = read_result(self.folder / "out")
        mean, std = result["parameters"]["mean"][0], result["parameters"]["std"][0]
        self.assertAlmostEqual(mean, 1.0, delta=2e-3)  # the estimator's first order in a scatter of 16 %
        self.assertAlmostEqual(std, 0.15811, delta=5e-3)
        first = numbers(self.folder / "out")
        self.succeed("update", "study.toml", "--out", "again", "--quiet", "--threads", "2")
        self.assertEqual(numbers(self.folder / "again"), first)

    def test_displacements_are_predicted_from_modes(self):
        self.write("study.toml", STUDY.replace('"mares"', '"maximum-likelihood"') +
                   "\n[predict]\ndraws = 1000\n" + STATIC + "\n")
        self.succeed("update", "study.toml", "--out", "out", "--quiet")
        self.assertEqual(read_result(self.folder / "out")["prediction"]["names"], NAMES)
        _, rows = read_csv(self.folder / "out" / "prediction.csv")
        self.assertEqual([row[5] for row in rows], ["m", "m", "m"])

    def test_a_beam_in_two_unit_systems(self):
        length, arm, inertia, young, force = 1.2, 0.3, 2e-8, 7e10, 30.0
        moment = -force * arm  # of the force on the rigid arm about the tip
        exact = [force * length**3 / (3 * young * inertia), force * length**2 / (2 * young * inertia),
                 moment * length / (young * inertia)]
        for units, metre, mass in (("SI", 1.0, 1.0), ("mm-t-s", 1e3, 1e-3)):
            self.write("beam.bdf", BEAM.format(length=length * metre, arm=arm * metre, area=4e-4 * metre**2,
                                               inertia=f"{inertia * metre**4:.6E}", young=f"{young / metre**2:.6E}",
                                               density=f"{2700.0 * mass / metre**3:.6E}"))
            self.write("study.toml", BEAM_STUDY.format(units=units, force=force))
            self.write("points.csv", "E\n1.0\n2.0\n")
            self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", f"out-{units}", "--quiet")
            header, rows = read_csv(next((self.folder / f"out-{units}").glob("cloud*.csv")))
            for name, value, size in zip(("u1:2:+Y", "u1:2:+RZ", "u2:2:+RZ"), exact, (metre, 1.0, 1.0)):
                for row, factor in zip(rows, (1.0, 2.0)):
                    found = float(row[header.index(name)])
                    self.assertAlmostEqual(found / (value * size / factor), 1.0, delta=1e-9)

    def test_faults_are_found_with_file_and_line(self):
        study = edited(STUDY, ("frequencies = [1, 2, 3]", "frequencies = [1, 2, 3]\n" + STATIC))
        line = line_of(study, "static =")
        for change, fault in (
                (("{ m3 = 1.0 }, dofs", "{ m9 = 1.0 }, dofs"), "outputs.static.1.forces: "),
                (("{ m3 = 1.0 }, dofs", "{ m3 = 0.0 }, dofs"), "outputs.static.1.forces: the load has no force that is not 0"),
                (("{ m3 = 1.0 }, dofs", "{ m3 = 1e200 }, dofs"), "outputs.static.1.forces.m3"),
                (('dofs = ["m2"]', 'dofs = ["m9"]'), "outputs.static.2.dofs: "),
                (("{ m3 = 1.0 }, dofs", '{ m3 = "1" }, dofs'), "forces.m3"),
                (('dofs = ["m1", "m3"]', 'dofs = ["m1", "m1"]'), "outputs.static.1.dofs: 'm1' is given twice"),
                ((', dofs = ["m2"]', ""), "dofs"),
                ((', dofs = ["m2"]', ', dofs = ["m2"], node = 1'), "node")):
            self.write("study.toml", edited(study, change))
            ended = self.call("check", "study.toml")
            self.assertEqual(ended.code, 2, change)
            self.assertIn(fault, ended.err)
            self.assertIn(f"study.toml:{line}: ", ended.err)

    def test_a_fault_of_the_second_load_has_its_line(self):
        loads = """
[[outputs.static]]
forces = { m3 = 1.0 }
dofs = ["m1", "m3"]

[[outputs.static]]
forces = { m1 = 1.0 }
dofs = ["m2"]
"""
        study = edited(STUDY, ("frequencies = [1, 2, 3]\n", "frequencies = [1, 2, 3]\n" + loads))
        self.write("study.toml", edited(study, ('dofs = ["m2"]', 'dofs = ["m7"]')))
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2)
        line = line_of(study, 'dofs = ["m2"]')
        self.assertIn(f"study.toml:{line}: outputs.static.2.dofs: ", ended.err)

    def test_modal_tests_hold_no_displacements(self):
        example = support.SOURCE / "examples" / "05-uff-population"
        study = (example / "study.toml").read_text(encoding="utf-8")
        outputs = study[study.index("[outputs]"):]
        outputs = outputs[:outputs.index("\n[", 1)]
        static = '[outputs]\nstatic = [{ forces = { "105:+Z" = 1.0 }, dofs = ["105:+Z"] }]\n'
        study = study.replace(outputs, static)
        for name in re.findall(r'"([^"]*(?:specimens|\.bdf|\.csv)[^"]*)"', study):
            study = study.replace(f'"{name}"', json.dumps(str(example / name)))
        self.write("study.toml", study)
        for verb in ("check", "update", "diagnose"):
            ended = self.call(verb, "study.toml")
            self.assertEqual(ended.code, 2, ended.err)
            self.assertIn("test.file: these files hold modes, and no output is of a mode", ended.err)

    def test_another_unit_than_the_studys_is_refused(self):
        self.write("study.toml", self.static_study())
        tests = self.made_tests([0.8, 0.9, 1.0, 1.1])
        for title, code in (("u1:m1 [m]", 0), ("u1:m1_m", 0), ("u1:m1 [mm]", 2), ("u1:m1 (in)", 2)):
            self.write("tests.csv", tests.replace("u1:m1", title, 1))
            ended = self.call("check", "study.toml")
            self.assertEqual(ended.code, code, ended.err)
            self.assertIn("" if code == 0 else "u1:m1 is in m", ended.err)

    def test_check_gives_the_displacements_of_a_study_without_modes(self):
        self.write("study.toml", self.static_study())
        self.write("tests.csv", self.made_tests([0.8, 0.9, 1.0, 1.1]))
        self.assertRegex(self.succeed("check", "study.toml").out, r"u1:m1 +0.217391 m ")

    def test_a_mass_that_moves_nothing_is_named_by_every_method(self):
        mass = '[[parameter]]\nname = "m"\ntarget = "mass:m1"\ndistribution = { kind = "normal", mean = 1.0, std = 0.1 }\n\n'
        study = self.static_study()
        header, *rows = self.made_tests([0.8, 0.9, 1.0, 1.1, 1.2, 0.95, 1.05]).splitlines()
        noisy = [",".join(repr(float(value) + 1e-3 * math.sin(7 * i + 3 * j)) for j, value in enumerate(row.split(",")))
                 for i, row in enumerate(rows)]  # else three outputs of one parameter have a singular covariance
        self.write("tests.csv", "\n".join([header, *noisy]))
        for method in ("maximum-likelihood", "inversion", "mares", "perturbation", "moment-matching"):
            with self.subTest(method=method):
                self.write("study.toml", edited(study, ("[outputs]", mass + "[outputs]"),
                                                ('"maximum-likelihood"', f'"{method}"'),
                                                ("\n[update.mares]\nweighting = \"mahalanobis\"\n", "")))
                ended = self.succeed("update", "study.toml", "--out", "out")
                self.assertIn("m cannot be identified from the outputs", ended.out)

    def test_a_program_has_no_stiffness_to_put_loads_on(self):
        self.write("input.txt", "{{k1}} {{k2}}\n")
        self.write("solver.py", "open('f.txt', 'w').write('1.0\\n2.0\\n')\n")
        study = command_study(["python3", "-S", "-E", "solver.py"]).replace("frequencies = [1, 2, 3]", STATIC)
        self.write("study.toml", study)
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2)
        self.assertIn(f"study.toml:{line_of(study, 'static =')}: outputs.static: the model's modes come from runs",
                      ended.err)


if __name__ == "__main__":
    main()
