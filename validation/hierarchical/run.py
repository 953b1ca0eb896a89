#!/usr/bin/python3
"""Populations whose posterior is known, and simulation-based calibration of the method `hierarchical`.

Needs the program built with -DMOTTLE_BUILD_VALIDATION=ON, NumPy and SciPy. Writes RESULTS.md beside this file and ends with
exit code 1 if a goal is missed.

    /usr/bin/python3 validation/hierarchical/run.py [--seeds 50] [--data-sets 500] [--particles 100] [--jobs 1] [--program PATH]
"""
import argparse
import concurrent.futures
import datetime
import json
import pathlib
import sys

import numpy
import scipy.stats

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
from replication import call  # noqa: E402

DEFAULT = HERE.parent.parent / "build/release/validation/hierarchical/mottle_hierarchical_references"
SCHOOLS = {"ln_evidence": -31.3113474, "mu": 4.3968207, "mu_std": 3.3177045, "tau": 3.5977055, "theta_1": 6.2118842}
CASES = [(3, 0.01), (10, 0.01), (3, 0.04), (10, 0.04)]
STATED = 4.0  # standard errors of a mean over seeds


def outputs_of(options, name, *words):
    """What the program prints for a case; of --saved what is there, or nothing."""
    if options.saved is None:
        return call(options.program, *words)
    file = pathlib.Path(options.saved) / f"{name}.json"
    return json.loads(file.read_text()) if file.is_file() and file.stat().st_size else None


def oracle_references():
    """Means, deviations and half-widths of 95 % of mu, means of sigma, for nu = 0.5, a = 0.05, n = 10, without noise."""
    nu, a, n = 0.5, 0.05, 10
    t = numpy.arange(10) - 4.5
    x = numpy.stack([t, t**2 - 8.25, t**3 - 14.65 * t], axis=1)
    x *= numpy.array([0.288, 0.130, 0.241]) / x.std(axis=0, ddof=1)
    x += numpy.array([1.08, 1.09, 0.96])
    freedom = n - 1 + nu
    references = {}
    for name, column in zip(("k1", "k2", "k5"), x.T):
        square = nu * a**2 + ((column - column.mean()) ** 2).sum()
        scale = numpy.sqrt(square / (n * freedom))
        references["mu_" + name] = column.mean()
        references["mu_std_" + name] = scale * numpy.sqrt(freedom / (freedom - 2))
        references["half_width_" + name] = scale * scipy.stats.t.ppf(0.975, freedom)
        references["sigma_" + name] = scipy.stats.invgamma(0.5 * freedom, scale=0.5 * square).expect(numpy.sqrt)
    return references


def curved_references():
    """Sums over grids of mu, ln sigma and each specimen's (x - mu) / sigma."""
    z, noise = numpy.array([0.5, 1.4, 2.3]), 0.4
    w = numpy.linspace(-8, 8, 641)
    normal = scipy.stats.norm.pdf(w) * (w[1] - w[0])
    mus, logs = numpy.linspace(-3, 3, 241), numpy.linspace(numpy.log(1e-5), numpy.log(50), 401)
    total = numpy.zeros(5)
    for log in logs:
        sigma = numpy.exp(log)
        x = mus[:, None] + sigma * w
        density = scipy.stats.norm.pdf(z[:, None, None], numpy.exp(numpy.minimum(x, 50)), noise) * normal
        each = density.sum(axis=2)
        prior = scipy.stats.norm.pdf(mus, 0, 0.5) * 4 * scipy.stats.t.pdf(sigma / 0.5, 4) * sigma
        p = prior * each.prod(axis=0)
        first = (density[0] * x).sum(axis=1) * each[1] * each[2]
        total += [p.sum(), (p * mus).sum(), (p * mus**2).sum(), p.sum() * sigma, (prior * first).sum()]
    moments = total[1:] / total[0]
    return {"ln_evidence": numpy.log(total[0] * (mus[1] - mus[0]) * (logs[1] - logs[0])), "mu": moments[0],
            "mu_std": numpy.sqrt(moments[1] - moments[0] ** 2), "sigma": moments[2], "x_1": moments[3]}


def moments(found, references):
    rows, good = [], True
    for name, reference in references.items():
        values = numpy.array(found[name])
        error = values.std(ddof=1) / numpy.sqrt(len(values))
        reached = abs(values.mean() - reference) < STATED * error + 5e-3 * abs(reference)
        good = good and reached
        rows.append(f"| {name} | {reference:.7f} | {values.mean():.5f} | {error:.5f} | {values.std(ddof=1):.4f} | {'yes' if reached else 'no'} |")
    return rows, good


class Band:
    """Simultaneous 95 % band of the empirical distribution of ranks 0 to `draws`, by simulation [Sailynoja2022]."""

    def __init__(self, data_sets, draws):
        self.data_sets, self.draws = data_sets, draws
        random = numpy.random.default_rng(1)
        self.smallest = numpy.sort([self.least(random.integers(0, draws + 1, data_sets)) for _ in range(4000)])

    def least(self, ranks):
        """The smallest pointwise probability of the counts of ranks up to each value."""
        counts = numpy.cumsum(numpy.bincount(numpy.asarray(ranks, int), minlength=self.draws + 1))[:-1]
        part = numpy.arange(1, self.draws + 1) / (self.draws + 1)
        below = scipy.stats.binom.cdf(counts, self.data_sets, part)
        above = scipy.stats.binom.sf(counts - 1, self.data_sets, part)
        return 2 * min(below.min(), above.min())

    def p_value(self, ranks):
        return (numpy.searchsorted(self.smallest, self.least(ranks), side="right") + 1) / (len(self.smallest) + 1)


