"""mottle compare: the numbers of several results side by side.

    python3 compare_test.py PATH_TO_MOTTLE
"""

import json
import math
import shutil
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

    def test_a_page_of_another_version_is_replaced_and_no_other_file(self):
        self.succeed("compare", "a", "b", "--out", "page.html")
        page = self.folder / "page.html"
        ours = page.read_text(encoding="utf-8")
        page.write_text(ours.replace("<meta charset", '<meta name="version" content="older">\n<meta charset', 1), encoding="utf-8")
        self.succeed("compare", "a", "b", "--out", "page.html")
        self.assertEqual(page.read_text(encoding="utf-8"), ours)
        page.write_text("<!doctype html><p>mine</p>", encoding="utf-8")
        ended = self.call("compare", "a", "b", "--out", "page.html")
        self.assertEqual(ended.code, 2, ended.out)
        self.assertIn("mine", page.read_text(encoding="utf-8"))

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


class EvidenceTest(support.CommandTest):
    """Models compared by their evidence."""

    BAYES = support.edited(support.STUDY, ('method = "mares"', 'method = "bayes"'),
                           ("[update.mares]\nweighting = \"mahalanobis\"\n", "[update.bayes]\nparticles = 200\n"),
                           ('file = "tests.csv"', 'file = "tests.csv"\nrepeatability = { "f*" = 0.02 }'))

    def setUp(self):
        super().setUp()
        self.update("a")

    def update(self, out, *edits, options=()):
        self.write(f"{out}.toml", support.edited(self.BAYES, *edits) if edits else self.BAYES)
        self.succeed("update", f"{out}.toml", "--out", out, "--quiet", *options)
        return support.read_result(self.folder / out)

    def evidence(self, *folders):
        return json.loads(self.succeed("compare", *folders, "--json").out)["evidence"]

    def test_bayes_factors_and_probabilities_are_those_of_the_evidences(self):
        results = [support.read_result(self.folder / "a"), self.update("b", ("stiffness = 3.0", "stiffness = 2.9"))]
        models = self.evidence("a", "b")["models"]
        logs = [result["evidence"]["ln_evidence"] for result in results]
        errors = [result["evidence"]["standard_error"] for result in results]
        for model, log in zip(models, logs, strict=True):
            self.assertAlmostEqual(model["ln_bayes_factor"], max(logs) - log, delta=1e-12)
            self.assertAlmostEqual(model["probability"], math.exp(log) / sum(map(math.exp, logs)), delta=1e-12)
            self.assertTrue(model["probability_ci95"][0] <= model["probability"] <= model["probability_ci95"][1])
        self.assertAlmostEqual(max(model["ln_bayes_factor_standard_error"] for model in models), math.hypot(*errors), delta=1e-12)
        pointwise = [result["posterior"]["leave_one_out"]["pointwise"] for result in results]
        apart = [abs(a - b) for a, b in zip(*pointwise)]
        self.assertAlmostEqual(min(model["elpd_difference"] for model in models), -abs(math.fsum(pointwise[0]) - math.fsum(pointwise[1])), delta=1e-9)
        self.assertEqual(len(apart), 6)
        lines = self.succeed("compare", "a", "b").out
        self.assertIn("ln Bayes factor", lines)
        self.assertIn("Kass and Raftery 1995", lines)
        self.succeed("compare", "a", "b", "--out", "page.html")
        html = (self.folder / "page.html").read_text(encoding="utf-8")
        start = html.index('id="mottle-data">') + len('id="mottle-data">')
        self.assertEqual(json.loads(html[start:html.index("</script", start)])["evidence"]["models"], models)

    def refused(self, out, reason):
        evidence = self.evidence("a", out)
        self.assertEqual(evidence["models"], [])
        self.assertEqual([entry["label"] for entry in evidence["not_compared"]], [out])
        self.assertIn(reason, evidence["not_compared"][0]["reason"])
        self.assertIn(f"not compared by evidence: {out}: ", self.succeed("compare", "a", out).out)

    def test_other_data_are_not_compared(self):
        lines = support.TESTS.splitlines()
        cells = lines[2].split(",")
        self.write("other.csv", "\n".join([*lines[:2], ",".join([str(1.01 * float(cells[0])), *cells[1:]]), *lines[3:]]) + "\n")
        self.write("fewer.csv", "\n".join(lines[:-1]) + "\n")
        self.update("values", ('"tests.csv"', '"other.csv"'))
        self.refused("values", "its tests are others than those of a: row 2 there (with f1 = ")
        self.update("specimens", ('"tests.csv"', '"fewer.csv"'))
        self.refused("specimens", "it has 5 specimens, a has 6")
        self.update("outputs", ("frequencies = [1, 2, 3]", "frequencies = [1, 2]"))
        self.refused("outputs", "its outputs are others than those of a: it has no f3")

    def test_the_order_of_specimens_and_outputs_does_not_matter(self):
        first = support.read_result(self.folder / "a")["posterior"]["leave_one_out"]["pointwise"]
        header, *rows = (line.split(",") for line in support.TESTS.splitlines())
        turned = [",".join(reversed(line)) for line in (header, *reversed(rows))]
        self.write("turned.csv", "\n".join(turned) + "\n")
        other = self.update("turned", ('"tests.csv"', '"turned.csv"'), ("stiffness = 3.0", "stiffness = 2.9"))
        evidence = self.evidence("a", "turned")
        self.assertEqual(evidence["not_compared"], [])
        apart = [b - a for a, b in zip(first, reversed(other["posterior"]["leave_one_out"]["pointwise"]), strict=True)]
        mean = math.fsum(apart) / len(apart)
        error = math.sqrt(len(apart) * math.fsum((x - mean) ** 2 for x in apart) / (len(apart) - 1))
        self.assertAlmostEqual(max(model["elpd_difference_standard_error"] for model in evidence["models"]), error, delta=1e-9)

    def test_one_run_is_not_compared_with_itself(self):
        shutil.copytree(self.folder / "a", self.folder / "copy")
        self.refused("copy", "its evidence is that of a to the last digit")

    def test_a_method_without_evidence_is_named(self):
        self.write("mares.toml", support.STUDY)
        self.succeed("update", "mares.toml", "--out", "mares", "--quiet")
        self.refused("mares", "method 'mares' gives no evidence")
        self.assertIsNone(self.evidence("mares", "mares"))

    def test_other_noise_is_a_warning(self):
        self.update("noise", ("0.02 }", "0.03 }"))
        self.update("error", ('repeatability', 'model_error = { "f*" = 0.001 }\nrepeatability'))
        for other in ("noise", "error"):
            evidence = self.evidence("a", other)
            self.assertEqual(len(evidence["models"]), 2)
            self.assertIn(f"are others in {other} than in a", " ".join(evidence["warnings"]))
        self.assertEqual(self.evidence("a", "a")["warnings"], [])

    def test_a_stalled_result_is_a_warning(self):
        result = self.update("short", ("particles = 200", "particles = 100\nmax_moves = 1"))
        self.assertEqual(result["status"], "stalled")
        self.assertIn("short is stalled", " ".join(self.evidence("a", "short")["warnings"]))


if __name__ == "__main__":
    support.main()
