"""One study in several systems of units, and how tests that state a unit are read.

    python3 units_test.py PATH_TO_MOTTLE
"""

import csv
import itertools
import unittest

import support
from support import STUDY, edited, read_csv, read_result

# What one SI unit of mass, stiffness, damping, frequency and mass-normalised shape is in each system.
SYSTEMS = {"SI": (1.0, 1.0, 1.0, 1.0, 1.0),
           "mm-t-s": (1e-3, 1e-3, 1e-3, 1.0, 1e3**0.5),
           "mm-kg-ms": (1.0, 1e-6, 1e-3, 1e-3, 1.0)}
OUTPUTS = ["f1", "f2", "f3", "phi1:m1", "phi1:m3", "zeta1", "zeta2"]
TRUTH = """
[truth]
specimens = 8
noise = { "f*" = 0.002, "phi*" = 0.01, "zeta*" = 0.0005 }
"""


def study(system, method, noise=""):
    """Parameters are factors on nominal values: the same numbers in every system."""
    mass, stiffness, damping, _, _ = SYSTEMS[system]
    springs = {"k1": ("ground", "m1", 1.0), "k2": ("ground", "m2", 1.0), "k3": ("ground", "m3", 1.0),
               "k4": ("m1", "m2", 1.0), "k5": ("m2", "m3", 1.0), "k6": ("m1", "m3", 3.0)}
    listed = ",\n".join(f'  {{ name = "{name}", between = ["{a}", "{b}"], stiffness = {k * stiffness!r} }}'
                        for name, (a, b, k) in springs.items())
    parameters = "".join(f'[[parameter]]\nname = "{name}"\ntarget = "spring:{name}"\nrelative = true\n'
                         'distribution = { kind = "normal", mean = 1.2, std = 0.2 }\n' for name in ("k1", "k2"))
    masses = ", ".join(f"m{i} = {mass!r}" for i in (1, 2, 3))
    return (f'title = "Units"\nunits = "{system}"\nseed = 5\n[model]\nkind = "mass-spring"\n'
            f"masses = {{ {masses} }}\nsprings = [\n{listed}\n]\n"
            f'dampers = [{{ name = "c1", between = ["ground", "m1"], damping = {0.05 * damping!r} }}]\n{parameters}'
            '[outputs]\nfrequencies = [1, 2, 3]\nshapes = { modes = [1], dofs = ["m1", "m3"] }\ndamping = [1, 2]\n'
            f'[test]\nfile = "tests-{system}.csv"\n[update]\nmethod = "{method}"\nsamples = 400\n'
            f"{noise}{TRUTH}")


def sizes(system):
    """Number of an output in a system over its number in SI."""
    _, _, _, frequency, shape = SYSTEMS[system]
    return [frequency if name[0] == "f" else shape if name[0] == "p" else 1.0 for name in OUTPUTS]


def leaves(value, path=()):
    if isinstance(value, dict):
        value = list(value.items())
        return itertools.chain.from_iterable(leaves(entry, (*path, key)) for key, entry in value)
    if isinstance(value, list):
        return itertools.chain.from_iterable(leaves(entry, (*path, i)) for i, entry in enumerate(value))
    return [(path, value)]


