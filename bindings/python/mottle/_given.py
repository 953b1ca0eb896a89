"""What a function is updated with, as the text that stands with the results."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from mottle import _checks, _toml
from mottle._checks import Option
from mottle.tables import Array

if TYPE_CHECKING:
    from mottle.functions import Parameter, Surrogate

def _table(parameter: Parameter) -> dict[str, Any]:
    given = {name: value for name, value in asdict(parameter).items() if value is not None}
    return {name: list(map(float, value)) if name == "bounds" else value for name, value in given.items()}


def text_of(
    title: str,
    seed: int,
    parameters: Sequence[Parameter],
    correlation: Array,
    outputs: Mapping[str, str],
    repeatability: Array,
    model_error: Array,
    update: Mapping[str, Any],
    options: Mapping[str, Option],
    surrogate: Surrogate | None,
) -> str:
    """As TOML, all but the tests; `outputs` are units by name, `repeatability` and `model_error` empty where none is given."""
    study: dict[str, Any] = {
        "title": title,
        "seed": seed,
        "model": {"kind": "function"},
        "parameter": [_table(parameter) for parameter in parameters],
        "outputs": {"names": list(outputs), "units": list(outputs.values())},
        "test": {"repeatability": repeatability, "model_error": model_error},
        "update": {**update, "options": dict(options)},
    }
    if correlation.size:
        study["correlation"] = correlation
    if surrogate is not None:
        study["surrogate"] = asdict(surrogate)
    return _toml.document(study)


def title_of(model: Any, title: str | None) -> str:
    """That of the results: the function's name where none is given."""
    if title is not None:
        return _checks.text(title, "title")
    named = getattr(model, "func", model)  # of functools.partial
    name = getattr(named, "__name__", None)
    return name if isinstance(name, str) else type(named).__name__
