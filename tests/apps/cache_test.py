"""Trained reduced models that one command leaves to the next.

    python3 cache_test.py PATH_TO_MOTTLE
"""

import subprocess

import support
from nastran_test import STUDY, deck
from support import edited, numbers

DECK = edited(deck(100), ("PELAS,9,1.0+4\n", ""), ("CELAS1,99,9,101,2\n", ""))  # 600 equations: worth a reduced model
READ, KEPT = "vectors read from", "kept in"


class CacheTest(support.CommandTest):
    def setUp(self):
        super().setUp()
        self.write("deck.bdf", DECK)
        self.write("study.toml", STUDY)

    def cache(self):
        return self.folder / "cache"

    def propagate(self, out, *arguments, **how):
        """The cloud as bytes, and the log."""
        arguments = (*arguments, "--cache", self.cache()) if not how else arguments
        self.succeed("propagate", "study.toml", "--quiet", "--out", out, *arguments, **how)
        return (self.folder / out / "cloud.csv").read_bytes(), (self.folder / out / "mottle.log").read_text()

    def test_the_second_run_trains_nothing_and_gives_the_same_bytes(self):
        first, first_log = self.propagate("a")
        second, second_log = self.propagate("b")
        self.assertIn(KEPT, first_log)
        self.assertNotIn(READ, first_log)
        self.assertIn(READ, second_log)
        self.assertNotIn(KEPT, second_log)
        self.assertEqual(first, second)
        self.assertEqual(numbers(self.folder / "a"), numbers(self.folder / "b"))
        self.assertEqual(first, self.propagate("c", "--cache", "off", environment={})[0])

    def test_another_seed_another_command_and_resume_find_it(self):
        self.propagate("a")
        self.assertIn(READ, self.propagate("b", "--seed", 99)[1])
        self.write("study.toml", STUDY.replace("[update]\n", '[test]\nfile = "beam.csv"\n[update]\niterations = 2\n'))
        header, rows = support.read_csv(self.folder / "a" / "cloud.csv")
        places = [header.index(name) for name in ("f1", "f2")]
        self.write("beam.csv", "f1,f2\n" + "".join(f"{row[places[0]]},{row[places[1]]}\n" for row in rows[:8]))
        for more in ((), ("--resume",), ("--set", "update.method='deterministic'", "--set", "update.samples=50")):
            self.succeed("update", "study.toml", "--quiet", "--out", "u", "--cache", self.cache(), *more)
            self.assertNotIn(KEPT, (self.folder / "u" / "mottle.log").read_text())
        self.assertEqual(len(list(self.cache().iterdir())), 1)

    def test_a_changed_model_prior_or_tolerance_does_not(self):
        self.propagate("a")
        changes = (("deck.bdf", edited(DECK, ("7.+10", "7.1+10"))),
                   ("deck.bdf", edited(DECK, ("SPC1,1,123456,1", "SPC1,1,12345,1"))),
                   ("study.toml", edited(STUDY, ("std = 0.05", "std = 0.06"))),
                   ("study.toml", edited(STUDY, ("mean = 1.0, std", "mean = 1.01, std"))),
                   ("study.toml", edited(STUDY, ('file = "deck.bdf"', 'file = "deck.bdf"\nfrequency_error = 1e-5'))),
                   ("study.toml", edited(STUDY, ("frequencies = [1, 2]", "frequencies = [1, 2, 3, 4, 5, 6, 7]"))))
        for k, (name, content) in enumerate(changes):
            self.write("deck.bdf", DECK)
            self.write("study.toml", STUDY)
            self.write(name, content)
            cloud, log = self.propagate(f"changed-{k}")
            self.assertIn(KEPT, log)
            self.assertNotIn(READ, log)
            self.assertEqual(cloud, self.propagate(f"alone-{k}", "--cache", "off", environment={})[0])

    def test_a_damaged_file_is_told_and_replaced(self):
        first, _ = self.propagate("a")
        file, = self.cache().iterdir()
        whole = file.read_bytes()
        another_byte = whole[:1000] + bytes([whole[1000] ^ 1]) + whole[1001:]
        for damaged in (whole[:-1], another_byte, b"", b"mottle basis 2\n"):
            file.write_bytes(damaged)
            again, log = self.propagate("b")
            self.assertIn("is not used and the basis trained anew: it", log)
            self.assertEqual(first, again)
            self.assertIn(READ, self.propagate("b")[1])

    def test_a_place_that_cannot_be_used_costs_the_reuse_alone(self):
        first, _ = self.propagate("a")
        for place in ("/proc/mottle", self.folder / "deck.bdf", "/dev/full"):
            again, log = self.propagate("b", "--cache", place, environment={})
            self.assertIn("not kept in", log)
            self.assertEqual(first, again)

    def test_it_lies_in_the_users_cache(self):
        for name, environment in (("xdg", {"XDG_CACHE_HOME": str(self.folder / "xdg"), "HOME": "/nowhere"}),
                                  ("home/.cache", {"XDG_CACHE_HOME": "relative", "HOME": str(self.folder / "home")})):
            _, log = self.propagate("a", environment=environment)
            file, = (self.folder / name / "mottle").iterdir()
            self.assertIn(f"{KEPT} {file}", log)
            self.assertEqual(file.parent.stat().st_mode & 0o777, 0o700)

    def test_two_commands_at_once_do_not_disturb_each_other(self):
        command = [support.MOTTLE, "propagate", "study.toml", "--quiet", "--cache", "cache", "--out"]
        both = [subprocess.Popen([*command, out], cwd=self.folder) for out in ("a", "b", "c")]
        self.assertEqual([one.wait() for one in both], [0, 0, 0])
        clouds = {(self.folder / out / "cloud.csv").read_bytes() for out in ("a", "b", "c")}
        self.assertEqual(len(clouds), 1)
        self.assertEqual(len(list(self.cache().iterdir())), 1)
        self.assertIn(READ, self.propagate("d")[1])


if __name__ == "__main__":
    support.main()
