"""Updating of a model that is a Python function."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Union

from mottle import _checks, _engine, _given, _progress
from mottle._model import Served
from mottle._progress import Progress
from mottle.errors import InvalidInput
from mottle.results import UpdateResult
from mottle.tables import Array, by_name, names_and_values
from mottle.tables import correlation as checked_correlation


@dataclass(frozen=True)
class Parameter:
    """An uncertain parameter.

    Attributes:
        name: its name.
        mean, std: of its prior distribution; None where the family takes none.
        distribution: "normal", "lognormal", "uniform", "truncated-normal", "beta" or "gamma".
        lower, upper: of the distribution, for the families that have ends.
        bounds: that the updated mean stays within.
        scale: on which the population is normal: "identity", "log" or "logit" (between the bounds); None: that of the
            distribution, "log" for "lognormal", "logit" for "beta", else "identity".
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
    scale: str | None = None
    positive: bool = False
    unit: str = "-"

    def _spec(self) -> _engine.ParameterSpec:
        if not isinstance(self.name, str) or not self.name.strip():
            raise InvalidInput(f"parameter {self.name!r}: has no name")
        where = f"parameter {_checks.text(self.name, 'parameter')!r}"

        def number(value: float | None, what: str) -> float:
            return math.nan if value is None else _checks.number(value, f"{where}: {what}")

        if not isinstance(self.bounds, (tuple, list)) or len(self.bounds) != 2:
            raise InvalidInput(f"{where}: bounds: {self.bounds!r}; a lower and an upper one are needed")
        if self.scale == "logit" and not all(map(math.isfinite, self.bounds)):
            raise InvalidInput(f"{where}: scale \"logit\" is taken between the bounds, which are missing")
        return _engine.ParameterSpec(
            name=str(self.name),
            kind=_checks.text(self.distribution, f"{where}: distribution"),
            mean=number(self.mean, "mean"),
            std=number(self.std, "std"),
            lower=number(self.lower, "lower"),
            upper=number(self.upper, "upper"),
            lower_bound=_checks.number(self.bounds[0], f"{where}: bounds"),
            upper_bound=_checks.number(self.bounds[1], f"{where}: bounds"),
            lower_limit=0.0 if self.positive else -math.inf,
            scale="" if self.scale is None else _checks.text(self.scale, f"{where}: scale"),
            unit=_checks.text(self.unit, f"{where}: unit"),
        )


@dataclass(frozen=True)
class Surrogate:
    """A surrogate in place of a function that costs minutes a sample: the method works on it, and it is refined where the
    estimate lies.

    Attributes:
        kind: "kriging", "chaos" (polynomial) or "quadratic".
        runs: samples of the first design, 10 to 1e5; 0: ten a parameter, more where the kind needs them.
        spread: half the first design's width, in standard deviations of the prior, 0.5 to 6.
        rounds: most refinements, to 100.
        tolerance: error that is good enough, as a part of the tests' scatter, 1e-6 to 1.
    """

    kind: str = "kriging"
    runs: int = 0
    spread: float = 3.0
    rounds: int = 3
    tolerance: float = 0.1

    def _settings(self) -> _engine.SurrogateSettings:
        runs = _checks.whole(self.runs, "surrogate: runs", 0, 100_000)
        return _engine.SurrogateSettings(
            kind=_checks.text(self.kind, "surrogate: kind"),
            runs=runs if runs == 0 else _checks.whole(runs, "surrogate: runs", 10, 100_000),
            spread=_checks.number(self.spread, "surrogate: spread", 0.5, 6.0),
            rounds=_checks.whole(self.rounds, "surrogate: rounds", 0, 100),
            tolerance=_checks.number(self.tolerance, "surrogate: tolerance", 1e-6, 1.0),
        )


