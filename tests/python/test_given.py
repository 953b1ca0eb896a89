"""What users give a function's update: taken as it is meant, or refused by its name; never taken for something else."""

import decimal
import gc
import weakref

import numpy as np
import pytest

import mottle
from mottle import Parameter
from test_functions import NOISE, PARAMETERS, TESTS, WithJacobian, frequencies, update

NAMES = ["f1", "f2", "f3"]


def update_tests(tests, **more):
    return mottle.update(frequencies, PARAMETERS, tests, **{"repeatability": NOISE, "samples": 100, **more})


def same(a, b):
    return np.array_equal(a.mean, b.mean) and np.array_equal(a.covariance, b.covariance)


def test_specimens_without_values_are_left_out_as_by_studies():
    none = np.full((1, 3), np.nan)
    found = update_tests((NAMES, np.vstack([TESTS[:4], none, TESTS[4:], none])))
    assert same(found, update_tests((NAMES, TESTS))) and np.array_equal(found.tests, TESTS)
    assert any(note.startswith("Specimens without any value are left out, 2: specimen 5, 12;") for note in found.notes)
    assert not any("left out" in note for note in update_tests((NAMES, TESTS)).notes)
    with pytest.raises(mottle.InvalidInput, match="no specimen with a value"):
        update_tests((NAMES, np.repeat(none, 3, axis=0)))
    with pytest.raises(mottle.InvalidInput, match="output 'f2' is never measured"):
        update_tests((NAMES, np.where([False, True, False], np.nan, TESTS)))


def test_masked_tests_are_not_measured():
    masked = np.ma.array(TESTS.copy(), mask=False)
    masked[0, 0] = np.ma.masked
    masked.data[0, 0] = 99.0
    missing = TESTS.copy()
    missing[0, 0] = np.nan
    wanted = update_tests((NAMES, missing))
    assert same(update_tests((NAMES, masked)), wanted)
    assert same(update_tests({name: masked[:, k] for k, name in enumerate(NAMES)}), wanted)
    with pytest.raises(mottle.InvalidInput, match="repeatability has a masked entry"):
        update_tests((NAMES, TESTS), repeatability=np.ma.array(NOISE, mask=[0, 1, 0]))


@pytest.mark.parametrize(("tests", "message"), [
    ((NAMES, TESTS + 0j), "tests holds complex numbers"),
    ({"f1": ["2.4", "2.5"]}, "column 'f1' holds text"),
    ({"f1": np.array(["2020-01-01"], dtype="datetime64[D]")}, "column 'f1' holds dates"),
    ({"f1": [object()]}, "column 'f1' holds <object"),
    ({"f1": [1.0, 2.0], "f2": [1.0]}, "columns of different lengths"),
    ((["f1", "f1", "f3"], TESTS), "'f1' is given twice, to columns 1 and 2"),
    ((["f1", " ", "f3"], TESTS), "column 2 has no name"),
    (([], TESTS[:, :0]), "there is no column"),
    ({}, "there is no column"),
    ((NAMES, TESTS[:, :2]), r"shape \(10, 2\)"),
    ((NAMES, [[1.0, 2.0, 3.0], [1.0]]), "rows of different lengths"),
])
def test_tables_that_are_none_are_refused(tests, message):
    with pytest.raises(mottle.InvalidInput, match=message):
        update_tests(tests)


