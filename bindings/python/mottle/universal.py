"""Reading and writing of universal files (.uff, .unv)."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from mottle import _checks, _engine
from mottle._files import write_new
from mottle.errors import Error, InvalidInput
from mottle.tables import Array, real
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

PathLike = Union[str, "os.PathLike[str]"]


def _taken(kind: Any, given: Any) -> Any:
    """A dataclass with the members of the engine's structure that have its names."""
    values = {each.name: getattr(given, each.name) for each in fields(kind)}
    if hasattr(given, "is_complex"):
        values["values"] = np.array(given.values if given.is_complex else given.values.real)
    for name, value in values.items():
        if isinstance(value, np.ndarray):
            values[name] = np.array(value)
        elif isinstance(value, _engine.UffAxis):
            values[name] = _taken(UffAxis, value)
    return kind(**values)


def read_uff(path: PathLike, *, si: bool = False) -> UffFile:
    """Reads datasets 15, 18, 55, 58, 58b, 82, 151, 164, 2411, 2412, 2414, 2420; others are left out, with a note.

    Args:
        path: the file.
        si: turns all numbers into SI units by dataset 164; without one nothing is changed.

    Raises:
        FormatError: what cannot be read, with its line.
    """
    file = Path(path)
    try:
        found = _engine.parse_uff(file.read_bytes(), str(file), si)
    except OSError as error:
        raise InvalidInput(f"{file}: {error.strerror}") from None
    nodes = found.nodes
    return UffFile(
        nodes=UffNodes(
            ids=np.array([each.id for each in nodes], dtype=int),
            positions=np.array([each.position for each in nodes]).reshape(len(nodes), 3),
            definition_systems=np.array([each.definition_system for each in nodes], dtype=int),
            displacement_systems=np.array([each.displacement_system for each in nodes], dtype=int),
            colors=np.array([each.color for each in nodes], dtype=int),
            are_local=np.array([each.is_local for each in nodes], dtype=bool),
        )
        if nodes
        else None,
        shapes=[_taken(UffShape, each) for each in found.shapes],
        functions=[_taken(UffFunction, each) for each in found.functions],
        trace_lines=[_taken(UffTraceLine, each) for each in found.trace_lines],
        elements=[_taken(UffElement, each) for each in found.elements],
        systems=[_taken(UffCoordinateSystem, each) for each in found.systems],
        units=None if found.units is None else _taken(UffUnits, found.units),
        header=found.header,
        notes=found.notes,
    )


def _values(given: Any, what: str, dimensions: int) -> npt.NDArray[np.complex128]:
    array = np.asarray(given)
    array = array.astype(complex) if array.dtype.kind == "c" else real(given, what).astype(complex)
    if array.ndim != dimensions or not np.isfinite(array).all():
        raise InvalidInput(f"{what}: shape {array.shape}; {dimensions} dimension{'s' * (dimensions > 1)} of finite numbers are needed")
    return array


def _plain(value: Any, what: str) -> Any:
    """As the engine takes it: lists of Python's own numbers; what is not finite is refused."""
    if isinstance(value, UffAxis):
        return _filled(_engine.UffAxis(), value, what)
    if isinstance(value, np.ndarray) and value.dtype.kind in "iub":
        return value.tolist()
    if isinstance(value, (float, complex, np.ndarray, np.inexact)) and not np.isfinite(value).all():
        raise InvalidInput(f"{what}: {value!r} is not finite")
    return value


def _filled(target: Any, given: Any, where: str) -> Any:
    """The engine's structure with the members of a dataclass."""
    return _with_members(target, {each.name: getattr(given, each.name) for each in fields(given)}, where)


def _with_members(target: Any, members: dict[str, Any], where: str) -> Any:
    for name, value in members.items():
        plain = _plain(value, f"{where}: {name}")
        try:
            setattr(target, name, plain)
        except (TypeError, ValueError) as error:
            reason = f": {error}" if isinstance(error, InvalidInput) else ""
            raise InvalidInput(f"{where}: {name}: {value!r} does not fit{reason}") from None
    return target


