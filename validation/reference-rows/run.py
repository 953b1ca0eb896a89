#!/usr/bin/env python3
"""Holds the estimators of a population against reference values on one set of ten specimens.

The specimens of the three masses have the sample mean (1.08, 1.09, 0.96) and deviation (0.288, 0.130, 0.241) of k1, k2,
k5 exactly and no correlation. The references were computed outside this program: inversion by the definition of the
specimens, the first-order fixed point from the analytic sensitivities, moment matching by Gauss-Hermite quadrature. All
four methods go through `mottle update` from the start of case 1. Writes the table into README.md beside this file.

    python3 validation/reference-rows/run.py [--mottle build/release/mottle] [--data oracle10.csv]
"""
import argparse
import csv
import datetime
import json
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
STUDY = ROOT / "examples" / "01-three-masses" / "case1.toml"
NAMES = ("k1", "k2", "k5")
SEED = 1
EXACT = ((1.08, 1.09, 0.96), (0.288, 0.130, 0.241))
FIRST_ORDER = ((1.09877159, 1.05074330, 0.96464297), (0.29255890, 0.11781059, 0.23789794))
MATCHED = ((1.07780753, 1.09323337, 0.96010173), (0.28967961, 0.11086464, 0.23698861))
# name, method, options, reference, tolerance
ROWS = (
    ("inversion", "inversion", (), EXACT, 1e-6),
    ("perturbation", "perturbation", (), FIRST_ORDER, 1e-5),
    ("covariance-adjustment, first order", "covariance-adjustment", ('update.covariance-adjustment.cloud="first-order"',),
     FIRST_ORDER, 1e-5),
    ("covariance-adjustment, 1000 samples", "covariance-adjustment", (), MATCHED, None),
    ("covariance-adjustment, 100 000 samples", "covariance-adjustment", ("update.samples=100000",), MATCHED, 2e-3),
    ("moment-matching, Gauss-Hermite", "moment-matching", (), MATCHED, 2e-3),
    ("moment-matching, degree 5", "moment-matching", ('update.moment-matching.rule="degree-5"',), MATCHED, None),
)


def run(*command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def specimens(file, folder):
    """The frequencies of the given table; without one, those of the discrete orthogonal polynomials on ten points."""
    if file is not None:
        return pathlib.Path(file).resolve()
    columns = []
    for mean, deviation, shape in zip(*EXACT, (lambda t: t, lambda t: t * t - 8.25, lambda t: t**3 - 14.65 * t)):
        values = [shape(i - 4.5) for i in range(10)]
        scale = deviation / (sum(value * value for value in values) / 9) ** 0.5
        columns.append([mean + scale * value for value in values])
    points = folder / "points.csv"
    with points.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(NAMES)
        writer.writerows(zip(*columns))
    return points


def tests_of(mottle, points, folder):
    """A test file: what the model says of the points, or the given table itself where it holds frequencies."""
    header = points.read_text().splitlines()[0]
    if "f1" in header:
        return points
    run(mottle, "propagate", STUDY, "--points", points, "--out", folder / "points", "--quiet")
    with (folder / "points" / "cloud.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    tests = folder / "tests.csv"
    with tests.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(("f1", "f2", "f3"))
        writer.writerows([row["f1"], row["f2"], row["f3"]] for row in rows)
    return tests


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--mottle", default=ROOT / "build" / "release" / "mottle")
    parser.add_argument("--data", help="CSV with f1 to f3 of the ten specimens; default: made from their definition")
    arguments = parser.parse_args()
    lines = ["| method | mean k1, k2, k5 | standard deviation k1, k2, k5 | largest error | allowed | updating, s |", "|---|---|---|---|---|---|"]
    failed = False
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        tests = tests_of(arguments.mottle, specimens(arguments.data, folder), folder)
        for title, method, options, reference, tolerance in ROWS:
            sets = ['test.file="%s"' % tests, 'update.method="%s"' % method, "update.tolerance=1e-9",
                    "update.iterations=200", *options]
            run(arguments.mottle, "update", STUDY, "--seed", SEED, "--quiet", "--threads", 1, "--out", folder / "out",
                *(part for text in sets for part in ("--set", text)))
            result = json.loads((folder / "out" / "result.json").read_text())
            if result["status"] != "converged":
                sys.exit(f"{title}: {result['status']}: {result['message']}")
            mean, deviation = result["parameters"]["mean"], result["parameters"]["std"]
            error = max(abs(found - wanted) for found, wanted in zip((*mean, *deviation), (*reference[0], *reference[1])))
            passed = tolerance is None or error <= tolerance
            failed = failed or not passed
            lines.append("| %s | %s | %s | %.1e | %s%s | %.3f |" % (
                title, ", ".join("%.8f" % value for value in mean), ", ".join("%.8f" % value for value in deviation), error,
                "-" if tolerance is None else "%.0e" % tolerance, "" if passed else " FAILED",
                result["timings_s"]["updating"]))
    version = run(arguments.mottle, "--version").strip()
    head = (HERE / "README.md").read_text().split("<!-- table -->")[0]
    text = "\n".join([head + "<!-- table -->", "", f"{version}, seed {SEED}, {datetime.date.today().isoformat()}; "
                      "time of the method, its first and last cloud of `samples` runs included, on one thread.", "",
                      *lines, ""])
    (HERE / "README.md").write_text(text)
    print("\n".join(lines))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
