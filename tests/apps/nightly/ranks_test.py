"""The command under mpirun: what ranks_test.py has in a smaller size, or once.

A rank waits 4 s for others: on a busy machine it may be too early that it gives up.

    python3 nightly/ranks_test.py PATH_TO_MOTTLE
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import support  # noqa: E402  (found by the line above)
from rank_jobs import AIRFRAME, RanksTest  # noqa: E402


class Ranks(RanksTest):
    def test_an_airframe(self):
        self.expect_same("update", AIRFRAME / "study.toml", ranks=(2, 4), options=("--set", "update.samples=200"))

    def test_a_rank_that_never_joins_is_told(self):
        update = [support.MOTTLE, "update", "study.toml", "--out", "out", "--quiet"]
        self.expect_told(update, ["/bin/true"], update_is_first=False)
        self.expect_told(update, [support.MOTTLE, "check", "study.toml"], update_is_first=True)


if __name__ == "__main__":
    support.main()
