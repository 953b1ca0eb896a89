"""Mottle: stochastic finite-element model updating.

    study = mottle.Study.read("study.toml")
    result = study.update()
    print(result)               # what the command prints
    result.mean, result.covariance, result.cloud_final.outputs

A model that is a Python function is updated by `mottle.update`.
"""

from mottle import _engine, errors, options
from mottle._about import about, warn_of_outdated_kernels
from mottle.clouds import Cloud, Posterior
from mottle.deck_files import Deck, Element, read_deck
from mottle.decks import Modes, Targets, modes, targets
from mottle.errors import Error, FormatError, InvalidInput, ModelFailure, Stopped, SystemFailure
from mottle.files import Results, load
from mottle.functions import Parameter, Surrogate, update
from mottle.matrices import Matrix, read_matrix, write_matrix
from mottle.numerics import TwoSampleTest, assign, eigsh, hotelling, mac, methods
from mottle.population import Population, reml
from mottle.reduced import ReducedModel, ReducedModes
from mottle.results import CheckResult, DiagnoseResult, PropagateResult, SimulateResult, UpdateResult
from mottle.study import Study
from mottle.uff import (
    UffAxis,
    UffCoordinateSystem,
    UffElement,
    UffFile,
    UffFunction,
    UffNodes,
    UffShape,
    UffTraceLine,
    UffUnits,
)
from mottle.universal import read_uff, write_uff

__version__: str = _engine.version()
warn_of_outdated_kernels()

__all__ = [
    "CheckResult",
    "Cloud",
    "Deck",
    "DiagnoseResult",
    "Element",
    "Error",
    "FormatError",
    "InvalidInput",
    "Matrix",
    "ModelFailure",
    "Modes",
    "Parameter",
    "Population",
    "Posterior",
    "PropagateResult",
    "ReducedModel",
    "ReducedModes",
    "Results",
    "SimulateResult",
    "Stopped",
    "Study",
    "Surrogate",
    "SystemFailure",
    "Targets",
    "TwoSampleTest",
    "UffAxis",
    "UffCoordinateSystem",
    "UffElement",
    "UffFile",
    "UffFunction",
    "UffNodes",
    "UffShape",
    "UffTraceLine",
    "UffUnits",
    "UpdateResult",
    "about",
    "assign",
    "eigsh",
    "errors",
    "hotelling",
    "load",
    "mac",
    "methods",
    "modes",
    "options",
    "read_deck",
    "read_matrix",
    "read_uff",
    "reml",
    "targets",
    "update",
    "write_matrix",
    "write_uff",
]
