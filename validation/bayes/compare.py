#!/usr/bin/env python3
"""Three models of one test of the three masses, compared by `mottle compare`, against quadrature.

Each seed updates the right model (k6 = 3) and two wrong ones (k6 = 3.5, no k6) by the method `bayes` and compares them, as a user
does. Writes COMPARISON.md beside this file and ends with exit code 1 if a goal is missed.

    python3 validation/bayes/compare.py [--seeds 20] [--mottle build/release/mottle]
"""
import argparse
import datetime
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
DEFAULT = HERE.parent.parent / "build/release/mottle"
LN_EVIDENCE = {"k6-3": 8.6435911, "k6-3.5": -5.3808755, "no-k6": -4.6166521}  # adaptive quadrature over (k1, k2, k5)
BEST = "k6-3"
K6 = {"k6-3": 3.0, "k6-3.5": 3.5, "no-k6": None}

STUDY = """\
title = "One test of the three masses, {name}"
units = "SI"
seed = {seed}
[model]
kind = "mass-spring"
masses = {{ m1 = 1.0, m2 = 1.0, m3 = 1.0 }}
springs = [
  {{ name = "k1", between = ["ground", "m1"], stiffness = 1.5 }},
  {{ name = "k2", between = ["ground", "m2"], stiffness = 1.5 }},
  {{ name = "k3", between = ["ground", "m3"], stiffness = 1.0 }},
  {{ name = "k4", between = ["m1", "m2"], stiffness = 1.0 }},
  {{ name = "k5", between = ["m2", "m3"], stiffness = 1.5 }},
{k6}]
{parameters}
[outputs]
frequencies = [1, 2, 3]
[test]
file = "tests.csv"
repeatability = {{ f1 = 0.0016, f2 = 0.00315, f3 = 0.00448 }}
[update]
method = "bayes"
samples = 200
"""
PARAMETER = """
[[parameter]]
name = "{name}"
target = "spring:{name}"
distribution = {{ kind = "lognormal", mean = 1.5, std = 0.5 }}
"""


def study(name, seed):
    k6 = f'  {{ name = "k6", between = ["m1", "m3"], stiffness = {K6[name]} }},\n' if K6[name] else ""
    return STUDY.format(name=name, seed=seed, k6=k6, parameters="".join(PARAMETER.format(name=k) for k in ("k1", "k2", "k5")))


def compare(mottle, seed):
    """{label: its entry in `evidence.models`} of one seed, and the statuses of the updates."""
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        (work / "tests.csv").write_text("f1,f2,f3\n0.1600,0.3150,0.4480\n", encoding="utf-8")
        for name in LN_EVIDENCE:
            (work / f"{name}.toml").write_text(study(name, seed), encoding="utf-8")
            subprocess.run([mottle, "update", f"{name}.toml", "--out", name, "--quiet"], cwd=work, check=True)
        ended = subprocess.run([mottle, "compare", *LN_EVIDENCE, "--json"], cwd=work, check=True, capture_output=True, text=True)
        comparison = json.loads(ended.stdout)
        stalled = [run["label"] for run in comparison["runs"] if run["status"] != "converged"]
        return {model["label"]: model for model in comparison["evidence"]["models"]}, stalled


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mottle", default=DEFAULT)
    parser.add_argument("--seeds", type=int, default=20)
    options = parser.parse_args()
    found = [compare(pathlib.Path(options.mottle).resolve(), seed + 1) for seed in range(options.seeds)]
    good = all(len(models) == len(LN_EVIDENCE) for models, _ in found)
    out = [f"# Models compared by evidence\n\n`mottle compare` of three models of one test of the three masses, seeds 1 to {options.seeds}, default "
           f"options, {datetime.date.today()}; made by compare.py. Goal: the mean of ln Bayes factors within three of its own standard errors of the "
           "quadrature, each within five of the standard errors that it states.\n",
           "| model | ln Bayes factor of k6 = 3 over it, quadrature | mean over the seeds | its standard error | of one seed: rms error | stated standard "
           "error | largest error, in stated standard errors | reached |", "|---|---|---|---|---|---|---|---|"]
    for name in LN_EVIDENCE:
        if name == BEST:
            continue
        exact = LN_EVIDENCE[BEST] - LN_EVIDENCE[name]
        factors = [models[name]["ln_bayes_factor"] for models, _ in found]
        stated = [models[name]["ln_bayes_factor_standard_error"] for models, _ in found]
        mean, error = statistics.fmean(factors), statistics.stdev(factors) / math.sqrt(len(factors))
        largest = max(abs(factor - exact) / own for factor, own in zip(factors, stated))
        reached = abs(mean - exact) < 3 * error and largest < 5
        good = good and reached
        rms = math.sqrt(statistics.fmean((factor - exact) ** 2 for factor in factors))
        out.append(f"| {name} | {exact:.7f} | {mean:.4f} | {error:.4f} | {rms:.4f} | {statistics.fmean(stated):.4f} | {largest:.1f} | "
                   f"{'yes' if reached else 'no'} |")
    log_sum = math.log(sum(math.exp(value) for value in LN_EVIDENCE.values()))
    out += ["\n| model | probability, quadrature | mean over the seeds | seeds whose 95 % interval holds it |", "|---|---|---|---|"]
    for name, value in LN_EVIDENCE.items():
        exact = math.exp(value - log_sum)
        models = [entry[name] for entry, _ in found]
        held = sum(model["probability_ci95"][0] <= exact <= model["probability_ci95"][1] for model in models)
        mean = statistics.fmean(model["probability"] for model in models)
        out.append(f"| {name} | {exact:.9g} | {mean:.9g} | {held} of {len(models)} |")
    stalled = [label for _, labels in found for label in labels]
    out += ["\n" + ("Every update converged." if not stalled else
                    "Updates that did not converge (`compare` warns of each): " +
                    ", ".join(f"{stalled.count(name)} of {name}" for name in sorted(set(stalled))) + ".")]
    (HERE / "COMPARISON.md").write_text("\n".join(out) + "\n", encoding="utf-8")
    print("\n".join(out))
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
