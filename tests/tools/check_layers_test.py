#!/usr/bin/env python3
"""The layer check finds each kind of violation that is planted, and is silent on a sound tree."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

CHECKER = pathlib.Path(__file__).resolve().parents[2] / "tools/check_layers.py"
TABLE = "core:\nstats: core\nmodal: core\nstudy: stats modal\napps: study\n"


class CheckLayers(unittest.TestCase):
    def run_on(self, files):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in {"tools/layers.txt": TABLE, **files}.items():
                path = pathlib.Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            done = subprocess.run([sys.executable, CHECKER, "--root", folder], capture_output=True, text=True)
            return done.returncode, done.stdout

    def assert_found(self, file, line, text):
        code, output = self.run_on({file: "\n" * (line - 1) + text + "\n"})
        self.assertEqual(code, 1, output)
        self.assertIn(f"{file}:{line}: ", output)

    def assert_sound(self, file, text):
        code, output = self.run_on({file: text + "\n"})
        self.assertEqual(code, 0, output)

    def test_a_layer_may_include_itself_and_everything_below(self):
        self.assert_sound("src/study/x.cpp", '#include "mottle/study/x.hpp"\n#include "mottle/core/x.hpp"')
        self.assert_sound("apps/mottle/main.cpp", '#include "mottle/modal/x.hpp"')
        self.assert_sound("tests/stats/x_test.cpp", '#include "stats/private.hpp"\n#include <openturns/OT.hxx>')

    def test_an_upward_include_is_found_in_source_header_and_test(self):
        for file in ("src/core/x.cpp", "include/mottle/core/x.hpp", "tests/core/x_test.cpp"):
            self.assert_found(file, 3, '#include "mottle/stats/x.hpp"')

    def test_a_sideways_include_is_found(self):
        self.assert_found("src/modal/x.cpp", 1, "#  include <mottle/stats/x.hpp>")

    def test_anothers_private_header_is_found(self):
        self.assert_found("src/study/x.cpp", 1, '#include "stats/private.hpp"')
        self.assert_found("src/study/x.cpp", 1, '#include "../stats/private.hpp"')

    def test_a_tests_helper_may_be_used_by_the_layers_above_it(self):
        code, output = self.run_on({"tests/core/helper.hpp": "", "tests/stats/x_test.cpp": '#include "core/helper.hpp"'})
        self.assertEqual(code, 0, output)
        code, output = self.run_on({"tests/stats/helper.hpp": "", "tests/core/x_test.cpp": '#include "stats/helper.hpp"'})
        self.assertEqual(code, 1, output)

    def test_anothers_namespace_is_found(self):
        self.assert_found("src/stats/x.cpp", 2, "namespace mottle::study {")
        self.assert_found("include/mottle/stats/x.hpp", 2, "namespace mottle {")
        self.assert_found("src/core/x.cpp", 2, "namespace mottle::stats {")
        self.assert_sound("src/core/x.cpp", "namespace mottle {")
        self.assert_sound("src/study/x.cpp", "namespace mottle::stats {\nclass Declared;\n}\nnamespace mottle::study {")

    def test_a_table_of_namespaces_that_is_not_that_of_the_layers_is_found(self):
        self.assert_found("include/mottle/layers.hpp", 1, "namespace stats {}\nnamespace study {\nusing namespace stats;\n}")
        self.assert_sound("include/mottle/layers.hpp", "namespace stats {}\nnamespace modal {}\nnamespace study {\nusing namespace "
                          "stats;\nusing namespace modal;\n}\nnamespace app {\nusing namespace study;\n}")

    def test_an_unknown_layer_is_found(self):
        self.assert_found("src/study/x.cpp", 2, '#include "mottle/nowhere/x.hpp"')
        self.assert_found("src/nowhere/x.cpp", 1, "")

    def test_a_confined_library_is_found_elsewhere_and_in_public_headers(self):
        self.assert_found("src/study/x.cpp", 1, "#include <openturns/OT.hxx>")
        self.assert_found("include/mottle/stats/x.hpp", 1, "#include <openturns/OT.hxx>")
        self.assert_found("include/mottle/study/x.hpp", 1, "#include <toml++/toml.h>")
        self.assert_found("include/mottle/study/x.hpp", 1, "#include <nlohmann/json.hpp>")

    def test_a_build_file_that_links_by_another_table_is_found(self):
        self.assert_found("CMakeLists.txt", 2, "mottle_layer(modal USES core stats LINKS PUBLIC fmt::fmt)")
        self.assert_sound("CMakeLists.txt", "mottle_layer(study USES stats modal LINKS PRIVATE OT)\nmottle_layer(core)")


if __name__ == "__main__":
    unittest.main()
