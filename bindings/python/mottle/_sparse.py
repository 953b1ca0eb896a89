"""Sparse symmetric matrices as the engine takes and gives them: lower triangles."""

from __future__ import annotations

from typing import Any

import numpy as np

from mottle.errors import InvalidInput


def lower(matrix: Any, what: str, size: int | None = None) -> Any:
    """The lower triangle of a matrix of scipy.sparse, which alone is read; `size`: that of the others."""
    from scipy import sparse

    if not sparse.issparse(matrix):
        raise InvalidInput(f"{what}: {type(matrix).__name__} is no sparse matrix; give one of scipy.sparse")
    if matrix.shape[0] != matrix.shape[1] or matrix.shape[0] != (size or matrix.shape[0]):
        raise InvalidInput(f"{what}: shape {matrix.shape}; all matrices are square and of one size")
    if np.iscomplexobj(matrix):
        raise InvalidInput(f"{what}: complex numbers; real ones are needed")
    triangle = sparse.csc_matrix(sparse.tril(matrix), dtype=float)
    triangle.sort_indices()
    if not np.isfinite(triangle.data).all():
        raise InvalidInput(f"{what}: an entry is not finite")
    return triangle


def symmetric(triangle: Any) -> Any:
    """The whole matrix, by columns. Entries that are zero stay: orderings are found faster where the equations of a node
    have one pattern."""
    from scipy import sparse

    entries = triangle.tocoo()
    below = entries.row != entries.col
    rows, columns = entries.row, entries.col
    whole = np.concatenate([rows, columns[below]]), np.concatenate([columns, rows[below]])
    return sparse.csc_matrix((np.concatenate([entries.data, entries.data[below]]), whole), shape=triangle.shape)
