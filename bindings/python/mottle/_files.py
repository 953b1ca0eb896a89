"""Files that appear complete or not at all."""

from __future__ import annotations

import os
from pathlib import Path

from mottle.errors import InvalidInput


def write_new(file: Path, content: bytes) -> None:
    """Writes beside the file and renames; what is at its place is replaced."""
    new = file.with_name(f"{file.name}.{os.getpid()}.new")
    try:
        new.write_bytes(content)
        os.replace(new, file)
    except OSError as error:
        new.unlink(missing_ok=True)
        raise InvalidInput(f"{file}: cannot be written: {error.strerror}") from None
