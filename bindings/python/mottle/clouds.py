"""Samples of a model and of a posterior, as views of the engine's own arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mottle import _engine
from mottle._held import Held
from mottle.tables import Array

if TYPE_CHECKING:
    import pandas
    import xarray


class Cloud(Held):
    """Samples of the parameters and the model's outputs for each; nan where its run failed."""

    def __init__(self, engine: _engine.Cloud, parameters: list[str], outputs: list[str]) -> None:
        self._engine = engine
        self.parameters = parameters
        self.output_names = outputs

    @property
    def samples(self) -> Array:
        """[sample x parameter]"""
        return self._engine.samples

    @property
    def outputs(self) -> Array:
        """[sample x output]"""
        return self._engine.outputs

    @property
    def failures(self) -> dict[int, str]:
        """Why runs failed, by sample."""
        return dict(self._engine.failures)

    def to_pandas(self) -> pandas.DataFrame:
        """A column for each parameter, then one for each output."""
        import pandas

        return pandas.DataFrame(np.hstack([self.samples, self.outputs]), columns=self.parameters + self.output_names)

    def __repr__(self) -> str:
        return f"<mottle.Cloud of {len(self.samples)} samples, {len(self._engine.failures)} failed>"


class Posterior(Held):
    """Draws of a posterior, of equal weight."""

    def __init__(self, engine: _engine.Posterior) -> None:
        self._engine = engine

    @property
    def names(self) -> list[str]:
        """Of the parameters, then of what was sampled beside them."""
        return self._engine.names

    @property
    def draws(self) -> Array:
        """[chain x draw x name]"""
        return self._engine.values.reshape(self._engine.chains, self._engine.draws, len(self.names))

    @property
    def log_likelihood(self) -> Array:
        """[chain x draw]"""
        return self._engine.log_likelihood.reshape(self._engine.chains, self._engine.draws)

    def to_dict(self) -> dict[str, Array]:
        """Name -> [chain x draw]: what arviz.from_dict takes as `posterior`."""
        return {name: self.draws[:, :, k] for k, name in enumerate(self.names)}

    def to_xarray(self) -> xarray.Dataset:
        """A variable for each name, with dimensions chain and draw."""
        import xarray

        return xarray.Dataset({name: (("chain", "draw"), draws) for name, draws in self.to_dict().items()})

    def __repr__(self) -> str:
        return f"<mottle.Posterior of {', '.join(self.names)}: {self._engine.chains} x {self._engine.draws} draws>"
