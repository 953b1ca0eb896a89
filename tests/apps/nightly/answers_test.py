#!/usr/bin/env python3
"""Right models are called right, and wrong ones wrong with the cause: the short form of validation/answers.

    answers_test.py PATH_TO_MOTTLE
"""
import pathlib
import subprocess
import sys

try:
    import numpy  # noqa: F401
except ImportError:
    print("skipped: NumPy is not installed")
    sys.exit(77)

RUN = pathlib.Path(__file__).resolve().parents[3] / "validation/answers/run.py"
sys.exit(subprocess.run([sys.executable, RUN, "--short", "--jobs", "1", "--program", sys.argv[1]], check=False).returncode)
