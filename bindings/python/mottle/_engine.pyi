# The module that bindings/python/engine makes; stubtest holds this file against it.
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

_Array = npt.NDArray[np.float64]
_Progress = Callable[[str, str, int, int], object] | None

def version() -> str: ...
def blas_kernels() -> str: ...
def are_blas_kernels_outdated() -> bool: ...
def available_threads() -> int: ...

class Study:
    @staticmethod
    def read(file: Path, *, assignments: list[str] = ..., seed: int | None = ...) -> Study: ...
    @staticmethod
    def from_text(text: str, file: Path) -> Study: ...
    @property
    def file(self) -> Path: ...
    @property
    def title(self) -> str: ...
    @property
    def units(self) -> str: ...
    @property
    def seed(self) -> int: ...
    @property
    def method(self) -> str: ...
    @property
    def parameters(self) -> list[str]: ...
    @property
    def text(self) -> str: ...
    def check(
        self, *, threads: int = ..., may_run_programs: bool = ..., cache: Path | None = ..., progress: _Progress = ...
    ) -> CheckOutcome: ...
    def update(
        self,
        *,
        folder: Path | None = ...,
        threads: int = ...,
        resume: bool = ...,
        may_run_programs: bool = ...,
        cache: Path | None = ...,
        progress: _Progress = ...,
    ) -> UpdateOutcome: ...
    def diagnose(
        self,
        *,
        folder: Path | None = ...,
        threads: int = ...,
        resume: bool = ...,
        may_run_programs: bool = ...,
        cache: Path | None = ...,
        progress: _Progress = ...,
    ) -> DiagnoseOutcome: ...
    def simulate(
        self,
        *,
        folder: Path | None = ...,
        threads: int = ...,
        resume: bool = ...,
        may_run_programs: bool = ...,
        cache: Path | None = ...,
        progress: _Progress = ...,
    ) -> SimulateOutcome: ...
    def propagate(
        self,
        points: Path | None = ...,
        *,
        folder: Path | None = ...,
        threads: int = ...,
        resume: bool = ...,
        may_run_programs: bool = ...,
        cache: Path | None = ...,
        progress: _Progress = ...,
    ) -> PropagateOutcome: ...

class Cloud:
    @property
    def samples(self) -> _Array: ...
    @property
    def outputs(self) -> _Array: ...
    @property
    def failures(self) -> list[tuple[int, str]]: ...
    @property
    def rejected(self) -> int: ...

class Posterior:
    @property
    def chains(self) -> int: ...
    @property
    def draws(self) -> int: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def values(self) -> _Array: ...
    @property
    def log_likelihood(self) -> _Array: ...

class UpdateOutcome:
    @property
    def status(self) -> str: ...
    @property
    def message(self) -> str: ...
    @property
    def verdict(self) -> str: ...
    @property
    def parameters(self) -> list[str]: ...
    @property
    def outputs(self) -> list[str]: ...
    @property
    def mean(self) -> _Array: ...
    @property
    def covariance(self) -> _Array: ...
    @property
    def sensitivity(self) -> _Array: ...
    @property
    def tests(self) -> _Array: ...
    @property
    def cloud_initial(self) -> Cloud: ...
    @property
    def cloud_final(self) -> Cloud: ...
    @property
    def posterior(self) -> Posterior | None: ...
    @property
    def reasons(self) -> list[str]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def model_evaluations(self) -> int: ...
    @property
    def intervals(self) -> tuple[_Array, _Array] | None: ...
    def result_text(self) -> str: ...
    def summary(self) -> list[str]: ...
    def save(self, arg0: Path) -> None: ...

class PropagateOutcome:
    @property
    def parameters(self) -> list[str]: ...
    @property
    def outputs(self) -> list[str]: ...
    @property
    def cloud(self) -> Cloud: ...
    def result_text(self) -> str: ...
    def summary(self) -> list[str]: ...
    def save(self, arg0: Path) -> None: ...

class SimulateOutcome:
    @property
    def parameters(self) -> list[str]: ...
    @property
    def outputs(self) -> list[str]: ...
    @property
    def truth(self) -> _Array: ...
    @property
    def specimens(self) -> _Array: ...
    @property
    def exact(self) -> _Array: ...

class DiagnoseOutcome:
    def result_text(self) -> str: ...
    def summary(self) -> list[str]: ...

class CheckOutcome:
    @property
    def frequencies(self) -> _Array: ...
    @property
    def outputs(self) -> _Array: ...
    @property
    def changes(self) -> _Array: ...
    @property
    def total_mass(self) -> float: ...
    def summary(self) -> list[str]: ...

class ModesOutcome:
    @property
    def frequencies(self) -> _Array: ...
    @property
    def residuals(self) -> _Array: ...
    def shapes(self) -> tuple[list[int], _Array, list[_Array]]: ...
    def summary(self) -> list[str]: ...

