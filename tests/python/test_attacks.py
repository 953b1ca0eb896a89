"""What users do to a function's update beside what is meant: taken as it is meant, or refused in words; the process lives."""

import copy
import gc
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import weakref
from pathlib import Path

import numpy as np
import pytest

import mottle
from mottle import Parameter
from test_functions import NOISE, PARAMETERS, TESTS, frequencies, update

NAMES = ["f1", "f2", "f3"]


def same(a, b):
    return np.array_equal(a.mean, b.mean) and np.array_equal(a.covariance, b.covariance)


@pytest.fixture(scope="module")
def wanted():
    return update(frequencies, samples=100)


@pytest.mark.parametrize("change", [
    np.asfortranarray,
    lambda y: np.repeat(y, 2, axis=1)[:, ::2],
    lambda y: y[::-1][::-1],
    lambda y: y.astype(">f8"),
    lambda y: y.astype(object),
    lambda y: y.astype(np.longdouble),
    lambda y: y.tolist(),
    lambda y: [list(row) for row in y],
    lambda y: (y, {}),
    lambda y: np.matrix(y),
    lambda y: np.ma.array(y),
    lambda y: y.view(type("Own", (np.ndarray,), {})),
], ids=str)
def test_arrays_of_any_kind_are_taken_as_their_numbers(wanted, change):
    assert same(update(lambda samples: change(frequencies(samples)), samples=100), wanted)


def test_arrays_that_may_not_be_written_and_frames(wanted):
    def frozen(samples):
        y = frequencies(samples)
        y.flags.writeable = False
        return y

    assert same(update(frozen, samples=100), wanted)
    pandas = pytest.importorskip("pandas")
    assert same(update(lambda samples: pandas.DataFrame(frequencies(samples), index=[7] * len(samples)), samples=100), wanted)


def test_numbers_of_fewer_bits_are_taken():
    single = update(lambda samples: frequencies(samples).astype(np.float32), samples=100)
    assert single.status in ("converged", "stalled", "max-iterations")

    def whole(samples):
        return np.round(1e3 * frequencies(samples)).astype(np.int32)

    tests = (NAMES, np.round(1e3 * TESTS))
    with pytest.raises(mottle.InvalidInput, match="no parameter moves any of them"):  # within a step of differences
        mottle.update(whole, PARAMETERS, tests, repeatability=1e3 * np.array(NOISE))
    found = mottle.update(whole, PARAMETERS, tests, repeatability=1e3 * np.array(NOISE), difference_step=0.1)
    assert np.allclose(found.mean, update(frequencies).mean, rtol=2e-3) and found.verdict == "adequate"


def test_what_the_model_does_with_its_arrays_is_its_own_business(wanted):
    kept, buffer = [], np.empty((10_000, 3))

    def model(samples):
        outputs = buffer[: len(samples)]  # one buffer for all calls
        outputs[:] = frequencies(samples)
        kept.append(samples)
        samples[:] = np.nan
        return outputs

    assert same(update(model, samples=100), wanted)
    gc.collect()
    buffer[:] = 0.0
    assert all(np.isnan(samples).all() for samples in kept)  # arrays of their own, which live on


def test_a_model_that_returns_its_samples():
    found = mottle.update(lambda samples: samples, [Parameter("a", 1.0, 0.3), Parameter("b", 2.0, 0.3)],
                          (["y1", "y2"], TESTS[:, :2] / TESTS[:, :2].mean(axis=0) * [1.1, 2.1]), repeatability=0.01)
    assert np.allclose(found.mean, [1.1, 2.1], atol=1e-6)


class Unprintable(Exception):
    def __str__(self):
        raise RuntimeError("no words")


@pytest.mark.parametrize("error", [Unprintable(), SystemExit(3), GeneratorExit(), StopIteration(1), MemoryError(), RecursionError(),
                                   KeyError("k"), mottle.InvalidInput("mine"), mottle.Stopped("mine"), Warning(),
                                   UnicodeDecodeError("utf-8", b"\xff", 0, 1, "bad")], ids=lambda error: type(error).__name__)
