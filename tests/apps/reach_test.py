"""What check says of a study by a stranger: the programs it runs, the files outside of its folder; --no-run starts none.

    python3 reach_test.py PATH_TO_MOTTLE
"""
import json
import unittest

import support
from support import STUDY, TESTS, edited

SOLVER = """\
import pathlib
pathlib.Path("MARK").touch()
k1, k2 = map(float, open("input.txt").read().split())
open("f.txt", "w").write(f"{k1}\\n{k1 + k2}\\n{k1 + 2 * k2}\\n")
"""


class ReachTest(support.CommandTest):
    """Studies that stay in their folder, and studies that do not."""

    def write_solver(self):
        self.mark = self.folder / "was-run"
        self.write("input.txt", "{{k1}} {{k2}}\n")
        self.write("solver.py", SOLVER.replace("MARK", str(self.mark)))
        self.write("study.toml", support.command_study(["python3", "-S", "-E", "solver.py"]))

    def test_a_study_that_stays_in_its_folder_reaches_nothing(self):
        checked = json.loads(self.succeed("check", "study.toml", "--no-run", "--json").out)
        self.assertEqual((checked["programs"], checked["outside"]), ([], []))

    def test_programs_are_listed(self):
        self.write_solver()
        checked = json.loads(self.succeed("check", "study.toml", "--json").out)
        self.assertEqual(checked["programs"], ["model.command: python3 -S -E solver.py"])
        self.assertTrue(self.mark.exists())
        self.assertIn("runs by model.command: python3", self.succeed("check", "study.toml").out)

    def test_no_run_starts_none_under_any_verb(self):
        self.write_solver()
        for verb in ("check", "update", "propagate"):
            with self.subTest(verb=verb):
                ended = self.call(verb, "study.toml", "--no-run", "--out", "out")
                self.assertEqual(ended.code, 2, ended.err)
                self.assertIn("model.command: 'python3 -S -E solver.py' would be run, which --no-run forbids", ended.err)
                self.assertFalse(self.mark.exists())
                self.assertFalse((self.folder / "out").exists())

    def test_no_run_starts_no_calculix_though_its_matrices_may_be_known(self):
        self.write("study.toml", '[model]\nkind = "calculix"\nfile = "x.inp"\nprogram = "./evil"\n[[parameter]]\nname = "E"\n'
                                 'target = "*ELASTIC:S:E"\ndistribution = { kind = "normal", mean = 1.0, std = 0.1 }\n'
                                 "[outputs]\nfrequencies = [1]\n")
        self.write("x.inp", "*NODE\n1, 0, 0, 0\n")
        self.write("evil", f"#!/bin/sh\ntouch {self.folder}/was-run\n").chmod(0o755)
        ended = self.call("check", "study.toml", "--no-run")
        self.assertEqual(ended.code, 2)
        self.assertIn("model.program: './evil' would be run", ended.err)
        self.assertFalse((self.folder / "was-run").exists())

    def test_files_outside_are_listed_through_links_too(self):
        self.write("elsewhere/tests.csv", TESTS)
        (self.folder / "inner").mkdir()
        self.write("inner/study.toml", STUDY)
        (self.folder / "inner" / "tests.csv").symlink_to(self.folder / "elsewhere" / "tests.csv")
        place = (self.folder / "elsewhere" / "tests.csv").resolve()
        self.assertEqual(json.loads(self.succeed("check", "inner/study.toml", "--json").out)["outside"], [f"test.file: {place}"])
        self.write("inner/study.toml", edited(STUDY, ('"tests.csv"', '"../elsewhere/*.csv"')))
        self.assertIn("reads outside of the study's folder by test.file: ", self.succeed("check", "inner/study.toml").out)

    def test_links_within_a_folder_of_tests_are_listed(self):
        self.write("elsewhere/a.csv", TESTS)
        self.write("inner/study.toml", edited(STUDY, ('"tests.csv"', '"specimens/*.csv"')))
        (self.folder / "inner" / "specimens").mkdir()
        (self.folder / "inner" / "specimens" / "b.csv").symlink_to(self.folder / "elsewhere" / "a.csv")
        place = (self.folder / "elsewhere" / "a.csv").resolve()
        self.assertEqual(json.loads(self.succeed("check", "inner/study.toml", "--json").out)["outside"], [f"test.file: {place}"])

    def test_a_strangers_texts_do_not_speak_to_the_terminal(self):
        (self.folder / "odd\x1b[2J").mkdir()
        self.write("odd\x1b[2J/tests.csv", TESTS)
        self.write("study.toml", edited(STUDY, ('"A study for tests"', '"\\u001b]0;mine\\u0007"'),
                                        ('"tests.csv"', '"odd\\u001b[2J/tests.csv"')))
        for verb in ("check", "update"):
            ended = self.call(verb, "study.toml", "--out", "out")
            self.assertEqual(ended.code, 0, ended.err)
            self.assertNotIn("\x1b", ended.out + ended.err)
        self.assertIn("\\x1b]0;mine\\x07", self.succeed("check", "study.toml").out)

    def test_includes_of_a_deck_are_listed(self):
        deck = self.folder / "study" / "deck.bdf"
        self.write("study/deck.bdf", "CEND\nBEGIN BULK\nINCLUDE '../cards.bdf'\nENDDATA\n")
        self.write("cards.bdf", "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nCELAS2,1,100.,1,3,2,3\nCONM2,2,1,,1.\nCONM2,3,2,,2.\n"
                                "SPC1,1,12456,1,2\nEIGRL,1,,,2\n")
        self.write("study/study.toml", f'[model]\nkind = "nastran"\nfile = "{deck.name}"\n[[parameter]]\nname = "k"\n'
                                       'target = "CELAS2:1:K"\ndistribution = { kind = "lognormal", mean = 100.0, std = 10.0 }\n'
                                       "[outputs]\nfrequencies = [2]\n")
        ended = self.call("check", "study/study.toml", "--json")
        self.assertEqual(ended.code, 0, ended.err)
        self.assertEqual(json.loads(ended.out)["outside"], [f"included: {(self.folder / 'cards.bdf').resolve()}"])


if __name__ == "__main__":
    support.main()
