"""Finite-element decks without a study: their modes and numbers."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

import numpy as np
import numpy.typing as npt

from mottle import _checks, _engine
from mottle.tables import Array

if TYPE_CHECKING:
    import pandas

PathLike = Union[str, "os.PathLike[str]"]


class Modes:
    """Natural frequencies and shapes of a deck."""

    def __init__(self, engine: _engine.ModesOutcome) -> None:
        self._engine = engine

    @property
    def frequencies(self) -> Array:
        """In Hz where the deck's unit of time is the second [mode]."""
        return self._engine.frequencies

    @property
    def residuals(self) -> Array:
        """Relative residuals of the eigenvalue problem [mode]."""
        return self._engine.residuals

    @cached_property
    def _grid(self) -> tuple[list[int], Array, list[Array]]:
        return self._engine.shapes()

    @property
    def nodes(self) -> npt.NDArray[np.int_]:
        """Ids of the grid points."""
        return np.array(self._grid[0], dtype=int)

    @property
    def positions(self) -> Array:
        """Of the grid points, basic coordinate system [node x 3]."""
        return self._grid[1]

    @cached_property
    def shapes(self) -> Array:
        """Displacements, of modal mass 1, basic coordinate system [mode x node x 3]."""
        return np.array(self._grid[2])

    def summary(self) -> str:
        """What the command prints."""
        return "\n".join(self._engine.summary())

    __str__ = summary

    def __repr__(self) -> str:
        return f"<mottle.Modes: {', '.join(f'{f:.6g}' for f in self.frequencies)} Hz>"


def chosen_cards(ignore_cards: str | Iterable[str], subcase: int | None) -> dict[str, Any]:
    """What is read of a deck; a text alone names one card."""
    cards = [ignore_cards] if isinstance(ignore_cards, str) else ignore_cards
    return {
        "ignore_cards": {card.upper() for card in cards},
        "subcase": None if subcase is None else _checks.whole(subcase, "subcase", 0, 2**31 - 1),
    }


def _asked(count: int, ignore_cards: str | Iterable[str], subcase: int | None) -> dict[str, Any]:
    """What `modes` and `targets` are both asked for."""
    return {"modes": _checks.whole(count, "count", 0, 2**31 - 1), **chosen_cards(ignore_cards, subcase)}


def modes(
    deck: PathLike, count: int = 0, *, ignore_cards: str | Iterable[str] = (), subcase: int | None = None
) -> Modes:
    """The lowest modes of a Nastran deck, none missed.

    Args:
        deck: the file.
        count: how many; 0: what its EIGRL asks for, else 10.
        ignore_cards: names of cards to leave out, or one name.
        subcase: its id; None: the first that asks for modes.
    """
    return Modes(_engine.find_modes(Path(deck), **_asked(count, ignore_cards, subcase)))


@dataclass(frozen=True)
class Targets:
    """The numbers of a deck that can be parameters, the most sensitive first."""

    frequencies: Array
    names: list[str]
    values: Array
    units: list[str]
    sensitivity: Array
    """d ln f / d ln p [target x mode]; nan of rigid-body modes."""
    notes: list[str]

    def to_pandas(self) -> pandas.DataFrame:
        """A row for each target."""
        import pandas

        table = pandas.DataFrame({"value": self.values, "unit": self.units}, index=pandas.Index(self.names, name="target"))
        for k in range(self.sensitivity.shape[1]):
            table[f"f{k + 1}"] = self.sensitivity[:, k]
        return table

    def __repr__(self) -> str:
        return f"<mottle.Targets: {len(self.names)}, first {', '.join(self.names[:3])}>"


def targets(
    deck: PathLike,
    count: int = 0,
    *,
    ignore_cards: str | Iterable[str] = (),
    subcase: int | None = None,
    units: str | None = None,
    all: bool = False,
) -> Targets:
    """The numbers of a deck (Nastran, CalculiX) that can be parameters, and what each does to the modes.

    Args:
        deck, count, ignore_cards, subcase: as of `modes`.
        units: "SI", "mm-t-s", "mm-kg-ms", "in-lbf-s"; only named. None: guessed from the materials.
        all: also numbers that are zero, change no mode or are seldom wrong.
    """
    frequencies, found, notes = _engine.find_targets(
        Path(deck), units=units, lists_all=all, **_asked(count, ignore_cards, subcase)
    )
    sensitivity = np.array([target.sensitivity for target in found]).reshape(len(found), len(frequencies))
    return Targets(
        frequencies=frequencies,
        names=[target.name for target in found],
        values=np.array([target.value for target in found]),
        units=[target.unit for target in found],
        sensitivity=sensitivity,
        notes=notes,
    )
