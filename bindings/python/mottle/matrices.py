"""Stiffness and mass matrices as solvers write them."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Union

from mottle import _engine, _sparse


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
