"""What Mottle raises. The message of each says where, what was found, what is allowed and what to do."""

from __future__ import annotations

import re

_PLACE = re.compile(r"^(?P<file>[^:\n]+):(?P<line>\d+): (?:(?P<key>[A-Za-z_][\w.\[\]-]*(?: '[^']*')?): )?")


class Error(RuntimeError):
    """Base of every error of Mottle."""


class InvalidInput(Error, ValueError):
    """The input is wrong and can be mended."""

    @property
    def file(self) -> str | None:
        """The file that is at fault, where the message names one with a line."""
        return self._place("file")

    @property
    def line(self) -> int | None:
        """The line in it, counted from 1."""
        line = self._place("line")
        return None if line is None else int(line)

    @property
    def key(self) -> str | None:
        """The key of the study that is at fault: "outputs.frequencies"."""
        return self._place("key")

    def _place(self, part: str) -> str | None:
        found = _PLACE.match(str(self))
        return None if found is None else found[part]


class FormatError(InvalidInput):
    """A file cannot be understood."""


class SystemFailure(Error):
    """A solver or the file system failed although the input is sound."""


class ModelFailure(SystemFailure):
    """The model gives no answer where a method needs one."""


class Stopped(Error):
    """The job was asked to stop; with a folder it can be resumed."""
