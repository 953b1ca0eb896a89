"""Nastran decks as plain arrays, and with other numbers in them."""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from mottle import _checks, _engine, _sparse
from mottle._files import write_new
from mottle.decks import PathLike, chosen_cards
from mottle.errors import InvalidInput
from mottle.tables import Array


class Element(NamedTuple):
    """An element: its card (CELAS of CELAS1 to CELAS4), its id and the ids of its nodes (0: ground, or left out)."""

    card: str
    id: int
    nodes: list[int]


class Deck:
    """A Nastran deck as Mottle reads it. `mottle.read_deck` makes it."""

    def __init__(self, file: Path, asked: dict[str, Any]) -> None:
        self.file = file
        self._asked = asked
        self._engine = _engine.read_deck(file, **asked)

    @cached_property
    def _nodes(self) -> tuple[list[int], Array]:
        return self._engine.nodes()

    @property
    def nodes(self) -> npt.NDArray[np.int_]:
        """Ids of grid and scalar points, ascending [node]."""
        return np.array(self._nodes[0], dtype=int)

    @property
    def positions(self) -> Array:
        """Of the nodes, basic coordinate system; nan of scalar points [node x 3]."""
        return self._nodes[1]

    @cached_property
    def elements(self) -> list[Element]:
        """All elements, by kind."""
        return [Element(*each) for each in self._engine.elements()]

    @cached_property
    def numbers(self) -> dict[str, float]:
        """The numbers that a parameter may act on: {"MAT1:2:E": 7.0e10, ...}."""
        return dict(self._engine.numbers())

    @property
    def files(self) -> list[str]:
        """Every file that was read, the main one first."""
        return self._engine.files

    @property
    def notes(self) -> list[str]:
        """What was left out, assumed or repaired."""
        return self._engine.notes

    def matrices(self) -> tuple[Any, Any, list[str]]:
        """Stiffness and mass of the equations (scipy.sparse), and the names of the rows, "101:+Z". Zeros of the stiffness that
        belong to the pattern of a node stay: `mottle.eigsh` is faster with them."""
        stiffness, mass, names = self._engine.matrices()
        whole = _sparse.symmetric(mass)
        whole.eliminate_zeros()
        return _sparse.symmetric(stiffness), whole, names

    def write(self, folder: PathLike, numbers: Mapping[str, float]) -> float:
        """Writes the deck, and the files that it includes, with other numbers in it; all other lines stay as they are.

        Args:
            folder: made where it is not there; files of these names must not be there.
            numbers: new values by name, as in `numbers`.

        Returns:
            The largest relative difference of a number as written from the one wanted, as wide as the fields are.

        Raises:
            InvalidInput: a number that is not on a card of its own, or a file that would be written over or lies outside
                of the folder of the deck.
        """
        changes = [(*self._field(name), _checks.number(value, name)) for name, value in numbers.items()]
        written, rounding = _engine.rewrite_deck(self.file, numbers=changes, **self._asked)
        home = self.file.resolve().parent
        contents = {}
        for name, content in written:
            path = Path(name).resolve()
            if home not in path.parents:
                raise InvalidInput(f"{name}: is outside of the folder of {self.file}; copy it there and include it from there")
            contents[Path(folder) / path.relative_to(home)] = content
        for path in contents:
            if path.exists():
                raise InvalidInput(f"{path}: is there already; name another folder")
        for path, content in contents.items():
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise InvalidInput(f"{path.parent}: cannot be made: {error.strerror}") from None
            write_new(path, content)
        return rounding

    def _field(self, name: str) -> tuple[str, int, str]:
        if name not in self.numbers:
            close = difflib.get_close_matches(str(name), self.numbers, 3)
            raise InvalidInput(f"{name!r} is no number of {self.file}{'; near are ' + ', '.join(close) if close else ''}")
        card, number, field = name.split(":")
        return card, int(number), field

    def __repr__(self) -> str:
        return f"<mottle.Deck {os.fspath(self.file)}: {len(self.nodes)} nodes, {len(self.elements)} elements>"


def read_deck(deck: PathLike, *, ignore_cards: str | Iterable[str] = (), subcase: int | None = None) -> Deck:
    """Reads a Nastran deck.

    Args:
        deck, ignore_cards, subcase: as of `mottle.modes`.
    """
    return Deck(Path(deck), chosen_cards(ignore_cards, subcase))
