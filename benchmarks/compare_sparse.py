#!/usr/bin/python3
"""One exact solve for the ten lowest modes of sparse models, on one core, side by side in one run: Mottle, Spectra on
our CHOLMOD factor and on its default, SciPy's eigsh (ARPACK on SuperLU), Octave's eigs, ARPACK on PETSc's CHOLMOD factor,
SLEPc's Krylov-Schur on PETSc's CHOLMOD and MUMPS factors. All get the matrices that Mottle assembled, and all results
must agree. Writes SPARSE.md beside this file.

    make bench; benchmarks/compare_sparse.py [--all] [--program FILE] [MODEL...]

--all adds the peers that need minutes for a large model; MODEL... takes these models only and writes no file.
Debian: libspectra-dev, octave, python3-scipy, python3-petsc4py-real, python3-slepc4py-real; a peer that is missing is
left out of the table.
"""
import argparse
import datetime
import json
import pathlib
import shutil
import subprocess
import tempfile
import time

import peers

peers.use_one_core()
peers.choose_blas_kernels()
peers.find_petsc()

import numpy as np  # noqa: E402  (threads and kernels must be set first)
import scipy.sparse  # noqa: E402
import scipy.sparse.linalg  # noqa: E402

import make_models  # noqa: E402

try:
    import petsc4py
    petsc4py.init(["compare", "-mat_mumps_icntl_7", "5"])  # METIS
    from petsc4py import PETSc
except ImportError:
    PETSc = None
try:
    from slepc4py import SLEPc
except ImportError:
    SLEPc = None

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = HERE.parent / "build" / "release" / "benchmarks" / "mottle_sparse_benchmark"
SPECTRA = PROGRAM.with_name("mottle_spectra_benchmark")
OCTAVE = shutil.which("octave-cli")
MODELS = {"shell2k": ("shell", 2000), "shell20k": ("shell", 20000), "shell100k": ("shell", 100000),
          "solid20k": ("solid", 20000), "solid100k": ("solid", 100000)}
MODES = 10
PATCHES = 5
TOLERANCE = 1e-10  # of all contenders: residual of the shift-inverted problem, relative
AGREEMENT = 1e-8   # of eigenvalues, relative
BUDGET = 10.0      # s a contender and model; one call at least


def read_matrix(folder, name):
    starts = np.fromfile(folder / f"{name}.starts", np.int32)
    rows = np.fromfile(folder / f"{name}.rows", np.int32)
    values = np.fromfile(folder / f"{name}.values", np.float64)
    lower = scipy.sparse.csc_matrix((values, rows, starts), shape=(len(starts) - 1,) * 2)
    matrix = (lower + scipy.sparse.tril(lower, -1).T).tocsc()
    matrix.eliminate_zeros()  # a lumped M keeps the pattern of K in the engine; the peers need not carry that
    return matrix


def scipy_superlu(stiffness, mass):
    def solve():
        return scipy.sparse.linalg.eigsh(stiffness, MODES, mass, sigma=0.0, tol=TOLERANCE)[0]
    return solve


def petsc_matrix(matrix):
    rows = matrix.tocsr()
    result = PETSc.Mat().createAIJ(rows.shape, csr=(rows.indptr, rows.indices, rows.data))
    result.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    result.setOption(PETSc.Mat.Option.SPD, True)
    return result


def use_cholesky(solver, package):
    solver.setType("preonly")
    solver.getPC().setType("cholesky")
    solver.getPC().setFactorSolverType(package)


def arpack_on_petsc(package):
    def prepare(stiffness, mass):
        operator = petsc_matrix(stiffness)
        right, left = operator.createVecs()

        def solve():
            solver = PETSc.KSP().create()
            solver.setOperators(operator)
            use_cholesky(solver, package)
            solver.setUp()

            def apply(vector):
                right.array = vector
                solver.solve(right, left)
                return left.array.copy()
            inverse = scipy.sparse.linalg.LinearOperator(stiffness.shape, apply, dtype=float)
            values = scipy.sparse.linalg.eigsh(stiffness, MODES, mass, sigma=0.0, OPinv=inverse, tol=TOLERANCE)[0]
            solver.destroy()
            return values
        return solve
    return prepare


def slepc(package):
    def prepare(stiffness, mass):
        operators = petsc_matrix(stiffness), petsc_matrix(mass)

        def solve():
            problem = SLEPc.EPS().create()
            problem.setOperators(*operators)
            problem.setProblemType(SLEPc.EPS.ProblemType.GHEP)
            problem.setType("krylovschur")
            problem.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
            problem.setTarget(0.0)
            problem.setDimensions(MODES)
            problem.setTolerances(TOLERANCE)
            problem.getST().setType("sinvert")
            use_cholesky(problem.getST().getKSP(), package)
            problem.solve()
            vector = operators[0].createVecRight()
            values = [problem.getEigenpair(i, vector).real for i in range(problem.getConverged())]
            problem.destroy()
            return np.array(values)[:MODES]
        return solve
    return prepare


def timed(prepare):
    """A contender of this process: folder, matrices -> its best time and eigenvalues."""
    return lambda _, stiffness, mass: best_time(prepare(stiffness, mass))


