"""Decks without a study."""

import csv

import numpy as np
import pytest

import mottle


def test_modes_and_targets_of_the_airframe(examples, command, tmp_path):
    deck = next((examples / "02-airframe").glob("*.bdf"))
    found = mottle.modes(deck, 8)
    command("modes", deck, "--modes", "8", "--out", tmp_path / "modes")
    with open(tmp_path / "modes" / "modes.csv", encoding="utf-8") as table:
        wanted = [float(row["frequency"]) for row in csv.DictReader(table)]
    assert np.array_equal(found.frequencies, wanted)
    assert found.shapes.shape == (8, len(found.nodes), 3) and found.positions.shape == (len(found.nodes), 3)
    assert "none missed" in str(found) and "Hz" in repr(found)
    targets = mottle.targets(deck, 8)
    assert targets.sensitivity.shape == (len(targets.names), 8)
    pytest.importorskip("pandas")
    assert list(targets.to_pandas().index) == targets.names


def test_a_deck_that_is_not_there():
    with pytest.raises(mottle.InvalidInput, match="nowhere.bdf"):
        mottle.modes("nowhere.bdf")


def test_one_card_may_be_left_out_by_its_name_alone(examples):
    deck = examples / "02-airframe" / "airframe.bdf"
    deck.write_text(deck.read_text().replace("ENDDATA", "CGROUT,1,2\nENDDATA"))
    for call in (mottle.modes, mottle.targets):
        with pytest.raises(mottle.InvalidInput, match="CGROUT"):
            call(deck, 2)
    for cards in ("cgrout", ["CGROUT"]):
        assert len(mottle.modes(deck, 2, ignore_cards=cards).frequencies) == 2
    assert mottle.targets(deck, 2, ignore_cards="CGROUT").names
