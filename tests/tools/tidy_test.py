#!/usr/bin/env python3
"""tools/tidy.py reads a group again whenever anything that it includes, the rules or its command has changed, and only then."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

TIDY = pathlib.Path(__file__).resolve().parents[2] / "tools/tidy.py"
ROOT = TIDY.parents[1]
# Stands in for clang-tidy: counts its calls, finds the word BAD in the source or in the header beside it; may be killed, and
# see the header edited while it reads.
STAND_IN = """#!/bin/sh
case "$1" in --version) echo "stand-in $VERSION"; exit;; esac
for file; do :; done
echo "$file" >> "$CALLS"
if [ -n "$KILLED" ]; then kill -9 $$; fi
if grep -n BAD "$file" "$(dirname "$file")/x.hpp"; then exit 1; fi
if [ -n "$EDITED" ]; then echo "// BAD" >> "$(dirname "$file")/x.hpp"; fi
"""


class Tidy(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.clone = self.make_clone("clone")
        stand_in = self.folder / "bin" / "clang-tidy"
        stand_in.parent.mkdir()
        stand_in.write_text(STAND_IN)
        stand_in.chmod(0o755)

    def make_clone(self, name):
        clone = self.folder / name
        (clone / "src/core").mkdir(parents=True)
        (clone / "tools").mkdir()
        (clone / "build").mkdir()
        shutil.copy(TIDY, clone / "tools")
        (clone / ".clang-tidy").write_text("Checks: '*'\n")
        (clone / "src/core/x.hpp").write_text("int x();\n")
        (clone / "src/core/x.cpp").write_text('#include "x.hpp"\nint x() { return 1; }\n')
        self.compile_with(clone, "-O1")
        return clone

    def compile_with(self, clone, flags):
        source = str(clone / "src/core/x.cpp")
        (clone / "build/compile_commands.json").write_text(json.dumps(
            [{"directory": str(clone / "build"), "file": source, "command": f"c++ {flags} -o x.o -c '{source}'"}]))

    def calls(self, *arguments, clone=None, version="1", **variables):
        """How often clang-tidy was called, and the exit code."""
        clone, record = clone or self.clone, self.folder / "calls"
        record.write_text("")
        environment = {**os.environ, "PATH": f"{self.folder}/bin:{os.environ['PATH']}", "CALLS": str(record), "VERSION": version,
                       "MOTTLE_TIDY_CACHE": str(self.folder / "cache"), **variables}
        done = subprocess.run([sys.executable, clone / "tools/tidy.py", clone / "build", "2", *arguments], env=environment,
                              capture_output=True, text=True)
        return len(record.read_text().splitlines()), done.returncode

    def test_an_unchanged_group_is_read_once(self):
        self.assertEqual(self.calls(), (1, 0))
        self.assertEqual(self.calls(), (0, 0))
        self.assertEqual(self.calls("--fresh"), (1, 0))

    def test_another_clone_of_the_same_sources_is_not_read(self):
        self.assertEqual(self.calls(), (1, 0))
        self.assertEqual(self.calls(clone=self.make_clone("another")), (0, 0))

    def test_a_finding_is_reported_each_time(self):
        self.assertEqual(self.calls(), (1, 0))
        (self.clone / "src/core/x.hpp").write_text("int x();  // BAD\n")
        self.assertEqual(self.calls(), (1, 1))
        self.assertEqual(self.calls(), (1, 1))
        (self.clone / "src/core/x.hpp").write_text("int x();\n")
        self.assertEqual(self.calls(), (0, 0))  # a state that had no finding

    def test_source_rules_command_and_version_each_count(self):
        self.assertEqual(self.calls(), (1, 0))
        (self.clone / "src/core/x.cpp").write_text('#include "x.hpp"\nint x() { return 2; }\n')
        self.assertEqual(self.calls(), (1, 0))
        (self.clone / ".clang-tidy").write_text("Checks: 'bugprone-*'\n")
        self.assertEqual(self.calls(), (1, 0))
        self.compile_with(self.clone, "-O2")
        self.assertEqual(self.calls(), (1, 0))
        self.assertEqual(self.calls(version="2"), (1, 0))
        self.assertEqual(self.calls(version="2"), (0, 0))

    def test_a_run_that_is_killed_is_a_finding(self):
        self.assertEqual(self.calls(KILLED="yes"), (1, 1))
        self.assertEqual(self.calls(), (1, 0))

    def test_what_is_edited_while_it_is_read_is_read_again(self):
        self.assertEqual(self.calls(EDITED="yes"), (1, 0))
        self.assertEqual(self.calls(), (1, 1))

    def test_a_path_may_hold_blanks_and_other_signs(self):
        clone = self.make_clone("a clone, #2 $x")
        self.assertEqual(self.calls(clone=clone), (1, 0))
        self.assertEqual(self.calls(clone=clone), (0, 0))
        (clone / "src/core/x.hpp").write_text("int x();  // BAD\n")
        self.assertEqual(self.calls(clone=clone), (1, 1))


@unittest.skipUnless(shutil.which("clang-tidy"), "no clang-tidy here")
class Rules(unittest.TestCase):
    def test_findings_within_a_group_are_reported_from_every_folder(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            files = ["src/core/a.cpp", "include/mottle/core/b.hpp", "apps/mottle/c.cpp", "bindings/python/engine/d.cpp", "modules/mpi/e.hpp"]
            for number, file in enumerate(files):
                (folder / file).parent.mkdir(parents=True, exist_ok=True)
                (folder / file).write_text(f"inline int Badly_Named{number}() {{ return {number}; }}\n")
            group = folder / "group.cxx"
            group.write_text("".join(f'#include "{folder / file}"\n' for file in files))
            done = subprocess.run(["clang-tidy", "--quiet", f"--config-file={ROOT}/.clang-tidy", group, "--", "-std=c++20"],
                                  capture_output=True, text=True)
            for number in range(len(files)):
                self.assertIn(f"Badly_Named{number}", done.stdout, files[number])


if __name__ == "__main__":
    unittest.main()
