"""Ctrl-C where the engine is in the middle of one long step.

The signal comes at a set time and must be answered within a second; a fast machine may have ended the step, a busy one not begun.
"""

import math
import os
import subprocess
import sys

import pytest

pytest.importorskip("scipy")

BEGIN = """
import os, signal, sys, threading, time
sys.path.insert(0, os.environ["MOTTLE_PYTHON"])
import numpy as np, scipy.sparse as sparse
import mottle
def chain(n):
    return sparse.diags([2.0 * np.ones(n), -np.ones(n - 1), -np.ones(n - 1)], [0, -1, 1])
def cube(n):
    one, k = sparse.identity(n), chain(n)
    return sparse.csc_matrix(sum(sparse.kron(sparse.kron(*pair), last) for pair, last in
                                 [((k, one), one), ((one, k), one), ((one, one), k)]))
def plate(n):
    lines = ["SOL 103", "CEND", "METHOD = 1", "BEGIN BULK", "EIGRL,1,,,100", "MAT1,1,7.+10,,.3,2700.", "PSHELL,1,1,.002,1,,1"]
    lines += [f"GRID,{{1 + i * n + j}},,{{0.01 * i}},{{0.01 * j}},0." for i in range(n) for j in range(n)]
    lines += [f"CQUAD4,{{1 + i * n + j}},1,{{1 + i * n + j}},{{1 + (i + 1) * n + j}},{{2 + (i + 1) * n + j}},{{2 + i * n + j}}"
              for i in range(n - 1) for j in range(n - 1)]
    with open(os.path.join(os.environ["MOTTLE_FOLDER"], "plate.bdf"), "w") as file:
        file.write("\\n".join([*lines, "ENDDATA", ""]))
    return file.name
{make}
sent = []
def interrupt():
    sent.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)
threading.Timer({wait}, interrupt).start()
begin = time.monotonic()
try:
    {call}
    print("done after", time.monotonic() - begin)
except KeyboardInterrupt:
    print("interrupted", time.monotonic() - sent[0])
small = chain(50).tocsc(), sparse.identity(50, format="csc")
print(mottle.eigsh(*small, 1)[0][0])
while True:  # until what was left to itself has ended
    used = time.process_time()
    time.sleep(0.3)
    if time.process_time() - used < 0.03:
        break
print("at rest", time.monotonic() - begin)
"""

JOBS = {
    "a factorisation": ("k = cube(48); m = sparse.identity(k.shape[0], format='csc')", "mottle.eigsh(k, m, 20)"),
    "steps of Lanczos": ("k = chain(200000).tocsc(); m = sparse.identity(200000, format='csc')", "mottle.eigsh(k, m, 300)"),
    "modes": ("deck = plate(120)", "mottle.modes(deck)"),
    "targets": ("deck = plate(120)", "mottle.targets(deck)"),
    "training": ("k = cube(40); m = sparse.identity(k.shape[0], format='csc')",
                 "mottle.ReducedModel([k, m], [], np.ones((5, 2)), constant_mass=m)"),
}


@pytest.mark.parametrize("job", JOBS)
def test_control_c_is_raised_at_once(job, tmp_path):
    make, call = JOBS[job]
    done = subprocess.run([sys.executable, "-c", BEGIN.format(make=make, call=call, wait=0.4)], capture_output=True, text=True,
                          check=False, timeout=120, env={**os.environ, "MOTTLE_FOLDER": str(tmp_path)})
    assert done.returncode == 0, done.stderr
    first, second, last = done.stdout.splitlines()
    word, seconds = first.rsplit(" ", 1)
    assert word == "interrupted", first
    # 0.1 s on a quiet machine, and 0.2 s is what is promised there; others may be at work here.
    assert float(seconds) < 1.0 * float(os.environ.get("MOTTLE_TEST_PATIENCE", "1"))
    assert abs(float(second) - (2.0 - 2.0 * math.cos(math.pi / 51))) < 1e-9
    assert last.startswith("at rest")
