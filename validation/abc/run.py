#!/usr/bin/env python3
"""Coverage of the intervals of `abc` by replication, beside those of `maximum-likelihood` on the same tests.

Needs the program built with -DMOTTLE_BUILD_VALIDATION=ON. Writes RESULTS.md beside this file and ends with exit code 1 if a
goal is missed.

    /usr/bin/python3 validation/abc/run.py [--replications 200] [--lines FOLDER] [--only] [--program ...]
"""
import argparse
import datetime
import json
import pathlib
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
SPECIMENS, NOISE, COVERED, STANDARD_ERRORS = 10, 0.005, 0.95, 4.0
FEWEST = 20  # data sets of a case that is shown
CASES = [("two-peaked", "energy"), ("skewed", "energy"), ("normal", "energy"), ("normal", "sliced-wasserstein")]


def lines_of(options, population, distance):
    """One line of JSON a data set, in the order of their numbers; those that are missing are computed unless --only is given."""
    path = options.lines / f"{population}-{distance}.jsonl"
    kept = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    if len(kept) < options.replications and not options.only:
        with path.open("a", encoding="utf-8") as file:
            subprocess.run([options.program, str(SPECIMENS), str(len(kept) + 1), str(options.replications), population, distance, str(NOISE)],
                           stdout=file, check=True)
        kept = path.read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in kept[:options.replications]]


def share(rows, method, key):
    """Fraction of the intervals that held the truth, of all parameters."""
    return statistics.fmean(statistics.fmean(row[method][key]) for row in rows)


def case_row(rows, population, distance):
    tolerance = STANDARD_ERRORS * (COVERED * (1 - COVERED) / len(rows)) ** 0.5
    own = {key: share(rows, "abc", key) for key in ("mean_held", "std_held")}
    peer = {key: share(rows, "likelihood", key) for key in ("mean_held", "std_held")}
    reached = all(abs(value - COVERED) <= tolerance for value in own.values())
    width = [statistics.median(statistics.fmean(row["abc"][key]) / statistics.fmean(row["likelihood"][key]) for row in rows)
             for key in ("mean_width", "std_width")]
    estimate = statistics.fmean(statistics.fmean(row["abc"]["std"]) for row in rows)
    better = statistics.fmean(row["abc"]["better"] for row in rows)
    converged = sum(row["abc"]["status"] == "converged" for row in rows)
    return reached, (f"| {population} | {distance} | {len(rows)} | {100 * own['mean_held']:.1f} | {100 * own['std_held']:.1f} | "
                     f"{100 * tolerance:.1f} | {100 * peer['mean_held']:.1f} | {100 * peer['std_held']:.1f} | {width[0]:.2f} | {width[1]:.2f} | "
                     f"{estimate:.3f} | {100 * better:.0f} | {converged} | {'yes' if reached else 'no'} |")


def by_parameter(rows, population, distance):
    cells = []
    for method, key in (("abc", "mean_held"), ("abc", "std_held"), ("likelihood", "mean_held"), ("likelihood", "std_held")):
        cells.append(" ".join(f"{100 * statistics.fmean(row[method][key][i] for row in rows):.0f}" for i in range(3)))
    return f"| {population} | {distance} | " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=ROOT / "build/release/validation/abc/mottle_abc_replications")
    parser.add_argument("--replications", type=int, default=200)
    parser.add_argument("--lines", type=pathlib.Path, default=ROOT / "build/abc-lines")
    parser.add_argument("--only", action="store_true", help="what --lines holds, no more")
    options = parser.parse_args()
    options.lines.mkdir(parents=True, exist_ok=True)
    found = [(lines_of(options, *case), *case) for case in CASES]
    missing = [f"{population} by {distance}" for rows, population, distance in found if len(rows) < FEWEST]
    found = [entry for entry in found if len(entry[0]) >= FEWEST]
    out = ["# Populations by distances between samples\n", f"Made by run.py, {datetime.date.today()}. Shares in per cent; of `abc`, then of `maximum-likelihood` on the same tests.\n",
           "| population | distance | data sets | mean held | std held | goal 95 within | likelihood: mean | std | width to likelihood's: mean | std | mean of the estimated std (0.2) | "
           "says likelihood is better | converged | reached |", "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"]
    good = []
    for rows, population, distance in found:
        reached, row = case_row(rows, population, distance)
        good.append(reached)
        out.append(row)
    out += ["\nBy parameter (k1 k2 k5):\n", "| population | distance | abc: mean held | std held | likelihood: mean held | std held |", "|---|---|---|---|---|---|"]
    out += [by_parameter(*entry) for entry in found]
    rows = [row["abc"] for entry in found for row in entry[0]]
    out.append(f"\nIn its own simulated studies `abc` found its intervals to hold the truth in {100 * statistics.fmean(statistics.fmean(row['coverage']) for row in rows):.1f} % before "
               f"stretching and in {100 * statistics.fmean(row['checked'] for row in rows):.1f} % after.")
    if missing:
        out.append(f"\nNot run: {', '.join(missing)}.")
    (HERE / "RESULTS.md").write_text("\n".join(out) + "\n", encoding="utf-8")
    print("\n".join(out))
    sys.exit(0 if all(good) and len(found) == len(CASES) else 1)


if __name__ == "__main__":
    main()
