"""Tables that users give: data frames, dictionaries, arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mottle.errors import InvalidInput


def names_and_values(
    table: Any, what: str, names: Sequence[str] | None = None
) -> tuple[list[str], npt.NDArray[np.float64]]:
    """Names of the columns and the values [row x column] of a DataFrame, a dictionary, a pair (names, array), or, where
    `names` are known, an array alone."""
    if hasattr(table, "columns") and hasattr(table, "to_numpy"):
        return _checked([str(column) for column in table.columns], table.to_numpy(dtype=float, na_value=np.nan), what)
    if isinstance(table, Mapping):
        columns = [np.atleast_1d(np.asarray(values, dtype=float)) for values in table.values()]
        if len({column.shape for column in columns}) != 1:
            lengths = ", ".join(f"{name}: {len(column)}" for name, column in zip(table, columns))
            raise InvalidInput(f"{what}: columns of different lengths ({lengths})")
        return _checked([str(name) for name in table], np.column_stack(columns), what)
    if isinstance(table, tuple) and len(table) == 2 and not np.isscalar(table[0]):
        return _checked([str(name) for name in table[0]], np.asarray(table[1], dtype=float), what)
    if names is not None:
        return _checked(list(names), np.asarray(table, dtype=float), what)
    raise InvalidInput(
        f"{what}: {type(table).__name__} is no table; give a DataFrame, a dictionary of columns, or a pair (names, array)"
    )


def _checked(names: list[str], values: npt.NDArray[np.float64], what: str) -> tuple[list[str], npt.NDArray[np.float64]]:
    if values.ndim != 2 or values.shape[1] != len(names):
        raise InvalidInput(
            f"{what}: shape {values.shape}, a row for each specimen or sample and {len(names)} columns are needed"
        )
    return names, values


def write_csv(file: Path, names: Sequence[str], values: npt.NDArray[np.float64]) -> None:
    """Writes digits that read back exactly; nan is an empty cell."""
    for name in names:
        if any(c in name for c in ',"\n\r'):
            raise InvalidInput(f"column {name!r}: a name has no comma, quote or line break")
    rows = [",".join("" if np.isnan(v) else repr(float(v)) for v in row) for row in values]
    file.write_text("\n".join([",".join(names), *rows]) + "\n", encoding="utf-8")
