"""Routines that stand alone, against SciPy and closed forms."""

import numpy as np
import pytest

import mottle

sparse = pytest.importorskip("scipy.sparse")
from scipy import stats  # noqa: E402
from scipy.optimize import linear_sum_assignment  # noqa: E402
from scipy.sparse.linalg import eigsh  # noqa: E402


def chain(n, is_free=False):
    stiffness = sparse.diags([-np.ones(n - 1), 2.0 * np.ones(n), -np.ones(n - 1)], [-1, 0, 1]).tolil()
    stiffness[n - 1, n - 1] = 1.0
    if is_free:
        stiffness[0, 0] = 1.0
    return stiffness.tocsr(), sparse.identity(n, format="csr")


def test_eigsh_of_a_chain_in_closed_form():
    stiffness, mass = chain(500)
    values, vectors = mottle.eigsh(stiffness, mass, 12, verify=True)
    mode = np.arange(1, 13)
    assert np.allclose(values, 4.0 * np.sin((2 * mode - 1) * np.pi / (4 * 500 + 2)) ** 2, rtol=1e-10)
    assert np.allclose(vectors.T @ (mass @ vectors), np.eye(12), atol=1e-10)


def test_eigsh_beside_scipy():
    rng = np.random.default_rng(1)
    stiffness, _ = chain(300)
    mass = sparse.diags(rng.uniform(0.5, 2.0, 300))
    values, _ = mottle.eigsh(stiffness, mass, 8)
    assert np.allclose(values, np.sort(eigsh(stiffness.tocsc(), 8, mass.tocsc(), sigma=-1e-3)[0]), rtol=1e-9)


def test_eigsh_finds_rigid_bodies_and_repeated_roots():
    stiffness, mass = chain(200, is_free=True)
    twice = sparse.block_diag([stiffness, stiffness]).tocsr()
    values, _ = mottle.eigsh(twice, sparse.identity(400), 6, verify=True)
    mode = np.repeat([0, 1, 2], 2)
    assert np.allclose(values, 4.0 * np.sin(mode * np.pi / 400) ** 2, atol=1e-9)


def test_eigsh_refuses_what_it_cannot_take():
    stiffness, mass = chain(5)
    for arguments, message in [((np.eye(5), mass, 1), "no sparse matrix"), ((stiffness, sparse.identity(4), 1), "one size"),
                               ((stiffness, mass, 6), "outside 1 to 5"), ((stiffness * np.nan, mass, 1), "not finite")]:
        with pytest.raises(mottle.InvalidInput, match=message):
            mottle.eigsh(*arguments)


def test_eigsh_refuses_an_indefinite_mass():
    stiffness, _ = chain(50)
    masses = np.ones(50)
    masses[40:] = -0.04
    with pytest.raises(mottle.InvalidInput, match=r"the diagonal entry of row 40 \(counted from 0\) is -0.04"):
        mottle.eigsh(stiffness, sparse.diags(masses), 3)
    coupled = sparse.diags([np.full(49, 0.6), np.ones(50), np.full(49, 0.6)], [-1, 0, 1])  # lowest eigenvalue 1 - 1.2 cos(pi / 51)
    with pytest.raises(mottle.InvalidInput, match="the mass matrix is not positive semidefinite: the pivot of row"):
        mottle.eigsh(stiffness, coupled, 3)


def test_mac_and_assignment():
    rng = np.random.default_rng(2)
    a, b = rng.normal(size=(30, 5)), rng.normal(size=(30, 7))
    wanted = (a.T @ b) ** 2 / np.outer((a**2).sum(0), (b**2).sum(0))
    found = mottle.mac(a, b)
    assert np.allclose(found, wanted, rtol=1e-12)
    rows, columns = linear_sum_assignment(-wanted)
    assert np.isclose(found[np.arange(5), mottle.assign(found)].sum(), wanted[rows, columns].sum())
    assert np.allclose(mottle.mac(a[:, 0], b[:, 1]), wanted[:1, 1:2], rtol=1e-12)
    with pytest.raises(mottle.InvalidInput, match="degrees of freedom"):
        mottle.mac(a, b[:-1])
    with pytest.raises(mottle.InvalidInput, match="mac: a holds complex"):
        mottle.mac(a + 1j, b)


def test_hotelling_beside_its_definition():
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=(12, 3)), rng.normal(size=(20, 3)) + 0.3
    pooled = (11 * np.cov(a, rowvar=False) + 19 * np.cov(b, rowvar=False)) / 30
    apart = a.mean(0) - b.mean(0)
    t_squared = 12 * 20 / 32 * apart @ np.linalg.solve(pooled, apart)
    found = mottle.hotelling(a, b)
    assert np.isclose(found.t_squared, t_squared, rtol=1e-12)
    assert np.isclose(found.p_value, stats.f.sf(t_squared * 28 / (30 * 3), 3, 28), rtol=1e-10)


def test_methods_have_options():
    found = mottle.methods()
    assert {"maximum-likelihood", "mares", "bayes"} <= set(found)
    assert found["bayes"]["options"]["particles"]["default"] == "1000"


def test_nodes_are_found_without_the_zeros_of_their_blocks(examples):
    """As SciPy leaves them out: the same modes, and as few steps."""
    stiffness, mass, _ = mottle.read_deck(examples / "02-airframe" / "airframe.bdf").matrices()
    lean = [matrix.copy() for matrix in (stiffness, mass)]
    for matrix in lean:
        matrix.eliminate_zeros()
    assert lean[0].nnz < stiffness.nnz
    values, shapes = mottle.eigsh(stiffness, mass, 12)
    found, modes = mottle.eigsh(*lean, 12)
    assert np.allclose(found[6:], values[6:], rtol=1e-9)
    assert np.allclose(np.diag(mottle.mac(shapes[:, 6:], modes[:, 6:])), 1.0, atol=1e-6)
