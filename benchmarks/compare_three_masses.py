#!/usr/bin/python3
"""The three-mass model on one core, side by side in one run. Clouds of 1000 samples a second, drawn and solved: Mottle,
a NumPy loop over scipy.linalg.eigh, OpenTURNS with a Python function (pointwise, and vectorised over the sample with
numpy.linalg.eigvalsh). The eigenproblem alone, samples given: Mottle, Eigen's generic generalised solver, an OpenTURNS
function in C++ around Eigen's closed form (whole samples at once), NumPy in a loop and batched. Writes RESULTS.md
beside this file.

    make bench; benchmarks/compare_three_masses.py      (Debian: python3-scipy, python3-openturns)
"""
import datetime
import json
import math
import pathlib
import subprocess

import peers

peers.use_one_core()
peers.choose_blas_kernels()

import numpy as np  # noqa: E402  (threads and kernels must be set first)
import openturns as ot  # noqa: E402
import scipy.linalg  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
PROGRAMS = HERE.parent / "build" / "release" / "benchmarks"
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
    return peers.best_time(work, 3.0)


def run(program, *words):
    return json.loads(subprocess.run([PROGRAMS / program, *words], check=True, capture_output=True, text=True).stdout)


def numpy_loop(matrices):
    for matrix in matrices:
        np.linalg.eigh(matrix)


def solve_rows():
    """(contender, us a sample, goal) of the eigenproblem alone."""
    samples = np.random.default_rng(3).normal(2.0, 0.3, (1 << 14, 3))
    matrices = np.array([stiffness(*x) for x in samples])
    peer = run("mottle_three_masses_peers_benchmark")
    microseconds = 1e6 / len(samples)
    some = matrices[:2000]
    yield "Mottle, values and vectors", peer["ours"], ""
    yield "Mottle, values alone", peer["ours_values"], ""
    yield "Eigen GeneralizedSelfAdjointEigenSolver", peer["eigen_generic"], "10"
    yield "OpenTURNS, C++ function, computeDirect, vectors", peer["openturns"], "3"
    yield "OpenTURNS, C++ function, computeDirect, values alone", peer["openturns_values"], "3"
    yield "NumPy loop over numpy.linalg.eigh", best_time(lambda: numpy_loop(some)) * 1e6 / len(some), "80"
    yield "SciPy loop over scipy.linalg.eigh(K, M)", \
        best_time(lambda: [scipy.linalg.eigh(k, MASS) for k in some]) * 1e6 / len(some), "80"
    yield "NumPy, batched eigh", best_time(lambda: np.linalg.eigh(matrices)) * microseconds, ""
    yield "NumPy, batched eigvalsh", best_time(lambda: np.linalg.eigvalsh(matrices)) * microseconds, ""


def main():
    generator = np.random.default_rng(1)
    distribution = ot.ComposedDistribution([ot.Normal(2.0, 0.3)] * 3)
    pointwise = ot.PythonFunction(3, 3, frequencies)
    vectorised = ot.PythonFunction(3, 3, func_sample=frequencies_of_sample)
    check = scipy_loop(np.random.default_rng(2))
    assert np.allclose(check, frequencies_of_sample(np.random.default_rng(2).normal(2.0, 0.3, (SAMPLES, 3))))
    mottle = run("mottle_three_masses_benchmark", "--json")
    rows = [("Mottle", mottle["cloud_1000_s"]),
            ("NumPy loop over scipy.linalg.eigh", best_time(lambda: scipy_loop(generator))),
            ("OpenTURNS, Python function, pointwise", best_time(lambda: pointwise(distribution.getSample(SAMPLES)))),
            ("OpenTURNS, Python function, vectorised", best_time(lambda: vectorised(distribution.getSample(SAMPLES))))]
    lines = ["# The three-mass model", "",
             f"One core, processor times, best of 2 to 3 seconds each, one run, {datetime.date.today().isoformat()}; "
             f"{peers.processor()}; Eigen compiled with -march=native; made by compare_three_masses.py.", "",
             "## Clouds", "", "1000 samples drawn and solved for three frequencies.", "",
             "| contender | clouds per second | time / Mottle's time |", "|---|---|---|"]
    lines += [f"| {name} | {1.0 / t:.1f} | {t / rows[0][1]:.0f} x |" for name, t in rows]
    lines += ["", f"Mottle alone on 2^20 samples: {1e6 * mottle['sample_s']:.3f} us a sample drawn and solved, "
              f"{1e6 * mottle['solve_s']:.3f} us solved.", "",
              "## The eigenproblem alone", "",
              "Samples of (k1, k2, k5) given. Contenders that find values alone are measured against Mottle's values "
              "alone, all others against values and vectors.", "",
              "| contender | us per sample | time / Mottle's time | goal |", "|---|---|---|---|"]
    rows = list(solve_rows())
    for name, time, goal in rows:
        base = rows[1][1] if "values alone" in name or "eigvalsh" in name else rows[0][1]
        lines.append(f"| {name} | {time:.3f} | {time / base:.1f} x | {goal and f'>= {goal} x'} |")
    lines.append("")
    (HERE / "RESULTS.md").write_text("\n".join(lines))
    print("\n".join(lines))


if __name__ == "__main__":
    main()
