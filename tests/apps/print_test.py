"""mottle report --pdf: the summary on paper, by whatever browser is on PATH.

    python3 print_test.py PATH_TO_MOTTLE
"""

import shutil
import unittest

import support

# Writes its arguments where it was told to print; FAILURE makes it end without.
BROWSER = """\
#!/bin/sh
PATH=/usr/bin:/bin
FAILURE
for argument in "$@"; do
  case "$argument" in --print-to-pdf=*) file="${argument#--print-to-pdf=}";; esac
done
printf '%s\\n' %PDF-1.4 "$@" > "$file"
"""


class PrintTest(support.CommandTest):
    def setUp(self):
        super().setUp()
        self.succeed("update", "study.toml", "--out", "a b#1", "--quiet")

    def print_by(self, script):
        programs = self.folder / "programs"
        if script is not None:
            self.write("programs/chromium", script).chmod(0o755)
        return self.call("report", "a b#1", "--pdf", environment={"PATH": f"{programs}"})

    def test_a_browser_is_handed_the_pages_address(self):
        ended = self.print_by(BROWSER.replace("FAILURE", ""))
        self.assertEqual((ended.code, ended.err), (0, ""))
        self.assertIn("a b#1/report.pdf", ended.out)
        handed = (self.folder / "a b#1" / "report.pdf").read_text().splitlines()
        self.assertIn("--headless", handed)
        self.assertEqual(handed[-1], f"file://{self.folder.resolve()}/a%20b%231/report.html")

    def test_what_is_no_pdf_replaces_none(self):
        self.assertEqual(self.print_by(BROWSER.replace("FAILURE", "")).code, 0)
        printed = self.folder / "a b#1" / "report.pdf"
        before = printed.read_bytes()
        for script in (BROWSER.replace("%PDF-1.4", "'<html>'"), '#!/bin/sh\n: > "${6#--print-to-pdf=}"\n'):
            ended = self.print_by(script)
            self.assertEqual(ended.code, 3, ended.err)
            self.assertEqual(printed.read_bytes(), before)

    def test_a_pdf_of_the_users_stays(self):
        mine = self.write("a b#1/report.pdf", "mine")
        ended = self.print_by(BROWSER.replace("FAILURE", ""))
        self.assertEqual(ended.code, 2, ended.err)
        self.assertEqual(mine.read_text(encoding="utf-8"), "mine")

    def test_without_a_browser_it_says_what_can_be_done(self):
        ended = self.print_by(None)
        self.assertEqual(ended.code, 2)
        for part in ("--pdf", "chromium", "report.html"):
            self.assertIn(part, ended.err)
        self.assertTrue((self.folder / "a b#1" / "report.html").is_file())

    def test_a_browser_that_fails_or_writes_nothing_leaves_no_file(self):
        for failure, said in (("exit 7", "exit status 7"), ("exit 0", "wrote no file")):
            ended = self.print_by(BROWSER.replace("FAILURE", failure))
            self.assertEqual(ended.code, 3)
            self.assertIn(said, ended.err)
            self.assertFalse((self.folder / "a b#1" / "report.pdf").exists())

    @unittest.skipUnless(shutil.which("chromium"), "needs chromium")
    def test_chromium_prints_two_pages_at_most(self):
        self.succeed("report", "a b#1", "--pdf", "--quiet", timeout=200)
        pdf = (self.folder / "a b#1" / "report.pdf").read_bytes()
        self.assertTrue(pdf.startswith(b"%PDF"))
        self.assertIn(pdf.count(b"/Type /Page\n"), (1, 2))


if __name__ == "__main__":
    support.main()
