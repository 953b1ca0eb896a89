"""mottle completion: what a shell completes, and that the help lists every verb.

    python3 completion_test.py PATH_TO_MOTTLE
"""

import re
import shutil
import subprocess
import unittest

import support


class CompletionTest(support.CommandTest):
    def verbs(self):
        return re.findall(r"^  ([a-z]+)  +[A-Za-z]", self.succeed("--help").out, re.MULTILINE)

    def complete(self, *words):
        """The answers of bash to these words, the last of which is being typed."""
        script = self.write("mottle.bash", self.succeed("completion", "bash").out)
        call = f"source {script}; COMP_WORDS=({' '.join(words)}); COMP_CWORD={len(words) - 1}; _mottle; echo ${{COMPREPLY[@]}}"
        done = subprocess.run(["bash", "-c", call], capture_output=True, text=True, check=True, cwd=self.folder)
        return done.stdout.split()

    def test_bash_completes_verbs_options_and_files(self):
        self.assertEqual(set(self.complete("mottle", "''")), set(self.verbs()))
        self.assertEqual(self.complete("mottle", "ex"), ["export"])
        self.assertEqual(self.complete("mottle", "update", "--th"), ["--threads"])
        self.assertEqual(self.complete("mottle", "update", "tes"), ["tests.csv"])

    def test_every_option_of_the_help_is_completed(self):
        for verb in self.verbs():
            named = set(re.findall(r"^ +(?:-\w,)?(--[a-z-]+)", self.succeed(verb, "--help").out, re.MULTILINE))
            self.assertEqual(set(self.complete("mottle", verb, "--")) & named, named, verb)

    def test_the_scripts_of_other_shells_are_their_language(self):
        for shell in ("zsh", "fish"):
            script = self.write("script", self.succeed("completion", shell).out)
            if shutil.which(shell):
                subprocess.run([shell, "-n", script], check=True)
            self.assertIn("export", script.read_text())
        self.assertEqual(self.call("completion", "csh").code, 2)


if __name__ == "__main__":
    support.main()