def calibration(options, cases, first=1):
    """Rows of the table, {(specimens, noise, name): p} and the time that it took, from the data set `first` on."""
    rows, p_values = [], {}
    seconds = 0.0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        runs = list(pool.map(lambda case: outputs_of(options, f"sbc-{case[0]}-{case[1]}-{first}", "sbc", *case, options.data_sets,
                                                     options.particles, first), cases))
    for (specimens, noise), found in zip(cases, runs):
        if found is None:
            rows.append(f"| {specimens} | {100 * noise:.0f} % | not run | | | | | |")
            continue
        seconds += found["seconds"] * found["data_sets"]
        ranks = numpy.array(found["ranks"])
        band = Band(len(ranks), found["draws"])
        for name, column in zip(found["names"], ranks.T):
            p = band.p_value(column)
            p_values[specimens, noise, name] = p
            rows.append(f"| {specimens} | {100 * noise:.0f} % | {name} | {len(ranks)} | {column.mean() / found['draws']:.3f} | {p:.3f} | "
                        f"{'inside' if p >= 0.05 else 'outside'} | {100 * found['converged']:.0f} |")
    return rows, p_values, seconds


TABLE = ["| specimens | noise | rank of | data sets | mean rank | p | 95 % band | converged, % |", "|---|---|---|---|---|---|---|---|"]


def again(options, p_values):
    """The cases in which a rank is outside its band, with other data sets: chance does not strike the same rank twice."""
    outside = {key for key, p in p_values.items() if p < 0.05}
    cases = [case for case in CASES if any(key[:2] == case for key in outside)]
    if not cases:
        return [], True
    rows, fresh, seconds = calibration(options, cases, options.data_sets + 1)
    twice = [key for key in outside if fresh.get(key, 1.0) < 0.05]
    text = (f"\n## The same with other data sets, where a rank was outside\n\nData sets {options.data_sets + 1} to {2 * options.data_sets}, {seconds:.0f} s of "
            f"one core. Ranks outside in both: {', '.join(key[2] for key in twice) or 'none'}: {'not reached' if twice else 'reached'}.\n")
    return [text, *TABLE, *rows], not twice


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=DEFAULT)
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--data-sets", type=int, default=500)
    parser.add_argument("--particles", type=int, default=100)
    parser.add_argument("--saved", help="folder of what the program printed, a file a case, instead of running it")
    parser.add_argument("--jobs", type=int, default=1, help="cases of the calibration at once")
    options = parser.parse_args()
    out = [f"# Populations whose posterior is known, and calibration\n\n{datetime.date.today()}; made by run.py."]
    good = True
    cases = (("eight-schools", "Eight schools", SCHOOLS), ("curved", "Three specimens of a curved model", curved_references()),
             ("oracle", "Ten inverted specimens", oracle_references()))
    for case, title, references in cases:
        found = outputs_of(options, case, case, options.seeds)
        if found is None:
            out.append(f"\n## {title}\n\nNot run.")
            continue
        rows, reached = moments(found, references)
        good = good and reached
        out += [f"\n## {title}\n", f"{found['seeds']} seeds, {numpy.mean(found['evaluations']):.0f} model runs and {found['seconds']:.2f} s a seed; converged in "
                f"{100 * numpy.mean(found['converged']):.0f} %, largest R-hat {max(found['r_hat']):.4f}.\n",
                "| what | reference | mean over seeds | its standard error | standard deviation over seeds | within 4 errors + 0.5 % |", "|---|---|---|---|---|---|", *rows]
        if "ln_evidence" in references:
            lower, upper = numpy.array(found["lower"]), numpy.array(found["upper"])
            covered = numpy.mean((lower <= references["ln_evidence"]) & (references["ln_evidence"] <= upper))
            out.append(f"\nln evidence: stated standard error {numpy.mean(found['stated']):.4f}; its 95 % interval holds the reference in "
                       f"{100 * covered:.0f} % of the seeds (standard error {100 * (0.0475 / found['seeds']) ** 0.5:.1f} %).")
    rows, of_ranks, seconds = calibration(options, CASES)
    p_values = list(of_ranks.values())
    outside = sum(p < 0.05 for p in p_values)
    # Of 28 correct ones more than 5 are outside in 0.2 % of all runs; one below 0.05 / 28 in 5 %.
    reached = outside <= 5 and min(p_values) >= 0.05 / len(p_values)
    out += ["\n## Simulation-based calibration\n",
            f"{options.particles} particles in each of 8 islands, ranks among 100 draws, {seconds:.0f} s of one core. p: of the largest "
            "deviation of the ranks' distribution, by its simultaneous law; outside the 95 % band where p < 0.05. "
            f"Outside: {outside} of {len(p_values)}, where 5 % are expected; smallest p {min(p_values):.4f}, to be compared with {0.05 / len(p_values):.4f}: "
            f"{'reached' if reached else 'not reached'}.\n", *TABLE, *rows]
    repeated, is_chance = again(options, of_ranks)
    good = good and reached and is_chance
    out += repeated
    (HERE / "RESULTS.md").write_text("\n".join(out) + "\n", encoding="utf-8")
    print("\n".join(out))
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
