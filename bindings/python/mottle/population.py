"""The population behind specimens' values, by restricted maximum likelihood."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from mottle import _checks, _engine
from mottle.errors import InvalidInput
from mottle.tables import Array, by_name, names_and_values, real


@dataclass(frozen=True, eq=False)
class Population:
    """Estimate of a normal population of effects.

    Attributes:
        mean: [effect].
        covariance: of the effects between specimens [effect x effect].
        mean_covariance: sampling covariance of `mean` [effect x effect].
        covariance_errors: standard errors of the entries of `covariance`, of Fisher's expected information [effect x
            effect].
        effects: of each specimen, given its values [specimen x effect].
        noise_factor: on the variance of the noise; 1 where that is known.
        log_likelihood: restricted where the estimate is; constants left out.
        iterations: of the expectation-maximisation.
        converged: within the tolerance.
    """

    mean: Array
    covariance: Array
    mean_covariance: Array
    covariance_errors: Array
    effects: Array
    noise_factor: float
    log_likelihood: float
    iterations: int
    converged: bool

    @property
    def mean_errors(self) -> Array:
        """Standard errors of `mean` [effect]."""
        return np.sqrt(np.diag(self.mean_covariance))

    @property
    def std(self) -> Array:
        """Standard deviations between specimens [effect]."""
        return np.sqrt(np.diag(self.covariance))

    def __repr__(self) -> str:
        found = ", ".join(f"{m:.6g} +- {s:.3g}" for m, s in zip(self.mean, self.std))
        return f"<mottle.Population: {found}{'' if self.converged else '; not converged'}>"


def _designs(given: npt.ArrayLike | None, specimens: int, outputs: int) -> Array:
    """[specimen x output x effect]."""
    design = np.eye(outputs) if given is None else real(given, "design")
    if design.ndim not in (2, 3) or design.shape[-2] != outputs or design.shape[:-2] not in ((), (specimens,)):
        raise InvalidInput(f"design: shape {design.shape}; ({outputs}, effects), or ({specimens}, {outputs}, effects), is needed")
    if not np.isfinite(design).all():
        raise InvalidInput("design: a number is not finite")
    return np.broadcast_to(design, (specimens, *design.shape[-2:]))


def _require_determined(units: list[tuple[Array, Array, Array]], noise_is_known: bool) -> None:
    designs = np.concatenate([unit[0] for unit in units])
    seen, effects = np.linalg.matrix_rank(designs), designs.shape[1]
    if seen < effects:
        raise InvalidInput(f"design: what was measured determines {seen} of the {effects} means; the columns of all specimens' "
                           "designs together must be independent")
    for design, _, variance in units:
        exact = variance == 0.0
        if not exact.any():
            continue
        if not noise_is_known:
            raise InvalidInput("noise: is 0 for an output, which a factor on it does not change; give a number above 0")
        if exact.sum() > np.linalg.matrix_rank(design[exact]):
            raise InvalidInput(f"noise: {exact.sum()} values of a specimen are without noise, more than effects that determine "
                               "them; give the standard deviation of their noise")


def _start(units: list[tuple[Array, Array, Array]]) -> Array:
    """Variances of the effects by which the squares of what least squares leave are fitted, one effect at a time."""
    designs, values = np.concatenate([unit[0] for unit in units]), np.concatenate([unit[1] for unit in units])
    squares = (values - designs @ np.linalg.lstsq(designs, values, rcond=None)[0]) ** 2
    weights = (designs**4).sum(axis=0)
    return np.diag((designs**2).T @ squares / np.where(weights > 0.0, weights, 1.0))


def reml(
    values: Any,
    *,
    design: npt.ArrayLike | None = None,
    noise: Any = None,
    noise_is_known: bool = True,
    restricted: bool = True,
    iterations: int = 2000,
    tolerance: float = 1e-8,
) -> Population:
    """Mean and covariance of a population of specimens, each of which was measured with noise.

        y_s = G_s x_s + e_s,   x_s ~ N(mean, covariance),   e_s ~ N(0, diag(noise^2))

    Restricted maximum likelihood by expectation-maximisation. Of balanced data without design it is the sample
    covariance less that of the noise, where this is positive definite.

    Args:
        values: what was measured [specimen x output], a DataFrame, a dictionary of columns, or an array; nan or masked:
            not measured.
        design: G, the same for all [output x effect], or of each [specimen x output x effect]; None: the effects are the
            outputs.
        noise: its standard deviation: a number, one for each output, a dictionary or Series by the outputs' names, or
            [specimen x output]; None: none, or, where it is not known, the same for all.
        noise_is_known: False: up to a factor on its variance, which is estimated.
        restricted: False: maximum likelihood, whose covariance is too small in small samples.
        iterations: most.
        tolerance: of the largest change of the covariance in one step, relative to its standard deviations.

    Raises:
        InvalidInput: fewer than two specimens with a value, or a mean that they do not determine.
    """
    if isinstance(values, (np.ndarray, list)):
        array = real(values, "values", may_be_missing=True)
        values = ([f"y{k + 1}" for k in range(array.shape[-1] if array.ndim else 0)], array)
    names, measured = names_and_values(values, "values")
    if np.isinf(measured).any():
        raise InvalidInput("values: a value is infinite; nan stands for what was not measured")
    if not isinstance(noise_is_known, bool) or not isinstance(restricted, bool):
        raise InvalidInput("noise_is_known, restricted: True or False are needed")
    if np.ndim(noise) == 2 and not hasattr(noise, "items"):
        deviations = real(noise, "noise")
        if deviations.shape != measured.shape or not (np.isfinite(deviations) & (deviations >= 0.0)).all():
            raise InvalidInput(f"noise: shape {deviations.shape}; {measured.shape}, not negative and finite, is needed")
    else:
        if noise is None:
            noise = 0.0 if noise_is_known else 1.0
        deviations = np.broadcast_to(by_name(noise, names, "noise"), measured.shape)
    designs = _designs(design, *measured.shape)
    units = []
    for rows, response, deviation in zip(designs, measured, deviations):
        seen = ~np.isnan(response)
        if seen.any():
            units.append((rows[seen], response[seen], deviation[seen] ** 2))
    if len(units) < 2:
        raise InvalidInput(f"values: {len(units)} specimens have a value; at least 2 are needed")
    _require_determined(units, noise_is_known)
    return Population(
        **_engine.fit_population(
            units,
            _start(units),
            is_restricted=restricted,
            estimates_noise=not noise_is_known,
            iterations=_checks.whole(iterations, "iterations", 1, 2**31 - 1),
            tolerance=_checks.number(tolerance, "tolerance", 0.0, 1.0),
        )
    )
