"""Types: the package's own, and the stub of its module against the module."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("mypy")
ROOT = Path(__file__).resolve().parents[2]


def run(*arguments):
    place = os.environ["MOTTLE_PYTHON"]
    is_installed = place in sys.path[1:]  # mypy finds it there itself
    search = {} if is_installed else {"MYPYPATH": place, "PYTHONPATH": place}
    done = subprocess.run([sys.executable, "-m", *map(str, arguments)], cwd=None if is_installed else place,
                          capture_output=True, text=True, check=False, env={**os.environ, **search})
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_package_is_typed(tmp_path):
    run("mypy", "--config-file", ROOT / "pyproject.toml", "--cache-dir", tmp_path, "-p", "mottle")


def test_the_stub_is_that_of_the_module():
    run("mypy.stubtest", "--mypy-config-file", ROOT / "pyproject.toml", "--allowlist",
        ROOT / "tests" / "python" / "stub_differences.txt", "mottle._engine")
