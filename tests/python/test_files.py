"""Universal files, matrices and decks as plain arrays."""

import numpy as np
import pytest

import mottle
from conftest import ROOT


def test_a_universal_file_by_its_columns(tmp_path):
    """As the format's documentation has them: datasets 15, 55 and 58."""
    lines = ["    -1", "    15", "         1         0         0         8  1.00000E+00  2.50000E+00 -3.00000E-01", "    -1",
             "    -1", "    55", "first bending", "NONE", "NONE", "NONE", "NONE",
             "         1         2         2         8         2         3", "         2         4         1         7",
             "  1.25000E+01  2.00000E+00  1.00000E-02  0.00000E+00", "         1", "  1.00000E-01 -2.00000E-01  3.00000E-01",
             "    -1", "    -1", "    58", "NONE", "NONE", "NONE", "NONE", "NONE",
             "    4         1    0         0       NONE         1   3       NONE         1  -1",
             "         5         3         1  1.00000E+01  5.00000E-01  0.00000E+00",
             "        18    0    0    0 Frequency            Hz", "        12    0    0    0 Acceleration         NONE",
             "        13    0    0    0 Force                NONE", "         0    0    0    0 NONE                 NONE",
             "  1.00000E+00  2.00000E+00  3.00000E+00  4.00000E+00  5.00000E+00  6.00000E+00", "    -1"]
    (tmp_path / "test.uff").write_text("\n".join(lines) + "\n")
    found = mottle.read_uff(tmp_path / "test.uff")
    assert found.nodes.ids.tolist() == [1] and found.nodes.positions.tolist() == [[1.0, 2.5, -0.3]]
    (shape,) = found.shapes
    assert (shape.frequency, shape.modal_mass, shape.viscous_damping, shape.mode) == (12.5, 2.0, 0.01, 7)
    assert shape.values.tolist() == [[0.1, -0.2, 0.3]] and shape.values.dtype == float and shape.titles[0] == "first bending"
    (function,) = found.functions
    assert function.abscissa.tolist() == [10.0, 10.5, 11.0] and function.values.tolist() == [1 + 2j, 3 + 4j, 5 + 6j]
    assert (function.response_node, function.response_direction, function.reference_direction) == (1, 3, -1)
    assert function.abscissa_axis.unit.strip() == "Hz" and function.type == 4


def everything():
    rng = np.random.default_rng(1)
    ids = [3, 7, 200000000]
    return mottle.UffFile(
        nodes=mottle.UffNodes(ids, rng.normal(size=(3, 3)), displacement_systems=[0, 5, 0], colors=8),
        shapes=[mottle.UffShape(ids, np.round(rng.normal(size=(3, 6)), 4), frequency=17.5, mode=1, modal_mass=1.0),
                mottle.UffShape(np.array(ids), np.round(rng.normal(size=(3, 3)), 4) * 1j, analysis_type=3, mode=2,
                                eigenvalue=-0.5 + 110j, modal_a=1 + 2j, titles=["a", "b", "c", "d", "e"])],
        functions=[mottle.UffFunction(10.0 + 0.25 * np.arange(9), rng.normal(size=9) + 1j * rng.normal(size=9), type=4,
                                      response_node=3, response_direction=-2, is_binary=True,
                                      abscissa_axis=mottle.UffAxis(18, "Frequency", "Hz")),
                   mottle.UffFunction([0.0, 1.0, 4.0], [1.0, 2.0, 3.0], type=1, reference_name="hammer")],
        trace_lines=[mottle.UffTraceLine(1, [3, 7, 0, 3, 200000000], "frame")],
        elements=[mottle.UffElement(1, 21, [3, 7], beam=(0, 1, 1))],
        systems=[mottle.UffCoordinateSystem(5, kind=1, origin=[1.0, 2.0, 3.0], axes=np.eye(3)[:, [1, 2, 0]], name="barrel")],
        units=mottle.UffUnits(code=5, description="mm", length=1000.0, force=1.0),
        header=["model", "what", "mottle", "today", "now", "mottle", "today"],
    )


