"""Mottle: stochastic finite-element model updating.

    study = mottle.Study.read("study.toml")
    result = study.update()
    print(result)               # what the command prints
    result.mean, result.covariance, result.cloud_final.outputs

A model that is a Python function is updated by `mottle.update`.
"""

from mottle import _engine, errors
from mottle.clouds import Cloud, Posterior
from mottle.decks import Modes, Targets, modes, targets
from mottle.errors import Error, FormatError, InvalidInput, ModelFailure, Stopped, SystemFailure
from mottle.files import Results, load
from mottle.functions import FunctionResult, Parameter, Surrogate, update
from mottle.numerics import TwoSampleTest, assign, eigsh, hotelling, mac, methods
from mottle.results import CheckResult, DiagnoseResult, PropagateResult, SimulateResult, UpdateResult
from mottle.study import Study

__version__: str = _engine.version()

__all__ = [
    "CheckResult",
    "Cloud",
    "DiagnoseResult",
    "Error",
    "FormatError",
    "FunctionResult",
    "InvalidInput",
    "ModelFailure",
    "Modes",
    "Parameter",
    "Posterior",
    "PropagateResult",
    "Results",
    "SimulateResult",
    "Stopped",
    "Study",
    "Surrogate",
    "SystemFailure",
    "Targets",
    "TwoSampleTest",
    "UpdateResult",
    "assign",
    "eigsh",
    "errors",
    "hotelling",
    "load",
    "mac",
    "methods",
    "modes",
    "targets",
    "update",
]
