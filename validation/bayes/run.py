#!/usr/bin/env python3
"""Evidences, moments and modes of posteriors that are known by quadrature, sampled under many seeds.

Needs the program built with -DMOTTLE_BUILD_VALIDATION=ON; every row is one call of it. Writes RESULTS.md beside this file and
ends with exit code 1 if a goal is missed.

    python3 validation/bayes/run.py [--seeds 200] [--first-seed 10001] [--program build/release/validation/bayes/mottle_bayes_references]
"""
import argparse
import datetime
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
from replication import call  # noqa: E402

DEFAULT = HERE.parent.parent / "build/release/validation/bayes/mottle_bayes_references"
BIAS, COVERED, MODE = 0.02, (0.93, 0.97), 0.03
CASES = {  # means, standard deviations, correlation of the first two, by quadrature
    "k6-3": ((1.0120188, 1.0400786, 0.9316923), (0.1566877, 0.1618705, 0.0714800), -0.919503),
    "k6-3.5": ((0.5911040, 1.6228500, 0.6753985), (0.0939480, 0.1866338, 0.0926951), None),
    "no-k6": ((2.8409248, 0.4252349, 3.2710055), (0.0861511, 0.0410631, 0.0825094), None),
    "beck-au": ((1.11699503, 0.59343654), (0.66237308, 0.32994652), -0.97991033),
    "eigenvalues": ((1.75110774, 0.87555529), None, None),
}


def numbers(values):
    return ", ".join(f"{value:.4f}" for value in values)


def errors(found, exact, error):
    return ", ".join(f"{(f - e) / s:+.1f}" for f, e, s in zip(found, exact, error))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=DEFAULT)
    parser.add_argument("--seeds", type=int, default=200)
    parser.add_argument("--first-seed", type=int, default=10001)
    parser.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES))
    options = parser.parse_args()
    found = {case: call(options.program, case, options.seeds, options.first_seed) for case in options.cases}
    # The interval's coverage over `seeds` has a standard error of its own: a goal is missed beyond twice that.
    slack = 2 * (0.95 * 0.05 / options.seeds) ** 0.5
    good = True
    out = [f"# Posteriors against quadrature\n\nSeeds {options.first_seed} to {options.first_seed + options.seeds - 1}, default options, {datetime.date.today()}; made by run.py. "
           f"Goals: |bias| of ln evidence below {BIAS}; its 95 % interval holds the reference in {100 * COVERED[0]:.0f} to "
           f"{100 * COVERED[1]:.0f} % (with {options.seeds} seeds the standard error of this is {50 * slack:.1f} %); the first of twin modes within {MODE} of its "
           "probability in every seed.\n",
           "## ln evidence\n",
           "| case | reference | bias | rms error | stated standard error | interval covers, % | evaluations | most moves of a stage | "
           "converged, % | largest R-hat | s of one core | reached |",
           "|---|---|---|---|---|---|---|---|---|---|---|---|"]
    for case, r in found.items():
        reached = abs(r["bias"]) < BIAS and COVERED[0] - slack <= r["covered"] <= COVERED[1] + slack
        good = good and reached
        out.append(f"| {case} | {r['reference']:.7f} | {r['bias']:.5f} | {r['rms']:.4f} | {r['stated']:.4f} | {100 * r['covered']:.1f} | "
                   f"{r['evaluations']} | {r['most_moves']} | {100 * r['converged']:.1f} | {r['largest_r_hat']:.4f} | {r['seconds']:.2f} | {'yes' if reached else 'no'} |")
    out += ["\n## Moments, mean over the seeds and its standard errors from the reference\n",
            "| case | means | by quadrature | errors | standard deviations | by quadrature | errors | correlation of the first two | by quadrature |",
            "|---|---|---|---|---|---|---|---|---|"]
    for case in found:
        mean, std, correlation = CASES[case]
        r = found[case]
        out.append(f"| {case} | {numbers(r['mean'])} | {numbers(mean)} | {errors(r['mean'], mean, r['mean_error'])} | {numbers(r['std'])} | "
                   f"{numbers(std) if std else '-'} | {errors(r['std'], std, r['std_error']) if std else '-'} | "
                   f"{r['correlation']:.4f} | {f'{correlation:.4f}' if correlation else '-'} |")
    if "eigenvalues" in found:
        twin = found["eigenvalues"]
        reached = twin["worst_mode"] < MODE
        good = good and reached
        out += ["\n## Twin modes\n",
                f"First mode of `eigenvalues`: probability {twin['first_mode']:.4f} on average (by quadrature 0.5000), at most "
                f"{twin['worst_mode']:.4f} away in any seed: {'reached' if reached else 'not reached'}."]
    (HERE / "RESULTS.md").write_text("\n".join(out) + "\n", encoding="utf-8")
    print("\n".join(out))
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
