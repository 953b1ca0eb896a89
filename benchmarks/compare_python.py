#!/usr/bin/python3
"""The Python package beside the command and SciPy, on one core, side by side in one run: a cloud of a million three-mass
samples by Study.propagate and by `mottle propagate`, results and report written by both; the ten lowest modes of sparse
matrices by mottle.eigsh and by scipy.sparse.linalg.eigsh (ARPACK, shift-inverted by SuperLU). Writes PYTHON.md beside this
file.

    make python; benchmarks/compare_python.py [--build FOLDER]      (Debian: python3-scipy)
"""
import argparse
import datetime
import filecmp
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import time

import peers

peers.use_one_core()
peers.choose_blas_kernels()

import numpy as np  # noqa: E402  (threads and kernels must be set first)
import scipy.sparse.linalg  # noqa: E402

import make_models  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
STUDY = HERE.parent / "examples" / "01-three-masses" / "case1.toml"
SAMPLES = 1_000_000
ROUNDS = 3
GOAL = 1.2  # of the command's time
MODELS = {"shell2k": ("shell", 2000), "shell20k": ("shell", 20000), "solid20k": ("solid", 20000)}
MODES, PATCHES, TOLERANCE, AGREEMENT = 10, 5, 1e-10, 1e-8  # those of compare_sparse.py


def command_seconds(program, folder):
    """Processor time of the command, its start included."""
    def used():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime
    before = used()
    subprocess.run([program, "propagate", STUDY, "--set", f"update.samples={SAMPLES}", "--threads", "1", "--out", folder],
                   check=True, capture_output=True)
    return used() - before


def python_seconds(mottle, folder):
    begin = time.process_time()
    mottle.Study.read(STUDY, {"update.samples": SAMPLES}).propagate(folder=folder, threads=1)
    return time.process_time() - begin


def compare_clouds(mottle, program):
    """Best processor times of the command, of Python with a folder, and of Python without."""
    times = [[], [], []]
    for _ in range(ROUNDS):
        with tempfile.TemporaryDirectory() as place:
            folders = pathlib.Path(place, "command"), pathlib.Path(place, "python")
            times[0].append(command_seconds(program, folders[0]))
            times[1].append(python_seconds(mottle, folders[1]))
            assert filecmp.cmp(folders[0] / "cloud.csv", folders[1] / "cloud.csv", shallow=False)
        times[2].append(python_seconds(mottle, None))
    return [min(each) for each in times]


def compare_modes(mottle, family, equations):
    """Equations, best processor times of mottle.eigsh, of it without the entries that are zero, and of SciPy's."""
    with tempfile.TemporaryDirectory() as place:
        deck = pathlib.Path(place, "model.bdf")
        make_models.write_model(family, equations, PATCHES, deck)
        given = mottle.read_deck(deck).matrices()[:2]
    lean = [matrix.copy() for matrix in given]
    for matrix in lean:
        matrix.eliminate_zeros()  # as compare_sparse.py gives them to the peers
    found = []

    def ours(matrices):
        return lambda: found.append(mottle.eigsh(*matrices, MODES, tolerance=TOLERANCE)[0])

    def theirs():
        found.append(np.sort(scipy.sparse.linalg.eigsh(lean[0], MODES, lean[1], sigma=0.0, tol=TOLERANCE)[0]))

    seconds = [peers.best_time(work, 4.0) for work in (ours(given), ours(lean), theirs)]
    assert all(np.allclose(each, found[0], rtol=AGREEMENT) for each in found)
    return given[0].shape[0], *seconds


def factor_of_sparse(model):
    """Of SciPy beside the engine in C++, as SPARSE.md has it."""
    found = re.search(rf"^\| {model},.*\| SciPy eigsh \(SuperLU\) \|.*\| ([0-9.]+) \|$", (HERE / "SPARSE.md").read_text(), re.M)
    return f"{found.group(1)} x" if found else ""


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--build", type=pathlib.Path, default=HERE.parent / "build" / "release")
    build = arguments.parse_args().build.resolve()
    sys.path.insert(0, str(build / "python"))
    import mottle

    command, python, alone = compare_clouds(mottle, build / "mottle")
    lines = ["# The Python package", "",
             f"Processor time on one core, best of {ROUNDS} or more, one run, {datetime.date.today().isoformat()}; "
             f"{peers.processor()}; Python {sys.version.split()[0]}, SciPy {scipy.__version__}; made by compare_python.py.", "",
             "## A cloud", "", f"{SAMPLES:,} samples of three masses, drawn, solved, and written with their report; the same "
             f"bits in cloud.csv. Goal: Python <= {GOAL} times the command.", "",
             "| contender | seconds | time / the command's time |", "|---|---|---|",
             f"| `mottle propagate` | {command:.2f} | 1 |", f"| `Study.propagate(folder=...)` | {python:.2f} | {python / command:.2f} |",
             f"| `Study.propagate()`, nothing written | {alone:.3f} | {alone / command:.2f} |", "",
             "## Modes of sparse matrices", "",
             f"The {MODES} lowest, from K and M as scipy.sparse matrices, tolerance {TOLERANCE:g}, eigenvalues that agree to "
             f"{AGREEMENT:g}. Where the equations of a node have one pattern, with zeros in it as `Deck.matrices` gives them, the "
             "ordering is found faster than without the zeros; SciPy has none. The last column is the factor of the engine in "
             "C++, in [SPARSE.md](SPARSE.md), of another run.", "",
             "| model | mottle.eigsh, s | without zeros, s | SciPy eigsh, s | SciPy's time / Mottle's | without zeros | in C++ |",
             "|---|---|---|---|---|---|---|"]
    for model, (family, equations) in MODELS.items():
        size, ours, lean, theirs = compare_modes(mottle, family, equations)
        lines.append(f"| {model}, {size} equations | {ours:.3g} | {lean:.3g} | {theirs:.3g} | {theirs / ours:.2f} x | "
                     f"{theirs / lean:.2f} x | {factor_of_sparse(model)} |")
    text = "\n".join([*lines, ""])
    (HERE / "PYTHON.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
