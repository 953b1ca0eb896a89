"""The notebooks of the examples run as they stand."""

import html
import os
import re
import shutil
from pathlib import Path

import pytest

nbclient = pytest.importorskip("nbclient")
nbformat = pytest.importorskip("nbformat")
pytest.importorskip("ipykernel")
pytest.importorskip("matplotlib")
pytest.importorskip("pandas")


@pytest.mark.parametrize("name", ["three_masses", "airframe", "own_model"])
def test_notebook(examples, name, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", os.environ["MOTTLE_PYTHON"])
    folder = examples / "07-python"
    before = sorted(path.name for path in folder.iterdir())
    notebook = nbformat.read(folder / f"{name}.ipynb", as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(folder)}}).execute()
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    told = "".join(output["text"] for output in outputs if output.get("name") == "stderr")
    assert "Warning" not in told, told
    assert sorted(path.name for path in folder.iterdir()) == before
    page = (Path(__file__).resolve().parents[2] / "docs" / "notebooks" / f"{name}.html").read_text(encoding="utf-8")
    shown = html.unescape(re.sub("<[^>]*>", "", page))
    for cell in notebook.cells:
        assert cell.cell_type != "code" or cell.source.strip() in shown, "tools/render_notebooks.py makes the page anew"
    keep = os.environ.get("MOTTLE_KEEP_NOTEBOOKS")
    if keep:
        nbformat.write(notebook, os.path.join(keep, f"{name}.ipynb"))
        shutil.copy(folder / "README.md", keep)
