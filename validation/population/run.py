#!/usr/bin/env python3
"""Does the estimator of the population tell the truth? Replications of the three-mass cases, new specimens each time.

Needs the program built with -DMOTTLE_BUILD_VALIDATION=ON; every row is one call of it, shown above its table. Writes
RESULTS.md beside this file. 1000 replications and fixed seeds: the standard error of a coverage of 95 % is 0.7 %.

    python3 validation/population/run.py [--program build/release/validation/population/mottle_population_replication]
"""
import argparse
import datetime
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
from replication import call  # noqa: E402

ROOT = HERE.parent.parent
DEFAULT = ROOT / "build/release/validation/population/mottle_population_replication"


def numbers(values, digits, percent=False):
    if percent:
        return ", ".join(f"{100 * value:.{digits}f}" for value in values)
    return ", ".join(f"{value:.{digits}f}" for value in values)


def within(values, low, high):
    return all(low <= value <= high for value in values)


def bias_table(program, replications, out):
    out.append("\n## Case 1, 10 specimens, frequencies, no noise: bias and error\n")
    out.append("Truth: means 1, standard deviations 0.2. \"Own\": error of an estimate from the specimens' true parameters. Goals for "
               "`maximum-likelihood`: bias of a mean below 0.006, of a variance below 3 %, errors at most 1.05 of own.\n")
    out.append("| method | bias of means | bias of variances, % | rms error of means | of standard deviations | own, means | own, standard deviations |")
    out.append("|---|---|---|---|---|---|---|")
    good = True
    for method in ("maximum-likelihood", "mares", "inversion", "perturbation", "covariance-adjustment",
                   "moment-matching"):
        r = call(program, 1, 10, 0, 0, "frequencies", replications, method)
        out.append(f"| {method} | {numbers(r['mean_bias'], 4)} | {numbers(r['variance_bias'], 1, True)} | "
                   f"{numbers(r['mean_rmse'], 4)} | {numbers(r['deviation_rmse'], 4)} | "
                   f"{numbers(r['own_mean_rmse'], 4)} | {numbers(r['own_deviation_rmse'], 4)} |")
        if method == "maximum-likelihood":
            good = within(r["mean_bias"], -0.006, 0.006) and within(r["variance_bias"], -0.03, 0.03)
            good = good and all(a <= 1.05 * b for a, b in zip(r["mean_rmse"] + r["deviation_rmse"],
                                                             r["own_mean_rmse"] + r["own_deviation_rmse"]))
    return good


def coverage_table(program, replications, out):
    out.append("\n## Case 1, frequencies: coverage of the 95 % intervals, %\n")
    out.append("Noise as a fraction of the outputs' scatter, known; entries missing at random.\n")
    out.append("| specimens | noise | missing | means | standard deviations | correlations | goal | reached | bias of standard deviations, % |")
    out.append("|---|---|---|---|---|---|---|---|---|")
    good = True
    for specimens in (5, 10, 50):
        for noise, missing in ((0, 0), (0.01, 0), (0, 0.2), (1, 0)):
            r = call(program, 1, specimens, noise, missing, "frequencies", replications)
            low, high = (0.90, 0.98) if noise == 1 else ((0.92, 0.98) if specimens == 5 else (0.93, 0.97))
            fine = all(within(r[f"{kind}_coverage"], low, high) for kind in ("mean", "deviation", "correlation"))
            good = good and fine
            out.append(f"| {specimens} | {noise} | {missing:.0%} | {numbers(r['mean_coverage'], 1, True)} | "
                       f"{numbers(r['deviation_coverage'], 1, True)} | {numbers(r['correlation_coverage'], 1, True)} | "
                       f"{100 * low:.0f}-{100 * high:.0f} | {'yes' if fine else 'no'} | "
                       f"{numbers(r['deviation_bias'], 1, True)} |")
    return good


def noise_table(program, replications, out):
    out.append("\n## Case 1, 50 specimens, noise as large as the scatter\n")
    out.append("| method | bias of standard deviations, % |\n|---|---|")
    fine = False
    for method in ("maximum-likelihood", "inversion"):
        r = call(program, 1, 50, 1, 0, "frequencies", replications, method)
        out.append(f"| {method} | {numbers(r['deviation_bias'], 1, True)} |")
        if method == "maximum-likelihood":
            fine = within(r["deviation_bias"], -0.03, 0.03)
    return fine


def verdict_table(program, replications, out):
    out.append("\n## The verdict at 5 %: how often it says \"inadequate\"\n")
    out.append("\"Shapes\": the three mode shapes beside the frequencies, noise 1 % of each frequency and of the shapes' "
               "size, known. Frequencies alone: no noise. Case 3 with shapes: "
               "where the iteration wanders, since no parameters give the tests, the verdict is undecided.\n")
    out.append("| case | specimens | outputs | replications | inadequate, % | goal | reached | failed tests |\n|---|---|---|---|---|---|---|---|")
    rows = ((1, 10, "1%", "shapes", 0.03, 0.07), (1, 10, "0", "frequencies", 0.0, 0.07), (2, 10, "1%", "shapes", 0.99, 1),
            (2, 10, "0", "frequencies", 0.99, 1), (3, 10, "1%", "shapes", 0.75, 1), (3, 10, "0", "frequencies", 0.99, 1),
            (4, 50, "1%", "shapes", 0.80, 1))
    good = True
    for case, specimens, noise, outputs, low, high in rows:
        # Tests that no parameters give make many steps: the rejection of all of them is as clear from a tenth.
        count = max(replications // 10, 1) if (case, outputs) == (3, "shapes") else replications
        r = call(program, case, specimens, noise, 0, outputs, count)
        fine = low <= r["rejected"] <= high
        good = good and fine
        failed = ", ".join(f"{name} {count}" for name, count in r["failed_tests"].items())
        out.append(f"| {case} | {specimens} | {outputs} | {count} | {100 * r['rejected']:.1f} | {100 * low:.0f}-{100 * high:.0f} | "
                   f"{'yes' if fine else 'no'} | {failed} |")
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=pathlib.Path, default=DEFAULT)
    parser.add_argument("--replications", type=int, default=1000)
    arguments = parser.parse_args()
    out = ["# The population by replication", "",
           f"{arguments.replications} replications a row where no other number is given, {datetime.date.today().isoformat()}, seeds 20061 (structures) "
           "and 20062 (measurement), made by run.py.", ""]
    tables = (bias_table, coverage_table, noise_table, verdict_table)
    good = [table(arguments.program, arguments.replications, out) for table in tables]
    (HERE / "RESULTS.md").write_text("\n".join(out) + "\n", encoding="utf-8")
    print("\n".join(out))
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main())
