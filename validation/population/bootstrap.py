#!/usr/bin/env python3
"""Do 95 % intervals by bootstrap hold the truth, also where the parameters do not scatter at all?

Three masses linear around the truth, k1, k2, k5 ~ N(1, deviation); two rows with the masses' own model. Needs the programs
built with -DMOTTLE_BUILD_VALIDATION=ON; every row is one call of mottle_bootstrap_coverage. Writes BOOTSTRAP.md beside this
file and ends with 1 where a row misses its goal.

    python3 validation/population/bootstrap.py [--program build/release/validation/population/mottle_bootstrap_coverage]
"""
import argparse
import datetime
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
from replication import call  # noqa: E402

ROOT = HERE.parent.parent
DEFAULT = ROOT / "build/release/validation/population/mottle_bootstrap_coverage"

# specimens, noise, deviation, missing, replications, samples, model
ROWS = ((10, 0, 0.2, 0, 400, 100, "linear"), (10, 1, 0.2, 0, 400, 100, "linear"), (5, 0, 0.2, 0, 400, 100, "linear"),
        (5, 1, 0.2, 0, 400, 100, "linear"), (10, 0, 0.2, 0.2, 400, 100, "linear"), (10, 1, 0, 0, 200, 100, "linear"),
        (5, 1, 0, 0, 200, 100, "linear"), (10, 0, 0.2, 0, 400, 100, "modal"), (10, 1, 0, 0, 200, 100, "modal"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", type=pathlib.Path, default=DEFAULT)
    parser.add_argument("--rows", nargs="*", type=int, default=list(range(len(ROWS))))
    arguments = parser.parse_args()
    lines = ["# Intervals by bootstrap", "",
             f"Seed 20141, {datetime.date.today().isoformat()}; made by bootstrap.py. Noise: standard deviation as a "
             "fraction of the outputs' scatter for a population of standard deviation 0.2, known. Coverage in %, over the three parameters (pairs), with "
             "the standard error of a fraction of 95 % as if the three were one. \"Modal\": the eigenvalue "
             "problem of the masses.", "",
             "| specimens | noise | true standard deviation | missing | model | replications x samples | means | standard deviations | correlations "
             "| standard error | goal | reached | mean width of a standard deviation's interval |", "|---" * 13 + "|"]
    good = True
    for row in arguments.rows:
        specimens, noise, deviation, missing, replications, samples, model = ROWS[row]
        r = call(arguments.program, *ROWS[row])
        low, high = (0.93, 0.97) if deviation > 0 else (0.93, 1.0)
        error = math.sqrt(0.95 * 0.05 / replications)
        # Means do not know a border: theirs are right everywhere. Correlations of what does not scatter do not exist.
        slack = error if model == "modal" else 0.0
        kinds = ("mean", "deviation", "correlation") if deviation > 0 else ("mean", "deviation")
        fine = r["failed"] == 0 and all(low - slack <= r[kind] <= high + slack for kind in kinds)
        good = good and fine
        cells = [f"{100 * r[kind]:.1f}" if kind in kinds else "-" for kind in ("mean", "deviation", "correlation")]
        lines.append(f"| {specimens} | {noise} | {deviation} | {missing:.0%} | {model} | {replications} x {samples} | "
                     + " | ".join(cells) + f" | {100 * error:.1f} | {100 * low:.0f}-{100 * high:.0f} | "
                     f"{'yes' if fine else 'no'} | {r['deviation_width']:.3f} |")
        print(lines[-1], f"{r['seconds']:.0f} s", flush=True)
    if arguments.rows == list(range(len(ROWS))):
        (HERE / "BOOTSTRAP.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
