"""Eight Python threads at once: each gets the bits that it would get alone."""

import threading

import numpy as np
import pytest

import mottle
from at_once import assert_alone_and_at_once_alike, at_once, same
from test_functions import NOISE, PARAMETERS, TESTS, frequencies, update
from test_studies import TESTS as TABLE
from test_studies import three_masses

sparse = pytest.importorskip("scipy.sparse")

THREADS = 8
LEAST = {
    "abc": {"simulations": 2000, "calibration_sets": 100},
    "bayes": {"particles": 100},
    "hierarchical": {"particles": 100, "decorrelation": 0.9},
    "mixture": {"bootstrap_samples": 99, "starts": 1},
}


def cube(n):
    line, one = sparse.diags([2.0 * np.ones(n), -np.ones(n - 1), -np.ones(n - 1)], [0, -1, 1]), sparse.identity(n)
    return sparse.csc_matrix(sum(sparse.kron(sparse.kron(*pair), last) for pair, last in
                                 [((line, one), one), ((one, line), one), ((one, one), line)]))


def test_functions_are_called_on_the_thread_that_asked():
    def one():
        seen = set()

        def model(samples):
            seen.add(threading.get_ident())
            return frequencies(samples)

        found = update(model, samples=200)
        assert seen == {threading.get_ident()}
        return found.mean, found.covariance

    assert same(at_once(*[one] * THREADS))


@pytest.mark.parametrize("method", sorted(mottle.methods()))
def test_every_method_gives_the_bits_that_it_gives_alone(method):
    """With the least work of each; the usual one is in nightly/test_eight_threads.py."""
    assert_alone_and_at_once_alike(method, LEAST.get(method, {}), threads=3)


def test_surrogates_give_the_bits_that_they_give_alone():
    for kind in ("kriging", "chaos", "quadratic"):
        def one():
            found = update(frequencies, surrogate=mottle.Surrogate(kind=kind, runs=30, rounds=1), samples=100)
            return found.mean, found.covariance

        assert same([one(), *at_once(*[one] * THREADS)]), kind


def test_modes_of_large_matrices_have_the_bits_that_they_have_alone():
    """METIS takes its random numbers from one source for the whole process."""
    stiffness, mass = cube(22), sparse.identity(22**3, format="csc")
    assert same([mottle.eigsh(stiffness, mass, 4), *at_once(*[lambda: mottle.eigsh(stiffness, mass, 4)] * THREADS)])


def test_counted_modes_have_the_bits_that_they_have_alone():
    stiffness, mass = cube(8), sparse.identity(8**3, format="csc")
    works = [lambda: mottle.eigsh(stiffness, mass, 4, verify=True)] * THREADS
    assert same([works[0](), *at_once(*works)])


def test_studies_files_and_routines_at_once(tmp_path):
    shapes = np.random.default_rng(1).normal(size=(30, 4))
    chain, one = cube(5), sparse.identity(125, format="csc")
    mottle.write_matrix(tmp_path / "k.mtx", chain)
    mottle.write_uff(tmp_path / "a.uff", mottle.UffFile(shapes=[mottle.UffShape(range(1, 31), np.ones((30, 3)))]))

    def file_round(place):
        file = tmp_path / f"{place}.op4"
        mottle.write_matrix(file, {"K": chain})
        return (mottle.read_matrix(file).values.toarray(),)

    works = [
        lambda: (mottle.Study.from_dict(three_masses(), tests=TABLE).update().mean,),
        lambda: (mottle.Study.from_dict(three_masses(), tests=TABLE).propagate().cloud.outputs,),
        lambda: (mottle.mac(shapes, shapes),),
        lambda: (mottle.read_matrix(tmp_path / "k.mtx").values.toarray(),),
        lambda: (mottle.read_uff(tmp_path / "a.uff").shapes[0].values,),
        lambda: (mottle.reml(TESTS, noise=NOISE).mean,),
        lambda: (mottle.ReducedModel([chain, one], [], np.ones((3, 2)), constant_mass=one, modes=2).solve(np.ones((9, 2))).values,),
    ]
    alone = [work() for work in works]
    for _ in range(3):
        for given, found in zip(alone, at_once(*works)):
            assert same([given, found])
    at_once(*[lambda place=place: file_round(place) for place in range(THREADS)])


def test_one_result_is_read_by_all():
    result = update(frequencies)

    def read():
        result.to_dict()
        return result.mean, result.cloud_final.outputs, result.covariance

    assert same(at_once(*[read] * THREADS))


def test_one_exception_is_that_of_its_thread():
    def failing(number):
        def model(samples):
            raise ValueError(f"of thread {number}")

        with pytest.raises(ValueError, match=f"of thread {number}$"):
            update(model)
        return (np.zeros(1),)

    at_once(*[lambda number=number: failing(number) for number in range(THREADS)])


def test_updates_within_an_update():
    """A model may be one that updates, in its own thread or in others."""
    inner = update(frequencies, samples=50)

    def model(samples):
        found = at_once(*[lambda: (update(frequencies, samples=50).mean,)] * 2)
        assert np.array_equal(found[0][0], inner.mean)
        assert np.array_equal(update(frequencies, samples=50).mean, inner.mean)
        return frequencies(samples)

    found = mottle.update(model, PARAMETERS, (["f1", "f2", "f3"], TESTS), repeatability=NOISE, samples=50, iterations=3)
    assert np.array_equal(found.mean, update(frequencies, samples=50, iterations=3).mean)
