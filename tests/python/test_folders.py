"""Updates of functions in a folder: results as the command leaves them, and resumption after whatever ended the update."""

import json
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import mottle
from test_functions import PARAMETERS, TESTS, WithJacobian, frequencies, update


class Counted:
    """Counts what it is asked for, and fails at a call as it is told."""

    def __init__(self, fails_at=None, failure=None):
        self.batches = []
        self.fails_at, self.failure = fails_at, failure

    def __call__(self, samples):
        if len(self.batches) == self.fails_at:
            self.failure()
        self.batches.append(samples.copy())
        return frequencies(samples)


def raising(error):
    def fail():
        raise error

    return fail


def without_times(result):
    return {name: value for name, value in result.to_dict().items() if name != "timings_s"}


@pytest.fixture(scope="module")
def whole():
    """What an update that nothing interrupts asks for, and its result."""
    model = Counted()
    return model.batches, update(model, batch=64)


def test_the_folder_is_as_the_command_leaves_it(tmp_path):
    folder = tmp_path / "results"
    result = update(frequencies, folder=folder, units={"f1": "Hz"}, title="A chain")
    assert {file.name for file in folder.iterdir()} == {
        ".mottle-files", "result.json", "report.html", "history.csv", "cloud-initial.csv", "cloud-final.csv", "clouds.csv",
        "tests.csv", "study.toml", "mottle.log"}
    contents = json.loads((folder / "result.json").read_text())
    assert contents["title"] == "A chain" and contents["outputs"]["units"] == ["Hz", "-", "-"]
    assert mottle.load(folder).to_dict() == contents
    assert {**result.to_dict(), "timings_s": 0} == {**contents, "timings_s": 0}
    assert contents["parameters"]["mean"] == result.mean.tolist()
    assert "A chain" in (folder / "report.html").read_text()
    assert (folder / "study.toml").read_text().count("[[parameter]]") == 2
    assert without_times(result) == without_times(update(frequencies, units={"f1": "Hz"}, title="A chain"))