@pytest.mark.parametrize("where", ["model", "jacobian", "progress"])
def test_whatever_is_raised_is_raised_as_it_is(error, where):
    def failing(*_):
        raise error

    def model(samples):
        if where == "progress":
            threading.Event().wait(0.12)
        return failing() if where == "model" else frequencies(samples)

    if where == "jacobian":
        model.jacobian = failing
    with pytest.raises(type(error)) as caught:
        update(model, progress=failing if where == "progress" else False, method="bayes" if where == "progress" else "maximum-likelihood")
    assert caught.value is error
    gc.collect()
    assert update(frequencies, samples=20).mean.shape == (2,)


def test_what_was_raised_is_let_go():
    class Big(Exception):
        pass

    error = Big()
    alive = weakref.ref(error)

    def model(samples, error=[error]):
        raise error.pop()

    del error
    try:
        update(model)
    except Big:
        pass
    del model
    gc.collect()
    assert alive() is None


def test_a_deep_recursion_in_the_model_ends_as_python_ends_it():
    def model(samples):
        return model(samples)

    with pytest.raises(RecursionError):
        update(model)


@pytest.mark.parametrize(("parameters", "message"), [
    ([], "parameters: there is none"),
    (None, "parameters: None"),
    (Parameter("k", 1.0, 0.1), "parameters: .*list"),
    ([Parameter("k\n1", 1.0, 0.1)], "control character"),
    ([Parameter("k\0", 1.0, 0.1)], "control character"),
    ([Parameter("\ud800", 1.0, 0.1)], "no Unicode text"),
    ([Parameter("k", 1.0, 0.1, unit="\ud800")], "unit"),
    ([Parameter("k", 1.0, 0.1, unit=3)], "unit"),
    ([Parameter(3, 1.0, 0.1)], "has no name"),
    ([Parameter("k", 1.0, 0.1, scale=3)], "scale"),
    ([Parameter("k", 1.0, 0.1, distribution=None)], "distribution"),
    ([Parameter("k", np.float64("nan"), 0.1)], "mean: nan"),
    ([Parameter("k", np.array([1.0, 2.0]), 0.1)], "mean: "),
    ([Parameter("k", 1.0, 0.0)], "std"),
    ([Parameter("k", 1.0, 0.1), Parameter("k", 1.0, 0.1)], "given twice"),
])
def test_parameters_that_are_none(parameters, message):
    with pytest.raises(mottle.InvalidInput, match=message):
        mottle.update(frequencies, parameters, (NAMES, TESTS))


@pytest.mark.parametrize("name", ["Größe", "параметр", "剛性", "\N{SNOWMAN}", "a,b", 'a"b', "a b", " k ", "k:1", "k#1", "'", "a\\b", "<b>"])
def test_names_of_any_letters(name, tmp_path):
    parameters = [Parameter(name, 1200.0, 200.0, unit=name), PARAMETERS[1]]
    outputs = [f"{name}1", "f2", "f3"]
    found = mottle.update(frequencies, parameters, (outputs, TESTS), repeatability=NOISE, samples=50, folder=tmp_path / name.strip(),
                          units={f"{name}1": name}, title=name)
    assert found.parameters == [name, "k2"] and found.outputs == outputs
    assert found.to_dict()["parameters"]["names"][0] == name
    pandas = pytest.importorskip("pandas")
    table = pandas.read_csv(tmp_path / name.strip() / "cloud-final.csv", skipinitialspace=False)
    assert list(table.columns[:3]) == [name, "k2", f"{name}1"]
    assert "<b>" != name or "&lt;b&gt;" in found._repr_html_()
    page = (tmp_path / name.strip() / "report.html").read_text(encoding="utf-8")
    assert name != "<b>" or "<b>1" not in page


