#!/usr/bin/env python3
"""The long forms of the attacks of tests/attack: mutated inputs, kills, two writers, limits, faulty solvers, torn files.

    python3 validation/attack/run.py build/release/mottle [--hours H] [--scale S] [--seed N] [--family NAME] [--resume]

Writes the table to RESULTS.md beside this file, a row a family, which replaces the row that is there; a family alone and a
part of one leave the others as they are. With --resume a family of the same seed goes on where its row ends. One attack again:

    python3 validation/attack/run.py build/release/mottle --family Mutations --seed 1 --number 4711
"""
import argparse
import datetime
import math
import pathlib
import re
import signal
import sys
import tempfile
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
RESULTS = HERE / "RESULTS.md"
sys.path.insert(0, str(ROOT / "tests" / "attack"))
import families  # noqa: E402

HEAD = """\
# Attacks

`python3 validation/attack/run.py build/release/mottle` (`make attack`). A row a family of tests/attack: what was attacked how often
from which seed, and what was found. An attack again: `--family F --seed S --number N`.

| family | what | seed | attacks | findings | minutes | version, day |
|---|---|---|---|---|---|---|
"""
ROW = re.compile(r"^\| (\w+) \| (.*?) \| (\d+) \| (\d+) \| (\d+) \| (\d+) \| (.*?) \|$")
FOUND = re.compile(r"^- (\w+) ")


class Row:
    """What one family has come to."""

    def __init__(self, family, seed, day):
        self.family, self.seed, self.day = family, seed, day
        self.attacks, self.minutes, self.found = 0, 0.0, []
        self.reason = ""  # why there were no attacks

    def text(self):
        what = self.family.title + (f" (not made: {self.reason})" if self.reason else "")
        return (f"| {self.family.__name__} | {what} | {self.seed} | {self.attacks} | {len(self.found)} | "
                f"{round(self.minutes)} | {self.day} |")


class Table:
    """RESULTS.md: rows and findings by family, written anew at each change."""

    def __init__(self):
        self.rows, self.found = {}, {}
        for line in RESULTS.read_text(encoding="utf-8").splitlines() if RESULTS.exists() else []:
            if row := ROW.match(line):
                self.rows[row[1]] = line
            elif found := FOUND.match(line):
                self.found.setdefault(found[1], []).append(line)

    def continue_row(self, row):
        """Takes over what an earlier part of the same seed has done."""
        earlier = ROW.match(self.rows.get(row.family.__name__, ""))
        if earlier and int(earlier[3]) == row.seed:
            row.attacks, row.minutes = int(earlier[4]), float(earlier[6])
            row.found = list(self.found.get(row.family.__name__, []))

    def put(self, row):
        name = row.family.__name__
        self.rows[name], self.found[name] = row.text(), list(row.found)
        order = [family.__name__ for family in families.ALL]
        names = sorted(self.rows, key=lambda name: order.index(name) if name in order else len(order))
        found = [line for name in names for line in self.found.get(name, [])]
        text = HEAD + "".join(self.rows[name] + "\n" for name in names)
        RESULTS.write_text(text + ("\n## Findings\n" + "\n".join(found) + "\n" if found else ""), encoding="utf-8")


def attack(row, table, mottle, scale, end):
    """Attacks until all are made or it is `end`; the table is written every minute."""
    count = math.inf if row.family.many is None else round(scale * row.family.many)
    if row.family.many is None:
        end = min(end, time.monotonic() + 60 * scale * row.family.minutes)
    with tempfile.TemporaryDirectory(prefix="mottle-attack-") as folder:
        attacks = row.family(mottle, folder)
        try:
            attacks.prepare()
        except unittest.SkipTest as reason:
            row.reason = str(reason)
            return
        began = written = time.monotonic()
        before = row.minutes
        while row.attacks < count and time.monotonic() < end:
            found = attacks.make(row.seed, row.attacks)
            if found:
                line = " ".join(found.replace(folder, "DIR").split())[:400]
                row.found.append(f"- {row.family.__name__} {row.seed} {row.attacks}: {attacks.doing}: {line}")
                print(row.found[-1], flush=True)
            row.attacks += 1
            row.minutes = before + (time.monotonic() - began) / 60
            if time.monotonic() > written + 60:
                written = time.monotonic()
                table.put(row)


def again(family, settings):
    """One attack alone."""
    with tempfile.TemporaryDirectory(prefix="mottle-attack-") as folder:
        attacks = family(settings.mottle.resolve(), folder)
        attacks.prepare()
        found = attacks.make(settings.seed, settings.number)
        print(f"{attacks.doing}: {found or 'nothing found'}")
        return bool(found)


def read_settings():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("mottle", type=pathlib.Path)
    parser.add_argument("--hours", type=float, default=24.0, help="that all families together may take")
    parser.add_argument("--scale", type=float, default=1.0, help="times the number of attacks of each family, or its time")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--family", action="append", choices=[family.__name__ for family in families.ALL])
    parser.add_argument("--number", type=int, help="this attack alone; no table is written")
    parser.add_argument("--resume", action="store_true")
    return parser.parse_args()


def main():
    settings = read_settings()
    for number in (signal.SIGINT, signal.SIGTERM):  # either way the row of what was done is written
        signal.signal(number, signal.default_int_handler)
    chosen = [family for family in families.ALL if family.__name__ in settings.family] if settings.family else families.ALL
    families.support.MOTTLE = str(settings.mottle.resolve())
    if settings.number is not None:
        sys.exit(again(chosen[0], settings))
    version = families.support.run("--version").out.strip()
    end, has_found = time.monotonic() + 3600 * settings.hours, False
    table = Table()
    for k, family in enumerate(chosen):
        row = Row(family, settings.seed, f"{version}, {datetime.date.today()}")
        if settings.resume:
            table.continue_row(row)
        # Each of the families that are left may take its part of the time that is left.
        part = family.minutes / sum(each.minutes for each in chosen[k:])
        share = time.monotonic() + part * (end - time.monotonic())
        try:
            attack(row, table, settings.mottle.resolve(), settings.scale, share)
        finally:
            table.put(row)
        print(row.text(), flush=True)
        has_found |= bool(row.found)
    sys.exit(has_found)


if __name__ == "__main__":
    main()
