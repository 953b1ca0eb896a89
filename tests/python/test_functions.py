"""A model that is a Python function."""

import threading

import numpy as np
import pytest

import mottle
from mottle import Parameter

TESTS = np.array([2.473, 7.829, 12.234, 2.560, 8.036, 12.516, 2.619, 8.207, 12.728, 2.519, 8.118, 12.735, 2.536, 7.980,
                  12.414, 2.567, 7.991, 12.393, 2.637, 8.232, 12.797, 2.514, 7.992, 12.485, 2.554, 7.880, 12.176, 2.508,
                  7.838, 12.187]).reshape(10, 3)
PARAMETERS = [Parameter("k1", 1200.0, 200.0, positive=True), Parameter("k2", 2200.0, 300.0, positive=True)]
NOISE = [0.0025, 0.008, 0.0127]


def matrices(k):
    k1, k2 = k
    return np.array([[k1 + k2, -k2, 0.0], [-k2, 2.0 * k2, -k2], [0.0, -k2, k2]])


def frequencies(samples):
    return np.sqrt([np.linalg.eigvalsh(matrices(k)) for k in samples]) / (2.0 * np.pi)


class WithJacobian:
    def __init__(self):
        self.calls = 0

    def __call__(self, samples):
        return frequencies(samples)

    def jacobian(self, k):
        self.calls += 1
        values, vectors = np.linalg.eigh(matrices(k))
        parts = matrices([1.0, 0.0]), matrices([0.0, 1.0])
        slopes = np.array([[v @ part @ v for part in parts] for v in vectors.T])
        return slopes / (8.0 * np.pi**2 * (np.sqrt(values) / (2.0 * np.pi)))[:, None]


def update(model, **more):
    return mottle.update(model, PARAMETERS, (["f1", "f2", "f3"], TESTS), **{"repeatability": NOISE, **more})


def test_a_function_gives_what_the_study_of_the_same_model_gives():
    study = mottle.Study.from_dict({
        "model": {"kind": "mass-spring", "masses": {"m1": 1.0, "m2": 1.0, "m3": 1.0}, "springs": [
            {"name": "a", "between": ["ground", "m1"], "stiffness": 1.0},
            {"name": "b", "between": ["m1", "m2"], "stiffness": 1.0},
            {"name": "c", "between": ["m2", "m3"], "stiffness": 1.0}]},
        "parameter": [{"name": "k1", "target": "spring:a", "distribution": {"kind": "normal", "mean": 1200, "std": 200}},
                      {"name": "k2", "target": ["spring:b", "spring:c"],
                       "distribution": {"kind": "normal", "mean": 2200, "std": 300}}],
        "outputs": {"frequencies": [1, 2, 3]},
        "test": {"repeatability": {"f1": NOISE[0], "f2": NOISE[1], "f3": NOISE[2]}},
    }, tests=(["f1", "f2", "f3"], TESTS)).update()
    found = update(frequencies)
    with_jacobian = WithJacobian()
    exact = update(with_jacobian)
    assert with_jacobian.calls > 0
    assert found.verdict == exact.verdict == study.verdict == "adequate"
    assert np.allclose(found.mean, study.mean, rtol=1e-5) and np.allclose(exact.mean, study.mean, rtol=1e-8)
    assert np.allclose(exact.covariance, study.covariance, rtol=1e-5)
    assert exact.intervals[0].shape == (2, 2)


def test_batches_are_arrays_on_the_calling_thread():
    seen = []

    def model(samples):
        seen.append((threading.get_ident(), samples.shape, samples.dtype, samples.flags.c_contiguous))
        return frequencies(samples)

    found = update(model, samples=500)
    assert {each[0] for each in seen} == {threading.get_ident()}
    assert all(shape[1] == 2 and kind == np.float64 and is_c for _, shape, kind, is_c in seen)
    assert max(shape[0] for _, shape, _, _ in seen) == 500
    assert found.model_evaluations == sum(shape[0] for _, shape, _, _ in seen)


def test_same_numbers_at_any_number_of_threads():
    found = [update(frequencies, method="bayes", options={"particles": 200}, threads=threads) for threads in (1, 8)]
    assert np.array_equal(found[0].posterior.draws, found[1].posterior.draws)


