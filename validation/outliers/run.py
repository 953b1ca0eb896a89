#!/usr/bin/env python3
"""Are outliers and populations that are not normal found, and only those? Replications with new specimens each time.

Needs the program built with -DMOTTLE_BUILD_VALIDATION=ON; every row is one call of it, its arguments are the row's first
columns. Writes RESULTS.md beside this file. Goals of levels are 5 % within 2 %, and three standard errors of the row.

    python3 validation/outliers/run.py [--program build/release/validation/outliers/mottle_outlier_replication]
"""
import argparse
import datetime
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
from replication import call  # noqa: E402

DEFAULT = HERE.parent.parent / "build/release/validation/outliers/mottle_outlier_replication"

# Columns: kind, specimens, variables, missing, noise, replications.
LEVELS = [("linear", n, q, 0, 0, 1000 if n < 50 else 500) for n in (6, 10, 20, 50) for q in (1, 3, 6)]
GAPS = [("linear", n, q, missing, noise, 1000) for n, q, missing, noise in (
    (6, 3, 0.4, 0), (10, 3, 0.4, 0), (20, 3, 0.4, 0), (10, 6, 0.4, 0), (10, 3, 0, 1), (10, 3, 0.4, 1))] + [
    ("three-masses", 10, 3, 0, 0, 500), ("three-masses", 10, 3, 0.4, 0, 300)]
OUTLIERS = [("linear", 12, 3, 0, 0, p, 1000) for p in ("same", "opposite", "apart", "oblique")] + [
    ("linear", 12, 1, 0, 0, "same", 1000), ("linear", 20, 6, 0, 0, "same", 500), ("linear", 20, 3, 0.2, 0, "same", 300),
    ("three-masses", 12, 3, 0, 0, "same", 300)]
SHAPES = [("linear", n, 3, 0, 0, p, 500) for p in ("batches:0.05", "batches:0.1", "batches:0.2", "lognormal")
          for n in (10, 20, 50)] + [
    ("linear", 20, 3, 0, 1, "batches:0.1", 500), ("linear", 20, 3, 0, 3, "batches:0.1", 500),
    ("three-masses", 20, 3, 0, 0, "batches:0.1", 200), ("three-masses", 50, 3, 0, 0, "lognormal", 200)]


def is_level(percent, replications, lowest):
    error = 3 * 100 * math.sqrt(0.05 * 0.95 / replications)
    return lowest - error <= percent <= 7 + error


def level_table(program, rows, out):
    out.append("| | specimens | variables | missing | noise | replications | any specimen named, % | remark on normality, % | "
               "reached | seconds |\n|---|---|---|---|---|---|---|---|---|---|")
    good = True
    for kind, n, q, missing, noise, count in rows:
        r = call(program, kind, n, q, missing, noise, "normal", count)
        fine = is_level(r["named"], count, 3) and is_level(r["remark"], count, 3)
        good = good and fine
        out.append(f"| {kind} | {n} | {q} | {missing} | {noise} | {count} | {r['named']:.1f} | {r['remark']:.1f} | "
                   f"{'yes' if fine else 'no'} | {r['seconds']:.0f} |")
    return good


def outlier_table(program, out):
    out.append("| | specimens | variables | missing | outliers | replications | both named, % | any other named, % |\n"
               "|---|---|---|---|---|---|---|---|")
    good = True
    for kind, n, q, missing, noise, population, count in OUTLIERS:
        r = call(program, kind, n, q, missing, noise, population, count)
        out.append(f"| {kind} | {n} | {q} | {missing} | {population} | {count} | {r['both']:.1f} | {r['others']:.1f} |")
        if (kind, n, q, missing) == ("linear", 12, 3, 0) and population in ("same", "opposite"):
            good = good and r["both"] >= 90
    return good


def shape_table(program, out):
    out.append("| | specimens | noise | population | replications | remark, % | suggests log, % | names batches, % |\n"
               "|---|---|---|---|---|---|---|---|")
    good = True
    for kind, n, q, missing, noise, population, count in SHAPES:
        r = call(program, kind, n, q, missing, noise, population, count)
        said = (f"{r['log']:.1f} | {r['batches']:.1f}" if kind == "three-masses" else "| ")
        out.append(f"| {kind} | {n} | {noise} | {population} | {count} | {r['remark']:.1f} | {said} |")
        if noise == 0 and population == "batches:0.1" and n >= 20:
            good = good and r["remark"] >= 95
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=pathlib.Path, default=DEFAULT)
    program = parser.parse_args().program
    out = ["# Outliers and populations that are not normal, by replication", "",
           f"{datetime.date.today().isoformat()}, seed 20063, made by run.py; `linear` and the populations: replicate.cpp.", "",
           "## Clean samples, level 5 %", ""]
    good = [level_table(program, LEVELS, out)]
    out += ["", "## Clean samples with missing entries or noise", "",
            "Before: 27 to 42 % named with 40 % missing (all estimates in one covariance).", ""]
    good.append(level_table(program, GAPS, out))
    out += ["", "## Two outliers at 7.5 standard deviations", "",
            "Before: both of twelve named in 2 of 40 (the search ended at the first step that was not significant). Goal: 90 % for "
            "`same` and `opposite` along one of three variables. With missing entries sound specimens are named beside outliers "
            "more often than without: look at each.", ""]
    good.append(outlier_table(program, out))
    out += ["", "## Populations that are not normal", "", "Before: never remarked upon. Suggestions are those of the whole method.",
            ""]
    good.append(shape_table(program, out))
    (HERE / "RESULTS.md").write_text("\n".join(out) + "\n", encoding="utf-8")
    print("\n".join(out))
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main())
