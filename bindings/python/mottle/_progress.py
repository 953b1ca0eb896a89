"""What a job shows of its progress."""

from __future__ import annotations

import importlib.util
import sys
import time
from collections.abc import Callable
from typing import Any, Union

Progress = Union[bool, None, Callable[[str, str, int, int], object]]


def shown(progress: Progress) -> Any:
    """The function that the engine calls, or None. None: a bar where there is a terminal or a notebook, after a second."""
    if callable(progress):
        return progress
    if progress is False or (progress is None and not _is_watched()):
        return None
    return _Bar(0.0 if progress else 1.0)


def _is_watched() -> bool:
    return sys.stderr.isatty() or "ipykernel" in sys.modules


def _tqdm() -> Any:
    """Notebooks' own bar needs ipywidgets; None: there is no tqdm."""
    is_notebook = "ipykernel" in sys.modules and importlib.util.find_spec("ipywidgets") is not None
    try:
        return importlib.import_module("tqdm.notebook" if is_notebook else "tqdm").tqdm
    except ImportError:
        return None


class _Bar:
    """A bar by tqdm where it is installed, else nothing."""

    def __init__(self, after: float) -> None:
        self._due = time.monotonic() + after
        self._bar: Any = None
        self._phase = ""

    def __call__(self, phase: str, work: str, done: int, total: int) -> None:
        if time.monotonic() < self._due:
            return
        if self._bar is None or phase != self._phase:
            self.close()
            tqdm = _tqdm()
            if tqdm is None:
                self._due = float("inf")
                return
            self._phase = phase
            self._bar = tqdm(total=total or None, desc=phase, unit="", leave=False)
        self._bar.total = total or None
        self._bar.update(max(0, done - self._bar.n))
        self._bar.set_postfix_str(work, refresh=False)

    def close(self) -> None:
        """Ends the bar."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None


def close(progress: Any) -> None:
    """Ends what `shown` made."""
    if isinstance(progress, _Bar):
        progress.close()