def test_data_frames_and_series_are_taken_by_name():
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame(TESTS, columns=NAMES)
    wanted = update_tests(table)
    series = pandas.Series({"f3": NOISE[2], "f2": NOISE[1], "f1": NOISE[0]})
    assert same(update_tests(table, repeatability=series), wanted)
    assert same(update_tests(table, model_error=0.1 * series[::-1]), update_tests(table, model_error=0.1 * np.array(NOISE)))
    assert same(update_tests(table.astype(object).astype("Float64")), wanted)
    prior = pandas.DataFrame([[1.0, 0.4], [0.4, 1.0]], index=["k2", "k1"], columns=["k1", "k2"]).loc[["k1", "k2"]]
    prior.loc["k1"], prior.loc["k2"] = [1.0, 0.4], [0.4, 1.0]
    bayes = {"method": "bayes", "options": {"particles": 100}}
    assert same(update_tests(table, correlation=prior.loc[::-1], **bayes), update_tests(table, correlation=prior.values, **bayes))
    for given, message in [
        (table.assign(f2=pandas.Timestamp("2020-01-01")), "column 'f2' holds dates"),
        (table.assign(f2=pandas.Timestamp("2020-01-01", tz="UTC")), "column 'f2' holds Timestamp"),
        (table.assign(f2="high"), "column 'f2' holds 'high'"),
        (table.assign(f2=1j), "column 'f2' holds complex numbers"),
        (table.rename(columns={"f2": "f1"}), "'f1' is given twice"),
    ]:
        with pytest.raises(mottle.InvalidInput, match=message):
            update_tests(given)
    with pytest.raises(mottle.InvalidInput, match="'0' is no output"):
        update_tests(table, repeatability=pandas.Series(NOISE))


def test_masked_rows_of_the_model_have_failed():
    def model(samples):
        return np.ma.masked_where(np.repeat(samples[:, :1] > 1500.0, 3, axis=1), frequencies(samples))

    cloud = update(model, samples=400).cloud_initial
    assert np.array_equal(np.isnan(cloud.outputs).all(axis=1), cloud.samples[:, 0] > 1500.0) and cloud.failures


@pytest.mark.parametrize(("returned", "message"), [
    (lambda s: frequencies(s) + 0j, "the model function's array holds complex numbers"),
    (lambda s: frequencies(s).astype(str), "holds text"),
    (lambda s: frequencies(s).astype("datetime64[s]"), "holds dates"),
    (lambda s: (frequencies(s), {-1: "no"}), r"reasons: sample: -1 is outside 0 to"),
    (lambda s: (frequencies(s), {len(s): "no"}), r"reasons: sample: \d+ is outside 0 to"),
    (lambda s: (frequencies(s), {"0": "no"}), r"reasons: sample: '0' \(str\) is no whole number"),
])
def test_what_the_model_returns_wrongly_is_refused(returned, message):
    with pytest.raises(mottle.InvalidInput, match=message):
        update(returned)


def test_jacobians():
    class Wrong(WithJacobian):
        def jacobian(self, k):
            return self.change(super().jacobian(k))

    for change, message in [(lambda d: d * [1.0, np.nan], r"returned nan at \[0, 1\]"), (lambda d: d / 0.0, "returned -?inf"),
                            (lambda d: d + 0j, "jacobian's array holds complex"), (lambda d: d.T, r"shape \(2, 3\), \(3, 2\)"),
                            (lambda d: None, "jacobian returned NoneType")]:
        Wrong.change = staticmethod(change)
        with pytest.raises(mottle.InvalidInput, match=message), np.errstate(divide="ignore", invalid="ignore"):
            update(Wrong())
    without = WithJacobian()
    without.jacobian = None
    assert same(update(without), update(frequencies))
    without.jacobian = 3.0
    with pytest.raises(mottle.InvalidInput, match="jacobian: float is no function"):
        update(without)


