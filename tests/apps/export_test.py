"""mottle export: the deck at the updated means gives the updated frequencies, and the study goes on from the result.

    python3 export_test.py PATH_TO_MOTTLE
"""

import json
import shutil
import unittest

import support

EXAMPLES = support.SOURCE / "examples"


class ExportTest(support.CommandTest):
    def frequencies(self, deck, modes):
        found = json.loads(self.succeed("modes", deck, "--json", "--modes", modes, "--out", "modes").out)["frequencies"]
        return found

    def update(self, example, *options, deck=None):
        shutil.copytree(EXAMPLES / example, self.folder / example, ignore=shutil.ignore_patterns("*.mottle"))
        if deck is not None:
            self.write(f"{example}/airframe.bdf", deck[0])
            self.write(f"{example}/materials.inc", deck[1])
        self.succeed("update", f"{example}/study.toml", "--out", "out", "--quiet", "--set", "update.samples=40", *options,
                     timeout=300)
        return support.read_result(self.folder / "out")

    def test_the_deck_at_the_means_gives_the_updated_frequencies(self):
        # deterministic: its outputs are those at the means, no mean over a cloud
        result = self.update("02-airframe", "--set", 'update.method="deterministic"')
        listed = json.loads(self.succeed("export", "out", "--decks", "2", "--json").out)
        for name in ("mean/airframe.bdf", "sample-0001/airframe.bdf", "sample-0002/airframe.bdf", "parameters.csv",
                     "samples.csv", "study.toml"):
            self.assertIn(name, listed["files"])
            self.assertTrue((self.folder / "out" / "export" / name).is_file())
        found = self.frequencies("out/export/mean/airframe.bdf", "20")
        for name, mean in zip(result["outputs"]["names"], result["outputs"]["final_mean"], strict=True):
            # Eight characters hold five digits of a number, which a frequency follows by at most 1.2 % per %; and a CQUAD4
            # of another thickness differs in second order from one that a parameter moved there (finite-elements.md).
            self.assertLess(min(abs(frequency / mean - 1) for frequency in found), 3e-4, name)

    def test_only_numbers_of_parameters_change(self):
        self.update("02-airframe", "--set", 'update.method="deterministic"')
        self.succeed("export", "out", "--quiet")
        before = (EXAMPLES / "02-airframe" / "airframe.bdf").read_text().splitlines()
        after = (self.folder / "out" / "export" / "mean" / "airframe.bdf").read_text().splitlines()
        changed = [one for one, other in zip(before, after, strict=True) if one != other]
        self.assertLessEqual(len(changed), 9)  # eight parameters, one on two cards
        for line in changed:
            self.assertRegex(line, r"^(MAT1|PSHELL|PBUSH|CONM2|\+|\*| )")

    def test_the_study_has_the_result_as_its_prior(self):
        result = self.update("02-airframe", "--set", 'update.method="perturbation"')
        self.succeed("export", "out", "--out", "next", "--quiet")
        checked = json.loads(self.succeed("check", "next/study.toml", "--json").out)["parameters"]
        for key in ("names", "prior_mean", "prior_std"):
            for one, other in zip(checked[key], result["parameters"][key.removeprefix("prior_")], strict=True):
                if isinstance(one, str):
                    self.assertEqual(one, other)
                elif other:
                    self.assertLess(abs(one / other - 1), 1e-9)

    def test_what_the_tests_do_not_see_stays_as_uncertain_as_it_was(self):
        lines = ["SOL 103", "CEND", "METHOD = 10", "BEGIN BULK", "EIGRL,10,,,2", "SPOINT,1,2", "CELAS2,1,1000.,1", "CELAS2,2,3000.,2",
                 "CMASS2,3,1.,1", "CMASS2,4,1.,2", "ENDDATA"]
        self.write("deck.bdf", "\n".join(lines) + "\n")
        parameter = '[[parameter]]\nname = "{}"\ntarget = "CELAS2:{}:K"\ndistribution = {{ kind = "normal", mean = {}, std = 50 }}\n'
        self.write("study.toml", '[model]\nkind = "nastran"\nfile = "deck.bdf"\n' + parameter.format("ka", 1, 1000) +
                   parameter.format("kb", 2, 3000) + '[outputs]\nfrequencies = [1]\n[test]\nfile = "tests.csv"\n')
        self.write("tests.csv", "f1\n5.03\n5.1\n5.05\n4.98\n")
        self.assertIn("warning: kb changes no output", self.succeed("check", "study.toml").out)
        said = self.succeed("update", "study.toml", "--out", "out", "--set", "update.samples=40").out
        self.assertNotRegex(said, r"off by \S+e-\d\d %")  # an error of the size of rounding
        self.assertIn("do not see kb", self.succeed("export", "out", "--out", "next").out)
        checked = json.loads(self.succeed("check", "next/study.toml", "--json").out)["parameters"]
        self.assertEqual(checked["prior_std"][1], 50.0)
        self.assertLess(checked["prior_std"][0], 50.0)

    def test_a_calculix_deck_has_the_updated_numbers(self):
        if shutil.which("ccx") is None:
            self.skipTest("CalculiX (ccx) is not here")
        result = self.update("03-plate-calculix", "--set", 'update.method="deterministic"')
        self.succeed("export", "out", "--quiet")
        text = (self.folder / "out" / "export" / "mean" / "plate.inp").read_text()
        mean = dict(zip(result["parameters"]["names"], result["parameters"]["mean"], strict=True))
        self.assertIn(f"{mean['sheet_E']:.12g}", text)

    def test_a_calculix_deck_keeps_its_files_and_line_ends(self):
        if shutil.which("ccx") is None:
            self.skipTest("CalculiX (ccx) is not here")
        deck = (EXAMPLES / "03-plate-calculix" / "plate.inp").read_text()
        start = deck.index("*MATERIAL")
        end = deck.index("*", deck.index("*DENSITY", start) + 1)
        parts = (deck[:start] + "*INCLUDE, INPUT=material.inc\n" + deck[end:], deck[start:end])
        whole, material = (part.replace("\n", "\r\n").encode() for part in parts)
        shutil.copytree(EXAMPLES / "03-plate-calculix", self.folder / "plate")
        (self.folder / "plate" / "plate.inp").write_bytes(whole)
        (self.folder / "plate" / "material.inc").write_bytes(material)
        self.succeed("update", "plate/study.toml", "--out", "out", "--quiet", "--set", 'update.method="deterministic"', "--set",
                     "update.samples=40")
        self.succeed("export", "out", "--quiet")
        mean = self.folder / "out" / "export" / "mean"
        lines, before = ((folder / "material.inc").read_bytes().split(b"\n") for folder in (mean, self.folder / "plate"))
        changed = [one for one, other in zip(lines, before, strict=True) if one != other]
        self.assertTrue(changed)
        self.assertTrue(all(line.endswith(b"\r") for line in changed))
        written, given = (mean / "plate.inp").read_bytes().split(b"\n"), whole.split(b"\n")
        self.assertEqual(len(written), len(given))
        self.assertIn(b"*INCLUDE, INPUT=material.inc\r", written)

    def test_a_model_without_deck_exports_tables_and_study(self):
        self.succeed("update", "study.toml", "--quiet")
        self.assertIn("no deck of its own", self.succeed("export", "study.mottle").out)
        header, rows = support.read_csv(self.folder / "study.mottle" / "export" / "samples.csv")
        self.assertEqual((header, len(rows)), (["k1", "k2"], 200))
        self.succeed("propagate", "study.mottle/export/study.toml", "--out", "again", "--quiet")

    def updated_with_include(self):
        """An update of the airframe whose materials are in a file that the deck includes."""
        text = (EXAMPLES / "02-airframe" / "airframe.bdf").read_text().splitlines(keepends=True)
        first = next(k for k, line in enumerate(text) if line.startswith("MAT1"))
        self.update("02-airframe", "--set", 'update.method="perturbation"', deck=(
            "".join(text[:first]) + "INCLUDE 'materials.inc'\n" + "".join(text[first + 1:]), text[first]))

    def test_a_deck_that_has_changed_since_the_update_is_refused(self):
        self.updated_with_include()
        names = [file["name"] for file in support.read_result(self.folder / "out")["model_files"]]
        self.assertEqual(names, ["airframe.bdf", "materials.inc"])
        include = self.folder / "02-airframe" / "materials.inc"
        before = include.read_text()
        include.write_text(before + "$ another comment\n")
        ended = self.call("export", "out")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("since this update materials.inc has changed", ended.err)
        self.assertIn("--changed-model", ended.err)
        self.assertFalse((self.folder / "out" / "export").exists())
        accepted = self.succeed("export", "out", "--changed-model", "--out", "anyway").out
        self.assertIn("materials.inc has changed", accepted)
        include.write_text(before)
        self.assertNotIn("changed", self.succeed("export", "out").out)

    def test_a_file_that_is_gone_is_named(self):
        self.updated_with_include()
        (self.folder / "02-airframe" / "materials.inc").unlink()
        ended = self.call("export", "out")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("materials.inc is missing", ended.err)

    def test_results_that_do_not_name_the_files_say_so(self):
        self.succeed("update", "study.toml", "--quiet")
        file = self.folder / "study.mottle" / "result.json"
        result = json.loads(file.read_text())
        del result["model_files"]
        file.write_text(json.dumps(result))
        self.assertIn("earlier version", self.succeed("export", "study.mottle").out)

    def test_nothing_is_written_over_and_other_folders_are_refused(self):
        self.succeed("update", "study.toml", "--quiet")
        self.write("study.mottle/export/mine.txt", "mine")
        ended = self.call("export", "study.mottle")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("is there already", ended.err)
        for folder in ("none", "."):
            ended = self.call("export", folder, "--out", "new")
            self.assertEqual(ended.code, 2, ended.out)
            self.assertIn("result.json", ended.err)
        self.write("bad/result.json", "{")
        self.assertEqual(self.call("export", "bad").code, 2)
        self.assertFalse((self.folder / "new").exists())


if __name__ == "__main__":
    support.main()
