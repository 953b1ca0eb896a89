#!/usr/bin/python3
"""What Mottle costs a sample beyond the sample's own work, on one machine. Replaces the section "Overhead of a sample" of
RANKS.md beside this file.

    make bench; benchmarks/measure_overhead.py [--mottle FILE] [--turns 5]

Each row is a difference: the same job with few and with many samples, so that the start, the training and the end cancel out.
Counted are processor seconds (getrusage of the job and of all its children, user and system), which other programs on the machine
hardly change, and elapsed seconds, which they do; of each the median over the turns. In a turn, the job and what is subtracted
from it run one after the other. What is subtracted:

- runs of a solver: a C loop that starts the same program as often. One does fork, execve and waitpid in one folder, and nothing
  else. The other also does what every run by itself needs: makes a folder, writes the input, sends the program's output to two
  files, reads its result, and takes the folder away. The solver is a static C program that copies a number, so that next to
  nothing is left but the starting of it;
- ranks: threads of one process that do the same.

For internal models nothing is subtracted: the row is the solution and all around it.
"""

import argparse
import datetime
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
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
static const char* const files[] = {"run/input.txt", "run/f.txt", "run/stdout.txt", "run/stderr.txt"};
static int prepare(void) {
  FILE* in = mkdir("run", 0700) == 0 ? fopen(files[0], "w") : 0;
  return in && fprintf(in, "2.0\n") > 0 && fclose(in) == 0;
}
static void redirect(void) {
  if (chdir("run") != 0) _exit(126);
  dup2(open("/dev/null", O_RDONLY), 0);
  dup2(open("stdout.txt", O_WRONLY | O_CREAT, 0644), 1);
  dup2(open("stderr.txt", O_WRONLY | O_CREAT, 0644), 2);
}
static int finish(void) {
  double k = 0.0;
  FILE* result = fopen(files[1], "r");
  if (!result || fscanf(result, "%lf", &k) != 1 || fclose(result) != 0) return 0;
  for (int i = 0; i < 4; ++i) {
    if (unlink(files[i]) != 0) return 0;
  }
  return rmdir("run") == 0;
}
int main(int argc, char** argv) {
  char* program[] = {argv[2], 0};
  char* nothing[] = {0};
  const int has_files = argc > 3;
  for (int i = atoi(argv[1]); i > 0; --i) {
    if (has_files && !prepare()) return 1;
    const pid_t child = fork();
    if (child == 0) {
      if (has_files) redirect();
      execve(program[0], program, nothing);
      _exit(127);
    }
    int status = 0;
    if (waitpid(child, &status, 0) != child || status != 0) return 1;
    if (has_files && !finish()) return 1;
  }
  return 0;
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


class Job:
    """Makes the command for a number of samples; `few` and `many` of them are run."""

    def __init__(self, make_command, few, many, folder):
        self.make_command, self.few, self.many, self.folder = make_command, few, many, folder

    def a_sample(self, name):
        """Elapsed and processor milliseconds a sample."""
        small, large = (spent(self.make_command(samples, f"{name}-{samples}"), self.folder) for samples in (self.few, self.many))
        return [1e3 * (b - a) / (self.many - self.few) for a, b in zip(small, large)]


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

    def measure(self, *jobs):
        """Elapsed and processor milliseconds a sample of each job: medians over the turns."""
        found = [[] for _ in jobs]
        for turn in range(self.turns):
            for number, job in enumerate(jobs):
                found[number].append(job.a_sample(f"{turn}-{number}"))
                for folder in self.folder.glob("out-*"):
                    subprocess.run(["rm", "-rf", folder], check=True)
        return [[statistics.median(column) for column in zip(*rows)] for rows in found]

    def job(self, study, few, many, *more):
        return Job(self.propagate(study, *more), few, many, self.folder)

    def loop(self, *has_files):
        folder = self.folder / "solver-input"
        folder.mkdir(exist_ok=True)
        (folder / "input.txt").write_text("2.0\n")
        program = str(self.folder / "solver")
        return Job(lambda runs, _: [str(self.folder / "loop"), str(runs), program, *has_files], 50, 1050, folder)

    def rows(self):
        one, two = ["--threads", "1"], ["--threads", "2"]
        for words, threads in (("one thread", one), ("two threads", two)):
            found, = self.measure(self.job(THREE_MASSES, 1000, 201000, threads))
            yield f"three masses, {words}", 200000, "nothing", found, [0.0, 0.0]
        found, bare, files = self.measure(self.job("study.toml", 50, 1050, one), self.loop(), self.loop("with files"))
        yield "runs of a solver, one at once", 1000, "loop of fork, execve, waitpid", found, bare
        yield "runs of a solver, one at once", 1000, "the same loop with its files", found, files
        full = ["--set", 'model.reduction="off"']
        found, base = self.measure(self.job(AIRFRAME, 20, 120, [*full, *one], [*MPIRUN, "2"]),
                                   self.job(AIRFRAME, 20, 120, [*full, *two]))
        yield "airframe solved in full, 2 ranks", 100, "2 threads", found, base
        found, base = self.measure(self.job("study.toml", 50, 1050, one, [*MPIRUN, "2"]),
                                   self.job("study.toml", 50, 1050, ["--set", "model.parallel=2"]))
        yield "runs of a solver, 2 ranks", 1000, "2 runs at once", found, base


def section(rows, turns):
    lines = [HEADING, "",
             f"Milliseconds a sample, {peers.processor()}; medians of {turns} turns, {datetime.date.today()}; made by "
             f"measure_overhead.py, which says how. "
             f"Goal: an overhead of at most {GOAL_MS:g} ms.", "",
             "| what | samples | processor | elapsed | subtracted | processor of that | elapsed of that | overhead, processor | "
             "overhead, elapsed | ratio, processor | ratio, elapsed |", "|---|---|---|---|---|---|---|---|---|---|---|"]
    for what, samples, base_name, found, base in rows:
        cells = [f"{found[1]:.4f}", f"{found[0]:.4f}", base_name, f"{base[1]:.4f}", f"{base[0]:.4f}",
                 f"{found[1] - base[1]:.4f}", f"{found[0] - base[0]:.4f}",
                 *(f"{found[i] / base[i]:.2f}" if base[i] > 0.0 else "" for i in (1, 0))]
        lines.append(f"| {what} | {samples} | " + " | ".join(cells) + " |")
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
