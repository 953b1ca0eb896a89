#!/usr/bin/env python3
"""Does the verdict keep its word? Replications of right and wrong three-mass models, new specimens each time.

Needs the program built with -DMOTTLE_BUILD_VALIDATION=ON. Writes RESULTS.md beside this file and ends with 1 where a row
misses its goal. Seeds 20061 (structures) and 20062 (measurement).

    python3 validation/verdict/run.py [--program build/release/validation/population/mottle_population_replication]
"""
import argparse
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
from replication import call  # noqa: E402

ROOT = HERE.parent.parent
DEFAULT = ROOT / "build/release/validation/population/mottle_population_replication"
ML, CA, MM, MARES = "maximum-likelihood", "covariance-adjustment", "moment-matching", "mares"

# What is tested, the words of the program, and the goals: least and most part that is inadequate, most that is adequate.
RIGHT = (
    ("shapes", (1, 3, "1%", 0, "shapes"), (ML,)),
    ("shapes", (1, 5, "1%", 0, "shapes"), (ML,)),
    ("shapes", (1, 10, "1%", 0, "shapes"), (ML,)),
    ("shapes", (1, 50, "1%", 0, "shapes"), (ML,)),
    ("shapes, noise not given", (1, 10, "1%", 0, "shapes"), (ML, "case.noise=unknown")),
    ("shapes, noise not given", (1, 5, "1%", 0, "shapes"), (ML, "case.noise=unknown")),
    ("frequencies, no correlations", (1, 5, 0, 0, "frequencies"), (ML, "case.covariance=diagonal")),
    ("frequencies, no correlations", (1, 10, 0, 0, "frequencies"), (ML, "case.covariance=diagonal")),
    ("frequencies, no correlations, plain likelihood", (1, 10, 0, 0, "frequencies"),
     (ML, "case.covariance=diagonal", "likelihood=plain")),
    ("frequencies, bound of k1 0.8 standard errors below", (1, 10, 0, 0, "frequencies"), (ML, "case.bound=0.8")),
    ("frequencies, bound of k1 on the truth", (1, 10, 0, 0, "frequencies"), (ML, "case.bound=0")),
    ("shapes, bound of k1 on the truth", (1, 10, "1%", 0, "shapes"), (ML, "case.bound=0")),
    ("frequencies", (1, 3, 0, 0, "frequencies"), (ML,)),
    ("frequencies, noise as large as the scatter", (1, 10, 1, 0, "frequencies"), (ML,)),
    ("shapes", (1, 10, "1%", 0, "shapes"), (CA,)),
    ("shapes", (1, 50, "1%", 0, "shapes"), (CA,)),
    ("shapes", (1, 10, "1%", 0, "shapes"), (MM,)),
    ("shapes, noise not given", (1, 50, "1%", 0, "shapes"), (CA, "case.noise=unknown")),
    ("frequencies", (1, 10, 0, 0, "frequencies"), (MARES,)),
    ("shapes", (1, 20, "1%", 0, "shapes"), (MARES,)),
    ("shapes", (1, 10, "1%", 0, "shapes"), ("deterministic",)),
    ("shapes", (1, 20, "1%", 0, "shapes"), ("deterministic",)),
    ("shapes", (1, 10, "1%", 0, "shapes"), ("inversion",)),
    ("shapes", (1, 50, "1%", 0, "shapes"), ("inversion",)),
    ("shapes", (1, 10, "1%", 0, "shapes"), ("perturbation",)),
    ("shapes, a quarter missing", (1, 12, "1%", 0.25, "shapes"), (ML,)),
    ("shapes, a quarter missing", (1, 12, "1%", 0.25, "shapes"), (CA,)),
    ("shapes, a quarter missing", (1, 12, "1%", 0.25, "shapes"), ("inversion",)),
    ("shapes, a quarter missing", (1, 12, "1%", 0.25, "shapes"), ("deterministic",)),
)
WRONG = (  # least part inadequate, most adequate
    ("case 2: k6 = 3.5", (2, 10, "1%", 0, "shapes"), (ML,), 0.99, 0),
    ("case 2: k6 = 3.5", (2, 10, 0, 0, "frequencies"), (ML,), 0.99, 0),
    ("case 2: k6 = 3.5", (2, 10, 0, 0, "frequencies"), (MARES,), 0.80, 0),
    ("case 3: no k6", (3, 10, 0, 0, "frequencies"), (ML,), 0.99, 0),
    ("case 3: no k6", (3, 10, 0, 0, "frequencies"), (MARES,), 0.80, 0),
    ("case 4: all springs vary", (4, 50, "1%", 0, "shapes"), (ML,), 0.80, 0.2),
    ("case 4: all springs vary", (4, 50, "1%", 0, "shapes"), (ML, "case.noise=unknown"), 0.80, 0.2),
    ("case 4: all springs vary", (4, 10, 0, 0, "frequencies"), (MARES,), 0, 0),
    ("k6 = 3.1", (5, 10, 0, 0, "frequencies"), (ML,), 0, 0),
    ("mass m1 10 % off", (6, 10, 0, 0, "frequencies"), (ML,), 0, 0),
)


def row(out, program, count, what, words, method, least, most, most_adequate):
    """One line of a table, and whether its goal is met."""
    r = call(program, *words, count, *method)
    refused, adequate = r["rejected"], r["adequate"]
    fine = least <= refused <= most and adequate <= most_adequate
    failed = ", ".join(f"{name} {number}" for name, number in r["failed_tests"].items())
    out.append(f"| {what} | {' '.join(method)} | {words[1]} | {count} | {100 * refused:.1f} | {100 * adequate:.1f} | "
               f"{100 * (1 - refused - adequate):.1f} | {100 * r['other_solutions']:.1f} | {'yes' if fine else 'no'} | {failed} |")
    print(out[-1], flush=True)
    return fine


HEAD = ("| what | method | specimens | replications | inadequate, % | adequate, % | undecided, % | other solutions, % | reached | "
        "failed tests (`held`: mean on a bound) |\n|---|---|---|---|---|---|---|---|---|---|")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=pathlib.Path, default=DEFAULT)
    parser.add_argument("--replications", type=int, default=400)
    arguments = parser.parse_args()
    count = arguments.replications
    out = ["# The verdict by replication", "",
           "Made by run.py, seeds 20061 (structures) and 20062 (measurement). Shapes: three mode shapes beside the "
           "frequencies, noise 1 % of each frequency and of the shapes' size.", "", "## Right models", "",
           "Goal: inadequate in 5 % + 2 at most.", "", HEAD]
    good = [row(out, arguments.program, count, *case, 0, 0.07, 1) for case in RIGHT]
    out += ["", "## Wrong models", "",
            "Goals: cases 2 and 3 inadequate in 99 % (80 % by mares: an update that oscillates is undecided), case 4 with "
            "shapes in 80 %; nothing that was not tested adequate, and "
            "errors that no test can detect undecided.", "", HEAD]
    for what, words, method, least, most_adequate in WRONG:
        good.append(row(out, arguments.program, max(count // 4, 1), what, words, method, least, 1 if least else 0.07,
                        most_adequate))
    (HERE / "RESULTS.md").write_text("\n".join(out) + "\n", encoding="utf-8")
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main())