def test_failed_samples_are_told_with_their_reasons():
    def model(samples):
        outputs = frequencies(samples)
        outputs[samples[:, 0] > 1500.0] = np.nan
        return outputs, {int(s): "too soft" for s in np.flatnonzero(samples[:, 0] < 1000.0)}

    found = update(model, samples=400)
    cloud = found.cloud_initial
    reasons = set(cloud.failures.values())
    assert reasons == {"too soft", "the model function returned a value that is not finite"}
    failed = np.isnan(cloud.outputs).any(axis=1)
    assert np.array_equal(failed, (cloud.samples[:, 0] > 1500.0) | (cloud.samples[:, 0] < 1000.0))


def test_what_the_function_raises_is_raised():
    class Broken(Exception):
        pass

    calls = []

    def model(samples):
        calls.append(len(samples))
        if len(calls) == 2:
            raise Broken("licence server away")
        return frequencies(samples)

    with pytest.raises(Broken, match="licence server away"):
        update(model)
    assert len(calls) == 2
    assert update(frequencies).verdict == "adequate"  # nothing is left of it


@pytest.mark.parametrize(("returned", "message"), [
    (lambda s: frequencies(s)[:, :2], r"shape \(\d+, 2\), \(\d+, 3\) is needed"),
    (lambda s: frequencies(s)[0], r"shape \(3,\), \(\d+, 3\) is needed"),
    (lambda s: None, "is needed"),
    (lambda s: "text", "returned str"),
    (lambda s: (frequencies(s), "why"), "a dict from the number of a failed sample"),
])
def test_wrong_shapes_are_refused(returned, message):
    with pytest.raises(mottle.InvalidInput, match=message):
        update(returned)


def test_wrong_arguments_are_refused():
    for arguments, message in [
        (dict(method="mare"), "mares"),
        (dict(method="mares", options={"weight": 1}), "weight"),
        (dict(repeatability={"f9": 0.1}), "'f9' is no output"),
        (dict(repeatability=-0.1), "repeatability: f1: -0.1 is negative"),
        (dict(level=5.0), "level: 5"),
        (dict(iterations=0), "iterations: 0"),
        (dict(tolerance=0.0), "tolerance: 0"),
        (dict(samples=1), "samples: 1"),
        (dict(max_failed=2.0), "max_failed: 2"),
    ]:
        with pytest.raises(mottle.InvalidInput, match=message):
            update(frequencies, **arguments)
    with pytest.raises(mottle.InvalidInput, match="parameter 'k': .*'normal'"):
        mottle.update(frequencies, [Parameter("k", 1.0, 0.1, distribution="norml")], (["f1"], TESTS[:, :1]))
    with pytest.raises(mottle.InvalidInput, match="infinite"):
        mottle.update(frequencies, PARAMETERS, (["f1", "f2", "f3"], np.where(TESTS > 12.79, np.inf, TESTS)))
    for names in (["f1", "f1", "f3"], ["f1", "k1", "f3"]):
        with pytest.raises(mottle.InvalidInput, match="given twice"):
            mottle.update(frequencies, PARAMETERS, (names, TESTS))
    with pytest.raises(mottle.InvalidInput, match="parameter 'k'"):
        mottle.update(frequencies, [Parameter("k", 1.0, -0.1)], (["f1"], TESTS[:, :1]))


def test_the_search_for_all_solutions_takes_as_many_starts_as_asked():
    def runs(starts):
        counted = []

        def model(samples):
            counted.append(len(samples))
            return frequencies(samples)

        return sum(counted) if update(model, samples=50, starts=starts) else 0

    assert runs(0) < runs(8) <= runs(None)
    with pytest.raises(mottle.InvalidInput, match="starts"):
        update(frequencies, starts=-1)


def test_a_surrogate_takes_few_samples():
    seen = []

    def model(samples):
        seen.append(len(samples))
        return frequencies(samples)

    exact = update(frequencies)
    found = update(model, surrogate=mottle.Surrogate(runs=30))
    assert sum(seen) == found.model_evaluations < 200
    assert found.verdict == exact.verdict
    assert np.allclose(found.mean, exact.mean, atol=0.1 * exact.std.min())
    with pytest.raises(mottle.InvalidInput, match="krigin"):
        update(model, surrogate=mottle.Surrogate(kind="krigin"))


def test_too_many_failures_end_the_update():
    with pytest.raises(mottle.SystemFailure):
        update(lambda samples: np.full((len(samples), 3), np.nan))