class UnitsTest(support.CommandTest):
    """One claim a test."""

    def setUp(self):
        super().setUp()
        self.write("SI.toml", study("SI", "maximum-likelihood"))
        self.succeed("simulate", "SI.toml", "--out", "drawn", "--quiet")
        header, rows = read_csv(self.folder / "drawn" / "specimens.csv")
        for system in SYSTEMS:
            with (self.folder / f"tests-{system}.csv").open("w", newline="", encoding="utf-8") as file:
                table = csv.writer(file)
                table.writerow(OUTPUTS)
                for row in rows:
                    values = [float(row[header.index(name)]) for name in OUTPUTS]
                    table.writerow([repr(value * size) for value, size in zip(values, sizes(system))])

    def update(self, system, method, noise):
        self.write(f"{system}.toml", study(system, method, noise))
        self.succeed("update", f"{system}.toml", "--out", system, "--quiet")
        return read_result(self.folder / system)

    def in_si(self, result, system):
        """Everything in a result that depends on the parameters or the outputs, with the outputs in SI."""
        size = sizes(system)
        outputs = {}
        for key, value in result["outputs"].items():
            if value is None or key in ("names", "units", "test_count"):
                continue
            is_matrix = isinstance(value[0], list)
            outputs[key] = ([[entry / size[i] / size[j] for j, entry in enumerate(row)] for i, row in enumerate(value)]
                            if is_matrix else [entry / size[i] for i, entry in enumerate(value)])
        of_study_units = ("units", "prior", "factor_of", "factor_units")
        parameters = {key: value for key, value in result["parameters"].items() if key not in of_study_units}
        slopes = [[entry / size[i] for entry in row] for i, row in enumerate(result["regression"]["sensitivity"])]
        kept = {key: result[key] for key in ("status", "verdict", "outliers", "other_solutions", "specimens",
                                             "identifiability", "spearman", "sample_size")}
        kept["sample_size"].pop("monte_carlo_error", None)
        for error in kept["verdict"].get("could_hide", []):
            error.pop("nominal")  # in the study's units
            error.pop("change")
        for step in kept["verdict"]["next"]:
            step.pop("command")  # names the study's file
        iterations = [(state["distance_mahalanobis"], state["parameter_mean"], state["parameter_covariance"])
                      for state in result["iterations"]]
        return {**kept, "parameters": parameters, "outputs": outputs, "sensitivity": slopes,
                "iterations": [list(state) for state in iterations]}

    def assert_same(self, method, noise="", tolerance=1e-5):
        """Rounding of the converted tests and masses decides at which point an iteration ends, whose steps are then below
        1e-3 of a deviation and fall by a hundred each time: 1e-5 of the largest number beside it (5e-7 was seen), far
        below any effect of a unit."""
        reference = self.in_si(self.update("SI", method, noise), "SI")
        for system in ("mm-t-s", "mm-kg-ms"):
            other = self.in_si(self.update(system, method, noise), system)
            expected = list(leaves(reference))
            found = dict(leaves(other))
            self.assertEqual([path for path, _ in expected], list(found))
            scale = {}
            for path, value in expected:
                if isinstance(value, float):
                    scale[path[:2]] = max(scale.get(path[:2], 0.0), abs(value))
            for path, value in expected:
                with self.subTest(method=method, system=system, path=path):
                    if isinstance(value, float) and found[path] is not None:
                        self.assertAlmostEqual(found[path], value, delta=tolerance * scale[path[:2]])
                    else:
                        self.assertEqual(found[path], value)

    def test_with_estimated_noise_no_result_depends_on_the_units(self):
        self.assert_same("maximum-likelihood", '[update.maximum-likelihood]\nnoise = "estimated"\n')

    def test_no_method_depends_on_the_units(self):
        for method in ("mares", "inversion", "perturbation", "covariance-adjustment", "moment-matching"):
            self.assert_same(method)

    def test_noise_of_frequencies_in_kilohertz_is_a_part_of_their_value(self):
        noise = self.update("mm-kg-ms", "maximum-likelihood", "")["outputs"]
        parts = [std / mean for std, mean in zip(noise["noise_std"][:3], noise["test_mean"][:3])]
        self.assertAlmostEqual(parts[1] / parts[0], 1.0, delta=0.02)  # mean square against squared mean: the scatter
        self.assertAlmostEqual(parts[2] / parts[0], 1.0, delta=0.02)

    def test_a_column_in_another_unit_than_the_studys_is_refused(self):
        for unit, system in (("f1_Hz", "mm-kg-ms"), ("f1 [kHz]", "SI"), ("f1_kHz", "SI"), ("f1 (rad/s)", "mm-t-s"),
                             ("f1 [rpm]", "SI"), ("zeta1 [%]", "SI")):
            with self.subTest(unit=unit, system=system):
                file = self.folder / f"tests-{system}.csv"
                whole = file.read_text(encoding="utf-8")
                name = "zeta1" if "zeta" in unit else "f1"
                file.write_text(whole.replace(f"{name},", f"{unit},", 1), encoding="utf-8")
                self.write("study.toml", study(system, "mares"))
                ended = self.call("check", "study.toml")
                file.write_text(whole, encoding="utf-8")
                self.assertEqual(ended.code, 2, ended.err)
                self.assertIn(f"tests-{system}.csv:1", ended.err)
                self.assertIn(f"'{unit}'", ended.err)

    def test_a_frequency_in_the_studys_unit_may_say_so(self):
        for unit, system in (("f1_kHz", "mm-kg-ms"), ("f1 [kHz]", "mm-kg-ms"), ("f1_Hz", "SI"), ("f1 (Hz)", "mm-t-s")):
            file = self.folder / f"tests-{system}.csv"
            file.write_text(file.read_text(encoding="utf-8").replace("f1,", f"{unit},", 1), encoding="utf-8")
            self.write("study.toml", study(system, "mares"))
            self.succeed("check", "study.toml")
            self.setUp()


if __name__ == "__main__":
    support.main()
