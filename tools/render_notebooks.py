#!/usr/bin/env python3
"""Runs the notebooks of examples/07-python and writes them with their results to docs/notebooks, as pages that need nothing else.

    PYTHONPATH=build/release/python python3 tools/render_notebooks.py
"""

import os
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbconvert import HTMLExporter

ROOT = Path(__file__).resolve().parent.parent
NOTEBOOKS = ROOT / "examples" / "07-python"
PAGES = ROOT / "docs" / "notebooks"
HEAD = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title><style>
body {{ font: 16px/1.5 sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }}
pre {{ overflow-x: auto; }} .highlight pre {{ background: #f4f4f4; padding: .6rem; }} img {{ max-width: 100%; }}
.prompt, .anchor-link {{ display: none; }} table {{ border-collapse: collapse; }} td, th {{ padding: .1rem .6rem; text-align: right; }}
</style></head><body>
"""


def render(file):
    notebook = nbformat.read(file, as_version=4)
    NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(file.parent)}}).execute()
    body, _ = HTMLExporter(template_name="basic").from_notebook_node(notebook)
    lines = "\n".join(line.rstrip() for line in body.splitlines())
    text = HEAD.format(title=file.stem) + lines + "\n</body></html>\n"
    (PAGES / f"{file.stem}.html").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    os.environ.setdefault("PYDEVD_DISABLE_FILE_VALIDATION", "1")
    PAGES.mkdir(exist_ok=True)
    for notebook_file in sorted(NOTEBOOKS.glob("*.ipynb")):
        render(notebook_file)
