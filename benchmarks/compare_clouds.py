#!/usr/bin/env python3
"""Clouds of shells and solids through the certified reduced model: their cost in exact solves (ours, the lowest 10 modes of
the nominal model, cold) on one core, and an audit of the bounds against exact solves. Writes CLOUDS.md beside this file.

    make bench; benchmarks/compare_clouds.py [--audit-samples N] [--program FILE]

Parameters are lognormal factors of the patches' Young's moduli (and densities), one a patch; see make_models.py. Training
samples, 400 of them, are other draws than the cloud. Takes about 10 minutes, most of it for exact solves of the audit.
"""
import argparse
import datetime
import json
import os
import pathlib
import subprocess
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = HERE.parent / "build" / "release" / "benchmarks" / "mottle_cloud_benchmark"
CLOUDS = [  # family, equations, patches, fields, variation, samples, frequency error
    ("shell", 20000, 5, "E", 0.1, 1000, 1e-4),
    ("shell", 20000, 5, "E", 0.1, 1000, 2e-6),
    ("shell", 20000, 5, "E", 0.1, 10000, 1e-4),
    ("shell", 20000, 5, "E", 0.1, 100000, 1e-4),
    ("shell", 20000, 5, "E+RHO", 0.1, 1000, 1e-4),
    ("shell", 20000, 5, "E", 0.3, 1000, 1e-4),
    ("shell", 20000, 10, "E", 0.1, 1000, 1e-4),
    ("shell", 20000, 18, "E", 0.1, 1000, 1e-4),
    ("shell", 20000, 30, "E", 0.1, 1000, 1e-4),
    ("solid", 20000, 5, "E", 0.1, 1000, 1e-4),
    ("shell", 100000, 5, "E", 0.1, 1000, 1e-4),
    ("solid", 100000, 5, "E", 0.1, 1000, 1e-4),
]
AUDITS = [(family, 2000, patches, fields, variation) for family in ("shell", "solid") for patches, fields in
          ((5, "E"), (5, "E+RHO"), (10, "E"), (18, "E"), (30, "E")) for variation in (0.05, 0.1, 0.2, 0.3)]


def blas_kernel():
    flags = pathlib.Path("/proc/cpuinfo").read_text() if os.path.exists("/proc/cpuinfo") else ""
    return "SKYLAKEX" if "avx512f" in flags else "HASWELL"


def run(arguments, folder, family, equations, patches, *words, threads=1):
    deck = folder / f"{family}-{equations}-{patches}.bdf"
    if not deck.exists():
        subprocess.run([HERE / "make_models.py", family, str(equations), str(patches), deck], check=True)
    environment = dict(os.environ, OPENBLAS_CORETYPE=blas_kernel(), OPENBLAS_NUM_THREADS="1", OMP_THREAD_LIMIT="1")
    fields, variation, samples, error, audited = words
    command = [arguments.program, deck, patches, fields, 10, variation, samples, error, audited, threads]
    output = subprocess.run([str(word) for word in command], check=True, env=environment, text=True, stdout=subprocess.PIPE)
    return json.loads(output.stdout)


def cloud_rows(arguments, folder):
    for family, equations, patches, fields, variation, samples, error in CLOUDS:
        r = run(arguments, folder, family, equations, patches, fields, variation, samples, error, 20)
        # What is not certain is solved exactly.
        total = r["begin_s"] + r["train_s"] + r["cloud_s"] + r["refine_s"] + r["unsure"] * r["exact_s"]
        yield (f"| {family}, {r['equations']} | {patches} | {fields} | {100 * variation:.0f} % | {samples} | {error:.0e} | "
               f"{r['exact_s']:.3f} | {r['vectors']} | {r['begin_s']:.2f} + {r['train_s']:.2f} + {r['cloud_s']:.2f} + {r['refine_s']:.2f} | "
               f"{r['refined']} | {r['unsure']} | {total / r['exact_s']:.1f} | {samples * r['exact_s'] / total:.0f} | "
               f"{r['largest_error']:.1e} |")


def audit_rows(arguments, folder):
    pairs = violations = 0
    for family, equations, patches, fields, variation in AUDITS:
        count = arguments.audit_samples
        r = run(arguments, folder, family, equations, patches, fields, variation, 2 * count, 1e-4, count)
        pairs += r["pairs"]
        violations += r["violations"]
        yield (f"| {family} | {patches} | {fields} | {100 * variation:.0f} % | {r['vectors']} | "
               f"{100 * r['unsure'] / r['samples']:.2f} % | {r['pairs']} | {r['violations']} | "
               f"{r['median_overestimate']:.1f} | {r['largest_error']:.1e} |")
    yield f"| all | | | | | | {pairs} | {violations} | | |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=PROGRAM)
    parser.add_argument("--audit-samples", type=int, default=280)
    arguments = parser.parse_args()
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        lines = [
            "# Clouds by the certified reduced model", "",
            f"One run, one core, {datetime.date.today()}, processor times in s; made by compare_clouds.py. Ten modes. "
            "\"Exact\" is one exact solve by Mottle on the same matrices, from the start. A cloud's time is that of the nominal "
            "solution, the training, the samples and the refinement of samples that were not certified; its cost counts "
            "samples that were not certified after refinement as exact solves. \"Vectors\" is the size of the basis.", "",
            "| model, equations | patches | fields | variation | samples | error | exact | vectors | time | refined | not certified | "
            "cost in exact solves | times faster than exact solves | largest true error of 20 |",
            "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"]
        lines += cloud_rows(arguments, folder)
        lines += [
            "", "## Audit of the bounds", "",
            f"Models of 2,000 equations, error 1e-4, {2 * arguments.audit_samples} samples each, of which "
            f"{arguments.audit_samples} were solved exactly: half of them those with the largest bounds.", "",
            "| model | patches | fields | variation | vectors | not certified | pairs | violations | median bound / error | "
            "largest true error where certified |", "|---|---|---|---|---|---|---|---|---|---|"]
        lines += audit_rows(arguments, folder)
    (HERE / "CLOUDS.md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
