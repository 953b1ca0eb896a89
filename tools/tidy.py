#!/usr/bin/env python3
"""clang-tidy over several sources at a time: nearly all of its work on a source is on the headers, Eigen's above all, so
the sources of a folder that share no names are included in one file and read together.
  tools/tidy.py BUILD_DIR JOBS FILE...      BUILD_DIR must hold compile_commands.json; exit code 1 on any finding"""
import concurrent.futures
import json
import os
import re
import subprocess
import sys
import tempfile

CONFIG = os.path.join(os.path.dirname(__file__), "..", ".clang-tidy")
LARGEST_GROUP = 8
# What may stand twice in sources compiled alone, but not in one: names that a source defines at the start of a line.
DEFINED = re.compile(r"^(?:(?:struct|class|enum class|using) (\w+)|constexpr .*?(\w+) ?[={]|[\w:].*?\b(\w+)\()", re.MULTILINE)


def defined_names(path):
    with open(path, encoding="utf-8") as file:
        return {name for found in DEFINED.findall(file.read()) for name in found if name}


def groups(files):
    result = []
    for path in sorted(files):
        folder, names = os.path.dirname(path), defined_names(path)
        for group in result:
            if group["folder"] == folder and len(group["files"]) < LARGEST_GROUP and not group["names"] & names:
                break
        else:
            group = {"folder": folder, "files": [], "names": set()}
            result.append(group)
        group["files"].append(path)
        group["names"] |= names
    return [group["files"] for group in result]


def clang_tidy(database, source):
    return subprocess.run(["clang-tidy", "--quiet", f"--config-file={CONFIG}", "-p", database, source], capture_output=True, text=True)


def check_group(build, commands, files):
    """The findings in these files, as text; empty where there are none."""
    if len(files) > 1:
        with tempfile.TemporaryDirectory() as folder:
            source = os.path.join(folder, "group.cpp")
            with open(source, "w", encoding="utf-8") as out:
                out.writelines(f'#include "{os.path.abspath(path)}"  // NOLINT\n' for path in files)
            command = dict(commands[os.path.abspath(files[0])], file=source)
            command["command"] = command["command"].replace(os.path.abspath(files[0]), source)
            with open(os.path.join(folder, "compile_commands.json"), "w", encoding="utf-8") as out:
                json.dump([command], out)
            run = clang_tidy(folder, source)
        if run.returncode == 0:
            return ""
        if not any(kind in run.stdout for kind in ("clang-diagnostic-error", "clang-diagnostic-shadow")):
            return run.stdout
    # Alone, or not to be compiled together: twice defined, or a name of one hides another's.
    return "".join(run.stdout for run in (clang_tidy(build, path) for path in files) if run.returncode != 0)


def main():
    build, jobs, files = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        commands = {entry["file"]: entry for entry in json.load(file)}
    work = groups(files)
    print(f"clang-tidy: {len(files)} files in {len(work)} groups", flush=True)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        findings = list(pool.map(lambda group: check_group(build, commands, group), work))
    print("".join(findings), end="")
    return 1 if any(findings) else 0


if __name__ == "__main__":
    sys.exit(main())
