"""Standard streams that are closed or full, and what the machine refuses: said, and no bug.

    python3 streams_test.py PATH_TO_MOTTLE
"""

import resource
import subprocess

from attack import support
from support import numbers


class StreamsTest(support.CommandTest):
    """One claim a test."""

    def shell(self, line):
        return subprocess.run(["/bin/sh", "-c", line.replace("mottle", support.MOTTLE)], cwd=self.folder, text=True,
                              capture_output=True, check=False, timeout=60 * support.PATIENCE)

    def test_closed_streams_change_no_file(self):
        self.succeed("update", "study.toml", "--out", "whole", "--quiet")
        for closed in ("<&-", ">&-", "2>&-", "<&- >&- 2>&-"):
            ended = self.shell(f"mottle update study.toml --out out {closed}")
            self.assertEqual(ended.returncode, 0, closed + ended.stderr)
            self.assertEqual(numbers(self.folder / "out"), numbers(self.folder / "whole"), closed)

    def test_a_full_standard_output_is_an_error(self):
        for command in ("mottle update study.toml --out out", "mottle check study.toml --json", "mottle methods --json"):
            ended = self.shell(command + " >/dev/full")
            self.assertEqual(ended.returncode, 3, command + ended.stderr)
            self.assertIn("No space left", ended.stderr)

    def test_a_limit_of_file_sizes_is_said(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
        ended = subprocess.run([support.MOTTLE, "update", "study.toml", "--out", "out"], cwd=self.folder, text=True,
                               capture_output=True, check=False, preexec_fn=limit)
        self.assertEqual(ended.returncode, 3, ended.stderr)
        self.assertIn("File too large", ended.stderr)
        self.assertFalse((self.folder / "out" / "result.json").exists())


if __name__ == "__main__":
    support.main()
