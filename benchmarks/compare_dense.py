#!/usr/bin/python3
"""The ten lowest modes with vectors of many dense pencils, on one core: Mottle's batches beside LAPACK (OpenBLAS) and
Eigen in one program, and beside NumPy's batched solvers on the same matrices. Writes DENSE.md beside this file.

    make bench; benchmarks/compare_dense.py [--seconds S] [ORDER...]      ORDER... writes no file
"""
import argparse
import datetime
import json
import pathlib
import subprocess
import tempfile

import peers

peers.use_one_core()
peers.choose_blas_kernels()

import numpy as np  # noqa: E402  (threads and kernels must be set first)

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = HERE.parent / "build" / "release" / "benchmarks" / "mottle_dense_benchmark"
ORDERS = [20, 40, 80, 120, 200, 400]
GOALS = {"standard": 8, "generalised": 4}  # times faster than the best of LAPACK and Eigen
TITLES = {"standard": "Constant mass", "generalised": "Parametric mass"}


def numpy_standard(stiffness, _, modes):
    values, vectors = np.linalg.eigh(stiffness)
    return values[:, :modes], vectors[:, :, :modes]


def numpy_generalised(stiffness, mass, modes):
    inverse = np.linalg.inv(np.linalg.cholesky(mass))
    values, vectors = np.linalg.eigh(inverse @ stiffness @ inverse.transpose(0, 2, 1))
    return values[:, :modes], inverse.transpose(0, 2, 1) @ vectors[:, :, :modes]


def time_numpy(folder, table, modes, seconds):
    kind = table["name"].rstrip("0123456789")
    shape = (table["samples"], table["order"], table["order"])
    stiffness = np.fromfile(folder / f"{table['name']}.stiffness").reshape(shape)
    mass = np.fromfile(folder / f"{table['name']}.mass")
    mass = mass.reshape(shape) if mass.size else None
    solve = {"standard": numpy_standard, "generalised": numpy_generalised}[kind]
    error = np.abs(solve(stiffness[:1], None if mass is None else mass[:1], modes)[0][0] / table["values"] - 1.0).max()
    best = peers.best_time(lambda: solve(stiffness, mass, modes), seconds / 4)
    return {"name": "NumPy, batched eigh", "seconds": best / table["samples"], "error": error}


def rows_of(table, kind):
    ours, *others = table["contenders"]
    best = min(c["seconds"] for c in others if "NumPy" not in c["name"])
    for c in table["contenders"]:
        ratio = best / ours["seconds"] if c is ours else c["seconds"] / ours["seconds"]
        note = f"{ratio:.1f} x faster than the best of LAPACK and Eigen (goal {GOALS[kind]})" if c is ours \
            else f"{ratio:.1f}"
        yield f"| {table['order']} | {c['name']} | {1e6 * c['seconds']:.1f} | {note} | {c['error']:.0e} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=PROGRAM)
    parser.add_argument("--seconds", type=float, default=6.0, help="of each order and kind, for all contenders")
    parser.add_argument("orders", nargs="*", type=int, metavar="ORDER")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        words = [arguments.program, place, arguments.seconds, *(arguments.orders or ORDERS)]
        output = subprocess.run([str(word) for word in words], check=True, text=True, stdout=subprocess.PIPE).stdout
        result = json.loads(output)
        for table in result["tables"]:
            numpy_row = time_numpy(pathlib.Path(place), table, result["modes"], arguments.seconds)
            table["contenders"].append(numpy_row)
    lines = ["# The lowest modes of small dense pencils", "",
             f"The {result['modes']} lowest modes with vectors, the same matrices for all contenders. Processor time per sample on "
             f"one core, the shortest of several repeats, one run, {datetime.date.today().isoformat()}; "
             f"{peers.processor()}, OpenBLAS kernels {result['blas_kernel']}, Eigen compiled with -march=native; made "
             "by compare_dense.py. The model is a rod of five sections in a rotated basis, so that every matrix is full.", "",
             "Mottle starts from the coefficients of a sample: its time includes the sums of the five terms (and of the "
             "five of the mass) and the reduction of a constant mass, once for all samples. The peers get each sample's "
             "assembled matrices, with a constant mass already reduced to the standard problem. Errors are "
             "the largest relative errors of the ten eigenvalues, compared with Eigen in 80-bit arithmetic from the same "
             "terms. The rounding of the matrices themselves gives errors of the order of 1e-16 times highest over lowest "
             "eigenvalue, which no solver can avoid.", ""]
    for kind, title in TITLES.items():
        lines += [f"## {title}", "", "| order | contender | us per sample | time / Mottle's time | error |",
                  "|---|---|---|---|---|"]
        for table in result["tables"]:
            if table["name"].startswith(kind):
                lines += rows_of(table, kind)
        lines.append("")
    print("\n".join(lines))
    if not arguments.orders:
        (HERE / "DENSE.md").write_text("\n".join(lines))


if __name__ == "__main__":
    main()
