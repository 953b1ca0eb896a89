"""Stiffness and mass matrices as solvers write and read them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Union

import numpy as np

from mottle import _engine, _sparse
from mottle._files import write_new
from mottle.errors import InvalidInput


@dataclass(frozen=True, eq=False)
class Matrix:
    """A symmetric matrix of a file.

    Attributes:
        values: scipy.sparse, both triangles.
        names: of the rows, "101:+Z", "101:+RX"; empty where the file has none.
        fixed_rows: that the solver fixed by a penalty on the diagonal.
    """

    values: Any
    names: list[str]
    fixed_rows: list[int]

    def __repr__(self) -> str:
        return f"<mottle.Matrix: {self.values.shape[0]} rows, {self.values.nnz} entries>"


def read_matrix(location: Union[str, "os.PathLike[str]"]) -> Matrix:
    """Reads a matrix of Matrix Market, CalculiX (.sti, .mas), Abaqus, Nastran (DMIG, OUTPUT4), Harwell-Boeing (ANSYS) or
    HDF5.

    Args:
        location: the file, and behind a '#' the matrix's name in a file of several: "model.op4#KAA".
    """
    triangle, names, fixed_rows = _engine.read_matrix(os.fspath(location))
    return Matrix(_sparse.symmetric(triangle), names, fixed_rows)


def _lower(given: Any, what: str) -> Any:
    """The lower triangle of a symmetric matrix; an array is taken as one, too."""
    from scipy import sparse

    values = given.values if isinstance(given, Matrix) else given
    matrix = values if sparse.issparse(values) else sparse.csc_matrix(np.asarray(values))
    triangle = _sparse.lower(matrix, what)
    difference = abs(matrix - matrix.T)
    if difference.nnz and difference.max() > 1e-9 * abs(matrix).max():
        raise InvalidInput(f"{what}: is not symmetric; K and M are")
    return triangle


def write_matrix(
    location: Union[str, "os.PathLike[str]"], matrix: Any, *, names: Sequence[str] | None = None
) -> None:
    """Writes symmetric matrices as solvers read them; all numbers read back exactly.

    Args:
        location: the file, by whose extension the format is known. .mtx: Matrix Market, whose rows' names go into a file
            .dof beside it, which `read_matrix` and studies find there. .op4: Nastran's OUTPUT4, binary, without names of
            rows; the matrix's name stands behind a '#': "model.op4#KAA".
        matrix: scipy.sparse, an array, or a `Matrix`, with its names; for OUTPUT4 also a dictionary of several by name.
        names: of the rows, "101:+Z"; None: those of a `Matrix`.

    Raises:
        InvalidInput: another extension, a matrix that is not square or not symmetric, a name that Nastran does not allow.
    """
    place, _, name = os.fspath(location).partition("#")
    file = Path(place)
    if file.suffix.lower() == ".op4":
        if names is not None:
            raise InvalidInput(f"{file}: names: OUTPUT4 has none of rows; write .mtx")
        several = matrix if isinstance(matrix, Mapping) else {name or "MATRIX": matrix}
        write_new(file, b"".join(_engine.output4_bytes(_lower(each, title), str(title)) for title, each in several.items()))
        return
    if file.suffix.lower() != ".mtx" or name or isinstance(matrix, Mapping):
        raise InvalidInput(f"{location}: Matrix Market is a file .mtx of one matrix, OUTPUT4 a file .op4 of one or several")
    triangle = _lower(matrix, "matrix")
    titles = list(names) if names is not None else matrix.names if isinstance(matrix, Matrix) else []
    if titles and len(titles) != triangle.shape[0]:
        raise InvalidInput(f"names: {len(titles)} for {triangle.shape[0]} rows; each row has one")
    beside = file.with_suffix(".dof")
    if titles:
        wrong = [each for each in titles if not isinstance(each, str) or not each or any(c.isspace() for c in each)]
        if wrong:
            raise InvalidInput(f"names: {wrong[0]!r}; a name is a text without blanks, like '101:+Z'")
        write_new(beside, "".join(f"{each}\n" for each in titles).encode())
    elif beside.exists():
        raise InvalidInput(f"{beside}: is there, and would be taken for the names of this matrix's rows; move it, or give names")
    write_new(file, _engine.matrix_market_text(triangle))