@pytest.mark.parametrize(("argument", "value", "message"), [
    ("iterations", -1, "iterations: -1 is outside"),
    ("method", None, "method: None is no name"),
    ("samples", 100.5, r"samples: 100.5 \(float\) is no whole number"),
    ("samples", True, "samples: True"),
    ("samples", 2**40, "samples: 1099511627776 is outside"),
    ("threads", -1, "threads: -1"),
    ("seed", -1, "seed: -1 is outside 0 to 9223372036854775807"),
    ("seed", 2**63, "seed: 9223372036854775808 is outside"),
    ("seed", 1.0, "seed: 1.0"),
    ("level", None, "level: None"),
    ("level", float("nan"), "level: nan"),
    ("tolerance", 1j, "tolerance: 1j"),
    ("max_failed", "0.1", "max_failed: '0.1'"),
    ("repeatability", [0.1, 0.1], r"repeatability: shape \(2,\)"),
    ("repeatability", {"f1": [0.1, 0.1]}, r"repeatability: f1: shape \(2,\)"),
    ("repeatability", [0.1, np.nan, 0.1], "repeatability: f2: nan"),
    ("repeatability", 1j, "repeatability holds complex"),
    ("model_error", [0.1] * 4, r"model_error: shape \(4,\)"),
    ("correlation", np.eye(3), r"correlation: shape \(3, 3\), \(2, 2\) is needed"),
    ("correlation", 0.5, r"correlation: shape \(\)"),
    ("correlation", [[1.0, 0.5], [0.2, 1.0]], "correlation: not symmetric"),
    ("units", {"f9": "Hz"}, "units: 'f9' is no output"),
    ("options", {"particles": None}, r"options: particles: None \(NoneType\)"),
    ("options", {"particles": [100]}, r"options: particles: \[100\]"),
    ("options", {"particles": 2**70}, "options: particles"),
    ("options", {1: 2}, "options: {1: 2}"),
    ("surrogate", mottle.Surrogate(runs=5), "surrogate: runs: 5 is outside 10 to 100000"),
    ("surrogate", mottle.Surrogate(runs=-1), "surrogate: runs: -1"),
    ("surrogate", mottle.Surrogate(spread=0.1), "surrogate: spread: 0.1 is outside 0.5 to 6"),
    ("surrogate", mottle.Surrogate(rounds=101), "surrogate: rounds: 101"),
    ("surrogate", mottle.Surrogate(tolerance=0.0), "surrogate: tolerance: 0"),
])
def test_arguments_are_refused_by_name(argument, value, message):
    with pytest.raises(mottle.InvalidInput, match=message):
        update(frequencies, **{argument: value})


def test_numbers_of_other_types_are_taken_as_numbers():
    wanted = update(frequencies, method="bayes", options={"particles": 100})
    for particles in (np.int16(100), decimal.Decimal(100)):
        assert same(update(frequencies, method="bayes", options={"particles": particles}), wanted)
    assert same(update(frequencies, level=decimal.Decimal("0.05"), samples=np.int64(1000)), update(frequencies))
    with pytest.raises(mottle.InvalidInput, match="particles.*100.5"):  # whole in float32 too, and no true or false
        update(frequencies, method="bayes", options={"particles": np.float32(100.5)})


@pytest.mark.parametrize(("parameter", "message"), [
    (dict(name="", mean=1.0, std=0.1), "has no name"),
    (dict(name="k", mean="1", std=0.1), "parameter 'k': mean: '1'"),
    (dict(name="k", mean=1.0, std=1j), "parameter 'k': std: 1j"),
    (dict(name="k", mean=1.0, std=0.1, bounds=(0.0, None)), "parameter 'k': bounds: None"),
    (dict(name="k", mean=1.0, std=0.1, bounds=(0.0,)), "parameter 'k': bounds"),
    (dict(name="k", mean=1.0, std=0.1, bounds=None), "parameter 'k': bounds: None"),
])
def test_parameters_are_refused_by_name(parameter, message):
    with pytest.raises(mottle.InvalidInput, match=message):
        mottle.update(frequencies, [Parameter(**parameter)], (NAMES, TESTS))
    with pytest.raises(mottle.InvalidInput, match="parameters: 'k1'; mottle.Parameter"):
        mottle.update(frequencies, ["k1", "k2"], (NAMES, TESTS))


def test_a_model_may_hold_its_result():
    class Model:
        def __call__(self, samples):
            return frequencies(samples)

    alive = []
    for _ in range(3):
        model = Model()
        model.result = update(model, samples=50)
        alive.append(weakref.ref(model))
        del model
    gc.collect()
    assert not any(each() for each in alive)
