"""Certified reduced models, against SciPy's eigenvalues of every sample."""

import numpy as np
import pytest

import mottle

sparse = pytest.importorskip("scipy.sparse")
from scipy.linalg import eigh  # noqa: E402


def grid(length=16, width=9, patches=4):
    """Masses in a rectangular grid, one edge held, each strip of springs with a stiffness of its own: terms of K and M."""
    index = np.arange(length * width).reshape(length, width)
    pairs = [(a, b) for rows in (zip(index[:-1].ravel(), index[1:].ravel()), zip(index[:, :-1].ravel(), index[:, 1:].ravel()))
             for a, b in rows]
    terms = [sparse.lil_matrix((index.size, index.size)) for _ in range(patches)]
    for a, b in pairs:
        term = terms[min(patches - 1, (a // width) * patches // length)]
        for i, j, value in ((a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)):
            term[i, j] += value
    held = sparse.diags(np.where(index.ravel() < width, 50.0, 0.0))
    weights = np.random.default_rng(4).uniform(0.8, 1.2, index.size)
    return [term.tocsr() for term in terms], held.tocsr(), sparse.diags(weights).tocsr()


def lognormal(samples, terms, seed, spread=0.15):
    return np.exp(spread * np.random.default_rng(seed).normal(size=(samples, terms)))


def exact(stiffness, mass, count):
    return eigh(stiffness.toarray(), mass.toarray(), subset_by_index=[0, count - 1])


def test_every_sample_is_within_its_bound():
    terms, held, mass = grid()
    model = mottle.ReducedModel(terms, [], lognormal(60, 4, 1), constant_stiffness=held, constant_mass=mass, modes=8)
    assert model.reaches_tolerance and not model.has_indefinite_terms and model.basis.shape[1] < mass.shape[0]
    samples = lognormal(20, 4, 2)
    found = model.solve(samples)
    assert found.values.shape == found.bounds.shape == (20, 8)
    assert (found.bounds <= 2e-4).mean() > 0.9
    for s, sample in enumerate(samples):
        stiffness = held + sum(a * term for a, term in zip(sample, terms))
        values, vectors = exact(stiffness, mass, 8)
        error = found.values[s] / values - 1.0
        assert (error > -1e-9).all() and (error <= found.bounds[s] + 1e-9).all()
        shapes = found.vectors(s)
        assert np.allclose(shapes.T @ (mass @ shapes), np.eye(8), atol=1e-8)
        assert np.diag(mottle.mac(shapes, vectors)).min() > 0.99


def test_far_from_the_training_the_bounds_still_hold():
    terms, held, mass = grid()
    parts = [sparse.diags(np.where(np.arange(144) < 72, 1.0, 0.0)) @ mass, sparse.diags(np.where(np.arange(144) < 72, 0.0, 1.0)) @ mass]
    model = mottle.ReducedModel([held, *terms], parts, lognormal(40, 7, 1, 0.05), modes=6, threads=1)
    samples = lognormal(10, 7, 3, 0.7)
    found = model.solve(samples, threads=1)
    for s, sample in enumerate(samples):
        stiffness = sum(a * term for a, term in zip(sample, [held, *terms]))
        values, _ = exact(stiffness, sample[5] * parts[0] + sample[6] * parts[1], 6)
        error = found.values[s] / values - 1.0
        assert (error > -1e-9).all() and (error <= found.bounds[s] + 1e-9).all()


def test_what_does_not_fit_is_refused():
    terms, held, mass = grid(6, 4, 2)
    training = lognormal(5, 2, 1)
    for arguments, options, message in [
        ((terms, [], training[:, :1]), {}, "training: shape"),
        ((terms, [], training * np.nan), {}, "not finite"),
        ((terms, [], training), {"modes": 0}, "modes"),
        ((terms, [], training), {"constant_stiffness": np.eye(24)}, "no sparse matrix"),
        ((terms, [], training), {"constant_stiffness": sparse.identity(5)}, "one size"),
        ((terms[0], [], training), {}, "constant_stiffness"),
        ((terms, [], training), {"nominal": [1.0]}, "nominal: shape"),
        ((terms, [], training), {"constant_mass": None}, "mass"),
    ]:
        with pytest.raises(mottle.InvalidInput, match=message):
            mottle.ReducedModel(*arguments, **{"constant_mass": mass, "constant_stiffness": held, **options})
    model = mottle.ReducedModel(terms, [], training, constant_mass=mass, constant_stiffness=held, modes=3)
    with pytest.raises(mottle.InvalidInput, match="2 columns"):
        model.solve(training[:, :1])
    with pytest.raises(mottle.InvalidInput, match="sample"):
        model.solve(training).vectors(5)
