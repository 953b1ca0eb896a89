#!/usr/bin/env python3
"""What a solver that fails, kills, full disks and changed inputs do to an update by command: nothing but what they must.

Writes the table to RESULTS.md beside this file. Needs a C compiler; the full disk needs the right to mount a tmpfs.

    python3 validation/solver-faults/run.py [--mottle build/release/mottle] [--kills 20] [--seed 1]
"""
import argparse
import datetime
import json
import math
import os
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
FEW = ["--set", "update.samples=40", "--set", "update.iterations=2"]
WORK = "runs"  # folder of runs that go on


def call(mottle, folder, out, *more, timeout=900):
    command = [mottle, "update", folder / "study.toml", "--out", out, "--quiet", *more]
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=timeout, check=False)


def succeed(mottle, folder, out, *more):
    done = call(mottle, folder, out, *more)
    if done.returncode != 0:
        sys.exit(f"ended with {done.returncode}: {done.stderr}")
    return read(out)


def read(out):
    return json.loads((out / "result.json").read_text())


def numbers(out):
    result = read(out)
    result.pop("timings_s")
    return json.dumps(result)


def environment(faults, log="/dev/null", pause=0):
    return ["--set", f'model.environment={{ FAULTS = "{faults}", RUN_LOG = "{log}", PAUSE_MS = "{pause}" }}']


def store_keys(file):
    """Keys of the whole records of runs.store."""
    data = file.read_bytes() if file.exists() else b""
    at, keys = 14, []
    while at + 40 <= len(data):
        size, first, second = struct.unpack_from("<3Q", data, at)
        if at + 40 + size > len(data):
            break
        keys.append((first, second))
        at += 40 + size
    return keys


def lines(file):
    return file.read_text().split() if file.exists() else []


class Table:
    def __init__(self):
        self.rows, self.has_failed = [], False

    def add(self, claim, measured, holds):
        self.rows.append((claim, measured, holds))
        self.has_failed |= not holds
        print(f"{'ok  ' if holds else 'FAIL'} {claim}: {measured}", flush=True)


def faults(mottle, folder, table):
    clean = succeed(mottle, folder, folder / "clean", *environment("0 0 0 0"))
    done = call(mottle, folder, folder / "faulty", *environment("0.05 0.05 0.05 0.05"))
    if done.returncode != 0:
        sys.exit(done.stderr)
    faulty = read(folder / "faulty")
    kinds = {"killed by signal 11": 0, "no end within": 0, "is not a number": 0, "modes are there": 0}
    for failure in faulty["failed_evaluations"]:
        for kind in kinds:
            kinds[kind] += kind in failure["reason"]
    failed, runs = len(faulty["failed_evaluations"]), faulty["model_evaluations"]
    states = len(faulty["iterations"])
    table.add("5 % each crash, hang, print garbage, lose a mode: the update finishes",
              f"{failed} of {runs} runs failed in {states} clouds of 200: {', '.join(str(n) for n in kinds.values())}",
              sum(kinds.values()) == failed and all(abs(n - 0.05 * runs) < 4 * math.sqrt(0.0475 * runs) for n in kinds.values()))
    kept = sorted((folder / "faulty" / "failed-runs").iterdir())
    complete = all((k / name).exists() for k in kept for name in ("input.txt", "stdout.txt", "stderr.txt", "reason.txt"))
    ids = {failure["reason"].split("run ")[-1].rstrip(")") for failure in faulty["failed_evaluations"]}
    table.add("their folders are kept, at most 20, under the names in failed_evaluations", f"{len(kept)} folders",
              len(kept) == 20 and complete and {k.name for k in kept} <= ids)
    table.add("a warning says that they bias the clouds", "in mottle.log",
              "biased" in (folder / "faulty" / "mottle.log").read_text())
    worst_mean = worst_std = 0.0
    n = 200 - failed / states
    for i, std in enumerate(clean["parameters"]["std"]):
        shift = faulty["parameters"]["mean"][i] - clean["parameters"]["mean"][i]
        worst_mean = max(worst_mean, abs(shift) / (std / math.sqrt(n)))
        shift = faulty["parameters"]["std"][i] - std
        worst_std = max(worst_std, abs(shift) / (std / math.sqrt(2 * n)))
    table.add("the estimate agrees with the clean run's within Monte-Carlo error",
              f"means within {worst_mean:.2f}, standard deviations within {worst_std:.2f} standard errors",
              worst_mean < 2 and worst_std < 2)
    done = call(mottle, folder, folder / "half", *environment("0.125 0.125 0.125 0.125"))
    table.add("50 % faults stop it", f"exit {done.returncode}: {done.stderr.strip()[:150]}",
              done.returncode == 3 and "solver runs failed" in done.stderr)


