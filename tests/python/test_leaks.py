"""Memory stays as it is over many calls; MOTTLE_TEST_CALLS sets their number."""

import os

import numpy as np
import pytest

import mottle
from test_functions import NOISE, PARAMETERS, TESTS, frequencies
from test_studies import TESTS as TABLE
from test_studies import three_masses

sparse = pytest.importorskip("scipy.sparse")


def resident():
    """Bytes of this process in memory."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


CHAIN = sparse.diags([2.0 * np.ones(60), -np.ones(59), -np.ones(59)], [0, -1, 1]).tocsc()
ONE = sparse.identity(60, format="csc")
SHAPES = np.random.default_rng(1).normal(size=(300, 6))
MODEL = mottle.ReducedModel([CHAIN, ONE], [], np.ones((3, 2)), constant_mass=ONE, modes=2, threads=1)
UFF = mottle.UffFile(shapes=[mottle.UffShape(range(1, 301), np.ones((300, 3)))])


def raising(samples):
    raise ArithmeticError("on purpose")


def write_and_read(folder):
    mottle.write_uff(folder / "a.uff", UFF)
    return mottle.read_uff(folder / "a.uff").shapes[0].values


def update(model):
    return mottle.update(model, PARAMETERS, (["f1", "f2", "f3"], TESTS), repeatability=NOISE, samples=20, iterations=3, threads=1)


def refused():
    with pytest.raises(ArithmeticError):
        update(raising)


CALLS = {
    "update": (1, lambda folder: update(frequencies).mean),
    "a function that raises": (10, lambda folder: refused()),
    "eigsh": (10, lambda folder: mottle.eigsh(CHAIN, ONE, 3)),
    "mac": (20, lambda folder: mottle.mac(SHAPES, SHAPES)),
    "from_dict": (5, lambda folder: mottle.Study.from_dict(three_masses(), tests=TABLE)),
    "reml": (5, lambda folder: mottle.reml(TESTS, noise=NOISE)),
    "reduced model": (10, lambda folder: MODEL.solve(np.ones((50, 2)), threads=1).vectors(0)),
    "universal file": (2, lambda folder: write_and_read(folder)),
}


@pytest.mark.parametrize("name", CALLS)
def test_memory_is_constant(name, tmp_path):
    portion, call = CALLS[name]
    calls = int(os.environ.get("MOTTLE_TEST_CALLS", "0")) or 40 * portion

    def repeat(count):
        for _ in range(count):
            call(tmp_path)

    repeat(min(calls // 2, 500))  # caches, arenas and the interpreter's own lists are filled
    before = resident()
    repeat(calls)
    grown = resident() - before
    print(f"{name}: {grown} bytes over {calls} calls")
    assert grown < 2**21, f"{grown} bytes over {calls} calls"  # 2 MB; a leak of one result a call is more in 10,000
