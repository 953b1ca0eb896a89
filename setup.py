"""Builds the module of the Python package by CMake; all else is in pyproject.toml. CMAKE_ARGS: further arguments of CMake's."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
VERSION = re.search(r"project\(mottle VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]


class CMakeBuild(build_ext):
    """CMake knows what the module is made of."""

    def build_extension(self, ext):
        target = Path(self.get_ext_fullpath(ext.name)).resolve()
        build = Path(self.build_temp).resolve()
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count()))
        subprocess.run(["cmake", "-S", ROOT, "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DMOTTLE_BUILD_PYTHON=ON",
                        "-DMOTTLE_UNITY=ON", "-DMOTTLE_BUILD_TESTS=OFF", "-DMOTTLE_INSTALL=OFF",
                        "-DCMAKE_SKIP_RPATH=ON",  # modules lie beside this one; the folder of the build goes
                        f"-DPython3_EXECUTABLE={sys.executable}", *shlex.split(os.environ.get("CMAKE_ARGS", ""))],
                       check=True)
        subprocess.run(["cmake", "--build", build, "--target", "mottle_python", "-j", jobs], check=True)
        target.parent.mkdir(parents=True, exist_ok=True)
        made = build / "python" / "mottle"
        self.copy_file(next(made.glob("_engine*.so")), target)
        self.copy_file(made / "options.py", target.parent / "options.py")
        self.copy_file(build / "mottle_openturns.so", target.parent / "mottle_openturns.so")


setup(
    version=VERSION,
    packages=["mottle"],
    package_dir={"mottle": "bindings/python/mottle"},
    package_data={"mottle": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("mottle._engine", sources=[])],
    cmdclass={"build_ext": CMakeBuild},
)
