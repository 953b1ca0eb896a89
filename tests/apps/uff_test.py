"""Universal files that make_files.py of examples/05-uff-population writes of a simulation, read by an update.

    python3 uff_test.py PATH_TO_MOTTLE
"""

import importlib.util
import shutil

import support
from support import SOURCE, edited, read_csv

AIRFRAME, EXAMPLE = SOURCE / "examples" / "02-airframe", SOURCE / "examples" / "05-uff-population"
SHAPES = 'shapes = { modes = [7, 9, 11, 14], dofs = ["11:+X", "11:+Z", "111:+X", "111:+Z", "205:+Y"] }'
STUDY = (EXAMPLE / "study.toml").read_text(encoding="utf-8")
# Only the values of the tests are looked at: the cheapest update that writes them.
CHEAP = '\n[update]\nmethod = "deterministic"\nsamples = 10\niterations = 1\n'


def example_module(folder):
    spec = importlib.util.spec_from_file_location("make_files", folder / "make_files.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class TestsAsModes(support.CommandTest):
    def setUp(self):
        super().setUp()
        (self.folder / "02-airframe").mkdir()
        shutil.copy(AIRFRAME / "airframe.bdf", self.folder / "02-airframe")
        self.home = self.folder / "05"
        shutil.copytree(EXAMPLE, self.home, ignore=shutil.ignore_patterns("*.mottle"))

    def study(self, *changes):
        self.write("05/study.toml", edited(STUDY, *changes) + CHEAP)

    def values_of_tests(self):
        """Column -> values of the tests as the update used them."""
        self.succeed("update", "05/study.toml", "--out", "out", "--quiet")
        header, rows = read_csv(self.folder / "out" / "tests.csv")
        return {name: [row[k] for row in rows] for k, name in enumerate(header) if name != "specimen"}

    def test_every_habit_of_a_file_gives_the_frequencies_and_shapes_that_were_drawn(self):
        self.succeed("simulate", "05/truth.toml", "--out", "05/truth.mottle", "--quiet")
        example_module(self.home).main()
        self.study(("frequencies = [7,", SHAPES + "\nfrequencies = [7,"), ('"f*" = "0.1 %"', '"f*" = "0.1 %"\n"phi*" = 0.01'))
        used = self.values_of_tests()
        header, rows = read_csv(self.home / "truth.mottle" / "specimens.csv")
        compared = 0
        for name, values in used.items():
            for specimen, (value, row) in enumerate(zip(values, rows), 1):
                true = float(row[header.index(name)])
                is_missing = specimen == 3 and (name == "f9" or name.startswith("phi9:"))
                if is_missing or (specimen == 6 and name.startswith("phi")):  # without modal mass
                    self.assertEqual(value, "", name)
                    continue
                # Six digits of the largest component. The complex file turns each sensor by 0.03 sin(node) besides the
                # common phase, of which the real part is left.
                tolerance = {4: 2e-3}.get(specimen, 2e-5) if name.startswith("phi") else 1e-5 * true
                self.assertLess(abs(float(value) - true), tolerance, f"{name} of specimen {specimen}")
                compared += 1
        self.assertEqual(compared, 10 * 29 - 6 - 20)


if __name__ == "__main__":
    support.main()
