"""A solver that writes without measure: its sample fails or passes in bounded time and memory.

The job must end within its time limit, which a busy machine may exceed.

    python3 output_test.py PATH_TO_MOTTLE
"""

import attack
import faults_test
from attack import demand

MUCH = "block = b'x' * 99 + b'\\n'; block *= 10000\nMEGABYTES = {}\n"
# Of which the sample's run is a failure.
FAILS = {
    "prints much and ends with a status": "for _ in range(MEGABYTES): os.write(1, block)\n    sys.exit(1)",
    "complains much and ends with a status": "for _ in range(MEGABYTES): os.write(2, block)\n    sys.exit(1)",
    "leaves much that is no number": "with open('f.txt', 'wb') as f:\n        for _ in range(MEGABYTES): f.write(block)",
}
PASSES = {
    "prints much": "for _ in range(MEGABYTES): os.write(1, block)\n    leave_all()",
    "leaves much behind its table": "leave_all()\n    with open('f.txt', 'ab') as f:\n        f.write(b'\\n')\n"
                                    "        for _ in range(MEGABYTES): f.write(block)",
    "leaves much in another file": "leave_all()\n    with open('other', 'wb') as f:\n        for _ in range(MEGABYTES): f.write(block)",
}


class Floods(faults_test.Faults):
    title = "solvers that write 50 MB"
    megabytes = 50
    table = [(name, text, True, False) for name, text in FAILS.items()] + [(name, text, False, False) for name, text in PASSES.items()]
    few = many = len(table)
    minutes = 1

    def lay_out(self, fault, limit, patience):
        super().lay_out(fault, limit, patience)
        solver = self.folder / "solver.py"
        solver.write_text(MUCH.format(self.megabytes) + solver.read_text(encoding="utf-8"), encoding="utf-8")


class LargeFloods(Floods):
    """Not in the tests: a gigabyte; of what a failed run has printed only the last part is kept."""

    title = "solvers that write 1 GB"
    megabytes = 1024
    # Beyond the 256 MB that a run may print.
    table = [(name, text, fails or name == "prints much", is_slow) for name, text, fails, is_slow in Floods.table]
    few = 0
    seconds = 300

    def attack(self, chance, number):
        super().attack(chance, number)
        kept = sum(path.stat().st_size for path in (self.folder / "out").rglob("std*.txt"))
        demand(kept < 40e6, f"{kept / 1e6:.0f} MB of output are left in the folder of results")


class OutputTest(attack.AttackTest):
    def test_much_output_takes_little(self):
        self.survive(Floods)


if __name__ == "__main__":
    attack.main()
