"""A study as TOML, from dictionaries and lists."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

import numpy as np

_BARE = re.compile(r"^[A-Za-z0-9_-]+$")


def _key(key: str) -> str:
    return key if _BARE.match(key) else _text(key)


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def value_text(value: Any) -> str:
    """One value as it stands behind the equals sign."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, (str, PurePath)):
        return _text(str(value))
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(str(k))} = {value_text(v)}" for k, v in value.items()) + " }"
    if isinstance(value, np.ndarray):
        return value_text(value.tolist())
    if isinstance(value, Sequence):
        return "[" + ", ".join(value_text(v) for v in value) + "]"
    raise TypeError(f"{type(value).__name__} has no form in a study: {value!r}")


def document(study: Mapping[str, Any]) -> str:
    """The document; each table and each parameter on lines of its own, so that messages name a line that helps."""
    plain = {k: v for k, v in study.items() if not _is_section(v)}
    lines = [f"{_key(k)} = {value_text(v)}" for k, v in plain.items()]
    for name, section in study.items():
        if name in plain:
            continue
        for table in [section] if isinstance(section, Mapping) else section:
            head = f"[{_key(name)}]" if isinstance(section, Mapping) else f"[[{_key(name)}]]"
            lines += ["", head] + [f"{_key(str(k))} = {value_text(v)}" for k, v in table.items()]
    return "\n".join(lines) + "\n"


def _is_section(value: Any) -> bool:
    if isinstance(value, Mapping):
        return True
    return isinstance(value, (list, tuple)) and bool(value) and all(isinstance(v, Mapping) for v in value)
