"""Tables and arrays that users give: data frames, dictionaries, arrays."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mottle.errors import InvalidInput

Array = npt.NDArray[np.float64]

_MA: Any = np.ma  # whose functions have no types

_KINDS = {"c": "complex numbers", "M": "dates", "m": "spans of time", "U": "text", "S": "text", "V": "records"}


def real(values: Any, what: str, *, may_be_missing: bool = False) -> Array:
    """An array of real numbers.

    Args:
        values: numbers in any nesting that NumPy takes, or a masked array.
        what: where, for messages.
        may_be_missing: masked entries, None and pandas.NA are nan; else refused.
    """
    if isinstance(values, (list, tuple)) and any(isinstance(each, np.ma.MaskedArray) for each in values):
        values = _MA.array(values)
    mask = _MA.getmaskarray(values) if isinstance(values, np.ma.MaskedArray) else None
    try:
        array = np.asarray(values)
    except (ValueError, TypeError):
        raise InvalidInput(f"{what}: {type(values).__name__} of rows of different lengths or kinds is no array") from None
    if array.dtype.kind in _KINDS:
        raise InvalidInput(f"{what} holds {_KINDS[array.dtype.kind]}; real numbers are needed")
    if array.dtype.kind == "O":
        numbers = np.array([_entry(each, what, may_be_missing) for each in array.ravel()], dtype=float).reshape(array.shape)
    else:
        numbers = np.array(array, dtype=float)
    if mask is not None and mask.any():
        if not may_be_missing:
            raise InvalidInput(f"{what} has a masked entry; a number is needed")
        numbers[mask] = np.nan
    return numbers


def _entry(value: Any, what: str, may_be_missing: bool) -> float:
    if value is None or value is np.ma.masked or type(value).__name__ == "NAType":
        if may_be_missing:
            return np.nan
        raise InvalidInput(f"{what} has an entry without value; a number is needed")
    if isinstance(value, (int, float, np.integer, np.floating, np.bool_, Decimal, Fraction)):
        return float(value)
    raise InvalidInput(f"{what} holds {value!r} ({type(value).__name__}); real numbers are needed")


def names_and_values(
    table: Any, what: str, names: Sequence[str] | None = None, *, may_be_missing: bool = True
) -> tuple[list[str], Array]:
    """Names of the columns and the values [row x column] of a DataFrame, a dictionary, a pair (names, array), or, where
    `names` are known, an array alone."""
    if hasattr(table, "columns") and hasattr(table, "to_numpy"):
        titles = _titles(table.columns, what)
        return titles, _columns(titles, [table[column] for column in table.columns], what, may_be_missing)
    if isinstance(table, Mapping):
        titles = _titles(table, what)
        return titles, _columns(titles, table.values(), what, may_be_missing)
    if isinstance(table, tuple) and len(table) == 2 and not np.isscalar(table[0]) and _is_names(table[0]):
        titles, values = _titles(table[0], what), table[1]
    elif names is not None:
        titles, values = list(names), table
    else:
        raise InvalidInput(
            f"{what}: {type(table).__name__} is no table; give a DataFrame, a dictionary of columns, or a pair (names, "
            "array)"
        )
    array = real(values, what, may_be_missing=may_be_missing)
    if array.ndim != 2 or array.shape[1] != len(titles):
        raise InvalidInput(
            f"{what}: shape {array.shape}, a row for each specimen or sample and {len(titles)} columns are needed"
        )
    return titles, array


def _is_names(given: Any) -> bool:
    return all(isinstance(each, str) for each in given)


def _titles(given: Iterable[Any], what: str) -> list[str]:
    titles = [str(each) for each in given]
    if not titles:
        raise InvalidInput(f"{what}: there is no column")
    for place, title in enumerate(titles):
        if not title.strip():
            raise InvalidInput(f"{what}: column {place + 1} has no name")
        if title in titles[:place]:
            raise InvalidInput(f"{what}: the name {title!r} is given twice, to columns {titles.index(title) + 1} and {place + 1}")
    return titles


def _columns(titles: list[str], columns: Iterable[Any], what: str, may_be_missing: bool) -> Array:
    found = [np.atleast_1d(real(values, f"{what}: column {title!r}", may_be_missing=may_be_missing))
             for title, values in zip(titles, columns)]
    if any(column.ndim != 1 for column in found):
        raise InvalidInput(f"{what}: a column has more than one dimension")
    if len({len(column) for column in found}) != 1:
        lengths = ", ".join(f"{title}: {len(column)}" for title, column in zip(titles, found))
        raise InvalidInput(f"{what}: columns of different lengths ({lengths})")
    return np.column_stack(found)


def points(table: Any, names: Sequence[str]) -> tuple[list[str], Array]:
    """Parameters of samples [sample x parameter], of which each has a value."""
    titles, values = names_and_values(table, "points", names, may_be_missing=False)
    wrong = np.argwhere(~np.isfinite(values))
    if len(wrong):
        row, column = wrong[0]
        raise InvalidInput(f"points: row {row + 1}: {titles[column]} is {values[row, column]}; a finite number is needed")
    return titles, values


def by_name(given: Any, names: Sequence[str], what: str) -> Array:
    """A number for each output: one for all, one each in their order, or by name (a dictionary, a pandas Series), where
    those that are not named have 0. None: empty."""
    if given is None:
        return np.zeros(0)
    if hasattr(given, "items") and hasattr(given, "index"):  # a Series
        labels = [str(label) for label in given.index]
        given = dict(zip(_titles(labels, what), given.to_numpy()))
    if isinstance(given, Mapping):
        unknown = [name for name in given if name not in names]
        if unknown:
            raise InvalidInput(f"{what}: {unknown[0]!r} is no output; outputs are {', '.join(names)}")
        each = [real(given.get(name, 0.0), f"{what}: {name}") for name in names]
        for name, number in zip(names, each):
            if number.ndim:
                raise InvalidInput(f"{what}: {name}: shape {number.shape}; one number is needed")
        numbers = np.array(each, dtype=float)
    else:
        numbers = real(given, what)
        if numbers.shape not in ((), (len(names),)):
            raise InvalidInput(f"{what}: shape {numbers.shape}; one number, or {len(names)}, one for each output, are needed")
        numbers = np.broadcast_to(numbers, (len(names),)).copy()
    for name, number in zip(names, numbers):
        if not 0.0 <= number < np.inf:
            raise InvalidInput(f"{what}: {name}: {number} is negative or not finite")
    return numbers


def correlation(given: Any, names: Sequence[str]) -> Array:
    """[parameter x parameter]; a DataFrame by its names. None: 0 x 0."""
    if given is None:
        return np.zeros((0, 0))
    if hasattr(given, "columns") and hasattr(given, "loc"):
        if {*map(str, given.columns)} != {*names} or {*map(str, given.index)} != {*names}:
            raise InvalidInput(f"correlation: rows and columns of the DataFrame are named as the parameters, {', '.join(names)}")
        given = given.loc[list(names), list(names)].to_numpy()
    array = real(given, "correlation")
    if array.shape != (len(names), len(names)):
        raise InvalidInput(f"correlation: shape {array.shape}, ({len(names)}, {len(names)}) is needed")
    return array


def csv_text(names: Sequence[str], values: Array) -> str:
    """Digits that read back exactly; nan is written as such, as an empty line would be no row."""
    for name in names:
        if "\n" in name or "\r" in name:
            raise InvalidInput(f"column {name!r}: a name has no line break")
    head = ",".join('"' + name.replace('"', '""') + '"' for name in names)
    rows = [",".join(repr(float(value)) for value in row) for row in values]
    return "\n".join([head, *rows]) + "\n"


_KEPT = "# Written by mottle.Study.from_dict, which may write it anew.\n"


def keep_csv(file: Path, text: str) -> None:
    """Writes a table that later runs find at the same place; a file that is not such a table is not touched."""
    if file.exists():
        there = file.read_text(encoding="utf-8", errors="replace")
        if there == _KEPT + text:
            return
        if not there.startswith(_KEPT):
            raise InvalidInput(f"{file}: is there already and is none of mottle's; name another as tests_file")
    file.parent.mkdir(parents=True, exist_ok=True)
    new = file.with_name(f"{file.name}.{os.getpid()}.new")
    new.write_text(_KEPT + text, encoding="utf-8")
    os.replace(new, file)