def _nodes(given: UffNodes, dataset: int) -> list[_engine.UffNode]:
    positions = real(given.positions, "nodes: positions")
    count = len(np.atleast_1d(given.ids))
    if positions.shape != (count, 3):
        raise InvalidInput(f"nodes: positions: shape {positions.shape}; ({count}, 3), a row for each id, is needed")
    columns: dict[str, Any] = {"position": positions}
    for name, values in [("id", given.ids), ("definition_system", given.definition_systems),
                         ("displacement_system", given.displacement_systems), ("color", given.colors),
                         ("is_local", given.are_local)]:
        array, is_flag = np.asarray(values), name == "is_local"
        if array.dtype.kind not in ("b" if is_flag else "iu") or array.shape not in ((), (count,)):
            raise InvalidInput(f"nodes: {name}: {'True or False' if is_flag else 'whole numbers'} are needed, one for each id, or "
                               "one for all")
        columns[name] = np.broadcast_to(array, (count,)).tolist()
    if len(set(columns["id"])) < count:
        raise InvalidInput("nodes: an id is given twice")
    local = {is_local for is_local, system in zip(columns["is_local"], columns["definition_system"]) if system != 0}
    if local - {dataset == 15}:
        raise InvalidInput(f"nodes: dataset {dataset} holds {'local' if dataset == 15 else 'global'} positions, and these are "
                           f"{'global' if dataset == 15 else 'local'} ones; write dataset {2411 if dataset == 15 else 15}")
    return [
        _with_members(_engine.UffNode(), dict(zip(columns, row)), f"nodes[{k}]") for k, row in enumerate(zip(*columns.values()))
    ]


def _shape(given: UffShape, where: str) -> _engine.UffShape:
    values = _values(given.values, f"{where}: values", 2)
    if values.shape not in ((len(given.nodes), 3), (len(given.nodes), 6)):
        raise InvalidInput(f"{where}: values: shape {values.shape}; ({len(given.nodes)}, 3 or 6), a row for each node, is needed")
    shape = _filled(_engine.UffShape(), given, where)
    shape.is_complex = bool(np.iscomplexobj(given.values))
    return shape


def _is_even(abscissa: Array, step: float) -> bool:
    """Whether start and step give the abscissa in more digits than it would be written with."""
    apart = abscissa - abscissa[0] - step * np.arange(len(abscissa))
    return bool(np.abs(apart).max() <= 1e-7 * np.abs(abscissa).max())


def _function(given: UffFunction, where: str) -> _engine.UffFunction:
    values, abscissa = _values(given.values, f"{where}: values", 1), real(given.abscissa, f"{where}: abscissa")
    if abscissa.shape != values.shape or not len(values):
        raise InvalidInput(f"{where}: abscissa: shape {abscissa.shape}; {values.shape}, that of the values, is needed, at least 1")
    function = _filled(_engine.UffFunction(), given, where)
    function.is_complex = bool(np.iscomplexobj(given.values))
    function.start = abscissa[0]
    function.step = (abscissa[-1] - abscissa[0]) / max(1, len(abscissa) - 1)
    function.is_even = _is_even(abscissa, function.step)
    return function


def write_uff(
    path: PathLike, contents: UffFile, *, nodes: int = 2411, shapes: int = 55, big_endian: bool = False
) -> None:
    """Writes a universal file, and reads it again before it takes its place.

    What is read again is what the format's digits hold: positions of dataset 2411, axes and factors of units to 17, values
    of a binary function all, of a double-precision one 12, all else 6 digits. Titles are cut at 80 bytes.

    Args:
        path: the file.
        contents: what it is to hold.
        nodes: dataset of the nodes, 2411 or 15 (six digits).
        shapes: dataset of the shapes, 55 or 2414.
        big_endian: byte order of binary functions.
    """
    if not isinstance(contents, UffFile):
        raise InvalidInput(f"contents: {type(contents).__name__}; mottle.UffFile is needed")
    file = _engine.UffFile()
    lists: dict[str, tuple[Any, Callable[[Any, str], Any]]] = {"shapes": (UffShape, _shape), "functions": (UffFunction, _function),
             "trace_lines": (UffTraceLine, lambda each, where: _filled(_engine.UffTraceLine(), each, where)),
             "elements": (UffElement, lambda each, where: _filled(_engine.UffElement(), each, where)),
             "systems": (UffCoordinateSystem, lambda each, where: _filled(_engine.UffCoordinateSystem(), each, where))}
    for name, (kind, make) in lists.items():
        made = []
        for k, each in enumerate(getattr(contents, name)):
            if not isinstance(each, kind):
                raise InvalidInput(f"{name}[{k}]: {type(each).__name__}; mottle.{kind.__name__} is needed")
            made.append(make(each, f"{name}[{k}]"))
        setattr(file, name, made)
    if contents.nodes is not None:
        file.nodes = _nodes(contents.nodes, nodes)
    if contents.units is not None:
        file.units = _filled(_engine.UffUnits(), contents.units, "units")
    if contents.header is not None:
        try:
            file.header = list(contents.header)
        except TypeError:
            raise InvalidInput(f"header: {contents.header!r}; seven texts are needed") from None
    given = {"nodes": _checks.whole(nodes, "nodes"), "shapes": _checks.whole(shapes, "shapes")}
    content = _engine.format_uff(file, is_big_endian=bool(big_endian), **given)
    try:
        _engine.parse_uff(content, "as written", False)
    except Error as error:
        raise InvalidInput(f"{path}: what is given cannot be read again: {error}") from None
    write_new(Path(path), content)
