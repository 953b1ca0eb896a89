"""The contents of universal files. `mottle.read_uff` and `mottle.write_uff` read and write them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Union

import numpy as np
import numpy.typing as npt

_Integers = Union[int, Sequence[int], npt.NDArray[np.int_]]
_NO_TITLES = ("NONE",) * 5


@dataclass(eq=False)
class UffUnits:
    """Dataset 164: a number of the file divided by the factor of its unit is in SI."""

    code: int = 1
    description: str = ""
    temperature_mode: int = 2
    length: float = 1.0
    force: float = 1.0
    temperature: float = 1.0
    temperature_offset: float = 0.0


@dataclass(eq=False)
class UffNodes:
    """Datasets 15 and 2411.

    Attributes:
        ids: [node].
        positions: [node x 3].
        definition_systems, displacement_systems, colors: [node], or one for all.
        are_local: positions are in the definition systems [node], or one for all.
    """

    ids: Sequence[int] | npt.NDArray[np.int_] = field(repr=False)
    positions: npt.ArrayLike = field(repr=False)
    definition_systems: _Integers = 0
    displacement_systems: _Integers = 0
    colors: _Integers = 0
    are_local: bool | Sequence[bool] | npt.NDArray[np.bool_] = False


@dataclass(eq=False)
class UffTraceLine:
    """Dataset 82: a line through nodes, 0 lifts the pen."""

    id: int
    nodes: Sequence[int]
    name: str = ""
    color: int = 0


@dataclass(eq=False)
class UffElement:
    """Dataset 2412; `descriptor`: 11, 21...24 lines, 41, 44, 91, 94 shells, 111... solids; `beam`: orientation node and
    end cross-sections of lines."""

    id: int
    descriptor: int
    nodes: Sequence[int]
    physical_property: int = 0
    material_property: int = 0
    color: int = 0
    beam: tuple[int, int, int] = (0, 0, 0)


@dataclass(eq=False)
class UffCoordinateSystem:
    """Datasets 18 and 2420; `kind`: 0 rectangular, 1 cylindrical, 2 spherical; `axes`: in columns; `reference`: 0 global."""

    id: int
    kind: int = 0
    origin: npt.ArrayLike = field(default_factory=lambda: np.zeros(3))
    axes: npt.ArrayLike = field(default_factory=lambda: np.eye(3))
    reference: int = 0
    color: int = 0
    name: str = ""


@dataclass(eq=False)
class UffShape:
    """Datasets 55 and 2414, of normal modes and complex eigenvalues at nodes.

    Attributes:
        nodes: ids [node].
        values: real or complex [node x 3 or 6], in the nodes' displacement systems.
        frequency: Hz, of a normal mode.
        mode: its number.
        modal_mass: of a normal mode; 0: not given.
        analysis_type: 2 normal mode; 3, 7 complex eigenvalue of first, second order.
        quantity: 8 displacement, 11 velocity, 12 acceleration.
        eigenvalue: rad/s, of a complex mode.
        modal_a, modal_b: of a complex mode; 0: not given.
    """

    nodes: Sequence[int] | npt.NDArray[np.int_] = field(repr=False)
    values: npt.ArrayLike = field(repr=False)
    frequency: float = 0.0
    mode: int = 0
    modal_mass: float = 0.0
    viscous_damping: float = 0.0
    hysteretic_damping: float = 0.0
    analysis_type: int = 2
    eigenvalue: complex = 0j
    modal_a: complex = 0j
    modal_b: complex = 0j
    quantity: int = 8
    model_type: int = 1
    load_case: int = 0
    titles: Sequence[str] = _NO_TITLES


@dataclass(eq=False)
class UffAxis:
    """One axis of a function; `quantity`: 17 time, 18 frequency, 8 displacement, 13 force...; `units`: exponents of length,
    force, temperature."""

    quantity: int = 0
    label: str = ""
    unit: str = ""
    units: tuple[int, int, int] = (0, 0, 0)


@dataclass(eq=False)
class UffFunction:
    """Datasets 58 and 58b.

    Attributes:
        abscissa: [point]; even ones are written as start and step, others with six digits.
        values: real or complex [point].
        type: 1 time response, 2 auto-spectrum, 3 cross-spectrum, 4 frequency response, 6 coherence...
        response_node, response_direction: +-1...3 translations, +-4...6 rotations.
        reference_node, reference_direction: the same of the excitation.
        is_double, is_binary: how the values are written.
    """

    abscissa: npt.ArrayLike = field(repr=False)
    values: npt.ArrayLike = field(repr=False)
    type: int = 0
    response_node: int = 0
    response_direction: int = 0
    reference_node: int = 0
    reference_direction: int = 0
    response_name: str = "NONE"
    reference_name: str = "NONE"
    id: int = 0
    version: int = 0
    load_case: int = 0
    z: float = 0.0
    is_double: bool = True
    is_binary: bool = False
    abscissa_axis: UffAxis = field(default_factory=UffAxis)
    ordinate_axis: UffAxis = field(default_factory=UffAxis)
    denominator_axis: UffAxis = field(default_factory=UffAxis)
    z_axis: UffAxis = field(default_factory=UffAxis)
    titles: Sequence[str] = _NO_TITLES


@dataclass(eq=False)
class UffFile:
    """What a universal file holds. Texts that are not UTF-8 keep their bytes as Python's names of files do."""

    nodes: UffNodes | None = None
    shapes: list[UffShape] = field(default_factory=list)
    functions: list[UffFunction] = field(default_factory=list)
    trace_lines: list[UffTraceLine] = field(default_factory=list)
    elements: list[UffElement] = field(default_factory=list)
    systems: list[UffCoordinateSystem] = field(default_factory=list)
    units: UffUnits | None = None
    header: Sequence[str] | None = None
    """Dataset 151: model file, description, program, created, saved, program that wrote the file, written."""
    notes: list[str] = field(default_factory=list)
    """Of reading: datasets that were left out, and why."""

    def __repr__(self) -> str:
        nodes = 0 if self.nodes is None else len(self.nodes.ids)
        return f"<mottle.UffFile: {nodes} nodes, {len(self.shapes)} shapes, {len(self.functions)} functions>"
