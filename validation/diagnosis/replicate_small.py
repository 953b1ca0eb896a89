#!/usr/bin/env python3
"""Replicates the diagnosis with few specimens whose noise is not known: how often is a candidate named without need?

As replicate.py, with the mode shapes measured and without [test] repeatability: Mottle estimates the noise. Case 1 (nothing
is missing) at 3, 4, 6 and 10 specimens, and cases 2 and 3 for the power. Writes the table to SMALL-SAMPLES.md.

    python3 validation/diagnosis/replicate_small.py [--mottle build/release/mottle] [--replications 400] [--power 100]
"""
import argparse
import concurrent.futures
import datetime
import math
import pathlib
import re
import sys

import replicate

FIRST_SEED = 9000
LEVEL = 0.05
ROWS = [(1, 3), (1, 4), (1, 6), (1, 10), (2, 3), (2, 4), (2, 6), (2, 10), (3, 4)]


def study_text(k6, has_shapes, specimens):
    text = ORIGINAL(k6, has_shapes)
    start, end = text.index("[test.repeatability]"), text.index("[truth]")
    text = text[:start] + text[end:]
    return re.sub(r"specimens = \d+", f"specimens = {specimens}", text)


ORIGINAL = replicate.study_text


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--mottle", type=pathlib.Path, default=replicate.ROOT / "build" / "release" / "mottle")
    parser.add_argument("--replications", type=int, default=400)
    parser.add_argument("--power", type=int, default=100)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--dry", action="store_true", help="print the table, write nothing")
    arguments = parser.parse_args()
    lines = ["| case | specimens | replications | a candidate is named | k6 named, alone or among equally good ones |",
             "|---|---|---|---|---|"]
    checks = {}
    for case, specimens in ROWS:
        replicate.study_text = lambda k6, has_shapes, n=specimens: study_text(k6, has_shapes, n)
        count = arguments.replications if case == 1 else arguments.power
        with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
            results = list(pool.map(lambda seed: replicate.replicate(arguments.mottle, case, True, seed),
                                    range(FIRST_SEED, FIRST_SEED + count)))
        named = sum(result["explained"] for result in results) / count
        right = sum(result["explained"] and "k6" in result["alike"] for result in results) / count
        lines.append(f"| {case} | {specimens} | {count} | {100 * named:.1f} % | {100 * right:.1f} % |")
        print(lines[-1], flush=True)
        if case == 1:  # 7 %, and two standard errors of the count
            limit = LEVEL + 0.02 + 2.0 * math.sqrt(LEVEL * (1.0 - LEVEL) / count)
            checks[f"case 1, {specimens} specimens: a candidate named in at most 7 % (with the count's error "
                   f"{100 * limit:.1f} %)"] = named <= limit
        elif specimens >= 6:
            checks[f"case {case}, {specimens} specimens: k6 named in at least 95 %"] = right >= 0.95
    verdicts = [f"- {'passed' if passed else 'FAILED'}: {claim}" for claim, passed in checks.items()]
    version = replicate.run(arguments.mottle, "--version").strip()
    text = "\n".join(["# Which spring is missing, with few specimens and unknown noise?", "",
                      f"Frequencies and shapes measured, seeds from {FIRST_SEED} on, {version}, "
                      f"{datetime.date.today().isoformat()}; made by replicate_small.py. Level 5 % for all candidates together.",
                      "", *lines, "", *verdicts, ""])
    if not arguments.dry:
        (replicate.HERE / "SMALL-SAMPLES.md").write_text(text)
    print(text)
    return 0 if all(checks.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