def kills(mottle, folder, table, count, seed):
    log, rates = folder / "runs.log", "0.03 0 0.03 0.03"
    common = [*FEW, *environment(rates, folder / "whole.log", 40)]
    start = time.monotonic()
    succeed(mottle, folder, folder / "whole", *common)
    duration = time.monotonic() - start
    common = [*FEW, *environment(rates, log, 40)]
    chance, same, killed, lost, repeated = random.Random(seed), 0, 0, 0, 0
    out = folder / "killed"
    while killed < count:
        shutil.rmtree(out, ignore_errors=True)
        log.unlink(missing_ok=True)
        more = []
        for _ in range(4):
            process = subprocess.Popen([str(p) for p in (mottle, "update", folder / "study.toml", "--out", out, "--quiet",
                                                         *common, *more)], stderr=subprocess.PIPE)
            time.sleep(chance.uniform(0.02, 0.6) * duration)
            has_ended = process.poll() is not None
            process.kill()
            process.communicate()
            if has_ended or killed == count:
                break
            killed += 1
            more = ["--resume"]
        time.sleep(0.3)
        before = len(lines(log)) - len(set(store_keys(out / "runs.store")))
        lost += max(0, before)
        succeed(mottle, folder, out, *common, "--resume")
        keys = store_keys(out / "runs.store")
        repeated += len(keys) - len(set(keys))
        a, b = read(out), read(folder / "whole")
        a.pop("timings_s"), b.pop("timings_s")
        for result in (a, b):  # runs are called by all that went into them, also the log's name
            for failure in result["failed_evaluations"]:
                failure["reason"] = failure["reason"].split(" (run")[0]
        same += a == b
        total = len(lines(log)) - len(set(lines(log)))
        print(f"  {killed} kills, {total} runs repeated that had not been kept", flush=True)
        if a != b:
            break
    left = [p.name for p in out.iterdir() if p.name == WORK]
    table.add(f"kill -9 at {count} random moments, then --resume: the same result.json", f"{same} resumed runs, all the same",
              a == b)
    table.add("no finished run is repeated", f"{repeated} runs were kept twice", repeated == 0)
    table.add("nothing is left of the killed runs' folders", f"{len(left)} folders", not left)


def changes(mottle, folder, table):
    common = [*FEW, *environment("0 0 0 0", pause=20)]
    out = folder / "changed"
    process = subprocess.Popen([str(p) for p in (mottle, "update", folder / "study.toml", "--out", out, "--quiet", *common)])
    while len(store_keys(out / "runs.store")) < 20:
        time.sleep(0.01)
    process.kill()
    process.wait()
    template = folder / "input.txt.in"
    text = template.read_text()
    template.write_text(text.replace("3.0", "3.1"))
    done = call(mottle, folder, out, *common, "--resume")
    table.add("a changed template is noticed by --resume", f"exit {done.returncode}: {done.stderr.strip()[-110:]}",
              done.returncode == 2 and "changed" in done.stderr)
    succeed(mottle, folder, out, *common)
    told = [line for line in (out / "mottle.log").read_text().splitlines() if "solver runs were needed" in line][0]
    template.write_text(text)
    kept = len(store_keys(out / "runs.store"))
    succeed(mottle, folder, out, *common)
    again = [line for line in (out / "mottle.log").read_text().splitlines() if "solver runs were needed" in line][0]
    table.add("and no run of the old one is used", told.split("s  ")[-1].split(",")[0], " 0 of them" in told or " 3 of them" in told)
    succeed(mottle, folder, out, *common)
    third = [line for line in (out / "mottle.log").read_text().splitlines() if "solver runs were needed" in line][0]
    need = int(third.split("s  ")[-1].split()[0])
    used = int(third.split("; ")[1].split()[0])
    table.add("a run again of an unchanged model repeats nothing", f"{used} of {need} runs from runs.store", used == need)
    tests = folder / "specimens.csv"
    text = tests.read_text()
    shutil.rmtree(out)
    process = subprocess.Popen([str(p) for p in (mottle, "update", folder / "study.toml", "--out", out, "--quiet", *common)])
    while len(store_keys(out / "runs.store")) < 20:
        time.sleep(0.01)
    process.kill()
    process.wait()
    tests.write_text(text + text.splitlines()[-1] + "\n")
    done = call(mottle, folder, out, *common, "--resume")
    table.add("a changed CSV is noticed by --resume", f"exit {done.returncode}: {done.stderr.strip()[-110:]}",
              done.returncode == 2 and "changed" in done.stderr)
    tests.write_text(text)


