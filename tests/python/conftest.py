"""Where the tests find the package, the command and the examples: MOTTLE_PYTHON and MOTTLE name the first two."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, os.environ["MOTTLE_PYTHON"])
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def examples(tmp_path):
    """A copy of the examples, in which results may be written."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples", ignore=shutil.ignore_patterns("*.mottle"))
    return tmp_path / "examples"


@pytest.fixture
def command():
    """Runs the command; its results are what the package is held against."""

    def run(*arguments):
        done = subprocess.run([os.environ["MOTTLE"], *map(str, arguments)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done

    return run
