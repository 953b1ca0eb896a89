"""Tables that go to the engine by files and come back: no row, digit or file is lost."""

import webbrowser

import numpy as np
import pytest

import mottle
from test_studies import TESTS, three_masses


def one_parameter():
    return mottle.Study.from_dict(three_masses(parameter=three_masses()["parameter"][:1]))


def test_points_without_a_value_are_refused_by_row():
    for study, given, message in [
        (one_parameter(), [[1.0], [np.nan], [1.1]], "points: row 2: k1 is nan"),
        (one_parameter(), {"k1": [1.0, None]}, "points: column 'k1' has an entry without value"),
        (one_parameter(), np.ma.array([[1.0], [1.1]], mask=[[0], [1]]), "points has a masked entry"),
        (mottle.Study.from_dict(three_masses()), [[1.0, 1.0], [1.0, np.inf]], "points: row 2: k2 is inf"),
        (mottle.Study.from_dict(three_masses()), [[1.0, 1.0 + 1j]], "points holds complex"),
        (mottle.Study.from_dict(three_masses()), [[1.0, 1.0, 1.0]], r"points: shape \(1, 3\)"),
    ]:
        with pytest.raises(mottle.InvalidInput, match=message):
            study.propagate(given)
    assert np.array_equal(one_parameter().propagate([[1.0], [1.1]]).cloud.samples, [[1.0], [1.1]])


def test_rows_of_one_column_without_value_keep_their_place():
    def study(values):
        return mottle.Study.from_dict(three_masses(outputs={"frequencies": [1]}, parameter=three_masses()["parameter"][:1]),
                                      tests={"f1": values})

    found = study([0.098, np.nan, 0.1, 0.101]).update()
    assert np.array_equal(found.tests.ravel(), [0.098, 0.1, 0.101])
    assert any("left out, 1: specimen 2;" in note for note in found.to_dict()["notes"])
    masked = study(np.ma.array([0.098, 5.0, 0.1, 0.101], mask=[0, 1, 0, 0])).update()
    assert np.array_equal(masked.mean, found.mean)


def test_names_may_hold_separators():
    outputs = ["f1", "f2"]
    text = mottle.tables.csv_text(['a;b', 'c"d,e'], np.ones((1, 2)))
    assert text == '"a;b","c""d,e"\n1.0,1.0\n'
    with pytest.raises(mottle.InvalidInput, match="'a;b'"):
        mottle.Study.from_dict(three_masses(), tests={"a;b": [1.0], **{name: [1.0] for name in outputs}}).check()
    with pytest.raises(mottle.InvalidInput, match="no line break"):
        mottle.Study.from_dict(three_masses(), tests={"a\nb": [1.0]})


def interrupt(*_):
    raise KeyboardInterrupt


def test_a_study_of_python_objects_is_resumed_where_its_tests_are_kept(tmp_path):
    def study(tests=TESTS, **more):
        content = three_masses(update={"method": "bayes", "bayes": {"particles": 300}})
        return mottle.Study.from_dict(content, tests=tests, folder=tmp_path, **more)

    kept = {"tests_file": "kept/tests.csv"}
    with pytest.raises(KeyboardInterrupt):
        study(**kept).update(tmp_path / "out", progress=interrupt)
    assert (tmp_path / "out" / "resume.journal").is_file()
    written = (tmp_path / "kept" / "tests.csv").stat()
    resumed = study(**kept).update(tmp_path / "out", resume=True)
    assert (tmp_path / "kept" / "tests.csv").stat() == written  # nothing to write
    assert np.array_equal(resumed.posterior.draws, study().update().posterior.draws)

    with pytest.raises(KeyboardInterrupt):
        study().update(tmp_path / "temporary", progress=interrupt)
    with pytest.raises(mottle.InvalidInput):
        study().update(tmp_path / "temporary", resume=True)

    other = {name: values[:3] for name, values in TESTS.items()}
    assert len(study(other, **kept).update().tests) == 3
    (tmp_path / "mine.csv").write_text("f1,f2\n1,2\n")
    with pytest.raises(mottle.InvalidInput, match="mine.csv: is there already"):
        study(tests_file="mine.csv")
    assert (tmp_path / "mine.csv").read_text() == "f1,f2\n1,2\n"
    with pytest.raises(mottle.InvalidInput, match="tests_file: there are no tests"):
        study(None, tests_file="new.csv")


def test_tables_of_results_have_all_digits(tmp_path):
    pytest.importorskip("pandas")
    result = mottle.Study.from_dict(three_masses(), tests=TESTS).update(tmp_path)
    table = mottle.load(tmp_path).table("cloud-final")
    assert np.array_equal(table[["k1", "k2"]].to_numpy(), result.cloud_final.samples)


def test_reports_live_as_long_as_the_interpreter(monkeypatch):
    opened = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    first = mottle.Study.from_dict(three_masses(), tests=TESTS).update().report()
    second = mottle.Study.from_dict(three_masses(), tests=TESTS).update().report()
    assert first != second and first.is_file() and second.is_file()
    assert opened == [first.as_uri(), second.as_uri()]


def test_seeds_threads_and_cards(examples):
    file = examples / "01-three-masses" / "case1.toml"
    for seed in (-1, 2**63, 1.0):
        with pytest.raises(mottle.InvalidInput, match="seed: "):
            mottle.Study.read(file, seed=seed)
    assert mottle.Study.read(file, seed=np.int64(7)).seed == 7
    with pytest.raises(mottle.InvalidInput, match="threads: 1.5"):
        mottle.Study.read(file).update(threads=1.5)
    deck = examples / "02-airframe" / "airframe.bdf"
    with pytest.raises(mottle.InvalidInput, match="count: 2.5"):
        mottle.modes(deck, 2.5)