def test_data_frames_as_they_come():
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame(TESTS, columns=NAMES)
    wanted = mottle.update(frequencies, PARAMETERS, table, repeatability=NOISE, samples=50)

    def given(tests):
        return mottle.update(frequencies, PARAMETERS, tests, repeatability=NOISE, samples=50)

    times = pandas.date_range("2020-01-01", periods=10)
    for index in (times, ["x"] * 10, range(10, 0, -1), pandas.MultiIndex.from_product([range(5), ["a", "b"]]), [np.nan] * 10):
        assert same(given(table.set_axis(index)), wanted)
    assert same(given(table.astype({"f1": "Float64", "f2": object})), wanted)
    assert same(given(table.set_axis(pandas.CategoricalIndex(NAMES), axis=1)), wanted)
    assert same(given(table[NAMES[::-1]][NAMES]), wanted)
    holes = table.copy()
    holes.iloc[3, 1] = np.nan
    for missing in (holes, holes.astype("Float64"), holes.astype(object).where(holes.notna(), None)):
        assert same(given(missing), given(holes))
    with pytest.raises(mottle.InvalidInput, match="'f3' is never measured"):
        given(table.assign(f3=np.nan))
    with pytest.raises(mottle.InvalidInput, match="column 'f1' holds"):
        given(table.assign(f1=table.f1.astype(str).astype("category")))
    with pytest.raises(mottle.InvalidInput, match="no specimen with a value"):
        given(table.iloc[:0])
    with pytest.raises(mottle.InvalidInput, match="shape|no column"):
        given((NAMES, np.empty((10, 0))))


@pytest.mark.parametrize("kind", [np.int8, np.uint16, np.int64, np.float32, np.float64, np.longdouble, np.array])
def test_numpy_scalars_are_options(kind):
    if kind in (np.float32, np.float64, np.longdouble):
        found = [update(frequencies, method="mares", options={"model_error": value}, samples=50) for value in (kind(0.25), 0.25)]
        assert same(*found)
        return
    if kind is np.array:
        with pytest.raises(mottle.InvalidInput, match="options: particles"):
            update(frequencies, method="bayes", options={"particles": np.array([100])})
        return
    assert same(update(frequencies, method=np.str_("bayes"), options={np.str_("particles"): kind(100)}, samples=np.int16(50)),
                update(frequencies, method="bayes", options={"particles": 100}, samples=50))


def test_views_live_longer_than_results():
    result = update(frequencies, method="bayes", options={"particles": 200}, samples=300)
    views = {
        "mean": result.mean, "covariance": result.covariance, "samples": result.cloud_initial.samples,
        "outputs": result.cloud_final.outputs, "draws": result.posterior.draws, "tests": result.tests,
        "chain": next(iter(result.posterior.to_dict().values())), "part": result.cloud_final.outputs[3:7, 1],
    }
    copies = {name: view.copy() for name, view in views.items()}
    alive = weakref.ref(result)
    del result
    gc.collect()
    assert alive() is None
    for _ in range(3):  # whatever takes the memory that was freed
        update(frequencies, method="bayes", options={"particles": 200}, samples=300)
    assert all(np.array_equal(views[name], copies[name]) for name in views)
    for name, view in views.items():
        assert not view.flags.writeable, name
        with pytest.raises(ValueError, match="read-only"):
            view[...] = 0.0


@pytest.mark.parametrize("make", [lambda r: r, lambda r: r.cloud_final, lambda r: r.posterior, lambda r: r.plot], ids=str)
def test_results_say_that_they_are_not_pickled(make):
    thing = make(update(frequencies, method="bayes", options={"particles": 100}, samples=50))
    with pytest.raises(TypeError, match="cannot be pickled, as its arrays are the engine's own"):
        pickle.dumps(thing)
    assert copy.copy(thing) is thing and copy.deepcopy([thing])[0] is thing  # its arrays are never written into


def test_what_is_plain_is_pickled(tmp_path):
    result = update(frequencies, samples=50, folder=tmp_path)
    for thing in (PARAMETERS[0], mottle.Surrogate(), result.to_dict(), mottle.load(tmp_path), mottle.InvalidInput("a.toml:3: x.y: z")):
        again = pickle.loads(pickle.dumps(thing))
        assert repr(again) == repr(thing)
    assert np.array_equal(pickle.loads(pickle.dumps(result.mean)), result.mean)
    assert pickle.loads(pickle.dumps(mottle.InvalidInput("a.toml:3: x.y: z"))).line == 3


def _mean(samples):
    return update(frequencies, samples=samples).mean


@pytest.mark.parametrize("way", ["fork", "spawn"])
def test_processes_that_are_forked_after_the_import_update(wanted, way):
    context = multiprocessing.get_context(way)
    with context.Pool(4) as pool:
        found = pool.map_async(_mean, [100] * 8).get(timeout=120)
    assert all(np.array_equal(mean, wanted.mean) for mean in found)


def _surrogate_job():
    update(frequencies, samples=50, iterations=2, surrogate=mottle.Surrogate("kriging"))