def program(*command):
    """A contender that is a program of its own; {} stands for the folder with the matrices."""
    def run(folder, *_):
        words = [str(word).format(folder) for word in command]
        output = subprocess.run(words, check=True, text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout
        result = json.loads(output)
        return result["seconds"], np.array(result["eigenvalues"])
    return run


def spectra(factor):
    return program(SPECTRA, "{}", MODES, factor, BUDGET)


# name, what runs it, whether it is there, models that take it minutes
CONTENDERS = [
    ("Spectra on our CHOLMOD factor", spectra("cholmod"), SPECTRA.exists(), ()),
    ("Spectra (Eigen's SparseLU)", spectra("default"), SPECTRA.exists(), ("shell100k", "solid100k")),
    ("SciPy eigsh (SuperLU)", timed(scipy_superlu), True, ("shell100k", "solid100k")),
    ("Octave eigs", program(OCTAVE, "-q", "--no-history", "--norc", HERE / "octave_modes.m", "{}", MODES, BUDGET),
     OCTAVE, ("solid100k",)),
    ("ARPACK on PETSc's CHOLMOD", timed(arpack_on_petsc("cholmod")), PETSc, ()),
    ("SLEPc on CHOLMOD", timed(slepc("cholmod")), SLEPc, ()),
    ("SLEPc on MUMPS", timed(slepc("mumps")), SLEPc, ()),
]


def best_time(solve):
    """Best processor time of one to five calls, as many as fit into the budget, and the eigenvalues."""
    best, spent = float("inf"), 0.0
    for _ in range(5):
        start = time.process_time()
        values = solve()
        elapsed = time.process_time() - start
        best, spent = min(best, elapsed), spent + elapsed
        if spent + best > BUDGET:
            break
    return best, np.sort(values)


def run_program(program, family, equations, patches, folder):
    deck = folder / "model.bdf"
    make_models.write_model(family, equations, patches, deck)
    subprocess.run([program, deck, str(patches), "E", str(MODES), folder, str(BUDGET)], check=True)
    return json.loads((folder / "result.json").read_text())


def check(model, name, values, expected):
    worst = np.abs(values / expected - 1.0).max() if len(values) == len(expected) else np.inf
    if not worst <= AGREEMENT:
        raise SystemExit(f"{model}: {name} and Mottle differ by {worst:.1e} in an eigenvalue:\n{values}\n{expected}")


def contender_rows(model, mottle, folder, everything):
    stiffness, mass = read_matrix(folder, "K"), read_matrix(folder, "M")
    for name, run, is_there, slow in CONTENDERS:
        if not is_there:
            yield f"| {name} | not installed | |"
        elif model in slow and not everything:
            yield f"| {name} | left out: minutes | |"
        else:
            seconds, values = run(folder, stiffness, mass)
            check(model, name, values, np.array(mottle["eigenvalues"]))
            yield f"| {name} | {seconds:.3g} | {seconds / mottle['cold_s']:.2f} |"


def compare(model, arguments):
    """Rows of the table of one model."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        mottle = run_program(arguments.program, *MODELS[model], PATCHES, folder)
        size = f"{model}, {mottle['equations']} equations"
        yield f"| {size} | Mottle | {mottle['cold_s']:.3g} | 1 |"
        yield f"| {size} | Mottle, a further sample, K(x) and M(x) included | {mottle['sample_s']:.3g} " \
              f"| {mottle['sample_s'] / mottle['cold_s']:.2f} |"
        for row in contender_rows(model, mottle, folder, arguments.all):
            yield f"| {size} {row}"


def deck_row(program, model, family, equations, patches):
    with tempfile.TemporaryDirectory() as folder:
        m = run_program(program, family, equations, patches, pathlib.Path(folder))
    ratio = (m["read_s"] + m["assembly_s"]) / m["factor_first_s"]
    return f"| {model}, {m['equations']} equations | {m['read_s']:.3g} | {m['assembly_s']:.3g} " \
           f"| {m['factor_first_s']:.3g} | {m['factor_s']:.3g} | {ratio:.2f} |", m["blas_kernel"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--program", type=pathlib.Path, default=PROGRAM)
    parser.add_argument("models", nargs="*", choices=[[], *MODELS], metavar="MODEL")
    arguments = parser.parse_args()
    table = []
    for model in arguments.models or MODELS:
        for row in compare(model, arguments):
            print(row, flush=True)
            table.append(row)
    if arguments.models:
        return
    decks = [deck_row(arguments.program, "shell100k", "shell", 100000, PATCHES),
             deck_row(arguments.program, "cube100k", "cube", 100000, 1)]
    lines = ["# One exact solve of a sparse model", "",
             f"The {MODES} lowest modes from assembled K and M, ordering, factorisation and vectors included; the same "
             f"matrices, tolerance {TOLERANCE:g}, and eigenvalues that agree to {AGREEMENT:g} for all. Processor time "
             f"on one core, best of one to five, one run, {datetime.date.today().isoformat()}; {peers.processor()}, OpenBLAS "
             f"kernels {decks[0][1]}; made by compare_sparse.py, models by make_models.py.", "",
             "| model | contender | seconds | time / Mottle's time |", "|---|---|---|---|", *table, "",
             "From the deck's file to K and M, against one factorisation of K (with its ordering, and again without):",
             "", "| model | read, s | assemble, s | factorise, s | again, s | (read + assemble) / factorise |",
             "|---|---|---|---|---|---|", *(row for row, _ in decks), ""]
    (HERE / "SPARSE.md").write_text("\n".join(lines))
    print("\n".join(lines))


if __name__ == "__main__":
    main()
