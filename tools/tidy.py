#!/usr/bin/env python3
"""clang-tidy over the library, the command and the Python module, as compile_commands.json holds them (the last where it is
configured): nearly all of its work on a source is
on the headers, Eigen's above all, so the groups of sources that the build compiles together are read together.
  tools/tidy.py BUILD_DIR JOBS [FILE...]      FILEs restrict it to the groups that hold them; exit code 1 on any finding"""
import concurrent.futures
import json
import os
import re
import subprocess
import sys

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), ".."))
INCLUDED = re.compile(r'^#include "(.*\.cpp)"', re.MULTILINE)


def sources_of(path):
    """What is compiled with this file: the sources of a group, else itself."""
    if not path.endswith(".cxx"):
        return [path]
    with open(path, encoding="utf-8") as file:
        return INCLUDED.findall(file.read())


def is_checked(source):
    """The library, the command and the Python module without the lane kernels."""
    folder = os.path.relpath(source, ROOT).split(os.sep)[0]
    return folder in ("src", "apps", "bindings") and not os.path.basename(source).startswith("simd_")


def clang_tidy(build, path):
    command = ["clang-tidy", "--quiet", f"--config-file={ROOT}/.clang-tidy", "-p", build, path]
    run = subprocess.run(command, capture_output=True, text=True)
    return run.stdout if run.returncode != 0 else ""


def main():
    build, jobs, files = sys.argv[1], int(sys.argv[2]), {os.path.abspath(path) for path in sys.argv[3:]}
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        units = {entry["file"]: sources_of(entry["file"]) for entry in json.load(file)}
    work = [unit for unit, sources in units.items()
            if any(is_checked(source) and (not files or source in files) for source in sources)]
    print(f"clang-tidy: {sum(len(units[unit]) for unit in work)} sources in {len(work)} groups", flush=True)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        findings = list(pool.map(lambda unit: clang_tidy(build, unit), work))
    print("".join(findings), end="")
    return 1 if any(findings) or not work else 0


if __name__ == "__main__":
    sys.exit(main())
