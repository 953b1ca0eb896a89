"""Studies: what `mottle` does with a study file, with results as arrays."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Union

from mottle import _checks, _engine, _progress, _toml
from mottle._progress import Progress
from mottle.errors import InvalidInput
from mottle.results import CheckResult, DiagnoseResult, PropagateResult, SimulateResult, UpdateResult
from mottle.tables import csv_text, keep_csv, names_and_values
from mottle.tables import points as checked_points

PathLike = Union[str, "os.PathLike[str]"]


def _assignments(changes: Mapping[str, Any] | None) -> list[str]:
    return [f"{key}={_toml.value_text(value)}" for key, value in (changes or {}).items()]


class Study:
    """A model with uncertain parameters, its outputs and their tests.

    Made by `Study.read` from a study file, or by `Study.from_dict` from Python objects. The keys of both are those of the
    study file (docs/reference/study-file.md).
    """

    def __init__(self, engine: _engine.Study, keeps: Any = None) -> None:
        self._engine = engine
        self._keeps = keeps  # a temporary folder that lives as long as the study

    @classmethod
    def read(cls, file: PathLike, changes: Mapping[str, Any] | None = None, *, seed: int | None = None) -> Study:
        """Reads and checks a study file.

        Args:
            file: the study file (TOML).
            changes: values in place of the file's, by dotted key: {"update.method": "mares"}.
            seed: of the random streams, in place of the study's.

        Raises:
            InvalidInput: with file, line and key of the fault.
        """
        seed = None if seed is None else _checks.whole(seed, "seed", 0)
        return cls(_engine.Study.read(Path(file), assignments=_assignments(changes), seed=seed))

    @classmethod
    def from_dict(
        cls, study: Mapping[str, Any], *, tests: Any = None, tests_file: PathLike | None = None, folder: PathLike = "."
    ) -> Study:
        """A study of Python objects.

        Args:
            study: keys and tables as in a study file; [[parameter]] is a list of dictionaries under "parameter".
            tests: the specimens, in place of `test.file`: a DataFrame, a dictionary from output to values, or a pair
                (names, array [specimen x output]); nan or masked: not measured.
            tests_file: where `tests` are written, so that another process finds them and can resume a job. None: a
                temporary file, which goes with the study.
            folder: against which the study's paths and `tests_file` are resolved.
        """
        content = dict(study)
        keeps = None
        if tests is None and tests_file is not None:
            raise InvalidInput("tests_file: there are no tests to write; give `tests`, or test.file in the study")
        if tests is not None:
            text = csv_text(*names_and_values(tests, "tests"))
            if tests_file is None:
                keeps = tempfile.TemporaryDirectory(prefix="mottle-")
                tests_file = Path(keeps.name) / "tests.csv"
                tests_file.write_text(text, encoding="utf-8")
            else:
                keep_csv(Path(folder) / tests_file, text)
            content["test"] = {**content.get("test", {}), "file": os.fspath(tests_file)}
        return cls(_engine.Study.from_text(_toml.document(content), Path(folder) / "study.toml"), keeps)

    @property
    def file(self) -> Path:
        """Where the study is, or where its paths are relative to."""
        return self._engine.file

    @property
    def title(self) -> str:
        """Its title."""
        return self._engine.title

    @property
    def method(self) -> str:
        """The updating method."""
        return self._engine.method

    @property
    def seed(self) -> int:
        """Seed of the random streams."""
        return self._engine.seed

    @property
    def parameters(self) -> list[str]:
        """Names of the uncertain parameters."""
        return self._engine.parameters

    def to_toml(self) -> str:
        """The study as it is run."""
        return self._engine.text

    def __repr__(self) -> str:
        return f"<mottle.Study {self.title!r}: {len(self.parameters)} parameters, method {self.method}>"

    def check(
        self, *, threads: int = 0, may_run_programs: bool = True, cache: PathLike | None = None, progress: Progress = None
    ) -> CheckResult:
        """Reads model and tests and refuses what an update would refuse; computes nothing long and writes nothing.

        Args:
            threads: to compute with; 0: all processors.
            may_run_programs: False: a study whose model is run by a program is refused.
            cache: folder of trained reduced models that later runs read; None: none.
            progress: True, False, None (a bar where somebody watches, after a second), or a function of
                (phase, work, done, total).
        """
        return CheckResult(self._run("check", progress, threads=threads, may_run_programs=may_run_programs, cache=cache))

    def update(self, folder: PathLike | None = None, **settings: Any) -> UpdateResult:
        """Finds the distribution of the parameters that explains the tests.

        Args:
            folder: of results and report, as the command leaves them; with it, a job that was stopped or killed can be
                resumed. None: nothing is written.
            settings: threads, resume, may_run_programs, cache, progress, as in `check`; resume=True goes on with an
                interrupted job in `folder`.

        Raises:
            InvalidInput, SystemFailure, Stopped: see mottle.errors.
            KeyboardInterrupt: on Ctrl-C, once the engine has come to rest.
        """
        return UpdateResult(self._run_in("update", folder, settings))

    def diagnose(self, folder: PathLike | None = None, **settings: Any) -> DiagnoseResult:
        """Finds which further parameter best explains the misfit that the parameters leave. Arguments as of `update`."""
        return DiagnoseResult(self._run_in("diagnose", folder, settings))

    def simulate(self, folder: PathLike | None = None, **settings: Any) -> SimulateResult:
        """Draws specimens from the study's [truth]. Arguments as of `update`."""
        return SimulateResult(self._run_in("simulate", folder, settings))

    def propagate(self, points: Any = None, folder: PathLike | None = None, **settings: Any) -> PropagateResult:
        """Runs the model over a cloud of parameters.

        Args:
            points: parameters in place of the drawn cloud: a DataFrame, a dictionary from parameter to values, or an array
                [sample x parameter] in the study's order.
            folder, settings: as of `update`.
        """
        if points is None:
            return PropagateResult(self._run_in("propagate", folder, settings))
        with tempfile.TemporaryDirectory(prefix="mottle-") as place:
            file = Path(place) / "points.csv"
            file.write_text(csv_text(*checked_points(points, self.parameters)), encoding="utf-8")
            return PropagateResult(self._run_in("propagate", folder, {**settings, "points": file}))

    def _run_in(self, job: str, folder: PathLike | None, settings: Mapping[str, Any]) -> Any:
        arguments = dict(settings)
        progress = arguments.pop("progress", None)
        return self._run(job, progress, folder=None if folder is None else Path(folder), **arguments)

    def _run(self, job: str, progress: Progress, **arguments: Any) -> Any:
        arguments["threads"] = _checks.whole(arguments.get("threads", 0), "threads", 0, 2**31 - 1)
        bar = _progress.shown(progress)
        if arguments.get("cache") is not None:
            arguments["cache"] = Path(arguments["cache"])
        try:
            return getattr(self._engine, job)(progress=bar, **arguments)
        finally:
            _progress.close(bar)
