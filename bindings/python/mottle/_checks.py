"""Numbers and options as users give them: converted exactly, or refused by their name."""

from __future__ import annotations

import math
import operator
from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from typing import Any, Union

import numpy as np

from mottle.errors import InvalidInput

Option = Union[bool, int, float, str]


def _kind(value: Any) -> str:
    return f"{value!r} ({type(value).__name__})"


def whole(value: Any, what: str, lower: int = -(2**63), upper: int = 2**63 - 1) -> int:
    """A whole number in a range; a bool is none."""
    try:
        number = operator.index(value)
    except TypeError:
        number = None
    if number is None or isinstance(value, (bool, np.bool_)):
        raise InvalidInput(f"{what}: {_kind(value)} is no whole number")
    if not lower <= number <= upper:
        raise InvalidInput(f"{what}: {number} is outside {lower} to {upper}")
    return number


def number(value: Any, what: str, lower: float = -math.inf, upper: float = math.inf) -> float:
    """A number in a range, not nan; a bool is none."""
    is_number = isinstance(value, (int, float, np.integer, np.floating, Decimal, Fraction)) and not isinstance(value, bool)
    if not is_number or math.isnan(value):
        raise InvalidInput(f"{what}: {_kind(value)} is no number")
    if not lower <= value <= upper:
        raise InvalidInput(f"{what}: {value} is outside {lower:g} to {upper:g}")
    try:
        return float(value)
    except OverflowError:
        raise InvalidInput(f"{what}: {value} is too large") from None


def text(value: Any, what: str) -> str:
    """A text that files can hold on one line."""
    if not isinstance(value, str):
        raise InvalidInput(f"{what}: {_kind(value)} is no text")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise InvalidInput(f"{what}: {value!r} is no Unicode text") from None
    control = next((c for c in value if ord(c) < 0x20 or ord(c) == 0x7F), None)
    if control is not None:
        raise InvalidInput(f"{what}: {value!r} holds the control character {control!r}")
    return str(value)


def options(given: Mapping[str, Any] | None) -> dict[str, Option]:
    """Options of a method; whole numbers stay whole."""
    found = {} if given is None else given
    if not isinstance(found, Mapping) or not all(isinstance(name, str) for name in found):
        raise InvalidInput(f"options: {_kind(given)}; a dictionary from name to value is needed")
    return {name: _option(value, f"options: {name}") for name, value in found.items()}


def _option(value: Any, what: str) -> Option:
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, str):
        return str(value)
    if isinstance(value, (int, np.integer)):
        return whole(value, what)
    if isinstance(value, (Decimal, Fraction)) and math.isfinite(value) and value == int(value):
        return whole(int(value), what)
    if isinstance(value, (float, np.floating, Decimal, Fraction)):
        return number(value, what)
    raise InvalidInput(f"{what}: {_kind(value)}; a number, True, False or a text is needed")
