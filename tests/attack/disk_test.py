"""A full disk ends a run with exit code 3 and one message; what is there is whole; --resume goes on when there is room.

Needs the right to mount a tmpfs; is skipped where there is none.

    python3 disk_test.py PATH_TO_MOTTLE
"""

import os
import subprocess

from attack import support
from support import STUDY, edited, numbers

LONG = edited(STUDY, ("samples = 200", "samples = 40000"), ("iterations = 30", "iterations = 6"))
SIZE = 16 << 20


class DiskTest(support.CommandTest):
    """Each test has a small disk of its own; what a run with room leaves is made once."""

    whole = reference = None

    def setUp(self):
        super().setUp()
        self.disk = self.folder / "disk"
        self.disk.mkdir()
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={SIZE}", "tmpfs", str(self.disk)],
                               capture_output=True, text=True, check=False)
        if mount.returncode != 0:
            self.skipTest("no tmpfs can be mounted here: " + mount.stderr.strip())
        self.addCleanup(subprocess.run, ["umount", "-l", str(self.disk)], check=False)
        self.write("study.toml", LONG)
        if DiskTest.whole is None:
            self.succeed("update", "study.toml", "--out", "whole", "--quiet")
            DiskTest.whole = {file.name: file.read_bytes() for file in (self.folder / "whole").iterdir() if file.suffix == ".csv"}
            DiskTest.reference = numbers(self.folder / "whole")

    def leave_room(self, room):
        """Fills the disk but for `room` bytes."""
        filler = self.disk / "filler"
        filler.unlink(missing_ok=True)
        state = os.statvfs(self.disk)
        free = state.f_bavail * state.f_frsize
        filler.write_bytes(b"\0" * max(0, free - room))

    def assert_fails_and_resumes(self, room):
        self.leave_room(room)
        ended = self.call("update", "study.toml", "--out", "disk/out")
        self.assertEqual(ended.code, 3, f"{room} bytes of room: {ended.err}")
        lines = [line for line in ended.err.splitlines() if line.startswith("mottle: ")]  # beside what shows progress
        self.assertEqual(len(lines), 1, ended.err)
        self.assertIn("disk/out", lines[0])
        self.assertIn("No space left on device", lines[0])
        out = self.disk / "out"
        if (out / "result.json").exists():
            self.assertEqual(numbers(out), self.reference)
        self.assertFalse(list(out.glob("*.partial")), "half a file is left")
        for name in ("history.csv", "cloud-initial.csv", "cloud-final.csv", "clouds.csv"):
            if (out / name).exists():
                self.assertEqual((out / name).read_bytes(), self.whole[name])
        (self.disk / "filler").unlink()
        ended = self.call("update", "study.toml", "--out", "disk/out", "--resume", "--quiet")
        self.assertEqual(ended.code, 0, ended.err)
        self.assertEqual(numbers(out), self.reference)
        for file in out.iterdir():
            file.unlink()
        out.rmdir()

    def test_no_room_at_all(self):
        self.assert_fails_and_resumes(0)

    def test_room_runs_out_in_the_journal(self):
        self.assert_fails_and_resumes(1 << 20)

    def test_room_runs_out_in_the_results(self):
        # The journal takes 24 bytes a sample and state; the results come on top of it.
        states = len(self.whole["history.csv"].splitlines()) - 1
        journal = 40000 * 24 * states
        for beyond in (1 << 18, 3 << 20, 6 << 20):
            if journal + beyond < SIZE:
                self.assert_fails_and_resumes(journal + beyond)

    def test_a_full_disk_is_no_fault_of_the_input_in_other_verbs(self):
        self.write("study.toml", edited(LONG, ("[outputs]", "[truth]\nspecimens = 5000\n\n[outputs]")))
        for verb in ("simulate", "propagate"):
            self.leave_room(1 << 14)
            ended = self.call(verb, "study.toml", "--out", "disk/" + verb)
            self.assertEqual(ended.code, 3, f"{verb}: {ended.err}")
            self.assertIn("No space left on device", ended.err)
            self.assertFalse((self.disk / verb / "specimens.csv").exists())

    def test_the_report_is_whole_or_the_old_one(self):
        self.succeed("update", "study.toml", "--out", "disk/out", "--quiet")
        page = (self.disk / "out" / "report.html").read_bytes()
        self.leave_room(1 << 16)
        ended = self.call("report", "disk/out")
        self.assertEqual(ended.code, 3, ended.err)
        self.assertEqual((self.disk / "out" / "report.html").read_bytes(), page)


if __name__ == "__main__":
    support.main()
