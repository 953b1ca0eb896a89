"""Figures for papers, by matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from mottle._held import Held
from mottle.errors import InvalidInput

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mottle.results import UpdateResult
    from mottle.tables import Array

_REACH = np.sqrt(-2.0 * np.log(0.05))  # deviations from the mean within which a bivariate normal lies with 95 %


def ellipse(mean: Array, covariance: Array, points: int = 200) -> Array:
    """Outline of the region in which a bivariate normal lies with 95 % [point x 2]."""
    values, vectors = np.linalg.eigh(covariance)
    angle = np.linspace(0.0, 2.0 * np.pi, points)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    return mean + _REACH * circle * np.sqrt(np.maximum(values, 0.0)) @ vectors.T


class Plots(Held):
    """Figures of an update."""

    def __init__(self, result: UpdateResult) -> None:
        self._result = result

    def ellipses(self, names: Sequence[str] | None = None) -> Figure:
        """Pairs of outputs: tests, the model's clouds before and after, and the regions of 95 %.

        Args:
            names: of the outputs that are drawn; None: all.
        """
        result = self._result
        clouds = [("before", result.cloud_initial.outputs, "C7"), ("after", result.cloud_final.outputs, "C0")]
        return self._pairs(result.outputs, names, clouds, result.tests)

    def parameters(self, names: Sequence[str] | None = None) -> Figure:
        """Pairs of parameters: samples before and after, or of the posterior.

        Args:
            names: of the parameters that are drawn; None: all.
        """
        result = self._result
        after = result.cloud_final.samples
        if result.posterior is not None:
            after = result.posterior.draws[:, :, : len(result.parameters)].reshape(-1, len(result.parameters))
        clouds = [("before", result.cloud_initial.samples, "C7"), ("after", after, "C0")]
        return self._pairs(result.parameters, names, clouds, None)

    @staticmethod
    def _pairs(
        all_names: list[str], wanted: Sequence[str] | None, clouds: list[tuple[str, Array, str]], tests: Array | None
    ) -> Figure:
        import matplotlib.pyplot as plt

        for name in wanted or []:
            if name not in all_names:
                raise InvalidInput(f"plot: there is no {name!r}; there are {', '.join(all_names)}")
        shown = list(range(len(all_names))) if wanted is None else [all_names.index(name) for name in wanted]
        pairs = list(combinations(shown, 2)) or [(shown[0], shown[0])]
        columns = min(3, len(pairs))
        rows = -(-len(pairs) // columns)
        figure, grid = plt.subplots(rows, columns, figsize=(3.2 * columns, 2.9 * rows), squeeze=False)
        for axes, (i, j) in zip(grid.flat, pairs):
            for label, cloud, colour in clouds:
                _draw(axes, cloud[:, [i, j]], label, colour)
            if tests is not None:
                axes.plot(tests[:, i], tests[:, j], "k+", label="tests")
            axes.set_xlabel(all_names[i])
            axes.set_ylabel(all_names[j])
        for axes in list(grid.flat)[len(pairs):]:
            axes.set_visible(False)
        grid.flat[0].legend(fontsize="small")
        figure.tight_layout()
        return figure


def _draw(axes: Any, cloud: Array, label: str, colour: str) -> None:
    whole = cloud[np.isfinite(cloud).all(axis=1)]
    shown = whole[:: max(1, len(whole) // 500)]
    axes.plot(shown[:, 0], shown[:, 1], ".", color=colour, ms=2, alpha=0.5, label=label)
    if len(whole) > 2:
        axes.plot(*ellipse(whole.mean(axis=0), np.cov(whole, rowvar=False)).T, color=colour, lw=1.2)
