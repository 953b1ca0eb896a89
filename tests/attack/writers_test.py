"""Two commands in one folder of results: one is refused, or one comes after the other; what is left is whole.

The second command starts after parts of the time that one takes alone: on a busy machine they may miss each other.

    python3 writers_test.py PATH_TO_MOTTLE
"""

import subprocess
import time

import attack
import support
from attack import demand
from support import PATIENCE, STUDY, edited

FILES = {"update": ("history.csv", "cloud-final.csv", "clouds.csv"), "propagate": ("cloud.csv", "clouds.csv")}


class Writers(attack.Family):
    """Two commands with other seeds, begun up to the length of one apart."""

    title = "two writers in one folder"
    few = 12
    many = None

    def prepare(self):
        self.write("study.toml", edited(STUDY, ("samples = 200", "samples = 3000")))
        self.write("tests.csv", support.TESTS)
        self.alone = {}
        began = time.monotonic()
        for verb in FILES:
            for seed in (1, 2):
                self.remove("out")
                self.succeed(verb, "study.toml", "--out", "out", "--quiet", "--seed", seed)
                self.alone[verb, seed] = self.contents(verb)
        self.duration = (time.monotonic() - began) / 4

    def contents(self, verb):
        out = self.folder / "out"
        if not all((out / name).exists() for name in (*FILES[verb], "result.json")):
            return None
        return {"result.json": self.numbers(), **{name: (out / name).read_bytes() for name in FILES[verb]}}

    def attack(self, chance, number):
        if chance.random() < 0.5:
            self.remove("out")
        calls = [(chance.choice(list(FILES)), seed) for seed in (1, 2)]
        delay = chance.uniform(0.0, self.duration)
        self.doing = f"{calls[0][0]} and, {delay:.3f} s after it, {calls[1][0]}"
        running, said = [], []
        for verb, seed in calls:
            process = self.start(verb, "study.toml", "--out", "out", "--quiet", "--seed", seed, err=subprocess.PIPE)
            running.append(process)
            said.append(attack.Drain(process.stderr))
            time.sleep(delay)
            delay = 0
        codes = [attack.wait(process, time.monotonic() + 60 * PATIENCE)[0] for process in running]
        told = [drain.text() for drain in said]
        demand(0 in codes and set(codes) <= {0, 2}, f"ended with {codes}: {told}")
        for code, text in zip(codes, told):
            demand(code == 0 or "another Mottle is filling this folder" in text, f"refused with {text!r}")
        ended_well = [call for call, code in zip(calls, codes) if code == 0]
        demand(any(self.contents(verb) == self.alone[verb, seed] for verb, seed in ended_well), "files of both, or of none")


class WritersTest(attack.AttackTest):
    def test_one_of_two_writers_leaves_its_results_whole(self):
        self.survive(Writers)


if __name__ == "__main__":
    attack.main()
