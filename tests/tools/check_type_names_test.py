#!/usr/bin/env python3
"""The check of type names finds each kind of second definition that is planted, and is silent where there is none."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

CHECKER = pathlib.Path(__file__).resolve().parents[2] / "tools/check_type_names.py"


def in_house(text):
    return "namespace mottle {\n" + text + "\n}\n"


class CheckTypeNames(unittest.TestCase):
    def run_on(self, *texts):
        with tempfile.TemporaryDirectory() as folder:
            for number, text in enumerate(texts):
                path = pathlib.Path(folder, f"src/core/x{number}.cpp")
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            done = subprocess.run([sys.executable, CHECKER, "--root", folder], capture_output=True, text=True)
            return done.returncode, done.stdout

    def assert_found(self, first, second):
        code, output = self.run_on(in_house(first), in_house(second))
        self.assertEqual(code, 1, output)
        self.assertIn("mottle::Sight", output)
        self.assertIn("src/core/x1.cpp:2", output)

    def assert_sound(self, *texts):
        code, output = self.run_on(*texts)
        self.assertEqual(code, 0, output)

    def test_each_kind_of_type_is_found(self):
        first = "struct Sight { int a = 0; };"
        for second in ("class Sight final : public Base<int> {};", "enum class Sight : int { a };", "enum Sight { a };",
                       "template <typename T, int n>\nstruct Sight {};", "union Sight {};",
                       "struct alignas(64) Sight {};"):
            self.assert_found(first, second.replace("\n", " "))

    def test_a_name_of_two_layers_is_found(self):
        code, output = self.run_on("namespace mottle::stats {\nstruct Sight {};\n}\n", "namespace mottle::fem {\nclass Sight {};\n}\n")
        self.assertEqual(code, 1, output)
        self.assertIn("mottle::Sight is defined 2 times", output)

    def test_behind_functions_comments_and_texts_it_is_still_found(self):
        self.assert_found("struct Sight {};", 'int f() { return "{"[0]; } /* { */ struct Sight {};')

    def test_what_is_a_files_own_is_no_second_definition(self):
        self.assert_sound(in_house("struct Sight {};"), in_house("namespace {\nstruct Sight {};\n}"),
                          in_house("struct Other { struct Sight {}; };"), in_house("void f() { struct Sight {}; }"))

    def test_declarations_results_and_specialisations_are_no_definitions(self):
        self.assert_sound(in_house("struct Sight {};"), in_house("struct Sight;\nstruct Sight f() { return {}; }"),
                          in_house("// struct Sight {};\ntemplate <>\nstruct Sight<int> {};"))

    def test_another_namespace_is_another_name(self):
        self.assert_sound(in_house("struct Sight {};"), in_house("namespace app {\nstruct Sight {};\n}"))


if __name__ == "__main__":
    unittest.main()
