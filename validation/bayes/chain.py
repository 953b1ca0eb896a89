#!/usr/bin/env python3
"""Posterior and evidence of a chain of 30 masses and 30 springs by importance sampling in NumPy, which shares nothing with Mottle.

Mass i (1 kg each) hangs between spring i and spring i + 1, spring 1 is fixed to the ground, the last mass is free. Spring
stiffnesses are independent, log-normal with mean 1000 N/m and standard deviation 100 N/m. One test of the lowest eight natural
frequencies, those of springs that grow from 900 to 1150 N/m, noise 0.5 % of each. The proposal is the normal density of the
linearised posterior at its peak, 3 % wider, in standard normal space; it prints the effective samples that its weights leave and
the standard errors of what it finds.

    /usr/bin/python3 validation/bayes/chain.py [--samples 200000]
"""
import argparse

import numpy
from scipy.optimize import least_squares

SPRINGS, MODES, NOISE, WIDER = 30, 8, 0.005, 1.03
LOG_STD = numpy.sqrt(numpy.log1p((100.0 / 1000.0) ** 2))
LOG_MEAN = numpy.log(1000.0) - LOG_STD**2 / 2


def frequencies(stiffness):
    """[sample x spring] -> [sample x mode]"""
    matrices = numpy.zeros((len(stiffness), SPRINGS, SPRINGS))
    i = numpy.arange(SPRINGS)
    matrices[:, i, i] = stiffness
    matrices[:, i[:-1], i[:-1]] += stiffness[:, 1:]
    matrices[:, i[1:], i[:-1]] = -stiffness[:, 1:]
    return numpy.sqrt(numpy.linalg.eigvalsh(matrices)[:, :MODES]) / (2 * numpy.pi)


def stiffness_of(scores):
    return numpy.exp(LOG_MEAN + LOG_STD * scores)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=200000)
    samples = parser.parse_args().samples
    tested = frequencies(numpy.linspace(900.0, 1150.0, SPRINGS)[None])[0]
    noise = NOISE * tested
    print("tests:", ", ".join(f"{value:.9g}" for value in tested))
    residuals = lambda u: numpy.concatenate([u, (frequencies(stiffness_of(u[None]))[0] - tested) / noise])  # noqa: E731
    peak = least_squares(residuals, numpy.zeros(SPRINGS), xtol=1e-12, ftol=1e-12)
    factor = WIDER * numpy.linalg.cholesky(numpy.linalg.inv(peak.jac.T @ peak.jac))
    random = numpy.random.default_rng(1)
    logs, parameters = [], []
    for _ in range(0, samples, 20000):
        w = random.standard_normal((20000, SPRINGS))
        u = peak.x + w @ factor.T
        x = stiffness_of(u)
        misfit = (((frequencies(x) - tested) / noise) ** 2).sum(1)
        logs.append(-0.5 * ((u**2).sum(1) + misfit) + 0.5 * (w**2).sum(1))
        parameters.append(x)
    constant = numpy.log(numpy.diag(factor)).sum() - numpy.log(noise).sum() - 0.5 * MODES * numpy.log(2 * numpy.pi)
    logs, parameters = numpy.concatenate(logs), numpy.concatenate(parameters)
    weights = numpy.exp(logs - logs.max())
    n = len(weights)
    print(f"effective samples: {weights.sum() ** 2 / (weights**2).sum():.0f} of {n}")
    print(f"ln evidence: {constant + logs.max() + numpy.log(weights.mean()):.5f} +- {weights.std() / weights.mean() / n**0.5:.5f}")
    weights /= weights.sum()
    mean = weights @ parameters
    std = numpy.sqrt(weights @ (parameters - mean) ** 2)
    error = numpy.sqrt((weights[:, None] ** 2 * (parameters - mean) ** 2).sum(0))
    for name, values in (("means", mean), ("standard deviations", std), ("standard errors of the means", error)):
        print(f"{name}:", ", ".join(f"{value:.2f}" for value in values))
    both = weights @ ((parameters[:, 0] - mean[0]) * (parameters[:, 1] - mean[1])) / (std[0] * std[1])
    print(f"correlation of springs 1 and 2: {both:.4f}")


if __name__ == "__main__":
    main()
