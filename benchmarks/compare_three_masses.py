#!/usr/bin/python3
"""Clouds of 1000 samples of the three-mass model a second, on one core, side by side in one run: Mottle, a NumPy loop
over scipy.linalg.eigh, and OpenTURNS with a Python function (pointwise, and vectorised over the sample with
numpy.linalg.eigvalsh). Every contender draws its samples and finds the frequencies. Writes RESULTS.md beside this file.

    make bench; taskset -c 0 benchmarks/compare_three_masses.py      (Debian: python3-scipy, python3-openturns)
"""
import datetime
import json
import math
import os
import pathlib
import subprocess
import time

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np  # noqa: E402  (the thread counts must be set first)
import openturns as ot  # noqa: E402
import scipy.linalg  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = HERE.parent / "build" / "release" / "benchmarks" / "mottle_three_masses_benchmark"
SAMPLES = 1000
MASS = np.eye(3)


def stiffness(k1, k2, k5):
    k3, k4, k6 = 1.0, 1.0, 3.0
    return np.array([[k1 + k4 + k6, -k4, -k6], [-k4, k2 + k4 + k5, -k5], [-k6, -k5, k3 + k5 + k6]])


def scipy_loop(generator):
    samples = generator.normal(2.0, 0.3, (SAMPLES, 3))
    return np.array([np.sqrt(scipy.linalg.eigh(stiffness(*x), MASS, eigvals_only=True)) / (2 * math.pi) for x in samples])


def frequencies(x):
    return np.sqrt(scipy.linalg.eigh(stiffness(*x), MASS, eigvals_only=True)) / (2 * math.pi)


def frequencies_of_sample(x):
    x = np.asarray(x)
    k = np.empty((len(x), 3, 3))
    k[:] = stiffness(0.0, 0.0, 0.0)
    k[:, 0, 0] += x[:, 0]
    k[:, 1, 1] += x[:, 1] + x[:, 2]
    k[:, 2, 2] += x[:, 2]
    k[:, 1, 2] -= x[:, 2]
    k[:, 2, 1] -= x[:, 2]
    return np.sqrt(np.linalg.eigvalsh(k)) / (2 * math.pi)


def best_time(work):
    times = []
    end = time.perf_counter() + 3.0
    while time.perf_counter() < end:
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def main():
    generator = np.random.default_rng(1)
    distribution = ot.ComposedDistribution([ot.Normal(2.0, 0.3)] * 3)
    pointwise = ot.PythonFunction(3, 3, frequencies)
    vectorised = ot.PythonFunction(3, 3, func_sample=frequencies_of_sample)
    check = scipy_loop(np.random.default_rng(2))
    assert np.allclose(check, frequencies_of_sample(np.random.default_rng(2).normal(2.0, 0.3, (SAMPLES, 3))))
    mottle = json.loads(subprocess.run([PROGRAM, "--json"], check=True, capture_output=True, text=True).stdout)
    rows = [("Mottle", mottle["cloud_1000_s"]),
            ("NumPy loop over scipy.linalg.eigh", best_time(lambda: scipy_loop(generator))),
            ("OpenTURNS, Python function, pointwise", best_time(lambda: pointwise(distribution.getSample(SAMPLES)))),
            ("OpenTURNS, Python function, vectorised", best_time(lambda: vectorised(distribution.getSample(SAMPLES))))]
    lines = ["# Clouds of the three-mass model", "",
             f"1000 samples drawn and solved for three frequencies, one core, best of 2 to 3 seconds each, one run, "
             f"{datetime.date.today().isoformat()}; made by compare_three_masses.py.", "",
             "| contender | clouds a second | time of Mottle's |", "|---|---|---|"]
    lines += [f"| {name} | {1.0 / t:.1f} | {t / rows[0][1]:.0f} x |" for name, t in rows]
    lines += ["", f"Mottle alone on 2^20 samples: {1e6 * mottle['sample_s']:.3f} us a sample drawn and solved, "
              f"{1e6 * mottle['solve_s']:.3f} us solved.", ""]
    (HERE / "RESULTS.md").write_text("\n".join(lines))
    print("\n".join(lines))


if __name__ == "__main__":
    main()
