"""Updating of a model that is a Python function."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Union

import numpy as np

from mottle import _engine, _progress
from mottle._progress import Progress
from mottle.errors import InvalidInput
from mottle.results import Array, _Updated
from mottle.tables import names_and_values

Option = Union[bool, int, float, str]


@dataclass(frozen=True)
class Parameter:
    """An uncertain parameter.

    Attributes:
        name: its name.
        mean, std: of its prior distribution; None where the family takes none.
        distribution: "normal", "lognormal", "uniform", "truncated-normal", "beta" or "gamma".
        lower, upper: of the distribution, for the families that have ends.
        bounds: that the updated mean stays within.
        scale: on which the population is normal: "identity", "log" or "logit" (between the bounds).
        positive: values of zero or less are impossible and are not drawn.
        unit: for readers.
    """

    name: str
    mean: float | None = None
    std: float | None = None
    distribution: str = "normal"
    lower: float | None = None
    upper: float | None = None
    bounds: tuple[float, float] = (-math.inf, math.inf)
    scale: str = "identity"
    positive: bool = False
    unit: str = "-"

    def _spec(self) -> _engine.ParameterSpec:
        def number(value: float | None) -> float:
            return math.nan if value is None else float(value)

        if self.scale == "logit" and not all(map(math.isfinite, self.bounds)):
            raise InvalidInput(f"parameter '{self.name}': scale \"logit\" is taken between the bounds, which are missing")
        return _engine.ParameterSpec(
            name=self.name,
            kind=self.distribution,
            mean=number(self.mean),
            std=number(self.std),
            lower=number(self.lower),
            upper=number(self.upper),
            lower_bound=float(self.bounds[0]),
            upper_bound=float(self.bounds[1]),
            lower_limit=0.0 if self.positive else -math.inf,
            scale=self.scale,
            unit=self.unit,
        )


class FunctionResult(_Updated):
    """What an update of a function found."""

    def __init__(self, engine: _engine.FunctionOutcome) -> None:
        self._engine = engine

    @property
    def reasons(self) -> list[str]:
        """Why the verdict is what it is, in sentences."""
        return self._engine.reasons

    @property
    def notes(self) -> list[str]:
        """What a reader of the numbers must know."""
        return self._engine.notes

    @property
    def warnings(self) -> list[str]:
        """What casts doubt on them."""
        return self._engine.warnings

    @property
    def intervals(self) -> tuple[Array, Array] | None:
        """95 % confidence intervals of means and standard deviations [parameter x 2], of methods that have them."""
        return self._engine.intervals

    @property
    def model_evaluations(self) -> int:
        """How many samples the function was given."""
        return self._engine.model_evaluations

    def summary(self) -> str:
        """Parameters, verdict and reasons in lines."""
        rows = [f"{n:<16} {m:>13.6g} {s:>13.4g}" for n, m, s in zip(self.parameters, self.mean, self.std)]
        head = f"{'parameter':<16} {'mean':>13} {'std':>13}"
        return "\n".join([head, *rows, f"verdict: {self.verdict}", *(f"  {reason}" for reason in self.reasons)])


@dataclass(frozen=True)
class Surrogate:
    """A surrogate in place of a function that costs minutes a sample: the method works on it, and it is refined where the
    estimate lies.

    Attributes:
        kind: "kriging", "chaos" (polynomial) or "quadratic".
        runs: samples of the first design; 0: ten a parameter, more where the kind needs them.
        spread: half the first design's width, in standard deviations of the prior.
        rounds: most refinements.
        tolerance: error that is good enough, as a part of the tests' scatter.
    """

    kind: str = "kriging"
    runs: int = 0
    spread: float = 3.0
    rounds: int = 3
    tolerance: float = 0.1

    def _settings(self) -> _engine.SurrogateSettings:
        return _engine.SurrogateSettings(
            kind=self.kind, runs=self.runs, spread=self.spread, rounds=self.rounds, tolerance=self.tolerance
        )


@dataclass
class _Noise:
    """Standard deviations of the outputs."""

    values: Any
    names: Sequence[str]
    what: str
    empty: Array = field(default_factory=lambda: np.zeros(0))

    def array(self) -> Array:
        if self.values is None:
            return self.empty
        if isinstance(self.values, Mapping):
            unknown = [name for name in self.values if name not in self.names]
            if unknown:
                raise InvalidInput(f"{self.what}: {unknown[0]!r} is no output; outputs are {', '.join(self.names)}")
            return np.array([float(self.values.get(name, 0.0)) for name in self.names])
        return np.broadcast_to(np.asarray(self.values, dtype=float), (len(self.names),)).copy()


def update(
    model: Callable[[Array], Any],
    parameters: Sequence[Parameter],
    tests: Any,
    *,
    method: str = "maximum-likelihood",
    options: Mapping[str, Option] | None = None,
    repeatability: Any = None,
    model_error: Any = None,
    correlation: Any = None,
    units: Mapping[str, str] | None = None,
    samples: int = 1000,
    max_failed: float = 0.3,
    iterations: int = 30,
    level: float = 0.05,
    tolerance: float = 1e-3,
    seed: int = 1,
    threads: int = 0,
    surrogate: Surrogate | None = None,
    progress: Progress = None,
) -> FunctionResult:
    """Updates a model that is a function.

    Args:
        model: called with one array [sample x parameter] for each batch, on the thread that calls `update`; returns the
            outputs [sample x output], or a pair of them and a dictionary {sample: reason} of samples that failed. A row
            with nan or an infinity has failed. An attribute `model.jacobian`, called with one parameter vector, returns
            dy/dx [output x parameter]; without it derivatives are differences.
        parameters: the uncertain ones, in the order of the array's columns.
        tests: the specimens: a DataFrame, a dictionary from output to values, or a pair (names, array [specimen x
            output]). Their names are those of the outputs, in the function's order.
        method: "maximum-likelihood", "mares", "bayes", ...: see `mottle.methods()`.
        options: of the method, by name.
        repeatability: standard deviation of the measurement noise: a number, one for each output, or a dictionary.
        model_error: the same of the model's own error, which all specimens share.
        correlation: of the prior's normal copula [parameter x parameter].
        units: of the outputs, by name.
        samples: of each cloud.
        max_failed: part of a cloud's runs that may fail.
        iterations, level, tolerance: as [update] of a study file.
        seed: of the random streams.
        threads: of the engine; the function is called on one.
        surrogate: for a function that costs minutes a sample.
        progress: as of `Study.check`.

    Raises:
        InvalidInput: what is given, or what the function returns, does not fit.
        Exception: what the function raises ends the update and is raised as it is.
    """
    names, values = names_and_values(tests, "tests")
    outputs = [_engine.OutputSpec(name=name, unit=(units or {}).get(name, "-")) for name in names]
    bar = _progress.shown(progress)
    try:
        return FunctionResult(
            _engine.update_function(
                model,
                parameters=[parameter._spec() for parameter in parameters],
                correlation=np.zeros((0, 0)) if correlation is None else np.asarray(correlation, dtype=float),
                outputs=outputs,
                tests=values,
                repeatability=_Noise(repeatability, names, "repeatability").array(),
                model_error=_Noise(model_error, names, "model_error").array(),
                method=method,
                options=dict(options or {}),
                samples=samples,
                max_failed=max_failed,
                iterations=iterations,
                level=level,
                tolerance=tolerance,
                seed=seed,
                threads=threads,
                surrogate=None if surrogate is None else surrogate._settings(),
                progress=bar,
            )
        )
    finally:
        _progress.close(bar)
