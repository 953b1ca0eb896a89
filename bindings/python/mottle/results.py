"""What jobs found: arrays that are views of the engine's own, and the contents of result.json."""

from __future__ import annotations

import html
import json
import tempfile
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mottle import _engine
from mottle._held import Held
from mottle.clouds import Cloud, Posterior
from mottle.tables import Array

if TYPE_CHECKING:
    import pandas

    from mottle.plots import Plots

_shown: list[tempfile.TemporaryDirectory[str]] = []  # pages that a browser may still read; they go with the interpreter


class _Result(Held):
    """What the results of all jobs have in common."""

    _engine: Any
    _instead = "pickle its to_dict(), or save it to a folder and mottle.load() that"

    def summary(self) -> str:
        """What the command prints."""
        return "\n".join(self._engine.summary())

    def __str__(self) -> str:
        return self.summary()


class _WithContents(_Result):
    """Of jobs whose results are a JSON file."""

    @cached_property
    def _contents(self) -> dict[str, Any]:
        return json.loads(self._engine.result_text())

    def to_dict(self) -> dict[str, Any]:
        """The contents of result.json; of diagnosis.json after a diagnosis."""
        return self._contents


class _WithFiles(_WithContents):
    """Of jobs whose results are a folder with a report."""

    def save(self, folder: str | Path) -> Path:
        """Writes results and report as the command does; the path of the report."""
        self._engine.save(Path(folder))
        return Path(folder) / "report.html"

    def report(self, folder: str | Path | None = None) -> Any:
        """Opens the report: in a notebook as a frame, else in the browser.

        Args:
            folder: where it is written; None: a temporary folder, which goes with the interpreter.
        """
        if folder is None:
            _shown.append(tempfile.TemporaryDirectory(prefix="mottle-report-"))
            folder = _shown[-1].name
        page = self.save(folder)
        try:
            from IPython import get_ipython
            from IPython.display import HTML
        except ImportError:
            get_ipython = None
        if get_ipython is not None and get_ipython() is not None and "IPKernelApp" in get_ipython().config:
            content = html.escape(page.read_text(encoding="utf-8"), quote=True)
            return HTML(f'<iframe srcdoc="{content}" width="100%" height="900" style="border:0"></iframe>')
        import webbrowser

        webbrowser.open(page.resolve().as_uri())
        return page


class UpdateResult(_WithFiles):
    """What an update of a study, or of a function, found."""

    def __init__(self, engine: _engine.UpdateOutcome) -> None:
        self._engine = engine

    @property
    def status(self) -> str:
        """"converged", "max-iterations", "stalled" or "failed"."""
        return self._engine.status

    @property
    def message(self) -> str:
        """How the method ended, in words."""
        return self._engine.message

    @property
    def verdict(self) -> str:
        """Whether the model can be right: "adequate", "inadequate", "undecided"."""
        return self._engine.verdict

    @property
    def reasons(self) -> list[str]:
        """Why the verdict is what it is, in sentences."""
        return self._engine.reasons

    @property
    def causes(self) -> list[dict[str, Any]]:
        """What the verdict comes from, the most useful to look at first: "kind", "sentence", "specimens" (numbers), "outputs"
        and "next" ("command" or None, and "reason")."""
        return self.to_dict()["verdict"]["causes"]

    @property
    def notes(self) -> list[str]:
        """What a reader of the numbers must know, what casts doubt on them included."""
        return list(self.to_dict()["notes"])

    @property
    def warnings(self) -> list[str]:
        """What casts doubt on them."""
        return self._engine.warnings

    @property
    def model_evaluations(self) -> int:
        """How many samples the model was asked for."""
        return self._engine.model_evaluations

    @property
    def parameters(self) -> list[str]:
        """Names of the parameters."""
        return self._engine.parameters

    @property
    def outputs(self) -> list[str]:
        """Names of the outputs."""
        return self._engine.outputs

    @property
    def mean(self) -> Array:
        """Of the parameters."""
        return self._engine.mean

    @property
    def covariance(self) -> Array:
        """Of the parameters [parameter x parameter]."""
        return self._engine.covariance

    @property
    def std(self) -> Array:
        """Standard deviations of the parameters."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def intervals(self) -> tuple[Array, Array] | None:
        """95 % confidence intervals of means and standard deviations [parameter x 2], of methods that have them."""
        return self._engine.intervals

    @property
    def sensitivity(self) -> Array:
        """dy/dx at the mean [output x parameter]; empty where the method has none."""
        return self._engine.sensitivity

    @property
    def tests(self) -> Array:
        """The tests as they were used [specimen x output]."""
        return self._engine.tests

    @property
    def cloud_initial(self) -> Cloud:
        """The model's cloud before the update."""
        return Cloud(self._engine.cloud_initial, self.parameters, self.outputs)

    @property
    def cloud_final(self) -> Cloud:
        """The model's cloud after it."""
        return Cloud(self._engine.cloud_final, self.parameters, self.outputs)

    @property
    def posterior(self) -> Posterior | None:
        """The draws of methods that sample a posterior."""
        found = self._engine.posterior
        return None if found is None else Posterior(found)

    @property
    def plot(self) -> Plots:
        """Figures by matplotlib."""
        from mottle.plots import Plots

        return Plots(self)

    def to_pandas(self) -> pandas.DataFrame:
        """Mean and standard deviation, a row for each parameter."""
        import pandas

        return pandas.DataFrame({"mean": self.mean, "std": self.std}, index=pandas.Index(self.parameters, name="parameter"))

    def __repr__(self) -> str:
        found = ", ".join(f"{n} = {m:.6g} +- {s:.3g}" for n, m, s in zip(self.parameters, self.mean, self.std))
        return f"<mottle.{type(self).__name__}: {self.verdict}, {self.status}; {found}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th>{html.escape(n)}</th><td>{m:.6g}</td><td>{s:.4g}</td></tr>"
            for n, m, s in zip(self.parameters, self.mean, self.std)
        )
        causes = "".join(f"<p>{html.escape(cause['sentence'])}</p>" for cause in self.causes)
        return (
            f"<p><b>{html.escape(self.verdict)}</b>, {html.escape(self.status)}: {html.escape(self.message)}</p>{causes}"
            f"<table><thead><tr><th>parameter</th><th>mean</th><th>standard deviation</th></tr></thead>"
            f"<tbody>{rows}</tbody></table>"
        )


