"""The same numbers at any number of threads, where a method samples as long as it does by default.

    python3 nightly/reproducibility_test.py PATH_TO_MOTTLE
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import support  # noqa: E402  (found by the line above)
from support import STUDY, edited, numbers  # noqa: E402


class ReproducibilityTest(support.CommandTest):
    def test_threads_do_not_change_the_numbers(self):
        for method in ("mares", "bayes", "hierarchical", "abc"):
            with self.subTest(method):
                self.write("study.toml", edited(STUDY, ('method = "mares"', f'method = "{method}"')))
                for threads in (1, 2, 3, 8):
                    self.succeed("update", "study.toml", "--out", f"t{threads}", "--threads", threads, "--quiet", timeout=600)
                for threads in (2, 3, 8):
                    self.assertEqual(numbers(self.folder / f"t{threads}"), numbers(self.folder / "t1"), f"{threads} threads")
                    self.assertEqual((self.folder / f"t{threads}" / "cloud-final.csv").read_bytes(),
                                     (self.folder / "t1" / "cloud-final.csv").read_bytes())


if __name__ == "__main__":
    support.main()
