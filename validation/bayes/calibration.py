#!/usr/bin/env python3
"""Simulation-based calibration of `bayes`: ranks of the true parameters, of the level of the noise and of the log-likelihood among the
draws of 1,000 posteriors, against the 95 % simultaneous band of the empirical distribution of uniform ranks.

Needs the program built with -DMOTTLE_BUILD_VALIDATION=ON. Writes CALIBRATION.md and calibration.png beside this file; ends with exit
code 1 if a rank leaves its band. Needs python3-numpy and python3-matplotlib of Debian.

    /usr/bin/python3 validation/bayes/calibration.py [--data-sets 1000] [--first-seed 500001] [--particles 100]
"""
import argparse
import datetime
import io
import pathlib
import subprocess
import sys

import matplotlib
import numpy

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
DEFAULT = HERE.parent.parent / "build/release/validation/bayes/mottle_bayes_calibration"
CASES = ("noise-known", "noise-estimated")
KEPT = 99  # draws that a rank is among


def distribution(ranks):
    """Part of the ranks that are <= 0, 1, ..., 98."""
    return numpy.cumsum(numpy.bincount(ranks, minlength=KEPT + 1))[:-1] / len(ranks)


def pointwise_level(data_sets, probability=0.95, simulations=2000):
    """Level of the pointwise binomial bands that hold the whole of a distribution of uniform ranks with this probability:
    by simulation, [Sailynoja2022], algorithm 1."""
    from scipy.stats import binom
    random = numpy.random.default_rng(1)
    places = numpy.arange(1, KEPT + 1) / (KEPT + 1)
    least = numpy.empty(simulations)
    for k in range(simulations):
        counts = numpy.round(distribution(random.integers(0, KEPT + 1, data_sets)) * data_sets)
        lower = binom.cdf(counts, data_sets, places)
        upper = binom.sf(counts - 1, data_sets, places)
        least[k] = 2 * numpy.minimum(lower, upper).min()
    return numpy.quantile(least, 1 - probability)


def band(data_sets, level):
    from scipy.stats import binom
    places = numpy.arange(1, KEPT + 1) / (KEPT + 1)
    return places, binom.ppf(level / 2, data_sets, places) / data_sets, binom.isf(level / 2, data_sets, places) / data_sets


def simulate(options, case):
    done = subprocess.run([options.program, case, str(options.data_sets), str(options.first_seed), str(options.particles)],
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{case} ended with {done.returncode}: {done.stderr}")
    names = done.stdout.split("\n", 1)[0].split(",")
    return names, numpy.loadtxt(io.StringIO(done.stdout), delimiter=",", skiprows=1, dtype=int).T


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=DEFAULT)
    parser.add_argument("--data-sets", type=int, default=1000)
    parser.add_argument("--first-seed", type=int, default=500001)
    parser.add_argument("--particles", type=int, default=100)
    parser.add_argument("--cases", nargs="+", choices=CASES, default=CASES)
    options = parser.parse_args()
    places, lower, upper = band(options.data_sets, pointwise_level(options.data_sets))
    figure, axes = pyplot.subplots(1, len(options.cases), figsize=(5 * len(options.cases), 4), sharey=True, squeeze=False)
    rows, good = [], True
    for case, axis in zip(options.cases, axes[0]):
        axis.fill_between(places, lower - places, upper - places, color="0.85", step="mid")
        for name, ranks in zip(*simulate(options, case)):
            found = distribution(ranks)
            outside = int(((found < lower) | (found > upper)).sum())
            good = good and outside == 0
            rows.append(f"| {case} | {name} | {ranks.mean() / KEPT:.4f} | {ranks.std() / KEPT:.4f} | {abs(found - places).max():.4f} | "
                        f"{outside} | {'yes' if outside == 0 else 'no'} |")
            axis.plot(places, found - places, label=name, linewidth=1)
        axis.set(title=case, xlabel="rank / 100")
        axis.legend(fontsize=8)
    axes[0, 0].set_ylabel("distribution of ranks less uniform")
    figure.tight_layout()
    figure.savefig(HERE / "calibration.png", dpi=90, metadata={"Software": None})
    text = (f"# Simulation-based calibration of `bayes`\n\n{options.data_sets} data sets of each case, seeds from {options.first_seed}, {options.particles} "
            f"particles in each of 8 islands, other options at their defaults, ranks among {KEPT} draws; {datetime.date.today()}; made by calibration.py. "
            "A uniform rank has mean 0.5 and standard deviation 0.289; the band holds the whole distribution of uniform ranks with 95 % probability.\n\n"
            "| case | quantity | mean of the rank | standard deviation | largest distance from uniform | places outside the band | inside |\n"
            "|---|---|---|---|---|---|---|\n" + "\n".join(rows) + "\n\n![distribution of ranks](calibration.png)\n")
    (HERE / "CALIBRATION.md").write_text(text, encoding="utf-8")
    print(text)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
