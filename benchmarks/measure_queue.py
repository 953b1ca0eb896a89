#!/usr/bin/env python3
"""Memory of a Mottle whose runs wait in a scheduler's queue.

    measure_queue.py MOTTLE [--runs 100000] [--smaps]

A study with a solver of no duration (examples/04-any-solver's parameters) is propagated by tasks of the stand-in for LSF that
tests use (tests/tools/stand_in_scheduler.py), which holds all tasks once the run at the means is done. Printed, in MB: peak of
resident memory (VmHWM), what of it is the process's own (RssAnon) and what are pages of programs and libraries (RssFile), once
as many runs as that are submitted, and for a study of 2 runs. The difference is the queue's. Goal: under 100 MB in all for
100,000 runs.
"""

import argparse
import collections
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(SOURCE / "tests" / "tools"))
import stand_in_scheduler  # noqa: E402


def status(process):
    """VmHWM, RssAnon and RssFile in MB."""
    text = pathlib.Path(f"/proc/{process}/status").read_text()
    return [int(re.search(rf"{key}:\s+(\d+) kB", text)[1]) / 1000 for key in ("VmHWM", "RssAnon", "RssFile")]


def largest_mappings(process):
    """Resident kB by mapped file, the largest first."""
    sizes, name = collections.Counter(), ""
    for line in pathlib.Path(f"/proc/{process}/smaps").read_text().splitlines():
        fields = line.split()
        if re.match(r"[0-9a-f]+-[0-9a-f]+$", fields[0]):
            name = fields[5] if len(fields) > 5 else "(anonymous)"
        elif fields[0] == "Rss:":
            sizes[name] += int(fields[1])
    return sizes.most_common(25)


def measure(mottle, runs, shows_mappings):
    with tempfile.TemporaryDirectory(prefix="mottle-queue-") as name:
        folder = pathlib.Path(name)
        shutil.copytree(SOURCE / "examples" / "04-any-solver", folder / "tower")
        study = folder / "tower" / "study.toml"
        text = study.read_text().replace("parallel = 2", 'launch = "lsf"')
        study.write_text(text.replace("[model.frequencies]", "[model.scheduler]\nruns_per_task = 100\n[model.frequencies]"))
        server = stand_in_scheduler.start(folder / "bin")
        state = folder / "bin" / "state"
        environment = {**os.environ, "PATH": f"{folder / 'bin'}:{os.environ['PATH']}"}
        process = subprocess.Popen([mottle, "propagate", study, "--out", folder / "out", "--set", f"update.samples={runs}",
                                    "--quiet"], env=environment, stdin=subprocess.DEVNULL)
        try:
            while not list(folder.glob("out/tasks/*/array")) and process.poll() is None:
                time.sleep(0.01)
            begun = {file.parent for file in folder.glob("out/tasks/*/array")}
            while all(array in begun for array in (file.parent for file in folder.glob("out/tasks/*/job"))):
                if (folder / "out" / "runs.store").stat().st_size > 100:
                    (state / "held").touch()  # the run at the means is there
                if process.poll() is not None:
                    sys.exit("Mottle has ended before its runs were in the queue")
                time.sleep(0.01)
            time.sleep(8.0)  # the tasks were asked for, and nothing more is under way
            found = status(process.pid)
            if shows_mappings:
                for mapping, size in largest_mappings(process.pid):
                    print(f"{size:8} kB  {mapping}")
            return found
        finally:
            process.kill()
            process.wait()
            server.terminate()
            server.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mottle")
    parser.add_argument("--runs", type=int, default=100000)
    parser.add_argument("--smaps", action="store_true", help="also the largest mappings")
    arguments = parser.parse_args()
    mottle = pathlib.Path(arguments.mottle).resolve()
    print("| runs in the queue | peak, MB | own, MB | of files, MB |\n|---|---|---|---|")
    for runs in (2, arguments.runs):
        peak, own, files = measure(mottle, runs, arguments.smaps)
        print(f"| {runs} | {peak:.1f} | {own:.1f} | {files:.1f} |")


if __name__ == "__main__":
    main()