def _hdf5_job():
    matrix = mottle.read_matrix(Path(__file__).parents[1] / "formats/matrices/octave.h5#A/value").values
    assert (matrix.diagonal() != 0.0).all()


JOBS = {"updates": lambda: update(frequencies, samples=20, iterations=2), "kriging": _surrogate_job, "HDF5": _hdf5_job}


@pytest.mark.parametrize("kind", JOBS)
def test_a_fork_in_the_middle_of_jobs_of_other_threads(kind):
    stop = threading.Event()
    job = JOBS[kind]
    job()  # imports what it needs: a child forked in the middle of another thread's import waits for it, in any program

    def work():
        while not stop.is_set():
            job()

    threads = [threading.Thread(target=work) for _ in range(3)]
    for each in threads:
        each.start()
    try:
        for _ in range(40):
            child = os.fork()
            if child == 0:
                status = 1
                signal.alarm(60)  # ends a child that waits for ever
                try:
                    job()
                    status = 0
                finally:
                    os._exit(status)
            assert os.waitpid(child, 0)[1] == 0
    finally:
        stop.set()
        for each in threads:
            each.join()


def test_a_fork_while_another_thread_makes_what_all_share():
    script = """
import os, signal, sys, threading
sys.path[:0] = [os.environ["MOTTLE_PYTHON"], os.environ["MOTTLE_TESTS"]]
from test_functions import frequencies, update
def is_loading():
    return "mottle_openturns.so" in open("/proc/self/maps").read()
thread = threading.Thread(target=lambda: update(frequencies))
thread.start()
while thread.is_alive() and not is_loading():
    pass
child = os.fork()
if child == 0:
    signal.alarm(60)
    update(frequencies)
    os._exit(0)
thread.join()
print(is_loading(), os.waitpid(child, 0)[1])
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False, timeout=120,
                          env={**os.environ, "MOTTLE_TESTS": str(Path(__file__).parent)})
    assert (done.returncode, done.stdout, done.stderr) == (0, "True 0\n", "")


def test_a_forked_model_is_the_childs_own():
    """A model that forks: the child ends by itself, the parent goes on."""
    def model(samples):
        child = os.fork()
        if child == 0:
            os._exit(0)
        assert os.waitpid(child, 0)[1] == 0
        return frequencies(samples)

    assert update(model, samples=50).mean.shape == (2,)


def test_a_million_samples_in_one_batch():
    seen = []

    def model(samples):
        seen.append(samples.shape)
        return np.column_stack([samples.sum(axis=1)] * 3) * [1.0, 2.0, 3.0] + [[0.0, 1.0, 2.0]] * samples[:, :1]

    found = update(model, samples=1_000_000, batch=2**20, iterations=2)
    assert (1_000_000, 2) in seen and found.cloud_final.outputs.shape == (1_000_000, 3)


def test_signals_of_the_users_own():
    script = """
import os, signal, sys
sys.path[:0] = [os.environ["MOTTLE_PYTHON"], os.environ["MOTTLE_TESTS"]]
from test_functions import frequencies, update
class Alarm(Exception):
    pass
def raise_alarm(number, frame):
    raise Alarm(number)
signal.signal(signal.SIGALRM, raise_alarm)
signal.setitimer(signal.ITIMER_REAL, 0.3)
try:
    while True:
        update(frequencies, samples=20000)
except Alarm:
    print("alarm")
print(update(frequencies).verdict)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False, timeout=120,
                          env={**os.environ, "MOTTLE_TESTS": str(Path(__file__).parent)})
    assert (done.returncode, done.stdout, done.stderr) == (0, "alarm\nadequate\n", "")


def test_a_model_that_deletes_what_it_can():
    class Model:
        def __init__(self):
            self.calls = 0

        def __call__(self, samples):
            global held
            self.calls += 1
            held = None
            gc.collect()
            return frequencies(samples)

    global held
    held = Model()
    assert update(held, samples=50).mean.shape == (2,)


def test_a_result_within_a_result():
    results = []

    def model(samples):
        if results:
            results[-1].to_dict()
            results[-1].report_text = results[-1].summary()
        results.append(update(frequencies, samples=20, iterations=2))
        return frequencies(samples)

    assert update(model, samples=20, iterations=2).mean.shape == (2,) and len(results) > 1
