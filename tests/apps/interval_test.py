"""Boxes of parameters as a user meets them: keys of result.json, threads, resume, report, faults of the study.

    python3 interval_test.py PATH_TO_MOTTLE
"""

import json
import unittest

import support
from support import STUDY, edited, read_result

INTERVAL = edited(STUDY, ('method = "mares"', 'method = "interval"'),
                  ("[update.mares]\nweighting = \"mahalanobis\"\n", "[update.interval]\nbounds = \"observed\"\n"))


class IntervalTest(support.CommandTest):
    """One claim a test."""

    def setUp(self):
        super().setUp()
        self.write("study.toml", INTERVAL)

    def update(self, *options, out="out"):
        ended = self.succeed("update", "study.toml", "--out", out, *options)
        return read_result(self.folder / out), ended

    def refuse(self, setting, *fragments):
        ended = self.call("update", "study.toml", "--out", "out", "--quiet", "--set", setting)
        self.assertEqual(ended.code, 2, ended.err)
        for fragment in fragments:
            self.assertIn(fragment, ended.err)

    def test_the_result_holds_box_bounds_and_image(self):
        result, ended = self.update("--quiet")
        self.assertEqual(result["parameters"]["estimate"]["kind"], "box")
        for (low, high), mean, std in zip(*(result["parameters"][key] for key in ("box", "mean", "std"))):
            self.assertAlmostEqual(0.5 * (low + high), mean, delta=1e-12)
            self.assertAlmostEqual((high - low) / 12**0.5, std, delta=1e-12)
        block = result["interval"]
        self.assertTrue(block["certified"] and block["covered"])
        self.assertEqual(block["trends"], ["rising"] * 2)
        for output in block["image"]:
            self.assertEqual(output["bounds"], output["observed"])
            self.assertTrue(output["image"][0] <= output["bounds"][0] and output["image"][1] >= output["bounds"][1])
            self.assertTrue(output["proven"][0] <= output["image"][0] and output["proven"][1] >= output["image"][1])
        self.assertIn("observed bounds alone", " ".join(result["notes"]))
        self.assertNotEqual(result["verdict"]["conclusion"], "adequate")

    def test_threads_and_resuming_change_no_bit(self):
        one, _ = self.update("--quiet", "--threads", "1", out="one")
        three, _ = self.update("--quiet", "--threads", "3", out="three")
        again, _ = self.update("--quiet", "--resume", out="one")
        for key in ("parameters", "interval", "outputs", "verdict"):
            text = json.dumps(one[key])
            self.assertEqual(text, json.dumps(three[key]))
            self.assertEqual(text, json.dumps(again[key]))

    def test_other_methods_have_no_box(self):
        self.write("study.toml", STUDY)
        result, _ = self.update("--quiet")
        self.assertIsNone(result["interval"])
        self.assertIsNone(result["parameters"]["box"])

    def test_too_few_specimens_for_distribution_free_limits_are_an_error_with_their_number(self):
        self.refuse('update.interval.bounds="distribution-free"', "need 93 specimens", "normal-tolerance")

    def test_an_option_out_of_range_is_an_error(self):
        self.refuse("update.interval.content=1.0", "content", ">= 0.5 and <= 0.999")

    def test_the_report_shows_the_bounds(self):
        self.update("--quiet")
        self.assertIn('"interval"', (self.folder / "out" / "report.html").read_text(encoding="utf-8"))


if __name__ == "__main__":
    support.main()
