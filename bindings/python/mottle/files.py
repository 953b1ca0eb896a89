"""Results of earlier runs."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

from mottle.errors import InvalidInput

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class Results:
    """A folder of results."""

    folder: Path
    contents: dict[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """The contents of result.json (of `diagnose`: diagnosis.json)."""
        return self.contents

    def table(self, name: str) -> pandas.DataFrame:
        """One of its CSV files: "tests", "cloud-final", "posterior", ..."""
        import pandas

        file = self.folder / f"{name}.csv"
        if not file.is_file():
            there = ", ".join(sorted(path.stem for path in self.folder.glob("*.csv")))
            raise InvalidInput(f"{file}: there is no such table; there are {there or 'none'}")
        return pandas.read_csv(file, float_precision="round_trip")

    def __repr__(self) -> str:
        return f"<mottle.Results of {self.contents.get('command', '?')} in {self.folder}>"


def load(folder: Union[str, "os.PathLike[str]"]) -> Results:
    """Reads what `mottle update`, `propagate` or `diagnose` left in a folder."""
    place = Path(folder)
    for name in ("result.json", "diagnosis.json"):
        file = place / name
        if not file.is_file():
            continue
        try:
            return Results(place, json.loads(file.read_text(encoding="utf-8")))
        except ValueError as error:
            raise InvalidInput(f"{file}: is no JSON: {error}") from None
    raise InvalidInput(f"{place}: holds no results; give the folder of an update, a cloud or a diagnosis")
