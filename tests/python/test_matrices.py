"""Matrices as files: what is written is what SciPy reads, record by record, and what Mottle reads again."""

import numpy as np
import pytest

import mottle

sparse = pytest.importorskip("scipy.sparse")
scipy_io = pytest.importorskip("scipy.io")


def random_matrix(size, density=0.1):
    random = sparse.random(size, size, density, random_state=1, data_rvs=lambda n: np.random.default_rng(2).normal(size=n) * 1e7)
    return (random + random.T + 1e-300 * sparse.identity(size)).tocsr()


def output4(file):
    """Name, rows and dense contents of each matrix, by Fortran's records as SciPy finds them and the format's description."""
    with scipy_io.FortranFile(file) as records:
        while True:
            try:
                head = records.read_record("i4")
            except scipy_io.FortranEOFError:
                return
            columns, rows, form, kind = head[:4]
            assert (columns, form, kind) == (abs(rows), 6, 2)
            entries = []
            while True:
                words = records.read_record("i4")
                column, first_row, count = words[:3]
                if column == columns + 1:
                    assert (first_row, count, words[3:].view("f8")[0]) == (1, 2, 1.0)
                    break
                assert first_row == 0 and count == len(words) - 3
                rest = words[3:]
                while len(rest):
                    length, row, rest = (rest[0], rest[1], rest[2:]) if rows < 0 else (*divmod(rest[0], 65536), rest[1:])
                    values, rest = rest[: length - 1].view("f8"), rest[length - 1:]
                    entries += [(row - 1 + k, column - 1, value) for k, value in enumerate(values)]
            i, j, values = zip(*entries)
            yield head[4:].tobytes().decode().strip(), rows, sparse.csr_matrix((values, (i, j)), shape=(columns, columns))


def same(a, b):
    return (sparse.csr_matrix(a) != sparse.csr_matrix(b)).nnz == 0


def test_matrix_market_reads_back_by_scipy_and_mottle(tmp_path):
    matrix, file = random_matrix(60), tmp_path / "k.mtx"
    names = [f"{row // 3 + 1}:+{'XYZ'[row % 3]}" for row in range(60)]
    mottle.write_matrix(file, matrix, names=names)
    assert same(scipy_io.mmread(file), matrix)
    found = mottle.read_matrix(file)
    assert same(found.values, matrix) and found.names == names
    mottle.write_matrix(tmp_path / "again.mtx", found)
    assert (tmp_path / "again.dof").read_text().split() == names
    mottle.write_matrix(tmp_path / "array.mtx", matrix.toarray())
    assert same(mottle.read_matrix(tmp_path / "array.mtx").values, matrix)


def test_output4_reads_back_by_its_records_and_by_mottle(tmp_path):
    given = {"KAA": random_matrix(60), "MAA": sparse.identity(60), "BAND": random_matrix(300, 0.9)}
    file = tmp_path / "model.op4"
    mottle.write_matrix(file, given)
    found = list(output4(file))
    assert [name for name, _, _ in found] == list(given)
    for name, rows, matrix in found:
        assert rows == given[name].shape[0] and same(matrix, given[name])
        assert same(mottle.read_matrix(f"{file}#{name}").values, given[name])
    mottle.write_matrix(f"{tmp_path / 'one.op4'}#K", given["KAA"])
    assert same(mottle.read_matrix(f"{tmp_path / 'one.op4'}#K").values, given["KAA"])


def test_output4_of_many_rows_has_bigmat_headers(tmp_path):
    size = 66000
    matrix = sparse.diags([2.0 * np.ones(size), -np.ones(size - 1), -np.ones(size - 1)], [0, -1, 1]).tocsr()
    mottle.write_matrix(tmp_path / "big.op4", {"K": matrix})
    ((name, rows, found),) = output4(tmp_path / "big.op4")
    assert (name, rows) == ("K", -size) and same(found, matrix)
    assert same(mottle.read_matrix(tmp_path / "big.op4").values, matrix)


def test_a_column_longer_than_a_string(tmp_path):
    size = 40000
    arrow = sparse.lil_matrix((size, size))
    arrow[:, 0] = 1.0
    arrow[0, :] = 1.0
    arrow.setdiag(2.0)
    mottle.write_matrix(tmp_path / "arrow.op4", {"K": arrow.tocsr()})
    ((_, rows, found),) = output4(tmp_path / "arrow.op4")
    assert rows == size and same(found, arrow) and same(mottle.read_matrix(tmp_path / "arrow.op4").values, arrow)


def test_a_study_reads_what_was_written(tmp_path):
    chain = sparse.diags([2.0 * np.ones(5), -np.ones(4), -np.ones(4)], [0, -1, 1])
    names = [f"{k}:+X" for k in range(1, 6)]
    mottle.write_matrix(tmp_path / "k.mtx", chain, names=names)
    mottle.write_matrix(tmp_path / "m.mtx", sparse.identity(5), names=names)
    study = mottle.Study.from_dict({
        "model": {"kind": "matrices", "mass": "m.mtx", "terms": [{"name": "k", "stiffness": "k.mtx"}]},
        "parameter": [{"name": "k", "target": "K:k", "distribution": {"kind": "normal", "mean": 4.0, "std": 0.4}}],
        "outputs": {"frequencies": [1]}}, folder=tmp_path)
    wanted = np.sqrt(4.0 * (2.0 - 2.0 * np.cos(np.pi / 6.0))) / (2.0 * np.pi)
    assert np.allclose(study.check().outputs, wanted, rtol=1e-12)


@pytest.mark.parametrize(("location", "matrix", "more", "message"), [
    ("k.txt", np.eye(2), {}, "Matrix Market is a file .mtx"),
    ("k.mtx#K", np.eye(2), {}, "Matrix Market is a file .mtx"),
    ("k.mtx", {"K": np.eye(2)}, {}, "Matrix Market is a file .mtx"),
    ("k.mtx", np.ones((2, 3)), {}, r"shape \(2, 3\)"),
    ("k.mtx", np.array([[1.0, 2.0], [0.0, 1.0]]), {}, "is not symmetric"),
    ("k.mtx", np.eye(2) + 0j, {}, "complex"),
    ("k.mtx", np.diag([1.0, np.nan]), {}, "not finite"),
    ("k.mtx", np.eye(2), {"names": ["1:+X"]}, "names: 1 for 2 rows"),
    ("k.mtx", np.eye(2), {"names": ["1:+X", "2 +X"]}, "'2 [+]X'; a name is a text without blanks"),
    ("k.op4", np.eye(2), {"names": ["1:+X", "2:+X"]}, "names: OUTPUT4 has none"),
    ("k.op4#stiff", np.eye(2), {}, "'stiff': a name of Nastran's"),
    ("k.op4", {"TOOLONGNAME": np.eye(2)}, {}, "'TOOLONGNAME': a name of Nastran's"),
    ("no/k.mtx", np.eye(2), {}, "cannot be written"),
])
def test_what_cannot_be_written_is_refused(tmp_path, location, matrix, more, message):
    with pytest.raises(mottle.InvalidInput, match=message):
        mottle.write_matrix(tmp_path / location, matrix, **more)
    assert not list(tmp_path.iterdir())


def test_names_of_another_matrix_are_not_taken(tmp_path):
    mottle.write_matrix(tmp_path / "k.mtx", np.eye(2), names=["1:+X", "2:+X"])
    with pytest.raises(mottle.InvalidInput, match="would be taken for the names"):
        mottle.write_matrix(tmp_path / "k.mtx", np.eye(2))