class PropagateResult(_WithFiles):
    """The model's cloud."""

    def __init__(self, engine: _engine.PropagateOutcome) -> None:
        self._engine = engine

    @property
    def cloud(self) -> Cloud:
        """Samples and outputs."""
        return Cloud(self._engine.cloud, self._engine.parameters, self._engine.outputs)

    def __repr__(self) -> str:
        return f"<mottle.PropagateResult: {self.cloud!r}>"


class SimulateResult(Held):
    """Specimens that were drawn."""

    def __init__(self, engine: _engine.SimulateOutcome) -> None:
        self._engine = engine

    @property
    def parameters(self) -> list[str]:
        """Names of the parameters."""
        return self._engine.parameters

    @property
    def outputs(self) -> list[str]:
        """Names of the outputs."""
        return self._engine.outputs

    @property
    def truth(self) -> Array:
        """Parameters of the specimens [specimen x parameter]."""
        return self._engine.truth

    @property
    def specimens(self) -> Array:
        """Outputs as a test would give them [specimen x output]."""
        return self._engine.specimens

    @property
    def exact(self) -> Array:
        """The same without noise of measurement."""
        return self._engine.exact

    def __repr__(self) -> str:
        return f"<mottle.SimulateResult: {len(self.specimens)} specimens of {', '.join(self.outputs)}>"


class DiagnoseResult(_WithContents):
    """Which further parameters explain a misfit."""

    def __init__(self, engine: _engine.DiagnoseOutcome) -> None:
        self._engine = engine

    def __repr__(self) -> str:
        return f"<mottle.DiagnoseResult: best {self._contents['best']}, {'explained' if self._contents['explained'] else 'not explained'}>"


class CheckResult(_Result):
    """What a check of a study says."""

    def __init__(self, engine: _engine.CheckOutcome) -> None:
        self._engine = engine

    @property
    def frequencies(self) -> Array:
        """The ten lowest at the parameters' means, in Hz; empty without outputs of modes."""
        return self._engine.frequencies

    @property
    def outputs(self) -> Array:
        """The outputs there."""
        return self._engine.outputs

    @property
    def changes(self) -> Array:
        """Changes of the outputs by one prior standard deviation of each parameter [output x parameter]."""
        return self._engine.changes

    @property
    def total_mass(self) -> float:
        """Mass of the model; 0 where it is not known."""
        return self._engine.total_mass

    def __repr__(self) -> str:
        return f"<mottle.CheckResult: {len(self.outputs)} outputs>"
