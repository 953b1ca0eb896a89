#!/usr/bin/python3
"""What Mottle costs a sample beyond the sample's own work, on one machine. Replaces the section "Overhead of a sample" of
RANKS.md beside this file.

    make bench; benchmarks/measure_overhead.py [--mottle FILE] [--turns 5]

Each row is a difference: the same job with few and with many samples, so that the start, the training and the end cancel out.
Counted are processor seconds (getrusage of the job and of all its children, user and system), which other programs on the machine
hardly change, and elapsed seconds, which they do; of each the median over the turns, the two sizes one after the other in a turn.
What is subtracted:

- runs of a solver: a C loop that does fork, execve and waitpid of the same program as often, in one folder. The solver is a static
  C program that copies a number, so that next to nothing is left but the starting of it;
- ranks: threads of one process that do the same.

For internal models nothing is subtracted: the row is the solution and all around it.
"""

import argparse
import pathlib
import resource
import statistics
import subprocess
import tempfile
import time

import peers

peers.choose_blas_kernels()

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent
THREE_MASSES = ROOT / "examples" / "01-three-masses" / "case1.toml"
AIRFRAME = ROOT / "examples" / "02-airframe" / "study.toml"
MPIRUN = ["mpirun", "--oversubscribe", "--allow-run-as-root", "-n"]
HEADING = "## Overhead of a sample"
GOAL_MS = 1.0

SOLVER = r"""
#include <stdio.h>
int main(void) {
  double k = 0.0;
  FILE* in = fopen("input.txt", "r");
  if (!in || fscanf(in, "%lf", &k) != 1) return 1;
  FILE* out = fopen("f.txt", "w");
  return !out || fprintf(out, "%.17g\n", k) < 0 || fclose(out) != 0;
}
"""
LOOP = r"""
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>
int main(int argc, char** argv) {
  char* program[] = {argv[2], 0};
  char* nothing[] = {0};
  for (int i = atoi(argv[1]); i > 0; --i) {
    const pid_t child = fork();
    if (child == 0) { execve(program[0], program, nothing); _exit(127); }
    int status = 0;
    if (waitpid(child, &status, 0) != child || status != 0) return 1;
  }
  return argc != 3;
}
"""
STUDY = """\
title = "A solver of no duration"
units = "SI"
[model]
kind = "command"
command = ["{solver}"]
templates = ["input.txt"]
parallel = 1
[model.frequencies]
file = "f.txt"
format = "column"
[[parameter]]
name = "k"
distribution = {{ kind = "lognormal", mean = 2.0, std = 0.3 }}
[outputs]
frequencies = [1]
"""


def spent(command, folder):
    """Elapsed and processor seconds of a command with all that it starts."""
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(command, cwd=folder, check=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    elapsed, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    return elapsed, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def a_sample(make_command, few, many, turns, folder):
    """Elapsed and processor milliseconds a sample: medians of the differences."""
    found = []
    for turn in range(turns):
        small, large = (spent(make_command(samples, f"{turn}-{samples}"), folder) for samples in (few, many))
        found.append([1e3 * (b - a) / (many - few) for a, b in zip(small, large)])
    return [statistics.median(column) for column in zip(*found)]


class Bench:
    def __init__(self, mottle, turns, folder):
        self.mottle, self.turns, self.folder = str(mottle), turns, folder
        for name, text in (("solver", SOLVER), ("loop", LOOP)):
            (folder / f"{name}.c").write_text(text)
            subprocess.run(["cc", "-O2", "-static", f"{name}.c", "-o", name], cwd=folder, check=True)
        (folder / "study.toml").write_text(STUDY.format(solver=folder / "solver"))
        (folder / "input.txt").write_text("{{k}}\n")

    def propagate(self, study, more=(), launcher=()):
        def command(samples, name):
            return [*launcher, self.mottle, "propagate", str(study), "--quiet", "--out", f"out-{name}-{len(launcher)}", "--set",
                    f"update.samples={samples}", *more]
        return command

    def measure(self, command, few, many):
        for folder in self.folder.glob("out-*"):
            subprocess.run(["rm", "-rf", folder], check=True)
        return a_sample(command, few, many, self.turns, self.folder)

    def rows(self):
        one = ["--threads", "1"]
        yield ("three masses, one thread", 1000, 201000, "nothing",
               self.measure(self.propagate(THREE_MASSES, one), 1000, 201000), [0.0, 0.0])
        yield ("three masses, two threads", 1000, 201000, "nothing",
               self.measure(self.propagate(THREE_MASSES, ["--threads", "2"]), 1000, 201000), [0.0, 0.0])
        (self.folder / "solver-input").mkdir(exist_ok=True)
        (self.folder / "solver-input" / "input.txt").write_text("2.0\n")
        loop = a_sample(lambda runs, _: [str(self.folder / "loop"), str(runs), str(self.folder / "solver")], 50, 1050,
                        self.turns, self.folder / "solver-input")
        runs = self.measure(self.propagate("study.toml", one), 50, 650)
        yield "runs of a solver, one at once", 50, 650, "loop of fork, execve, waitpid", runs, loop
        full = ["--set", 'model.reduction="off"']
        threads = self.measure(self.propagate(AIRFRAME, [*full, "--threads", "2"]), 20, 120)
        ranks = self.measure(self.propagate(AIRFRAME, [*full, "--threads", "1"], [*MPIRUN, "2"]), 20, 120)
        yield "airframe solved in full, 2 ranks", 20, 120, "2 threads", ranks, threads
        ranks = self.measure(self.propagate("study.toml", one, [*MPIRUN, "2"]), 50, 650)
        threads = self.measure(self.propagate("study.toml", ["--set", "model.parallel=2"]), 50, 650)
        yield "runs of a solver, 2 ranks", 50, 650, "2 runs at once", ranks, threads


def section(rows, turns):
    lines = [HEADING, "",
             f"Milliseconds a sample, {peers.processor()}; medians of {turns} turns; made by measure_overhead.py, which says how. "
             f"Goal: an overhead of at most {GOAL_MS:g} ms.", "",
             "| what | samples | processor | elapsed | subtracted | processor of that | elapsed of that | overhead, processor | "
             "overhead, elapsed |", "|---|---|---|---|---|---|---|---|---|"]
    for what, few, many, base_name, found, base in rows:
        cells = [f"{found[1]:.4f}", f"{found[0]:.4f}", base_name, f"{base[1]:.4f}", f"{base[0]:.4f}",
                 f"{found[1] - base[1]:.4f}", f"{found[0] - base[0]:.4f}"]
        lines.append(f"| {what} | {many - few} | " + " | ".join(cells) + " |")
        print(lines[-1], flush=True)
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mottle", type=pathlib.Path, default=ROOT / "build" / "release" / "mottle")
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--print", action="store_true", help="print only")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="mottle-overhead-") as name:
        text = section(Bench(arguments.mottle.resolve(), arguments.turns, pathlib.Path(name)).rows(), arguments.turns)
    if arguments.print:
        return
    page = HERE / "RANKS.md"
    page.write_text(page.read_text().partition(HEADING)[0].rstrip("\n") + "\n\n" + text)


if __name__ == "__main__":
    main()
