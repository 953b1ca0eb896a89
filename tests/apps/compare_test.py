"""mottle compare: the numbers of several results side by side.

    python3 compare_test.py PATH_TO_MOTTLE
"""

import json
import math
import unittest

import support


class CompareTest(support.CommandTest):
    def setUp(self):
        super().setUp()
        self.succeed("update", "study.toml", "--out", "a", "--quiet")
        self.succeed("update", "study.toml", "--out", "b", "--quiet", "--set", 'update.method="maximum-likelihood"')

    def test_it_has_the_numbers_of_each_result(self):
        runs = json.loads(self.succeed("compare", "a", "b", "--json").out)["runs"]
        for run in runs:
            result = support.read_result(self.folder / run["label"])
            self.assertEqual(run["method"], result["method"])
            self.assertEqual(run["verdict"], result["verdict"]["conclusion"])
            self.assertEqual(run["specimens"], 6)
            for one, mean, std in zip(run["parameters"], result["parameters"]["mean"], result["parameters"]["std"], strict=True):
                self.assertEqual((one["mean"], one["std"]), (mean, std))
            outputs = result["outputs"]
            for k, one in enumerate(run["outputs"]):
                noise = (outputs["noise_std"] or [0.0] * 3)[k] or 0.0
                ratio = math.sqrt((outputs["final_covariance"][k][k] + noise**2) / outputs["test_covariance"][k][k])
                self.assertAlmostEqual(one["scatter_ratio"], ratio, delta=1e-12)

    def test_the_table_has_a_column_for_each_run(self):
        lines = self.succeed("compare", "a", "b").out.splitlines()
        self.assertEqual(lines[0].split(), ["a", "b"])
        self.assertIn("mares", next(line for line in lines if line.startswith("method")))
        self.assertTrue(any(line.strip().startswith("k1 ") for line in lines))

    def test_the_page_holds_what_the_results_hold(self):
        out = self.succeed("compare", "a", "b", "--out", "pages/both.html").out
        self.assertIn("page: pages/both.html", out)
        html = (self.folder / "pages" / "both.html").read_text(encoding="utf-8")
        start = html.index('id="mottle-data">') + len('id="mottle-data">')
        data = json.loads(html[start:html.index("</script", start)])
        self.assertEqual(data["kind"], "compare")
        for run, label in zip(data["runs"], ("a", "b"), strict=True):
            result = support.read_result(self.folder / label)
            self.assertEqual(run["report"], f"../{label}/report.html")
            for part in ("parameters", "outputs", "verdict"):
                for key, value in run["result"][part].items():
                    self.assertEqual(value, result[part][key], key)
            self.assertEqual(run["result"]["agreement"], result["agreement"])

    def test_a_page_of_another_name_is_refused(self):
        ended = self.call("compare", "a", "b", "--out", "a/result.json")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn(".html", ended.err)
        support.read_result(self.folder / "a")

    def test_folders_of_one_name_are_told_apart(self):
        self.succeed("update", "study.toml", "--out", "one/out", "--quiet")
        self.succeed("update", "study.toml", "--out", "two/out", "--quiet")
        self.assertEqual(self.succeed("compare", "one/out", "two/out").out.splitlines()[0].split(), ["one/out", "two/out"])

    def test_studies_with_other_parameters_have_gaps(self):
        self.write("other.toml", support.edited(support.STUDY, ('name = "k2"\ntarget = "spring:k2"', 'name = "k5"\ntarget = "spring:k5"')))
        self.succeed("update", "other.toml", "--out", "c", "--quiet")
        lines = self.succeed("compare", "a", "c").out.splitlines()
        self.assertTrue(next(line for line in lines if line.strip().startswith("k2 ")).endswith("-"))

    def test_wrong_folders_are_named(self):
        for folders, told in ((["a"], "two or more"), (["a", "none"], "none: holds no result.json")):
            ended = self.call("compare", *folders)
            self.assertEqual(ended.code, 2, ended.out)
            self.assertIn(told, ended.err)


if __name__ == "__main__":
    support.main()
