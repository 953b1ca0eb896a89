"""Types: the package's own, and the stub of its module against the module."""

import os
import subprocess
import sys
import typing
from pathlib import Path

import mottle
import pytest

pytest.importorskip("mypy")
ROOT = Path(__file__).resolve().parents[2]


def call(*arguments):
    place = os.environ["MOTTLE_PYTHON"]
    is_installed = Path(place).name in ("site-packages", "dist-packages")  # mypy finds it there itself
    search = {} if is_installed else {"MYPYPATH": place, "PYTHONPATH": place}
    return subprocess.run([sys.executable, "-m", *map(str, arguments)], cwd=None if is_installed else place,
                          capture_output=True, text=True, check=False, env={**os.environ, **search})


def run(*arguments):
    done = call(*arguments)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    """What mypy has read of NumPy, for all of its calls: 11 s each."""
    return tmp_path_factory.mktemp("cache")


def test_the_package_is_typed(cache):
    run("mypy", "--config-file", ROOT / "pyproject.toml", "--cache-dir", cache, "-p", "mottle")


def test_options_are_those_of_the_tables():
    names = {name: name.title().replace("-", "") for name in mottle.methods()}
    assert sorted(names.values()) == sorted(mottle.options.__all__)
    for name, method in mottle.methods().items():
        described = getattr(mottle.options, names[name])
        types = typing.get_type_hints(described)
        assert list(types) == list(method["options"]), name
        for option, what in method["options"].items():
            assert f"        {option}: " in described.__doc__, option
            default = what["default"].strip('"')
            choices = [word for one in (types[option], *typing.get_args(types[option]))
                       if typing.get_origin(one) is typing.Literal for word in typing.get_args(one)]
            assert default in choices or float(default) is not None, option


def test_options_are_checked(cache, tmp_path):
    program = tmp_path / "program.py"
    program.write_text("import mottle\nright: mottle.options.Bayes = {'particles': 500, 'noise': 'given'}\n"
                       "built = mottle.options.Mixture(components='automatic')\n"
                       "wrong = mottle.options.Bayes(particles='many')\nunknown = mottle.options.Bayes(particle=1)\n")
    found = call("mypy", "--config-file", ROOT / "pyproject.toml", program, "--cache-dir", cache)
    assert found.returncode == 1, found.stdout
    lines = [line.split(":")[1] for line in found.stdout.splitlines() if ": error:" in line]
    assert lines == ["4", "5"], found.stdout


def test_the_stub_is_that_of_the_module():
    run("mypy.stubtest", "--mypy-config-file", ROOT / "pyproject.toml", "--allowlist",
        ROOT / "tests" / "python" / "stub_differences.txt", "mottle._engine")
