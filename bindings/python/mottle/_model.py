"""A user's function as the engine calls it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mottle import _checks
from mottle.errors import InvalidInput
from mottle.tables import Array, real


class Served:
    """Holds what the function returns against what is needed: an array of real numbers of the right shape, masked ones
    as nan, with the reasons of failed samples. It has `jacobian` where the function has one."""

    def __init__(self, model: Callable[[Array], Any], outputs: int) -> None:
        if not callable(model):
            raise InvalidInput(f"model: {type(model).__name__} is no function")
        self._model = model
        self._outputs = outputs
        derivatives = getattr(model, "jacobian", None)
        if derivatives is not None:
            if not callable(derivatives):
                raise InvalidInput(f"the model's jacobian: {type(derivatives).__name__} is no function")
            self.jacobian = lambda at: self._derivatives(derivatives, at)

    def __call__(self, samples: Array) -> tuple[Array, dict[int, str]]:
        count = len(samples)
        found = self._model(samples)
        reasons: dict[int, str] = {}
        if isinstance(found, tuple) and len(found) == 2:
            reasons = _reasons(found[1], count)
            found = found[0]
        return _matrix(found, "the model function", (count, self._outputs)), reasons

    def _derivatives(self, derivatives: Callable[[Array], Any], at: Array) -> Array:
        found = _matrix(derivatives(at), "the model's jacobian", (self._outputs, len(at)))
        wrong = np.argwhere(~np.isfinite(found))
        if len(wrong):
            row, column = wrong[0]
            raise InvalidInput(f"the model's jacobian returned {found[row, column]} at [{row}, {column}], "
                               f"for parameters {at.tolist()}; finite numbers are needed")
        return found


def _matrix(found: Any, who: str, shape: tuple[int, int]) -> Array:
    if found is None or isinstance(found, (str, bytes, Mapping)):
        raise InvalidInput(f"{who} returned {type(found).__name__}, an array of {shape[0]} x {shape[1]} numbers is needed")
    array = real(found, f"{who}'s array", may_be_missing=True)
    if array.shape != shape:
        raise InvalidInput(f"{who} returned an array of shape {array.shape}, {shape} is needed")
    return array


def _reasons(given: Any, samples: int) -> dict[int, str]:
    if not isinstance(given, Mapping):
        raise InvalidInput(f"the model function returned a pair whose second is {type(given).__name__}; a dict from the "
                           "number of a failed sample to the reason is needed")
    what = "the model function's reasons: sample"
    return {_checks.whole(sample, what, 0, samples - 1): str(reason) for sample, reason in given.items()}
