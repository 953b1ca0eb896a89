#!/usr/bin/env python3
"""clang-tidy over the library, the command and the Python module, as compile_commands.json holds them. Nearly all of its work
on a source is on the headers, Eigen's above all, so the sources of a group that is compiled at once are read at once.
  tools/tidy.py BUILD_DIR JOBS [--fresh] [FILE...]      FILEs restrict it to the groups that hold them; exit code 1 on any finding
A group without a finding is remembered by all that clang-tidy read of it (~/.cache/mottle-tidy, or MOTTLE_TIDY_CACHE) and
not read again until a byte of that changes, wherever the clone lies; --fresh reads every group."""
import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
INCLUDED = re.compile(r'^#include "(.*\.cpp)"', re.MULTILINE)
CACHE = pathlib.Path(os.environ.get("MOTTLE_TIDY_CACHE") or
                     pathlib.Path(os.environ.get("XDG_CACHE_HOME", "~/.cache"), "mottle-tidy").expanduser())
KEPT = 20  # states of a group: branches go back and forth


def sources_of(path):
    """What is compiled with this file: the sources of a group, else itself."""
    if not path.endswith(".cxx"):
        return [path]
    return INCLUDED.findall(pathlib.Path(path).read_text(encoding="utf-8"))


def is_checked(source):
    """The library, the command, its modules and the Python module without the lane kernels."""
    folder = os.path.relpath(source, ROOT).split(os.sep)[0]
    return folder in ("src", "apps", "modules", "bindings") and not os.path.basename(source).startswith("simd_")


def anywhere(text):
    """The same in every clone."""
    return text.replace(str(ROOT).encode(), b".")


def digest_now(file):
    """None where there is no such file."""
    try:
        return hashlib.sha256(anywhere(pathlib.Path(file).read_bytes())).hexdigest()
    except OSError:
        return None


digest_of = functools.cache(digest_now)  # as the file was when it was first asked for


def listed_files(make_rule):
    """Files that a rule of make names, which writes blanks, # and $ its own way."""
    words = re.findall(r"(?:\\.|\S)+", make_rule.replace("\\\n", " ").split(": ", 1)[1])
    return [re.sub(r"\\(.)", r"\1", word).replace("$$", "$") for word in words]


@functools.cache
def rules():
    version = subprocess.run(["clang-tidy", "--version"], capture_output=True, check=True).stdout
    return version + (ROOT / ".clang-tidy").read_bytes() + pathlib.Path(__file__).read_bytes()


class Memory:
    """What was read of one group in states that had no finding: a list of {file: digest}, the newest first."""

    def __init__(self, entry):
        key = rules() + anywhere(entry["command"].encode())
        self.path = CACHE / (hashlib.sha256(key).hexdigest() + ".json")
        self.entry = entry

    def states(self):
        try:
            return json.loads(self.path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return []

    def holds(self):
        def now(file):
            return digest_of(str(ROOT / file))  # an absolute path stays one

        return any(all(now(file) == digest for file, digest in state.items()) for state in self.states())

    def state(self):
        """{file: digest} of what the compiler says that the group includes; empty where it cannot say, or a file is missing."""
        command = shlex.split(self.entry["command"])
        listing = command[:command.index("-o")] + ["-M", self.entry["file"]]
        done = subprocess.run(listing, cwd=self.entry["directory"], capture_output=True, text=True)
        if done.returncode != 0:
            return {}
        files = [os.path.normpath(os.path.join(self.entry["directory"], file)) for file in listed_files(done.stdout)]
        state = {os.path.relpath(file, ROOT) if file.startswith(str(ROOT) + os.sep) else file: digest_of(file) for file in files}
        return state if self.entry["file"] in files and all(state.values()) else {}

    def keep(self, state):
        """A group whose files have changed since is read again next time."""
        if not state or any(digest_now(str(ROOT / file)) != digest for file, digest in state.items()):
            return
        CACHE.mkdir(parents=True, exist_ok=True)
        new = self.path.with_suffix(f".{os.getpid()}")
        new.write_text(json.dumps([state] + self.states()[:KEPT - 1]), encoding="utf-8")
        new.replace(self.path)


def check(build, entry):
    """Findings as text, empty where there are none."""
    began = time.monotonic()
    command = ["clang-tidy", "--quiet", f"--config-file={ROOT}/.clang-tidy", "-p", build, entry["file"]]
    memory = Memory(entry)
    state = memory.state()
    run = subprocess.run(command, capture_output=True, text=True)
    if run.returncode == 0:
        memory.keep(state)
    name = os.path.relpath(entry["file"], build)
    print(f"  {name}: {time.monotonic() - began:.0f} s", flush=True)
    if run.returncode == 0:
        return ""
    return run.stdout or run.stderr or f"{name}: clang-tidy ended with code {run.returncode} and said nothing\n"


def main():
    build, jobs, rest = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
    is_fresh = "--fresh" in rest
    files = {os.path.abspath(file) for file in rest if file != "--fresh"}
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        entries = [entry for entry in json.load(file)
                   if any(is_checked(source) and (not files or source in files) for source in sources_of(entry["file"]))]
    work = entries if is_fresh else [entry for entry in entries if not Memory(entry).holds()]
    print(f"clang-tidy: {len(entries)} groups, {len(entries) - len(work)} of them unchanged since they had no finding", flush=True)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        findings = list(pool.map(lambda entry: check(build, entry), work))
    print("".join(findings), end="")
    return 1 if any(findings) or not entries else 0


if __name__ == "__main__":
    sys.exit(main())