def test_the_report_opens(tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    result = update(frequencies, samples=50)
    page = result.report()
    assert opened == [page.resolve().as_uri()] and "frequencies" in page.read_text()
    assert result.report(tmp_path / "page") == tmp_path / "page" / "report.html"
    command_words = [step["command"] for step in result.to_dict()["verdict"]["next"]]
    assert not any(command_words)  # the command cannot go on with a function


def test_the_command_says_that_it_cannot_run_a_function(tmp_path):
    update(frequencies, samples=50, folder=tmp_path)
    done = subprocess.run([os.environ["MOTTLE"], "check", tmp_path / "study.toml"], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "which alone can run it" in done.stderr, done.stderr


@pytest.mark.parametrize("failure", [raising(RuntimeError("licence away")), raising(KeyboardInterrupt()),
                                     lambda: os.kill(os.getpid(), signal.SIGINT)], ids=["raises", "interrupt", "signal"])
@pytest.mark.parametrize("at", [0, 1, 5, 17])
def test_an_update_whose_function_failed_goes_on(tmp_path, whole, failure, at):
    broken = Counted(at, failure)
    with pytest.raises((RuntimeError, KeyboardInterrupt)):
        update(broken, batch=64, folder=tmp_path)
    finished = broken.batches[:at]
    model = Counted()
    result = update(model, batch=64, folder=tmp_path, resume=True)
    assert len(finished) >= at and len(finished) + len(model.batches) <= len(whole[0])
    assert all(np.array_equal(*pair) for pair in zip(finished, whole[0]))
    assert all(np.array_equal(*pair) for pair in zip(model.batches[::-1], whole[0][::-1]))  # and nothing of it twice
    assert {**without_times(result), "title": ""} == {**without_times(whole[1]), "title": ""}
    assert result.model_evaluations == whole[1].model_evaluations
    assert not (tmp_path / "resume.journal").exists()


KILLED = """
import os, signal, sys
sys.path[:0] = [os.environ["MOTTLE_PYTHON"], os.environ["MOTTLE_TESTS"]]
from test_functions import frequencies, update
calls = []
def model(samples):
    if len(calls) == 6:
        os.kill(os.getpid(), signal.SIGKILL)
    calls.append(len(samples))
    return frequencies(samples)
update(model, batch=64, folder=os.environ["MOTTLE_FOLDER"], title="Counted")
"""


def test_a_killed_update_goes_on(tmp_path, whole):
    done = subprocess.run([sys.executable, "-c", KILLED], capture_output=True, text=True, check=False, timeout=60,
                          env={**os.environ, "MOTTLE_TESTS": str(Path(__file__).parent), "MOTTLE_FOLDER": str(tmp_path)})
    assert done.returncode == -signal.SIGKILL, done.stderr
    assert not (tmp_path / "result.json").exists()
    model = Counted()
    result = update(model, batch=64, folder=tmp_path, resume=True)
    assert len(model.batches) == len(whole[0]) - 6
    assert without_times(result) == without_times(whole[1])


def test_surrogates_and_derivatives_go_on_too(tmp_path):
    def compare(make, folder, **more):
        exact = update(make(), **more)
        broken = make()
        original, calls = broken.__call__, []

        def failing(samples):
            calls.append(len(samples))
            if len(calls) == 2:
                raise RuntimeError("once")
            return original(samples)

        if hasattr(broken, "jacobian"):
            failing.jacobian = broken.jacobian
        with pytest.raises(RuntimeError):
            update(failing, folder=folder, title="t", **more)
        resumed = update(make(), folder=folder, title="t", resume=True, **more)
        assert np.array_equal(resumed.mean, exact.mean) and np.array_equal(resumed.covariance, exact.covariance)

    compare(Counted, tmp_path / "a", surrogate=mottle.Surrogate(runs=30))
    compare(WithJacobian, tmp_path / "b")


def test_derivatives_are_not_asked_for_again(tmp_path):
    class Points(WithJacobian):
        def __init__(self, fails_at=None):
            super().__init__()
            self.points, self.fails_at = [], fails_at

        def jacobian(self, k):
            if len(self.points) == self.fails_at:
                raise RuntimeError("licence away")
            self.points.append(tuple(k))
            return super().jacobian(k)

    whole = Points()
    wanted = update(whole, folder=tmp_path / "whole")  # which keeps a point that is asked for twice
    for at in (0, 1, len(whole.points) // 2, len(whole.points) - 1):
        broken, model = Points(at), Points()
        with pytest.raises(RuntimeError):
            update(broken, folder=tmp_path / str(at))
        found = update(model, folder=tmp_path / str(at), resume=True)
        assert np.array_equal(found.mean, wanted.mean) and np.array_equal(found.covariance, wanted.covariance)
        assert not {*broken.points} & {*model.points} and {*broken.points} | {*model.points} == {*whole.points}


def test_what_has_changed_is_not_resumed(tmp_path):
    with pytest.raises(RuntimeError):
        update(Counted(2, raising(RuntimeError())), batch=64, folder=tmp_path)
    for changed in (dict(samples=999), dict(seed=2), dict(method="mares"), dict(level=0.1), dict(repeatability=0.01)):
        with pytest.raises(mottle.InvalidInput, match="changed since"):
            update(Counted(), batch=64, folder=tmp_path, resume=True, **changed)
    with pytest.raises(mottle.InvalidInput, match="changed since"):
        mottle.update(Counted(), PARAMETERS, (["f1", "f2", "f3"], TESTS + 0.001), repeatability=[0.0025, 0.008, 0.0127],
                      folder=tmp_path, resume=True)
    model = Counted()
    update(model, batch=64, folder=tmp_path, resume=True, threads=2)  # which changes no number
    assert model.batches
    with pytest.raises(mottle.InvalidInput, match="resume: there is no folder"):
        update(frequencies, resume=True)


def test_a_folder_is_filled_by_one_update_at_a_time(tmp_path):
    refused = []

    def model(samples):
        if not refused:
            try:
                update(frequencies, folder=tmp_path)
            except mottle.InvalidInput as error:
                refused.append(str(error))
        return frequencies(samples)

    update(model, folder=tmp_path)
    assert len(refused) == 1 and str(tmp_path) in refused[0]


def test_files_of_the_user_stay(tmp_path):
    (tmp_path / "result.json").write_text("mine")
    with pytest.raises(mottle.InvalidInput, match="result.json"):
        update(frequencies, folder=tmp_path)
    assert (tmp_path / "result.json").read_text() == "mine"


def test_batches_are_no_larger_than_asked():
    model = Counted()
    result = update(model, batch=7)
    assert max(map(len, model.batches)) == 7
    assert np.array_equal(result.mean, update(frequencies).mean)
    with pytest.raises(mottle.InvalidInput, match="batch: 0 is outside"):
        update(frequencies, batch=0)


def test_two_updates_fill_two_folders_at_once(tmp_path):
    found = {}
    threads = [threading.Thread(target=lambda name=name: found.update({name: update(frequencies, folder=tmp_path / name)}))
               for name in "abcd"]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert len(found) == 4 and len({json.dumps(without_times(each)) for each in found.values()}) == 1
