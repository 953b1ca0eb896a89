#!/usr/bin/env python3
"""Boxes of parameters against what they must hold; writes RESULTS.md beside this file, exit code 1 if a goal is missed.

    python3 validation/interval/run.py [--cases 10000] [--replications 4000]
        [--program build/release/validation/interval/mottle_interval_cases] [--mottle build/release/mottle]
"""
import argparse
import datetime
import json
import math
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
from replication import call  # noqa: E402

BUILD = HERE.parent.parent / "build/release"
STUDY = HERE.parent / "frame4dof/study.toml"
DATA = HERE.parent.parent.parent / "shared/data/frame4dof/tests_br.csv"


def numbers(values, digits=4):
    return ", ".join(f"{value:.{digits}f}" for value in values)


def enclosures(options):
    r = call(options.program, "enclosures", options.cases)
    good = r["violations"] == 0 and r["worst_gap"] <= 1.01 * r["tolerance"]
    return good, [
        "## Enclosures\n",
        "| boxes | eigenvalues compared | parameters that are not monotone | beyond the proven range | widest gap of proven and attained ends | "
        "tolerance | boxes where solutions ran out | solutions | reached |", "|---|---|---|---|---|---|---|---|---|",
        f"| {r['cases']} | {r['values']} | {r['mixed_parameters']} | {r['violations']} | {r['worst_gap']:.3g} | {r['tolerance']:g} | "
        f"{r['unfinished']} | {r['solutions']} | {'yes' if good else 'no'} |"]


def coverage(options):
    error = math.sqrt(0.95 * 0.05 / options.replications)
    out = [f"\n## Tolerance limits: content 95 %, confidence 95 %\n\nFraction of {options.replications} samples in which limits contain 95 % of the "
           f"population (binomial standard error {100 * error:.2f} %). Goal: of the normal output within three standard errors of 95 %, but above where the "
           "observed bounds are wider than the limits; of the frequencies no less than 95 % less three.\n",
           "| n | outputs | limits, % | observed bounds, % | mean fraction between observed bounds, % | (n - 1) / (n + 1), % | reached |",
           "|---|---|---|---|---|---|---|"]
    good = True
    for kind in ("normal", "box"):
        for n in (5, 10, 30):
            r = call(options.program, "coverage", n, kind, options.replications)
            reached = min(r["limits_cover"]) >= 0.95 - 3 * error
            if kind == "normal" and n <= 10:
                reached = reached and max(r["limits_cover"]) <= 0.95 + 3 * error
            good = good and reached
            out.append(f"| {n} | {'normal' if kind == 'normal' else 'f1, f2, f3'} | {numbers([100 * c for c in r['limits_cover']], 2)} | "
                       f"{numbers([100 * c for c in r['observed_cover']], 2)} | {100 * r['between_observed']:.2f} | "
                       f"{100 * r['expected_between_observed']:.2f} | {'yes' if reached else 'no'} |")
    return good, out


def boxes(options):
    out = ["\n## Boxes\n\nError: the largest distance of an end from the true one, in widths of the true box. Goal: below 1e-4 where the bounds are exact; "
           "covered in floating point everywhere.\n",
           "| case | bounds | status | lower ends | upper ends | error | width / true width | width of the specimens' hull / true width | specimens outside | "
           "least excess | proven | reached |", "|---|---|---|---|---|---|---|---|---|---|---|---|"]
    good = True
    runs = [("three masses, exact bounds", "observed", ("recovery", "exact", "observed"), True),
            ("three masses, 1,000 by chance", "observed", ("recovery", "random", "observed"), False),
            ("three masses, 1,000 by chance", "distribution-free", ("recovery", "random", "distribution-free"), False),
            ("three masses, 1,000 by chance", "normal-tolerance", ("recovery", "random", "normal-tolerance"), False),
            ("[Khodaparast2011], separated", "observed (exact)", ("literature", "separated"), True),
            ("[Khodaparast2011], close", "observed (exact)", ("literature", "close"), True)]
    for title, bounds, words, is_exact in runs:
        r = call(options.program, *words)
        reached = r["status"] == "converged" and r["least_excess"] >= 0 and r["certified"]
        reached = reached and (not is_exact or r["largest_error_of_width"] < 1e-4)
        good = good and reached
        out.append(f"| {title} | {bounds} | {r['status']} | {numbers(r['box']['lower'])} | {numbers(r['box']['upper'])} | "
                   f"{r['largest_error_of_width']:.2g} | {numbers(r['width_ratio'], 3)} | {numbers(r['hull_ratio'], 3)} | {r['outside']} | "
                   f"{r['least_excess']:.2g} | {'yes' if r['certified'] else 'no'} | {'yes' if reached else 'no'} |")
    return good, out


def frame(options):
    if not DATA.is_file() or not pathlib.Path(options.mottle).is_file():
        return True, ["\n## The measured frame\n\nNot run: its data or the command is not there."]
    out = ["\n## The measured frame, 100 tests\n",
           "| bounds | verdict | theta1 to theta4 | hull of the specimens' own | specimens outside | widest image / bounds | proven |",
           "|---|---|---|---|---|---|---|"]
    for bounds in ("observed", "normal-tolerance", "distribution-free"):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([options.mottle, "update", STUDY, "--out", folder, "--quiet", "--set", 'update.method="interval"', "--set",
                            f'update.interval.bounds="{bounds}"'], check=True, stdout=subprocess.DEVNULL)
            result = json.loads((pathlib.Path(folder) / "result.json").read_text(encoding="utf-8"))
        block = result["interval"]
        ratio = max((o["image"][1] - o["image"][0]) / (o["bounds"][1] - o["bounds"][0]) for o in block["image"])

        def text(box):
            return ", ".join(f"[{low:.4f}, {high:.4f}]" for low, high in box)
        out.append(f"| {bounds} | {result['verdict']['conclusion']} | {text(result['parameters']['box'])} | {text(block['hull'])} | "
                   f"{len(block['outside'])} | {ratio:.3f} | {'yes' if block['certified'] else 'no'} |")
    return True, out


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=BUILD / "validation/interval/mottle_interval_cases")
    parser.add_argument("--mottle", default=BUILD / "mottle")
    parser.add_argument("--cases", type=int, default=10000)
    parser.add_argument("--replications", type=int, default=4000)
    options = parser.parse_args()
    parts = [part(options) for part in (enclosures, coverage, boxes, frame)]
    head = f"# Boxes of parameters\n\nMade by run.py, {datetime.date.today()}.\n"
    (HERE / "RESULTS.md").write_text("\n".join([head] + [line for _, out in parts for line in out]) + "\n", encoding="utf-8")
    sys.exit(0 if all(good for good, _ in parts) else 1)


if __name__ == "__main__":
    main()