@pytest.mark.parametrize("shapes", [55, 2414])
def test_what_is_written_is_read_again(tmp_path, shapes):
    was, file = everything(), tmp_path / "all.uff"
    mottle.write_uff(file, was, shapes=shapes, big_endian=True)
    now = mottle.read_uff(file)
    assert np.array_equal(now.nodes.positions, was.nodes.positions) and now.nodes.ids.tolist() == was.nodes.ids
    assert now.nodes.displacement_systems.tolist() == [0, 5, 0] and now.nodes.colors.tolist() == [8, 8, 8]
    for new, old in zip(now.shapes, was.shapes):
        assert np.array_equal(new.values, old.values) and new.values.dtype == np.asarray(old.values).dtype
        assert list(new.nodes) == list(old.nodes) and new.frequency == old.frequency and new.eigenvalue == old.eigenvalue
    assert now.shapes[1].modal_a == 1 + 2j and now.shapes[1].titles == ["a", "b", "c", "d", "e"]
    for new, old in zip(now.functions, was.functions):
        assert np.array_equal(new.values, old.values) and np.array_equal(new.abscissa, old.abscissa)
    assert now.functions[0].is_binary and now.functions[0].response_direction == -2
    assert now.functions[0].abscissa_axis.label.strip() == "Frequency" and now.functions[1].reference_name.strip() == "hammer"
    assert list(now.trace_lines[0].nodes)[:4] == [3, 7, 0, 3] and now.elements[0].nodes == [3, 7]
    assert np.array_equal(now.systems[0].axes, was.systems[0].axes) and now.systems[0].kind == 1
    assert now.units.length == 1000.0 and [line.strip() for line in now.header] == was.header
    again = tmp_path / "again.uff"
    mottle.write_uff(again, now, shapes=shapes, big_endian=True)
    assert again.read_bytes() == file.read_bytes()
    assert np.allclose(mottle.read_uff(file, si=True).nodes.positions, was.nodes.positions / 1000.0, rtol=1e-15)
    assert not list(tmp_path.glob("*.new"))


def test_texts_keep_bytes_that_are_not_utf8(tmp_path):
    (tmp_path / "a.uff").write_bytes(b"    -1\n    82\n         1         2         1\nFl\xfcgel\n         3         7\n    -1\n")
    read = mottle.read_uff(tmp_path / "a.uff")
    assert read.trace_lines[0].name.strip() == "Fl\udcfcgel"
    mottle.write_uff(tmp_path / "b.uff", read)
    assert b"Fl\xfcgel" in (tmp_path / "b.uff").read_bytes()


def test_what_cannot_be_written_is_refused(tmp_path):
    file = tmp_path / "a.uff"
    file.write_bytes(b"kept")
    shape, function, axis = mottle.UffShape, mottle.UffFunction, mottle.UffAxis
    for contents, message in [
        ({"shapes": [shape([1, 2], np.zeros((3, 3)))]}, r"shapes\[0\]: values: shape"),
        ({"shapes": [shape([1], [[0.0, np.nan, 0.0]])]}, "finite"),
        ({"shapes": [shape([1.5], np.zeros((1, 3)))]}, "nodes"),
        ({"shapes": [shape([1], np.zeros((1, 3)), frequency="high")]}, "frequency"),
        ({"shapes": [shape([1], np.zeros((1, 3)), frequency=np.inf)]}, "not finite"),
        ({"shapes": [shape([1], np.zeros((1, 3)), titles=["one"])]}, "titles"),
        ({"shapes": [axis()]}, "UffShape is needed"),
        ({"functions": [function([0.0, 1.0], [1.0])]}, "abscissa: shape"),
        ({"functions": [function([], [])]}, "at least 1"),
        ({"functions": [function([0.0], [1.0], abscissa_axis=axis(units=(1, 2)))]}, "units"),
        ({"nodes": mottle.UffNodes([1, 1], np.zeros((2, 3)))}, "given twice"),
        ({"nodes": mottle.UffNodes([1, 2], np.zeros((1, 3)))}, "positions: shape"),
        ({"nodes": mottle.UffNodes([1], np.zeros((1, 3)), colors=[1.0])}, "color"),
        ({"nodes": mottle.UffNodes([1], np.zeros((1, 3)), definition_systems=4, are_local=True)}, "dataset 15"),
        ({"nodes": mottle.UffNodes([2**40], np.zeros((1, 3)))}, "id"),
        ({"systems": [mottle.UffCoordinateSystem(1, kind=3)]}, "outside 0 to 2"),
        ({"systems": [mottle.UffCoordinateSystem(1, origin=[0.0])]}, "origin"),
        ({"header": ["one"]}, "seven texts"),
    ]:
        with pytest.raises(mottle.InvalidInput, match=message):
            mottle.write_uff(file, mottle.UffFile(**contents))
    with pytest.raises(mottle.InvalidInput, match="2411"):
        mottle.write_uff(file, everything(), nodes=16)
    with pytest.raises(mottle.InvalidInput, match="cannot be written"):
        mottle.write_uff(tmp_path / "nowhere" / "a.uff", everything())
    with pytest.raises(mottle.InvalidInput, match="nowhere.uff"):
        mottle.read_uff(tmp_path / "nowhere.uff")
    with pytest.raises(mottle.FormatError):
        mottle.read_uff(file)
    assert file.read_bytes() == b"kept"


def test_specimens_of_the_example_are_read():
    for file in sorted((ROOT / "examples" / "05-uff-population" / "specimens").glob("*.uff")):
        found = mottle.read_uff(file)
        first = found.shapes[0]
        assert first.values.shape == (len(first.nodes), 3) and (first.frequency > 0.0 or first.eigenvalue.imag > 0.0)


