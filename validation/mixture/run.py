#!/usr/bin/env python3
"""Mixtures of batches: against scikit-learn, by replication, and on a measured frame.

Needs the program built with -DMOTTLE_BUILD_VALIDATION=ON. Writes RESULTS.md beside this file and ends with exit code 1 if a
goal is missed.

    python3 validation/mixture/run.py [--replications 200] [--program ...] [--mottle build/release/mottle]
"""
import argparse
import datetime
import json
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.append(str(HERE.parent))
from replication import call  # noqa: E402

DATA = ROOT.parent / "shared/data/frame4dof/tests_br.csv"
LEVEL, POWER, COVERED, ROWS = 0.05, 0.8, 0.95, 0.97


def standard_error(share, count):
    return (share * (1 - share) / count) ** 0.5


def reference(program, out):
    try:
        import numpy as np
        from sklearn.mixture import GaussianMixture
    except ImportError:
        out.append("\n## scikit-learn\n\nNot installed.")
        return True
    likelihood = probability = mean = 0.0
    better = worse = 0
    for seed in range(1, 21):
        own = call(program, "reference", seed)
        data = np.array(own["data"])
        truth = [data[::3].mean(axis=0), np.delete(data, slice(None, None, 3), axis=0).mean(axis=0)]
        settings = {"tol": 1e-12, "max_iter": 20000, "reg_covar": 0, "covariance_type": "full"}
        # The local maximum that Mottle found, from its probabilities; and the one that the true batches lead to.
        shares = np.stack([own["probabilities"], 1 - np.array(own["probabilities"])])
        precisions = [np.linalg.inv(np.cov(data.T, aweights=share, ddof=0)) for share in shares]
        same = GaussianMixture(2, weights_init=shares.mean(axis=1), means_init=own["means"], precisions_init=precisions, **settings).fit(data)
        fits = [GaussianMixture(2, means_init=truth, **settings).fit(data)]
        first = 0 if np.linalg.norm(same.means_[0] - own["means"][0]) < np.linalg.norm(same.means_[1] - own["means"][0]) else 1
        likelihood = max(likelihood, abs(same.score(data) * len(data) - own["log_likelihood"]))
        probability = max(probability, np.abs(same.predict_proba(data)[:, first] - own["probabilities"]).max())
        mean = max(mean, np.abs(same.means_[first] - own["means"][0]).max())
        best = fits[0].score(data) * len(data)
        better += own["log_likelihood"] > best + 1e-6
        worse += own["log_likelihood"] < best - 1e-6
    good = likelihood < 1e-6 and probability < 1e-3
    out.append(f"\n## scikit-learn\n\nOf 20 data sets, at the maximum that Mottle found: largest difference of the log-likelihood {likelihood:.2g}, of a "
               f"probability {probability:.2g}, of a mean {mean:.2g}. Mottle's likelihood is the larger one in {better} of them and the smaller "
               f"one in {worse}, compared with the maximum that scikit-learn reaches from the true batches. Reached: {'yes' if good else 'no'}.")
    return good


def splits(program, replications, out):
    good = True
    stated = {}
    out += ["\n## One batch\n", f"Goal: split in no more than 5 % (standard error {100 * standard_error(LEVEL, replications):.1f} %).\n",
            "| specimens | noise | split, % | an outlier named, % | stated distance of two batches, mean | reached |", "|---|---|---|---|---|---|"]
    for n in (10, 30, 100):
        for noise in ("none", "known", "estimated"):
            r = call(program, "splits", n, replications, noise)
            share = r["several"] / r["replications"]
            reached = share <= LEVEL + 2 * standard_error(LEVEL, replications)
            good = good and reached
            stated[n, noise] = r["stated_distance"]
            out.append(f"| {n} | {noise} | {100 * share:.1f} | {100 * r['with_outlier'] / r['replications']:.1f} | "
                       f"{r['stated_distance']:.2f} | {'yes' if reached else 'no'} |")
    return good, stated


def power(program, replications, stated, out):
    good = True
    slack = 2 * standard_error(POWER, replications) + 0.05
    out += ["\n## Two batches at the stated distance\n", f"Goal: told in 80 % within {100 * slack:.0f} % (two standard errors, and those of the statement itself).\n",
            "| specimens | noise | distance | told, % | reached |", "|---|---|---|---|---|"]
    for n, noise in ((10, "none"), (30, "none"), (30, "known"), (30, "estimated")):
        r = call(program, "power", n, replications, noise, f"{stated[n, noise]:.3f}")
        share = r["several"] / r["replications"]
        reached = abs(share - POWER) <= slack
        good = good and reached
        out.append(f"| {n} | {noise} | {stated[n, noise]:.2f} | {100 * share:.1f} | {'yes' if reached else 'no'} |")
    return good


