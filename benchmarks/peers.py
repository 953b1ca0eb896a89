"""What the comparisons share: one core, one thread, the BLAS kernels that fit the processor, clocks. Import it before
numpy, which reads the environment when it loads."""
import glob
import os
import pathlib
import subprocess
import sys
import time

CORE = max(os.sched_getaffinity(0))
FLAGS = pathlib.Path("/proc/cpuinfo").read_text()
CORE_NAME = "import ctypes; f = ctypes.CDLL('libopenblas.so.0').openblas_get_corename; " \
            "f.restype = ctypes.c_char_p; print(f().decode())"


def use_one_core():
    os.sched_setaffinity(0, {CORE})
    # CHOLMOD asks OpenMP for four threads whatever OMP_NUM_THREADS says; on one core they only wait for each other.
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "OMP_THREAD_LIMIT"):
        os.environ[name] = "1"


def choose_blas_kernels():
    """As src/linalg/dense/blas_kernels.cpp does: other kernels only where OpenBLAS takes the processor for its oldest."""
    found = subprocess.run(["/usr/bin/python3", "-c", CORE_NAME], capture_output=True, text=True, check=False).stdout
    if "OPENBLAS_CORETYPE" not in os.environ and found.strip() == "Prescott":
        if " avx512f" in FLAGS and " avx512vl" in FLAGS:
            os.environ["OPENBLAS_CORETYPE"] = "SKYLAKEX"
        elif " avx2" in FLAGS:
            os.environ["OPENBLAS_CORETYPE"] = "HASWELL"


def find_petsc():
    """Debian keeps these packages where Python does not look."""
    sys.path += glob.glob("/usr/lib/petscdir/*/*-real/lib/python3/dist-packages")
    sys.path += glob.glob("/usr/lib/slepcdir/*/*-real/lib/python3/dist-packages")


def processor():
    names = [line.split(":")[1].strip() for line in FLAGS.splitlines() if line.startswith("model name")]
    sets = [name for name in ("avx2", "fma", "avx512f", "avx512dq", "avx512vl") if f" {name}" in FLAGS]
    return f"{names[0] if names else os.uname().machine} ({', '.join(sets) or 'no AVX'})"


def best_time(work, budget):
    """Best processor time of calls that fill the budget, three at least."""
    best, end, calls = float("inf"), time.process_time() + budget, 0
    while calls < 3 or time.process_time() < end:
        start = time.process_time()
        work()
        best, calls = min(best, time.process_time() - start), calls + 1
    return best
