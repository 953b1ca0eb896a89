#!/usr/bin/env python3
"""Which scale goes with a bounded prior: means, scatter and verdicts of a right model on "identity" and "logit".

Four masses in a chain, two of their springs unknown, four frequencies of ten specimens with noise of 0.1 %. The mean of each
parameter is drawn from its prior between 0.5 and 1.5. Specimens are normal about it (0.08), so that some lie beyond the ends, or
logit-normal between the ends. Prints a table.

    /usr/bin/python3 validation/population/scales.py [--mottle build/release/mottle] [--sets 40]
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
LOW, HIGH, SCATTER = 0.5, 1.5, 0.08
PRIORS = {
    "uniform": '{ kind = "uniform", lower = 0.5, upper = 1.5 }',
    "truncated-normal": '{ kind = "truncated-normal", mean = 1.0, std = 0.3, lower = 0.5, upper = 1.5 }',
    "beta": '{ kind = "beta", mean = 1.0, std = 0.25, lower = 0.5, upper = 1.5 }',
}
STUDY = """\
[model]
kind = "mass-spring"
masses = { m1 = 1.0, m2 = 1.0, m3 = 1.0, m4 = 1.0 }
springs = [ { name = "k1", between = ["ground", "m1"], stiffness = 1000.0 }, { name = "k2", between = ["m1", "m2"], stiffness = 1500.0 },
            { name = "k3", between = ["m2", "m3"], stiffness = 2000.0 }, { name = "k4", between = ["m3", "m4"], stiffness = 3000.0 } ]
[outputs]
frequencies = [1, 2, 3, 4]
[test]
file = "tests.csv"
repeatability = { "f*" = "0.1 %" }
[update]
method = "maximum-likelihood"
"""


def draw_mean(rng, prior):
    while True:
        mean = {"uniform": lambda: rng.uniform(LOW, HIGH), "beta": lambda: LOW + rng.beta(1.5, 1.5),
                "truncated-normal": lambda: 1.0 + 0.3 * rng.standard_normal()}[prior]()
        if LOW < mean < HIGH:
            return mean


def between_ends(mean, normals):
    slope = (mean - LOW) * (HIGH - mean) / (HIGH - LOW)
    return LOW + (HIGH - LOW) / (1.0 + np.exp(-(np.log((mean - LOW) / (HIGH - mean)) + SCATTER / slope * normals)))


def frequencies(a, b):
    k = [1000 * a, 1500, 2000 * b, 3000]
    matrix = np.diag([k[0] + k[1], k[1] + k[2], k[2] + k[3], k[3]]) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
    return np.sqrt(np.linalg.eigvalsh(matrix)) / (2 * np.pi)


def row(mottle, prior, population, sets, folder):
    counts = {scale: {"mean": 0, "std": 0, "adequate": 0, "inadequate": 0, "undecided": 0, "open": 0, "outliers": 0} for scale in ("identity", "logit")}
    for number in range(sets):
        rng = np.random.default_rng(1000 + number)
        drawn = [draw_mean(rng, prior) for _ in range(2)]
        normals = rng.standard_normal((10, 2))
        of = (lambda m, z: m + SCATTER * z) if population == "normal" else between_ends
        many = [of(m, np.random.default_rng(5).standard_normal(200000)) for m in drawn]
        tests = [frequencies(*(of(m, z) for m, z in zip(drawn, row))) * (1 + 0.001 * rng.standard_normal(4)) for row in normals]
        (folder / "tests.csv").write_text("f1,f2,f3,f4\n" + "\n".join(",".join(f"{x:.7g}" for x in t) for t in tests) + "\n")
        for scale, count in counts.items():
            text = "".join(f'[[parameter]]\nname = "{name}"\ntarget = "spring:{name}"\nrelative = true\ndistribution = {PRIORS[prior]}\n'
                           f'bounds = [0.5, 1.5]\nscale = "{scale}"\n' for name in ("k1", "k3"))
            (folder / "study.toml").write_text(STUDY.replace("[outputs]", text + "[outputs]"))
            subprocess.run([mottle, "update", "study.toml", "--threads", "1", "--quiet", "--out", "out"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
            result = json.loads((folder / "out/result.json").read_text())
            count[result["verdict"]["conclusion"]] += 1
            count["open"] += result["status"] != "converged"
            count["outliers"] += len(result["outliers"])
            for i, x in enumerate(many):
                for key, truth in (("mean", x.mean()), ("std", x.std())):
                    low, high = result["parameters"][f"{key}_ci95"][i]
                    count[key] += low <= truth <= high
    for scale, c in counts.items():
        print(f"| {prior} | {population} | {scale} | {50 * c['mean'] / sets:.0f} | {50 * c['std'] / sets:.0f} | {c['adequate']} | {c['inadequate']} | {c['undecided']} | "
              f"{c['open']} | {c['outliers']} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mottle", default=ROOT / "build/release/mottle", type=pathlib.Path)
    parser.add_argument("--sets", default=40, type=int)
    options = parser.parse_args()
    print("| prior | specimens | scale | mean covered, % | std covered, % | adequate | inadequate | undecided | not converged | outliers named |\n" + "|---" * 10 + "|")
    with tempfile.TemporaryDirectory() as folder:
        for prior, population in (("uniform", "normal"), ("truncated-normal", "normal"), ("beta", "normal"), ("beta", "between the ends")):
            row(options.mottle.resolve(), prior, population, options.sets, pathlib.Path(folder))


if __name__ == "__main__":
    main()
