"""Right models are called right, and wrong ones wrong with the cause: the short form of validation/answers.

    python3 nightly/answers_test.py PATH_TO_MOTTLE
"""
import pathlib
import subprocess
import sys

RUN = pathlib.Path(__file__).resolve().parents[3] / "validation/answers/run.py"


def interpreter_with_numpy():
    """The interpreter that runs this, or the system's, whichever has NumPy; None: neither."""
    for python in (sys.executable, "/usr/bin/python3"):
        if pathlib.Path(python).exists() and subprocess.run([python, "-c", "import numpy"], capture_output=True, check=False).returncode == 0:
            return python
    return None


if __name__ == "__main__":
    found = interpreter_with_numpy()
    if found is None:
        print("skipped: no interpreter has NumPy")
        sys.exit(77)
    sys.exit(subprocess.run([found, RUN, "--short", "--jobs", "1", "--program", sys.argv[1]], check=False).returncode)
