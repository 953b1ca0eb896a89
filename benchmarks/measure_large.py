#!/usr/bin/python3
"""One solve of a large model by `mottle modes`: elapsed and processor time, what dominates, peak memory. Appends its row to LARGE.md.

    benchmarks/measure_large.py shell 1000000 [--modes 10] [--limit-gib 16]
"""
import argparse
import os
import pathlib
import re
import resource
import tempfile
import time

import make_models

HERE = pathlib.Path(__file__).resolve().parent
MOTTLE = HERE.parent / "build" / "release" / "mottle"


def solve(deck, modes, limit_bytes, out):
    """Exit status, elapsed time, use of resources."""
    begin = time.perf_counter()
    child = os.fork()
    if child == 0:
        resource.setrlimit(resource.RLIMIT_AS, (limit_bytes, limit_bytes))
        with out.open("wb") as file:
            os.dup2(file.fileno(), 1)
            os.dup2(file.fileno(), 2)
        os.execv(MOTTLE, [str(MOTTLE), "modes", str(deck), "--modes", str(modes), "--out", str(out.parent / "modes")])
    _, status, used = os.wait4(child, 0)
    return os.waitstatus_to_exitcode(status), time.perf_counter() - begin, used


def row(family, modes, said, end):
    status, elapsed, used = end
    equations = re.search(r"(\d+) equations", said)
    phases = re.search(r"read in (\S+) s, assembled in (\S+) s, solved in (\S+) s, of which factorised in (\S+) s", said)
    counted = "yes" if "none missed" in said else "no"
    cells = [family, equations.group(1) if equations else "?", str(modes), f"{elapsed:.0f}", f"{used.ru_utime + used.ru_stime:.0f}",
             *(phases.groups() if phases else ["?"] * 4), f"{used.ru_maxrss / 2**20:.1f}",
             counted if status == 0 else f"exit code {status}: {said.strip().splitlines()[-1]}"]
    return f"| {' | '.join(cells)} |\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("family", choices=["shell", "solid", "cube"])
    parser.add_argument("equations", type=int)
    parser.add_argument("--modes", type=int, default=10)
    parser.add_argument("--limit-gib", type=float, default=16.0, help="of address space (default: 16)")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        deck = pathlib.Path(place) / "model.bdf"
        make_models.write_model(arguments.family, arguments.equations, 1, deck)
        out = pathlib.Path(place) / "out.txt"
        end = solve(deck, arguments.modes, int(arguments.limit_gib * 2**30), out)
        with (HERE / "LARGE.md").open("a", encoding="utf-8") as table:
            table.write(row(arguments.family, arguments.modes, out.read_text(), end))


if __name__ == "__main__":
    main()
