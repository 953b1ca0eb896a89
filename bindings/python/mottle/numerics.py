"""Numerical routines that stand alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from mottle import _checks, _engine, _sparse
from mottle.errors import InvalidInput
from mottle.tables import Array, real


def eigsh(
    stiffness: Any, mass: Any, k: int = 10, *, tolerance: float = 1e-10, verify: bool = False
) -> tuple[Array, Array]:
    """The lowest eigenvalues of K x = lambda M x, K positive semi-definite, M positive semi-definite, both symmetric.

    Block Lanczos, shift-inverted below the spectrum; rigid-body modes and repeated eigenvalues are found. The equations of
    a node are best rows that follow each other: the ordering finds the nodes by them.

    Args:
        stiffness, mass: scipy.sparse matrices; only their lower triangles are read.
        k: how many.
        tolerance: relative residual of the shift-inverted problem.
        verify: counts the eigenvalues below by the inertia of K - s M, and raises SystemFailure if one was missed.

    Returns:
        Eigenvalues, ascending [mode], and vectors with x' M x = 1 [row x mode].

    Raises:
        InvalidInput: M is not positive semi-definite; the message names a row.
    """
    lower = [_sparse.lower(stiffness, "stiffness"), _sparse.lower(mass, "mass", stiffness.shape[0])]
    _checks.whole(k, "k", 1, stiffness.shape[0])
    _checks.number(tolerance, "tolerance", 0.0, 1.0)
    return _engine.modes_of(lower[0], lower[1], count=k, tolerance=tolerance, counts=verify)


def _as_shapes(given: npt.ArrayLike, name: str) -> Array:
    shapes = real(given, f"mac: {name}")
    if shapes.ndim not in (1, 2):
        raise InvalidInput(f"mac: {name}: shape {shapes.shape}; [degree of freedom x mode] is needed")
    return shapes[:, None] if shapes.ndim == 1 else shapes


def mac(a: npt.ArrayLike, b: npt.ArrayLike) -> Array:
    """Modal assurance criterion of every pair of real shapes [degree of freedom x mode]: [mode of a x mode of b].

    A shape alone may have one dimension.
    """
    first, second = _as_shapes(a, "a"), _as_shapes(b, "b")
    if first.shape[0] != second.shape[0]:
        raise InvalidInput(f"mac: {first.shape[0]} and {second.shape[0]} degrees of freedom; they are the same for both")
    return _engine.mac(first, second)


def assign(score: npt.ArrayLike) -> npt.NDArray[np.int_]:
    """The distinct column of each row that makes the sum of the chosen entries largest, as for pairing modes by MAC."""
    matrix = real(score, "assign: score")
    if matrix.ndim != 2 or matrix.shape[0] > matrix.shape[1]:
        raise InvalidInput(f"assign: shape {matrix.shape}; a matrix with no more rows than columns is needed")
    return np.array(_engine.optimal_assignment(matrix), dtype=int)


@dataclass(frozen=True)
class TwoSampleTest:
    """Hotelling's test that two normal populations of one covariance have one mean."""

    t_squared: float
    f: float
    p_value: float
    critical_t_squared: float
    df1: int
    df2: int
    rejects: bool


def hotelling(a: npt.ArrayLike, b: npt.ArrayLike, *, level: float = 0.05) -> TwoSampleTest:
    """Hotelling's two-sample test.

    Args:
        a, b: samples [specimen x output].
        level: false-alarm rate.
    """
    samples = [real(a, "hotelling: a"), real(b, "hotelling: b")]
    _checks.number(level, "level", 0.0, 1.0)
    for each in samples:
        if each.ndim != 2 or each.shape[1] != samples[0].shape[1] or each.shape[0] < 1:
            raise InvalidInput(f"hotelling: shapes {samples[0].shape} and {samples[1].shape}; a row for each specimen and "
                               "the same outputs are needed")
        if not np.isfinite(each).all():
            raise InvalidInput("hotelling: a value is not finite")

    def moments(x: Array) -> tuple[Array, Array, int]:
        p = x.shape[1]
        covariance = np.cov(x, rowvar=False).reshape(p, p) if len(x) > 1 else np.zeros((p, p))
        return x.mean(axis=0), covariance, len(x)

    return TwoSampleTest(**_engine.two_sample_test(*moments(samples[0]), *moments(samples[1]), level=level))


def methods() -> dict[str, dict[str, Any]]:
    """Every updating method by name: its summary, and its options with unit, allowed values, default and meaning."""
    return {
        method["name"]: {"summary": method["summary"], "options": {o["name"]: o for o in method["options"]}}
        for method in _engine.methods()
    }
