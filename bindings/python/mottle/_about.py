"""What this installation computes with."""

import warnings
from typing import Any

from mottle import _engine


def about() -> dict[str, Any]:
    """What this installation computes with.

    :return: `version`; `threads`, the processors that this process may use; `blas_kernels`, OpenBLAS's name of the
        processors that its kernels are for (empty: another BLAS): on other kernels the last bits are others;
        `blas_kernels_outdated`, whether these are the kernels for its oldest processors, several times slower than what
        this one could run.
    """
    return {
        "version": _engine.version(),
        "threads": _engine.available_threads(),
        "blas_kernels": _engine.blas_kernels(),
        "blas_kernels_outdated": _engine.are_blas_kernels_outdated(),
    }


def warn_of_outdated_kernels() -> None:
    """The import changes them, but not while another thread computes."""
    if _engine.are_blas_kernels_outdated():
        warnings.warn(
            "OpenBLAS does not know this processor and uses its oldest kernels, several times slower than they could be: "
            "another thread was computing, or was not seen to sleep, while mottle was imported. Import mottle before, or "
            "set OPENBLAS_CORETYPE=HASWELL before Python starts.",
            RuntimeWarning,
            stacklevel=3,
        )
