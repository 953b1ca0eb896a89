"""Errors that a study may contain, and whether an answer names them among its first two causes."""
import dataclasses
import re

import numpy as np


@dataclasses.dataclass
class Answers:
    """What a user reads: the first causes of the update, and the first candidates of `diagnose`."""
    causes: str
    candidates: list = dataclasses.field(default_factory=list)  # of lists of targets
    specimen: int | None = None  # the one that differs


def first_causes(result):
    """The first two causes of result.json as text; where it lists none, the first screen's sentences."""
    causes = result["verdict"].get("causes")
    if causes is None:
        # "Assumed" lists numbers that could be wrong, of a right model too.
        return " ".join([result["verdict"]["headline"], *(said for said in result["verdict"]["summary"] if not said.startswith("Assumed"))])
    return " | ".join(f"{cause['kind']}: {cause['sentence']} outputs {' '.join(map(str, cause.get('outputs') or []))} "
                      f"specimens {' '.join(map(str, cause.get('specimens') or []))}" for cause in causes[:2])


def mentions(text, *words):
    """All words, each by itself."""
    return all(re.search(rf"(?<![\w:]){re.escape(word)}(?![\w:])", text) for word in words)


class ModelError:
    """A fault of the study's model: a change of the true structure."""
    asks_diagnosis = False

    def change(self, truth, count, rng):
        """Changes the specimens' factors {target: [specimen]}; the number of the one that differs, where it is one."""

    def spoil(self, columns, values):
        """Changes the table of tests [specimen x column] in place."""


@dataclasses.dataclass
class WrongNumber(ModelError):
    """A number that is no parameter differs by a factor; targets that cannot be told from it count as well."""
    target: str
    factor: float
    alike: tuple = ()
    asks_diagnosis = True

    def change(self, truth, count, rng):
        truth[self.target] = truth.get(self.target, np.ones(count)) * self.factor

    def is_named(self, answers):
        names = (self.target, *self.alike)
        own_names = (name.split(":")[1] for name in names if name.count(":") == 1)  # spring:k2 is k2 where it is written
        return any(name in targets for targets in answers.candidates[:2] for name in names) or any(mentions(answers.causes, name) for name in (*names, *own_names))


@dataclasses.dataclass
class LooseSpecimen(ModelError):
    """One specimen's joint has a small fraction of its stiffness."""
    targets: tuple
    factor: float

    def change(self, truth, count, rng):
        loose = np.ones(count)
        row = int(rng.integers(count))
        loose[row] = self.factor
        for target in self.targets:
            truth[target] = truth.get(target, np.ones(count)) * loose
        return row + 1

    def is_named(self, answers):
        return bool(re.search(rf"[Ss]pecimens? (\d+,? (and )?)*{answers.specimen}\b", answers.causes))


@dataclasses.dataclass
class TwoBatches(ModelError):
    """A part of the specimens was made with another number, which is a parameter."""
    target: str
    factor: float

    def change(self, truth, count, rng):
        truth[self.target] = truth[self.target] * np.where(np.arange(count) % 3 == 0, self.factor, 1.0)

    def is_named(self, answers):
        return bool(re.search(r"batch|two (groups|populations)", answers.causes))


@dataclasses.dataclass
class SwappedColumns(ModelError):
    """Two columns of the tests, or two sensors of all shapes, change places."""
    first: str
    second: str

    def spoil(self, columns, values):
        for k, column in enumerate(columns):
            other = re.sub(rf"(^|:){re.escape(self.first)}$", rf"\g<1>{self.second}", column)
            if other != column:
                j = columns.index(other)
                values[:, [k, j]] = values[:, [j, k]]

    def is_named(self, answers):
        are_mentioned = all(re.search(rf"\b{name}\b", answers.causes) for name in (self.first, self.second))
        return are_mentioned and bool(re.search(r"swap|exchang|chang\w* places|ascend|cross|pair|order|column|sensor", answers.causes))


@dataclasses.dataclass
class WrongUnit(ModelError):
    """Frequencies of the tests, or the model's, are in another unit: a factor on the columns that match."""
    pattern: str
    factor: float

    def spoil(self, columns, values):
        for k, column in enumerate(columns):
            if re.fullmatch(self.pattern, column):
                values[:, k] *= self.factor

    def is_named(self, answers):
        return bool(re.search(r"\bunits?\b|rad/s|kHz", answers.causes))
