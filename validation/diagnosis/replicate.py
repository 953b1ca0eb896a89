#!/usr/bin/env python3
"""Replicates the diagnosis of the three masses: does `mottle diagnose` name the spring that is missing?

For each case `mottle simulate` draws ten specimens (a new seed each time) with 1 % noise, and `mottle diagnose` is asked
which of k3, k4, k6 is missing beside k1, k2, k5. Case 1: none. Case 2: the tests have k6 = 3.5, the model 3.0. Case 3: the
model has a k6 of zero stiffness. With the three mode shapes measured beside the frequencies, and with frequencies alone.
Writes the table to RESULTS.md beside this file.

    python3 validation/diagnosis/replicate.py [--mottle build/release/mottle] [--replications 200] [--alone 40] [--jobs 2]
"""
import argparse
import collections
import concurrent.futures
import datetime
import json
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
FIRST_SEED = 5000
K6 = '{ name = "k6", between = ["m1", "m3"], stiffness = 3.0 }'
IN_MODEL = {1: 3.0, 2: 3.0, 3: 0.0}
IN_TESTS = {1: 3.0, 2: 3.5, 3: 3.0}


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def study_text(k6, has_shapes):
    text = (HERE / "study.toml").read_text()
    if text.count(K6) != 1:
        sys.exit(f"study.toml: the line of k6 is not {K6}")
    text = text.replace(K6, K6.replace("3.0", str(k6)))
    if has_shapes:
        return text
    return "\n".join(line for line in text.splitlines() if "phi" not in line and not line.startswith("shapes"))


def replicate(mottle, case, has_shapes, seed):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "truth.toml").write_text(study_text(IN_TESTS[case], has_shapes))
        (folder / "study.toml").write_text(study_text(IN_MODEL[case], has_shapes))
        run(mottle, "simulate", folder / "truth.toml", "--seed", seed, "--out", folder / "truth", "--quiet")
        run(mottle, "diagnose", folder / "study.toml", "--quiet", "--threads", 1, "--out", folder / "out", "--set",
            f'test.file="{folder / "truth" / "specimens.csv"}"')
        return json.loads((folder / "out" / "diagnosis.json").read_text())


def summarise(results):
    count = len(results)
    named = collections.Counter(result["best"] for result in results
                                if result["explained"] and len(result["alike"]) == 1)
    alike = collections.Counter(" = ".join(sorted(result["alike"])) for result in results
                                if result["explained"] and len(result["alike"]) > 1)
    proposed = collections.Counter(", ".join(entry["name"] for entry in result["proposed"] if not entry["given"]) or "none"
                                   for result in results)
    silent = sum(not result["explained"] for result in results)
    k6 = [entry for result in results for entry in result["candidates"] if entry["name"] == "k6"]
    means = sorted(entry["shifted"]["mean"] for entry in k6 if "mean" in entry["shifted"])
    return {
        "count": count,
        "named": named,
        "alike": alike,
        "silent": silent,
        "proposed": proposed,
        "k6": means[len(means) // 2] if means else None,
    }


def share(counter, count):
    return ", ".join(f"{name} {100 * number / count:.1f} %" for name, number in counter.most_common()) or "-"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--mottle", type=pathlib.Path, default=ROOT / "build" / "release" / "mottle")
    parser.add_argument("--replications", type=int, default=200)
    parser.add_argument("--alone", type=int, default=40, help="replications with frequencies alone")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--dry", action="store_true", help="print the table, write nothing")
    arguments = parser.parse_args()
    lines = ["| case | measured | named alone | named as equally good | no candidate explains the tests | k6 as a fixed effect (median) | "
             "added by forward selection |", "|---|---|---|---|---|---|---|"]
    checks = {}
    for has_shapes in (True, False):
        for case in (1, 2, 3):
            seeds = range(FIRST_SEED, FIRST_SEED + (arguments.replications if has_shapes else arguments.alone))
            with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
                results = list(pool.map(lambda seed: replicate(arguments.mottle, case, has_shapes, seed), seeds))
            found = summarise(results)
            count = found["count"]
            measured = "frequencies and shapes" if has_shapes else "frequencies"
            lines.append(f"| {case} | {measured} | {share(found['named'], count)} | {share(found['alike'], count)} | "
                         f"{100 * found['silent'] / count:.1f} % | {found['k6']:.3f} | "
                         f"{share(found['proposed'], count)} |")
            print(lines[-1], flush=True)
            if has_shapes and case > 1:
                checks[f"case {case}, shapes: k6 named alone in at least 95 %"] = found["named"]["k6"] >= 0.95 * count
            if has_shapes and case == 1:
                checks["case 1, shapes: a candidate named in at most 7 %"] = found["silent"] >= 0.93 * count
            if not has_shapes:
                alone = sum(found["named"].values())
                wrong = alone - found["named"]["k6"]
                checks[f"case {case}, frequencies: a wrong candidate named alone in at most 7 %"] = wrong <= 0.07 * count
    verdicts = [f"- {'passed' if passed else 'FAILED'}: {claim}" for claim, passed in checks.items()]
    version = run(arguments.mottle, "--version").strip()
    text = "\n".join([
        "# Which spring is missing?", "",
        f"{arguments.replications} replications of ten specimens each ({arguments.alone} with frequencies alone), seeds "
        f"from {FIRST_SEED} on, {version}, {datetime.date.today().isoformat()}; made by replicate.py.",
        "", "Candidates k3, k4, k6 beside k1, k2, k5. \"Equally good\": BIC within 6 of the best. Level 5 % for all "
        "candidates together.", "", *lines, "", *verdicts, ""])
    if not arguments.dry:
        (HERE / "RESULTS.md").write_text(text)
    print(text)
    return 0 if all(checks.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