def disks(mottle, folder, table):
    disk = folder / "disk"
    disk.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", disk], check=False).returncode != 0:
        print("no tmpfs can be mounted here: the full disk is not tried")
        return
    try:
        common = [*FEW, *environment("0 0 0 0")]
        succeed(mottle, folder, folder / "whole-disk", *common)
        same = stopped = 0
        messages = set()
        rooms = [0, 1 << 13, 1 << 15, 1 << 16, 90000, 120000, 150000, 200000]
        for room in rooms:
            filler = disk / "filler"
            state = os.statvfs(disk)
            filler.write_bytes(b"\0" * max(0, state.f_bavail * state.f_frsize - room))
            done = call(mottle, folder, disk / "out", *common)
            stopped += done.returncode == 3
            if done.returncode not in (0, 3):
                messages.add(f"exit {done.returncode}: {done.stderr}")
            elif done.returncode == 3:
                messages.add("No space left on device" if "No space left on device" in done.stderr else done.stderr)
            filler.unlink()
            done = call(mottle, folder, disk / "out", *common, "--resume")
            same += done.returncode == 0 and numbers(disk / "out") == numbers(folder / "whole-disk")
            shutil.rmtree(disk / "out")
        table.add(f"a tmpfs with {len(rooms)} sizes of room too little: exit 3 and a clear message",
                  f"{stopped} stopped, all: {'; '.join(messages)[:200]}", stopped >= 5 and messages == {"No space left on device"})
        table.add("after there is room, --resume gives the same result.json", f"{same} of {len(rooms)}", same == len(rooms))
        process = subprocess.Popen([str(p) for p in (mottle, "update", folder / "study.toml", "--out", disk / "out", "--quiet",
                                                     *FEW, *environment("0 0 0 0"))])
        while len(store_keys(disk / "out" / "runs.store")) < 5:
            time.sleep(0.01)
        process.kill()
        process.wait()
        time.sleep(0.5)
        subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
        done = call(mottle, folder, disk / "out", *common, "--resume")
        subprocess.run(["mount", "-o", "remount,rw", disk], check=True)
        again = call(mottle, folder, disk / "out", *common, "--resume")
        table.add("a place that has become read-only: a clear message, and --resume works after",
                  f"exit {done.returncode}: {done.stderr.strip()[-100:]}",
                  done.returncode in (2, 3) and "Read-only" in done.stderr and again.returncode == 0
                  and numbers(disk / "out") == numbers(folder / "whole-disk"))
    finally:
        subprocess.run(["umount", "-l", disk], check=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--mottle", default=ROOT / "build" / "release" / "mottle", type=pathlib.Path)
    parser.add_argument("--kills", default=20, type=int)
    parser.add_argument("--seed", default=1, type=int)
    settings = parser.parse_args()
    table = Table()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for file in ("study.toml", "input.txt.in", "specimens.csv"):
            shutil.copy(HERE / file, folder)
        subprocess.run(["cc", "-O1", "-o", folder / "solver", HERE / "solver.c", "-lm"], check=True)
        faults(settings.mottle.resolve(), folder, table)
        changes(settings.mottle.resolve(), folder, table)
        disks(settings.mottle.resolve(), folder, table)
        kills(settings.mottle.resolve(), folder, table, settings.kills, settings.seed)
    version = subprocess.run([settings.mottle, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    report = [f"# {version}: a solver that fails", "",
              f"`python3 validation/solver-faults/run.py`, {datetime.date.today()}, seed {settings.seed}: three masses, three "
              "springs by `mares`, a solver of its own process a sample, two at once.", "", "| claim | measured | holds |", "|---|---|---|"]
    report += [f"| {claim} | {measured.replace('|', '/')} | {'yes' if holds else '**no**'} |" for claim, measured, holds in table.rows]
    (HERE / "RESULTS.md").write_text("\n".join(report).replace(name, "DIR") + "\n")
    sys.exit(table.has_failed)


if __name__ == "__main__":
    main()
