#!/usr/bin/env python3
"""Replicates predictions of specimens that were not used: do 95 % intervals hold 95 % of new specimens?

Each time ten specimens are drawn and updated to (three frequencies), and the frequencies and a shape component of the same
structure with mass m1 doubled are predicted and held against fifty new specimens of that structure. Without noise, and with
a known noise of 1 % of each frequency. Writes the table to RESULTS.md beside this file.

    python3 validation/prediction/replicate.py [--mottle build/release/mottle] [--replications 200] [--jobs 2]
"""
import argparse
import concurrent.futures
import datetime
import json
import math
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
FIRST_SEED = 7000
SHAPES = 'shapes = { modes = [1], dofs = ["m2"] }'
NOISE = "{ f1 = 0.0016, f2 = 0.0032, f3 = 0.0045 }"


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def edited(text, old, new):
    if text.count(old) != 1:
        sys.exit(f"study.toml: '{old}' stands {text.count(old)} times")
    return text.replace(old, new)


def replicate(mottle, has_noise, seed):
    text = (HERE / "study.toml").read_text()
    if has_noise:
        text = edited(text, "specimens = 10", f"specimens = 10\nnoise = {NOISE}")
        text = edited(text, 'file = "truth/specimens.csv"', f'file = "truth/specimens.csv"\nrepeatability = {NOISE}')
    held_out = edited(edited(edited(text, "m1 = 1.0", "m1 = 2.0"), "frequencies = [1, 2, 3]",
                             f"frequencies = [1, 2, 3]\n{SHAPES}"), "specimens = 10", "specimens = 50")
    predict = (f'\n[predict]\nfrequencies = [1, 2, 3]\n{SHAPES}\nmodel = {{ "mass:m1" = 2.0 }}\n'
               'held_out = "held-out/specimens.csv"\n')
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "study.toml").write_text(text + predict)
        (folder / "held-out.toml").write_text(held_out)
        run(mottle, "simulate", folder / "study.toml", "--seed", seed, "--out", folder / "truth", "--quiet")
        run(mottle, "simulate", folder / "held-out.toml", "--seed", seed + 1000000, "--out", folder / "held-out", "--quiet")
        run(mottle, "update", folder / "study.toml", "--quiet", "--threads", 1, "--out", folder / "out")
        return json.loads((folder / "out" / "result.json").read_text())["prediction"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--mottle", type=pathlib.Path, default=ROOT / "build" / "release" / "mottle")
    parser.add_argument("--replications", type=int, default=200)
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    lines = ["| noise | f1 | f2 | f3 | phi1:m2 | joint region | uniformity rejected at 5 % |", "|---|---|---|---|---|---|---|"]
    checks = {}
    for has_noise in (False, True):
        seeds = range(FIRST_SEED, FIRST_SEED + arguments.replications)
        with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
            found = list(pool.map(lambda seed: replicate(arguments.mottle, has_noise, seed), seeds))
        checked = [prediction["held_out"] for prediction in found]
        count = len(checked)
        columns = [[check["coverage"][k] for check in checked] for k in range(4)]
        columns.append([check["joint_coverage"] for check in checked])
        means = [sum(column) / count for column in columns]
        errors = [math.sqrt(sum((value - mean) ** 2 for value in column) / (count - 1) / count)
                  for column, mean in zip(columns, means)]
        rejected = sum(check["adjusted_p_value"] < 0.05 for check in checked) / count
        label = "1 %" if has_noise else "none"
        lines.append(f"| {label} | " + " | ".join(f"{100 * mean:.1f} % ± {100 * error:.1f}"
                                                  for mean, error in zip(means, errors)) + f" | {100 * rejected:.1f} % |")
        print(lines[-1], flush=True)
        # Where noise hides an output's scatter, the scatter cannot be negative: intervals are then too wide, never too narrow.
        most = 1.0 if has_noise else 0.97
        claim = "at least 93 %" if has_noise else "93 to 97 %"
        checks[f"noise {label}: coverage of every output and of the joint region {claim}"] = all(
            0.93 <= mean <= most for mean in means)
        checks[f"noise {label}: uniformity rejected in at most 7 %"] = rejected <= 0.07
    verdicts = [f"- {'passed' if passed else 'FAILED'}: {claim}" for claim, passed in checks.items()]
    version = run(arguments.mottle, "--version").strip()
    text = "\n".join([
        "# Specimens that were not used", "",
        f"{arguments.replications} replications, ten specimens to update to and fifty held out, seeds from {FIRST_SEED} on, "
        f"{version}, {datetime.date.today().isoformat()}; made by replicate.py.", "",
        "Part of the held-out specimens inside the predicted 95 % intervals of each output and inside the joint region, with "
        "the standard error of the mean over the replications.", "", *lines, "", *verdicts, ""])
    (HERE / "RESULTS.md").write_text(text)
    print(text)
    return 0 if all(checks.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