class Target:
    @property
    def name(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def value(self) -> float: ...
    @property
    def elements(self) -> int: ...
    @property
    def strain(self) -> _Array: ...
    @property
    def kinetic(self) -> _Array: ...
    @property
    def sensitivity(self) -> _Array: ...

class ParameterSpec:
    def __init__(
        self,
        name: str,
        kind: str,
        mean: float,
        std: float,
        lower: float,
        upper: float,
        lower_bound: float,
        upper_bound: float,
        lower_limit: float,
        scale: str,
        unit: str,
    ) -> None: ...

class SurrogateSettings:
    def __init__(self, kind: str, runs: int, spread: float, rounds: int, tolerance: float) -> None: ...

class OutputSpec:
    def __init__(self, name: str, unit: str) -> None: ...

def write_report(folder: Path) -> None: ...
def find_modes(model: Path, *, modes: int, ignore_cards: set[str], subcase: int | None) -> ModesOutcome: ...
def find_targets(
    model: Path, *, modes: int, ignore_cards: set[str], subcase: int | None, units: str | None, lists_all: bool
) -> tuple[_Array, list[Target], list[str]]: ...
def update_function(
    function: Any,
    *,
    parameters: list[ParameterSpec],
    correlation: _Array,
    outputs: list[OutputSpec],
    tests: _Array,
    repeatability: _Array,
    model_error: _Array,
    method: str,
    options: dict[str, bool | int | float | str],
    samples: int,
    max_failed: float,
    iterations: int,
    level: float,
    tolerance: float,
    seed: int,
    threads: int,
    batch: int,
    difference_step: float,
    surrogate: SurrogateSettings | None,
    title: str,
    text: str,
    folder: Path | None,
    resume: bool,
    progress: _Progress,
) -> UpdateOutcome: ...
def matrix_market_text(lower: Any) -> bytes: ...
def output4_bytes(lower: Any, name: str) -> bytes: ...
def modes_of(stiffness: Any, mass: Any, *, count: int, tolerance: float, counts: bool) -> tuple[_Array, _Array]: ...
def mac(a: _Array, b: _Array) -> _Array: ...
def optimal_assignment(score: _Array) -> list[int]: ...
def methods() -> list[dict[str, Any]]: ...
def two_sample_test(
    mean_a: _Array,
    covariance_a: _Array,
    n_a: int,
    mean_b: _Array,
    covariance_b: _Array,
    n_b: int,
    *,
    level: float,
) -> dict[str, Any]: ...
def fit_population(
    units: list[tuple[_Array, _Array, _Array]],
    start: _Array,
    *,
    is_restricted: bool,
    estimates_noise: bool,
    iterations: int,
    tolerance: float,
) -> dict[str, Any]: ...

class ReducedModel:
    def __init__(
        self,
        stiffness_constant: Any,
        stiffness: list[Any],
        mass_constant: Any,
        mass: list[Any],
        *,
        nominal: _Array,
        training: _Array,
        modes: int,
        tolerance: float,
        max_vectors: int,
        threads: int,
    ) -> None: ...
    def solve(self, coefficients: _Array, *, threads: int) -> tuple[_Array, _Array, _Array]: ...
    @property
    def basis(self) -> _Array: ...
    @property
    def reaches_tolerance(self) -> bool: ...
    @property
    def has_indefinite_terms(self) -> bool: ...

class Deck:
    @property
    def notes(self) -> list[str]: ...
    @property
    def files(self) -> list[str]: ...
    def nodes(self) -> tuple[list[int], _Array]: ...
    def elements(self) -> list[tuple[str, int, list[int]]]: ...
    def numbers(self) -> list[tuple[str, float]]: ...
    def matrices(self) -> tuple[Any, Any, list[str]]: ...

def read_deck(file: Path, *, ignore_cards: set[str], subcase: int | None) -> Deck: ...
def rewrite_deck(
    file: Path, *, ignore_cards: set[str], subcase: int | None, numbers: list[tuple[str, int, str, float]]
) -> tuple[list[tuple[str, bytes]], float]: ...
def read_matrix(location: str) -> tuple[Any, list[str], list[int]]: ...

class UffUnits:
    def __init__(self) -> None: ...
    code: int
    description: str
    temperature_mode: int
    length: float
    force: float
    temperature: float
    temperature_offset: float

class UffNode:
    def __init__(self) -> None: ...
    id: int
    definition_system: int
    displacement_system: int
    color: int
    position: _Array
    is_local: bool

class UffTraceLine:
    def __init__(self) -> None: ...
    id: int
    color: int
    name: str
    nodes: list[int]

class UffElement:
    def __init__(self) -> None: ...
    id: int
    descriptor: int
    physical_property: int
    material_property: int
    color: int
    beam: list[int]
    nodes: list[int]

class UffCoordinateSystem:
    def __init__(self) -> None: ...
    id: int
    kind: int
    origin: _Array
    axes: _Array
    reference: int
    color: int
    name: str

class UffShape:
    def __init__(self) -> None: ...
    titles: list[str]
    model_type: int
    analysis_type: int
    quantity: int
    is_complex: bool
    load_case: int
    mode: int
    frequency: float
    modal_mass: float
    viscous_damping: float
    hysteretic_damping: float
    eigenvalue: complex
    modal_a: complex
    modal_b: complex
    nodes: list[int]
    values: npt.NDArray[np.complex128]

class UffAxis:
    def __init__(self) -> None: ...
    quantity: int
    units: list[int]
    label: str
    unit: str

class UffFunction:
    def __init__(self) -> None: ...
    titles: list[str]
    type: int
    id: int
    version: int
    load_case: int
    response_name: str
    reference_name: str
    response_node: int
    response_direction: int
    reference_node: int
    reference_direction: int
    is_complex: bool
    is_double: bool
    is_even: bool
    is_binary: bool
    start: float
    step: float
    z: float
    abscissa_axis: UffAxis
    ordinate_axis: UffAxis
    denominator_axis: UffAxis
    z_axis: UffAxis
    abscissa: _Array
    values: npt.NDArray[np.complex128]

class UffFile:
    def __init__(self) -> None: ...
    header: list[str] | None
    units: UffUnits | None
    systems: list[UffCoordinateSystem]
    nodes: list[UffNode]
    trace_lines: list[UffTraceLine]
    elements: list[UffElement]
    shapes: list[UffShape]
    functions: list[UffFunction]
    notes: list[str]

def parse_uff(bytes: bytes, file: str, is_in_si: bool) -> UffFile: ...
def format_uff(contents: UffFile, *, nodes: int, shapes: int, is_big_endian: bool) -> bytes: ...