def scales(program, replications, out):
    good = True
    out += ["\n## One skewed population and two wide batches\n", "Goals: of the skewed ones at most 10 % split; of the wide ones all but 5 % of those that the tests refuse.\n",
            "| case | specimens | one batch refused, % | several reported, % | reached |", "|---|---|---|---|---|"]
    for case, number in (("skewed", 0.6), ("wide", 4)):
        r = call(program, case, 40, replications, "none", number)
        refused, several = r["one_refused"] / replications, r["several"] / replications
        reached = several <= 0.1 if case == "skewed" else several >= 0.95 * refused
        good = good and reached
        out.append(f"| {case} {number} | 40 | {100 * refused:.1f} | {100 * several:.1f} | {'yes' if reached else 'no'} |")
    return good


def intervals(program, replications, out):
    good = True
    slack = 2 * standard_error(COVERED, replications)
    out += ["\n## Intervals of two batches\n", "Two batches of equal size, 6 standard deviations apart, first parameter. Bias in standard deviations of a batch. Goal: the "
            f"intervals of a batch hold the truth in at least {100 * (COVERED - slack):.1f} %.\n",
            "| specimens | noise | bias of a batch's mean | mean ratio of its std | mean covered, % | std covered, % | whole: mean, % | whole: std, % | rightly assigned, % | reached |",
            "|---|---|---|---|---|---|---|---|---|---|"]
    for n in (20, 60):
        for noise in ("none", "known", "estimated"):
            r = call(program, "intervals", n, replications, noise, 6)
            count = r["replications"]
            reached = min(r["mean"], r["std"]) / count >= COVERED - slack
            good = good and reached
            shares = " | ".join(f"{100 * r[key] / count:.1f}" for key in ("mean", "std", "whole_mean", "whole_std"))
            out.append(f"| {n} | {noise} | {r['bias']:.3f} | {r['std_ratio']:.3f} | {shares} | {100 * r['right']:.1f} | {'yes' if reached else 'no'} |")
    return good


def frame(mottle, out):
    if not DATA.is_file():
        out.append("\n## frame4dof\n\nThe measured data are not there.")
        return True
    good = True
    out += ["\n## frame4dof\n", "Truth: rows 1-30, 31-70, 71-100. An outlier counts as wrong.\n",
            "| components | found | p-values of the tests | right, % | wrong rows | outliers | stated distance | reached |", "|---|---|---|---|---|---|---|---|"]
    for components in ('"automatic"', "3"):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([mottle, "update", HERE / "study.toml", "--out", f"{folder}/out", "--quiet", "--set",
                            f"update.mixture.components={components}"], check=True, stdout=subprocess.DEVNULL)
            result = json.loads(pathlib.Path(f"{folder}/out/result.json").read_text(encoding="utf-8"))
        rows = result["assignments"]
        regimes = [[row for row in rows if low < row["specimen"] <= high] for low, high in ((0, 30), (30, 70), (70, 100))]
        names = [max(range(1, len(result["components"]) + 1), key=lambda k, own=own: sum(row["component"] == k for row in own))
                 for own in regimes]
        wrong = [row["specimen"] for own, name in zip(regimes, names) for row in own if row["component"] != name]
        found = len(result["components"])
        reached = found == 3 and len(set(names)) == 3 and len(wrong) <= 100 * (1 - ROWS) + 1e-9
        good = good and reached
        tests = ", ".join(f"{test['p_value']:.3f}" for test in result["mixture"]["tests"]) or "-"
        distance = result["mixture"]["detectable_distance"]
        out.append(f"| {components.strip(chr(34))} | {found} | {tests} | {100 - len(wrong)} | {wrong} | "
                   f"{[row['specimen'] for row in rows if row['component'] is None]} | {f'{distance:.1f}' if distance else '-'} | {'yes' if reached else 'no'} |")
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=ROOT / "build/release/validation/mixture/mottle_mixture_replications")
    parser.add_argument("--mottle", default=ROOT / "build/release/mottle")
    parser.add_argument("--replications", type=int, default=200)
    options = parser.parse_args()
    out = [f"# Batches of specimens\n\n{options.replications} replications, seeds 1 on, {datetime.date.today()}; made by run.py."]
    good = [reference(options.program, out)]
    reached, stated = splits(options.program, options.replications, out)
    good += [reached, power(options.program, options.replications, stated, out), scales(options.program, options.replications, out), intervals(options.program, options.replications, out),
             frame(options.mottle, out)]
    (HERE / "RESULTS.md").write_text("\n".join(out) + "\n", encoding="utf-8")
    print("\n".join(out))
    sys.exit(0 if all(good) else 1)


if __name__ == "__main__":
    main()