def update(
    model: Callable[[Array], Any],
    parameters: Sequence[Parameter],
    tests: Any,
    *,
    method: str = "maximum-likelihood",
    options: Mapping[str, object] | None = None,
    repeatability: Any = None,
    model_error: Any = None,
    correlation: Any = None,
    units: Mapping[str, str] | None = None,
    samples: int = 1000,
    max_failed: float = 0.3,
    iterations: int = 30,
    level: float = 0.05,
    tolerance: float = 1e-3,
    starts: int | None = None,
    seed: int = 1,
    threads: int = 0,
    surrogate: Surrogate | None = None,
    batch: int = 8192,
    difference_step: float = 1e-4,
    folder: Union[str, os.PathLike[str], None] = None,
    resume: bool = False,
    title: str | None = None,
    progress: Progress = None,
) -> UpdateResult:
    """Updates a model that is a function.

    Args:
        model: called with one array [sample x parameter] for each batch, on the thread that calls `update`; returns the
            outputs [sample x output], or a pair of them and a dictionary {sample: reason} of samples that failed,
            counted from 0. A row with nan, an infinity or a masked entry has failed. An attribute `model.jacobian`,
            called with one parameter vector, returns dy/dx [output x parameter]; without it, or where it is None,
            derivatives are differences.
        parameters: the uncertain ones, in the order of the array's columns.
        tests: the specimens: a DataFrame, a dictionary from output to values, or a pair (names, array [specimen x
            output]). Their names are those of the outputs, in the function's order. nan or masked: not measured; a
            specimen without any value is left out, with a note.
        method: "maximum-likelihood", "mares", "bayes", ...: see `mottle.methods()`.
        options: of the method, by name, as in `mottle.options`: {"particles": 500}, or
            mottle.options.Bayes(particles=500).
        repeatability: standard deviation of the measurement noise: a number, one for each output, or a dictionary or
            Series by the outputs' names.
        model_error: the same of the model's own error, which all specimens share.
        correlation: of the prior's normal copula [parameter x parameter]; a DataFrame by its names.
        units: of the outputs, by name.
        samples: of each cloud.
        max_failed: part of a cloud's runs that may fail.
        iterations, level, tolerance: as [update] of a study file.
        starts: most starting points of the search for all parameters that explain the tests' mean; 0: the prior's mean
            alone; None: 64. For a function that costs minutes without a surrogate, fewer.
        seed: of the random streams.
        threads: of the engine; the function is called on one.
        surrogate: for a function that costs minutes a sample.
        batch: most samples of one call of the function. A batch is kept in the folder when the function has returned
            it: so many samples may be lost where the process is killed.
        difference_step: of derivatives by central differences, in standard deviations of the prior: small against the
            model's curvature, large against the rounding of its outputs. 1e-6 to 1.
        folder: of results and report, as the command leaves them; with it, an update that was stopped or killed, or
            whose function raised, can be resumed. None: nothing is written.
        resume: goes on with an interrupted update in `folder`: batches that the function had returned are not asked
            for again. Whether the function is still the same cannot be seen.
        title: of the report; None: the function's name.
        progress: as of `Study.check`.

    Raises:
        InvalidInput: what is given, or what the function returns, does not fit; `resume` where the folder has been begun
            with other parameters, tests or settings.
        Exception: what the function raises ends the update and is raised as it is.
    """
    names, values = names_and_values(tests, "tests")
    if not isinstance(units or {}, Mapping):
        raise InvalidInput(f"units: {units!r}; a dictionary from output to unit is needed")
    unknown = [name for name in units or {} if name not in names]
    if unknown:
        raise InvalidInput(f"units: {unknown[0]!r} is no output; outputs are {', '.join(names)}")
    if not isinstance(parameters, Sequence):
        raise InvalidInput(f"parameters: {parameters!r}; a list of mottle.Parameter is needed")
    wrong = [each for each in parameters if not isinstance(each, Parameter)]
    if wrong or not parameters:
        found = repr(wrong[0]) if wrong else "there is none"
        raise InvalidInput(f"parameters: {found}; mottle.Parameter is needed for each")
    if not isinstance(method, str):
        raise InvalidInput(f"method: {method!r} is no name; see mottle.methods()")
    if resume and folder is None:
        raise InvalidInput("resume: there is no folder to go on from; give the one of the interrupted update")
    served = Served(model, len(names))
    units_of = {_checks.text(name, "tests"): _checks.text((units or {}).get(name, "-"), f"units: {name}") for name in names}
    given: dict[str, Any] = {
        "correlation": checked_correlation(correlation, [parameter.name for parameter in parameters]),
        "repeatability": by_name(repeatability, names, "repeatability"),
        "model_error": by_name(model_error, names, "model_error"),
        "options": _checks.options(options),
        "seed": _checks.whole(seed, "seed", 0),
        "title": _given.title_of(model, title),
    }
    settings: dict[str, Any] = {
        "method": str(method),
        "samples": _checks.whole(samples, "samples", 2, 10**8),
        "max_failed": _checks.number(max_failed, "max_failed", 0.0, 1.0),
        "iterations": _checks.whole(iterations, "iterations", 1, 100_000),
        "level": _checks.number(level, "level", 1e-6, 0.5),
        "tolerance": _checks.number(tolerance, "tolerance", sys.float_info.min, 1.0),
        "difference_step": _checks.number(difference_step, "difference_step", 1e-6, 1.0),
    }
    if starts is not None:
        settings["starts"] = _checks.whole(starts, "starts", 0, 100_000)
    specs = [parameter._spec() for parameter in parameters]
    bar = _progress.shown(progress)
    try:
        return UpdateResult(
            _engine.update_function(
                served,
                parameters=specs,
                outputs=[_engine.OutputSpec(name=name, unit=unit) for name, unit in units_of.items()],
                tests=values,
                threads=_checks.whole(threads, "threads", 0, 2**31 - 1),
                batch=_checks.whole(batch, "batch", 1, 2**31 - 1),
                surrogate=None if surrogate is None else surrogate._settings(),
                text=_given.text_of(parameters=parameters, outputs=units_of, update=settings, surrogate=surrogate, **given),
                folder=None if folder is None else Path(folder),
                resume=bool(resume),
                progress=bar,
                **given,
                **settings,
            )
        )
    finally:
        _progress.close(bar)
