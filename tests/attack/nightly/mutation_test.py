"""More files of every reader, mutated: read, or refused with a message, in little time and memory.

    python3 nightly/mutation_test.py PATH_TO_MOTTLE
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import attack  # noqa: E402  (found by the line above)
from mutation_test import Mutations  # noqa: E402


class MutationTest(attack.AttackTest):
    def test_mutated_files_are_read_or_refused(self):
        self.survive(Mutations, range(Mutations.few, 1000))


if __name__ == "__main__":
    attack.main()