def test_matrices_of_matrix_market_beside_scipy(tmp_path):
    scipy_io = pytest.importorskip("scipy.io")
    sparse = pytest.importorskip("scipy.sparse")
    random = sparse.random(40, 40, 0.1, random_state=1)
    matrix = random + random.T + sparse.identity(40)
    for symmetry in ("symmetric", "general"):
        file = tmp_path / f"{symmetry}.mtx"
        scipy_io.mmwrite(file, matrix, precision=17, symmetry=symmetry)
        found = mottle.read_matrix(file)
        assert (found.values != scipy_io.mmread(file)).nnz == 0 and found.names == []
    with pytest.raises(mottle.InvalidInput, match="nowhere.mtx"):
        mottle.read_matrix(tmp_path / "nowhere.mtx")


def test_a_deck_as_arrays(examples):
    pytest.importorskip("scipy")
    file = examples / "02-airframe" / "airframe.bdf"
    deck = mottle.read_deck(file)
    lines = file.read_text().splitlines()
    assert deck.nodes.tolist() == sorted(int(line[8:16]) for line in lines if line.startswith("GRID "))
    assert deck.positions.shape == (len(deck.nodes), 3) and len(deck.elements) > 0
    cards = {line[:8].strip() for line in lines}
    assert all({each.card, f"{each.card}1"} & cards and set(each.nodes) <= {0, *deck.nodes} for each in deck.elements)
    count = sum(line.startswith(("CQUAD4", "CBEAM", "CBUSH", "CONM2", "CELAS1")) for line in lines)
    assert len(deck.elements) == count
    assert "mottle.Deck" in repr(deck) and deck.files == [str(file)]
    stiffness, mass, names = deck.matrices()
    assert stiffness.shape == mass.shape == (len(names), len(names)) and "+" in names[0]
    values, _ = mottle.eigsh(stiffness, mass, 12)
    frequencies = np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi)
    assert np.allclose(frequencies[6:], mottle.modes(file, 12).frequencies[6:], rtol=1e-9)


def test_files_that_a_deck_includes_are_written_too(tmp_path):
    (tmp_path / "deck" / "parts").mkdir(parents=True)
    file = tmp_path / "deck" / "main.bdf"
    file.write_text("SOL 103\nCEND\nMETHOD=1\nBEGIN BULK\nEIGRL,1,,,2\nINCLUDE 'parts/rod.bdf'\nGRID,1,,0.,0.,0.,,123456\n"
                    "GRID,2,,1.,0.,0.,,23456\nCELAS2,7,100.,2,1\nCONM2,9,2,,3.\nCROD,1,1,1,2\nENDDATA\n")
    (tmp_path / "deck" / "parts" / "rod.bdf").write_text("MAT1,1,7.+10,,.3,2700.\nPROD,1,1,.01\n")
    deck = mottle.read_deck(file)
    assert deck.elements == [("CROD", 1, [1, 2]), ("CELAS", 7, [2, 0]), ("CONM2", 9, [2])]
    assert deck.write(tmp_path / "new", {"MAT1:1:E": 8e10, "CELAS2:7:K": 55.0}) == 0.0
    assert (tmp_path / "new" / "parts" / "rod.bdf").read_text() == "MAT1,1,8.+10,,.3,2700.\nPROD,1,1,.01\n"
    assert "CELAS2,7,55." in (tmp_path / "new" / "main.bdf").read_text()


def test_a_deck_with_other_numbers(examples, tmp_path):
    file = examples / "02-airframe" / "airframe.bdf"
    deck = mottle.read_deck(file)
    name = next(each for each in deck.numbers if each.startswith("MAT1:") and each.endswith(":E"))
    wanted = 1.21 * deck.numbers[name]
    rounding = deck.write(tmp_path / "new", {name: wanted})
    again = mottle.read_deck(tmp_path / "new" / "airframe.bdf")
    assert rounding < 1e-4 and abs(again.numbers[name] / wanted - 1.0) <= rounding
    assert {**deck.numbers, name: 0.0} == {**again.numbers, name: 0.0}
    changed = [a != b for a, b in zip(file.read_text().splitlines(), (tmp_path / "new" / "airframe.bdf").read_text().splitlines())]
    assert sum(changed) == 1
    with pytest.raises(mottle.InvalidInput, match="there already"):
        deck.write(tmp_path / "new", {name: wanted})
    with pytest.raises(mottle.InvalidInput, match="is no number"):
        deck.write(tmp_path / "other", {name + "E": wanted})
    with pytest.raises(mottle.InvalidInput, match="no number"):
        deck.write(tmp_path / "other", {name: "high"})
    assert not (tmp_path / "other").exists()
