#!/usr/bin/python3
"""What ranks cost and gain on this machine: messages, and whole `mottle propagate` by threads and by ranks side by side.
Writes RANKS.md and ranks.json (for simulate_ranks.py) beside this file.

    make bench; benchmarks/compare_ranks.py [cloud] [full] [runs] [short_runs] [messages]

Of what is not named, the last measurement stays.
"""
import datetime
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import peers

peers.choose_blas_kernels()

HERE = pathlib.Path(__file__).resolve().parent
BUILD = HERE.parent / "build" / "release"
AIRFRAME = HERE.parent / "examples" / "02-airframe" / "study.toml"
RANKS = min(2, len(os.sched_getaffinity(0)))
MPIRUN = ["mpirun", "--oversubscribe", "--allow-run-as-root", "-n"]
REPEATS = 3

# A solver of known duration: all else is overhead.
SLEEPER = """\
title = "A solver that sleeps"
units = "SI"
[model]
kind = "command"
command = ["sh", "solver.sh"]
templates = ["input.txt"]
files = ["solver.sh"]
parallel = {parallel}
[model.frequencies]
file = "f.txt"
format = "column"
[[parameter]]
name = "k"
distribution = {{ kind = "normal", mean = 2.0, std = 0.3 }}
[outputs]
frequencies = [1]
[update]
samples = {samples}
"""


def write_sleeper(folder, seconds, parallel, samples):
    folder.mkdir()
    (folder / "input.txt").write_text("{{k}}\n")
    (folder / "solver.sh").write_text(f"sleep {seconds}\ncp input.txt f.txt\n" if seconds else "cp input.txt f.txt\n")
    study = folder / "study.toml"
    study.write_text(SLEEPER.format(parallel=parallel, samples=samples))
    return study


class Contender:
    """A way to run a study: threads of one process, or ranks of one thread."""

    def __init__(self, threads, ranks):
        self.name = f"{ranks} ranks" if ranks else f"{threads} thread{'s' * (threads > 1)}"
        self.launch = [*MPIRUN, str(ranks)] if ranks else []
        self.threads = threads
        self.workers = max(threads, ranks)


CONTENDERS = [Contender(1, 0), Contender(RANKS, 0), Contender(1, RANKS)]


def seconds(contender, study, out, options):
    """Time that the process says itself, without the start, and the start."""
    begin = time.perf_counter()
    subprocess.run([*contender.launch, str(BUILD / "mottle"), "propagate", str(study), "--quiet", "--cache", "off", "--threads",
                    str(contender.threads), "--out", str(out), *options], check=True, stdin=subprocess.DEVNULL)
    wall = time.perf_counter() - begin
    inside = json.loads((out / "result.json").read_text())["timings_s"]["total"]
    return inside, wall - inside


def compare(place, study_of, options):
    """Best times of each contender, which take turns."""
    best = {}
    for repeat in range(REPEATS):
        for number, contender in enumerate(CONTENDERS):
            study = study_of(contender, place / f"study-{repeat}-{number}")
            now = seconds(contender, study, place / f"out-{repeat}-{number}", options)
            best[contender.name] = tuple(map(min, now, best.get(contender.name, now)))
    return best


def cases():
    """Title, samples, seconds of a sample where they are known, study, options."""
    def sleeper(duration, samples):
        def study_of(contender, folder):
            return write_sleeper(folder, duration, 1 if contender.launch else contender.workers, samples)
        return study_of

    airframe = lambda contender, folder: AIRFRAME  # noqa: E731
    yield "cloud", "airframe, certified reduced model", 50000, airframe, ["--set", "update.samples=50000"]
    yield "full", "airframe, solved in full", 300, airframe, ["--set", "update.samples=300", "--set",
                                                             "model.reduction=\"off\""]
    yield "runs", "runs of a solver of 0.1 s", 60, sleeper(0.1, 60), []
    yield "short_runs", "runs of a solver of no duration", 400, sleeper(0, 400), []


def messages(ranks):
    """Medians of five runs: a rank that the system lets wait once would decide a single one."""
    program = [*MPIRUN, str(ranks), str(BUILD / "benchmarks" / "mottle_rank_benchmark"), str(BUILD / "libmottle_mpi.so")]
    runs = [json.loads(subprocess.run(program, check=True, text=True, stdout=subprocess.PIPE).stdout) for _ in range(5)]
    return {name: statistics.median(run[name] for run in runs) for name in runs[0]}


def row(case):
    one, threads, ranks = case["one"], case["threads"], case["ranks"]
    overhead = 1e3 * (ranks - threads) / case["samples"]
    return (f"| {case['title']} | {case['samples']} | {one:.2f} | {threads:.2f} | {ranks:.2f} | {one / threads:.2f} | "
            f"{one / ranks:.2f} | {overhead:.3f} | {case['start_ranks'] - case['start']:.2f} | {case['date']} |")


def main():
    chosen = sys.argv[1:] or ["cloud", "full", "runs", "short_runs", "messages"]
    found = json.loads((HERE / "ranks.json").read_text())
    if "messages" in chosen:
        found["messages"] = messages(2)
    with tempfile.TemporaryDirectory() as place:
        for key, title, samples, study_of, options in cases():
            if key not in chosen:
                continue
            folder = pathlib.Path(place) / key
            folder.mkdir()
            best = compare(folder, study_of, options)
            one, threads, ranks = (best[contender.name] for contender in CONTENDERS)
            found["cases"][key] = {"title": title, "date": datetime.date.today().isoformat(), "samples": samples, "one": one[0],
                                   "threads": threads[0], "ranks": ranks[0], "start": one[1], "start_ranks": ranks[1]}
    rows = [row(case) for case in found["cases"].values()]
    (HERE / "ranks.json").write_text(json.dumps(found, indent=1) + "\n")
    m = found["messages"]
    page = HERE / "RANKS.md"
    kept = page.read_text().partition("## Overhead of a sample")[1:]  # made by measure_overhead.py
    page.write_text("\n".join([
        "# Ranks on one machine", "",
        f"`mottle propagate` by threads of one process and by ranks of one thread; {len(os.sched_getaffinity(0))} processors, "
        f"best of {REPEATS} turns, elapsed times in s without the start; "
        f"{peers.processor()}; made by compare_ranks.py. Overhead: what {RANKS} ranks need more than {RANKS} threads, a sample. "
        "Start: what mpirun and MPI add before and after. Numbers of a solver's runs are those at once in all.", "",
        f"| model | samples | 1 thread | {RANKS} threads | {RANKS} ranks | speed-up, threads | speed-up, ranks | overhead, ms a "
        "sample | start, s | measured on |",
        "|---|---|---|---|---|---|---|---|---|---|", *rows, "",
        f"Messages between two ranks: a number of the shared counter {1e6 * m['counter_latency']:.0f} us from question to answer, "
        f"{1e6 * m['counter_service']:.1f} us of rank 0 where many threads ask at once; gathering 8 bytes {1e6 * m['gather']:.0f} us, "
        f"and {1e9 * m['gather_byte']:.2f} ns a byte of all ranks together (shared memory, not a network).", ""]) + "".join(["\n", *kept] if kept[0] else []))


if __name__ == "__main__":
    main()
