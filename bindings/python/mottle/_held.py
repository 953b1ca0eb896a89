"""What holds arrays of the engine's own."""

from __future__ import annotations

from typing import Any, NoReturn, TypeVar

_Self = TypeVar("_Self", bound="Held")


class Held:
    """A thing whose arrays are the engine's own and are never written into: a copy of it is itself, and another process cannot
    have it."""

    _instead = "give other processes its arrays"

    def __copy__(self: _Self) -> _Self:
        return self

    def __deepcopy__(self: _Self, memo: dict[int, Any]) -> _Self:
        return self

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        raise TypeError(f"mottle.{type(self).__name__} cannot be pickled, as its arrays are the engine's own; {self._instead}")
