"""Certified reduced models of a family of sparse matrices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from mottle import _checks, _engine, _sparse
from mottle.errors import InvalidInput
from mottle.tables import Array, real


@dataclass(frozen=True, eq=False)
class ReducedModes:
    """Lowest modes of many samples, each with a bound of its error.

    Attributes:
        values: eigenvalues lambda, not below the exact ones [sample x mode]; nan where a sample has none.
        bounds: e, lambda (1 - e) <= exact <= lambda [sample x mode]; infinite where nothing is known.
        coordinates: of the modes in the model's basis [sample x mode x vector].
    """

    values: Array
    bounds: Array
    coordinates: Array
    _basis: Array

    def vectors(self, sample: int) -> Array:
        """The modes of one sample in all rows of the matrices, x' M x = 1 [row x mode]."""
        which = _checks.whole(sample, "sample", 0, len(self.values) - 1)
        return self._basis @ self.coordinates[which].T

    def __repr__(self) -> str:
        return f"<mottle.ReducedModes: {self.values.shape[0]} samples, {self.values.shape[1]} modes>"


class ReducedModel:
    """A reduced model of K(a) = K_0 + sum a_t K_t, M(b) = M_0 + sum b_t M_t, which gives the lowest modes of many samples
    from one factorisation, each with a bound of its error.

        model = mottle.ReducedModel([K1, K2], [], training, constant_mass=M, modes=8)
        modes = model.solve(samples)

    It is trained when it is made, and does not change any more; several threads may use it at once.

    Args:
        stiffness: the terms K_t: scipy.sparse matrices, symmetric; only their lower triangles are read.
        mass: the terms M_t; their sum is positive semi-definite at every sample.
        training: coefficients to train with, where the samples will be: those of K, then those of M [sample x term].
        constant_stiffness, constant_mass: K_0, M_0; None: zero.
        nominal: coefficients of the sample where the basis starts [term]; None: the mean of `training`.
        modes: how many of the lowest.
        tolerance: of an eigenvalue, relative: half of it is that of a frequency.
        max_vectors: largest size of the basis.
        threads: 0: all.
    """

    def __init__(
        self,
        stiffness: Sequence[Any],
        mass: Sequence[Any],
        training: npt.ArrayLike,
        *,
        constant_stiffness: Any = None,
        constant_mass: Any = None,
        nominal: npt.ArrayLike | None = None,
        modes: int = 10,
        tolerance: float = 2e-4,
        max_vectors: int = 400,
        threads: int = 0,
    ) -> None:
        from scipy import sparse

        given = {"constant_stiffness": constant_stiffness, "constant_mass": constant_mass}
        for name, terms in (("stiffness", stiffness), ("mass", mass)):
            if sparse.issparse(terms) or isinstance(terms, np.ndarray):
                raise InvalidInput(f"{name}: a list of terms is needed; a matrix without coefficient is constant_{name}")
            given.update({f"{name}[{t}]": term for t, term in enumerate(terms)})
        size = next((each.shape[0] for each in given.values() if sparse.issparse(each)), 1)
        lower = {
            name: sparse.csc_matrix((size, size)) if each is None and name.startswith("constant") else _sparse.lower(each, name, size)
            for name, each in given.items()
        }
        self._terms = len(stiffness) + len(mass)
        samples = self._coefficients(training, "training")
        centre = samples.mean(axis=1) if nominal is None else real(nominal, "nominal")
        if centre.shape != (self._terms,) or not np.isfinite(centre).all():
            raise InvalidInput(f"nominal: shape {centre.shape}; {self._terms} finite numbers, one for each term, are needed")
        self._engine = _engine.ReducedModel(
            lower["constant_stiffness"],
            [lower[f"stiffness[{t}]"] for t in range(len(stiffness))],
            lower["constant_mass"],
            [lower[f"mass[{t}]"] for t in range(len(mass))],
            nominal=centre,
            training=samples,
            modes=_checks.whole(modes, "modes", 1, size),
            tolerance=_checks.number(tolerance, "tolerance", 1e-12, 1.0),
            max_vectors=_checks.whole(max_vectors, "max_vectors", 1, 2**31 - 1),
            threads=_checks.whole(threads, "threads", 0, 2**31 - 1),
        )

    def _coefficients(self, given: npt.ArrayLike, what: str) -> Array:
        """[term x sample]."""
        samples = real(given, what)
        if samples.ndim != 2 or samples.shape[1] != self._terms or len(samples) < 1:
            raise InvalidInput(f"{what}: shape {samples.shape}; a row for each sample and {self._terms} columns, one for each "
                               "term of the stiffness, then of the mass, are needed")
        if not np.isfinite(samples).all():
            raise InvalidInput(f"{what}: a coefficient is not finite")
        return samples.T

    def solve(self, samples: npt.ArrayLike, *, threads: int = 0) -> ReducedModes:
        """The lowest modes of every sample, with bounds of their errors. `mottle.eigsh` solves those whose bound is too
        large.

        Args:
            samples: coefficients [sample x term].
            threads: 0: all.
        """
        coefficients = self._coefficients(samples, "samples")
        values, bounds, vectors = self._engine.solve(coefficients, threads=_checks.whole(threads, "threads", 0, 2**31 - 1))
        return ReducedModes(values.T, bounds.T, vectors.T.reshape(*values.T.shape, self.basis.shape[1]), self.basis)

    @property
    def basis(self) -> Array:
        """[row x vector]."""
        return self._engine.basis

    @property
    def reaches_tolerance(self) -> bool:
        """Whether the training samples came within the tolerance."""
        return self._engine.reaches_tolerance

    @property
    def has_indefinite_terms(self) -> bool:
        """Whether a term is not proven to be positive semi-definite: bounds may then be infinite."""
        return self._engine.has_indefinite_terms

    def __repr__(self) -> str:
        return f"<mottle.ReducedModel: {self.basis.shape[0]} rows, {self.basis.shape[1]} vectors, {self._terms} terms>"
