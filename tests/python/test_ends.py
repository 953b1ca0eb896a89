"""The interpreter ends while daemon threads run jobs: the process ends too, without a word.

It must within 30 s, five of which it may wait for a job that does not stop.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

BEGIN = """
import atexit, os, sys, threading, time
sys.path[:0] = [os.environ["MOTTLE_PYTHON"], os.environ["MOTTLE_TESTS"]]
import numpy as np
import mottle
from test_functions import frequencies, update
from test_studies import TESTS, three_masses
def long_study():
    return mottle.Study.from_dict(three_masses(update=dict(samples=2000000, iterations=40)), tests=TESTS)
begun = threading.Event()
def slow(samples):
    begun.set()
    time.sleep({seconds})
    return frequencies(samples)
def run():
    {job}
threading.Thread(target=run, daemon=True).start()
begun.wait(10)
time.sleep({wait})
print("main ends", flush=True)
"""

JOBS = {
    "a study's job": ("long_study().update(progress=lambda *_: begun.set())", 0.0, 0.3),
    "a model that is called often": ("update(slow, method='bayes')", 0.02, 0.5),
    "a model that does not come back": ("update(slow)", 1000.0, 0.2),
    "progress": ("long_study().update(progress=lambda *_: (begun.set(), time.sleep(0.02)))", 0.0, 0.3),
    "progress that does not come back": ("long_study().update(progress=lambda *_: (begun.set(), time.sleep(1000.0)))", 0.0, 0.1),
    "results that are written": ("result = mottle.Study.from_dict(three_masses(), tests=TESTS).update(); begun.set()\n"
                                 "    while True: result.save(os.environ['MOTTLE_FOLDER']); result._engine.result_text()",
                                 0.0, 0.7),
    "jobs one after the other": ("begun.set()\n    while True: update(frequencies, samples=20)", 0.0, 0.7),
    "a job without a stop": ("import scipy.sparse as s; n = 150000; begun.set(); mottle.eigsh("
                             "s.diags([2.0 * np.ones(n), -np.ones(n - 1), -np.ones(n - 1)], [0, -1, 1]).tocsc(), "
                             "s.identity(n, format='csc'), 400)", 0.0, 1.0),
}


@pytest.mark.parametrize("job", JOBS)
def test_the_process_ends_quietly(job, tmp_path):
    call, seconds, wait = JOBS[job]
    if "scipy" in call:
        pytest.importorskip("scipy")
    patience = float(os.environ.get("MOTTLE_TEST_PATIENCE", "1"))
    begin = time.monotonic()
    done = subprocess.run([sys.executable, "-c", BEGIN.format(job=call, seconds=seconds, wait=wait)], capture_output=True,
                          text=True, check=False, timeout=60 * patience,
                          env={**os.environ, "MOTTLE_TESTS": str(Path(__file__).parent), "MOTTLE_FOLDER": str(tmp_path)})
    assert (done.returncode, done.stdout, done.stderr) == (0, "main ends\n", "")
    assert time.monotonic() - begin < 30 * patience  # five seconds for a job that does not stop


@pytest.mark.parametrize("is_forked", [False, True])
def test_what_is_begun_after_the_end_is_refused(is_forked):
    """A function that was registered before the import runs after Mottle's own end."""
    script = f"""
import atexit, os, sys
def last():
    child = os.fork() if {is_forked} else 0
    if child:
        os.waitpid(child, 0)
        return
    try:
        update(frequencies)
    except RuntimeError as error:
        print(error)
atexit.register(last)
sys.path[:0] = [os.environ["MOTTLE_PYTHON"], os.environ["MOTTLE_TESTS"]]
from test_functions import frequencies, update
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False, timeout=60,
                          env={**os.environ, "MOTTLE_TESTS": str(Path(__file__).parent)})
    said = "" if is_forked else "Python is ending, and Mottle has ended: nothing more is computed\n"
    assert (done.returncode, done.stdout, done.stderr) == (0, said, "")


def test_the_main_thread_may_work_at_exit():
    script = """
import atexit, os, sys
sys.path[:0] = [os.environ["MOTTLE_PYTHON"], os.environ["MOTTLE_TESTS"]]
import mottle
from test_functions import frequencies, update
atexit.register(lambda: print(update(frequencies).verdict))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False, timeout=60,
                          env={**os.environ, "MOTTLE_TESTS": str(Path(__file__).parent)})
    assert (done.returncode, done.stdout, done.stderr) == (0, "adequate\n", "")
