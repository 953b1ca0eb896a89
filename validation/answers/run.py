#!/usr/bin/env python3
"""Are right models called right, and wrong ones wrong, with the cause? Mottle's answers to drawn studies are counted.

Writes RESULTS.md beside this file and ends with 1 where a goal is missed. Needs NumPy.

    python3 validation/answers/run.py [--program build/release/mottle] [--part methods|studies] [--sets 40] [--jobs 2]
    python3 validation/answers/run.py --short             # a few sets of each kind of study; writes nothing
    python3 validation/answers/run.py --family "six masses, by rank" --number 3 --keep FOLDER     # one set, to look at
"""
import argparse
import json
import os
import pathlib
import sys

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # small matrices

import by_method  # noqa: E402
import by_study  # noqa: E402
from families import families  # noqa: E402
from studies import one_set  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
SECOND = "# Answers to whole studies"


def options():
    """The command's arguments."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=HERE.parent.parent / "build/release/mottle")
    parser.add_argument("--part", choices=("methods", "studies"), help="make one of the two tables again, and keep the other")
    parser.add_argument("--sets", type=int, help="sets of each row (default: 40 by method, 20 of whole studies; 0: those in the log)")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--log", type=pathlib.Path, help="file of the answers to whole studies, a line of JSON each: read, and added to")
    parser.add_argument("--short", action="store_true", help="two sets of each family; the goals then with two standard errors")
    parser.add_argument("--family", help="one set of this family alone")
    parser.add_argument("--number", type=int, default=0)
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the files and answers of that set")
    return parser.parse_args()


def main():
    arguments = options()
    program = arguments.program.resolve()
    if arguments.family:
        family = next(family for family in families() if family.what == arguments.family)
        print(json.dumps(one_set(program, family, arguments.number, arguments.keep), indent=1))
        return 0
    if arguments.short:
        return 0 if by_study.section(program, arguments.sets or 2, arguments.jobs, arguments.log, is_short=True)[1] else 1
    results = HERE / "RESULTS.md"
    first, _, second = results.read_text(encoding="utf-8").partition(SECOND)
    second, met = SECOND + second, []
    if arguments.part != "studies":
        first, is_met = by_method.section(program, arguments.sets or 40, arguments.jobs)
        met.append(is_met)
    if arguments.part != "methods":
        second, is_met = by_study.section(program, 20 if arguments.sets is None else arguments.sets, arguments.jobs, arguments.log)
        met.append(is_met)
    results.write_text(first.rstrip("\n") + "\n\n" + second, encoding="utf-8")
    return 0 if all(met) else 1


if __name__ == "__main__":
    sys.exit(main())
